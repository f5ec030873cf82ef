import json
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.definition.algorithms import ALGORITHMS
from pareto_monoped.definition.study import Study, is_opened, load_study, open_up, study_from_dict
from pareto_monoped.definition.variables import OPENED, Bounds, number_of
from pareto_monoped.design import DEFAULTS, LENGTHS, LOWER, PAPER_CASES, PAPER_CONTROL, PAPER_NAMES, UPPER
from pareto_monoped.errors import InputError, StudyError
from pareto_monoped.jump import calibration_defaults
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from tests.study.support import assert_refused
from tests.study.support import study_of as made

SHIPPED = sorted((Path(__file__).parents[2] / "studies").glob("*.toml"))


def test_the_defaults_are_case_c_with_the_papers_bounds():
    study = made()
    assert study.free == PAPER_NAMES
    assert np.array_equal(study.lower[: len(LOWER)], LOWER)
    assert np.array_equal(study.upper[: len(UPPER)], UPPER)
    assert study.constraints.value("min_height_m") == 0.55
    assert study.algorithm.name == "surrogate"
    assert (study.motor, study.calibration) == ("VT8020", "reference")
    assert study.reference_point.as_dict() == {"height_m": 0.55, "energy_j": 100.0}
    assert (study.stop.wall_time_s, study.stop.plateau_evaluations, study.stop.plateau_growth) == (None, None, 0.001)
    assert study.audit is True


def test_the_defaults_of_the_algorithms():
    evolution = made(algorithm={"name": "sms_emoa"}).algorithm
    assert evolution.population == 40
    assert (evolution.crossover_probability, evolution.crossover_eta, evolution.mutation_eta) == (0.9, 15.0, 20.0)
    weighted = made(algorithm={"name": "weighted_cmaes"}).algorithm
    assert (weighted.population, weighted.sigma, weighted.iterations) == (8, 0.1, 200)
    assert made(algorithm={"name": "random"}).algorithm.population == 40
    assert [made(algorithm={"name": f"optuna_{kind}"}).algorithm.batch for kind in ("nsga2", "tpe")] == [50, 8]


@pytest.mark.parametrize(
    ("case", "fixed"),
    [
        ("A", {"thigh_length_m": 0.4, "shank_length_m": 0.4}),
        ("B", {"knee_ratio": 6.0, "hip_ratio": 6.0}),
        ("C", {}),
    ],
)
def test_a_case_fixes_what_the_paper_fixed(case, fixed):
    study = made(case=case)
    assert {name: v for name, v in study.variables.items() if not isinstance(v, Bounds)} == fixed | DEFAULTS
    assert study.free == tuple(name for name in PAPER_NAMES if name not in fixed)


def test_bounds_and_fixed_values_override_the_case():
    study = made(case="A", variables={"thigh_length_m": {"lower": 0.35, "upper": 0.45}, "hip_ratio": 4})
    assert study.variables["thigh_length_m"] == Bounds(lower=0.35, upper=0.45)
    assert study.variables["hip_ratio"] == 4.0
    assert study.variables["shank_length_m"] == 0.4


def test_limits_that_are_off_and_came_later_are_not_stored():
    """A study without them keeps the hash that it had before there were any."""
    assert set(made().as_dict()["constraints"]) == {
        "min_height_m",
        "max_energy_j",
        "max_mass_kg",
        "min_foot_clearance_m",
    }
    limited = made(constraints={"max_drift_m": 0.1})
    assert limited.as_dict()["constraints"]["max_drift_m"] == 0.1
    assert study_from_dict(limited.as_dict(), source="db") == limited


def test_the_rules_paper_are_not_stored_and_others_are():
    """A study stored before there were rules is one of the rules ``paper``, and keeps its hash."""
    assert made().rules == "paper"
    assert "rules" not in made().as_dict()
    assert made(rules="paper") == made()
    rated = made(rules="iso6336")
    assert rated.as_dict()["rules"] == "iso6336"
    assert study_from_dict(json.loads(json.dumps(rated.as_dict())), source="db") == rated


def test_a_file_without_rules_takes_the_default_but_a_stored_study_does_not(tmp_path, monkeypatch):
    """What happens when the default changes: the calibration ``paper`` keeps its rules, as stored studies do."""
    monkeypatch.setattr(calibration_defaults, "DEFAULT_RULES", "iso6336")
    path = tmp_path / "s.toml"
    path.write_text('name = "s"\nevaluations = 5\n')
    assert load_study(path).rules == "iso6336"
    path.write_text('name = "s"\nevaluations = 5\ncalibration = "paper"\n')
    assert load_study(path).rules == "paper"
    assert made().rules == "paper"


@pytest.mark.parametrize("name", ALGORITHMS)
def test_plain_values_and_back(name):
    study = made(
        case="B", algorithm={"name": name}, seed=2**60, stop={"wall_time_s": 3.5}, variables={"hip_ratio": 5.0}
    )
    assert study_from_dict(json.loads(json.dumps(study.as_dict())), source="db") == study


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"evaluation": 3}, ["'evaluation'", "did you mean 'evaluations'"]),
        ({"evaluations": 0}, ["evaluations = 0", "must be at least 1"]),
        ({"evaluations": "many"}, ["evaluations = 'many'", "whole number"]),
        ({"name": ""}, ["name = ''", "at least one letter"]),
        ({"case": "D"}, ["case = 'D'", "'A', 'B' or 'C'"]),
        ({"seed": -1}, ["seed = -1"]),
        ({"rules": "agma"}, ["rules = 'agma'", "'paper' or 'iso6336'"]),
        ({"rules": "iso6336", "calibration": "paper"}, ["rules = 'iso6336'", "'paper' with the calibration"]),
        ({"variables": {"K": 5}}, ["'K'", "stiffness_n_per_m"]),
        ({"variables": {"knee_ratio": "big"}}, ["variables.knee_ratio = 'big'", "1 to 100"]),
        ({"variables": {"knee_ratio": (5, 7)}}, ["knee_ratio = (5, 7)", 'a range such as {"lower": 4, "upper": 8.7};']),
        ({"variables": {"knee_ratio": True}}, ["variables.knee_ratio = True"]),
        ({"variables": {"knee_ratio": float("nan")}}, ["variables.knee_ratio = nan"]),
        ({"variables": {"knee_ratio": {"lower": 5.0}}}, ["variables.knee_ratio", "lower and upper"]),
        ({"variables": {"knee_ratio": {"lower": 5.0, "upper": 5.0}}}, ["lower = 5, upper = 5", "below"]),
        ({"variables": {"knee_ratio": {"lower": 0.5, "upper": 5.0}}}, ["variables.knee_ratio.lower = 0.5"]),
        ({"variables": {"damping_n_s_per_m": -1.0}}, ["damping_n_s_per_m = -1.0", "from 0"]),
        (
            {"variables": {"thigh_length_m": 0.2, "shank_length_m": {"lower": 0.1, "upper": 0.3}}},
            ["thigh_length_m + shank_length_m = 0.5", "0.5 m", "longer links"],
        ),
        ({"variables": dict.fromkeys(PAPER_NAMES, 5.0) | dict.fromkeys(LENGTHS, 0.4)}, ["all are fixed"]),
        ({"objectives": {"height_m": "minimise"}}, ["objectives.height_m = 'minimise'", "'maximise'"]),
        ({"constraints": {"min_height": 0.6}}, ["constraints.min_height"]),
        ({"constraints": {"min_height_m": 0.2}}, ["constraints.min_height_m = 0.2", "0.5"]),
        ({"stop": {"wall_time_s": 0}}, ["stop.wall_time_s = 0"]),
        ({"algorithm": {"name": "nsga3"}}, ["algorithm.name = 'nsga3'", "nsga2", "weighted_cmaes"]),
        ({"algorithm": {"population": 8}}, ["algorithm.name = None"]),
        ({"algorithm": {"name": "nsga2", "pop": 8}}, ["'pop'", "population"]),
        ({"algorithm": {"name": "nsga2", "population": 7}}, ["population = 7", "multiple of 2"]),
        ({"algorithm": {"name": "nsga2", "sigma": 0.1}}, ["'sigma'"]),
        ({"algorithm": {"name": "weighted_cmaes", "height_weights": []}}, ["height_weights"]),
        ({"algorithm": {"name": "weighted_cmaes", "height_weights": [1.5]}}, ["height_weights.0 = 1.5"]),
        ({"algorithm": {"name": "weighted_cmaes", "start": {"k": 1.0}}}, ["algorithm.start", "'k'"]),
    ],
)
def test_what_cannot_be_names_its_key_and_what_is_allowed(change, words):
    assert_refused(change, words)


def test_missing_keys_are_named():
    with pytest.raises(StudyError, match="evaluations is missing"):
        study_from_dict({"name": "s"}, source="s")


def test_a_file_that_is_no_toml_is_refused(tmp_path):
    path = tmp_path / "s.toml"
    path.write_text("name = = 3")
    with pytest.raises(StudyError, match="not valid TOML"):
        load_study(path)
    with pytest.raises(StudyError, match="no such file"):
        load_study(tmp_path / "t.toml")


def test_a_users_motor_file_is_found_beside_the_study(tmp_path):
    path = tmp_path / "s.toml"
    path.write_text('name = "s"\nevaluations = 5\nmotor = "mine.toml"\n')
    assert load_study(path).motor == str((tmp_path / "mine.toml").resolve())


def test_budget_and_seed_can_be_given_in_place_of_the_files(tmp_path):
    path = tmp_path / "s.toml"
    path.write_text('name = "s"\nevaluations = 5\n')
    study = load_study(path, evaluations=7, seed=9)
    assert (study.evaluations, study.seed) == (7, 9)


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_shipped_studies_are_sound(path):
    study = load_study(path)
    assert study.name == path.stem
    assert study.description


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"motor": "VT8021"}, "study: motor = 'VT8021': must be one of VT8020, .*did you mean 'VT8020'"),
        ({"motor": "V"}, "study: motor = 'V': must be one of VT8020"),
        ({"motor": "V" * 1000}, "study: motor = 'V+[.]*'?: must be one of VT8020"),
        ({"motor": "V" * 1001}, "of at most 1000 letters"),
        ({"motor": ""}, "of at most 1000 letters"),
        ({"motor": ["U8", "U9"]}, "study: motor = 'U9'"),
        ({"hip_motor": "U8", "knee_motor": "VT8021"}, "study: knee_motor = 'VT8021'"),
        ({"calibration": "referense"}, "study: calibration = 'referense': .*did you mean 'reference'"),
    ],
)
def test_unknown_names_are_refused_when_a_study_is_defined(changes, words):
    """A motor that does not exist was refused only when the study ran."""
    with pytest.raises(InputError, match=words):
        Study.define(name="mine", evaluations=10, **changes)


def test_each_motor_of_the_hip_is_paired_with_each_of_the_knee():
    study = made(hip_motor=["U8", "U12"], knee_motor=["VT8020", "U8"])
    assert study.kits == (("U8", "VT8020"), ("U8", "U8"), ("U12", "VT8020"), ("U12", "U8"))
    assert made(hip_motor="U8", knee_motor="U12").kits == (("U8", "U12"),)
    assert made(motor=["U8", "U12"]).kits == (("U8", "U8"), ("U12", "U12"))


def test_files_and_names_of_a_program_are_found_only_when_a_study_runs():
    study = Study.define(name="mine", evaluations=10, motor="not_yet.toml", calibration="own:mine")
    assert (study.motor, study.calibration) == ("not_yet.toml", "own:mine")


def test_a_stored_study_keeps_a_name_that_is_unknown_by_now():
    values = Study.define(name="mine", evaluations=10).as_dict() | {"motor": "VT7000", "calibration": "older"}
    assert study_from_dict(values, source="database").motor == "VT7000"


def test_the_same_limit_with_a_dot_and_as_a_table_is_refused():
    with pytest.raises(InputError, match=r"height_m\.p05: is given twice"):
        Study.define(
            name="mine",
            evaluations=10,
            constraints={"height_m.p05": {"min": 0.6}, "height_m": {"p05": {"min": 0.7}}},
        )


@pytest.mark.parametrize("name", ["stiffness_n_per_m", "damping_n_s_per_m"])
def test_gains_of_the_controller_may_be_any_number_from_0_to_a_million(name):
    assert [number_of("fixed", name, given) for given in (0, 9.5e5, 1e6)] == [0.0, 9.5e5, 1e6]
    for given in (-1e-9, 1.0001e6):
        with pytest.raises(StudyError, match="a number from 0 to 1e\\+06"):
            number_of("fixed", name, given)


def test_an_opened_study_frees_what_it_leaves_out_and_keeps_what_it_says(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(
        'name = "mine"\nevaluations = 40\n[variables]\nknee_release_rad = 0.0\nstart_height_m = 0.45\n'
        "damping_n_s_per_m = { lower = 0.0, upper = 10.0 }\nstiffness_n_per_m = 7.0\n"
    )
    plain, opened = (load_study(path, opened=value) for value in (False, True))
    changed = {name: value for name, value in opened.variables.items() if value != plain.variables[name]}
    assert changed == {
        "rest_length_m": Bounds(lower=1.0, upper=20.0),
        "torsional_stiffness_n_m_per_rad": Bounds(lower=0.0, upper=200.0),
    }
    assert opened.name == "mine with more variables free"
    assert study_from_dict(opened.as_dict(), source="stored") == opened
    assert is_opened(opened, plain)
    assert not is_opened(plain, opened)
    assert not is_opened(plain, plain)


def test_the_gains_of_an_opened_study_are_those_of_the_wide_one():
    wide, opened = load_study(SHIPPED[0].with_name("wide.toml")), open_up(made(case="A"))
    assert {name: wide.variables[name] for name in PAPER_CONTROL} == {n: opened.variables[n] for n in PAPER_CONTROL}
    assert set(opened.free) == {*PAPER_NAMES, *DEFAULTS} - {*LENGTHS, "start_height_m"}


@pytest.mark.parametrize(
    "table",
    [
        "\n".join(["[variables]", *(f"{name} = 8.0" for name in OPENED[1:]), "knee_release_rad = 0.1"]),
        '[controller]\nkind = "torque_over_time"\nknots = 3\n',
    ],
)
def test_a_study_that_leaves_nothing_to_open_is_refused(tmp_path, table):
    """It names everything itself, or its law reads nothing of it."""
    path = tmp_path / "mine.toml"
    path.write_text(f'name = "mine"\nevaluations = 40\n{table}')
    line = r"^study file '.*mine\.toml': variables left to open = none: must be .*knee_release_rad, .*; leave it out.*$"
    with pytest.raises(StudyError, match=line):
        load_study(path, opened=True)
    with pytest.raises(StudyError, match=r"^study: variables left to open"):
        open_up(open_up(made(case="A")))


@pytest.mark.parametrize(("calibration", "acts"), [("paper", False), ("reference", True)])
def test_a_release_before_a_stop_is_opened_only_where_there_is_a_stop(calibration, acts):
    study = open_up(made(calibration=calibration))
    assert ("knee_release_rad" in study.free) == acts
    assert "rest_length_m" in study.free
    case = PAPER_CASES["C"].design
    rules = "paper" if calibration == "paper" else "iso6336"
    evaluate = Evaluator(map_for("VT8020", rules), load_calibration(calibration))
    plain, released = evaluate(np.array([case.as_array(), case.replace({"knee_release_rad": 0.5}).as_array()])).of(
        "height_m"
    )
    assert (plain != released) == acts


def test_designs_at_the_bounds_of_an_opened_study_jump():
    """Each bound alone on the design of Case C, by the evaluator, which knows nothing of studies.

    0.5 N/m over 10 m and 7.9 N/m over 1 m of spring push less than the robot weighs.
    """
    opened, case = open_up(made()), PAPER_CASES["C"].design
    ends = [(name, value) for name in OPENED for value in asdict(opened.variables[name]).values()]
    designs = [case, *(case.replace({name: value}) for name, value in ends)]
    jumps = Evaluator(map_for("VT8020"), load_calibration())(np.array([one.as_array() for one in designs]))
    height = jumps.of("height_m")
    fallen = {end for end, one in zip(ends, height[1:], strict=True) if np.isnan(one)}
    assert fallen == {("stiffness_n_per_m", 0.5), ("rest_length_m", 1.0)}
    same = {end for end, one in zip(ends, height[1:], strict=True) if one == height[0]}
    assert same == {end for end, one in zip(ends, designs[1:], strict=True) if one == case}
