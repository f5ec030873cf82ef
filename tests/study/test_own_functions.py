"""Own objectives and constraints of a stored study: values are stored, functions never."""

import shutil
import sqlite3

import numpy as np
import pandas as pd
import pytest

import pareto_monoped as pm
from pareto_monoped.analysis.verify import verify
from pareto_monoped.cli import _run as cli
from pareto_monoped.definition.goals import Limit
from pareto_monoped.errors import StudyError
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.own_functions import Jumps, called, functions_of

STUDY = {
    "name": "own",
    "evaluations": 60,
    "algorithm": {"name": "nsga2", "population": 20},
    "audit": False,
    "strength": False,
}


def load_factor(jumps):
    return jumps["peak_foot_force_n"] / (9.81 * jumps["mass_kg"])


def slides(jumps):
    return abs(jumps["drift_m"]) - 0.22 * jumps["thigh_length_m"]


GOALS = {"objectives": ["height_m", load_factor], "constraints": [{"mass_kg": {"max": 5.5}}, slides]}


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    return pm.run(pm.Study.define(**STUDY), tmp_path_factory.mktemp("own") / "own.db", **GOALS)


@pytest.fixture(scope="module")
def half_once(tmp_path_factory):
    return pm.run(pm.Study.define(**STUDY), tmp_path_factory.mktemp("half") / "half.db", evaluations=30, **GOALS).path


@pytest.fixture
def half(half_once, tmp_path):
    """A study that has 30 of its 60 trials: one and a half generations."""
    return shutil.copy(half_once, tmp_path / "half.db")


def test_every_trial_stores_what_the_functions_make_of_it(stored):
    trials = stored.trials
    ok = (trials["status"] == "ok").to_numpy()
    assert ok.sum() > 30
    for function in (load_factor, slides):
        values = trials[f"own_{function.__name__}"].to_numpy()
        np.testing.assert_allclose(values[ok], function(trials)[ok], rtol=1e-12)
        assert np.isnan(values[~ok]).all()
    held = trials[trials["state"] == "feasible"]
    assert len(held)
    assert (held["own_slides"] <= 0.0).all()
    missed = trials[ok & (trials["own_slides"] > 0.0)]
    assert (missed["state"] == "infeasible").all()
    assert missed["reason"].str.contains("own_slides").all()


def test_less_of_an_own_objective_is_better_on_the_front(stored):
    front = stored.front()
    assert len(front) > 1
    assert (np.diff(front["height_m"]) > 0.0).all()
    assert (np.diff(front["own_load_factor"]) > 0.0).all()
    feasible = stored.trials[stored.trials["state"] == "feasible"]
    ends = (feasible["own_load_factor"].min(), feasible["height_m"].max())
    assert (front["own_load_factor"].iloc[0], front["height_m"].iloc[-1]) == ends


def test_a_study_goes_on_with_its_functions_as_if_it_had_not_stopped(stored, half):
    again = pm.resume(half, evaluations=60, functions=[load_factor, slides])
    pd.testing.assert_frame_equal(again.trials, stored.trials, check_exact=True)
    assert again.data.meta.hash == stored.data.meta.hash


def test_the_same_call_goes_on_too(stored, half):
    again = pm.run(pm.Study.define(**STUDY), half, **GOALS)
    pd.testing.assert_frame_equal(again.trials, stored.trials, check_exact=True)


def test_the_database_holds_no_code(stored):
    """Only text and numbers, of which none is a pickle or source."""
    connection = sqlite3.connect(stored.path)
    tables = [name for (name,) in connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")]
    cells = [cell for table in tables for row in connection.execute(f"SELECT * FROM {table}") for cell in row]
    connection.close()
    assert not any(isinstance(cell, bytes) for cell in cells)
    assert not any(isinstance(cell, str) and ("def " in cell or "lambda" in cell) for cell in cells)


def test_without_its_functions_a_study_does_not_go_on(half, capsys):
    before = half.read_bytes()
    with pytest.raises(StudyError, match=r"needs load_factor, slides, .*functions=\[load_factor, slides\]"):
        pm.resume(half, evaluations=60)
    with pytest.raises(StudyError, match="needs slides,"):
        pm.resume(half, evaluations=60, functions=[load_factor])
    assert cli(["resume", str(half), "--evaluations", "60"]) == 2
    message = capsys.readouterr().err
    assert "pareto_monoped.resume(db, functions=[load_factor, slides])" in message
    assert message.count("\n") == 1
    assert half.read_bytes() == before


def test_a_function_that_the_study_does_not_know_is_refused(half):
    def stranger(jumps):
        return jumps["mass_kg"]

    with pytest.raises(StudyError, match="knows no own function 'stranger'; it has load_factor, slides"):
        pm.resume(half, evaluations=60, functions=[load_factor, slides, stranger])


def test_a_function_that_has_changed_is_refused(half):
    def changed(jumps):
        return 1.0001 * load_factor(jumps)

    changed.__name__ = "load_factor"
    before = half.read_bytes()
    with pytest.raises(StudyError, match=r"own function 'load_factor' gives .* where .* is stored"):
        pm.resume(half, evaluations=60, functions=[changed, slides])
    assert half.read_bytes() == before


def test_commands_read_pick_check_and_report_such_a_study(stored, tmp_path, capsys):
    db = str(stored.path)
    assert cli(["front", db]) == 0
    assert cli(["pick", db, "--knee"]) == 0
    assert "load factor" in capsys.readouterr().out
    assert cli(["pick", db, "--max", f"own_load_factor={stored.front()['own_load_factor'].max()}"]) == 0
    assert cli(["status", db]) == 0
    assert "max_own_slides 0" in capsys.readouterr().out
    assert verify(stored.path, simulate=5).findings == ()
    assert cli(["report", db, "-o", str(tmp_path / "own.html")]) == 0
    assert "load factor" in (tmp_path / "own.html").read_text(encoding="utf-8")


def test_a_pick_may_have_conditions_on_own_measures(stored):
    front = stored.front()
    middle = front["own_load_factor"].median()
    picked = stored.pick(at_most={"own_load_factor": middle})
    assert picked.row["height_m"] == front[front["own_load_factor"] <= middle]["height_m"].max()


def test_a_damaged_own_value_is_noticed(stored, tmp_path):
    copy = tmp_path / "copy.db"
    copy.write_bytes(stored.path.read_bytes())
    connection = sqlite3.connect(copy)
    connection.execute("UPDATE monoped_trials SET own_slides = own_slides + 1e-6 WHERE trial = 7")
    connection.commit()
    connection.close()
    with pytest.raises(pm.ParetoMonopedError, match="trial 7 does not match its hash"):
        read_study(copy)


def test_an_own_constraint_may_have_any_limit():
    study = pm.Study.define(name="s", evaluations=10, constraints={"own_lean": {"min": -0.5, "max": 0.0}})
    limits = {limit.key: limit.value for limit in study.constraints.limits}
    assert (limits["min_own_lean"], limits["max_own_lean"]) == (-0.5, 0.0)
    assert study == pm.Study.define(**study.as_dict())
    shares = Limit(measure="own_lean", side="min", value=-0.5).shares(np.array([-1.0, -0.5, 0.0]))
    np.testing.assert_allclose(shares, [1.0, 0.0, -1.0])
    np.testing.assert_allclose(
        Limit(measure="own_lean", side="max", value=0.0).shares(np.array([-2.0, 0.3])), [-2, 0.3]
    )


@pytest.mark.parametrize("limit", [True, "much", float("nan"), float("inf"), 10**400])
def test_a_limit_that_is_no_number_is_refused(limit):
    with pytest.raises(StudyError, match="finite number"):
        pm.Study.define(name="s", evaluations=10, constraints={"own_lean": {"max": limit}})


def test_a_corner_of_an_own_objective_may_be_given():
    keys = {"name": "s", "evaluations": 10, "objectives": ["height_m", "own_lean"]}
    assert pm.Study.define(**keys).reference_point.values == (0.55, 1000.0)
    assert pm.Study.define(**keys, reference_point={"own_lean": -2.0}).reference_point.values == (0.55, -2.0)


def test_names_that_cannot_be_stored_are_refused():
    def lean(jumps):
        return jumps["mass_kg"]

    def Lean(jumps):  # noqa: N802
        return jumps["mass_kg"]

    assert list(functions_of([lean, lean])) == ["own_lean"]
    for two in ([lean, Lean], [Lean, lean]):
        with pytest.raises(StudyError, match="name of two functions"):
            functions_of(two)
    for function in (lambda jumps: jumps["mass_kg"], np.float64, 5, None):
        with pytest.raises(StudyError) as caught:
            functions_of([function])
        assert "\n" not in str(caught.value)


def test_an_unknown_measure_is_named_with_the_nearest():
    def mistyped(jumps):
        return jumps["hight_m"]

    table = Jumps({"height_m": np.ones(2)})
    with pytest.raises(StudyError, match=r"own function 'mistyped': jumps: 'hight_m' is .* did you mean 'height_m'\?"):
        called(mistyped, table, np.zeros(2, dtype=bool))


SLIPS = {
    "truths": (
        lambda jumps: jumps["drift_m"] < 0.3,
        "own function '<lambda>' = bool: must return numbers; a constraint holds where its value is <= 0",
    ),
    "a list of truths": (lambda jumps: [True, False], "= bool: must return numbers;"),
    "truths of pandas": (lambda jumps: pd.array([True, False], dtype="boolean"), "= bool: must return numbers;"),
    "an attribute": (lambda jumps: jumps.drift - 0.3, 'take measures by name: jumps["drift_m"]'),
    "an attribute like none": (lambda jumps: jumps.zzz, 'take measures by name: jumps["height_m"]'),
    "a condition": (lambda jumps: jumps["drift_m"] if jumps["drift_m"] > 0.0 else 0.0, "use numpy.where instead of if"),
    "words": (lambda jumps: ["long", "short"], "it must return 2 numbers"),
}


@pytest.mark.parametrize(("function", "words"), SLIPS.values(), ids=SLIPS.keys())
def test_a_slip_in_a_function_is_told_in_one_line(function, words):
    table = Jumps({"height_m": np.ones(2), "drift_m": np.array([0.1, 0.5])})
    with pytest.raises(StudyError) as caught:
        called(function, table, np.zeros(2, dtype=bool))
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_function_cannot_change_the_jumps():
    def greedy(jumps):
        jumps["height_m"] += 1.0
        return jumps["height_m"]

    table = Jumps({"height_m": np.ones(2)})
    called(greedy, table, np.zeros(2, dtype=bool))
    np.testing.assert_array_equal(table["height_m"], [1.0, 1.0])


def test_a_study_that_names_own_functions_is_no_problem_for_optimisers_outside():
    study = pm.Study.define(name="s", evaluations=10, objectives=["height_m", "own_lean"])
    with pytest.raises(StudyError, match="names the own function 'own_lean'"):
        pm.MonopedProblem(study)


def test_own_limits_in_another_order_are_the_same_study(tmp_path):
    """The surrogate's model had one function's values among the other's."""
    study = pm.Study.define(**STUDY | {"algorithm": {"name": "surrogate", "population": 8}})

    def light(jumps):
        return jumps["mass_kg"] - 5.2

    whole = pm.run(study, tmp_path / "whole.db", constraints=[light, slides], workers=1)
    pm.run(study, tmp_path / "parts.db", constraints=[light, slides], evaluations=32, workers=1)
    parts = pm.run(study, tmp_path / "parts.db", constraints=[slides, light], workers=1)
    assert parts.study.constraints == whole.study.constraints
    pd.testing.assert_frame_equal(parts.trials, whole.trials)


class Taste:
    def heavy(self, jumps):
        return jumps["mass_kg"]


def test_a_method_may_be_given_twice():
    one, other = Taste(), Taste()
    assert functions_of([one.heavy, one.heavy]) == {"own_heavy": one.heavy}
    with pytest.raises(StudyError, match="is the name of two functions"):
        functions_of([one.heavy, other.heavy])


@pytest.mark.parametrize("kind", [complex, str])
def test_values_that_are_not_real_numbers_are_refused(kind):
    def odd(jumps):
        return jumps["mass_kg"].astype(kind)

    table = Jumps({"mass_kg": np.array([4.0, 5.0])})
    with pytest.raises(StudyError, match=r"own function 'odd': returns .*; it must return 2 numbers"):
        called(odd, table, np.zeros(2, dtype=bool))


@pytest.mark.parametrize(
    "constraints",
    [
        {"mass_kg": {"max": 4.0}, "max_mass_kg": 5.0},
        [{"max_mass_kg": 5.0}, {"mass_kg": {"max": 4.0}}],
        [{"mass_kg": {"max": 4.0}}, {"mass_kg": {"min": 1.0, "max": 4.0}}],
    ],
)
def test_one_limit_in_two_spellings_is_refused(constraints, tmp_path):
    """The last one was taken without a word."""
    with pytest.raises(StudyError, match=r"^constraints: the max of mass_kg is given twice; drop one$"):
        pm.run(pm.Study.define(name="s", evaluations=10), tmp_path / "s.db", constraints=constraints)
    assert list(tmp_path.iterdir()) == []


MIXING = {
    "the mean": lambda jumps: np.nanmean(jumps["height_m"]) - jumps["height_m"],
    "the last": lambda jumps: jumps["mass_kg"] - jumps["mass_kg"][-1],
    "those before": lambda jumps: np.nancumsum(jumps["mass_kg"]),
    "places": lambda jumps: np.argsort(np.argsort(-jumps["mass_kg"])),
}


@pytest.mark.parametrize("mixing", MIXING.values(), ids=MIXING.keys())
def test_a_function_that_mixes_jumps_is_refused_in_the_first_generation(mixing, tmp_path):
    mixing.__name__ = "mixing"
    words = (
        r"^own function 'mixing': gives \S+ for a jump among \d+ and \S+ for the same jump alone; compute each value"
    )
    with pytest.raises(StudyError, match=words) as caught:
        pm.run(pm.Study.define(**STUDY), tmp_path / "s.db", objectives=["height_m", mixing])
    assert "\n" not in str(caught.value)
    assert len(pm.load_study(tmp_path / "s.db").trials) == 0


def test_functions_are_asked_of_single_jumps_in_the_first_generation_only(tmp_path):
    counts = []

    def counting(jumps):
        counts.append(len(jumps["mass_kg"]))
        return jumps["mass_kg"] - 5.0

    pm.run(pm.Study.define(**STUDY), tmp_path / "s.db", constraints=counting)
    assert counts == [20, 1, 1, 20, 20]
