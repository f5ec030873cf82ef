"""Every part is held: a push along or across its axis ends at the rods that carry the base.

Moved by a little play, a part runs into its neighbours, these into theirs, and so on; it is held if that ends at the
base, in each of six directions. All parts are stacks of flat shapes across the joints' axes, so that this is a question
of shapes in a plane: along the axis a part runs into what lies before its faces, across it into what its shifted
cross-section cuts. Teeth count by their root circles, since a mesh turns and holds nothing.

Some joints have no shape of their own. A screw's thread is found where its core fills a hole. Cones count for nothing,
but a countersunk head counts as a thin disc on its face, as the countersink under it does not count either. What is
pressed, bonded or threaded by other means says so in its record (``Part.joint``), which is believed only if the part
that it names stands in its way on two opposite sides.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import manifold3d as m3
import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.assembly import Instance, Pose, instances
from pareto_monoped.cad.check.result import LOOSE, Check, count_of
from pareto_monoped.cad.shape.meshes import cross_section
from pareto_monoped.geometry.features import CountersunkHead
from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import FASTENERS, Group, Role
from pareto_monoped.geometry.shapes import Circle, Shape
from pareto_monoped.robot.build import Robot

PLAY_MM = 0.8  #: How far a part may move before something stops it: the largest play of the design, 0.5 mm, and 0.3 mm.
THREAD_SHARE = 0.6  #: Least depth of thread over the screw's diameter.
_GROUND = Role.ROD  # the test stand's carriage clamps to the rods
POSE = Pose(hip_rad=0.0, knee_rad=0.5 * np.pi)
"""Within the knee's range, where no end stop is met, and with the shank's own axes along those of the assembly."""
_AXES = ("x", "y", "z")  # of the assembly in this pose; y is the joints' axis
_CONTACT_MM2 = 0.25  # a square of 0.5 mm: less is no stop but the facets of a round fit
_TOLERANCE_MM = 0.02
_TOUCH_MM = 1e-6
_ALONG_MM = 0.3  # least common height of two parts that stop each other across the axis
_SKIN_MM = 0.05  # a thread's core lies this close to its hole
_HEAD_MM = 0.1

Bools = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, kw_only=True)
class Loose:
    """An instance that can move: its name, and in which directions of the assembly, its knee at a right angle."""

    name: str
    directions: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.name} is not held along {', '.join(self.directions)}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Slab:
    """A prism of an instance in the assembly: its cross-section seen along y, from one height to another."""

    owner: int
    section: m3.CrossSection
    low: float
    high: float


def check(robot: Robot) -> Check:
    """Push every part of a robot in six directions."""
    loose, count = loose_parts(robot)
    return count_of(LOOSE, f"{count} parts in 6 directions, with {PLAY_MM} mm of play", [str(part) for part in loose])


def loose_parts(robot: Robot) -> tuple[list[Loose], int]:
    """Return every instance that can move, and how many were looked at."""
    placed = instances(robot, POSE)
    pieces = slabs(placed)
    runs_into = _contacts(placed, pieces)
    tied = threads(placed, pieces) | _joints(placed, runs_into)
    ground = np.array([instance.part.role is _GROUND for instance in placed])
    free: list[list[str]] = [[] for _ in placed]
    # Rotors float between their bearings and a chain is limp: along the axis they hold nothing but themselves.
    limp = (Role.CHAIN, Role.TURNBUCKLE)
    weak = np.array([one.part.group is Group.ROTOR or one.part.role in limp for one in placed])
    for (axis, sign), blocked in runs_into.items():
        edges = blocked | tied
        if axis == "y":
            edges &= ~(weak[None] & ~weak[:, None])
        held = _reaches(edges, ground)
        for k in np.flatnonzero(~held):
            free[k].append(f"{sign}{axis}")
    loose = [Loose(name=one.name, directions=tuple(ways)) for one, ways in zip(placed, free, strict=True) if ways]
    return loose, len(placed)


def _reaches(edges: Bools, ground: Bools) -> Bools:
    """Return from which nodes the ground can be reached along edges, shape (n,)."""
    held = ground
    while True:
        more = held | edges[:, held].any(axis=1)
        if (more == held).all():
            return held
        held = more


def _contacts(placed: Sequence[Instance], pieces: Sequence[Slab]) -> dict[tuple[str, str], Bools]:
    """Return per direction a matrix, true at (i, j) where instance i, moved that way, runs into instance j."""
    owner = np.array([slab.owner for slab in pieces])
    low, high = np.array([slab.low for slab in pieces]), np.array([slab.high for slab in pieces])
    bounds = np.array([slab.section.bounds() for slab in pieces])
    others = owner[:, None] != owner[None]
    found = {(axis, sign): np.zeros((len(placed), len(placed)), dtype=bool) for axis in _AXES for sign in "+-"}

    def add(axis: str, i: int, j: int) -> None:
        # What i runs into going one way runs into i going the other.
        found[axis, "+"][i, j] = found[axis, "-"][j, i] = True

    shared: dict[tuple[int, int], float] = {}

    def common_mm2(a: int, b: int) -> float:
        pair = (min(a, b), max(a, b))
        if pair not in shared:
            shared[pair] = (pieces[a].section ^ pieces[b].section).area()
        return shared[pair]

    def meeting(shift: NDArray[np.float64]) -> Bools:
        mine = bounds + np.tile(shift, 2)
        overlapping: Bools = np.all(
            (mine[:, None, :2] < bounds[None, :, 2:]) & (mine[:, None, 2:] > bounds[None, :, :2]), axis=2
        )
        return overlapping

    gap = low[None] - high[:, None]
    before = others & (gap > -_TOUCH_MM) & (gap < PLAY_MM) & meeting(np.zeros(2))
    for a, b in np.argwhere(before).tolist():
        i, j = int(owner[a]), int(owner[b])
        if not found["y", "+"][i, j] and common_mm2(a, b) > _CONTACT_MM2:
            add("y", i, j)
    beside = others & (np.minimum(high[:, None], high[None]) - np.maximum(low[:, None], low[None]) > _ALONG_MM)
    for axis, direction in (("x", (1.0, 0.0)), ("z", (0.0, 1.0))):
        shift = PLAY_MM * np.array(direction)
        for a, b in np.argwhere(beside & meeting(shift)).tolist():
            i, j = int(owner[a]), int(owner[b])
            if found[axis, "+"][i, j]:
                continue
            cut = (pieces[a].section.translate((float(shift[0]), float(shift[1]))) ^ pieces[b].section).area()
            if cut > _CONTACT_MM2 and cut - common_mm2(a, b) > _CONTACT_MM2:
                add(axis, i, j)
    return found


def threads(placed: Sequence[Instance], pieces: Sequence[Slab]) -> Bools:
    """Return true at (i, j) where one is a screw whose core fits a hole of the other all around, over enough depth."""
    tied = np.zeros((len(placed), len(placed)), dtype=bool)
    low, high = np.array([slab.low for slab in pieces]), np.array([slab.high for slab in pieces])
    bounds = np.array([slab.section.bounds() for slab in pieces])
    for a, screw in enumerate(pieces):
        part = placed[screw.owner].part
        if part.role not in FASTENERS:
            continue
        core = screw.section
        skin = core.offset(2.0 * _SKIN_MM, m3.JoinType.Round) - core.offset(_SKIN_MM, m3.JoinType.Round)
        common = np.minimum(high, screw.high) - np.maximum(low, screw.low)
        around = np.all((bounds[:, :2] < bounds[a, :2]) & (bounds[:, 2:] > bounds[a, 2:]), axis=1)
        depth: dict[int, float] = {}
        for b in np.flatnonzero(around & (common > _TOUCH_MM)).tolist():
            if (skin ^ pieces[b].section).area() > 0.9 * skin.area():
                depth[pieces[b].owner] = depth.get(pieces[b].owner, 0.0) + float(common[b])
        for j, deep in depth.items():
            if deep >= THREAD_SHARE * thread_diameter_mm(part) - _TOUCH_MM:
                tied[screw.owner, j] = tied[j, screw.owner] = True
    return tied


def _joints(placed: Sequence[Instance], runs_into: dict[tuple[str, str], Bools]) -> Bools:
    """Return true at (i, j) where one says to be joined to the other, which is in its way on two opposite sides."""
    tied = np.zeros((len(placed), len(placed)), dtype=bool)
    for i, instance in enumerate(placed):
        joint = instance.part.joint
        if joint is None:
            continue
        for j, other in enumerate(placed):
            if other.part.name == joint.partner and any(
                runs_into[axis, "+"][i, j] and runs_into[axis, "-"][i, j] for axis in _AXES
            ):
                tied[i, j] = tied[j, i] = True
    return tied


def cylinders(part: Part) -> list[tuple[float, float, float]]:
    """Return the radius and both heights of the cylinders of a screw."""
    discs = [(prism.outline, prism) for prism in part.prisms]
    return [(float(o.radius_mm), float(p.z0_mm), float(p.z1_mm)) for o, p in discs if isinstance(o, Circle)]


def thread_diameter_mm(part: Part) -> float:
    """Return the diameter of a screw's thread: of its widest cylinder below the head."""
    radii = sorted({radius for radius, _, _ in cylinders(part)})
    return 2.0 * radii[min(1, len(radii) - 1)]


def slabs(placed: Iterable[Instance], *, blunt: bool = True) -> list[Slab]:
    """Return the pieces of all instances in the assembly, in their order; gears by their root circles if ``blunt``."""
    local: dict[int, list[tuple[m3.CrossSection, float, float]]] = {}
    found = []
    for k, instance in enumerate(placed):
        if (key := id(instance.part)) not in local:
            local[key] = list(_sections(instance.part, blunt=blunt))
        world = instance.world
        flat = np.hstack([world[[0, 2]][:, :2], world[[0, 2]][:, 3:]])
        for section, z0, z1 in local[key]:
            low, high = sorted(float(world[1, 2] * z + world[1, 3]) for z in (z0, z1))
            found.append(Slab(owner=k, section=section.transform(flat), low=low, high=high))
    return found


def _sections(part: Part, *, blunt: bool) -> Iterator[tuple[m3.CrossSection, float, float]]:
    """Yield the prisms of a part, a slice of its balls, and discs for its countersunk heads."""
    for prism in part.prisms:
        section = cross_section([toothless(prism.outline) if blunt else prism.outline], _TOLERANCE_MM)
        if prism.holes:
            section -= cross_section([toothless(hole) if blunt else hole for hole in prism.holes], _TOLERANCE_MM)
        yield section, float(prism.z0_mm), float(prism.z1_mm)
    for ball in part.balls:
        if ball.pocket is not None:
            disc = cross_section([Circle(radius_mm=ball.radius_mm, y_mm=ball.y_mm)], _TOLERANCE_MM)
            pocket = cross_section([ball.pocket.outline], _TOLERANCE_MM)
            yield disc - pocket, float(ball.pocket.z0_mm), float(ball.pocket.z1_mm)
    for head in part.features:
        if isinstance(head, CountersunkHead):
            face = float(head.face_mm)
            out = face - head.inwards * _HEAD_MM
            yield cross_section([Circle(radius_mm=head.radius_mm)], _TOLERANCE_MM), min(face, out), max(face, out)


def toothless(shape: Shape) -> Shape:
    """Return a gear without its teeth: what is surely material, or surely not."""
    if isinstance(shape, ExternalGear | InternalGear):
        return Circle(radius_mm=float(shape.root_radius_mm))
    return shape
