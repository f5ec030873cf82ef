"""Turns between the frames of units, parts and bodies."""

import numpy as np
import pytest

from pareto_monoped.geometry.parts import MassProperties
from pareto_monoped.robot.units import OVER, PART_TO_BODY, UPRIGHT, in_body

X, Y, Z = np.eye(3)


def test_parts_have_the_joint_axis_along_z_and_bodies_along_y():
    np.testing.assert_array_equal(PART_TO_BODY @ X, X)  # forward
    np.testing.assert_array_equal(PART_TO_BODY @ Y, Z)  # up
    np.testing.assert_array_equal(PART_TO_BODY @ Z, -Y)  # to the right


def test_the_knee_actuator_is_turned_over_about_the_forward_axis():
    np.testing.assert_array_equal(OVER @ X, X)
    np.testing.assert_array_equal(OVER @ Y, -Y)
    np.testing.assert_array_equal(OVER @ Z, -Z)


def test_turns_are_shared_and_cannot_be_changed():
    for turn in (PART_TO_BODY, UPRIGHT, OVER):
        with pytest.raises(ValueError, match="read-only"):
            turn[0, 0] = 2.0


def test_a_point_mass_is_turned_then_moved_along_the_joint_axis():
    at = np.array([0.1, 0.2, 0.3])
    point = MassProperties(mass_kg=np.array(2.0), first_kg_m=2.0 * at, second_kg_m2=2.0 * np.outer(at, at))
    moved = in_body(point, OVER, 50.0)
    # Turned over: (0.1, -0.2, -0.3); moved: z = -0.25; in the body frame y = -z and z = y.
    np.testing.assert_allclose(moved.com_m, [0.1, 0.25, -0.2], atol=1e-15)
    np.testing.assert_allclose(moved.inertia_kg_m2, np.zeros((3, 3)), atol=1e-15)
