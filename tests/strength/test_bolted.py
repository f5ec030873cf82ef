"""Screw joints: compliances by integration, threads by their basic profile, preload and slip by plain sums."""

import numpy as np
import pytest

from pareto_monoped.geometry.screws import M3, M4
from pareto_monoped.strength.connections import (
    head_force_n,
    least_preload_n,
    plate_compliance_mm_per_n,
    screw_compliance_mm_per_n,
    slip_force_n,
    thread_force_n,
)

STEEL, ALUMINIUM = 206000.0, 70000.0


def test_plates_give_like_a_cone_of_thin_slices():
    bearing, hole, grip = 5.17, 3.2, 9.0
    z = (np.arange(200000) + 0.5) / 200000 * grip
    area = 0.25 * np.pi * ((bearing + 2.0 * 0.6 * z) ** 2 - hole**2)
    slices = np.mean(grip / (ALUMINIUM * area))
    assert plate_compliance_mm_per_n(bearing, hole, grip, ALUMINIUM) == pytest.approx(slices, rel=1e-6)


def test_a_screw_gives_like_its_cylinders_in_series():
    """M4 in aluminium, grip 10 mm: head of 1.6 and female thread of 1.32 mm nominal, core over the grip and 2 mm."""
    core = 4.0 - 1.226869 * 0.7
    given = 1.6 / (STEEL * np.pi * 4.0) + 12.0 / (STEEL * 0.25 * np.pi * core**2) + 1.32 / (ALUMINIUM * np.pi * 4.0)
    thread = M4.fastening("cap", "8.8").thread
    found = screw_compliance_mm_per_n(thread, 10.0, steel_mpa=STEEL, threaded_into_mpa=ALUMINIUM)
    assert found == pytest.approx(given, rel=1e-6)


def test_preload_left_is_the_least_tightened_less_what_settles():
    """M3, 10.9, 6 mm of aluminium: 3739 N / 1.6 less 10 um over both compliances."""
    found = M3.fastening("cap", "10.9")
    screw = screw_compliance_mm_per_n(found.thread, 6.0, steel_mpa=STEEL, threaded_into_mpa=ALUMINIUM)
    plates = plate_compliance_mm_per_n(0.94 * 5.5, 3.2, 6.0, ALUMINIUM)
    left = least_preload_n(found, 6.0, steel_mpa=STEEL, clamped_mpa=ALUMINIUM)
    assert left == pytest.approx(3739.0 / 1.6 - 0.010 / (screw + plates), rel=2e-4)
    assert 0.3 * found.preload_n < left < found.preload_n / 1.6


def test_a_longer_grip_keeps_more_preload():
    left = [least_preload_n(M3.fastening("cap", "8.8"), g, steel_mpa=STEEL, clamped_mpa=ALUMINIUM) for g in (3, 6, 12)]
    assert left == sorted(left)


def test_slip_is_friction_of_all_screws():
    assert slip_force_n(6.0, 2000.0) == pytest.approx(6 * 0.15 * 2000.0)


@pytest.mark.parametrize("screw", [M3, M4])
def test_a_female_thread_shears_over_seven_eighths_of_its_pitch(screw):
    """Basic profile (ISO 68-1): the screw's crest is an eighth of the pitch wide, the rest is female thread."""
    thread = screw.fastening("cap", "8.8").thread
    surface = np.pi * thread.diameter_mm * 0.875 * 5.0
    assert thread_force_n(thread, 5.0, 144.0) == pytest.approx(0.897 * 144.0 * surface, rel=1e-9)


def test_a_head_presses_on_its_ring():
    """M3: 5.17 to 3.2 mm, one and a half times 250 MPa."""
    ring = np.pi * ((0.5 * 0.94 * 5.5) ** 2 - 1.6**2)
    assert head_force_n(M3.fastening("cap", "8.8"), 250.0) == pytest.approx(ring * 375.0)
