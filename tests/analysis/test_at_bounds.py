"""Variables that are at their bounds along the front: which, on which share of it, and in which part."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from pareto_monoped.analysis.at_bounds import Part, at_bounds, binding_limits, bound_lines
from pareto_monoped.analysis.remarks import remarks
from pareto_monoped.definition.goals import constraints_of
from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.storage.reader import read_study
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
    assert [(part.least, part.greatest, part.share) for part in stiffness.parts] == [
        pytest.approx((0.6, 0.7, 1.0)),
        pytest.approx((0.9, 1.0, 1.0)),
    ]
    bounds = data.study.variables["knee_ratio"]
    assert list(bound_lines(data, front).values())[:2] == [
        "stiffness_n_per_m is at its lower bound of 5 N/m in 54 % of the front (all of height 0.600 to 0.700 m, all of "
        "0.900 to 1.000 m)",
        f"knee_ratio, within {bounds.lower:g} to {bounds.upper:g}, is at the first gearbox, {lowest:.4g}, in 46 % of "
        "the front (all of height 0.600 to 0.780 m)",
    ]


def test_a_part_of_the_front_says_which_share_of_its_designs_is_at_the_bound(data):
    """A part may have gaps: it read as if all of its designs were at the bound."""
    height = np.linspace(0.6, 1.0, 41)
    every_second = np.where((np.arange(41) % 2 == 0) & (height < 0.905), 5.0, 60.0)
    front = front_of(data, height, stiffness_n_per_m=every_second)
    (found,) = at_bounds(data, front)
    assert found.share == pytest.approx(16 / 41)
    assert found.parts == (Part(least=height[0], greatest=height[30], share=16 / 31),)
    assert bound_lines(data, front) == {
        "stiffness_n_per_m": "stiffness_n_per_m is at its lower bound of 5 N/m in 39 % of the front (52 % of height "
        "0.600 to 0.900 m)"
    }


def test_both_bounds_of_a_variable_are_in_one_note(data):
    height = np.linspace(0.6, 1.0, 41)
    front = front_of(data, height, stiffness_n_per_m=np.where(height < 0.705, 5.0, np.where(height > 0.895, 200.0, 60)))
    assert remarks(data, front) == [
        "stiffness_n_per_m is at its lower bound of 5 N/m in 27 % of the front (all of height 0.600 to 0.700 m); at "
        "its upper bound of 200 N/m in 27 % of the front (all of height 0.900 to 1.000 m)"
    ]


def test_all_variables_at_bounds_are_named_after_a_run_within_few_lines(data):
    """Those beyond the fourth note were counted, but not named."""
    height = np.linspace(0.6, 1.0, 41)
    free = list(data.study.free)
    assert len(free) == 7
    limits = {name: data.coordinates.limits(name) for name in free}
    at = {
        name: np.where(height < 0.705 + 0.04 * k, limits[name][k % 2], np.mean(limits[name]))
        for k, name in enumerate(free)
    }
    front = front_of(data, height, **at)
    lines = remarks(data, front)
    assert len(lines) == 4
    assert [line.split()[0].rstrip(",") for line in lines[:3]] == free[:3:-1]
    assert lines[3] == f"also at bounds along the front, which the report shows: {', '.join(free[3::-1])}"
    assert len(bound_lines(data, front)) == 7


@pytest.mark.parametrize(("lower", "upper", "told"), [(5.16, 5.17, False), (5.0, 6.0, True)])
def test_a_list_of_one_gearbox_has_no_bounds(tmp_path, lower, upper, told):
    """It was told as lower and as upper bound of the whole front."""
    path = tmp_path / "s.db"
    run(made(variables={"knee_ratio": {"lower": lower, "upper": upper}}), path, evaluations=8)
    data = read_study(path)
    least, most = data.coordinates.limits("knee_ratio")
    assert (least < most) == told
    front = front_of(data, np.linspace(0.6, 1.0, 11), knee_ratio=least)
    assert [(one.name, one.side) for one in at_bounds(data, front)] == [("knee_ratio", "lower")] * told


@pytest.mark.long
def test_a_bound_of_a_gear_list_is_its_last_gearbox_and_not_what_the_study_says(tmp_path):
    run(made(rules="iso6336", motor="U8"), tmp_path / "s.db", evaluations=8)
    data = read_study(tmp_path / "s.db")
    last = data.coordinates.limits("knee_ratio")[1]
    bounds = data.study.variables["knee_ratio"]
    assert last != bounds.upper
    middle = {name: np.mean(data.coordinates.limits(name)) for name in data.study.free}
    alone = data.trials.iloc[:1].assign(**(middle | {"knee_ratio": last}))
    trial = int(alone["trial"].iloc[0])
    known = replace(data, trials=alone, study=replace(data.study, constraints=constraints_of({})))
    assert f"knee_ratio at the last gearbox, {last:.4g}, within 4 to 8.7" in binding_limits(known, trial)


@pytest.mark.long
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
    (line,) = bound_lines(data, front).values()
    assert line == (
        f"knee_ratio, within 4 to 8.7, is at the last gearbox, {top['U8']:.4g} with U8, in 50 % of the front (all of "
        f"height 0.600 to 0.789 m); at the last gearbox, {top['MN8014']:.4g} with MN8014, in 50 % of the front (all of "
        "height 0.811 to 1.000 m)"
    )


def test_a_front_between_all_bounds_needs_no_remark(data):
    assert remarks(data, front_of(data, np.linspace(0.6, 1.0, 10))) == []
