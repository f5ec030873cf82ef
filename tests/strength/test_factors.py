"""Factors of populations: those of single designs, and groups as the least of them."""

import numpy as np
import pytest

from pareto_monoped.design import NAMES
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.measures import MEASURES
from pareto_monoped.strength.factors import MOST_FACTOR, TABLE, safeties, strength_factors
from pareto_monoped.strength.groups import GROUP_MEASURES, INFORMING
from pareto_monoped.strength.joint import LOAD_NAMES, loads_of
from tests.strength.support import factors_one_by_one, jumped


@pytest.mark.parametrize("rules", ["paper", "iso6336"])
def test_a_population_has_the_factors_of_its_designs(rules):
    actuator_map, designs, result, loads = jumped(rules)
    factors = strength_factors(designs, actuator_map, loads)
    assert factors.shape == (len(designs), len(TABLE))
    for i, design in enumerate(designs[:4]):
        alone = factors_one_by_one(actuator_map, design, loads, i)
        assert list(alone) == [joint.name for joint in TABLE]
        assert factors[i] == pytest.approx(list(alone.values()), rel=1e-10, nan_ok=rules == "paper")
    unknown = {joint.name for k, joint in enumerate(TABLE) if np.isnan(factors[:, k]).any()}
    assert unknown == ({"hip_gear_strikes", "knee_gear_strikes"} if rules == "paper" else set())
    for group, measure in GROUP_MEASURES.items():
        rows = [k for k, joint in enumerate(TABLE) if joint.group == group]
        if rows:
            least = [min(row[k] / TABLE[k].required for k in rows) for row in factors]
            assert getattr(result, measure) == pytest.approx(least, rel=1e-15, nan_ok=group in INFORMING)


def test_a_design_does_not_depend_on_the_batch():
    actuator_map, designs, _, loads = jumped()
    whole = strength_factors(designs, actuator_map, loads)
    order = np.random.default_rng(3).permutation(len(designs))
    turned = {name: loads[name][order] for name in LOAD_NAMES}
    np.testing.assert_array_equal(strength_factors(designs[order], actuator_map, turned), whole[order])


def test_more_load_is_less_safety():
    """Ten times more, so that it also shows where only the largest of several loads counts."""
    actuator_map, designs, _, loads = jumped()
    before = strength_factors(designs, actuator_map, loads)
    lengths = ("thigh_length_m", "shank_length_m")
    for name in LOAD_NAMES:
        if name not in lengths:
            more = {each: loads[each] * (10.0 if each == name else 1.0) for each in LOAD_NAMES}
            after = strength_factors(designs, actuator_map, more)
            assert np.all(after <= before * (1.0 + 1e-12)), name
            for k, joint in enumerate(TABLE):
                if name in joint.loads:
                    loaded = (before[:, k] < MOST_FACTOR) & (loads[name] > 0.0)
                    assert not loaded.any() or np.any(after[loaded, k] < before[loaded, k]), (joint.name, name)


def test_a_joint_without_load_has_a_finite_factor_and_an_unknown_load_none():
    actuator_map, designs, _, loads = jumped()
    idle = {name: values if "length" in name else np.zeros_like(values) for name, values in loads.items()}
    factors = strength_factors(designs, actuator_map, idle)
    # Threads under their preload and dowels in their holes have no load of the jump.
    loaded = np.array([bool(joint.loads) for joint in TABLE])
    assert np.all(factors[:, loaded] == MOST_FACTOR)
    unknown = loads_of(dict(zip(NAMES, designs.T, strict=True)))
    assert np.isnan(strength_factors(designs, actuator_map, unknown)[:, loaded]).all()
    nothing = safeties(np.full((3, len(TABLE)), np.nan))
    assert all(np.isnan(nothing[GROUP_MEASURES[joint.group]]).all() for joint in TABLE)


def test_failed_jumps_have_no_safety():
    actuator_map, designs, _, _ = jumped()
    lame = designs[:2].copy()
    lame[0, NAMES.index("knee_ratio")] = 99.0
    result = Evaluator(actuator_map, load_calibration("reference"))(lame)
    assert result.status[0] == "no_gearbox"
    for safety in (result.gear_safety, result.gear_strike_safety):
        assert np.isnan(safety[0])
        assert np.isfinite(safety[1])


def test_rows_can_be_told_apart_and_say_what_they_are_about():
    names = [joint.name for joint in TABLE]
    assert len(names) == len(set(names))
    measures = {entry.name for entry in MEASURES}
    for joint in TABLE:
        assert joint.required > 0.0
        assert joint.group in GROUP_MEASURES
        assert joint.parts
        assert all((joint.formula, joint.source, joint.required_source, joint.cure))
        # A stored study must know every load, but for the lengths, which are variables.
        assert set(joint.loads) <= measures | {"thigh_length_m", "shank_length_m"}


def test_required_factors_are_those_of_their_sources():
    """5: DIN 8150; 2: bonds; 1.5: what shares a load or is hard, columns; 1: standards with their own safety in them.

    All others are against yield, or slip after VDI 2230-1, R12: 1.2.
    """
    both = lambda *names: {f"{side}_{name}" for side in ("hip", "knee") for name in names}  # noqa: E731
    other = {
        5.0: {"chain_breaking"},
        2.0: both("ring_bond"),
        1.5: both("spline", "sun_shaft", "planet_pin_bending", "planet_pin_seat")
        | both("coupling_dowels", "ring_housing_dowels", "output_dowels", "mount_dowels")
        | {"knee_axle_dowels", "knee_drive_shaft", "turnbuckle_stud", "turnbuckle_thread", "turnbuckle_bar"}
        | {"thigh_side_inner", "thigh_side_outer", "shank_fork_side"},
        1.0: both("gear_flank", "gear_root", "gear_strikes", "bumper", "actuator_threads")
        | {"leg_threads", "knee_journal_threads", "actuator_screws_tightened", "dowels_pressed", "knee_drive_opening"}
        | {"chain_wear", "knee_bearing_static", "knee_bearing_life"},
    }
    expected = {joint.name: 1.2 for joint in TABLE} | {name: value for value, names in other.items() for name in names}
    assert {joint.name: joint.required for joint in TABLE} == expected
