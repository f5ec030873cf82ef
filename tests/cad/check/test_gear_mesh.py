"""Gears that mesh in the pose but not while they turn."""

import dataclasses

import pytest

from pareto_monoped.cad.check import free_motion
from pareto_monoped.cad.check.result import GEAR_MESH


@pytest.mark.parametrize("joint", ["hip", "knee"])
@pytest.mark.parametrize("factor", [1.3, 0.7])
def test_a_sun_that_turns_too_fast_or_too_slowly_is_found(product, failing, joint, factor):
    actuator = getattr(product.robot, joint)
    wrong = dataclasses.replace(actuator, ratio=factor * actuator.ratio)
    broken = dataclasses.replace(product, robot=dataclasses.replace(product.robot, **{joint: wrong}))
    check = free_motion.check_gear_mesh(broken)
    assert check.measured > GEAR_MESH.value
    assert all(f"{joint}_actuator/sun" in text and "of the gears' cycle" in text for text in check.failures)
    if (joint, factor) == ("hip", 1.3):
        assert failing(product=broken) == ["gears mesh"]


@pytest.mark.parametrize("joint", ["hip", "knee"])
def test_planets_that_do_not_roll_on_their_ring_are_found(product, joint):
    actuator = getattr(product.robot, joint)
    gears = dataclasses.replace(actuator.gears, ring_teeth=actuator.gears.ring_teeth - 12)
    robot = dataclasses.replace(product.robot, **{joint: dataclasses.replace(actuator, gears=gears)})
    texts = free_motion.check_gear_mesh(dataclasses.replace(product, robot=robot)).failures
    assert any(f"{joint}_actuator/ring" in text and f"{joint}_actuator/planet" in text for text in texts)


def test_the_cycle_is_one_tooth_of_the_sun(product, monkeypatch):
    """In steps; the first is the pose itself."""
    poses = []
    instances = free_motion.instances

    def seen(robot, pose, **only):
        poses.append(pose)
        return instances(robot, pose, **only)

    monkeypatch.setattr(free_motion, "instances", seen)
    free_motion.in_gear_cycle(product)
    assert len(poses) == 2 * free_motion.STEPS
    cycles = poses[: free_motion.STEPS], poses[free_motion.STEPS :]
    for actuator, cycle in zip((product.robot.hip, product.robot.knee), cycles, strict=True):
        teeth = [pose.hip_rad * actuator.ratio * actuator.gears.sun_teeth / 6.283185307179586 for pose in cycle]
        assert teeth == pytest.approx([k / free_motion.STEPS for k in range(free_motion.STEPS)])
        assert [pose.knee_rad for pose in cycle] == [pose.hip_rad for pose in cycle]
