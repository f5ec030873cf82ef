"""What must not touch does not, and planted faults are found, named and measured."""

import dataclasses

import numpy as np
import pytest

from pareto_monoped.cad.assembly import turn_z
from pareto_monoped.cad.check import overlaps
from pareto_monoped.cad.check.checks import run_checks
from pareto_monoped.cad.product import build_product
from pareto_monoped.robot.build import build_robot
from pareto_monoped.robot.population import robot_arrays


def moved(product, name, matrix):
    """The product with one instance moved by a matrix in its own frame."""
    changed = tuple(
        dataclasses.replace(i, world=i.world @ matrix, in_body=i.in_body @ matrix, moves=i.moves @ matrix)
        if i.name == name
        else i
        for i in product.instances
    )
    assert any(i.name == name for i in product.instances)
    return dataclasses.replace(product, instances=changed)


def bare(robot):
    """The robot without its actuators, which take longest to build."""
    units = tuple(unit for unit in robot.units if not unit.name.endswith("_actuator"))
    return dataclasses.replace(robot, units=units)


def with_unit(product, unit_name, change):
    """The product of a bare robot with one unit changed."""
    robot = bare(product.robot)
    units = tuple(change(unit) if unit.name == unit_name else unit for unit in robot.units)
    return build_product(dataclasses.replace(robot, units=units), product.pose)


def test_nothing_overlaps_and_every_check_passes(product, actuator_map):
    checks = run_checks(product, robot_arrays(product.robot.design.as_array(), actuator_map))
    assert len(checks) == 11
    assert [failure for check in checks for failure in check.failures] == []


def test_a_planet_turned_by_one_degree_is_found(product):
    found, _ = overlaps.in_pose(moved(product, "knee_actuator/planet_2", turn_z(np.radians(1.0))))
    assert {frozenset((o.one, o.other)) for o in found} == {
        frozenset(("knee_actuator/planet_2", "knee_actuator/ring")),
        frozenset(("knee_actuator/planet_2", "knee_actuator/sun")),
    }
    assert all(o.volume_mm3 > 1.0 for o in found)


def test_a_shifted_screw_and_a_wrong_weight_are_found(product, actuator_map):
    sideways = np.eye(4)
    sideways[0, 3] = 0.3
    faulty = moved(product, "thigh/knee_mount_screw_1", sideways)
    heavier = robot_arrays(product.robot.design.replace({"shank_length_m": 0.41}).as_array(), actuator_map)
    checks = {check.name: check for check in run_checks(faulty, heavier)}
    bolts = checks["bolt patterns coincide"]
    assert any("thigh/knee_mount_screw_1: 0.30 mm off its hole in knee_actuator/" in text for text in bolts.failures)
    assert any("thigh/knee_mount_screw_1" in text for text in checks["no two parts overlap"].failures)
    assert [name for name, check in checks.items() if not check.passed] == [
        "shank is the body that was simulated",
        "no two parts overlap",
        "bolt patterns coincide",
    ]


def test_a_frame_in_the_thigh_s_way_is_found(product):
    def lower(unit):
        parts = tuple(
            dataclasses.replace(part, places_mm=tuple((x, y - 30.0, z) for x, y, z in part.places_mm))
            if part.name == "base_rod"
            else part
            for part in unit.parts
        )
        return dataclasses.replace(unit, parts=parts)

    found, _ = overlaps.in_working_range(with_unit(product, "base_frame", lower))
    pairs = {(o.one.rstrip("_1234"), o.other) for o in found}
    assert ("base_frame/base_rod", "thigh/thigh_plate_outer") in pairs
    assert all("with the hip at" in o.where for o in found)


@pytest.mark.parametrize("lengths", [(0.3, 0.3), (0.3, 0.5), (0.5, 0.3)])
def test_short_and_long_links_fold_freely(product, actuator_map, lengths):
    design = product.robot.design.replace({"thigh_length_m": lengths[0], "shank_length_m": lengths[1]})
    found, clearance = overlaps.in_working_range(build_product(bare(build_robot(design, actuator_map)), product.pose))
    assert found == []
    assert clearance > 5.0
