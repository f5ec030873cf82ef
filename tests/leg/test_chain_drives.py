"""Chains and sprockets against ISO 606, and the choice between them."""

import numpy as np
import pytest

from pareto_monoped.leg.dimensions import CHAIN_DRIVES, SAFETY, chain_drive_for

LIGHT, MIDDLE, HEAVY = CHAIN_DRIVES


def test_chains_are_those_of_iso_606():
    """Inner width, width over the inner plates, pin's diameter, plate's height, breaking load: ISO 606, table 1."""
    table = {
        "081": (3.3, 5.8, 3.66, 9.91, 8000.0),
        "083": (4.88, 7.9, 4.09, 10.3, 11600.0),
        "084": (4.88, 8.8, 4.09, 11.15, 15600.0),
    }
    for drive in CHAIN_DRIVES:
        assert table.pop(drive.name) == (
            drive.inner_width_mm,
            drive.inner_link_mm,
            drive.pin_diameter_mm,
            drive.plate_mm,
            drive.breaking_n,
        )
        assert (drive.pitch_mm, drive.roller_mm) == (12.7, 7.75)
        # ISO 606 with h14 (ISO 286: 0.25 mm to 3 mm, 0.3 mm to 6 mm), in halves of whole 0.1 mm.
        assert 0.93 * drive.inner_width_mm - 0.25 <= drive.sprocket_width_mm <= 0.93 * drive.inner_width_mm
        assert 5.0 * drive.sprocket_width_mm == pytest.approx(round(5.0 * drive.sprocket_width_mm), abs=1e-9)
        assert drive.inner_width_mm < drive.inner_link_mm < drive.pin_mm
        assert drive.pin_diameter_mm < drive.roller_mm < drive.plate_mm
        assert drive.bearing_area_mm2 == pytest.approx(drive.pin_diameter_mm * drive.inner_link_mm)
    assert not table


def test_all_chains_run_on_the_same_circle():
    # 12.7 mm with 14 teeth: d = 57.07 mm.
    for drive in CHAIN_DRIVES:
        assert 2.0 * drive.pitch_radius_mm == pytest.approx(57.07, abs=0.005)


def test_a_chain_breaks_at_five_times_its_largest_torque():
    # 15.6 kN on a radius of 28.54 mm: 445.2 N m.
    assert SAFETY == 5.0
    assert 5.0 * HEAVY.torque_limit_n_m == pytest.approx(15600.0 * 0.5 * 12.7e-3 / np.sin(np.pi / 14))
    assert HEAVY.torque_limit_n_m == pytest.approx(89.04, abs=0.01)


def test_the_smallest_chain_that_carries_the_torque_in_the_stop_is_chosen():
    """In the stop it is 1.8 times the motor's."""
    limit = LIGHT.torque_limit_n_m / 1.8
    assert chain_drive_for(0.0) is LIGHT
    assert chain_drive_for(limit * (1.0 - 1e-12)) is LIGHT
    assert chain_drive_for(limit * (1.0 + 1e-12)) is MIDDLE
    assert chain_drive_for(MIDDLE.torque_limit_n_m) is HEAVY
    assert chain_drive_for(10.0 * HEAVY.torque_limit_n_m) is HEAVY
