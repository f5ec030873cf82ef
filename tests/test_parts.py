"""What every part of every robot has: a role, a place in its group, and a partner that exists where it is joined."""

import dataclasses
from itertools import product

import pytest

from pareto_monoped.actuator.actuator import reflected_inertia_kg_m2
from pareto_monoped.actuator.motors import motor_names
from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import DEFAULT_RULES, PAPER_CASES
from pareto_monoped.geometry.features import Hole
from pareto_monoped.geometry.making import limits
from pareto_monoped.geometry.roles import FASTENERS, SCREWS, Group, JointKind, Role, Visibility
from pareto_monoped.robot.build import build_robot


def ratios_of_families(found):
    """One gear ratio per family that the motor has."""
    ratios = {}
    for entry in found.entries:
        if entry.actuator is not None:
            ratios.setdefault(entry.actuator.family, entry.actuator.ratio)
    return list(ratios.values())


def robots(motor, rules=DEFAULT_RULES):
    found = map_for(motor, rules)
    for knee, hip in product(ratios_of_families(found), repeat=2):
        yield build_robot(PAPER_CASES["A"].design.replace({"knee_ratio": knee, "hip_ratio": hip}), found)


def all_parts():
    for motor in motor_names():
        for robot in robots(motor):
            for unit in robot.units:
                for part in unit.parts:
                    yield unit, part


def test_every_part_has_a_role_and_every_member_is_used():
    """Bushes are in the gearboxes of the paper's rules alone."""
    parts = [part for _, part in all_parts()]
    parts += [part for robot in robots("VT8020", "paper") for unit in robot.units for part in unit.parts]
    assert {part.role for part in parts} == set(Role)
    assert {part.group for part in parts} == set(Group)
    assert {part.visibility for part in parts} == set(Visibility)
    assert {part.joint.kind for part in parts if part.joint} == set(JointKind)


def test_the_partner_of_a_joint_is_another_part_of_its_unit():
    for unit, part in all_parts():
        if part.joint is None:
            continue
        partners = {other.name for other in unit.parts} - {part.name}
        if unit.name == "foot":
            partners = {"foot_block"}  # of the shank
        elif unit.name == "thigh":
            partners |= {"knee_axle"}  # of the shank
        assert part.joint.partner in partners
        assert part.joint.partner in part.joint.text.split()


def test_fasteners_are_bought_and_only_screws_have_names_of_screws():
    for _, part in all_parts():
        assert (part.role in SCREWS) == ("screw" in part.name), part.name
        assert (part.role is Role.BOLT) == part.name.endswith("_bolt"), part.name
        if part.role in FASTENERS:
            assert part.process == "bought"


def test_every_fit_of_a_part_is_in_the_tables_of_limits():
    """A drawing states the limits, so that an export would fail on a class that the tables lack."""
    for _, part in all_parts():
        for fit in part.fits:
            found = limits(float(fit.diameter_mm), fit.zone)
            assert found.lower_mm < found.upper_mm, part.name


@pytest.mark.parametrize("motor", motor_names())
def test_an_actuator_does_not_depend_on_the_names_of_its_parts(motor):
    found = map_for(motor)
    for ratio in ratios_of_families(found):
        actuator = found.lookup(ratio)
        names = {part.name: f"piece_{k}" for k, part in enumerate(actuator.parts)}
        renamed = dataclasses.replace(
            actuator, parts=tuple(dataclasses.replace(p, name=names[p.name]) for p in actuator.parts)
        )
        assert (
            reflected_inertia_kg_m2(renamed.parts, actuator.gears, actuator.motor) == actuator.reflected_inertia_kg_m2
        )
        assert [p.name for p in renamed.parts_bolted_at_back] == [names[p.name] for p in actuator.parts_bolted_at_back]


@pytest.mark.parametrize("name", ["VT8020", "MN8014"])
def test_volume_alone_is_the_first_of_the_integrals(name):
    """Searches take the volume alone; inertias and the CAD take all integrals."""
    found = map_for(name)
    actuators = [entry.actuator for entry in found.entries if entry.actuator is not None][::12]
    solids = [s for a in actuators for part in a.parts for s in (*part.prisms, *part.balls, *part.bevels)]
    assert len(solids) > 100
    for solid in solids:
        assert solid.volume_mm3() == pytest.approx(solid.integrals()[0], rel=1e-12, abs=1e-12)


def test_every_hole_lies_within_its_part():
    """A bore of a casing could have begun below it: solids and meshes are cut by prisms, and drawings told the bore."""
    seen = 0
    for unit, part in all_parts():
        holes = [one for one in part.features if isinstance(one, Hole)]
        if not holes:
            continue
        ends = [(float(p.z0_mm), float(p.z1_mm)) for p in part.prisms]
        low, high = min(min(pair) for pair in ends), max(max(pair) for pair in ends)
        for hole in holes:
            assert low - 1e-9 <= hole.low_mm < hole.high_mm <= high + 1e-9, (unit.name, part.name, hole)
            seen += 1
    assert seen > 100
