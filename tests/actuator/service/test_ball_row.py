"""The load distribution in a row of balls against closed forms, a plain solver, and simple facts."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import fsolve
from scipy.special import ellipe, ellipk

from pareto_monoped.actuator.bearings import rated_bearing, rated_bearings
from pareto_monoped.actuator.service.loads import _POISSON_RATIO, _YOUNGS_MODULUS_MPA, contact_stiffness, row_load
from pareto_monoped.errors import SimulationError

B6808 = rated_bearing(40.0)
CLEARANCE_MM = 0.010


def load(bearing, force_n, moment_n_m, clearance_mm=CLEARANCE_MM):
    return row_load(bearing, np.array([force_n]), np.array([moment_n_m]), clearance_mm)


def plain_balls(bearing, force_n, moment_n_m, clearance_mm):
    """Shift, tilt and ball forces, ball by ball, from the two equations of balance alone (ISO/TS 16281)."""
    ball, count = bearing.ball_diameter_mm, bearing.balls
    free, stiffness = 0.04 * ball, contact_stiffness(bearing)
    arm = bearing.pitch_diameter_mm / 2 + 0.02 * ball
    angles = [2 * math.pi * (j + 0.5) / count for j in range(count)]

    def forces(shift, tilt):
        found = []
        for angle in angles:
            radial = free - clearance_mm / 2 + shift * math.cos(angle)
            axial = arm * tilt * math.cos(angle)
            distance = math.sqrt(radial**2 + axial**2)
            found.append((stiffness * max(distance - free, 0.0) ** 1.5, radial / distance, axial / distance))
        return found

    def unbalanced(state):
        found = forces(state[0], state[1] * 1e-3)
        pull = sum(q * r * math.cos(a) for (q, r, _), a in zip(found, angles, strict=True))
        turn = sum(q * s * math.cos(a) for (q, _, s), a in zip(found, angles, strict=True)) * arm
        return pull - force_n, (turn - 1e3 * moment_n_m) / arm

    shift, milli = fsolve(unbalanced, (0.02, 4.0), xtol=1e-13)
    return shift, milli * 1e-3, [q for q, _, _ in forces(shift, milli * 1e-3)]


@pytest.mark.parametrize(("force_n", "moment_n_m"), [(1291.0, 30.3), (500.0, 45.0), (3000.0, 10.0), (0.0, 31.0)])
@pytest.mark.parametrize("bearing", [B6808, rated_bearing(55.0), rated_bearing(28.0)], ids=lambda b: b.designation)
def test_balance_is_that_of_a_plain_solver(bearing, force_n, moment_n_m):
    shift, tilt, balls = plain_balls(bearing, force_n, moment_n_m, CLEARANCE_MM)
    found = load(bearing, force_n, moment_n_m)
    assert found.shift_mm[0] == pytest.approx(shift, abs=1e-7)
    assert found.tilt_rad[0] == pytest.approx(tilt, rel=1e-6)
    assert found.largest_n[0] == pytest.approx(max(balls), rel=1e-6)


@pytest.mark.parametrize("bearing", rated_bearings(), ids=lambda bearing: bearing.designation)
def test_a_radial_force_without_clearance_is_its_own_equivalent(bearing):
    """ISO 281 rates a row of which half the balls carry; ISO/TS 16281 must then give P = F."""
    force = 0.05 * bearing.dynamic_rating_n
    assert load(bearing, force, 0.0, 0.0).equivalent_n[0] == pytest.approx(force, rel=0.03)


def test_stribeck_s_number_of_a_radial_force():
    """Without clearance, the most loaded ball of many carries 4.37 / Z of the force (Stribeck)."""
    large = rated_bearing(105.0)
    assert load(large, 500.0, 0.0, 0.0).largest_n[0] * large.balls / 500.0 == pytest.approx(4.37, rel=0.02)


def test_a_small_moment_presses_the_worst_ball_as_a_closed_form_says():
    """Without clearance and for a small tilt t, the grooves approach by (R t cos)^2 / 2A, so that Q = Qmax |cos|^3.

    With sin a = R t / A cos, the moment is Z R Qmax sin a times the mean of |cos|^5, which is 16 / (15 pi). (Balls that
    all had the same contact angle would give 4.37 M / (Z Dpw sin a), as in four-point contact bearings.)
    """
    for bearing in (B6808, rated_bearing(105.0)):
        found = load(bearing, 0.0, 1e-3, 0.0)
        arm = bearing.pitch_diameter_mm / 2 + 0.02 * bearing.ball_diameter_mm
        sine = arm * found.tilt_rad[0] / (0.04 * bearing.ball_diameter_mm)
        closed = 1.0 / (bearing.balls * arm * sine * 16.0 / (15.0 * math.pi))
        assert found.largest_n[0] == pytest.approx(closed, rel=0.02)


def test_static_safety_of_a_radial_force_without_clearance():
    """ISO 76 takes 5 / Z for the worst ball, without clearance it is 4.37 / Z: s0 = 5 / 4.37 C0 / F."""
    found = load(B6808, 1000.0, 0.0, 0.0)
    assert found.static_safety[0] == pytest.approx(5.0 / 4.37 * 5550.0 / 1000.0, rel=0.025)


def exact_stiffness(bearing):
    """Hertz with exact elliptic integrals, N/mm^1.5."""
    ball, gamma, softness = bearing.ball_diameter_mm, bearing.ball_diameter_mm / bearing.pitch_diameter_mm, 0.0
    for side in (1, -1):
        along = 2 / ball + side * 2 * gamma / (1 - side * gamma) / ball
        across = 2 / ball - 1 / (0.52 * ball)
        total, difference = along + across, (along - across) / (along + across)
        low, high = 1.0001, 500.0
        for _ in range(200):
            k = 0.5 * (low + high)
            first, second = ellipk(1 - k**-2), ellipe(1 - k**-2)
            if ((k**2 + 1) * second - 2 * first) / ((k**2 - 1) * second) < difference:
                low = k
            else:
                high = k
        approach = 2 * first / math.pi * (math.pi / (2 * k**2 * second)) ** (1 / 3)
        # Approach over force to the power 2/3 (Harris, eq. 6.42 with both bodies of steel).
        softness += approach * (3 / (2 * total) * 2 * (1 - 0.3**2) / 207e3) ** (2 / 3) * total / 2
    return softness**-1.5


def test_rings_and_balls_are_of_the_steel_of_iso_76():
    assert (_YOUNGS_MODULUS_MPA, _POISSON_RATIO) == (2.07e5, 0.3)


@pytest.mark.parametrize("bearing", rated_bearings(), ids=lambda bearing: bearing.designation)
def test_contact_stiffness_is_that_of_the_exact_integrals(bearing):
    assert contact_stiffness(bearing) == pytest.approx(exact_stiffness(bearing), rel=0.03)


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(rated_bearings()),
    st.floats(0.0, 0.3),
    st.floats(0.0, 0.01),
    st.floats(1.05, 3.0),
    st.floats(0.0, 0.03),
)
def test_more_of_the_same_load_is_never_better(bearing, force_share, moment_share, more, clearance):
    force, moment = force_share * bearing.dynamic_rating_n + 1.0, moment_share * bearing.dynamic_rating_n
    moment *= 1e-3 * bearing.pitch_diameter_mm * 10.0
    less = load(bearing, force, moment, clearance)
    again = load(bearing, more * force, more * moment, clearance)
    assert again.equivalent_n[0] > less.equivalent_n[0]
    assert again.largest_n[0] > less.largest_n[0]
    assert again.static_safety[0] < less.static_safety[0]
    assert less.equivalent_n[0] > 0.97 * force


def test_loads_side_by_side_are_as_each_alone():
    forces, moments = np.array([100.0, 1291.0, 3227.0]), np.array([0.0, 30.3, 75.8])
    together = row_load(B6808, forces, moments, CLEARANCE_MM)
    for i, (force, moment) in enumerate(zip(forces, moments, strict=True)):
        alone = load(B6808, force, moment)
        assert together.equivalent_n[i] == pytest.approx(alone.equivalent_n[0], rel=1e-8)
        assert together.static_safety[i] == pytest.approx(alone.static_safety[0], rel=1e-8)


@pytest.mark.parametrize("force_n", [1e-3, 1e6])
@pytest.mark.parametrize("moment_n_m", [0.0, 1e-4, 1e4])
def test_loads_of_every_size_are_balanced(force_n, moment_n_m):
    found = load(B6808, force_n, moment_n_m)
    assert found.largest_n[0] >= 2.0 * force_n / B6808.balls  # as if every ball carried its share
    assert np.isfinite(found.equivalent_n[0])


def test_loads_that_no_row_can_balance_are_refused():
    with pytest.raises(SimulationError, match=r"must be finite and bearable"), np.errstate(invalid="ignore"):
        load(B6808, math.inf, 0.0)
