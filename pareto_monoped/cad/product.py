"""A robot as a product: its unique parts with meshes and facts of their solids, and all placed instances."""

from collections.abc import Iterator
from concurrent.futures import Future
from dataclasses import dataclass

from pareto_monoped.cad.assembly import ACTUATOR_UNITS, Instance, Pose, instances
from pareto_monoped.cad.kernel.client import SolidFacts, StepAssembly, StepPlacement, solid_facts
from pareto_monoped.cad.shape.meshes import Mesh, mesh_of
from pareto_monoped.geometry.parts import Part
from pareto_monoped.robot.build import Robot


@dataclass(frozen=True, slots=True, kw_only=True)
class ListedPart:
    """A part that is made once and used ``count`` times in the robot."""

    name: str  #: unique in the product and safe as a file name
    part: Part
    count: int
    units: tuple[str, ...]  #: the units that have it


@dataclass(frozen=True, slots=True, kw_only=True)
class UniquePart(ListedPart):
    """The same with its triangles."""

    mesh: Mesh  #: in the part's own frame, millimetres


@dataclass(frozen=True, slots=True, kw_only=True)
class Listed:
    """A robot and its unique parts without triangles: what another process can be given."""

    robot: Robot
    unique: tuple[ListedPart, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Product:
    """A robot in a pose with everything that its files are made from."""

    robot: Robot
    pose: Pose
    unique: tuple[UniquePart, ...]  #: every part that differs from all others, in the order of the assembly
    instances: tuple[Instance, ...]  #: every part in its place
    kinds: tuple[int, ...]  #: for each instance, the index of its part in ``unique``
    solids: Future[list[SolidFacts]]  #: what the kernel finds about each unique part's solid, once it has built them

    def placed(self) -> Iterator[tuple[Instance, UniquePart]]:
        """Yield every instance with its unique part."""
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
        name, count = part_file_name(units, part.name), len(members)
        unique.append(UniquePart(name=name, part=part, mesh=mesh_of(part), count=count, units=units))
    index = {key: k for k, key in enumerate(order)}
    kinds = tuple(index[id(instance.part)] for instance in found)
    return Product(robot=robot, pose=pose, unique=tuple(unique), instances=found, kinds=kinds, solids=solids)


def step_assembly(product: Product, name: str) -> StepAssembly:
    """Return what the kernel writes a product's STEP files from."""
    units: dict[str, list[StepPlacement]] = {unit.name: [] for unit in product.robot.units}
    for instance, unique in product.placed():
        units[instance.unit].append(StepPlacement(part=unique.name, matrix=instance.world))
    return StepAssembly(
        name=name,
        parts={unique.name: unique.part for unique in product.unique},
        units={unit: tuple(placements) for unit, placements in units.items()},
    )


def part_file_name(units: tuple[str, ...], part_name: str) -> str:
    """Return a part's name over all units: an actuator's part is named after its unit, or ``actuator`` for both."""
    actuators = [unit for unit in units if unit in ACTUATOR_UNITS]
    if not actuators:
        return part_name
    return f"{actuators[0] if len(actuators) == 1 else 'actuator'}_{part_name}"
