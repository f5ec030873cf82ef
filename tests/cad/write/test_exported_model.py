"""The exported MJCF of very different robots, in plain MuJoCo: it stands, jumps and stops as simulated."""

import importlib.util
import json
from dataclasses import dataclass
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
from pareto_monoped.jump.calibration import Calibration, load_calibration
from pareto_monoped.jump.document import mjcf
from pareto_monoped.jump.end_stops import end_stops as end_stops_of
from pareto_monoped.jump.end_stops import slow_torque_n_m
from pareto_monoped.jump.model import start_pose
from pareto_monoped.robot.population import RobotArrays, robot_arrays

CALIBRATIONS = {name: load_calibration(name) for name in ("reference", "reference-3")}
"""The default, whose drives are elastic and whose stops are motors; rigid drives and stops that are joint limits."""
# Lowest, knee and highest of a front of 800 jumps of studies/quick.toml; a case of the paper; another motor.
DESIGNS = {
    "lowest": ("VT8020", (0.398, 0.3, 4.578, 4.6, 5.929, 9.711, 3.178)),
    "knee": ("VT8020", (0.4, 0.39, 6.05, 4.6, 12.0, 9.0, 6.0)),
    "highest": ("VT8020", (0.5, 0.499, 8.384, 4.059, 19.392, 7.709, 6.695)),
    "case A": ("VT8020", tuple(PAPER_CASES["A"].design.as_array())),
    "U12": ("U12", (0.45, 0.4, 6.2, 6.0, 60.0, 3.0, 15.0)),
}


# Every calibration, and designs that differ most; the others take long.
EVERY_TIME = (("lowest", "reference-3"), ("highest", "reference"), ("case A", "reference"))


def some(known):
    """Names of designs, of which a calibration has only some every time."""
    return [pytest.param(n, marks=() if (n, known) in EVERY_TIME[:2] else pytest.mark.long) for n in DESIGNS]


@dataclass
class Exported:
    """The files of one design's model, as an export writes them, but for meshes."""

    folder: Path
    calibration: Calibration
    arrays: RobotArrays
    model: mujoco.MjModel


def made(name, calibration, folder):
    motor, values = DESIGNS[name]
    actuator_map = map_for(motor)
    design = as_built(Design.from_array(values), actuator_map)
    arrays = robot_arrays(design.as_array(), actuator_map, calibration.mass)
    (folder / "monoped.xml").write_text(mjcf_with_meshes(mjcf(arrays, calibration), (), ()))
    (folder / "monoped.urdf").write_text(urdf(arrays, calibration.joints, (), ()))
    (folder / "jump.json").write_text(jump_record(arrays, design, calibration))
    (folder / "replay.py").write_text(replay_script())
    return Exported(folder, calibration, arrays, mujoco.MjModel.from_xml_path(str(folder / "monoped.xml")))


@pytest.fixture(
    scope="module",
    params=[
        pytest.param((name, known), marks=() if (name, known) in EVERY_TIME else pytest.mark.long)
        for name in DESIGNS
        for known in CALIBRATIONS
    ],
    ids="-".join,
)
def exported(request, tmp_path_factory):
    name, known = request.param
    return made(name, CALIBRATIONS[known], tmp_path_factory.mktemp("model"))


@pytest.fixture(scope="module", params=some("reference-3"))
def rigid(request, tmp_path_factory):
    return made(request.param, CALIBRATIONS["reference-3"], tmp_path_factory.mktemp("rigid"))


@pytest.fixture(scope="module", params=some("reference"))
def elastic(request, tmp_path_factory):
    return made(request.param, CALIBRATIONS["reference"], tmp_path_factory.mktemp("elastic"))


def replay_of(exported):
    """The module ``replay``, and what it reads."""
    spec = importlib.util.spec_from_file_location("replay", exported.folder / "replay.py")
    replay = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(replay)
    return replay, json.loads((exported.folder / "jump.json").read_text())


def at_keyframe(model):
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.keyframe("start").id)
    return data


def test_stands_at_its_keyframe(exported):
    """The foot lies under the base, carries the weight, and the joints are those of the start pose."""
    data = at_keyframe(exported.model)
    mujoco.mj_forward(exported.model, data)
    pose = start_pose(exported.arrays, exported.calibration)
    assert data.joint("hip").qpos[0] == pose.hip_rad[0]
    assert data.joint("knee").qpos[0] == pose.knee_rad[0]
    assert data.site("foot").xpos[0] == pytest.approx(0.0, abs=1e-12)
    # Held by torques that balance gravity and the floor, nothing moves.
    weight = exported.arrays.body_mass_kg[0].sum() * 9.81
    jacobian = np.zeros((3, exported.model.nv))
    mujoco.mj_jacSite(exported.model, data, jacobian, None, exported.model.site("foot").id)
    for k, joint in enumerate(("hip", "knee")):
        place = exported.model.joint(joint).dofadr[0]
        data.ctrl[k] = data.qfrc_bias[place] - weight * jacobian[2, place]
    mujoco.mj_forward(exported.model, data)
    assert np.abs(data.qacc).max() < 0.05


def test_jumps_as_simulated(exported):
    replay, jump = replay_of(exported)
    expected = jump["expected"]
    assert expected["height_m"] > 0.6
    found = replay.replay(exported.folder)
    names = ("height_m", "energy_j", "electrical_energy_j")
    for name, value in zip(names, found, strict=True):
        assert value == pytest.approx(expected[name], rel=1e-9), name


@pytest.mark.parametrize("end", ["lower", "upper"])
@pytest.mark.parametrize("joint", ["hip", "knee"])
def test_pushes_back_beyond_its_stops_and_nowhere_before(rigid, joint, end):
    stop = dict(zip(("hip", "knee"), end_stops_of(rigid.arrays, rigid.calibration.joints), strict=True))[joint]
    part = getattr(rigid.arrays.stops, joint)
    outwards = {"lower": -1.0, "upper": 1.0}[end]
    limit = getattr(part, f"{end}_rad")
    for share in (-0.01, 0.1, 0.5, 1.0):
        data = at_keyframe(rigid.model)
        data.joint("slide_z").qpos[0] = 3.0  # in the air
        data.joint(joint).qpos[0] = limit + outwards * share * part.travel_rad
        mujoco.mj_forward(rigid.model, data)
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
def test_a_knee_thrown_into_a_stop_comes_back_with_a_part_of_its_speed(rigid, end):
    """In the air and without gravity; the rest of the robot is free and takes a part of the impact."""
    model, part = rigid.model, rigid.arrays.stops.knee
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


@pytest.mark.parametrize("end", ["lower", "upper"])
@pytest.mark.parametrize("joint", ["hip", "knee"])
def test_the_replay_pushes_back_as_the_part_does(elastic, joint, end):
    """Slowly, with the part's own torque; nothing else in the file stops a joint."""
    replay, jump = replay_of(elastic)
    part, k = getattr(elastic.arrays.stops, joint), ("hip", "knee").index(joint)
    outwards, limit = {"lower": (-1.0, part.lower_rad), "upper": (1.0, part.upper_rad)}[end]
    assert not elastic.model.jnt_limited.any()
    for share in (-0.01, 0.1, 0.5, 1.0):
        angles = np.array([0.0, 1.0])
        angles[k] = limit + outwards * share * part.travel_rad
        torques = replay.bumpers(jump, angles, np.zeros(2))
        assert torques[1 - k] == 0.0
        expected = 0.0 if share < 0.0 else part.torque_n_m(share * part.travel_rad)
        assert -outwards * torques[k] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("end", ["lower", "upper"])
def test_a_knee_that_the_replay_stops_comes_back_with_a_part_of_its_speed(elastic, end):
    """In the air and without gravity, with the motor's rotor behind its elastic drive."""
    (replay, jump), model, part = replay_of(elastic), elastic.model, elastic.arrays.stops.knee
    model.opt.gravity[:] = 0.0
    data = at_keyframe(model)
    data.joint("slide_z").qpos[0] = 3.0
    outwards, limit = {"lower": (-1.0, part.lower_rad), "upper": (1.0, part.upper_rad)}[end]
    for name in ("knee", "knee_motor"):
        data.joint(name).qpos[0], data.joint(name).qvel[0] = limit - outwards * 0.02, 15.0 * outwards
    places = [model.joint(name).dofadr[0] for name in ("hip", "knee")]
    deepest = 0.0
    for _ in range(1000):
        data.ctrl[2:] = replay.bumpers(jump, data.qpos[places], data.qvel[places])
        mujoco.mj_step(model, data)
        beyond = outwards * (data.joint("knee").qpos[0] - limit)
        deepest = max(deepest, beyond)
        if beyond <= 0.0 and deepest > 0.0:
            break
    model.opt.gravity[2] = -9.81
    assert 0.1 * part.travel_rad < deepest < part.travel_rad
    assert 0.0 < -data.joint("knee").qvel[0] * outwards / 15.0 < 0.5


def test_limits_are_the_angles_of_touch_in_both_files(exported):
    root = ET.parse(exported.folder / "monoped.urdf").getroot()
    for joint in ("hip", "knee"):
        part, limit = getattr(exported.arrays.stops, joint), root.find(f"joint[@name='{joint}']/limit")
        if not exported.calibration.drive.elastic:
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
            # With motors that turn as their joints do.
            turned = np.array(
                [[model.joint(k).name.startswith(joint) for joint in ("hip", "knee")] for k in range(model.njnt)]
            )
            matrices.append(turned.T @ matrix @ turned)
        coupling, reflected = arrays.knee_coupling_kg_m2[0], arrays.knee_reflected_kg_m2[0]
        rotors = np.array(
            [[arrays.armature_kg_m2[0, 0] + arrays.rotor_excess_kg_m2[0], coupling], [coupling, reflected]]
        )
        np.testing.assert_allclose(matrices[0], matrices[1] + rotors, rtol=1e-9)
