"""MJCF and URDF load where they are used, and carry the simulated robot."""

import xml.etree.ElementTree as ET

import mujoco
import numpy as np
import pytest

from pareto_monoped.cad.check.mass import weigh_bodies, weigh_parts
from pareto_monoped.design import Design
from pareto_monoped.jump import single
from pareto_monoped.robot.population import robot_arrays


@pytest.fixture(scope="module")
def built(exported):
    return Design(**exported.record["as_built"])


def test_mjcf_makes_the_as_built_jump(exported, built, actuator_map, calibration, monkeypatch):
    robots = robot_arrays(built.as_array(), actuator_map, calibration.mass)
    control = built.as_array()[None, 4:7]
    plain = single.trace_of(robots, control, calibration)
    # The paper's controller on the exported document, in the place of the one that the simulation would write.
    load, path = mujoco.MjModel.from_xml_path, str(exported.folder / "model" / "monoped.xml")
    monkeypatch.setattr(mujoco.MjModel, "from_xml_string", staticmethod(lambda text: load(path)))
    with_meshes = single.trace_of(robots, control, calibration)
    assert with_meshes["base_z_m"].max() == pytest.approx(exported.record["jumps"]["as_built"]["height_m"], abs=1e-9)
    for name, values in plain.items():
        # The same state at every step, so the same work too.
        assert with_meshes[name] == pytest.approx(values, abs=1e-9, nan_ok=True), name


def test_mjcf_has_names_meshes_and_colliders(exported):
    model = mujoco.MjModel.from_xml_path(str(exported.folder / "model" / "monoped.xml"))
    motors = ["knee_motor", "hip_motor"]
    assert [model.body(k).name for k in range(1, model.nbody)] == ["base", "thigh", "shank", *motors]
    assert [model.joint(k).name for k in range(model.njnt)] == ["slide_x", "slide_z", "hip", "knee", *motors]
    assert model.geom("foot").type[0] == mujoco.mjtGeom.mjGEOM_SPHERE
    visual = [k for k in range(model.ngeom) if model.geom(k).name.endswith("_visual")]
    collider = [k for k in range(model.ngeom) if model.geom(k).name.endswith("_collider")]
    assert len(visual) >= 6
    assert len(collider) == 5
    assert all(model.geom_contype[k] == model.geom_conaffinity[k] == 0 for k in visual)
    primitive = {int(mujoco.mjtGeom.mjGEOM_BOX), int(mujoco.mjtGeom.mjGEOM_CYLINDER)}
    assert {int(model.geom_type[k]) for k in collider} == primitive
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    assert all({model.geom(c.geom[0]).name, model.geom(c.geom[1]).name} == {"floor", "foot"} for c in data.contact)


def test_urdf_loads_with_the_simulated_masses_and_inertias(exported, built, actuator_map):
    path = exported.folder / "model" / "monoped.urdf"
    model = mujoco.MjModel.from_xml_path(str(path))
    robots = robot_arrays(built.as_array(), actuator_map)
    # MuJoCo welds the URDF's root link to the world.
    assert [model.body(k).name for k in range(1, model.nbody)] == ["thigh", "shank"]
    assert model.body_mass[1:] == pytest.approx(robots.body_mass_kg[0, 1:], rel=1e-9)
    assert np.sort(model.body_inertia[2]) == pytest.approx(
        np.sort(np.linalg.eigvalsh(robots.body_inertia_kg_m2[0, 2])), rel=1e-6
    )
    root = ET.parse(path).getroot()
    assert [link.get("name") for link in root.findall("link")] == ["base", "thigh", "shank", "foot"]
    knee = root.find("joint[@name='knee']")
    assert knee.find("axis").get("xyz") == "0 1 0"
    assert float(knee.find("origin").get("xyz").split()[2]) == -built.thigh_length_m
    assert float(knee.find("limit").get("effort")) == pytest.approx(33.0)
    for mesh in root.iter("mesh"):
        assert (path.parent / mesh.get("filename")).is_file()
    base_mass = root.find("link[@name='base']/inertial/mass").get("value")
    assert float(base_mass) == pytest.approx(robots.body_mass_kg[0, 0])


def test_bodies_of_solids_are_the_bodies_that_jump(product, actuator_map):
    robots = robot_arrays(product.robot.design.as_array(), actuator_map)
    bodies = weigh_bodies(product, weigh_parts(product))
    for k, body in enumerate(("base", "thigh", "shank")):
        cad = bodies[body]
        assert float(cad.mass_kg) == pytest.approx(robots.body_mass_kg[0, k], rel=5e-3)
        assert cad.com_m == pytest.approx(robots.body_com_m[0, k], abs=1e-4)
        inertia = np.diag(robots.body_inertia_kg_m2[0, k])
        assert np.diag(cad.inertia_kg_m2) == pytest.approx(inertia, rel=0.03)
