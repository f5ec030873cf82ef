"""Loads on the bearings and their lives, written out a second time."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pareto_monoped.actuator.actuator import build_actuator
from pareto_monoped.actuator.assumptions import default_service
from pareto_monoped.actuator.gearset import load_sharing
from pareto_monoped.actuator.motors import load_motor, motor_names
from pareto_monoped.actuator.search import map_for, map_of
from pareto_monoped.actuator.service.loads import bush_pv, row_load
from pareto_monoped.actuator.service.sheet import service_sheet
from pareto_monoped.design import RULE_SETS

SERVICE = default_service()


def bearings(actuator_map, ratio, service=SERVICE, settings=None):
    sheet = service_sheet(actuator_map.lookup(ratio), settings or actuator_map.settings, service)
    return {found.place: found for found in sheet.bearings}


def test_the_chain_pulls_between_two_supports(vt_map):
    """Moments about either support, by hand: 1156 N at 6:1, 23.5 mm before one bearing and 15 mm behind the other."""
    found = bearings(vt_map, 6.0)
    main, far = found["main, knee"], found["far, knee"]
    assert main.bearing.designation == "6808"
    assert far.bearing.designation == "HK1210"
    pull = 33.0 / 28.54e-3
    assert main.force_n + far.force_n == pytest.approx(pull) == pytest.approx(1156.3, abs=1.0)
    assert main.force_n * 23.5 == pytest.approx(far.force_n * 15.0)
    sheet = service_sheet(vt_map.lookup(6.0), vt_map.settings)
    assert sheet.output_tilt_n_m == pytest.approx(main.force_n * 9.0e-3)


def test_life_is_miner_s_sum_of_iso_281(vt_map):
    """Each level of a jump by itself: turns per hour over turns that the level alone would leave."""
    for ratio in (4.0, 7.9):
        found = bearings(vt_map, ratio)
        main, far = found["main, knee"], found["far, knee"]
        used = {main.place: 0.0, far.place: 0.0}
        for share, angle in ((1.0, 1.0), (0.5, 1.0), (0.35, 1.0)):  # torque over the peak, rad: the shipped duty
            load = row_load(main.bearing, np.array([share * main.force_n]), np.zeros(1), SERVICE.bearing_clearance_mm)
            turns = 60.0 * SERVICE.jumps_per_minute * angle / (2.0 * np.pi)
            used[main.place] += turns / (1e6 * (main.bearing.dynamic_rating_n / load.equivalent_n[0]) ** 3)
            used[far.place] += turns / (1e6 * (5050.0 / (share * far.force_n)) ** (10.0 / 3.0))
        for bearing in (main, far):
            assert bearing.life_h == pytest.approx(1.0 / used[bearing.place], rel=1e-6)
        assert far.static_safety == pytest.approx(6250.0 / far.force_n)
        assert far.overload_safety == pytest.approx(far.static_safety / 2.5)


def test_the_tilt_is_the_larger_play_over_the_supports_distance(vt_map):
    tilt = bearings(vt_map, 6.0)["main, knee"].tilt_rad
    assert tilt == pytest.approx(0.5 * 0.040 / 38.5)  # the far bearing's play decides
    tight = replace(SERVICE, drive_support_clearance_mm=0.0)
    found = bearings(vt_map, 6.0, tight)["main, knee"]
    shift = row_load(found.bearing, np.array([found.force_n]), np.zeros(1), SERVICE.bearing_clearance_mm).shift_mm[0]
    assert found.tilt_rad == pytest.approx(shift / 38.5, rel=1e-4)


def test_needles_carry_the_most_loaded_planet(vt8020):
    """ISO 281 and ISO 76 written out for the needles at 6:1."""
    actuator_map = map_for("VT8020", "iso6336")
    actuator = actuator_map.lookup(6.0)
    found = bearings(actuator_map, 6.0)["planets"]
    gears = actuator.gears
    sharing = {3: 1.23, 4: 1.32}[gears.planets]  # sun in bearings
    force = sharing * actuator.peak_torque_n_m / (gears.planets * 1e-3 * gears.carrier_radius_mm)
    assert found.force_n == pytest.approx(force)
    assert actuator.face_width_mm < 15.6  # one row
    lengths = [n for n in (5.8, 6.8, 7.8, 9.8, 11.8, 13.8) if n <= actuator.face_width_mm]
    carries = max(lengths) - 0.6
    static = 44.0 * (1.0 - 1.5 / 7.5) * 15 * carries * 1.5
    assert found.static_safety == pytest.approx(static / force)
    # f_c of ISO 281, table 7, is 88.7 at D / D_pw = 0.2, its largest value.
    dynamic = 1.1 * 88.7 * carries ** (7 / 9) * 15**0.75 * 1.5 ** (29 / 27)
    assert found.bearing.dynamic_rating_n == pytest.approx(dynamic, rel=5e-3)
    assert found.turns_per_output == pytest.approx(gears.ring_teeth / gears.planet_teeth)
    mean = (1 + 0.5 ** (10 / 3) + 0.35 ** (10 / 3)) / 3  # over the three levels of the duty, an angle of 1 rad each
    revolutions = 1e6 / (mean * (force / found.bearing.dynamic_rating_n) ** (10 / 3))
    per_hour = 600.0 * 3.0 / (2.0 * np.pi) * found.turns_per_output
    assert found.life_h == pytest.approx(revolutions / per_hour, rel=1e-6)


def test_small_bearings_turn_with_the_rotor(vt_map):
    inside, outside = bearings(vt_map, 6.0), bearings(vt_map, 7.9)
    assert set(inside) == {"main, knee", "far, knee", "main, hip", "end", "rear"}
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
    assert at_hip.tilt_rad == 0.0


@pytest.mark.parametrize("rules", RULE_SETS)
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name == "VT8020" else pytest.mark.long) for name in motor_names()]
)
def test_every_winner_of_every_motor_has_a_sheet_of_finite_numbers(name, rules):
    actuator_map = map_of(load_motor(name), rules)
    for entry in actuator_map.entries:
        if entry.actuator is not None:
            sheet = service_sheet(entry.actuator, actuator_map.settings)
            assert 100.0 < sheet.bearing_life_h < 1e9
            assert 0.8 < sheet.losses.efficiency_total < sheet.losses.efficiency_mesh
            assert 500.0 < sheet.stiffness.stiffness_n_m_per_rad < 1e6
            # Rated teeth are 0.03 modules thinner each: 0.12 / (zs + zp) rad, 4.7 for 22 and 65 teeth.
            assert 4.0 < sheet.backlash_arcmin < 60.0
            assert all(found.overload_safety < found.static_safety for found in sheet.bearings)


def with_overload(actuator_settings, factor):
    parts = actuator_settings.parts
    return replace(actuator_settings, parts=replace(parts, rating=replace(parts.rating, overload_factor=factor)))


@settings(max_examples=25, deadline=None)
@given(st.floats(1.0, 100.0), st.floats(5.0, 60.0), st.floats(1.1, 4.0))
def test_more_jumps_a_farther_support_or_overload_never_help(jumps, support, overload):
    actuator_map = map_for("VT8020")
    base = replace(SERVICE, jumps_per_minute=jumps, drive_support_mm=support)
    usual, hard = with_overload(actuator_map.settings, overload), with_overload(actuator_map.settings, 1.5 * overload)
    knee = bearings(actuator_map, 6.0, base, usual)["main, knee"]
    assert bearings(actuator_map, 6.0, replace(base, jumps_per_minute=2.0 * jumps))[
        "main, knee"
    ].life_h == pytest.approx(0.5 * knee.life_h)
    farther = bearings(actuator_map, 6.0, replace(base, drive_support_mm=support + 5.0))["main, knee"]
    assert farther.life_h < knee.life_h
    assert farther.static_safety < knee.static_safety
    harder = bearings(actuator_map, 6.0, base, hard)["main, knee"]
    assert harder.overload_safety < knee.overload_safety
    assert harder.life_h == pytest.approx(knee.life_h)


def test_a_larger_bearing_lasts_longer(vt8020, vt_map):
    gears, usual = vt_map.lookup(6.0).gears, vt_map.settings
    carrier = replace(usual.parts.carrier, bearing_clearance_mm=30.0)
    wide = replace(usual, parts=replace(usual.parts, carrier=carrier))
    small, large = (
        next(
            found
            for found in service_sheet(build_actuator(vt8020, "ESSPG", gears, one), one).bearings
            if found.place == "main, knee"
        )
        for one in (usual, wide)
    )
    assert large.life_h > 1.5 * small.life_h


def test_bushes_bear_the_pressure_on_a_pin_times_the_speed_at_which_it_slides(vt_map):
    """By hand: the mean torque over the planets, on the pin's section; the planet turns on its pin as it rolls in the
    ring that stands, while the carrier takes the pin along.
    """
    gears, width_mm, data = vt_map.lookup(6.0).gears, 8.0, vt_map.settings.parts
    carrier_mm = 0.5 * gears.module_mm * (gears.sun_teeth + gears.planet_teeth)
    assert gears.carrier_radius_mm == pytest.approx(carrier_mm, rel=0.02)  # profile shift moves it a little
    torque_n_m = data.duty.mean_share * gears.ratio * vt_map.motor.peak_torque_n_m
    force_n = (
        load_sharing(gears.planets, vt_map.settings) * torque_n_m / (gears.planets * 1e-3 * gears.carrier_radius_mm)
    )
    pressure_mpa = force_n / (data.carrier.pin_diameter_mm * width_mm)
    carrier = vt_map.settings.service.mean_speed_rad_per_s
    planet = carrier * (1.0 - gears.ring_teeth / gears.planet_teeth)
    sliding_m_per_s = abs(planet - carrier) * 0.5e-3 * data.carrier.pin_diameter_mm
    found = bush_pv(gears, width_mm, vt_map.motor, vt_map.settings)
    assert found == pytest.approx(pressure_mpa * sliding_m_per_s, rel=1e-12)
