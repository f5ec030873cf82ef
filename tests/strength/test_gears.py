"""Gears in the stop against the slow rating of the standard's equations, and against Lewis by hand."""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.actuator.ratiomap import joint_maps
from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.single import simulate
from pareto_monoped.strength.factors import TABLE, GearLife, capacities, gear_life, joint_factors
from pareto_monoped.strength.gears import (
    MOST_JUMPS,
    lewis_torque_n_m,
    static_torques_n_m,
    strike_life_jumps,
    strike_torques_n_m,
    struck_safeties,
)
from pareto_monoped.strength.joint import loads_of
from tests.actuator.rating import iso6336
from tests.strength.support import structure


@pytest.mark.parametrize("ratio", [4.0, 5.2, 6.0, 7.5, 8.4])
def test_at_its_limit_a_gear_has_exactly_the_required_static_safety(ratio):
    s = structure(map_for("VT8020", rules="iso6336"), ratio)
    data, gears = s.settings.parts.rating, s.settings.parts.gears
    for torque, column, least in zip(
        static_torques_n_m(s), (2, 3), (data.overload_flank_safety, data.overload_root_safety), strict=True
    ):
        at_limit = replace(data, overload_factor=torque / s.actuator.peak_torque_n_m)
        settings = replace(s.settings, parts=replace(s.settings.parts, rating=at_limit))
        safety, _ = iso6336.rate(
            s.actuator.gears,
            s.actuator.motor,
            s.actuator.face_width_mm,
            settings,
            ring_wall=gears.ring_rim_modules * s.actuator.gears.module_mm,
            sun_bore=None,
        )
        # The slow rating's fillet is exact to 1e-4, and the torque grows with the square of the flank's safety.
        assert min(values[column] for values in safety.values()) == pytest.approx(least, rel=2e-4)


def struck_safety(s, torque, jumps):
    """The least of S_H and S_F over those required, by the slow rating: the strike is one more level of one pass.

    K_A is 1 for it and 1.25 for the others; K_V is 1.
    """
    data, duty, gears = s.settings.parts.rating, s.settings.parts.duty, s.settings.parts.gears
    share = torque / s.actuator.peak_torque_n_m
    level = replace(
        duty,
        jumps=jumps,
        torque_shares=(*(1.25 * one for one in duty.torque_shares), share),
        output_angles_rad=(*duty.output_angles_rad, 1e-5),
        reversed=(*duty.reversed, False),
    )
    safety, _ = iso6336.rate(
        s.actuator.gears,
        s.actuator.motor,
        s.actuator.face_width_mm,
        replace(s.settings, parts=replace(s.settings.parts, duty=level)),
        ring_wall=gears.ring_rim_modules * s.actuator.gears.module_mm,
        sun_bore=None,
        standing_at=max(share, *(1.25 * one for one in duty.torque_shares)),
    )
    return min(min(v[0] / data.flank_safety, v[1] / data.root_safety) for v in safety.values())


@pytest.mark.parametrize(
    ("motor", "ratio"), [*(("VT8020", ratio) for ratio in (4.0, 5.2, 6.0, 7.5, 8.4)), ("U8", 4.636), ("U8", 6.706)]
)
def test_struck_in_every_jump_at_its_limit_a_gear_has_exactly_the_safety_of_its_duty(motor, ratio):
    s = structure(map_for(motor, rules="iso6336"), ratio)
    (torque,) = strike_torques_n_m([s])
    assert struck_safety(s, torque, s.settings.parts.duty.jumps) == pytest.approx(1.0, rel=2e-4)
    assert strike_life_jumps(s, torque) == pytest.approx(s.settings.parts.duty.jumps, rel=1e-4)
    flank, root = struck_safeties(s, torque)
    data = s.settings.parts.rating
    assert min(flank / data.flank_safety, root / data.root_safety) == pytest.approx(1.0, rel=2e-4)


@pytest.mark.parametrize(("ratio", "share"), [(4.0, 1.5), (6.0, 1.4), (7.5, 1.6), (8.4, 1.5)])
def test_gears_have_the_safety_of_their_duty_until_their_life_ends(ratio, share):
    s = structure(map_for("VT8020", rules="iso6336"), ratio)
    torque = share * s.actuator.peak_torque_n_m
    jumps = strike_life_jumps(s, torque)
    assert 1.0 < jumps < MOST_JUMPS
    # A ring that is nitrided has the steepest curve: a safety that is 2e-4 off moves its life by 0.4 percent.
    assert struck_safety(s, torque, jumps) == pytest.approx(1.0, rel=2e-4)
    assert struck_safety(s, torque, 1.1 * jumps) < 1.0 < struck_safety(s, torque, 0.9 * jumps)
    flank, root = struck_safeties(s, torque, jumps)
    data = s.settings.parts.rating
    assert min(flank / data.flank_safety, root / data.root_safety) == pytest.approx(1.0, rel=2e-4)


@pytest.mark.parametrize(
    "motor", ["VT8020", "U8", *(pytest.param(name, marks=pytest.mark.long) for name in ("U10", "U12", "MN8014"))]
)
def test_strikes_are_worse_in_every_jump_than_once_and_the_worse_the_more_jumps(motor):
    """Gears just wide enough for their duty had no torque at all, so that no design with them kept its strength."""
    actuator_map = map_for(motor, rules="iso6336")
    structures = [structure(actuator_map, e.actuator.ratio) for e in actuator_map.entries if e.actuator]
    always = np.array(strike_torques_n_m(structures))
    assert (always < np.min([static_torques_n_m(s) for s in structures], axis=1)).all()
    # The duty itself is carried, whose highest level has K_A; a cycle more of it in each jump takes a little.
    assert (always >= 1.15 * np.array([s.actuator.peak_torque_n_m for s in structures])).all()
    parts = replace(actuator_map.settings.parts, duty=replace(actuator_map.settings.parts.duty, jumps=2e4))
    fewer = [replace(s, settings=replace(s.settings, parts=parts)) for s in structures]
    assert (np.array(strike_torques_n_m(fewer)) > always).all()


def test_gearboxes_together_have_the_torques_that_each_has_alone():
    actuator_map = map_for("U8", rules="iso6336")
    structures = [structure(actuator_map, e.actuator.ratio) for e in actuator_map.entries if e.actuator]
    together = strike_torques_n_m(structures)
    assert together[::6] == pytest.approx([strike_torques_n_m([s])[0] for s in structures[::6]], rel=1e-10)
    row = next(k for k, joint in enumerate(TABLE) if joint.name == "knee_gear_strikes")
    found = capacities(joint_maps(actuator_map))
    assert found.values["knee"][:, found.columns[row]].ravel() == pytest.approx(together, rel=0.0)


def test_a_hip_that_strikes_nothing_lasts_as_long_as_its_duty_lets_it():
    s = structure(map_for("VT8020", rules="iso6336"), 6.0)
    lives = [strike_life_jumps(s, share * s.actuator.peak_torque_n_m) for share in (0.1, 0.5, 1.0, 1.5)]
    assert lives == sorted(lives, reverse=True)
    assert lives[0] == pytest.approx(lives[1], rel=1e-2)
    assert lives[0] > s.settings.parts.duty.jumps


@pytest.mark.parametrize(("case", "calibration"), [("nominal", "reference"), ("C", "reference-3")])
def test_a_design_is_told_how_long_its_gears_last(case, calibration):
    """They last in Case C under the loads of rigid drives."""
    actuator_map = map_for("VT8020")
    result = simulate(PAPER_CASES[case].design, actuator_map, load_calibration(calibration))
    known = result.measures | result.design.as_dict()
    loads = loads_of({name: np.array([value]) for name, value in known.items()})
    life = gear_life(result.design, actuator_map, loads)
    rows = {one.joint.name: one for one in joint_factors(result.design, actuator_map, loads)}
    strikes = [rows[f"{side}_gear_strikes"] for side in ("hip", "knee")]
    assert result.measures["gear_strike_safety"] == min(one.factor for one in strikes)
    assert all(one.joint.informs for one in strikes)
    # The life ends before the duty where the safety is below 1, and only then there is something to say.
    assert (life.jumps < life.duty_jumps) == (result.measures["gear_strike_safety"] < 1.0) == bool(life.advice)
    assert "\n" not in life.advice
    short = (life.flank_safety / life.asked[0], life.root_safety / life.asked[1])
    assert (min(short) < 1.0) == bool(life.advice)
    if case == "nominal":  # whose knee strikes harder than the duty's highest level, as the slow rating needs it
        knee = structure(actuator_map, result.design.knee_ratio)
        torque = float(loads["peak_gear_torque_knee_n_m"][0])
        assert min(short) == pytest.approx(struck_safety(knee, torque, life.duty_jumps), rel=2e-4)
    assert all(f"{value:.2f} against" in life.advice for value in (life.flank_safety, life.root_safety) if life.advice)
    assert ("gear_strike_safety" in life.advice) == (case == "nominal")


def test_rules_without_fatigue_know_no_life():
    actuator_map = map_for("VT8020", rules="paper")
    s = structure(actuator_map, 6.0)
    assert np.isnan([*strike_torques_n_m([s, s]), strike_life_jumps(s, 50.0)]).all()
    result = simulate(PAPER_CASES["C"].design, actuator_map, load_calibration("paper"))
    assert np.isnan(result.measures["gear_strike_safety"])
    loads = loads_of({name: np.array([v]) for name, v in (result.measures | result.design.as_dict()).items()})
    assert gear_life(result.design, actuator_map, loads) is None
    # The other rows are known all the same.
    assert len(joint_factors(result.design, actuator_map, loads)) == len(TABLE) - 2


def test_lives_are_told_with_two_digits():
    told = [
        GearLife(jumps=jumps, duty_jumps=1e5, flank_safety=1.0, root_safety=1.0, asked=(1.1, 1.4)).text
        for jumps in (0.0, 7.3, 7864.8, 142127.0, MOST_JUMPS)
    ]
    assert told == ["0", "7", "7900", "140000", "1e+09 or more"]


def test_gears_of_the_map_carry_the_overload_that_they_are_rated_for():
    actuator_map = map_for("VT8020", rules="iso6336")
    share = actuator_map.settings.parts.rating.overload_factor
    for entry in actuator_map.entries:
        if entry.actuator is not None:
            s = structure(actuator_map, entry.actuator.ratio)
            assert min(static_torques_n_m(s)) >= share * entry.actuator.peak_torque_n_m * (1.0 - 1e-9)


def test_lewis_by_hand():
    """The paper's 6:1 gearbox, 18/36/90 m 0.5 with 3 planets: Y of 18 teeth is 0.309 (Shigley, table 14-2)."""
    s = structure(map_for("VT8020", rules="paper"), 6.0)
    assert (s.actuator.gears.sun_teeth, s.actuator.gears.module_mm, s.actuator.gears.planets) == (18, 0.5, 3)
    force = 400.0 / 1.2 * s.actuator.face_width_mm * 0.5 * 0.309
    assert lewis_torque_n_m(s) == pytest.approx(3 * force * 4.5e-3 * 6.0, rel=1e-12)
    # The face was chosen for twice the peak torque and for Barth's factor at the no-load speed.
    assert lewis_torque_n_m(s) > 2.0 * s.actuator.peak_torque_n_m


def test_flanks_have_no_limit_under_the_paper_rules():
    s = structure(map_for("VT8020", rules="paper"), 6.0)
    (row,) = [joint for joint in TABLE if joint.name == "hip_gear_flank"]
    assert row.factor(*row.capacity(s), np.array([50.0]))[0] == np.inf
