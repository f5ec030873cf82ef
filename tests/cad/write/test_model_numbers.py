"""Every number of URDF and MJCF against the robot that is simulated, and against the parts that are drawn."""

import xml.etree.ElementTree as ET

import mujoco
import numpy as np
import pytest
import trimesh

from pareto_monoped.design import Design
from pareto_monoped.robot.build import build_robot
from pareto_monoped.robot.population import robot_arrays


@pytest.fixture(scope="module")
def built(exported):
    return Design(**exported.record["as_built"])


@pytest.fixture(scope="module")
def robots(built, actuator_map):
    return robot_arrays(built.as_array(), actuator_map)


@pytest.fixture(scope="module")
def urdf(exported):
    parser = ET.XMLParser(target=ET.TreeBuilder(insert_comments=True))
    return ET.parse(exported.folder / "model" / "monoped.urdf", parser=parser).getroot()


def numbers(element, name):
    return [float(word) for word in element.get(name).split()]


@pytest.mark.parametrize(("body", "name"), list(enumerate(("base", "thigh", "shank"))))
def test_inertials_stand_at_the_centre_of_mass_along_the_body_s_axes(urdf, robots, body, name):
    inertial = urdf.find(f"link[@name='{name}']/inertial")
    assert numbers(inertial.find("origin"), "xyz") == pytest.approx(robots.body_com_m[0, body], abs=0.0)
    assert numbers(inertial.find("origin"), "rpy") == [0.0, 0.0, 0.0]
    tensor = robots.body_inertia_kg_m2[0, body]
    entries = inertial.find("inertia")
    for row, column, key in ((0, 0, "ixx"), (1, 1, "iyy"), (2, 2, "izz"), (0, 1, "ixy"), (0, 2, "ixz"), (1, 2, "iyz")):
        assert float(entries.get(key)) == tensor[row, column]


@pytest.mark.parametrize(
    ("joint", "name", "parent", "child"), [(0, "hip", "base", "thigh"), (1, "knee", "thigh", "shank")]
)
def test_joints_have_their_own_actuator_s_limits(urdf, robots, joint, name, parent, child):
    element = urdf.find(f"joint[@name='{name}']")
    assert (element.find("parent").get("link"), element.find("child").get("link")) == (parent, child)
    assert element.find("axis").get("xyz") == "0 1 0"
    limit = element.find("limit")
    stop = getattr(robots.stops, name)
    assert (float(limit.get("lower")), float(limit.get("upper"))) == (stop.lower_rad, stop.upper_rad)
    assert float(limit.get("effort")) == robots.peak_torque_n_m[0, joint]
    assert float(limit.get("velocity")) == robots.no_load_speed_rad_per_s[0, joint]
    (comment,) = [e.text for e in urdf if e.tag is ET.Comment and e.text.startswith(f" {name}:")]
    reflected = {"hip": robots.armature_kg_m2[0, 0], "knee": robots.knee_reflected_kg_m2[0]}[name]
    assert comment.startswith(f" {name}: reflected rotor inertia {float(reflected)!r} kg m2")
    coupling = (
        f"coupled with the thigh's rotation by {float(robots.knee_coupling_kg_m2[0])!r} kg m2; URDF can hold neither"
    )
    assert (coupling in comment) == (name == "knee")


@pytest.mark.parametrize("name", ["hip", "knee"])
def test_joints_of_the_urdf_lose_what_motors_of_the_mjcf_lose(exported, urdf, name):
    """The URDF's drives are rigid, so that its joints turn with their motors."""
    model = mujoco.MjModel.from_xml_path(str(exported.folder / "model" / "monoped.xml"))
    dynamics = urdf.find(f"joint[@name='{name}']/dynamics")
    assert float(dynamics.get("damping")) == model.joint(f"{name}_motor").damping[0] > 0.0
    assert float(dynamics.get("friction")) == model.joint(f"{name}_motor").frictionloss[0] > 0.0


def test_the_foot_has_a_frame_at_the_centre_of_its_sphere(urdf, robots):
    joint = urdf.find("joint[@name='foot']")
    assert joint.get("type") == "fixed"
    assert (joint.find("parent").get("link"), joint.find("child").get("link")) == ("shank", "foot")
    assert numbers(joint.find("origin"), "xyz") == [0.0, 0.0, -robots.shank_length_m[0]]
    assert len(urdf.find("link[@name='foot']")) == 0


def test_hip_and_knee_differ_so_that_a_swap_would_show(robots):
    for pair in (robots.peak_torque_n_m[0], robots.no_load_speed_rad_per_s[0], robots.armature_kg_m2[0]):
        assert pair[0] != pair[1]
    assert robots.stops.hip.upper_rad != robots.stops.knee.upper_rad


def test_the_foot_s_sphere_is_the_simulation_s(urdf, robots, built):
    foot = urdf.find("link[@name='shank']/collision[@name='foot']")
    assert numbers(foot.find("origin"), "xyz") == [0.0, 0.0, -built.shank_length_m]
    assert float(foot.find("geometry/sphere").get("radius")) == robots.foot_radius_m[0]


def test_urdf_and_mjcf_have_the_same_colliders_and_they_cover_the_robot(exported, urdf, built, actuator_map):
    model = mujoco.MjModel.from_xml_path(str(exported.folder / "model" / "monoped.xml"))
    robot = build_robot(built, actuator_map)
    found = {e.get("name"): e for e in urdf.iter("collision") if e.get("name") != "foot"}
    assert set(found) == {"hip_actuator", "knee_actuator", "frame", "thigh", "shank"}
    for name, element in found.items():
        geom = model.geom(f"{name}_collider")
        assert numbers(element.find("origin"), "xyz") == pytest.approx(geom.pos, abs=1e-12)
        rotation = np.zeros(9)
        mujoco.mju_quat2Mat(rotation, geom.quat)
        if name.endswith("_actuator"):
            actuator = robot.hip if name == "hip_actuator" else robot.knee
            cylinder = element.find("geometry/cylinder")
            assert float(cylinder.get("radius")) == pytest.approx(geom.size[0])
            assert float(cylinder.get("length")) == pytest.approx(2.0 * geom.size[1])
            assert 2e3 * geom.size[1] == pytest.approx(actuator.length_mm)
            assert 1e3 * geom.size[0] == pytest.approx(actuator.mount.housing_radius_mm)
            # Along the joint's axis: z of the primitive is y of the body.
            assert np.abs(rotation.reshape(3, 3)[:, 2]) == pytest.approx([0.0, 1.0, 0.0], abs=1e-9)
            assert numbers(element.find("origin"), "rpy") == pytest.approx([np.pi / 2.0, 0.0, 0.0])
        else:
            assert numbers(element.find("geometry/box"), "size") == pytest.approx(2.0 * geom.size)
            assert rotation.reshape(3, 3) == pytest.approx(np.eye(3), abs=1e-12)
    for name in ("thigh", "shank"):
        geom = model.geom(f"{name}_collider")
        core = trimesh.load(exported.folder / "parts" / "stl" / f"{name}_core.stl").extents
        # A millimetre of margin on each side.
        assert sorted(2e3 * geom.size - 2.0) == pytest.approx(sorted(core), abs=0.05)
        assert geom.pos[2] < 0.0


def test_the_actuators_colliders_are_where_their_parts_are(product):
    from pareto_monoped.cad.shape.meshes import placed
    from pareto_monoped.cad.write.meshes import colliders

    by_name = {collider.name: collider for collider in colliders(product)}
    for name in ("hip_actuator", "knee_actuator"):
        boxes = np.array(
            [
                placed(unique.mesh.body, instance.in_body).bounding_box()
                for instance, unique in product.placed()
                if instance.unit == name
            ]
        )
        middle_mm = 0.5 * (boxes[:, 1].min() + boxes[:, 4].max())
        assert 1e3 * by_name[name].position[1] == pytest.approx(middle_mm, abs=8.0)


def test_meshes_of_the_models_are_in_metres(exported, built):
    meshes = [trimesh.load(path) for path in sorted((exported.folder / "model" / "meshes").glob("thigh_*.stl"))]
    height = max(mesh.bounds[1, 2] for mesh in meshes) - min(mesh.bounds[0, 2] for mesh in meshes)
    assert built.thigh_length_m < height < built.thigh_length_m + 0.2
