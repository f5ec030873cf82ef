"""The engine of a study: from its calibration or its file, stored when it begins, and never another one later."""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.definition.study import Study
from pareto_monoped.errors import InputError
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import run

FILE = {
    "name": "s",
    "motor": "VT8020",
    "calibration": "reference",
    "evaluations": 8,
    "seed": 3,
    "algorithm": {"name": "random"},
    "objectives": ["height_m", "energy_j"],
}


def made(tmp_path, name="s.db", **changes):
    db = tmp_path / name
    run(Study.define(**(FILE | changes)), db, workers=1)
    return read_study(db)


def test_both_engines_make_the_same_study_and_say_which_they_are(tmp_path):
    own, mujoco = made(tmp_path), made(tmp_path, "m.db", engine="mujoco")
    assert own.calibration.simulation.engine == "compiled"
    assert mujoco.calibration.simulation.engine == "mujoco"
    assert own.meta.hash != mujoco.meta.hash
    for name in ("height_m", "energy_j", "peak_chain_tension_n", "chain_safety"):
        np.testing.assert_allclose(own.trials[name], mujoco.trials[name], rtol=1e-8)
    # Both results stand beside every design of the front.
    audits = own.audits.set_index("trial")
    for trial in own.front()["trial"]:
        jump = own.trials.set_index("trial").loc[trial]
        assert audits.loc[trial, "mujoco_height_m"] == pytest.approx(jump["height_m"], rel=1e-8)
        assert audits.loc[trial, "mujoco_energy_j"] == pytest.approx(jump["energy_j"], rel=1e-8)


def test_a_study_keeps_its_engine(tmp_path):
    began = made(tmp_path, engine="mujoco")
    db = tmp_path / "s.db"
    run(Study.define(**(FILE | {"evaluations": 12})), db, workers=1)
    assert read_study(db).calibration == began.calibration
    assert len(read_study(db).trials) == 12
    with pytest.raises(InputError, match=r"calibration\.simulation\.engine") as caught:
        run(Study.define(**(FILE | {"evaluations": 16, "engine": "compiled"})), db, workers=1)
    assert "\n" not in str(caught.value)
    assert len(read_study(db).trials) == 12


def test_an_engine_that_cannot_is_refused_in_one_line(tmp_path):
    with pytest.raises(
        InputError, match=r"engine.*'compiled'.*'reference' does not have joints\.stop_law 'hunt_crossley'; drop it"
    ):
        made(tmp_path, calibration="reference-3", engine="compiled")
    assert not list(tmp_path.iterdir())
    with pytest.raises(InputError, match="engine"):
        Study.define(**(FILE | {"engine": "bullet"}))


def test_a_study_without_the_key_is_stored_as_before():
    plain, asked = Study.define(**FILE), Study.define(**(FILE | {"engine": "mujoco"}))
    assert "engine" not in plain.as_dict()
    assert asked.as_dict() == plain.as_dict() | {"engine": "mujoco"}
    assert replace(asked, engine=None) == plain
