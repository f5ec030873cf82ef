"""Robots one by one and as a population are the same robots, and options change what they name and nothing else."""

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import LOWER, NAMES, PAPER_CASES, UPPER, Design
from pareto_monoped.errors import DesignError
from pareto_monoped.robot.build import build_robot
from pareto_monoped.robot.frames import BODIES, JOINTS
from pareto_monoped.robot.population import PARTS_ONLY, MassOptions, robot_arrays


@pytest.fixture(scope="module")
def actuator_map():
    return map_for("VT8020")


@pytest.fixture(scope="module")
def designs():
    return np.random.default_rng(7).uniform(LOWER, UPPER, (24, 7))


def buildable(designs, actuator_map):
    return [i for i, reason in enumerate(robot_arrays(designs, actuator_map).reason) if not reason]


def test_a_population_weighs_what_its_robots_weigh_one_by_one(designs, actuator_map):
    arrays = robot_arrays(designs, actuator_map)
    rows = buildable(designs, actuator_map)
    assert len(rows) >= 12
    for i in rows:
        robot = build_robot(Design.from_array(designs[i]), actuator_map)
        for b, (body, mass) in enumerate(robot.body_mass_properties().items()):
            assert body == BODIES[b]
            np.testing.assert_allclose(arrays.body_mass_kg[i, b], mass.mass_kg, rtol=1e-12)
            np.testing.assert_allclose(arrays.body_com_m[i, b], mass.com_m, rtol=0, atol=1e-12)
            np.testing.assert_allclose(arrays.body_inertia_kg_m2[i, b], mass.inertia_kg_m2, rtol=1e-9, atol=1e-12)
        for j, actuator in enumerate((robot.hip, robot.knee)):
            assert arrays.ratio[i, j] == actuator.ratio
            assert arrays.peak_torque_n_m[i, j] == actuator.peak_torque_n_m
            assert arrays.armature_kg_m2[i, j] == actuator.reflected_inertia_kg_m2
        assert robot.mass_kg == pytest.approx(arrays.body_mass_kg[i].sum(), rel=1e-12)


@pytest.mark.parametrize("rows", [[5], [5, 3], list(range(23, -1, -1)), [5] * 100])
def test_a_row_is_the_same_to_the_last_bit_in_any_company(designs, actuator_map, rows):
    everyone = robot_arrays(designs, actuator_map)
    some = robot_arrays(designs[rows], actuator_map)
    for name in ("body_mass_kg", "body_com_m", "body_inertia_kg_m2", "armature_kg_m2"):
        assert np.array_equal(getattr(everyone, name)[rows], getattr(some, name)), name


def test_ratio_is_the_gearboxs_within_the_interval_asked_for(designs, actuator_map):
    arrays = robot_arrays(designs, actuator_map)
    rows = buildable(designs, actuator_map)
    asked = designs[:, [NAMES.index(f"{joint}_ratio") for joint in JOINTS]]
    low = np.floor(10 * asked[rows]) / 10
    assert np.all((arrays.ratio[rows] >= low - 1e-12) & (arrays.ratio[rows] < low + 0.1))


def test_the_papers_robots_are_plausible(actuator_map):
    for case in PAPER_CASES.values():
        robot = build_robot(case.design, actuator_map)
        assert 3.0 < robot.mass_kg < 5.0
        thigh = robot.body_mass_properties()["thigh"]
        # The knee actuator sits on the hip axis: the thigh's centre of mass is near the hip, below it.
        assert -0.5 * case.design.thigh_length_m < thigh.com_m[2] < 0.0
        shank = robot.body_mass_properties()["shank"]
        assert -case.design.shank_length_m < shank.com_m[2] < 0.0
        # Everything is symmetric about the plane through the joint axes and the links.
        for mass in (thigh, shank):
            assert abs(mass.com_m[0]) < 1e-3


def test_inertia_tensors_are_physical(designs, actuator_map):
    inertia = robot_arrays(designs, actuator_map).body_inertia_kg_m2
    principal = np.linalg.eigvalsh(inertia)
    assert np.all(principal > 0)
    assert np.all(principal[..., 0] + principal[..., 1] >= principal[..., 2])


def test_longer_links_are_heavier_and_carry_their_mass_lower(actuator_map):
    base = PAPER_CASES["nominal"].design
    lengths = np.linspace(0.3, 0.5, 5)
    arrays = robot_arrays([base.replace({"thigh_length_m": x}).as_array() for x in lengths], actuator_map)
    assert np.all(np.diff(arrays.body_mass_kg[:, 1]) > 0)
    assert np.all(np.diff(arrays.body_com_m[:, 1, 2]) < 0)
    assert np.ptp(arrays.body_mass_kg[:, [0, 2]], axis=0).max() == 0.0


def test_options_set_what_they_name(designs, actuator_map):
    rows = buildable(designs, actuator_map)
    plain = robot_arrays(designs[rows], actuator_map, PARTS_ONLY)
    hip_mass = [build_robot(Design.from_array(designs[i]), actuator_map).hip.mass_kg for i in rows]
    changed = robot_arrays(
        designs[rows],
        actuator_map,
        MassOptions(base_structure_mass_kg=0.0, foot_mass_kg=0.2, foot_radius_m=0.03, rotor_inertia_kg_m2=2e-5),
    )
    np.testing.assert_allclose(changed.body_mass_kg[:, 0], hip_mass, rtol=1e-9)
    np.testing.assert_array_equal(changed.body_mass_kg[:, 1], plain.body_mass_kg[:, 1])
    foot = [
        next(u for u in build_robot(Design.from_array(designs[i]), actuator_map).units if u.name == "foot")
        for i in rows
    ]
    expected = plain.body_mass_kg[:, 2] + 0.2 - [float(u.mass_properties().mass_kg) for u in foot]
    np.testing.assert_allclose(changed.body_mass_kg[:, 2], expected, rtol=1e-9)
    assert np.all(changed.foot_radius_m == 0.03)
    np.testing.assert_allclose(changed.armature_kg_m2, 2e-5 * plain.ratio**2, rtol=1e-12)


def test_link_scale_touches_links_only(designs, actuator_map):
    rows = buildable(designs, actuator_map)
    plain, light = (robot_arrays(designs[rows], actuator_map, MassOptions(link_mass_scale=s)) for s in (1.0, 0.5))
    for i, row in enumerate(rows):
        units = {u.name: u for u in build_robot(Design.from_array(designs[row]), actuator_map).units}
        for body, name in ((1, "thigh"), (2, "shank")):
            half = 0.5 * float(units[name].mass_properties().mass_kg)
            assert plain.body_mass_kg[i, body] - light.body_mass_kg[i, body] == pytest.approx(half, rel=1e-9)


@pytest.mark.parametrize("length_m", [0.1, 0.2499, 0.2501, 0.5499, 0.5501, 1.2])
def test_links_of_any_length_weigh_what_their_parts_weigh(actuator_map, length_m):
    """Also beyond the tables of link masses, beside links that are within them."""
    design = PAPER_CASES["C"].design.replace({"thigh_length_m": length_m, "shank_length_m": length_m})
    values = np.stack([PAPER_CASES["C"].design.as_array(), design.as_array()])
    arrays = robot_arrays(values, actuator_map)
    for b, mass in enumerate(build_robot(design, actuator_map).body_mass_properties().values()):
        np.testing.assert_allclose(arrays.body_mass_kg[1, b], mass.mass_kg, rtol=1e-12)
        np.testing.assert_allclose(arrays.body_com_m[1, b], mass.com_m, rtol=0, atol=1e-12)
        np.testing.assert_allclose(arrays.body_inertia_kg_m2[1, b], mass.inertia_kg_m2, rtol=1e-9, atol=1e-12)


def test_a_ratio_without_gearbox_is_a_reason_not_an_exception(actuator_map):
    design = PAPER_CASES["C"].design.replace({"knee_ratio": 14.95})
    (reason,) = robot_arrays(design.as_array(), actuator_map).reason
    assert reason.startswith("knee_ratio")
    with pytest.raises(DesignError):
        build_robot(design, actuator_map)


def test_a_link_without_length_is_refused(actuator_map):
    with pytest.raises(DesignError, match="shank_length_m"):
        build_robot(PAPER_CASES["C"].design.replace({"shank_length_m": 0.0}), actuator_map)
