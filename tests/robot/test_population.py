"""A population is the same robots as one by one, and options change only what they name."""

import numpy as np
import pytest

from pareto_monoped.actuator.motors import motor_names
from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import NAMES, PAPER_CASES, Design
from pareto_monoped.errors import DesignError
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.robot.build import build_robot
from pareto_monoped.robot.population import PARTS_ONLY, MassOptions, robot_arrays
from pareto_monoped.robot.tables import actuator_table, actuator_units, weighed
from pareto_monoped.robot.units import BODIES, JOINTS


def assert_same_robot(arrays, i, robot):
    """Row i of the arrays is this robot."""
    for b, (body, mass) in enumerate(robot.body_mass_properties().items()):
        assert body == BODIES[b]
        np.testing.assert_allclose(arrays.body_mass_kg[i, b], mass.mass_kg, rtol=1e-12)
        np.testing.assert_allclose(arrays.body_com_m[i, b], mass.com_m, rtol=0, atol=1e-12)
        np.testing.assert_allclose(arrays.body_inertia_kg_m2[i, b], mass.inertia_kg_m2, rtol=1e-9, atol=1e-12)
    assert (arrays.thigh_length_m[i], arrays.shank_length_m[i]) == (
        robot.design.thigh_length_m,
        robot.design.shank_length_m,
    )
    foot = next(part for unit in robot.units for part in unit.parts if part.name == "foot")
    assert arrays.foot_radius_m[i] == pytest.approx(1e-3 * foot.balls[0].radius_mm, rel=1e-15)
    for j, actuator in enumerate((robot.hip, robot.knee)):
        assert arrays.ratio[i, j] == actuator.ratio
        assert arrays.armature_kg_m2[i, j] == actuator.reflected_inertia_kg_m2
        assert arrays.torque_constant_n_m_per_a[i, j] == actuator.motor.torque_constant_n_m_per_a
        assert arrays.winding_resistance_ohm[i, j] == actuator.motor.terminal_resistance_ohm
        for name in ("peak_torque_n_m", "continuous_torque_n_m", "no_load_speed_rad_per_s", "efficiency"):
            assert getattr(arrays, name)[i, j] == getattr(actuator, name), name
    assert robot.mass_kg == pytest.approx(arrays.body_mass_kg[i].sum(), rel=1e-12)
    cost = robot.cost
    assert arrays.cost_eur[i] == pytest.approx(cost.total_eur, rel=1e-12)
    assert (arrays.made_parts[i], arrays.bought_parts[i]) == (cost.made, cost.bought)


@pytest.mark.parametrize(
    "motor",
    [pytest.param(name, marks=() if name in ("VT8020", "MN8014") else pytest.mark.long) for name in motor_names()],
)
def test_a_population_is_the_robots_one_by_one(motor, designs):
    actuator_map = map_for(motor)
    arrays = robot_arrays(designs, actuator_map)
    rows = [i for i, reason in enumerate(arrays.reason) if not reason]
    assert len(rows) >= 3
    for i in rows:
        assert_same_robot(arrays, i, build_robot(Design.from_array(designs[i]), actuator_map))


@pytest.mark.parametrize("length_m", [0.1, 0.2499, 0.2501, 0.5499, 0.5501, 1.2])
def test_links_of_any_length_weigh_what_their_parts_weigh(actuator_map, length_m):
    """Lengths beyond the tables too, in one population with lengths within them."""
    design = PAPER_CASES["C"].design.replace({"thigh_length_m": length_m, "shank_length_m": length_m})
    values = np.stack([PAPER_CASES["C"].design.as_array(), design.as_array()])
    assert_same_robot(robot_arrays(values, actuator_map), 1, build_robot(design, actuator_map))


@pytest.mark.parametrize("rows", [[5], [5, 3], list(range(23, -1, -1)), [5] * 100])
def test_a_row_is_the_same_to_the_last_bit_in_any_company(designs, actuator_map, rows):
    everyone = robot_arrays(designs, actuator_map)
    some = robot_arrays(designs[rows], actuator_map)
    for name in ("body_mass_kg", "body_com_m", "body_inertia_kg_m2", "armature_kg_m2"):
        assert np.array_equal(getattr(everyone, name)[rows], getattr(some, name)), name


def test_ratio_is_the_gearboxs_within_the_interval_asked_for(designs, actuator_map, buildable):
    arrays = robot_arrays(designs, actuator_map)
    asked = designs[:, [NAMES.index(f"{joint}_ratio") for joint in JOINTS]]
    low = np.floor(10 * asked[buildable]) / 10
    stood_in = np.array([[bool(actuator_map.stand_in(ratio)) for ratio in row] for row in asked[buildable]])
    assert np.all(stood_in | (arrays.ratio[buildable] >= low - 1e-12) & (arrays.ratio[buildable] < low + 0.1))
    assert not stood_in.all()


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


def test_options_set_what_they_name(designs, actuator_map, buildable):
    plain = robot_arrays(designs[buildable], actuator_map, PARTS_ONLY)
    hip_mass = [build_robot(Design.from_array(designs[i]), actuator_map).hip.mass_kg for i in buildable]
    changed = robot_arrays(
        designs[buildable],
        actuator_map,
        MassOptions(base_structure_mass_kg=0.0, foot_mass_kg=0.2, foot_radius_m=0.03, rotor_inertia_kg_m2=2e-5),
    )
    np.testing.assert_allclose(changed.body_mass_kg[:, 0], hip_mass, rtol=1e-9)
    np.testing.assert_array_equal(changed.body_mass_kg[:, 1], plain.body_mass_kg[:, 1])
    foot = [
        next(u for u in build_robot(Design.from_array(designs[i]), actuator_map).units if u.name == "foot")
        for i in buildable
    ]
    expected = plain.body_mass_kg[:, 2] + 0.2 - [float(u.mass_properties().mass_kg) for u in foot]
    np.testing.assert_allclose(changed.body_mass_kg[:, 2], expected, rtol=1e-9)
    assert np.all(changed.foot_radius_m == 0.03)
    np.testing.assert_allclose(changed.armature_kg_m2, 2e-5 * plain.ratio**2, rtol=1e-12)
    # What is coupled beyond the chain's own is the rotor at its speed, and nothing is left over.
    half = robot_arrays(designs[buildable], actuator_map, MassOptions(rotor_inertia_kg_m2=1e-5))
    coupled = changed.knee_coupling_kg_m2 - half.knee_coupling_kg_m2
    np.testing.assert_allclose(coupled, 1e-5 * plain.ratio[:, 1], rtol=1e-9)
    assert not changed.rotor_excess_kg_m2.any()


def test_link_scale_touches_links_only(designs, actuator_map, buildable):
    plain, light = (robot_arrays(designs[buildable], actuator_map, MassOptions(link_mass_scale=s)) for s in (1.0, 0.5))
    for i, row in enumerate(buildable):
        units = {u.name: u for u in build_robot(Design.from_array(designs[row]), actuator_map).units}
        for body, name in ((1, "thigh"), (2, "shank")):
            half = 0.5 * float(units[name].mass_properties().mass_kg)
            assert plain.body_mass_kg[i, body] - light.body_mass_kg[i, body] == pytest.approx(half, rel=1e-9)


def test_a_ratio_without_gearbox_is_a_reason_not_an_exception(actuator_map):
    design = PAPER_CASES["C"].design.replace({"knee_ratio": 14.95})
    (reason,) = robot_arrays(design.as_array(), actuator_map).reason
    assert reason.startswith("knee_ratio")
    with pytest.raises(DesignError):
        build_robot(design, actuator_map)


def test_a_body_s_actuator_is_added_last(designs, actuator_map, buildable):
    """To the last bit, on which the results of stored studies depend."""
    table, leg = actuator_table(actuator_map), leg_dimensions(actuator_map)
    units = actuator_units("knee", actuator_map, leg)
    arrays = robot_arrays(designs, actuator_map)
    differs = 0
    for i in buildable:
        knee = int(table.row[actuator_map.interval_index(designs[i, [NAMES.index("knee_ratio")]])[0]])
        thigh = weighed("thigh_length_m", leg, designs[i : i + 1, NAMES.index("thigh_length_m")])["thigh"].mass_kg[0]
        journal, actuator = (units[name].mass_kg[knee] for name in ("journal", "knee_actuator"))
        assert arrays.body_mass_kg[i, 1] == (thigh + journal) + actuator
        differs += arrays.body_mass_kg[i, 1] != (thigh + actuator) + journal
    assert differs
