"""The ranges of the joints, and the bumpers of the shipped calibrations in front of their ends."""

import numpy as np
import pytest

from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.leg.joint_ranges import HIP_RANGE_RAD, KNEE_RANGE_RAD


def test_ranges_are_those_of_the_docs():
    assert np.degrees(HIP_RANGE_RAD) == pytest.approx([-110.0, 110.0], abs=0.2)
    assert np.degrees(KNEE_RANGE_RAD) == pytest.approx([-150.0, 150.0], abs=0.2)


@pytest.mark.parametrize("name", ["reference", "ideal"])
def test_bumpers_are_met_10_degrees_before_the_ends_and_are_compressed_at_them(name):
    joints = load_calibration(name).joints
    for stop, limits in ((joints.hip_stop, HIP_RANGE_RAD), (joints.knee_stop, KNEE_RANGE_RAD)):
        assert stop.width_rad == pytest.approx(np.radians(10.0), abs=1e-4)
        assert stop.upper_rad + stop.width_rad == pytest.approx(limits[1], abs=0.003)
        assert stop.upper_rad + stop.width_rad <= limits[1]
        assert stop.lower_rad - stop.width_rad >= limits[0]
    assert joints.hip_stop.lower_rad == -joints.hip_stop.upper_rad
    # The knee bends one way only: its lower bumper ends 5 degrees before the straight leg.
    assert joints.knee_stop.lower_rad - joints.knee_stop.width_rad == pytest.approx(np.radians(5.0), abs=1e-4)
