"""A robot as a product: its unique parts with meshes and facts of their solids, and all placed instances."""

from collections.abc import Iterator
from concurrent.futures import Future
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.assembly import ACTUATOR_UNITS, Instance, Pose, instances
from pareto_monoped.cad.kernel.client import SolidFacts, StepAssembly, StepPlacement, solid_facts
from pareto_monoped.cad.shape.meshes import Mesh, mesh_of
from pareto_monoped.geometry.parts import Part
from pareto_monoped.robot.build import Robot


@dataclass(frozen=True, slots=True, kw_only=True)
class ListedPart:
    """A part that is made once and used ``count`` times in the robot.

    Attributes:
        name: unique in the product and safe as a file name.
        part: the record.
        count: how often the robot has it.
        units: the units that have it.
    """

    name: str
    part: Part
    count: int
    units: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class UniquePart(ListedPart):
    """The same with its triangles.

    Attributes:
        mesh: in the part's own frame, millimetres.
    """

    mesh: Mesh


@dataclass(frozen=True, slots=True, kw_only=True)
class Listed:
    """A robot and its unique parts without triangles: what another process can be given."""

    robot: Robot
    unique: tuple[ListedPart, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Product:
    """A robot in a pose with everything that its files are made from.

    Attributes:
        robot, pose: what and how.
        unique: every part that differs from all others, in the order of the assembly.
        instances: every part in its place.
        kinds: for each instance, the index of its part in ``unique``.
        solids: what the kernel finds about the solid of each unique part, once it has built them.
    """

    robot: Robot
    pose: Pose
    unique: tuple[UniquePart, ...]
    instances: tuple[Instance, ...]
    kinds: tuple[int, ...]
    solids: Future[list[SolidFacts]]

    def placed(self) -> Iterator[tuple[Instance, UniquePart]]:
        """Every instance with its unique part."""
        for instance, index in zip(self.instances, self.kinds, strict=True):
            yield instance, self.unique[index]

    @property
    def listed(self) -> Listed:
        """The same without triangles."""
        unique = [ListedPart(name=u.name, part=u.part, count=u.count, units=u.units) for u in self.unique]
        return Listed(robot=self.robot, unique=tuple(unique))


def build_product(robot: Robot, pose: Pose) -> Product:
    """Make every part of a robot once and place it."""
    found = instances(robot, pose)
    # Two actuators of one gear ratio share their part records, so each of those parts is made once for both.
    order: dict[int, list[Instance]] = {}
    for instance in found:
        order.setdefault(id(instance.part), []).append(instance)
    # The kernel builds its solids while the meshes are made here.
    solids = solid_facts([members[0].part for members in order.values()])
    unique = []
    for members in order.values():
        part = members[0].part
        units = tuple(dict.fromkeys(member.unit for member in members))
        unique.append(
            UniquePart(
                name=part_file_name(units, part.name),
                part=part,
                mesh=mesh_of(part),
                count=len(members),
                units=units,
            )
        )
    index = {key: k for k, key in enumerate(order)}
    return Product(
        robot=robot,
        pose=pose,
        unique=tuple(unique),
        instances=found,
        kinds=tuple(index[id(instance.part)] for instance in found),
        solids=solids,
    )


def step_assembly(product: Product, name: str) -> StepAssembly:
    """What the kernel writes a product's STEP files from."""
    units: dict[str, list[StepPlacement]] = {unit.name: [] for unit in product.robot.units}
    for instance, unique in product.placed():
        units[instance.unit].append(StepPlacement(part=unique.name, matrix=instance.world))
    return StepAssembly(
        name=name,
        parts={unique.name: unique.part for unique in product.unique},
        units={unit: tuple(placements) for unit, placements in units.items()},
    )


def part_file_name(units: tuple[str, ...], part_name: str) -> str:
    """Name of a part over all units: that of an actuator's part begins with the unit, or just ``actuator`` for both."""
    actuators = [unit for unit in units if unit in ACTUATOR_UNITS]
    if not actuators:
        return part_name
    return f"{actuators[0] if len(actuators) == 1 else 'actuator'}_{part_name}"


def extent_mm(mesh: Mesh) -> NDArray[np.float64]:
    """Size of a part along its axes, shape (3,)."""
    return np.asarray(mesh.points_mm.max(axis=0) - mesh.points_mm.min(axis=0))
