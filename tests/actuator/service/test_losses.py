"""Losses by source: the figures found by hand in the notes of the design, closed forms, and energy."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.actuator.assumptions import default_service
from pareto_monoped.actuator.gearset import GearSet, efficiency
from pareto_monoped.actuator.service.sheet import Losses, bush_load, churning_loss, planet_bearing_loss, service_sheet

FOUR = GearSet(sun_teeth=30, planet_teeth=30, ring_teeth=90, module_mm=0.5, planets=5)
SIX = GearSet(sun_teeth=18, planet_teeth=36, ring_teeth=90, module_mm=0.5, planets=3)
EIGHT = GearSet(sun_teeth=22, planet_teeth=65, ring_teeth=152, module_mm=0.5, planets=3)


@pytest.mark.parametrize(
    ("gears", "low", "high"), [(FOUR, 0.030, 0.060), (SIX, 0.028, 0.056), (EIGHT, 0.016, 0.032)], ids=str
)
def test_bushes_take_what_was_found_by_hand(gears, low, high):
    """The three published sets on 6 mm pins with a friction of 0.05 and 0.1."""
    assert planet_bearing_loss(gears, 6.0, 0.05) == pytest.approx(low, abs=5e-4)
    assert planet_bearing_loss(gears, 6.0, 0.10) == pytest.approx(high, abs=5e-4)


teeth = st.integers(18, 80)


@given(teeth, teeth, st.floats(0.3, 1.2), st.integers(3, 6), st.floats(0.01, 0.3), st.floats(3.0, 12.0))
def test_bush_loss_is_friction_power_over_output_power(sun, planet, module, planets, friction, pin):
    """Power at each pin from its own force and sliding speed, both from rolling circles."""
    gears = GearSet(sun_teeth=sun, planet_teeth=planet, ring_teeth=sun + 2 * planet, module_mm=module, planets=planets)
    torque, speed = 20.0, 7.0
    r_sun, r_planet = 0.5e-3 * module * sun, 0.5e-3 * module * planet
    centre = r_sun + r_planet
    # The planet rolls on the fixed ring: its point there stands still.
    spin_against_carrier = -speed * centre / r_planet - speed
    force = torque / (planets * centre)
    power = planets * friction * force * abs(spin_against_carrier) * 0.5e-3 * pin
    assert planet_bearing_loss(gears, pin, friction) == pytest.approx(power / (torque * speed))
    found = bush_load(gears, torque, speed, pin, 10.0)
    assert found.speed_m_per_s == pytest.approx(abs(spin_against_carrier) * 0.5e-3 * pin)
    assert found.pressure_mpa == pytest.approx(force / (pin * 10.0))


def test_pv_of_the_published_set_at_four_is_that_of_the_notes(vt_map):
    """3.9 MPa m/s at the continuous torque and the no-load speed, over the bush's own length of 9.8 mm."""
    actuator = vt_map.lookup(4.0)
    found = service_sheet(actuator, vt_map.settings).bush
    assert found.pv_mpa_m_per_s == pytest.approx(3.9, abs=0.05)
    length = actuator.face_width_mm + 2 * 1.3
    assert found.pressure_mpa == pytest.approx(actuator.continuous_torque_n_m / (5 * 0.015) / (6.0 * length))


def test_pressure_on_the_duty_s_bush_is_that_of_its_mean_torque(vt_map):
    """By angle of the levels, over five pins of 6 mm on 15 mm: the torque that the pressure makes is the mean one."""
    actuator, duty = vt_map.lookup(4.0), vt_map.settings.parts.duty
    pressure_mpa = service_sheet(actuator, vt_map.settings).bush_duty.pressure_mpa
    torque_n_m = pressure_mpa * 6.0 * (actuator.face_width_mm + 2 * 1.3) * 5 * 0.015
    assert torque_n_m / actuator.peak_torque_n_m == pytest.approx(
        np.average(duty.torque_shares, weights=duty.output_angles_rad)
    )


def test_sources_multiply_and_none_gains(vt_map):
    for ratio in (4.0, 6.0, 7.9):
        actuator = vt_map.lookup(ratio)
        losses = service_sheet(actuator, vt_map.settings).losses
        parts = (losses.efficiency_mesh, losses.efficiency_planets, losses.efficiency_bearings)
        assert losses.efficiency_churning == 1.0
        assert losses.efficiency_total == pytest.approx(math.prod(parts))
        assert all(0.9 < part < 1.0 for part in parts)
        assert losses.efficiency_mesh == actuator.efficiency


def test_bearing_loss_is_skf_s_simple_model(vt_map):
    """0.0015 P d / 2 at each bearing's own speed, the main bearing once, at its load on the knee."""
    actuator = vt_map.lookup(6.0)
    sheet = service_sheet(actuator, vt_map.settings)
    by_place = {found.place: found for found in sheet.bearings}
    lost = 0.0
    for place, friction, bore_m, turns in (
        ("main, knee", 0.0015, 0.040, 1.0),
        ("far, knee", 0.0020, 0.012, 1.0),
        ("end", 0.0015, 0.006, 5.0),
        ("rear", 0.0015, 0.010, 6.0),
    ):
        lost += friction * by_place[place].equivalent_n * 0.5 * bore_m * turns
    assert 1.0 - sheet.losses.efficiency_bearings == pytest.approx(lost / actuator.peak_torque_n_m)


def test_churning_is_an_option_and_follows_palmgren(vt_map):
    actuator = vt_map.lookup(6.0)
    thin = replace(default_service(), lubricant_viscosity_mm2_per_s=1.0)
    sheet = service_sheet(actuator, vt_map.settings, thin)
    # Below nu n = 2000: M0 = 160e-7 f0 dm^3 N mm, whatever the speed; dm of 6808, HK1210, 696, 6800.
    drag = sum(
        160e-7 * 2.0 * dm**3 * 1e-3 * turns for dm, turns in ((46.0, 1.0), (14.0, 1.0), (10.5, 5.0), (14.5, 6.0))
    )
    assert 1.0 - sheet.losses.efficiency_churning == pytest.approx(drag / actuator.peak_torque_n_m)
    thick = replace(default_service(), lubricant_viscosity_mm2_per_s=100.0)
    found = churning_loss(sheet.bearings[:1], 1.0, thick)
    flow = 100.0 * default_service().mean_speed_rad_per_s * 30.0 / math.pi
    assert found == pytest.approx(1e-7 * 2.0 * flow ** (2 / 3) * 46.0**3 * 1e-3)


def test_the_measured_printed_gearbox_asks_for_these_friction_coefficients():
    """25/65/155, module 0.5, three planets: what docs/actuators.md says of measured efficiencies of 0.80 and 0.51."""
    printed = GearSet(sun_teeth=25, planet_teeth=65, ring_teeth=155, module_mm=0.5, planets=3)

    def total(friction):
        return efficiency(printed, friction) * (1.0 - planet_bearing_loss(printed, 6.0, friction))

    def friction_for(value):
        low, high = 0.0, 2.0
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if total(middle) > value else (low, middle)
        return low

    assert friction_for(0.80) == pytest.approx(0.46, abs=0.01)
    assert friction_for(0.51) == pytest.approx(1.23, abs=0.01)
    assert total(0.3) == pytest.approx(0.86, abs=0.01)


def test_losses_print_their_product():
    assert Losses(
        efficiency_mesh=0.9, efficiency_planets=0.8, efficiency_bearings=0.7, efficiency_churning=0.5
    ).efficiency_total == pytest.approx(0.252)
