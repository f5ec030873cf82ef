"""The leg moves freely through its working ranges, and its end stops meet at their ends.

Joints turn about parallel axes. Two parts can therefore only meet if their extents along the axis overlap and so do
their distances from the joint's axis; pairs that can meet are intersected at steps through the joint's range. Beyond
either end a joint turns on by the travel of its stop, where only a bumper may be met: it is soft, and drawn unsqueezed.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import manifold3d as m3
import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.assembly import Instance, Matrix, Pose, body_frames, instances, turn_y
from pareto_monoped.cad.check.overlap import TOUCH_MM, Overlap, PlacedMesh, boxes_meet, deepest, overlap_of
from pareto_monoped.cad.check.result import (
    DEPTH_MM,
    END_STOP,
    FREE_MOTION,
    SHANK_CLEARANCE,
    Check,
    Finding,
    worst_of,
)
from pareto_monoped.cad.product import Product
from pareto_monoped.geometry.roles import Group, Role
from pareto_monoped.leg.stops import JointStop, hip_stop, knee_stop

_TURNING = (Group.OUTPUT, Group.ROTOR, Group.PLANET, Group.KNEE_DRIVE)
_STEP_RAD = np.radians(16.0)  # the travel of the knee's stops is 15.7 degrees
_SEARCH_RAD = np.radians(2.0)  # a bumper that is met at all stays met for longer
_EXACT_RAD = np.radians(0.01)
_NEVER_DEG = 180.0
_ZERO = Pose(hip_rad=0.0, knee_rad=0.0)

_Solid = tuple[Instance, m3.Manifold]
Bodies = dict[str, list[_Solid]]


def check_free_motion(product: Product) -> tuple[Check, Check, Check]:
    """Look for parts that meet, at the angles where stops meet, and at the clearance between shank and base."""
    by_body = _by_body(product)
    turns = _turns(product, by_body)
    found = [overlap for turn in turns for overlap in _while_turning(turn)]
    clearance_mm = _shank_clearance_mm(product, by_body)
    text = f"shank and base come {-clearance_mm:.1f} mm into each other's reach"
    return (
        deepest(FREE_MOTION, "hip and knee through their working ranges", found),
        worst_of(END_STOP, "bumpers and strikers at both ends of hip and knee", list(_stop_errors(turns))),
        worst_of(SHANK_CLEARANCE, "any hip angle, the knee's working range", [Finding(value=clearance_mm, text=text)]),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Turn:
    """A joint between two bodies, in a frame whose y axis is the joint's."""

    name: str  #: of the joint
    stop: JointStop
    #: The parts of the still and of the turning body, at angle zero, that turning can bring together
    pairs: tuple[tuple[PlacedMesh, PlacedMesh], ...]
    soft: frozenset[str]  #: names of the bumpers
    strikers: frozenset[str]  #: names of the strikers

    def meet_in_stop(self, one: PlacedMesh, other: PlacedMesh) -> bool:
        """Return whether one part is a bumper and the other a striker."""
        names = {one.name, other.name}
        return bool(names & self.soft) and bool(names & self.strikers)


def _turns(product: Product, by_body: Bodies) -> tuple[_Turn, _Turn]:
    leg = product.robot.leg
    to_knee = np.linalg.inv(body_frames(product.robot, _ZERO)["shank"]).astype(np.float64)
    return (
        _turn("hip", hip_stop(leg), by_body["base"], by_body["thigh"], np.eye(4)),
        _turn("knee", knee_stop(leg), by_body["thigh"], by_body["shank"], to_knee),
    )


def _turn(name: str, stop: JointStop, fixed: list[_Solid], moving: list[_Solid], frame: Matrix) -> _Turn:
    """Return a joint between two bodies; ``frame`` leads from the assembly to an origin on the axis."""

    def named(role: Role) -> frozenset[str]:
        return frozenset(instance.name for instance, _ in (*fixed, *moving) if instance.part.role is role)

    still, turning = ([PlacedMesh.of(i.name, body, frame @ i.world) for i, body in side] for side in (fixed, moving))
    reach = {mesh.name: radii_mm(mesh) for mesh in (*still, *turning)}
    pairs = tuple((a, b) for a in still for b in turning if _may_meet(a, b, reach))
    return _Turn(name=name, stop=stop, pairs=pairs, soft=named(Role.BUMPER), strikers=named(Role.STRIKER))


def _by_body(product: Product) -> Bodies:
    """Return the parts of each body with both joints at zero, with their meshes."""
    found: Bodies = {"base": [], "thigh": [], "shank": []}
    for instance, kind in zip(instances(product.robot, _ZERO), product.kinds, strict=True):
        # What turns inside an actuator turns with the next body and has its own check.
        if instance.part.group not in _TURNING:
            found[instance.body].append((instance, product.unique[kind].mesh.body))
    return found


def _while_turning(turn: _Turn) -> Iterator[Overlap]:
    """Yield the overlaps of the parts of two bodies while one turns about the joint between them."""
    stop = turn.stop
    for angle in _angles(stop):
        squeezed = not stop.lower_rad <= angle <= stop.upper_rad
        turned: dict[str, PlacedMesh] = {}
        for one, other in turn.pairs:
            if squeezed and {one.name, other.name} & turn.soft:
                continue
            if other.name not in turned:
                turned[other.name] = PlacedMesh.of(other.name, other.body, turn_y(float(angle)))
            if boxes_meet(one, turned[other.name]):
                yield from overlap_of(one, turned[other.name], f"with the {turn.name} at {np.degrees(angle):.0f} deg")


def _angles(stop: JointStop) -> NDArray[np.float64]:
    """Return angles from one end of a joint's range to the other, and the ends of its stops' travel."""
    count = int(np.ceil((stop.upper_rad - stop.lower_rad) / _STEP_RAD)) + 1
    inside = np.linspace(stop.lower_rad, stop.upper_rad, count)
    return np.array([stop.lower_rad - stop.travel_rad, *inside, stop.upper_rad + stop.travel_rad])


def _stop_errors(turns: Sequence[_Turn]) -> Iterator[Finding]:
    """Yield by how much each end stop meets at another angle than the joint's range ends at, in degrees."""
    for turn in turns:
        pairs, stop = [pair for pair in turn.pairs if turn.meet_in_stop(*pair)], turn.stop
        for end_rad, sign in ((stop.lower_rad, -1.0), (stop.upper_rad, 1.0)):
            middle_rad = 0.5 * (stop.lower_rad + stop.upper_rad)
            met_rad = _first_contact_rad(pairs, middle_rad, end_rad + sign * stop.travel_rad)
            end = f"{turn.name} at {np.degrees(end_rad):.1f} deg"
            if met_rad is None:
                yield Finding(value=_NEVER_DEG, text=f"{end}: no bumper meets a striker")
                continue
            text = f"{end}: bumper and striker meet at {np.degrees(met_rad):.2f} deg"
            yield Finding(value=abs(float(np.degrees(met_rad - end_rad))), text=text)


def _first_contact_rad(pairs: list[tuple[PlacedMesh, PlacedMesh]], from_rad: float, to_rad: float) -> float | None:
    """Return the first angle on the way at which one of the pairs overlaps, None if none does."""

    def meets(angle_rad: float) -> bool:
        for one, other in pairs:
            turned = PlacedMesh.of(other.name, other.body, turn_y(angle_rad))
            if boxes_meet(one, turned) and any(overlap_of(one, turned, "")):
                return True
        return False

    way = np.linspace(from_rad, to_rad, int(np.ceil(abs(to_rad - from_rad) / _SEARCH_RAD)) + 1)
    first = next((k for k, angle in enumerate(way) if meets(float(angle))), None)
    if not first:
        return None if first is None else from_rad
    apart, met = float(way[first - 1]), float(way[first])
    while abs(met - apart) > _EXACT_RAD:
        half = 0.5 * (apart + met)
        apart, met = (apart, half) if meets(half) else (half, met)
    return met


def _shank_clearance_mm(product: Product, by_body: Bodies) -> float:
    """Return how far the shank stays from the base at any hip angle, negative if they can meet.

    A part of the base lies within the circle about the hip axis that it reaches. The clearance is the distance of the
    shank's parts from that circle, the least over the knee's range and over all pairs that have a common stretch along
    the axis: what lies beside the shank, such as the motors' drivers outside of the cheeks, is passed at any angle.
    """
    base = [PlacedMesh.of(i.name, body, i.world) for i, body in by_body["base"]]
    low, high = np.array([mesh.low[1] for mesh in base]), np.array([mesh.high[1] for mesh in base])
    reach = np.array([radii_mm(mesh)[1] for mesh in base])
    clearance = np.inf
    for angle in _angles(knee_stop(product.robot.leg)):
        frame = body_frames(product.robot, Pose(hip_rad=0.0, knee_rad=float(angle)))["shank"]
        for instance, body in by_body["shank"]:
            mesh = PlacedMesh.of(instance.name, body, frame @ instance.in_body)
            beside = (low < mesh.high[1] - TOUCH_MM) & (mesh.low[1] < high - TOUCH_MM)
            # The distance of a mesh is at least that of its box, which often shows that it is not the nearest.
            from_axis_mm = float(np.hypot(*np.maximum(0.0, np.maximum(mesh.low, -mesh.high))[[0, 2]]))
            if np.any(beside) and from_axis_mm - np.max(reach[beside]) < clearance:
                clearance = min(clearance, radii_mm(mesh)[0] - np.max(reach[beside]))
    return float(clearance)


def radii_mm(mesh: PlacedMesh) -> tuple[float, float]:
    """Return the least and the greatest distance of a mesh from the y axis."""
    raw = mesh.body.to_mesh64()
    points = np.asarray(raw.vert_properties)[:, [0, 2]]
    corner = points[np.asarray(raw.tri_verts)]
    following = np.roll(corner, -1, axis=1)
    along = following - corner
    length2 = np.sum(along**2, axis=-1)
    share = np.clip(-np.sum(corner * along, axis=-1) / np.where(length2 > 0.0, length2, 1.0), 0.0, 1.0)
    nearest = np.linalg.norm(corner + share[..., None] * along, axis=-1).min()
    # A triangle around the axis: the axis lies on the same side of all its edges.
    side = corner[..., 0] * following[..., 1] - corner[..., 1] * following[..., 0]
    pierced = np.any(np.all(side > 0.0, axis=1) | np.all(side < 0.0, axis=1))
    return 0.0 if pierced else float(nearest), float(np.linalg.norm(points, axis=1).max())


def _may_meet(one: PlacedMesh, other: PlacedMesh, reach: Mapping[str, tuple[float, float]]) -> bool:
    """Return whether turning about the y axis can bring two meshes together."""
    if one.low[1] >= other.high[1] - TOUCH_MM or other.low[1] >= one.high[1] - TOUCH_MM:
        return False
    (least, greatest), (other_least, other_greatest) = reach[one.name], reach[other.name]
    return least < other_greatest - DEPTH_MM and other_least < greatest - DEPTH_MM
