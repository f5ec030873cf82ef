"""Torques by shape and by bonding, against stresses integrated over faces and sections."""

import numpy as np
import pytest

from pareto_monoped.strength.connections import (
    BOND_MPA,
    bearing_force_n,
    bond_torque_n_m,
    pin_bending_force_n,
    shear_force_n,
    spline_torque_n_m,
    torsion_torque_n_m,
)

N = 20000


def middles(low, high):
    return low + (np.arange(N) + 0.5) / N * (high - low), (high - low) / N


def test_a_spline_s_flanks_press_evenly():
    """Eighteen flanks from 4.23 to 5 mm, 3 mm long, three in four of them at 460 MPa."""
    r, dr = middles(4.23, 5.0)
    torque_n_mm = 0.75 * 18 * np.sum(460.0 * 3.0 * r * dr)
    assert spline_torque_n_m(18.0, 4.23, 5.0, 3.0, 460.0) == pytest.approx(1e-3 * torque_n_mm)


def test_a_shaft_yields_first_at_its_surface():
    r, dr = middles(0.0, 4.0)
    stress = 850.0 / np.sqrt(3.0) * r / 4.0
    assert torsion_torque_n_m(4.0, 850.0) == pytest.approx(1e-3 * np.sum(stress * 2.0 * np.pi * r**2 * dr), rel=1e-6)


def test_a_bond_shears_all_around():
    angle, da = middles(0.0, 2.0 * np.pi)
    assert bond_torque_n_m(40.0, 12.0) == pytest.approx(1e-3 * np.sum(BOND_MPA * 40.0 * 12.0 * 40.0 * da + 0.0 * angle))


def test_a_dowel_presses_on_its_projected_face():
    """Radial pressure p cos(a) over half the hole has the resultant pi/4 of that; the mean one is F / (d l)."""
    angle, da = middles(-0.5 * np.pi, 0.5 * np.pi)
    even = np.sum(250.0 * np.cos(angle) * 1.5 * da * 2.5)
    assert bearing_force_n(3.0, 2.5, 250.0) == pytest.approx(even, rel=1e-6)


def test_a_dowel_s_shear_is_greatest_in_its_middle():
    """Jourawski on a circle: tau = F S / (I b) in the middle, with S = 2 r^3 / 3, I = pi r^4 / 4, b = 2 r."""
    r, force = 1.25, shear_force_n(2.5, 1300.0)
    tau = force * (2.0 * r**3 / 3.0) / (0.25 * np.pi * r**4 * 2.0 * r)
    assert np.sqrt(3.0) * tau == pytest.approx(1300.0)


def test_a_pin_bends_most_in_its_middle():
    span, force = 20.0, pin_bending_force_n(6.0, 20.0, 1300.0)
    x, dx = middles(0.0, 0.5 * span)
    moment = 0.5 * force * 0.5 * span - np.sum(force / span * (0.5 * span - x) * dx)
    assert moment * 3.0 / (np.pi * 6.0**4 / 64.0) == pytest.approx(1300.0, rel=1e-6)
