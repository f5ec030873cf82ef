"""Robustness of a small real study: simulated, stored, resumed, checked, picked from."""

import json
import shutil
import sqlite3
from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.analysis import robustness as module
from pareto_monoped.analysis.robustness import robust, robust_front, robust_trials, simulated
from pareto_monoped.analysis.verify import verify
from pareto_monoped.cli import _run as cli
from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.design import NAMES
from pareto_monoped.errors import DatabaseError, InputError, SelectionError, StudyError
from pareto_monoped.storage.extra_rows import read_robustness
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import run
from pareto_monoped.study.simulator import stored_simulator
from pareto_monoped.uncertainty.samples import sobol_samples, variations
from pareto_monoped.uncertainty.settings import load_uncertainty

UNCERTAINTY = load_uncertainty()


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A study of 30 trials, two of them simulated under uncertainty, and the numbers of its feasible trials."""
    db = tmp_path_factory.mktemp("robust") / "s.db"
    file = {"name": "s", "evaluations": 30, "audit": False, "strength": True, "algorithm": {"name": "random"}}
    holding = {"knee_ratio": {"lower": 4.0, "upper": 6.0}, "knee_release_rad": {"lower": 0.3, "upper": 1.0}}
    file |= {"gear_list": True, "rules": "iso6336", "variables": holding}
    run(study_from_dict(file, source="test"), db, workers=1)
    data = read_study(db)
    jumped = data.trials[data.trials["state"] == "feasible"]["trial"].tolist()
    assert len(jumped) >= 8
    robust(db, UNCERTAINTY, trials=jumped[:2], workers=1)
    return db, jumped


@pytest.fixture
def db(made, tmp_path):
    shutil.copy(made[0], tmp_path / "s.db")
    return tmp_path / "s.db"


def test_it_is_what_each_sample_alone_gives(made):
    """Every sixteenth sample, jumped alone; all of them then have the stored percentiles."""
    db, jumped = made
    data, samples = read_study(db), sobol_samples(UNCERTAINTY)
    design = data.trials.set_index("trial").loc[jumped[0], list(NAMES)].to_numpy(dtype=np.float64)
    evaluator = stored_simulator(data, workers=2).evaluator
    varied = variations(samples, 1, data.calibration)
    heights = evaluator(np.tile(design, (256, 1)), variations=varied).height_m
    stored = read_robustness(db)[jumped[0]].result
    ok = np.isfinite(heights)
    assert stored.failed == pytest.approx(1.0 - ok.mean())
    assert stored.measures["height_m"].p05 == pytest.approx(np.percentile(heights[ok], 5), rel=1e-12)
    assert stored.measures["height_m"].mean == pytest.approx(heights[ok].mean(), rel=1e-12)
    for row in range(0, 256, 64):
        one = replace(varied, **{name: getattr(varied, name)[row : row + 1] for name in varied.__dataclass_fields__})
        np.testing.assert_array_equal(evaluator(design[None], variations=one).height_m, heights[row : row + 1])


def test_workers_and_other_designs_change_no_number(made):
    db, jumped = made
    data = read_study(db)
    rows = data.trials[data.trials["trial"].isin(jumped[:2])]
    evaluator = stored_simulator(data, workers=2).evaluator
    alone = simulated(data, rows.iloc[1:], evaluator, sobol_samples(UNCERTAINTY))
    assert alone[jumped[1]] == read_robustness(db)[jumped[1]].result


def test_what_is_stored_is_not_simulated_again(made, db, monkeypatch):
    before = read_robustness(db)
    asked = []
    monkeypatch.setattr(module, "simulated", lambda *given: asked.append(given))
    found = robust(db, UNCERTAINTY, trials=made[1][:2], workers=1)
    assert asked == []
    assert found == {trial: before[trial].result for trial in made[1][:2]}
    # Another seed is another question.
    with pytest.raises(AttributeError):
        robust(db, UNCERTAINTY, trials=made[1][:1], seed=2, workers=1)
    assert len(asked) == 1


def test_the_study_stays_whole_and_goes_on(db):
    checked = verify(db)
    assert checked.findings == ()
    assert checked.sealed
    study = read_study(db).study
    run(replace(study, evaluations=31), db, workers=1)
    assert len(read_robustness(db)) == 2
    assert verify(db).findings == ()


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ("UPDATE monoped_robustness SET result = replace(result, '256', '255')", "does not match its hash"),
        ("DELETE FROM monoped_robustness WHERE trial = (SELECT min(trial) FROM monoped_robustness)", "is missing"),
        ("INSERT INTO monoped_robustness VALUES (999, '{}', '{}')", "has no hash"),
    ],
)
def test_damage_is_found(db, change, word):
    connection = sqlite3.connect(db)
    connection.execute(change)
    connection.commit()
    connection.close()
    for reader in (read_robustness, verify):
        with pytest.raises(DatabaseError, match=word):
            reader(db)


def test_a_table_that_is_gone_is_missed(db):
    connection = sqlite3.connect(db)
    connection.execute("DROP TABLE monoped_robustness")
    connection.commit()
    connection.close()
    with pytest.raises(DatabaseError, match="is missing"):
        read_robustness(db)


def test_a_study_without_robustness_has_none(tmp_path):
    from tests.study.support import made_database

    made_database(tmp_path / "s.db")
    assert read_robustness(tmp_path / "s.db") == {}
    with pytest.raises(SelectionError, match="simulate it with 'robust' first"):
        robust_trials(read_study(tmp_path / "s.db"), {})


def test_what_cannot_be_asked_is_refused(made, db):
    with pytest.raises(InputError, match="samples = 128: must be a power of two of at least 256"):
        robust(db, UNCERTAINTY, samples=128)
    with pytest.raises(SelectionError, match="trial = 999: must be a trial of the study that jumped"):
        robust(db, UNCERTAINTY, trials=[999])


def test_other_jumps_than_the_stored_ones_are_refused(made):
    data = read_study(made[0])
    rows = data.trials[data.trials["trial"] == made[1][0]].assign(height_m=0.9)
    with pytest.raises(
        StudyError, match=rf"trial {made[1][0]} jumps .* m with this code and machine, 0.9 m are stored"
    ):
        simulated(data, rows, stored_simulator(data, workers=1).evaluator, sobol_samples(UNCERTAINTY, 4))


def test_robust_on_the_command_line(made, db, capsys):
    trial = made[1][0]
    assert cli(["robust", str(db), "--trial", str(trial), "--json"]) == 0
    shown = json.loads(capsys.readouterr().out)
    stored = read_robustness(db)[trial].result
    assert shown["trials"][str(trial)] == stored.as_dict()
    assert (shown["samples"], shown["uncertainty"]) == (256, "default")
    assert cli(["robust", str(db), "--trial", str(trial)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    height = stored.measures["height_m"]
    assert lines[-1].split()[:4] == [str(trial), *(f"{value:.3f}" for value in (height.mean, height.p05, height.p95))]
    assert lines[-1].split()[-2:] == [f"{100 * stored.failed:.1f}", f"{100 * stored.overloaded:.1f}"]


def test_alternatives_are_simulated_with_the_designs(made, db, monkeypatch, capsys):
    """Which ones is what ``pick`` says; the jumps themselves play no part here."""
    from pareto_monoped.analysis.alternatives import alternatives

    monkeypatch.setitem(alternatives.__kwdefaults__, "tolerance", 10.0)
    data = read_study(db)
    others = [one.trial for one in alternatives(data, made[1][0], count=2)]
    assert len(others) == 2
    asked = []
    monkeypatch.setattr(module, "robust", lambda *given, **named: asked.append(named["trials"]) or {})
    assert cli(["robust", str(db), "--trial", str(made[1][0]), "--alternatives", "2", "--json"]) == 0
    assert asked == [[made[1][0], *others]]


def test_pick_robust(made, db, capsys):
    data = read_study(db)
    front = robust_front(data, robust_trials(data, read_robustness(db)))
    assert cli(["pick", str(db), "--robust", "--knee", "--json"]) == 0
    picked = json.loads(capsys.readouterr().out)
    row = front[front["trial"] == picked["trial"]].iloc[0]
    assert picked["height_m"] == row["height_m"] == read_robustness(db)[picked["trial"]].result.measures["height_m"].p05
    assert (picked["failed_share"], picked["overloaded_share"]) == (row["failed_share"], row["overloaded_share"])
    assert cli(["pick", str(db), "--robust", "--knee"]) == 0
    words = " ".join(capsys.readouterr().out.split())
    failed, overloaded = (f"{100 * row[name]:.1f} %" for name in ("failed_share", "overloaded_share"))
    assert f"{failed} of jumps fail, {overloaded} overload a part" in words
    other = next(trial for trial in made[1][:2] if trial != picked["trial"])
    command = ["pick", str(db), "--robust", "--knee", "--alternatives", "2", "--tolerance", "100"]
    assert cli([*command, "--json"]) == 0
    (alternative,) = json.loads(capsys.readouterr().out)["alternatives"]
    assert alternative["trial"] == other
    assert alternative["height_m"] == read_robustness(db)[other].result.measures["height_m"].p05
    assert cli(command) == 0
    words = " ".join(capsys.readouterr().out.split())
    assert f"trial {other} (" in words
    assert "compared are the 2 designs whose robustness is stored" in words
