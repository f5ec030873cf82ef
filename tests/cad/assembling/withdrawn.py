"""Whether an assembly comes apart, from the triangles of its parts alone: height maps, without the package's outlines.

Every solid is cut across the axis at many heights, and each cut is drawn on a raster. Per pixel this gives the lowest
and the highest point of each part. Moved up to infinity, a part meets another where the highest point of the other lies
above its own lowest point. This says for all pairs who stands in whose way; going down, all pairs change their roles.

A screw is taken out by itself, towards its head, before the part with its thread moves. All other parts leave one after
the other, or as a group whose members stand in each other's way, and which then has to come apart by itself. Only a
screw that is out of its holes, and a bumper, whose seat is open to one side, may also go sideways. What does not come
apart cannot be put together either. A retaining ring is spread or pressed together by a little, and then goes
straight. A bolt is assumed to lose its nut, and so to leave what it holds.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import manifold3d as m3
import numpy as np
from scipy.sparse.csgraph import connected_components

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.cad.assembly import Pose, instances
from pareto_monoped.cad.shape.meshes import mesh_of
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import SCREWS, Group, JointKind, Role
from pareto_monoped.robot.build import Robot

# All lengths and limits are our own choice.
RASTER_MM = 0.2
"""Distance of the rays."""
PLAY_MM = 0.015
"""Taken off each part all around: polygons of meshes leave their arcs by up to 0.01 mm, and fits touch."""
LEAST_PIXELS = 6
"""What fewer rays meet is no obstacle but a corner of rounding: 0.24 mm2."""
ALONG_MM = 0.2
"""Heights closer than this are touching: cones are drawn as steps of ``STEP_MM``, on both parts."""
STEP_MM = 0.1
LIFT_MM = 1.0
"""In what steps a screw rises; its head is 2 mm high, and jumps over nothing."""
FAR_MM = 1000.0
"""Out of the robot."""
LEAST_MM3 = 0.5
"""Two solids that share less are facets of a round fit."""
POSE = Pose(hip_rad=0.0, knee_rad=0.5 * np.pi)
SPREAD_MM = tuple(0.25 * sign * k for k in range(1, 13) for sign in (1, -1))
SPREAD_SHARE = 0.08
"""By what the radii of retaining rings are made greater or smaller, and the greatest share of their outer radius. From
a groove to its shaft or bore they have to give 2 to 7 percent (DIN 471 and DIN 472, from 25 mm); more is refused."""
SIDEWAYS = ("screw", "bumper")
_OFFSET_MM = np.array([0.0137, 0.0271])  # no edge at a round number of millimetres meets a row of rays


@dataclass(frozen=True, kw_only=True)
class Placed:
    """A solid, and where it stands: turned and moved across the axis, moved along it."""

    name: str
    body: m3.Manifold
    turn: np.ndarray  #: shape (2, 2)
    centre_mm: np.ndarray  #: shape (2,)
    height_mm: float
    sign: float = 1.0  #: -1 if it stands upside down
    kind: str = ""  #: ``screw``, ``bolt``, ``ring`` (a retaining ring), ``bumper``, or nothing of these
    never_leaves: frozenset[str] = frozenset()  #: names of others

    @property
    def solid(self) -> m3.Manifold:
        """Where it stands."""
        matrix = np.zeros((3, 4))
        matrix[:2, :2], matrix[:2, 3] = self.turn, self.centre_mm
        matrix[2, 2], matrix[2, 3] = self.sign, self.height_mm
        return self.body.transform(matrix)


@dataclass(frozen=True, kw_only=True)
class Cut:
    """A section of a solid, which holds from one height to another."""

    section: m3.CrossSection
    low_mm: float
    high_mm: float


def cuts_of(body: m3.Manifold) -> list[Cut]:
    """Cut a solid between every two heights of its corners, and more often where its walls are slanted."""
    mesh = body.to_mesh64()
    corners = np.asarray(mesh.vert_properties)[:, :3][np.asarray(mesh.tri_verts)]
    upright = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    bottom, top = corners[..., 2].min(axis=1), corners[..., 2].max(axis=1)
    slanted = (np.abs(upright[:, 2]) > 1e-3 * np.linalg.norm(upright, axis=1)) & (top - bottom > 1e-3)
    heights = np.unique(np.round(corners[..., 2], 4))
    heights = heights[np.concatenate([[True], np.diff(heights) > 2e-3])]
    found = []
    for low, high in pairwise(heights):
        cone = np.any(slanted & (bottom < high - 1e-3) & (top > low + 1e-3))
        at = np.linspace(low, high, 1 + (int(np.ceil((high - low) / STEP_MM)) if cone else 1)).tolist()
        for start, stop in pairwise(at):
            section = body.slice(0.5 * (start + stop)).offset(-PLAY_MM, m3.JoinType.Miter)
            if not section.is_empty():
                found.append(Cut(section=section, low_mm=start, high_mm=stop))
    return found


class Heights:
    """The lowest and the highest points of a placed solid, on the window of the raster that it covers."""

    def __init__(self, one: Placed, cuts: Sequence[Cut]):
        def on_raster(polygon):
            return (np.asarray(polygon) @ one.turn.T + one.centre_mm - _OFFSET_MM) / RASTER_MM

        drawn = [([on_raster(p) for p in cut.section.to_polygons()], cut) for cut in cuts]
        corners = np.concatenate([p for polygons, _ in drawn for p in polygons])
        self.start = np.floor(corners.min(axis=0)).astype(int) - 1
        self.stop = np.ceil(corners.max(axis=0)).astype(int) + 2
        shape = self.stop - self.start
        self.low, self.high = np.full(shape, np.inf, np.float32), np.full(shape, -np.inf, np.float32)
        for polygons, cut in drawn:
            inside = filled([p - self.start for p in polygons], shape)
            bottom, top = sorted(one.sign * z + one.height_mm for z in (cut.low_mm, cut.high_mm))
            self.low[inside] = np.minimum(self.low[inside], bottom)
            self.high[inside] = np.maximum(self.high[inside], top)
        self.bottom, self.top = float(self.low.min()), float(self.high.max())

    def window(self, start, stop):
        """Return the slices of a part of the window."""
        (a, b), (c, d) = start - self.start, stop - self.start
        return slice(a, c), slice(b, d)


def filled(polygons, shape):
    """Return which rays are inside of polygons: on their row they have passed an odd number of edges."""
    here = np.concatenate(polygons)
    after = np.concatenate([np.roll(p, -1, axis=0) for p in polygons])
    first = np.ceil(np.minimum(here[:, 0], after[:, 0])).astype(int)
    count = np.ceil(np.maximum(here[:, 0], after[:, 0])).astype(int) - first
    edge = np.repeat(np.arange(len(here)), count)
    row = np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count) + first[edge]
    share = (row - here[edge, 0]) / (after[edge, 0] - here[edge, 0])
    column = np.ceil(here[edge, 1] + share * (after[edge, 1] - here[edge, 1])).astype(int)
    passed = np.bincount(row * shape[1] + column, minlength=shape[0] * shape[1]).astype(np.uint8)
    return np.cumsum(passed.reshape(shape), axis=1, dtype=np.uint8) % 2 == 1


def runs_into(moving: Heights, other: Heights) -> bool:
    """Return whether a solid, moved up, runs into another."""
    start, stop = np.maximum(moving.start, other.start), np.minimum(moving.stop, other.stop)
    if other.top <= moving.bottom + ALONG_MM or np.any(stop <= start):
        return False
    met = other.high[other.window(start, stop)] > moving.low[moving.window(start, stop)] + np.float32(ALONG_MM)
    return bool(np.count_nonzero(met) >= LEAST_PIXELS)


def spread(cuts: Sequence[Cut], by_mm: float) -> list[Cut]:
    """Return a ring whose radii are greater: bent, it keeps its width."""

    def moved(section):
        polygons = [np.asarray(polygon) for polygon in section.to_polygons()]
        bent = [polygon * (1.0 + by_mm / np.hypot(*polygon.T))[:, None] for polygon in polygons]
        return m3.CrossSection(bent, m3.FillRule.EvenOdd)

    return [Cut(section=moved(cut.section), low_mm=cut.low_mm, high_mm=cut.high_mm) for cut in cuts]


class Assembly:
    """Placed solids, and which of them stand in each other's way."""

    def __init__(self, placed: Sequence[Placed]):
        self.placed = placed
        known = {key: cuts_of(body) for key, body in {id(one.body): one.body for one in placed}.items()}
        cuts = [known[id(one.body)] for one in placed]
        self.solids = [one.solid for one in placed]
        self.boxes = np.array([solid.bounding_box() for solid in self.solids])
        drawn = [Heights(one, some) for one, some in zip(placed, cuts, strict=True)]
        #: True at (i, j) where i, moved up, runs into j; moved down, j runs into i
        self.up = np.array([[i != j and runs_into(a, b) for j, b in enumerate(drawn)] for i, a in enumerate(drawn)])
        #: Of each retaining ring, by what its radii are made greater: what it then runs into, moved up and down
        self.spread: dict[int, dict[float, tuple[np.ndarray, np.ndarray]]] = {}
        for i, (one, some) in enumerate(zip(placed, cuts, strict=True)):
            most_mm = SPREAD_SHARE * 0.5 * (self.boxes[i, 3] - self.boxes[i, 0])
            for by_mm in SPREAD_MM if one.kind == "ring" else ():
                if abs(by_mm) <= most_mm:
                    ring = Heights(one, spread(some, by_mm))
                    ways = [(i != j and runs_into(ring, b), i != j and runs_into(b, ring)) for j, b in enumerate(drawn)]
                    self.spread.setdefault(i, {})[by_mm] = tuple(np.array(ways).T)
        #: True where two are one, such as a motor's rotor in its own bearings
        self.one = np.array([[b.name in a.never_leaves or a.name in b.never_leaves for b in placed] for a in placed])
        self.heads = [_head(one, some) for one, some in zip(placed, cuts, strict=True)]
        self._sections: dict[tuple[int, float], m3.CrossSection] = {}
        #: True where one is a screw in the other's thread
        self.tied = np.zeros_like(self.up)
        for i, (one, some) in enumerate(zip(placed, cuts, strict=True)):
            if one.kind == "screw":
                held = self._threaded(i, some[0] if self.heads[i] * one.sign > 0.0 else some[-1])
                self.tied[i, held] = self.tied[held, i] = True
        self.spread_by_mm: dict[str, float] = {}  #: by what a retaining ring was spread
        self.sideways: set[str] = set()  #: what has left so
        self.groups = 0  #: of several parts that left together

    def _threaded(self, i: int, tip: Cut) -> list[int]:
        """Return the parts in which a screw's thread sits: they fill a sleeve of 0.06 mm around its core."""
        one = self.placed[i]
        core = tip.section.offset(PLAY_MM, m3.JoinType.Round)
        sleeve = core.offset(0.06, m3.JoinType.Round) - core
        sleeve = sleeve.transform(np.column_stack([one.turn, one.centre_mm]))
        z = one.sign * 0.5 * (tip.low_mm + tip.high_mm) + one.height_mm
        others = [j for j in self._near(self.solids[i], range(len(self.placed))) if j != i]
        return [j for j in others if (sleeve ^ self._at(j, z)).area() > 0.5 * sleeve.area()]

    def _at(self, j: int, z_mm: float) -> m3.CrossSection:
        """Return the section of a placed solid at a height."""
        key = j, round(z_mm, 6)
        if key not in self._sections:
            self._sections[key] = self.solids[j].slice(z_mm)
        return self._sections[key]

    def _near(self, solid: m3.Manifold, members: Sequence[int]) -> list[int]:
        """Return the members whose boxes meet that of a solid."""
        box, boxes = np.array(solid.bounding_box()), self.boxes[list(members)]
        meets = np.all((boxes[:, :3] < box[3:]) & (boxes[:, 3:] > box[:3]), axis=1)
        return [j for j, met in zip(members, meets, strict=True) if met]

    def _free(self, solid: m3.Manifold, others: Sequence[int]) -> bool:
        return all((solid ^ self.solids[j]).volume() <= LEAST_MM3 for j in self._near(solid, others))

    def _leaves(self, i: int, members: Sequence[int]) -> bool:
        """Return whether something of a kind leaves along the axis by itself: a screw towards its head."""
        others = [j for j in members if j != i]
        above, below = self.up[i, others], self.up[others, i]
        if self.placed[i].kind in SIDEWAYS:
            return not (above if self.heads[i] > 0.0 else below).any()
        if self.placed[i].kind == "bolt":
            # What stands in its way on both sides is what it holds, and leaves it with its nut.
            return not (above ^ below).any()
        ways = ((by_mm, way[others].any()) for by_mm, both in self.spread[i].items() for way in both)
        least = next((by_mm for by_mm, blocked in ways if not blocked), None)
        if least is not None:
            self.spread_by_mm[self.placed[i].name] = least
        return least is not None

    def _leaves_sideways(self, i: int, members: Sequence[int]) -> bool:
        """Return whether a bumper, or a screw out of its holes, leaves across the axis in one of twelve directions.

        The hull of where it is and where it goes is more than it passes, never less.
        """
        others, raised = [j for j in members if j != i], self.solids[i]
        if self.placed[i].kind == "screw":
            # It is out when it has risen by its length; it rises as far as it can.
            for _ in range(int(np.ceil((self.boxes[i, 5] - self.boxes[i, 2]) / LIFT_MM))):
                higher = raised.translate((0.0, 0.0, self.heads[i] * LIFT_MM))
                if not self._free(higher, others):
                    break
                raised = higher
        x, y = self.placed[i].centre_mm
        for angle in np.arctan2(y, x) + np.arange(12) * np.pi / 6.0:
            away = raised.translate((FAR_MM * float(np.cos(angle)), FAR_MM * float(np.sin(angle)), 0.0))
            if self._free(m3.Manifold.batch_hull([raised, away]), others):
                self.sideways.add(self.placed[i].name)
                return True
        return False

    def left_over(self, members: Sequence[int] | None = None) -> Iterator[list[str]]:
        """Yield the names of parts that do not come apart, group by group."""
        members = list(range(len(self.placed)) if members is None else members)
        while free := [i for i in members if self.placed[i].kind and self._leaves(i, members)]:
            members = [i for i in members if i not in free]
        for some in self._pieces(members, self.up | self.tied | self.one):
            if len(self._pieces(some, self.one)) == 1:
                continue
            if len(some) < len(members):
                self.groups += 1
                yield from self.left_over(some)
            elif free := [i for i in some if self.placed[i].kind in SIDEWAYS and self._leaves_sideways(i, some)]:
                yield from self.left_over([i for i in some if i not in free])
            else:
                yield [self.placed[i].name for i in some]

    @staticmethod
    def _pieces(members: Sequence[int], edges: np.ndarray) -> list[list[int]]:
        """Return groups in which each member is led to each other; no way leads back from one group to another."""
        count, group = connected_components(edges[np.ix_(members, members)], directed=True, connection="strong")
        return [[members[k] for k in np.flatnonzero(group == g)] for g in range(count)]


def _head(one: Placed, cuts: Sequence[Cut]) -> float:
    """Return the side on which a placed solid is wider: 1 up, -1 down."""
    return one.sign if cuts[-1].section.area() > cuts[0].section.area() else -one.sign


_KINDS = {Role.BOLT: "bolt", Role.RETAINING_RING: "ring", Role.BUMPER: "bumper"} | dict.fromkeys(SCREWS, "screw")
_LIMP = (Role.CHAIN, Role.TURNBUCKLE)


def of_parts(standing: Sequence[tuple[str, Part, np.ndarray]]) -> Assembly:
    """Return an assembly of named parts where matrices (4, 4) put their meshes; names are ``unit/part``, with numbers.

    A chain and its turnbuckles, which are put on link by link, are left out.
    """
    lasting = (JointKind.MOULDED, JointKind.RUNNING)
    found = []
    for name, part, at in standing:
        assert abs(abs(at[2, 2]) - 1.0) < 1e-9, f"{name}: stands across the axis"
        partner = part.joint.partner if part.joint is not None and part.joint.kind in lasting else ""
        never_leaves = {other for other, one, _ in standing if one.name == partner}
        # Both actuators have parts of one name; a foot is moulded onto a part of another unit.
        never_leaves = {other for other in never_leaves if _unit(other) == _unit(name)} or never_leaves
        placed = Placed(
            name=name,
            body=mesh_of(part).body,
            turn=at[:2, :2],
            centre_mm=at[:2, 3],
            height_mm=float(at[2, 3]),
            sign=float(np.sign(at[2, 2])),
            kind=_KINDS.get(part.role, ""),
            never_leaves=frozenset(never_leaves),
        )
        if part.role not in _LIMP:
            found.append(placed)
    return Assembly(found)


def _unit(name: str) -> str:
    return name.partition("/")[0]


def of_actuator(actuator: Actuator) -> Assembly:
    """Return an actuator as it is drawn; its planets have rolled around the sun to their places."""
    standing = []
    for part in actuator.parts:
        radius, count = float(part.pitch_radius_mm), int(part.count)
        places = [(place, k) for place in part.places_mm for k in range(count)]
        for number, (place, k) in enumerate(places, 1):
            around = 2.0 * np.pi * k / count
            own = around + float(part.phase_rad) if radius else 0.0
            rolled = around * actuator.gears.sun_teeth / actuator.gears.planet_teeth
            turn = own + (rolled if part.group is Group.PLANET else 0.0)
            at = np.eye(4)
            at[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
            at[:3, 3] = np.array(place, dtype=float) + radius * np.array([np.cos(own), np.sin(own), 0.0])
            standing.append((f"actuator/{part.name}_{number}", part, at))
    return of_parts(standing)


def of_robot(robot: Robot) -> Assembly:
    """Return a robot with its knee at a right angle, looked at along the axes of its joints."""
    along = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
    return of_parts([(one.name, one.part, along @ one.world) for one in instances(robot, POSE)])
