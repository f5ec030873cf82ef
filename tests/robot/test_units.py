"""The table of units against the layout of the leg, worked out here a second time.

``build_robot`` and ``robot_arrays`` read one table, so that they agree on a faulty one too.
"""

import numpy as np
import pytest

from pareto_monoped.design import PAPER_CASES
from pareto_monoped.geometry.shapes import Circle
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.robot.build import build_robot
from pareto_monoped.robot.units import BODIES, JOINTS, UNITS, ActuatorSized

HIP_RATIO, KNEE_RATIO = 4.5, 7.5  # actuators of different lengths and families


@pytest.fixture(scope="module")
def robot(actuator_map):
    return build_robot(
        PAPER_CASES["C"].design.replace({"hip_ratio": HIP_RATIO, "knee_ratio": KNEE_RATIO}), actuator_map
    )


@pytest.fixture(scope="module")
def leg(actuator_map):
    return leg_dimensions(actuator_map)


def heights_mm(robot, unit_name, part_name):
    """Lower and upper end of a part along the joint axis, in the body's part frame."""
    (unit,) = (unit for unit in robot.units if unit.name == unit_name)
    (part,) = (part for part in unit.parts if part.name == part_name)
    ends = [
        unit.z_mm + unit.turn[2, 2] * (place[2] + z)
        for place in part.places_mm
        for prism in part.prisms
        for z in (prism.z0_mm, prism.z1_mm)
    ]
    return min(ends), max(ends)


def test_rows_are_well_formed():
    assert len({unit.name for unit in UNITS}) == len(UNITS)
    for unit in UNITS:
        assert unit.body in BODIES
        np.testing.assert_array_equal(unit.turn @ unit.turn.T, np.eye(3))
        assert np.linalg.det(unit.turn) == 1.0  # a rotation, no mirror
        if isinstance(unit, ActuatorSized):
            assert unit.joint in JOINTS


def test_a_robot_has_the_units_of_the_table_in_its_order(robot):
    assert [unit.name for unit in robot.units] == [
        "base_frame",
        "hip_actuator",
        "thigh",
        "knee_actuator",
        "journal",
        "shank",
        "foot",
    ]
    assert [unit.body for unit in robot.units] == ["base", "base", "thigh", "thigh", "thigh", "shank", "shank"]


def test_actuators_stand_on_either_side_of_the_leg_with_their_outputs_towards_it(robot, leg):
    """An actuator lies at z <= 0 of its own frame; part z is the robot's right, body y its left."""
    units = {unit.name: unit for unit in robot.units}
    hip, knee = (units[name].mass_properties() for name in ("hip_actuator", "knee_actuator"))
    behind_hip, behind_knee = -com_z_m(robot.hip.parts), -com_z_m(robot.knee.parts_bolted_at_back)
    assert behind_hip > 0.01
    assert hip.com_m[1] == pytest.approx(-1e-3 * leg.hip_mount_mm + behind_hip)
    assert knee.com_m[1] == pytest.approx(-(1e-3 * leg.knee_mount_mm + behind_knee))
    assert hip.mass_kg == pytest.approx(robot.hip.mass_kg)
    assert units["knee_actuator"].parts == robot.knee.parts_bolted_at_back


def com_z_m(parts):
    mass = sum(part.mass_kg() for part in parts)
    return sum(part.mass_kg() * part.mass_properties().com_m[2] for part in parts) / mass


def test_both_parts_of_the_knee_actuator_s_free_end_follow_its_length(robot, leg):
    back_mm = leg.knee_mount_mm + robot.knee.length_mm
    assert robot.knee.length_mm != pytest.approx(robot.hip.length_mm, abs=1.0)
    low, high = heights_mm(robot, "journal", "journal")
    assert low == pytest.approx(back_mm)
    # The seat reaches through the far cheek, 1 mm beyond the bearing that moves along it.
    assert heights_mm(robot, "base_frame", "base_bearing")[1] == pytest.approx(high - 1.0)


def test_the_foot_is_at_the_end_of_the_shank(robot):
    foot = next(unit for unit in robot.units if unit.name == "foot").mass_properties()
    assert foot.com_m[2] == pytest.approx(-robot.design.shank_length_m, abs=0.006)


@pytest.mark.parametrize(("ratio", "family", "clearance_mm"), [(4.5, "ISSPG", 0.0), (7.5, "ESSPG", 3.0)])
def test_journal_screws_hold_5_mm_of_thread_and_reach_no_rotor(actuator_map, leg, ratio, family, clearance_mm):
    robot = build_robot(PAPER_CASES["C"].design.replace({"knee_ratio": ratio}), actuator_map)
    knee = robot.knee
    assert knee.family == family
    (screw,) = (part for unit in robot.units for part in unit.parts if part.name == "journal_screw")
    # Heights in the knee actuator's frame, where its back is at -length.
    first = leg.knee_mount_mm - max(prism.z1_mm for prism in screw.prisms if prism.outline.radius_mm < 2.5)
    tip = leg.knee_mount_mm - min(prism.z0_mm for prism in screw.prisms)
    assert first == pytest.approx(-knee.length_mm + clearance_mm)
    assert tip - first >= 5.0 - 1e-9
    plate = "through the knee actuator's backplate into the threads in its motor's base"
    place, run_out = screw.note.split("; ")
    assert place == (plate if family == "ESSPG" else "into the threads in the knee actuator's backplate")
    assert run_out == "tighten with the seat's run-out at 0.05 mm or less, measured as the thigh swings"
    assert screw.pitch_radius_mm == pytest.approx(0.5 * knee.mount.back_bolts.pitch_circle_mm)
    low, high = screw.pitch_radius_mm - 2.5, screw.pitch_radius_mm + 2.5
    for part in knee.parts:
        if part.group != "housing":
            for prism in part.prisms:
                if prism.z0_mm < tip:
                    bore = max((hole.radius_mm for hole in prism.holes if isinstance(hole, Circle)), default=0.0)
                    assert bore > high or prism.outline.radius_mm < low, part.name
