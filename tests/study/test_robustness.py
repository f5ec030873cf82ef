"""Robustness of a small real study: simulated, stored, resumed, checked, picked from."""

import json
import shutil
import sqlite3
from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.cli import _run as cli
from pareto_monoped.design import NAMES
from pareto_monoped.errors import DatabaseError, InputError, SelectionError, StudyError
from pareto_monoped.pareto.front import front_mask
from pareto_monoped.study import robustness as module
from pareto_monoped.study.definition import study_from_dict
from pareto_monoped.study.reader import read_study
from pareto_monoped.study.robust_rows import Stored, read_robustness
from pareto_monoped.study.robustness import MOST_FAILED, robust, robust_front, simulated
from pareto_monoped.study.run import run
from pareto_monoped.study.simulator import stored_simulator
from pareto_monoped.study.verify import verify
from pareto_monoped.uncertainty.ranges import load_uncertainty
from pareto_monoped.uncertainty.samples import sobol_samples, variations
from pareto_monoped.uncertainty.statistics import Robustness, Spread

UNCERTAINTY = load_uncertainty()


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A study of 30 trials, one design of its front and one other trial under uncertainty."""
    db = tmp_path_factory.mktemp("robust") / "s.db"
    file = {"name": "s", "evaluations": 30, "audit": False, "strength": True, "algorithm": {"name": "random"}}
    run(study_from_dict(file | {"gear_list": True, "rules": "iso6336"}, source="test"), db, workers=1)
    data = read_study(db)
    jumped = data.trials[data.trials["status"] == "ok"]["trial"].tolist()
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
        robust_front(read_study(tmp_path / "s.db"), {})


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


def spread(value):
    return Spread(mean=value, deviation=0.0, p05=0.9 * value, p95=1.1 * value)


def test_the_robust_front_takes_the_worse_percentile_and_leaves_failures_out(made):
    db, jumped = made
    data = read_study(db)
    generator = np.random.default_rng(1)
    values = {trial: generator.uniform(0.6, 1.2, 2) for trial in jumped}
    failed = {trial: 0.06 if k % 5 == 0 else 0.05 for k, trial in enumerate(jumped)}
    stored = {
        trial: Stored(
            settings={},
            result=Robustness(
                samples=256,
                failed=failed[trial],
                overloaded=0.25,
                measures={"height_m": spread(height), "energy_j": spread(energy), "apex_s": spread(0.5)},
            ),
        )
        for trial, (height, energy) in values.items()
    }
    front = robust_front(data, stored)
    able = [trial for trial in jumped if failed[trial] <= MOST_FAILED]
    points = np.array([[0.9 * values[t][0], 1.1 * values[t][1]] for t in able])
    expected = [t for t, on in zip(able, front_mask(points, data.study.objectives), strict=True) if on]
    assert sorted(front["trial"]) == sorted(expected)
    for _, row in front.iterrows():
        height, energy = values[int(row["trial"])]
        assert (row["height_m"], row["energy_j"]) == pytest.approx((0.9 * height, 1.1 * energy))
        assert (row["apex_s"], row["overloaded"]) == (0.5, 0.25)
    assert front["mass_kg"].isna().all()


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


def test_pick_robust(made, db, capsys):
    front = robust_front(read_study(db), read_robustness(db))
    assert cli(["pick", str(db), "--robust", "--knee", "--json"]) == 0
    picked = json.loads(capsys.readouterr().out)
    row = front[front["trial"] == picked["trial"]].iloc[0]
    assert picked["height_m"] == row["height_m"] == read_robustness(db)[picked["trial"]].result.measures["height_m"].p05
    assert (picked["failed"], picked["overloaded"]) == (row["failed"], row["overloaded"])
    assert cli(["pick", str(db), "--robust", "--knee"]) == 0
    words = " ".join(capsys.readouterr().out.split())
    assert f"{100 * row['failed']:.1f} % of jumps fail, {100 * row['overloaded']:.1f} % overload a part" in words
    assert cli(["pick", str(db), "--robust", "--knee", "--alternatives", "2"]) == 2
    assert "--robust takes no --alternatives" in capsys.readouterr().err
