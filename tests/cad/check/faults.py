"""Ways to break one property of a product, for the tests of the checks."""

import dataclasses
from concurrent.futures import Future

import numpy as np

from pareto_monoped.cad.product import build_product


def shifted(x=0.0, y=0.0, z=0.0):
    """A translation."""
    matrix = np.eye(4)
    matrix[:3, 3] = (x, y, z)
    return matrix


def with_instance(product, name, change):
    """The product with one instance changed."""
    assert any(instance.name == name for instance in product.instances)
    changed = tuple(change(instance) if instance.name == name else instance for instance in product.instances)
    return dataclasses.replace(product, instances=changed)


def moved(product, name, matrix):
    """The product with one instance moved by a matrix in its own frame, wherever it is looked at."""
    return with_instance(
        product,
        name,
        lambda i: dataclasses.replace(i, world=i.world @ matrix, in_body=i.in_body @ matrix, moves=i.moves @ matrix),
    )


def with_facts(product, name, **values):
    """The product whose kernel finds something else about the solid of one part; functions change what it found."""
    facts = list(product.solids.result())
    k = [kind.name for kind in product.unique].index(name)
    new = {field: value(getattr(facts[k], field)) if callable(value) else value for field, value in values.items()}
    facts[k] = dataclasses.replace(facts[k], **new)
    answer = Future()
    answer.set_result(facts)
    return dataclasses.replace(product, solids=answer)


def with_parts(robot, change):
    """The robot with other records: ``change`` gives the parts that stand for a unit's part."""
    units = tuple(
        dataclasses.replace(unit, parts=tuple(p for part in unit.parts for p in change(unit, part)))
        for unit in robot.units
    )
    return dataclasses.replace(robot, units=units)


def without(robot, name):
    """The robot without a kind of part, called ``unit/part``."""
    changed = with_parts(robot, lambda unit, part: () if f"{unit.name}/{part.name}" == name else (part,))
    assert sum(len(unit.parts) for unit in changed.units) == sum(len(unit.parts) for unit in robot.units) - 1
    return changed


def replaced(robot, name, **fields):
    """The robot with other values in the record of a part, called ``unit/part``."""

    def change(unit, part):
        return (dataclasses.replace(part, **fields) if f"{unit.name}/{part.name}" == name else part,)

    return with_parts(robot, change)


def bare(robot):
    """The robot without its actuators, which take longest to build."""
    units = tuple(unit for unit in robot.units if not unit.name.endswith("_actuator"))
    return dataclasses.replace(robot, units=units)


def with_unit(product, unit_name, change):
    """The product of a bare robot with one unit changed."""
    robot = bare(product.robot)
    units = tuple(change(unit) if unit.name == unit_name else unit for unit in robot.units)
    return build_product(dataclasses.replace(robot, units=units), product.pose)
