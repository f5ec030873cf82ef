"""Forward kinematics and the turning of parts, against MuJoCo's and Willis's."""

import mujoco
import numpy as np
import pytest

from pareto_monoped.cad.assembly import Pose, body_frames, instances, turn_y
from pareto_monoped.jump.document import mjcf
from pareto_monoped.robot.population import robot_arrays


@pytest.mark.parametrize(("hip_rad", "knee_rad"), [(0.0, 0.0), (-0.7, 1.5), (0.9, 2.2), (-1.5, 0.3)])
def test_the_foot_is_where_mujoco_has_it(product, actuator_map, calibration, hip_rad, knee_rad):
    robots = robot_arrays(product.robot.design.as_array(), actuator_map)
    model = mujoco.MjModel.from_xml_string(mjcf(robots, calibration))
    data = mujoco.MjData(model)
    data.joint("hip").qpos[0], data.joint("knee").qpos[0] = hip_rad, knee_rad
    mujoco.mj_kinematics(model, data)
    expected = 1e3 * (data.site("foot").xpos - data.body("base").xpos)
    shank = body_frames(product.robot, Pose(hip_rad=hip_rad, knee_rad=knee_rad))["shank"]
    foot = shank @ np.array([0.0, 0.0, -1e3 * product.robot.design.shank_length_m, 1.0])
    assert foot[:3] == pytest.approx(expected, abs=1e-9)


def test_frames_are_rotations_and_the_knee_hangs_on_the_thigh(product):
    frames = body_frames(product.robot, Pose(hip_rad=0.4, knee_rad=-0.2))
    for frame in frames.values():
        assert frame[:3, :3] @ frame[:3, :3].T == pytest.approx(np.eye(3), abs=1e-12)
    knee = frames["shank"][:3, 3]
    assert np.linalg.norm(knee) == pytest.approx(1e3 * product.robot.design.thigh_length_m)
    assert frames["shank"][:3, :3] == pytest.approx(turn_y(0.2)[:3, :3])


def test_every_part_has_as_many_instances_as_its_record_says(product):
    names = [instance.name for instance in product.instances]
    assert len(set(names)) == len(names)
    for unit in product.robot.units:
        for part in unit.parts:
            count = sum(i.unit == unit.name and i.part is part for i in product.instances)
            assert count == int(part.count) * len(part.places_mm)


def test_the_hip_s_output_turns_with_the_thigh_and_the_sun_by_the_ratio(product):
    robot = product.robot
    zero, turned = (instances(robot, Pose(hip_rad=angle, knee_rad=0.0)) for angle in (0.0, 0.01))

    def angle_of(name):
        one, other = (next(i for i in found if i.name == f"hip_actuator/{name}").world for found in (zero, turned))
        rotation = other[:3, :3] @ one[:3, :3].T
        return np.arctan2(rotation[0, 2], rotation[0, 0])

    assert angle_of("carrier") == pytest.approx(0.01)
    assert angle_of("casing") == pytest.approx(0.0)
    assert angle_of("sun") == pytest.approx(0.01 * robot.hip.ratio)
    gears = robot.hip.gears
    # Willis with the ring fixed: planet against carrier by -ring / planet, so absolutely 1 - ring / planet.
    assert angle_of("planet_1") == pytest.approx(0.01 * (1.0 - gears.ring_teeth / gears.planet_teeth))


def test_the_chain_drive_turns_with_the_shank(product):
    bent = instances(product.robot, Pose(hip_rad=0.3, knee_rad=0.8))
    drive = next(i for i in bent if i.name == "thigh/drive_sprocket").world
    driven = next(i for i in bent if i.name == "shank/knee_axle").world
    assert drive[:3, :3] == pytest.approx(driven[:3, :3], abs=1e-12)
