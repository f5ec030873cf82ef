"""The exported MJCF of very different robots, in plain MuJoCo: it stands, jumps and stops as simulated."""

import importlib.util
import json
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from xml.etree import ElementTree as ET

import mujoco
import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.as_built import as_built
from pareto_monoped.cad.write.mjcf import jump_record, mjcf_with_meshes, replay_script
from pareto_monoped.cad.write.urdf import urdf
from pareto_monoped.design import PAPER_CASES, Design
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.document import mjcf
from pareto_monoped.jump.end_stops import end_stops as end_stops_of
from pareto_monoped.jump.end_stops import slow_torque_n_m
from pareto_monoped.jump.model import start_pose
from pareto_monoped.robot.population import RobotArrays, robot_arrays

CALIBRATION = load_calibration("reference")
# Lowest, knee and highest of a front of 800 jumps of studies/quick.toml; a case of the paper; another motor.
DESIGNS = {
    "lowest": ("VT8020", (0.398, 0.3, 4.578, 4.6, 5.929, 9.711, 3.178)),
    "knee": ("VT8020", (0.4, 0.39, 6.05, 4.6, 12.0, 9.0, 6.0)),
    "highest": ("VT8020", (0.5, 0.499, 8.384, 4.059, 19.392, 7.709, 6.695)),
    "case A": ("VT8020", tuple(PAPER_CASES["A"].design.as_array())),
    "U12": ("U12", (0.45, 0.4, 6.2, 6.0, 60.0, 3.0, 15.0)),
}


@dataclass
class Exported:
    """The files of one design's model, as an export writes them, but for meshes."""

    folder: Path
    arrays: RobotArrays
    model: mujoco.MjModel


@pytest.fixture(scope="module", params=DESIGNS)
def exported(request, tmp_path_factory):
    motor, values = DESIGNS[request.param]
    actuator_map, folder = map_for(motor), tmp_path_factory.mktemp("model")
    design = as_built(Design.from_array(values), actuator_map)
    arrays = robot_arrays(design.as_array(), actuator_map, CALIBRATION.mass)
    (folder / "monoped.xml").write_text(mjcf_with_meshes(mjcf(arrays, CALIBRATION), (), ()))
    (folder / "monoped.urdf").write_text(urdf(arrays, CALIBRATION.joints, (), ()))
    (folder / "jump.json").write_text(jump_record(arrays, design, CALIBRATION))
    (folder / "replay.py").write_text(replay_script())
    return Exported(folder, arrays, mujoco.MjModel.from_xml_path(str(folder / "monoped.xml")))


def at_keyframe(model):
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.keyframe("start").id)
    return data


def test_stands_at_its_keyframe(exported):
    """The foot lies under the base, carries the weight, and the joints are those of the start pose."""
    data = at_keyframe(exported.model)
    mujoco.mj_forward(exported.model, data)
    pose = start_pose(exported.arrays, CALIBRATION)
    assert data.joint("hip").qpos[0] == pose.hip_rad[0]
    assert data.joint("knee").qpos[0] == pose.knee_rad[0]
    assert data.site("foot").xpos[0] == pytest.approx(0.0, abs=1e-12)
    # Held by torques that balance gravity and the floor, nothing moves.
    weight = exported.arrays.body_mass_kg[0].sum() * 9.81
    jacobian = np.zeros((3, exported.model.nv))
    mujoco.mj_jacSite(exported.model, data, jacobian, None, exported.model.site("foot").id)
    data.ctrl[:] = (data.qfrc_bias - weight * jacobian[2])[-2:]
    mujoco.mj_forward(exported.model, data)
    assert np.abs(data.qacc).max() < 0.05


def test_jumps_as_simulated(exported):
    spec = importlib.util.spec_from_file_location("replay", resources.files("pareto_monoped") / "data" / "replay.py")
    replay = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(replay)
    expected = json.loads((exported.folder / "jump.json").read_text())["expected"]
    assert expected["height_m"] > 0.6
    found = replay.replay(exported.folder)
    names = ("height_m", "energy_j", "electrical_energy_j")
    for name, value in zip(names, found, strict=True):
        assert value == pytest.approx(expected[name], rel=1e-9), name


@pytest.mark.parametrize("end", ["lower", "upper"])
@pytest.mark.parametrize("joint", ["hip", "knee"])
def test_pushes_back_beyond_its_stops_and_nowhere_before(exported, joint, end):
    stop = dict(zip(("hip", "knee"), end_stops_of(exported.arrays, CALIBRATION.joints), strict=True))[joint]
    part = getattr(exported.arrays.stops, joint)
    outwards = {"lower": -1.0, "upper": 1.0}[end]
    limit = getattr(part, f"{end}_rad")
    for share in (-0.01, 0.1, 0.5, 1.0):
        data = at_keyframe(exported.model)
        data.joint("slide_z").qpos[0] = 3.0  # in the air
        data.joint(joint).qpos[0] = limit + outwards * share * part.travel_rad
        mujoco.mj_forward(exported.model, data)
        pushes = data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_LIMIT_JOINT)
        if share < 0.0:
            assert not pushes.any()
            continue
        (torque,) = (data.efc_aref / data.efc_R)[pushes]
        expected = slow_torque_n_m(stop, np.array([share * part.travel_rad]))[0]
        assert torque == pytest.approx(expected, rel=0.005)
        assert torque == pytest.approx(
            part.torque_n_m(share * part.travel_rad), abs=0.065 * part.torque_n_m(part.travel_rad)
        )


@pytest.mark.parametrize("end", ["lower", "upper"])
def test_a_knee_thrown_into_a_stop_comes_back_with_a_part_of_its_speed(exported, end):
    """In the air and without gravity; the rest of the robot is free and takes a part of the impact."""
    model, part = exported.model, exported.arrays.stops.knee
    model.opt.gravity[:] = 0.0
    data = at_keyframe(model)
    data.joint("slide_z").qpos[0] = 3.0
    outwards, limit = {"lower": (-1.0, part.lower_rad), "upper": (1.0, part.upper_rad)}[end]
    data.joint("knee").qpos[0] = limit - outwards * 0.02
    data.joint("knee").qvel[0] = 15.0 * outwards
    before, deepest = None, 0.0
    for _ in range(200):
        mujoco.mj_step(model, data)
        beyond = outwards * (data.joint("knee").qpos[0] - limit)
        deepest = max(deepest, beyond)
        if beyond <= 0.0 and deepest > 0.0:
            break
        before = data.joint("knee").qvel[0] if deepest == 0.0 else before
    model.opt.gravity[2] = -9.81
    assert 0.1 * part.travel_rad < deepest < part.travel_rad
    assert 0.05 < -data.joint("knee").qvel[0] / (before or 15.0 * outwards) < 0.5


def test_limits_are_the_angles_of_touch_in_both_files(exported):
    root = ET.parse(exported.folder / "monoped.urdf").getroot()
    for joint in ("hip", "knee"):
        part, limit = getattr(exported.arrays.stops, joint), root.find(f"joint[@name='{joint}']/limit")
        assert exported.model.joint(joint).range.tolist() == [part.lower_rad, part.upper_rad]
        assert [float(limit.get(end)) for end in ("lower", "upper")] == [part.lower_rad, part.upper_rad]


def test_inertias_are_equal_but_for_the_rotors(exported):
    """At any pose, the URDF's mass matrix with the parts that turn added is that of the MJCF's joints."""
    loaded = mujoco.MjModel.from_xml_path(str(exported.folder / "monoped.urdf"))
    arrays, rng = exported.arrays, np.random.default_rng(2)
    for _ in range(5):
        angles = rng.uniform([part.lower_rad for part in (arrays.stops.hip, arrays.stops.knee)], 1.7)
        matrices = []
        for model in (exported.model, loaded):
            data = mujoco.MjData(model)
            for joint, angle in zip(("hip", "knee"), angles, strict=True):
                data.joint(joint).qpos[0] = angle
            mujoco.mj_forward(model, data)
            matrix = np.zeros((model.nv, model.nv))
            mujoco.mj_fullM(model, data, matrix)
            matrices.append(matrix[-2:, -2:])
        coupling, reflected = arrays.knee_coupling_kg_m2[0], arrays.knee_reflected_kg_m2[0]
        rotors = np.array(
            [[arrays.armature_kg_m2[0, 0] + arrays.rotor_excess_kg_m2[0], coupling], [coupling, reflected]]
        )
        np.testing.assert_allclose(matrices[0], matrices[1] + rotors, rtol=1e-9)
