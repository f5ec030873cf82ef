"""Robots whose hip and knee have different motors, and those whose motors are named twice."""

import dataclasses

import numpy as np
import pytest

from pareto_monoped.actuator.motors import motor_names
from pareto_monoped.actuator.ratiomap import JointMaps, joint_maps, motor_label
from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import LOWER, PAPER_CASES, UPPER, complete
from pareto_monoped.errors import DesignError
from pareto_monoped.geometry.roles import Role
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.document import mjcf
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.robot.build import build_robot
from pareto_monoped.robot.population import robot_arrays
from pareto_monoped.strength.factors import TABLE, capacities

PAIRS = [("VT8020", "U8"), ("U8", "VT8020"), ("U12", "MN8014"), ("MN8014", "U12")]
DESIGNS = complete(
    np.vstack(
        [
            [case.design.as_array()[: len(LOWER)] for case in PAPER_CASES.values()],
            np.random.default_rng(3).uniform(LOWER, UPPER, (12, len(LOWER))),
        ]
    )
)
CALIBRATION = load_calibration("reference")


def pair(hip, knee):
    return JointMaps(hip=map_for(hip), knee=map_for(knee))


TRIED = pytest.mark.parametrize(
    ("hip", "knee"),
    [pytest.param(*pair, marks=() if pair[0] in ("U8", "MN8014") else pytest.mark.long) for pair in PAIRS],
)
"""A stronger knee, and a motor that has no frameless body, every time; also the other way round in long tests."""


@pytest.mark.parametrize(
    "motor",
    [pytest.param(name, marks=() if name in ("VT8020", "MN8014") else pytest.mark.long) for name in motor_names()],
)
def test_one_motor_named_twice_is_that_motor_to_the_last_bit(motor):
    alone, twice = map_for(motor), pair(motor, motor)
    one, other = (Evaluator(maps, CALIBRATION)(DESIGNS).as_columns() for maps in (alone, twice))
    assert all(one[name].tobytes() == other[name].tobytes() for name in one)
    arrays, again = (robot_arrays(DESIGNS, maps, CALIBRATION.mass) for maps in (alone, twice))
    for field in dataclasses.fields(arrays):
        assert np.array_equal(getattr(arrays, field.name), getattr(again, field.name)), field.name
    assert mjcf(arrays, CALIBRATION) == mjcf(again, CALIBRATION)
    robots = [build_robot(PAPER_CASES["C"].design, maps) for maps in (alone, twice)]
    assert repr(dataclasses.asdict(robots[0])) == repr(dataclasses.asdict(robots[1]))


@TRIED
def test_the_weighed_population_is_the_robots_part_by_part(hip, knee):
    maps = pair(hip, knee)
    arrays = robot_arrays(DESIGNS, maps)
    for i, case in enumerate(PAPER_CASES.values()):
        robot = build_robot(case.design, maps)
        assert (robot.hip.motor.name, robot.knee.motor.name) == (hip, knee)
        for k, body in enumerate(robot.body_mass_properties().values()):
            assert arrays.body_mass_kg[i, k] == pytest.approx(float(body.mass_kg), rel=1e-11)
            assert arrays.body_com_m[i, k] == pytest.approx(body.com_m, rel=1e-9, abs=1e-12)
            assert arrays.body_inertia_kg_m2[i, k] == pytest.approx(body.inertia_kg_m2, rel=1e-8, abs=1e-12)


@TRIED
def test_each_joint_turns_with_its_own_motor(hip, knee):
    """Column by column: what drives the hip is that of a robot with the hip's motor at both joints, and so the knee."""
    mixed, alone = (
        robot_arrays(DESIGNS, pair(hip, knee)),
        [robot_arrays(DESIGNS, map_for(name)) for name in (hip, knee)],
    )
    for name in (
        "ratio",
        "armature_kg_m2",
        "rotor_inertia_kg_m2",
        "peak_torque_n_m",
        "continuous_torque_n_m",
        "no_load_speed_rad_per_s",
        "efficiency",
        "efficiency_total",
        "torque_constant_n_m_per_a",
        "winding_resistance_ohm",
    ):
        for k in (0, 1):
            assert np.array_equal(getattr(mixed, name)[:, k], getattr(alone[k], name)[:, k]), name
    assert np.array_equal(mixed.rotor_excess_kg_m2, alone[1].rotor_excess_kg_m2)
    # Each body carries its own actuator: the hip's is in the base, the knee's in the thigh.
    for body, k in ((0, 0), (1, 1)):
        away = np.abs(mixed.body_mass_kg[:, body] - alone[k].body_mass_kg[:, body])
        assert away.max() < 0.15  # plates, rods and drivers that fit the other motor, too
        assert np.all(np.abs(mixed.body_mass_kg[:, body] - alone[1 - k].body_mass_kg[:, body]) > away)


@pytest.mark.parametrize(
    ("hip", "knee"), [PAIRS[1], *(pytest.param(*pair, marks=pytest.mark.long) for pair in (PAIRS[0], *PAIRS[2:]))]
)
def test_capacities_of_a_side_are_those_of_its_motor_s_gearboxes(hip, knee):
    """What the actuator alone decides is as in a robot with this motor at both joints."""
    mixed = capacities(pair(hip, knee))
    for side, motor in (("hip", hip), ("knee", knee)):
        alone = capacities(joint_maps(map_for(motor)))
        assert np.array_equal(mixed.row[side], alone.row[side])
        own = [k for k, joint in enumerate(TABLE) if joint.name.startswith(f"{side}_gear_")]
        assert len(own) >= 2
        for k in own:
            one, other = mixed.values[side][:, mixed.columns[k]], alone.values[side][:, alone.columns[k]]
            assert np.array_equal(one, other)


@TRIED
def test_each_driver_carries_its_own_motor(hip, knee):
    robot = build_robot(PAPER_CASES["C"].design, pair(hip, knee))
    boards = {part.name: part for unit in robot.units for part in unit.parts if part.role is Role.ELECTRONICS}
    for joint, motor in (("hip", hip), ("knee", knee)):
        alone = build_robot(PAPER_CASES["C"].design, map_for(motor)).leg.of(joint)
        assert boards[f"{joint}_driver"].described == "; ".join(
            filter(None, (f"motor driver {alone.driver.name}, bare board", alone.driver_note))
        )
        assert float(boards[f"{joint}_driver"].mass_kg()) == pytest.approx(alone.driver.mass_kg)


def test_a_pair_weighs_little_more_than_its_halves():
    """Against the mean of both robots with one motor: only plates and rods that fit the wider motor are added."""
    for hip, knee in PAIRS:
        both, one, other = (
            build_robot(PAPER_CASES["C"].design, maps).mass_kg
            for maps in (pair(hip, knee), map_for(hip), map_for(knee))
        )
        swapped = build_robot(PAPER_CASES["C"].design, pair(knee, hip)).mass_kg
        assert abs(0.5 * (both + swapped) - 0.5 * (one + other)) < 0.08


def test_a_missing_gearbox_is_that_of_the_joint():
    maps = pair("U8", "VT8020")
    design = PAPER_CASES["C"].design.replace({"knee_ratio": 14.95})
    (reason,) = robot_arrays(design.as_array(), maps).reason
    assert reason.startswith("knee_ratio = 14.95: VT8020 has no gearbox")
    with pytest.raises(DesignError, match="VT8020"):
        build_robot(design, maps)


def test_maps_of_different_rules_make_no_robot():
    with pytest.raises(
        DesignError, match=r"^rules of the hip's gearboxes = 'paper': must be those of the knee's"
    ) as caught:
        JointMaps(hip=map_for("U8", "paper"), knee=map_for("U8", "iso6336"))
    assert "\n" not in str(caught.value)


def test_labels_name_the_joints_only_where_the_motors_differ():
    assert (motor_label("U8", "U8"), pair("U8", "U12").label) == ("U8", "U8 hip, U12 knee")
    assert pair("U8", "U8") == pair("U8", "U8") == joint_maps(map_for("U8"))
