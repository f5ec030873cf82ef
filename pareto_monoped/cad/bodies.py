"""What is put together in one go: the instances of one part at one place, with what keeps them from moving.

All parts are stacks of flat shapes across the joints' axes. Along y a part therefore runs into what lies before it and
covers its outline; across y it runs into what its outline sweeps over at the same height. All paths are straight lines
that lead out of the assembly, so that blocking does not depend on the distance.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import manifold3d as m3
import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.assembly import Instance
from pareto_monoped.cad.check.retention import Slab, slabs, threads
from pareto_monoped.geometry.roles import FASTENERS, JointKind, Role

Bools = NDArray[np.bool_]

DIRECTIONS = ("+y", "-y", "+x", "-x", "+z", "-z")
"""Ways out, of the assembly in ``retention.POSE``: y is the joints' axis."""
KEY_REACH_MM = 58.0
"""Free length behind a screw for the long arm of its key: 2.5 mm for M3 (ISO 2936); smaller ones are shorter."""
SPANNER_REACH_MM = 50.0
"""Free length beside a head for an open spanner; our own choice, half of one for 5.5 mm (ISO 10102)."""
_JAW = 2.0  # half width of an open spanner's jaws over the radius of the head (ISO 10102: 13.5 mm for 5.5)
_SLIDE_MM = 0.05  # fits slide: this is taken off all around
_AREA_MM2 = 0.3  # a square of 0.5 mm; less is a facet of a round fit
_TOUCH_MM = 1e-3
_FLUSH_MM = 0.15  # countersunk heads count as thin discs on their faces, see ``retention``
_PLAY_MM = 0.25  # of fits that turn or slide, on one side
_NEAR_MM = 0.8  # a screw's shank is nearer than this to the parts that it goes through
_DEPTH_MM = 0.2  # least height that a screw and what it goes through have in common
_FAR_MM = 1000.0  # out of the robot
_LASTING = frozenset({JointKind.MOULDED, JointKind.RUNNING, JointKind.STUCK, JointKind.PRESSED})
"""Joints that are never taken apart: what is cast onto a part, a rotor in its supplier's bearings, loose needles, which
come with their planet, and what is pressed, which needs the part alone under a press. Bonds are, unless they say
``Joint.first``: a ring is bonded around its planets, and a dowel where its holes have been reamed."""
_FLEXIBLE = frozenset({JointKind.ENGAGED, JointKind.THREADED})
"""Joints of parts that do not come straight: a chain is laid around its sprocket, a turnbuckle is turned."""
_LIMP = frozenset({Role.CHAIN, Role.TURNBUCKLE})  # parts of a chain drive, which are put together link by link
_SPRUNG = frozenset({Role.RETAINING_RING})
"""Parts that are spread with pliers: they leave their groove, and then go straight."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    """Instances of one part at one place of one unit."""

    unit: str
    instances: tuple[int, ...]  #: indices of the placed instances
    instance: Instance  #: the first of them

    @property
    def is_fastener(self) -> bool:
        """Whether it holds others and is undone before they move."""
        return self.instance.part.role in FASTENERS or self.instance.part.role in _SPRUNG


@dataclass(slots=True, kw_only=True)
class Blocking:
    """Bodies, and which of them block which."""

    bodies: tuple[Body, ...]  #: in the order of the assembly
    #: For +y and -y: true at (i, j) where body i, moved that way, runs into body j; shape (n, n)
    along: Mapping[str, Bools]
    lasting: Bools  #: true at (i, j) where two bodies are never taken apart
    tied: Bools  #: true at (i, j) where one is a screw in the other's thread
    touching: Bools  #: true at (i, j) where two bodies touch
    key: Mapping[int, tuple[frozenset[int], ...]]  #: per fastener the bodies in the way of its key, per way to undo it
    goes_through: Mapping[int, frozenset[int]]  #: per fastener the bodies that it joins
    _slabs: "_Slabs"
    _flexible: Bools
    _across: dict[tuple[str, int], Bools] = field(default_factory=dict)

    def blocked(self, direction: str, body: int) -> Bools:
        """Return the bodies that a body runs into in a direction, shape (n,)."""
        if direction in self.along:
            return np.asarray(self.along[direction][body])
        if (direction, body) not in self._across:
            row = self._slabs.across(direction, body) & ~self._flexible[body]
            row[body] = False
            self._across[direction, body] = row
        return self._across[direction, body]

    def driven_from(self, fastener: int) -> str:
        """Return the side from which a fastener comes, ``+y`` or ``-y``: that of its head, or of a bolt's screw."""
        return self._slabs.head_side(fastener)


def bodies_of(placed: Sequence[Instance]) -> tuple[Body, ...]:
    """Return the bodies; instances of one part of one unit that lie at one height are one."""
    groups: dict[tuple[int, str, float], list[int]] = {}
    for k, instance in enumerate(placed):
        height = round(float(instance.world[1, 3]), 3)
        groups.setdefault((id(instance.part), instance.unit, height), []).append(k)
    first = {members[0]: tuple(members) for members in groups.values()}
    return tuple(Body(unit=placed[k].unit, instances=members, instance=placed[k]) for k, members in first.items())


def partners_of(bodies: Sequence[Body], body: int) -> list[int]:
    """Return the bodies that a body's record names as its partner in a joint; none where it has no joint."""
    joint = bodies[body].instance.part.joint
    partners = [j for j, other in enumerate(bodies) if joint and other.instance.part.name == joint.partner]
    # Both actuators have parts of one name; a chain's sprocket may be in another unit.
    return [j for j in partners if bodies[j].unit == bodies[body].unit] or partners


def blocking_of(placed: Sequence[Instance]) -> Blocking:
    """Look at all pairs of bodies of an assembly in ``retention.POSE``."""
    bodies = bodies_of(placed)
    pieces = slabs(placed, blunt=False)
    view, count = _Slabs(bodies, placed, pieces), len(bodies)
    owner = np.empty(len(placed), dtype=np.intp)
    for k, body in enumerate(bodies):
        owner[list(body.instances)] = k
    limp = np.array([body.instance.part.role in _LIMP for body in bodies])
    flexible = _joined(bodies, _FLEXIBLE) | (limp[:, None] & limp[None])
    # A nut is on its stud before the bar is, and both forks go into the bar by equal turns: none comes later.
    turned = np.array([body.instance.part.role is Role.TURNBUCKLE for body in bodies])
    forward = view.along() & ~flexible & ~np.eye(count, dtype=bool)
    fasteners = [k for k, body in enumerate(bodies) if body.is_fastener]
    return Blocking(
        bodies=bodies,
        along={"+y": forward, "-y": forward.T.copy()},
        lasting=_joined(bodies, _LASTING, first=True) | (turned[:, None] & turned[None]),
        tied=_grouped(threads(placed, pieces), owner, count),
        touching=view.touching(),
        key={k: view.in_the_way_of_key(k) for k in fasteners},
        goes_through={k: view.around(k) for k in fasteners},
        _slabs=view,
        _flexible=flexible,
    )


def _grouped(matrix: Bools, owner: NDArray[np.intp], count: int) -> Bools:
    """Return the same matrix for bodies: true where it is for any of their instances."""
    found = np.zeros((count, count), dtype=bool)
    one, other = np.nonzero(matrix)
    found[owner[one], owner[other]] = True
    return found


def _joined(bodies: Sequence[Body], wanted: frozenset[JointKind], *, first: bool = False) -> Bools:
    """Return true at (i, j) where one body's record names the other as its partner in a joint of one of the kinds.

    ``first``: or in any joint that is made before both come to others.
    """
    found = np.zeros((len(bodies), len(bodies)), dtype=bool)
    for i, body in enumerate(bodies):
        joint = body.instance.part.joint
        if joint is not None and (joint.kind in wanted or (first and joint.first)):
            partners = partners_of(bodies, i)
            found[i, partners] = found[partners, i] = True
    return found


class _Slabs:
    """The slabs of bodies as arrays, and what they run into."""

    def __init__(self, bodies: Sequence[Body], placed: Sequence[Instance], pieces: Sequence[Slab]) -> None:
        self.bodies = bodies
        # A part on a circle has its x axis away from the circle's centre.
        self.outwards = np.array([instance.world[[0, 2], 0] for instance in placed])
        owner = {instance: k for k, body in enumerate(bodies) for instance in body.instances}
        self.owner = np.array([owner[piece.owner] for piece in pieces])
        self.instance = np.array([piece.owner for piece in pieces])
        self.low = np.array([piece.low for piece in pieces])
        self.high = np.array([piece.high for piece in pieces])
        self.section = [piece.section for piece in pieces]
        self.slim = [piece.section.offset(-_SLIDE_MM, m3.JoinType.Miter) for piece in pieces]
        self.bounds = np.array([piece.section.bounds() for piece in pieces])
        self.corners = np.array([piece.section.num_vert() for piece in pieces])

    def along(self) -> Bools:
        """Return true at (i, j) where body i, moved along +y, runs into body j."""
        count = len(self.bodies)
        found = np.zeros((count, count), dtype=bool)
        before = self.low[None] > self.high[:, None] - _TOUCH_MM
        before &= self.owner[:, None] != self.owner[None]
        before &= self._covering(self.bounds)
        for a, b in self._simple_first(before):
            i, j = int(self.owner[a]), int(self.owner[b])
            if not found[i, j] and (self.slim[a] ^ self.section[b]).area() > _AREA_MM2:
                found[i, j] = True
        return found

    def across(self, direction: str, body: int) -> Bools:
        """Return the bodies that one runs into, moved across the axis, shape (n,)."""
        sign = 1.0 if direction[0] == "+" else -1.0
        way = np.array([sign, 0.0] if direction[1] == "x" else [0.0, sign]) * _FAR_MM
        met: set[int] = set()
        for a in np.flatnonzero(self.owner == body).tolist():
            slim = self.section[a].offset(-_SLIDE_MM, m3.JoinType.Miter)
            swept = m3.CrossSection.batch_boolean([slim, *_strips(slim, way)], m3.OpType.Add)
            if not swept.is_empty():
                self._meet(swept, self._beside(a, swept, _SLIDE_MM) & (self.owner != body), met)
        found = np.zeros(len(self.bodies), dtype=bool)
        found[list(met)] = True
        return found

    def _beside(self, a: int, path: m3.CrossSection, common_mm: float) -> Bools:
        """Return which slabs have more than a height in common with slab ``a`` and a box that meets that of a path."""
        common = np.minimum(self.high[a], self.high) - np.maximum(self.low[a], self.low)
        return np.asarray((common > common_mm) & self._covering(np.array([path.bounds()]))[0])

    def _meet(self, path: m3.CrossSection, looked_at: Bools, met: set[int]) -> None:
        """Add the bodies whose slabs, of those that are looked at, share an area with a path."""
        for b in np.flatnonzero(looked_at).tolist():
            j = int(self.owner[b])
            if j not in met and (path ^ self.section[b]).area() > _AREA_MM2:
                met.add(j)

    def touching(self) -> Bools:
        """Return true at (i, j) where two bodies lie beside or before each other with at most play between them."""
        found = np.eye(len(self.bodies), dtype=bool)
        margin = np.array([-_PLAY_MM, -_PLAY_MM, _PLAY_MM, _PLAY_MM])
        common = np.minimum(self.high[:, None], self.high[None]) - np.maximum(self.low[:, None], self.low[None])
        near = (common > -_PLAY_MM) & (self.owner[:, None] < self.owner[None]) & self._covering(self.bounds + margin)
        wide: dict[int, m3.CrossSection] = {}
        for a, b in self._simple_first(near):
            i, j = int(self.owner[a]), int(self.owner[b])
            if found[i, j]:
                continue
            if a not in wide:
                wide[a] = self.section[a].offset(_PLAY_MM, m3.JoinType.Miter)
            if (wide[a] ^ self.section[b]).area() > _AREA_MM2:
                found[i, j] = found[j, i] = True
        return found

    def around(self, fastener: int) -> frozenset[int]:
        """Return the bodies whose material is close around a fastener."""
        found: set[int] = set()
        for a in np.flatnonzero(self.owner == fastener).tolist():
            wide = self.section[a].offset(_NEAR_MM, m3.JoinType.Round)
            self._meet(wide, self._beside(a, wide, _DEPTH_MM) & (self.owner != fastener), found)
        return frozenset(found)

    def in_the_way_of_key(self, fastener: int) -> tuple[frozenset[int], ...]:
        """Return the bodies that block a fastener and its key, per way to undo it: before its head, by both lengths.

        A bolt with its nut needs room at both ends. A spanner comes from beside the head, from any direction. A sprung
        ring is held by the walls of its groove and leaves it on either side.
        """
        role = self.bodies[fastener].instance.part.role
        if role in _SPRUNG:
            sides = [self._before_heads(fastener, (sign,)) for sign in (1, -1)]
            groove = sides[0] & sides[1]
            return tuple(frozenset(side - groove) for side in sides)
        fastening = self.bodies[fastener].instance.part.fastening
        if fastening is not None and fastening.head == "hexagon":
            before = self._before_heads(fastener, (), reach_mm=0.0)
            angles = np.arange(0.0, 2.0 * np.pi, np.pi / 6.0)
            return tuple(frozenset(before | self._beside_heads(fastener, float(angle))) for angle in angles)
        return (frozenset(self._before_heads(fastener, (1, -1) if role is Role.BOLT else ())),)

    def _before_heads(self, fastener: int, sides: tuple[int, ...], *, reach_mm: float = KEY_REACH_MM) -> set[int]:
        """Return what lies before the widest end of each instance, or before the given sides (1 is +y)."""
        found: set[int] = set()
        for instance in self.bodies[fastener].instances:
            own = np.flatnonzero(self.instance == instance)
            low, high = float(self.low[own].min()), float(self.high[own].max())
            widest = self._widest(own)
            head_up = float(self.low[widest] + self.high[widest]) > low + high
            reach = reach_mm if self.bodies[fastener].instance.part.role in _SPRUNG else high - low + reach_mm
            for side in sides or ((1,) if head_up else (-1,)):
                if side > 0:
                    before = (self.low > high - _FLUSH_MM) & (self.low < high + reach)
                else:
                    before = (self.high < low + _FLUSH_MM) & (self.high > low - reach)
                before &= (self.owner != fastener) & self._covering(self.bounds[[widest]])[0]
                self._meet(self.slim[widest], before, found)
        return found

    def _beside_heads(self, fastener: int, angle_rad: float) -> set[int]:
        """Return what an open spanner meets at each head, at an angle to the way out from the circle's axis."""
        found: set[int] = set()
        for instance in self.bodies[fastener].instances:
            head = self._widest(np.flatnonzero(self.instance == instance))
            left, low, right, high = self.bounds[head].tolist()
            radius = 0.5 * (right - left)
            half, reach = _JAW * radius, radius + SPANNER_REACH_MM
            outwards = np.arctan2(*self.outwards[instance][[1, 0]])
            path = m3.CrossSection([np.array([[0.0, -half], [reach, -half], [reach, half], [0.0, half]])])
            path = path.rotate(float(np.degrees(outwards + angle_rad)))
            path = path.translate((0.5 * (left + right), 0.5 * (low + high)))
            self._meet(path, self._beside(head, path, _DEPTH_MM) & (self.instance != instance), found)
        return found

    def head_side(self, fastener: int) -> str:
        """Return the side on which a fastener is widest."""
        own = np.flatnonzero(self.instance == self.bodies[fastener].instances[0])
        widest = self._widest(own)
        middle = float(self.low[own].min() + self.high[own].max())
        return "+y" if float(self.low[widest] + self.high[widest]) > middle else "-y"

    def _widest(self, own: NDArray[np.intp]) -> int:
        """Return the widest of some slabs: the head of a screw."""
        size = self.bounds[own]
        return int(own[int(np.argmax(size[:, 2] - size[:, 0]))])

    def _simple_first(self, pairs: Bools) -> list[list[int]]:
        """Return the pairs of slabs where a matrix is true, those with the fewest corners first: they often decide."""
        found = np.argwhere(pairs)
        return list(found[np.argsort(self.corners[found].sum(axis=1), kind="stable")].tolist())

    def _covering(self, bounds: NDArray[np.float64]) -> Bools:
        """Return which boxes, of shape (m, 4), meet those of the slabs: shape (m, number of slabs)."""
        mine = bounds[:, None]
        meets = (mine[..., :2] < self.bounds[None, :, 2:]) & (mine[..., 2:] > self.bounds[None, :, :2])
        return np.asarray(np.all(meets, axis=2))


def _strips(section: m3.CrossSection, way: NDArray[np.float64]) -> Iterator[m3.CrossSection]:
    """Yield what each edge of a section sweeps over."""
    for polygon in section.to_polygons():
        corners = np.asarray(polygon)
        for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            strip = np.array([start, end, end + way, start + way])
            along = end - start
            if along[0] * way[1] < along[1] * way[0]:
                strip = strip[::-1]
            yield m3.CrossSection([strip])
