"""What a user hears of a result: variables at their bounds along the front, limits that no design holds."""


import numpy as np
import pandas as pd
import pytest

from pareto_monoped.errors import StudyError
from pareto_monoped.study.definition import load_study, study_from_dict
from pareto_monoped.study.reader import read_study
from pareto_monoped.study.remarks import at_bounds, remarks
from pareto_monoped.study.run import run


def made(**more):
    settings = {"name": "s", "evaluations": 40, "audit": False, "algorithm": {"name": "random"}, "gear_list": True}
    return study_from_dict(settings | more, source="test")


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    path = tmp_path_factory.mktemp("random") / "s.db"
    run(made(), path)
    return read_study(path)


def front_of(data, height_m, **columns):
    """A front with these heights, all variables in the middle of their ranges but for the columns given."""
    middle = {name: np.mean(data.coordinates.limits(name)) for name in data.study.free}
    return pd.DataFrame(middle | {"height_m": height_m, "energy_j": 10.0} | columns)


def test_bounds_are_told_with_the_share_of_the_front_and_its_parts(data):
    height = np.linspace(0.6, 1.0, 41)
    lowest, highest = data.coordinates.limits("knee_ratio")
    front = front_of(
        data,
        height,
        stiffness_n_per_m=np.where((height < 0.705) | (height > 0.895), 5.4, 60.0),
        damping_n_s_per_m=np.where(height > 0.8951, 9.99, 9.9),
        knee_ratio=np.where(height < 0.785, lowest, np.where(height > 0.9951, highest, 6.0)),
    )
    found = {(one.name, one.side): one for one in at_bounds(data, front)}
    assert list(found) == [
        ("stiffness_n_per_m", "lower"),
        ("knee_ratio", "lower"),
        ("damping_n_s_per_m", "upper"),
    ]
    stiffness = found["stiffness_n_per_m", "lower"]
    assert (stiffness.share, stiffness.bound) == (pytest.approx(22 / 41), 5.0)
    assert np.allclose(stiffness.parts, [(0.6, 0.7), (0.9, 1.0)])
    assert np.allclose(found["damping_n_s_per_m", "upper"].parts, [(0.9, 1.0)])
    assert remarks(data, front)[:2] == [
        "stiffness_n_per_m is at its lower bound of 5 N/m in 54 % of the front (height 0.600 to 0.700 m and 0.900 to "
        "1.000 m)",
        f"knee_ratio is at its lower bound of {lowest:.4g} in 46 % of the front (height 0.600 to 0.780 m)",
    ]


def test_each_motor_s_gearboxes_have_bounds_of_their_own(tmp_path):
    """The greatest of all ratios is one motor's alone: designs with another motor are at a bound below it."""
    path = tmp_path / "s.db"
    listed = {"hip_motor": ["VT8020", "U8"], "knee_motor": ["U8", "MN8014"], "rules": "iso6336"}
    run(made(**listed), path, evaluations=8)
    data = read_study(path)
    ends = {motor: data.actuator_maps[motor] for motor in ("VT8020", "U8", "MN8014")}
    top = {motor: found.lookup(8.7).ratio for motor, found in ends.items()}
    assert top["U8"] != top["MN8014"]
    knee = np.repeat(["U8", "MN8014"], 10)
    front = front_of(
        data,
        np.linspace(0.6, 1.0, 20),
        knee_ratio=[top[name] for name in knee],
        hip_ratio=5.0,
        hip_motor="VT8020",
        knee_motor=knee,
    )
    assert [(one.name, one.side, one.motor, one.bound, one.share) for one in at_bounds(data, front)] == [
        ("knee_ratio", "upper", name, top[name], 0.5) for name in ("U8", "MN8014")
    ]
    assert remarks(data, front)[1].startswith(
        f"knee_ratio is at its upper bound of {top['MN8014']:.4g} with MN8014 in 50 % of the front (height 0.8"
    )


def test_a_front_between_all_bounds_needs_no_remark(data):
    assert remarks(data, front_of(data, np.linspace(0.6, 1.0, 10))) == []


WEIGHTED = 'name = "w"\nevaluations = {}\naudit = false\n[algorithm]\nname = "weighted_cmaes"\nheight_weights = {}\n'


def written(folder, evaluations, weights, more=""):
    path = folder / "w.toml"
    path.write_text(WEIGHTED.format(evaluations, weights) + more)
    return path


@pytest.mark.parametrize(("evaluations", "iterations"), [(2400, 30), (2479, 30), (80, 1), (16_000, 200), (99_999, 200)])
def test_weights_share_a_budget(tmp_path, evaluations, iterations):
    study = load_study(written(tmp_path, evaluations, [k / 11 for k in range(1, 11)]))
    assert study.algorithm.iterations == iterations
    assert study.as_dict()["algorithm"]["iterations"] == iterations


def test_a_budget_that_ends_before_the_last_weight_is_refused_with_the_number(tmp_path):
    path = written(tmp_path, 2400, [0.2, 0.5, 0.8], "iterations = 200\n")
    with pytest.raises(
        StudyError,
        match=r"evaluations = 2400: 3 weights of 8 designs times 200 iterations need 4800; raise it, set "
        r"algorithm.iterations = 100, or leave",
    ):
        load_study(path)
    assert load_study(path, evaluations=4800).algorithm.iterations == 200
    with pytest.raises(StudyError, match=r"evaluations = 20: 3 weights .* need 24; raise it$"):
        load_study(written(tmp_path, 20, [0.2, 0.5, 0.8]))


def test_a_shared_budget_reaches_the_last_weight_and_a_cut_one_says_where_it_ended(tmp_path):
    study = load_study(written(tmp_path, 60, [0.2, 0.5, 0.8]))
    cut = run(study, tmp_path / "w.db", evaluations=24)
    assert any(
        line.startswith("the budget of 24 ended at weight 2 of 3; all weights need up to 48: continue with")
        for line in cut.remarks
    )
    whole = run(study, tmp_path / "w.db")
    assert not any("weight" in line for line in whole.remarks)
    assert read_study(tmp_path / "w.db").trials["height_weight"].tolist() == [0.2] * 16 + [0.5] * 16 + [0.8] * 16
