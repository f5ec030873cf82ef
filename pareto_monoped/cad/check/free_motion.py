"""The leg moves freely through the working ranges of hip and knee.

Joints turn about parallel axes. Two parts can therefore only meet if their extents along the axis overlap and so do
their distances from the joint's axis; pairs that can meet are intersected at steps through the joint's range.
"""

from collections.abc import Mapping

import manifold3d as m3
import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.assembly import Instance, Matrix, Pose, body_frames, instances, turn_y
from pareto_monoped.cad.check.contact import TOUCH_MM, Overlap, PlacedMesh, boxes_meet, deepest, overlap_of
from pareto_monoped.cad.check.limits import DEPTH_MM, FREE_MOTION, SHANK_CLEARANCE
from pareto_monoped.cad.check.result import Check, Finding, worst_of
from pareto_monoped.cad.product import Product
from pareto_monoped.geometry.roles import Group
from pareto_monoped.leg.joint_ranges import HIP_RANGE_RAD, KNEE_RANGE_RAD

_TURNING = (Group.OUTPUT, Group.ROTOR, Group.PLANET, Group.KNEE_DRIVE)
_STEP_RAD = np.radians(15.0)
_ZERO = Pose(hip_rad=0.0, knee_rad=0.0)

Bodies = dict[str, list[tuple[Instance, m3.Manifold]]]


def check(product: Product) -> tuple[Check, Check]:
    """Look for parts that meet, and at the clearance between shank and base."""
    found, clearance_mm = in_working_range(product)
    text = f"shank and base come {-clearance_mm:.1f} mm into each other's reach"
    return (
        deepest(FREE_MOTION, "hip and knee through their working ranges", found),
        worst_of(SHANK_CLEARANCE, "any hip angle, the knee's working range", [Finding(value=clearance_mm, text=text)]),
    )


def in_working_range(product: Product) -> tuple[list[Overlap], float]:
    """Overlaps while hip and knee move through their working ranges, and the shank's distance from the base in mm."""
    by_body = _by_body(product)
    to_knee = np.linalg.inv(body_frames(product.robot, _ZERO)["shank"]).astype(np.float64)
    hip = _while_turning(by_body["base"], by_body["thigh"], HIP_RANGE_RAD, np.eye(4), "hip")
    knee = _while_turning(by_body["thigh"], by_body["shank"], KNEE_RANGE_RAD, to_knee, "knee")
    return hip + knee, _shank_clearance_mm(product, by_body)


def _by_body(product: Product) -> Bodies:
    """The parts of each body with both joints at zero, with their meshes."""
    found: Bodies = {"base": [], "thigh": [], "shank": []}
    for instance, kind in zip(instances(product.robot, _ZERO), product.kinds, strict=True):
        # What turns inside an actuator turns with the next body and has its own check.
        if instance.part.group not in _TURNING:
            found[instance.body].append((instance, product.unique[kind].mesh.body))
    return found


def _while_turning(
    fixed: list[tuple[Instance, m3.Manifold]],
    moving: list[tuple[Instance, m3.Manifold]],
    limits_rad: tuple[float, float],
    frame: Matrix,
    joint: str,
) -> list[Overlap]:
    """Overlaps of the parts of two bodies while one turns about the joint between them.

    Args:
        fixed: parts with their meshes of the body that stands still.
        moving: the same of the body that turns.
        limits_rad: the joint's range.
        frame: 4 x 4 matrix from the assembly's frame to one with its origin on the joint's axis, which is y.
        joint: its name.
    """
    here = [PlacedMesh.of(i.name, body, frame @ i.world) for i, body in fixed]
    there = [PlacedMesh.of(i.name, body, frame @ i.world) for i, body in moving]
    reach = {mesh.name: radii_mm(mesh) for mesh in (*here, *there)}
    pairs = [(a, b) for a in here for b in there if _may_meet(a, b, reach)]
    found: list[Overlap] = []
    for angle in _through(limits_rad):
        turned: dict[str, PlacedMesh] = {}
        for one, other in pairs:
            if other.name not in turned:
                turned[other.name] = PlacedMesh.of(other.name, other.body, turn_y(float(angle)))
            if boxes_meet(one, turned[other.name]):
                found += overlap_of(one, turned[other.name], f"with the {joint} at {np.degrees(angle):.0f} deg")
    return found


def _through(limits_rad: tuple[float, float]) -> NDArray[np.float64]:
    """Angles from one limit to the other, both included."""
    return np.linspace(*limits_rad, int(np.ceil((limits_rad[1] - limits_rad[0]) / _STEP_RAD)) + 1)


def _shank_clearance_mm(product: Product, by_body: Bodies) -> float:
    """How far the shank stays from the base at any hip angle, negative if they can meet.

    The base lies within the circle about the hip axis that its farthest part reaches. The clearance is the distance of
    the shank from that circle, the least over the knee's range.
    """
    base = [PlacedMesh.of(i.name, body, i.world) for i, body in by_body["base"]]
    reach = max(radii_mm(mesh)[1] for mesh in base)
    distance = np.inf
    for angle in _through(KNEE_RANGE_RAD):
        frame = body_frames(product.robot, Pose(hip_rad=0.0, knee_rad=float(angle)))["shank"]
        for instance, body in by_body["shank"]:
            distance = min(distance, radii_mm(PlacedMesh.of(instance.name, body, frame @ instance.in_body))[0])
    return float(distance - reach)


def radii_mm(mesh: PlacedMesh) -> tuple[float, float]:
    """Least and greatest distance of a mesh from the y axis."""
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
    """Whether turning about the y axis can bring two meshes together."""
    if one.low[1] >= other.high[1] - TOUCH_MM or other.low[1] >= one.high[1] - TOUCH_MM:
        return False
    (least, greatest), (other_least, other_greatest) = reach[one.name], reach[other.name]
    return least < other_greatest - DEPTH_MM and other_least < greatest - DEPTH_MM
