"""Chains and sprockets against ISO 606, and the choice between them."""

import numpy as np
import pytest

from pareto_monoped.leg.chain_drives import CHAIN_DRIVES, chain_drive_for

LIGHT, HEAVY = CHAIN_DRIVES


def test_chains_are_those_of_iso_606():
    assert (LIGHT.name, LIGHT.pitch_mm, LIGHT.roller_mm, LIGHT.inner_width_mm) == ("05B-1", 8.0, 5.0, 3.0)
    assert (HEAVY.name, HEAVY.pitch_mm, HEAVY.roller_mm, HEAVY.inner_width_mm) == ("06B-1", 9.525, 6.35, 5.72)
    assert (LIGHT.breaking_n, HEAVY.breaking_n) == (4400.0, 8900.0)
    for drive in CHAIN_DRIVES:
        assert drive.sprocket_width_mm == pytest.approx(0.93 * drive.inner_width_mm, abs=0.03)
        assert drive.inner_width_mm < drive.inner_link_mm < drive.pin_mm
        assert drive.pin_diameter_mm < drive.roller_mm < drive.plate_mm


def test_both_pitch_circles_fit_the_same_plates():
    # 05B-1 with 20 teeth: d = 51.14 mm; 06B-1 with 17: 0.7 mm more.
    assert 2.0 * LIGHT.pitch_radius_mm == pytest.approx(51.14, abs=0.005)
    assert 2.0 * (HEAVY.pitch_radius_mm - LIGHT.pitch_radius_mm) == pytest.approx(0.7, abs=0.05)


def test_a_chain_breaks_at_twice_its_largest_torque():
    # 4.4 kN on a radius of 25.57 mm: 112.5 N m.
    assert 2.0 * LIGHT.torque_limit_n_m == pytest.approx(4400.0 * 0.5 * 8e-3 / np.sin(np.pi / 20))
    assert LIGHT.torque_limit_n_m == pytest.approx(56.26, abs=0.01)


def test_the_smallest_chain_that_carries_the_torque_is_chosen():
    assert chain_drive_for(0.0) is LIGHT
    assert chain_drive_for(LIGHT.torque_limit_n_m) is LIGHT
    assert chain_drive_for(np.nextafter(LIGHT.torque_limit_n_m, np.inf)) is HEAVY
    assert chain_drive_for(10.0 * HEAVY.torque_limit_n_m) is HEAVY
