"""Do parts get into each other's way: in the pose, in one cycle of the gears' mesh, and in the leg's working range."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import manifold3d as m3
import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.assembly import Instance, Matrix, Pose, body_frames, instances
from pareto_monoped.cad.product import Product
from pareto_monoped.cad.shape.meshes import placed
from pareto_monoped.cad.shape.outlines import all_polygons
from pareto_monoped.geometry.gears import InternalGear
from pareto_monoped.geometry.roles import Group, Role
from pareto_monoped.geometry.shapes import Circle
from pareto_monoped.leg.joint_ranges import HIP_RANGE_RAD, KNEE_RANGE_RAD

ALLOWED_DEPTH_MM = 0.02
"""Mean depth below which an overlap is the facets of two fitting cylinders, which lie within 0.01 mm of the circle."""
_TURNING = (Group.OUTPUT, Group.ROTOR, Group.PLANET, Group.KNEE_DRIVE)
_GEAR_STEPS = 8
_SWEEP_STEP_RAD = np.radians(15.0)
_TOUCH_MM = 1e-6


@dataclass(frozen=True, slots=True, kw_only=True)
class Overlap:
    """Two instances that share volume, and how deep on average: twice the shared volume over its surface."""

    one: str
    other: str
    volume_mm3: float
    depth_mm: float
    where: str

    def __str__(self) -> str:
        size = f"{self.volume_mm3:.2f} mm3, {self.depth_mm:.3f} mm deep"
        return f"{self.one} and {self.other} overlap by {size}, {self.where}"


@dataclass(frozen=True, slots=True, kw_only=True)
class _Thing:
    """An instance's mesh in a body's frame with the box around it."""

    name: str
    body: m3.Manifold
    low: NDArray[np.float64]
    high: NDArray[np.float64]


def in_pose(product: Product) -> tuple[list[Overlap], int]:
    """Overlaps of all pairs of instances in the product's pose, and how many pairs were looked at."""
    things = {i.name: _thing(i.name, k.mesh.body, i.world) for i, k in product.placed()}
    rings = {instance.name: _rings(instance) for instance in product.instances}
    found: list[Overlap] = []
    for one, other in _near(list(things.values())):
        if not _apart(rings[one.name], rings[other.name]):
            found += _overlap(one, other, "in the pose")
    count = len(things)
    return found, count * (count - 1) // 2


def in_gear_cycle(product: Product) -> tuple[list[Overlap], int]:
    """Overlaps of sun, planets and ring of both actuators while the sun turns by one tooth, and how many steps."""
    found: list[Overlap] = []
    for name, actuator in (("hip_actuator", product.robot.hip), ("knee_actuator", product.robot.knee)):
        if name == "knee_actuator" and actuator is product.robot.hip:
            break
        step = 2.0 * np.pi / (float(actuator.gears.sun_teeth) * actuator.ratio * _GEAR_STEPS)
        for k in range(_GEAR_STEPS):
            pose = Pose(hip_rad=k * step, knee_rad=k * step)
            meshing = [
                _thing(i.name, product.unique[kind].mesh.body, i.moves)
                for i, kind in zip(instances(product.robot, pose), product.kinds, strict=True)
                if i.unit == name and i.part.role is Role.GEAR
            ]
            for one, other in _near(meshing):
                found += _overlap(one, other, f"in step {k} of the gears' cycle")
    return found, _GEAR_STEPS


def in_working_range(product: Product) -> tuple[list[Overlap], float]:
    """Overlaps while hip and knee move through their working ranges, and the shank's distance from the base in mm.

    Joints turn about parallel axes, so two parts can only meet if their extents along the axis and their distances from
    the joint's axis overlap; what can meet is put through the joint's range in steps. The shank stays clear of the base
    at any hip angle if it stays farther from the hip axis than any part of the base reaches, over the knee's range.
    """
    zero = Pose(hip_rad=0.0, knee_rad=0.0)
    at_zero = instances(product.robot, zero)
    by_body: dict[str, list[tuple[Instance, m3.Manifold]]] = {"base": [], "thigh": [], "shank": []}
    for instance, kind in zip(at_zero, product.kinds, strict=True):
        # What turns inside an actuator turns with the next body and has its own check.
        if instance.part.group in _TURNING:
            continue
        by_body[instance.body].append((instance, product.unique[kind].mesh.body))
    found: list[Overlap] = []
    for fixed, moving, limits in (("base", "thigh", HIP_RANGE_RAD), ("thigh", "shank", KNEE_RANGE_RAD)):
        hip = fixed == "base"
        frame = np.eye(4) if hip else np.linalg.inv(body_frames(product.robot, zero)["shank"])
        here = [_thing(i.name, body, frame @ i.world) for i, body in by_body[fixed]]
        there = [_thing(i.name, body, frame @ i.world) for i, body in by_body[moving]]
        reach = {thing.name: _radii(thing) for thing in (*here, *there)}
        pairs = [(a, b) for a in here for b in there if _may_meet(a, b, reach)]
        angles = _through(limits)
        for angle in angles:
            turned: dict[str, _Thing] = {}
            for one, other in pairs:
                if other.name not in turned:
                    pose = Pose(hip_rad=float(angle), knee_rad=0.0)
                    turned[other.name] = _thing(other.name, other.body, body_frames(product.robot, pose)["thigh"])
                where = f"with the {'hip' if hip else 'knee'} at {np.degrees(angle):.0f} deg"
                if _boxes_meet(one, turned[other.name]):
                    found += _overlap(one, turned[other.name], where)
    return found, _shank_clearance(product, by_body)


def _through(limits: tuple[float, float]) -> NDArray[np.float64]:
    """Angles from one limit to the other."""
    return np.linspace(*limits, int(np.ceil((limits[1] - limits[0]) / _SWEEP_STEP_RAD)) + 1)


def _shank_clearance(product: Product, by_body: dict[str, list[tuple[Instance, m3.Manifold]]]) -> float:
    base = [_thing(i.name, body, i.world) for i, body in by_body["base"]]
    reach = max(_radii(thing)[1] for thing in base)
    distance = np.inf
    for angle in _through(KNEE_RANGE_RAD):
        frame = body_frames(product.robot, Pose(hip_rad=0.0, knee_rad=float(angle)))["shank"]
        for instance, body in by_body["shank"]:
            distance = min(distance, _radii(_thing(instance.name, body, frame @ instance.in_body))[0])
    return float(distance - reach)


def _thing(name: str, body: m3.Manifold, matrix: Matrix) -> _Thing:
    moved = placed(body, matrix)
    box = np.asarray(moved.bounding_box())
    return _Thing(name=name, body=moved, low=box[:3], high=box[3:])


def _near(things: Sequence[_Thing]) -> Iterator[tuple[_Thing, _Thing]]:
    """Pairs of different things whose boxes overlap, each pair once."""
    low, high = np.array([t.low for t in things]), np.array([t.high for t in things])
    meets = np.all((low[:, None] < high[None] - _TOUCH_MM) & (low[None] < high[:, None] - _TOUCH_MM), axis=2)
    for i, j in np.argwhere(np.triu(meets, 1)):
        yield things[i], things[j]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Rings:
    """An instance's prisms as rings around its own axis, a row each: least and greatest radius, low and high y."""

    axis: NDArray[np.float64]
    rows: NDArray[np.float64]


def _rings(instance: Instance) -> _Rings | None:
    """None for what has no prisms."""
    rows = []
    for prism in instance.part.prisms:
        heights = [float((instance.world @ np.array([0.0, 0.0, float(z), 1.0]))[1]) for z in (prism.z0_mm, prism.z1_mm)]
        bores = [hole for hole in prism.holes if isinstance(hole, Circle | InternalGear)]
        least = max((_bore_radius(bore) for bore in bores), default=0.0)
        greatest = max(float(np.hypot(*points.T).max()) for points in all_polygons([prism.outline]))
        rows.append((least, greatest, min(heights), max(heights)))
    return _Rings(axis=instance.world[[0, 2], 3], rows=np.array(rows)) if rows and not instance.part.balls else None


def _bore_radius(hole: Circle | InternalGear) -> float:
    """Radius of a hole around the part's axis; 0 for one that is elsewhere."""
    if isinstance(hole, InternalGear):
        return float(hole.tip_radius_mm)
    return float(hole.radius_mm) if float(hole.x_mm) == 0.0 and float(hole.y_mm) == 0.0 else 0.0


def _apart(one: _Rings | None, other: _Rings | None) -> bool:
    """Whether two instances on one axis keep apart as rings, so that their meshes need not be intersected."""
    if one is None or other is None or float(np.abs(one.axis - other.axis).max()) > _TOUCH_MM:
        return False
    a, b = one.rows[:, None], other.rows[None]
    radial = np.minimum(a[..., 1], b[..., 1]) - np.maximum(a[..., 0], b[..., 0]) > _TOUCH_MM
    axial = np.minimum(a[..., 3], b[..., 3]) - np.maximum(a[..., 2], b[..., 2]) > _TOUCH_MM
    return not bool(np.any(radial & axial))


def _boxes_meet(one: _Thing, other: _Thing) -> bool:
    return bool(np.all(one.low < other.high - _TOUCH_MM) and np.all(other.low < one.high - _TOUCH_MM))


def _radii(thing: _Thing) -> tuple[float, float]:
    """Least and greatest distance of a thing from the y axis, as seen along it."""
    raw = thing.body.to_mesh64()
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


def _may_meet(one: _Thing, other: _Thing, reach: Mapping[str, tuple[float, float]]) -> bool:
    """Whether turning about the y axis can bring two things together."""
    if one.low[1] >= other.high[1] - _TOUCH_MM or other.low[1] >= one.high[1] - _TOUCH_MM:
        return False
    (least, greatest), (other_least, other_greatest) = reach[one.name], reach[other.name]
    return least < other_greatest - ALLOWED_DEPTH_MM and other_least < greatest - ALLOWED_DEPTH_MM


def _overlap(one: _Thing, other: _Thing, where: str) -> Iterable[Overlap]:
    shared = one.body ^ other.body
    volume = shared.volume()
    if volume <= 1e-6:
        return ()
    depth = 2.0 * volume / shared.surface_area()
    if depth < ALLOWED_DEPTH_MM:
        return ()
    return (Overlap(one=one.name, other=other.name, volume_mm3=volume, depth_mm=depth, where=where),)
