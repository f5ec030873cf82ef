import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.jump.calibration import SpringContact, load_calibration
from pareto_monoped.jump.model import compression_m, start_pose
from tests.jump.robots import plausible_robots

LENGTHS = st.floats(0.3, 0.5)


def _design(thigh, shank):
    return np.array([[thigh, shank, 6.0, 6.0, 50.0, 2.5, 10.0]])


def test_equilateral_leg_stands_at_sixty_degrees():
    # Both links as long as the line from hip to foot: with the paper's rigid start that is 0.5 m less the radius.
    calibration = load_calibration("paper")
    pose = start_pose(plausible_robots(_design(0.475, 0.475)), calibration)  # radius 0.025
    assert np.degrees(pose.hip_rad[0]) == pytest.approx(-60.0)
    assert np.degrees(pose.knee_rad[0]) == pytest.approx(120.0)


@given(LENGTHS, LENGTHS)
def test_foot_is_below_the_base_and_carries_the_weight(thigh, shank):
    calibration, robots = load_calibration(), plausible_robots(_design(thigh, shank))
    pose = start_pose(robots, calibration)
    assert pose.reason == ("",)
    hip, knee = pose.hip_rad[0], pose.knee_rad[0]
    x = -thigh * np.sin(hip) - shank * np.sin(hip + knee)
    z = 0.5 - thigh * np.cos(hip) - shank * np.cos(hip + knee)
    assert x == pytest.approx(0.0, abs=1e-12)
    sunk = robots.foot_radius_m[0] - z
    assert sunk == pytest.approx(compression_m(calibration.contact, robots.body_mass_kg.sum(axis=1) * 9.81)[0])
    assert knee > 0.0


@pytest.mark.parametrize(
    ("thigh", "shank", "reason"),
    [
        (0.2, 0.2, "shorter than"),
        (1.2, 0.3, "cannot fold"),
        (2.0, 2.0, "the knee would stand at 16"),
        (0.24, 0.238, "the knee would stand at 1"),
        (0.2, 0.58, "the hip would stand at -11"),
    ],
)
def test_what_cannot_stand_says_why(thigh, shank, reason):
    pose = start_pose(plausible_robots(_design(thigh, shank)), load_calibration())
    assert reason in pose.reason[0]
    assert np.isnan(pose.hip_rad[0])
    assert np.isnan(pose.knee_rad[0])


@given(st.floats(1.0, 900.0))
def test_compression_follows_the_documented_spring(force):
    contact = SpringContact(
        kind="spring",
        stiffness_n_per_m=3e5,
        damping_n_s_per_m=300.0,
        width_m=0.003,
        impedance=0.2,
        friction=1.0,
    )
    u = compression_m(contact, np.array([force]))[0] / contact.width_m
    assert u < 1.0 + 1e-12
    # k w u^3 (1 - d) / (1 - d u); MuJoCo's smallest impedance of 1e-4 adds a little near u = 0
    documented = 900.0 * u**3 * 0.8 / (1.0 - 0.2 * u)
    assert force == pytest.approx(documented, rel=0.02)


def test_compression_beyond_the_width_is_linear():
    contact = load_calibration().contact
    force = 3.0 * contact.stiffness_n_per_m * contact.width_m
    assert compression_m(contact, np.array([force]))[0] == pytest.approx(3.0 * contact.width_m)
