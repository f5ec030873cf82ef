"""Names of parts are for people: when every part is renamed, nothing that an export computes changes."""

import dataclasses

import pytest

from pareto_monoped.cad.assembly import instances
from pareto_monoped.cad.check import free_motion, gear_mesh, screws
from pareto_monoped.cad.check.retention import loose_parts
from pareto_monoped.cad.picture.scenes import assembly_scene
from pareto_monoped.cad.write.meshes import colliders, visuals


@pytest.fixture(scope="module")
def names(product):
    """Part names that tell nothing."""
    known = dict.fromkeys(part.name for unit in product.robot.units for part in unit.parts)
    return {name: f"piece_{k}" for k, name in enumerate(known)}


@pytest.fixture(scope="module")
def renamed(product, names):
    """The product with other names, those of the joints' partners with them; its solids and meshes are the same."""
    new = {}

    def other(part):
        if id(part) not in new:
            joint = part.joint and dataclasses.replace(part.joint, partner=names[part.joint.partner])
            new[id(part)] = dataclasses.replace(part, name=names[part.name], joint=joint)
        return new[id(part)]

    units = tuple(
        dataclasses.replace(unit, parts=tuple(other(part) for part in unit.parts)) for unit in product.robot.units
    )
    robot = dataclasses.replace(product.robot, units=units)
    return dataclasses.replace(
        product,
        robot=robot,
        instances=instances(robot, product.pose),
        unique=tuple(dataclasses.replace(kind, part=other(kind.part)) for kind in product.unique),
    )


def without(robot, unit_name, part_name):
    units = tuple(
        dataclasses.replace(unit, parts=tuple(part for part in unit.parts if part.name != part_name))
        if unit.name == unit_name
        else unit
        for unit in robot.units
    )
    return dataclasses.replace(robot, units=units)


@pytest.mark.parametrize(
    ("unit", "part"),
    [pytest.param("thigh", "none", marks=pytest.mark.long), ("thigh", "turnbuckle_end_hip")],
)
def test_what_is_loose_does_not_depend_on_names(product, renamed, names, unit, part):
    here = loose_parts(without(product.robot, unit, part))
    there = loose_parts(without(renamed.robot, unit, names.get(part, "none")))
    assert [loose.directions for loose in here[0]] == [loose.directions for loose in there[0]]
    assert here[1] == there[1]
    assert bool(here[0]) == (part != "none")


@pytest.mark.long
def test_checks_do_not_depend_on_names(product, renamed):
    assert screws.check_bolts(renamed) == screws.check_bolts(product)
    assert gear_mesh.check(renamed) == gear_mesh.check(product)
    assert free_motion.check_free_motion(renamed) == free_motion.check_free_motion(product)


def test_models_and_pictures_do_not_depend_on_names(product, renamed):
    assert colliders(renamed) == colliders(product)
    here, there = visuals(product), visuals(renamed)
    assert [(v.name, v.colour, len(v.mesh.triangles)) for v in here] == [
        (v.name, v.colour, len(v.mesh.triangles)) for v in there
    ]
    assert len(assembly_scene(product).bodies) == len(assembly_scene(renamed).bodies)
