import pytest

from pareto_monoped.definition.provenance import decisive, differences, digest, versions
from tests.study.support import CONTENTS, made_study


def hashed(study, contents=CONTENTS, package_versions=None):
    return digest(decisive(study, contents, package_versions or versions(study)))


def test_the_hash_does_not_depend_on_the_order_of_keys():
    assert digest({"a": 1, "b": [2.5]}) == digest({"b": [2.5], "a": 1})


@pytest.mark.parametrize(
    "change",
    [
        {"seed": 2},
        {"case": "A"},
        {"variables": {"hip_ratio": {"lower": 4.0, "upper": 8.0}}},
        {"constraints": {"min_height_m": 0.6}},
        {"algorithm": {"name": "nsga2", "population": 20}},
        {"algorithm": {"name": "random"}},
        {"reference_point": {"energy_j": 90.0}},
    ],
)
def test_what_changes_results_changes_the_hash(change):
    assert hashed(made_study(**change)) != hashed(made_study())


def test_contents_and_versions_change_the_hash():
    study = made_study()
    other = {"motor": {"peak_torque_n_m": 5.6}, "calibration": {"name": "reference"}}
    assert hashed(study, other) != hashed(study)
    assert hashed(study, package_versions=versions(study) | {"mujoco": "0"}) != hashed(study)


@pytest.mark.parametrize("change", [{"evaluations": 1000}, {"description": "x"}, {"stop": {"wall_time_s": 5.0}}])
def test_when_it_ends_does_not_change_the_hash(change):
    assert hashed(made_study(**change)) == hashed(made_study())


def test_only_the_algorithm_in_use_counts_among_the_versions():
    assert "pymoo" in versions(made_study())
    assert "pymoo" not in versions(made_study(algorithm={"name": "weighted_cmaes"}))
    assert "cma" in versions(made_study(algorithm={"name": "weighted_cmaes"}))
    assert "optuna" in versions(made_study(algorithm={"name": "optuna_tpe"}))
    assert not {"pymoo", "cma", "optuna"} & set(versions(made_study(algorithm={"name": "random"})))


def test_differences_name_key_old_and_new():
    before = {"a": {"b": 1, "c": [1, 2]}, "d": "x", "gone": 3}
    now = {"a": {"b": 2, "c": [1, 2]}, "d": "y", "new": {"e": None}}
    assert differences(before, now) == [
        "a.b: 1 -> 2",
        'd: "x" -> "y"',
        "gone: 3 -> (none)",
        "new.e: (none) -> null",
    ]
    assert differences(before, before) == []
