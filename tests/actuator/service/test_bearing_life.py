"""Loads on the bearings and their lives, written out a second time."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pareto_monoped.actuator.actuator import build_actuator
from pareto_monoped.actuator.motors import load_motor, motor_names
from pareto_monoped.actuator.search import build_map, map_for
from pareto_monoped.actuator.service.ball_row import row_load
from pareto_monoped.actuator.service.data import default_service
from pareto_monoped.actuator.service.sheet import service_sheet
from pareto_monoped.actuator.settings import RULE_SETS, ActuatorSettings

SERVICE = default_service()


def bearings(actuator_map, ratio, service=SERVICE, settings=None):
    sheet = service_sheet(actuator_map.lookup(ratio), settings or actuator_map.settings, service)
    return {found.place: found for found in sheet.bearings}


def test_the_tilting_moment_is_that_of_the_design_notes(vt_map):
    """About 27 N m on the single 40x52x7 row at 6:1 and 41 N m at the strongest, found by hand."""
    found = bearings(vt_map, 6.0)["main, knee"]
    assert found.bearing.designation == "6808"
    assert found.force_n == pytest.approx(1156.3, abs=1.0)
    assert found.tilt_n_m == pytest.approx(27.1, abs=0.1)
    tilts = [
        service_sheet(entry.actuator, vt_map.settings).output_tilt_n_m for entry in vt_map.entries if entry.actuator
    ]
    assert max(tilts) == pytest.approx(41.2, abs=0.5)


def test_life_is_miner_s_sum_of_iso_281(vt_map):
    """Each level of a jump by itself: turns per hour over turns that the level alone would leave."""
    for ratio in (4.0, 7.9):
        actuator = vt_map.lookup(ratio)
        found = bearings(vt_map, ratio)["main, knee"]
        used_per_hour = 0.0
        for share, angle in ((1.0, 1.0), (0.5, 2.0)):  # torque over the peak, rad: the shipped duty of one jump
            load = row_load(
                found.bearing,
                np.array([share * found.force_n]),
                np.array([share * found.tilt_n_m]),
                SERVICE.bearing_clearance_mm,
            )
            turns = 60.0 * SERVICE.jumps_per_minute * angle / (2.0 * np.pi)
            used_per_hour += turns / (1e6 * (found.bearing.dynamic_rating_n / load.equivalent_n[0]) ** 3)
        assert found.life_h == pytest.approx(1.0 / used_per_hour, rel=1e-6)
        assert actuator.peak_torque_n_m == pytest.approx(found.force_n * 28.54e-3)


def test_small_bearings_turn_with_the_rotor(vt_map):
    inside, outside = bearings(vt_map, 6.0), bearings(vt_map, 7.9)
    assert set(inside) == {"main, knee", "main, hip", "end", "rear"}
    assert set(outside) == set(inside) - {"rear"}  # the framed motor has bearings of its own
    assert inside["end"].turns_per_output == pytest.approx(5.0)  # between sun and carrier
    assert inside["rear"].turns_per_output == pytest.approx(6.0)
    # K_gamma of three planets around a sun in bearings is 1.23; 5.5 N m over three planets at 4.5 mm, on two bearings.
    tooth = 5.5 / 3 / 4.5e-3 / np.cos(np.radians(20.0))
    assert inside["end"].force_n == pytest.approx(0.5 * 0.23 * tooth)
    assert inside["rear"].force_n > inside["end"].force_n  # the rotor's weight


def test_the_hip_rests_in_two_bearings(vt_map):
    """Moments about the main bearing, then about the far one: both reactions together carry foot force and weight."""
    actuator = vt_map.lookup(6.0)
    at_hip = bearings(vt_map, 6.0)["main, hip"]
    main = -(23.5 + 9.0)  # mm from the leg's middle plane; the 40x52x7 sits 5.5 to 12.5 mm behind the output face
    far = 14.5 + actuator.length_mm + 14.0
    load = SERVICE.foot_force_n + SERVICE.leg_weight_n
    at_far = load * (0.0 - main) / (far - main)
    assert at_hip.force_n == pytest.approx(load - at_far)
    assert at_hip.tilt_n_m == 0.0


@pytest.mark.parametrize("rules", RULE_SETS)
@pytest.mark.parametrize("name", motor_names())
def test_every_winner_of_every_motor_has_a_sheet_of_finite_numbers(name, rules):
    actuator_map = build_map(load_motor(name), ActuatorSettings(rules=rules))
    for entry in actuator_map.entries:
        if entry.actuator is not None:
            sheet = service_sheet(entry.actuator, actuator_map.settings)
            assert 100.0 < sheet.bearing_life_h < 1e9
            assert 0.8 < sheet.losses.efficiency_total < sheet.losses.efficiency_mesh
            assert 500.0 < sheet.stiffness.stiffness_n_m_per_rad < 1e6
            assert 5.0 < sheet.backlash_arcmin < 60.0
            assert all(found.overload_safety < found.static_safety for found in sheet.bearings)


def with_overload(actuator_settings, factor):
    parts = actuator_settings.parts
    return replace(actuator_settings, parts=replace(parts, rating=replace(parts.rating, overload_factor=factor)))


@settings(max_examples=25, deadline=None)
@given(st.floats(1.0, 100.0), st.floats(0.0, 60.0), st.floats(1.1, 4.0))
def test_more_jumps_a_longer_lever_or_overload_never_help(jumps, offset, overload):
    actuator_map = map_for("VT8020")
    base = replace(SERVICE, jumps_per_minute=jumps, chain_offset_mm=offset)
    usual, hard = with_overload(actuator_map.settings, overload), with_overload(actuator_map.settings, 1.5 * overload)
    knee = bearings(actuator_map, 6.0, base, usual)["main, knee"]
    assert bearings(actuator_map, 6.0, replace(base, jumps_per_minute=2.0 * jumps))[
        "main, knee"
    ].life_h == pytest.approx(0.5 * knee.life_h)
    longer = bearings(actuator_map, 6.0, replace(base, chain_offset_mm=offset + 5.0))["main, knee"]
    assert longer.life_h < knee.life_h
    assert longer.static_safety < knee.static_safety
    harder = bearings(actuator_map, 6.0, base, hard)["main, knee"]
    assert harder.overload_safety < knee.overload_safety
    assert harder.life_h == pytest.approx(knee.life_h)


def test_a_larger_bearing_lasts_longer(vt8020, vt_map):
    gears, usual = vt_map.lookup(6.0).gears, vt_map.settings
    carrier = replace(usual.parts.carrier, bearing_clearance_mm=30.0)
    wide = replace(usual, parts=replace(usual.parts, carrier=carrier))
    small = service_sheet(build_actuator(vt8020, "ESSPG", gears, usual), usual)
    large = service_sheet(build_actuator(vt8020, "ESSPG", gears, wide), wide)
    assert large.bearing_life_h > 1.5 * small.bearing_life_h
