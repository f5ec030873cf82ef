"""Gears roll on their driving flanks through a whole cycle and touch nowhere else, by the outlines of their solids."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import shapely
from scipy.interpolate import CubicSpline
from shapely import Polygon, affinity

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.cad.check.result import GEAR_MESH, Check, Finding, worst_of
from pareto_monoped.cad.product import Product
from pareto_monoped.cad.shape.outlines import Contour, Spline, contours, polygon
from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from pareto_monoped.geometry.roles import Group, Role

STEPS = 8  #: Positions of the gears within one pitch, after which all repeats.
_GROUPS = {"sun": Group.ROTOR, "planet": Group.PLANET}
_TOUCH_EXACT_MM = 1e-4
"""To which the angles are found, as lengths along the flanks' normal."""
_FINER = 6
"""Points between two of a spline's, for the chords of a flank to lie within 0.1 um of it."""


def check(product: Product) -> Check:
    """Roll the gears of both actuators on their driving flanks, in both directions, by the outlines of their solids."""
    robot = product.robot
    actuators = {"hip_actuator": robot.hip} | ({} if robot.knee is robot.hip else {"knee_actuator": robot.knee})
    found = [
        replace(mesh, name=f"{name}/{mesh.name}") for name, actuator in actuators.items() for mesh in rolled(actuator)
    ]
    clearance_mm = min(mesh.clearance_mm for mesh in found)
    return worst_of(
        GEAR_MESH,
        f"sun, planets and ring, driven both ways in {STEPS} steps of a tooth; {clearance_mm:.3f} mm elsewhere",
        [Finding(value=mesh.early_mm, text=str(mesh)) for mesh in found],
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Rolled:
    """What two gears do that roll on each other on their driving flanks."""

    name: str
    #: By how much they touch too early somewhere in the cycle, along the flanks' normal; the depth of what overlaps
    early_mm: float
    clearance_mm: float  #: least distance of the flanks that do not drive, along their normal, and of tips from roots

    def __str__(self) -> str:
        return f"{self.name} touch {self.early_mm:.4f} mm too early: a tip reaches into a root, or flanks do not fit"


def rolled(actuator: Actuator) -> Iterator[Rolled]:
    """Yield what sun and planet, and planet and ring, do, for each direction of the load.

    Both turn about fixed centres by equal pitches. The planet is then turned on until it touches. With involute flanks
    it takes the same angle in all positions; where a tip meets a root first, it takes less.
    """
    gears = actuator.gears
    distance, half_mm = float(gears.carrier_radius_mm), 0.5 * float(gears.module_mm * gears.planet_teeth)
    sun, planet, ring = (_metal(actuator, name) for name in ("sun", "planet", "ring"))
    planet = affinity.translate(planet, distance, 0.0)
    tips = (float(gear.tip_radius_mm) for gear in (gears.sun(), gears.planet(), gears.ring()))
    roots = (float(gear.root_radius_mm) for gear in (gears.sun(), gears.planet(), gears.ring()))
    sun_tip, planet_tip, ring_tip, sun_root, planet_root, ring_root = *tips, *roots
    at_tips = min(distance - sun_tip - planet_root, distance - planet_tip - sun_root)
    at_ring_tips = min(ring_root - distance - planet_tip, ring_tip - distance - planet_root)
    for name, mate, teeth, sense, x_mm, tips_mm in (
        ("sun and planet", sun, float(gears.sun_teeth), -1.0, distance - half_mm, at_tips),
        ("ring and planet", ring, float(gears.ring_teeth), 1.0, distance + half_mm, at_ring_tips),
    ):
        positions = []
        for step in 2.0 * np.pi * np.arange(STEPS) / STEPS:
            turned = affinity.rotate(mate, step / teeth, (0.0, 0.0), use_radians=True)
            other = affinity.rotate(planet, sense * step / gears.planet_teeth, (distance, 0.0), use_radians=True)
            positions.append((_near(turned, x_mm, gears), _near(other, x_mm, gears)))
        for way in (1.0, -1.0):
            found = _rolled_one_way(name, positions, way / float(gears.planet().base_radius_mm), (distance, 0.0))
            yield replace(found, clearance_mm=min(found.clearance_mm, tips_mm))


def _rolled_one_way(
    name: str, positions: list[tuple[Polygon, Polygon]], turn_per_mm: float, centre: tuple[float, float]
) -> Rolled:
    def turned(planet: Polygon, by_mm: float) -> Polygon:
        return affinity.rotate(planet, by_mm * turn_per_mm, centre, use_radians=True)

    touching = []
    for still, planet in positions:
        if still.intersects(planet):
            shared = still.intersection(planet)
            return Rolled(name=name, early_mm=2.0 * shared.area / max(shared.length, 1e-9), clearance_mm=0.0)
        low, high = 0.0, 0.1
        while not still.intersects(turned(planet, high)):
            low, high = high, 2.0 * high
        while high - low > _TOUCH_EXACT_MM:
            middle = 0.5 * (low + high)
            low, high = (low, middle) if still.intersects(turned(planet, middle)) else (middle, high)
        touching.append(low)
    # Half of the play is on either side: pressed against one flank, the other one is twice as far away.
    return Rolled(name=name, early_mm=max(touching) - min(touching), clearance_mm=2.0 * min(touching))


def _near(metal: Polygon, x_mm: float, gears: GearSet) -> Polygon:
    """Return the metal around the pitch point, three pitches to either side."""
    module = float(gears.module_mm)
    return shapely.clip_by_rect(metal, x_mm - 4.0 * module, -9.0 * module, x_mm + 4.0 * module, 9.0 * module)


def _metal(actuator: Actuator, name: str) -> Polygon:
    """Return a gear's solid as it is extruded, without its bore; of a ring, what is around its teeth."""
    kind, group = (InternalGear, Group.HOUSING) if name == "ring" else (ExternalGear, _GROUPS[name])
    teeth = getattr(actuator.gears, f"{name}_teeth")
    gear = next(
        shape
        for part in actuator.parts
        if part.role is Role.GEAR and part.group is group
        for prism in part.prisms
        for shape in (prism.outline, *prism.holes)
        if isinstance(shape, kind) and shape.teeth == teeth
    )
    (contour,) = contours(gear)
    points = []
    for piece in contour.pieces:
        if isinstance(piece, Spline):
            along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(piece.points_mm, axis=0).T))])
            finer = np.interp(np.linspace(0.0, len(along) - 1.0, _FINER * len(along)), np.arange(len(along)), along)
            points.append(CubicSpline(along, piece.points_mm)(finer)[:-1])
        else:
            points.append(polygon(Contour(pieces=(piece,)), 1e-4))
    outline = shapely.Polygon(np.concatenate(points))
    if isinstance(gear, InternalGear):
        return shapely.Point(0.0, 0.0).buffer(float(gear.root_radius_mm + gear.module_mm), 64).difference(outline)
    return outline
