"""Objectives, constraints and the corner of a study: what may be written, what is stored, what is refused."""

import json
from pathlib import Path

import numpy as np
import pytest

from pareto_monoped.definition import provenance
from pareto_monoped.definition.goals import Limit, constraints_of, objectives_of
from pareto_monoped.definition.study import load_study, study_from_dict
from pareto_monoped.errors import StudyError
from pareto_monoped.measures import MEASURES, measure
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY
from tests.study.support import assert_refused
from tests.study.support import study_of as made

BATTERY = ["height_m", "electrical_energy_j"]
THREE = [*BATTERY, "mass_kg"]


def digest(study):
    return provenance.digest(provenance.decisive(study, {}, {}))


@pytest.mark.parametrize(
    "same",
    [
        {"objectives": ["height_m", "energy_j"]},
        {"objectives": {"energy_j": "minimise", "height_m": "maximise"}},
        {"constraints": {"min_height_m": 0.55}},
        {"constraints": {"height_m": {"min": 0.55}}},
        {"reference_point": {"energy_j": 100}},
    ],
)
def test_what_is_the_default_is_stored_as_ever(same):
    """So the hash of a study that version 0.1.0 stored stays what it was."""
    plain = made(**same).as_dict()
    assert plain == made().as_dict()
    assert plain["objectives"] == {"height_m": "maximise", "energy_j": "minimise"}
    assert plain["reference_point"] == {"height_m": 0.55, "energy_j": 100.0}
    assert list(plain["constraints"].items()) == [
        ("min_height_m", 0.55),
        ("max_energy_j", None),
        ("max_mass_kg", None),
        ("min_foot_clearance_m", None),
    ]


@pytest.mark.parametrize("names", [BATTERY, THREE, ["energy_j", "height_m"], ["mass_kg", "drift_m", "efficiency"]])
def test_objectives_go_into_a_database_and_back(names):
    study = made(objectives=names, constraints={"drift_m": {"max": 0.1}})
    assert study.objectives.names == tuple(names)
    assert study.as_dict()["objectives"] == names
    assert study_from_dict(json.loads(json.dumps(study.as_dict())), source="db") == study
    assert digest(study) != digest(made(constraints={"drift_m": {"max": 0.1}}))
    assert list(study.reference_point.as_dict()) == names


def test_the_order_of_a_list_counts_and_that_of_a_table_does_not():
    assert digest(made(objectives=THREE)) != digest(made(objectives=THREE[::-1]))
    table = {"mass_kg": "minimise", "height_m": "maximise"}
    assert digest(made(objectives=table)) == digest(made(objectives=dict(reversed(table.items()))))


def test_both_ways_to_write_a_limit_are_one():
    new = {"mass_kg": {"max": 4}, "height_m": {"min": 0.6, "max": 1.2}, "peak_chain_tension_n": {"max": 2000.0}}
    old = {"max_mass_kg": 4.0, "min_height_m": 0.6, "max_height_m": 1.2, "max_peak_chain_tension_n": 2000.0}
    assert constraints_of(new) == constraints_of(old)
    stored = made(constraints=new).as_dict()["constraints"]
    assert {key: value for key, value in stored.items() if value is not None} == old
    assert digest(made(constraints=new)) == digest(made(constraints=old))


def test_limits_are_judged_in_the_order_of_0_1_0():
    """Violations are summed in it, to the last bit, and Optuna's tables have the constraints in it."""
    limits = constraints_of(
        {"foot_clearance_m": {"min": 0.02}, "drift_m": {"max": 0.1}, "mass_kg": {"max": 4.0}}
    ).limits
    assert [limit.key for limit in limits] == ["min_height_m", "max_mass_kg", "min_foot_clearance_m", "max_drift_m"]


def test_every_measure_can_be_limited_on_either_side():
    for entry in MEASURES:
        limits = constraints_of({entry.name: {"min": 0.6, "max": 0.7}}).limits
        mine = sorted((limit.side, limit.value) for limit in limits if limit.measure == entry.name)
        assert mine == [("max", 0.7), ("min", 0.6)]


def test_the_default_search_is_the_same_for_two_and_three_objectives():
    assert made(objectives=BATTERY).algorithm.name == "surrogate"
    assert made(objectives=THREE).algorithm.name == "surrogate"
    assert made(objectives=THREE, algorithm={"name": "nsga2"}).algorithm.name == "nsga2"


def test_other_objectives_can_be_given_in_place_of_the_files(tmp_path):
    path = tmp_path / "s.toml"
    path.write_text('name = "s"\nevaluations = 5\n[reference_point]\nheight_m = 0.6\nenergy_j = 80.0\n')
    study = load_study(path, objectives=BATTERY)
    assert study.objectives.names == tuple(BATTERY)
    assert study.reference_point.as_dict() == {"height_m": 0.6, "electrical_energy_j": 200.0}
    assert load_study(path).objectives == HEIGHT_AND_ENERGY


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"objectives": ["height_m", "electric_energy_j"]}, ["'electric_energy_j'", "mean 'electrical_energy_j'"]),
        (
            {"objectives": ["height_m", "qqq"]},
            ["'qqq' is not a measure", "; the nearest are "],
        ),
        ({"objectives": ["height_m", "apex_s"]}, ["'apex_s' has no direction"]),
        ({"objectives": ["height_m", "height_m"]}, ["'height_m' is named twice"]),
        ({"objectives": ["height_m"]}, ["number of objectives = 1: must be two or three"]),
        ({"objectives": [*THREE, "drift_m"]}, ["number of objectives = 4: must be two or three"]),
        ({"objectives": []}, ["number of objectives = 0"]),
        ({"objectives": "height_m"}, ["objectives = 'height_m'", "list of two or three"]),
        ({"objectives": 3}, ["objectives = 3"]),
        ({"objectives": [1, 2]}, ["1 is not a measure"]),
        ({"objectives": {"height_m": "maximise", "mass_kg": "maximise"}}, ["objectives.mass_kg", "'minimise'"]),
        ({"constraints": {"mass_kgs": {"max": 4.0}}}, ["constraints.mass_kgs", "mean 'mass_kg'"]),
        ({"constraints": {"max_mass": 4.0}}, ["constraints.max_mass", "mean 'mass_kg'"]),
        ({"constraints": {"mass_kg": 4.0}}, ["constraints.mass_kg = 4.0", "min, max or both"]),
        ({"constraints": {"mass_kg": {}}}, ["constraints.mass_kg = {}"]),
        ({"constraints": {"mass_kg": {"most": 4.0}}}, ["constraints.mass_kg", "'most'"]),
        ({"constraints": {"mass_kg": {"max": "4"}}}, ["constraints.mass_kg.max = '4': must be a number above 0;"]),
        ({"constraints": {"mass_kg": {"max": True}}}, ["constraints.mass_kg.max = True"]),
        ({"constraints": {"mass_kg": {"max": 0.0}}}, ["constraints.mass_kg.max = 0.0", "above 0"]),
        ({"constraints": {"mass_kg": {"max": float("inf")}}}, ["constraints.mass_kg.max = inf"]),
        ({"constraints": {"max_mass_kg": -1.0}}, ["constraints.max_mass_kg = -1.0: must be a number above 0;"]),
        (
            {"constraints": {"height_m": {"min": 0.3}}},
            ["constraints.height_m.min = 0.3: must be a number from 0.5 to 10;"],
        ),
        ({"constraints": {"foot_clearance_m": {"min": 11}}}, ["must be a number from 0 to 10, above 0;"]),
        ({"constraints": {"mass_kg": {"max": 4.0}, "max_mass_kg": 5.0}}, ["constraints.mass_kg", "given twice"]),
        ({"constraints": {"mass_kg": {"min": 5.0, "max": 4.0}}}, ["min = 5, max = 4", "must not exceed"]),
        ({"constraints": {"height_m": {"max": 0.5}}}, ["constraints.height_m", "min = 0.55, max = 0.5"]),
        ({"reference_point": {"mass_kg": 5.0}}, ["reference_point", "'mass_kg'", "height_m, energy_j"]),
        ({"reference_point": {"energy_j": 0.0}}, ["reference_point.energy_j = 0.0", "above 0"]),
        ({"objectives": THREE, "algorithm": {"name": "weighted_cmaes"}}, ["weighs two, 3 are named"]),
        (
            {"objectives": ["height_m", "efficiency"], "algorithm": {"name": "weighted_cmaes"}},
            ["reference_point.efficiency = 0", "give a number above 0"],
        ),
    ],
)
def test_what_cannot_be_is_one_line_that_says_what_can(change, words):
    assert_refused(change, words)


def test_without_a_choice_they_are_the_papers():
    assert objectives_of(None) == HEIGHT_AND_ENERGY


@pytest.mark.parametrize("name", ["watts", "qqq", ""])
def test_an_unknown_objective_without_a_near_match_does_not_list_all_measures(name):
    """The line had 39 names."""
    with pytest.raises(StudyError) as caught:
        made(objectives=["height_m", name])
    message = str(caught.value)
    few, _, place = message.partition("the nearest are ")[2].partition("; ")
    assert [measure(one).direction is None for one in few.split(", ")] == [False] * 3
    assert place.startswith("docs/reference/measures.md")
    assert (Path(__file__).parents[2] / "docs/reference/measures.md").exists()


@pytest.mark.parametrize(
    ("side", "limit", "expected"),
    [
        ("max", 4.0, [-0.5, 0.0, 0.5]),
        ("min", 4.0, [0.5, 0.0, -0.5]),
        # Own measures may be negative: beyond a limit of -4 is -2 where -4 is the most, and -6 where it is the least.
        ("max", -4.0, [-0.5, 0.0, 0.5]),
        ("min", -4.0, [0.5, 0.0, -0.5]),
        ("max", 0.0, [-2.0, 0.0, 2.0]),
        ("min", 0.0, [2.0, 0.0, -2.0]),
    ],
)
def test_how_far_a_value_is_beyond_a_limit(side, limit, expected):
    values = np.array([limit - 2.0, limit, limit + 2.0])
    assert Limit(measure="own.x", side=side, value=limit).shares(values).tolist() == expected
