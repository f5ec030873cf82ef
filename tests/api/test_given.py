"""What NumPy, pandas and pathlib give is taken wherever numbers, lists, tables and names of files are."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import pareto_monoped as pm
from pareto_monoped.errors import StudyError

TINY = {"name": "tiny", "evaluations": 40, "algorithm": "random", "audit": False, "strength": False}
MOTOR = (
    "kv_rpm_per_v = 100.0\nrated_voltage_v = 48.0\nmax_continuous_current_a = 30.0\nwinding_resistance_ohm = 0.1\n"
    "[framed]\nmass_kg = 0.3\nouter_diameter_mm = 90.0\nlength_mm = 30.0\n"
)


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    return pm.run(pm.Study.define(**TINY), tmp_path_factory.mktemp("given") / "tiny.db")


@pytest.fixture
def motor(tmp_path):
    (tmp_path / "my.toml").write_text(MOTOR)
    return tmp_path / "my.toml"


KEYS = {
    "motor": lambda path: {"motor": path},
    "several motors": lambda path: {"motor": [path, "U8"]},
    "motors of the joints": lambda path: {"hip_motor": path, "knee_motor": Path("U8")},
    "calibration": lambda _: {"calibration": Path("reference")},
}


def as_text(values):
    return {
        key: [str(one) for one in given] if isinstance(given, list) else str(given) for key, given in values.items()
    }


@pytest.mark.parametrize("keys", KEYS.values(), ids=KEYS.keys())
def test_paths_and_text_name_the_same_files_in_a_study(keys, motor, tmp_path):
    values = keys(motor)
    assert pm.Study.define(**TINY, **values) == pm.Study.define(**TINY, **as_text(values))
    (tmp_path / "study.toml").write_text('name = "s"\nevaluations = 20\n')
    file = tmp_path / "study.toml"
    assert pm.Study.from_toml(file, **values) == pm.Study.from_toml(file, **as_text(values))


@pytest.mark.long
def test_a_study_runs_with_a_motor_by_its_path(motor, tmp_path):
    study = pm.Study.define(**TINY | {"evaluations": 4}, motor=motor, rules="paper")
    assert pm.run(study, tmp_path / "s.db").motors(0) == ("my", "my")


def test_a_study_says_what_to_give_in_place_of_motors_and_calibrations():
    for key in ({"motor": pm.load_motor("U8")}, {"motor": ["U10", pm.load_motor("U8")]}):
        with pytest.raises(StudyError, match=r"^study: motor: is a Motor, .* give the path of its TOML file$"):
            pm.Study.define(**TINY, **key)
    with pytest.raises(
        StudyError,
        match=r"^study: calibration: is a Calibration, .* pareto_monoped\.run\(study, db, calibration=\.\.\.\)$",
    ):
        pm.Study.define(**TINY, calibration=pm.load_calibration())


def test_a_misspelt_key_of_a_study_is_told_before_a_missing_one():
    with pytest.raises(StudyError, match=r"unknown key 'evalutions'; .* did you mean 'evaluations'\?"):
        pm.Study.define(name="x", evalutions=3)
    with pytest.raises(StudyError, match="evaluations is missing; add it"):
        pm.Study.define(name="x")


NUMPY_KEYS = {
    "objectives": (["height_m", "mass_kg"], np.array(["height_m", "mass_kg"])),
    "constraints": ({"max_mass_kg": 4.0}, {"max_mass_kg": np.int64(4)}),
    "variables": (
        {"rest_length_m": {"lower": 5.0, "upper": 10.0}},
        {"rest_length_m": pd.Series({"lower": 5, "upper": 10})},
    ),
    "motor": (["U8", "U10"], np.array(["U8", "U10"])),
    "seed": (3, np.int64(3)),
}


@pytest.mark.parametrize("key", NUMPY_KEYS)
def test_values_of_numpy_and_pandas_are_those_of_a_study(key):
    plain, given = NUMPY_KEYS[key]
    study = pm.Study.define(**TINY, **{key: given})
    assert study == pm.Study.define(**TINY, **{key: plain})
    assert repr(study) == repr(pm.Study.define(**TINY, **{key: plain}))


PICKS = {
    "weights": ([2.0, 1.0], (np.array([2, 1]), pd.Series([2, 1]), np.array([2, 1], dtype=np.float32))),
    "compromise": ([2.0, 1.0], (np.array([2.0, 1.0]), pd.Series({"height_m": 2.0, "energy_j": 1.0}))),
    "at_most": ({"mass_kg": 6.0}, (pd.Series({"mass_kg": 6.0}), {"mass_kg": np.int64(6)})),
    "nearest": ({"height_m": 0.9}, (pd.Series({"height_m": 0.9}),)),
}


@pytest.mark.parametrize("key", PICKS)
def test_a_pick_takes_arrays_and_series(key, stored):
    plain, others = PICKS[key]
    for given in others:
        assert stored.pick(**{key: given}).trial == stored.pick(**{key: plain}).trial


def test_lists_of_objectives_may_be_arrays_and_indices(stored, tmp_path):
    names = ["height_m", "mass_kg"]
    front = stored.front(names)
    for given in (np.array(names), pd.Index(names), pd.Series(names), front[names].columns):
        pd.testing.assert_frame_equal(stored.front(given), front)
        assert stored.pick("knee", objectives=given).trial == stored.pick("knee", objectives=names).trial
    goals = {"objectives": pd.Index(names), "constraints": pd.Series({"max_mass_kg": np.float32(6)})}
    study = pm.run(pm.Study.define(**TINY | {"evaluations": 4}), tmp_path / "s.db", **goals).study
    assert (study.objectives.names, study.constraints.value("max_mass_kg")) == (tuple(names), 6.0)


@pytest.mark.usefixtures("few_samples")
def test_robust_takes_a_column_of_trials(stored):
    trials = stored.front()["trial"].iloc[:2]
    known = pm.robust(stored, trials.tolist())
    assert known["trial"].tolist() == trials.tolist()
    for given in (trials, trials.to_numpy(), pd.Index(trials), trials.iloc[0]):
        pd.testing.assert_frame_equal(pm.robust(stored, given), known.iloc[: np.size(given)])


def test_formats_of_an_export_may_be_an_array(stored, tmp_path):
    with pytest.raises(pm.ParetoMonopedError, match="did you mean 'step'"):
        pm.export(pm.PAPER_CASES["C"].design, tmp_path / "c", formats=np.array(["stpe"]))
    with pytest.raises(pm.ParetoMonopedError, match="did you mean 'step'"):
        pm.export_trial(stored, 0, tmp_path / "c", formats=pd.Index(["stpe"]))


CURES = {
    "a study that is a table": (lambda _: pm.run({"name": "x"}), "must be a Study, or the path of a study file"),
    "a calibration that is a number": (
        lambda folder: pm.run(pm.Study.define(**TINY), folder / "s.db", calibration=5),
        "must be a Calibration, the name of a shipped one, or the path of a TOML file",
    ),
    "a jump model that is a number": (
        lambda _: pm.simulate(pm.PAPER_CASES["C"].design, calibration=5),
        "must be a Calibration, a name or the path of a TOML file",
    ),
    "a motor that is a number": (lambda _: pm.actuator_map(5), "must be a Motor, a name or the path of a TOML file"),
    "a report over a file of another kind": (
        lambda folder: pm.write_report(folder / "tiny.db", folder / "my.toml"),
        r"give another name, or --force \(in Python force=True\)$",
    ),
    "an export over a folder that is full": (
        lambda folder: pm.export(pm.PAPER_CASES["C"].design, folder),
        r"give another folder, or --force \(in Python force=True\) to replace an export$",
    ),
    "a database of other settings": (
        lambda folder: pm.run(pm.Study.define(**TINY, description="x", motor="U8"), folder / "tiny.db"),
        r"give another database file \(--db, in Python db=\.\.\.\) to start anew$",
    ),
}


@pytest.mark.parametrize(("call", "match"), CURES.values(), ids=CURES.keys())
def test_cures_say_what_python_takes(call, match, stored, motor):
    (motor.parent / "tiny.db").write_bytes(stored.path.read_bytes())
    with pytest.raises(pm.ParetoMonopedError, match=match) as caught:
        call(motor.parent)
    assert "\n" not in str(caught.value)
