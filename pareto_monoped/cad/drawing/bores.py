"""Round holes of a part: merged over its prisms, with what is cut into them, and as they are called out."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely

from pareto_monoped.cad.drawing.paper import TIMES
from pareto_monoped.cad.shape.outlines import centres_mm, contours, polygon
from pareto_monoped.geometry.features import Cone, Hole, Mouth
from pareto_monoped.geometry.making import Fit
from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.screws import M3, M4, M5, M25
from pareto_monoped.geometry.shapes import Circle, Pattern, Shape

_SAME_MM = 1e-6

PLACE_FITTED_MM = 0.02
"""Diameter of the zone of a fitted pattern's axes: about what ISO 1328-1 class 6 allows the pitch of teeth of this
size, so that planets share their load (our own choice)."""
PLACE_SCREWS_MM = 0.1
"""Likewise of screws: half of the 0.2 mm by which an M3 clearance hole is wider (ISO 273, fine); two parts share it."""
_HOLES_MM = (
    *(2.0 * screw.hole for screw in (M25, M3, M4, M5)),  # ISO 273, fine
    *(4.2, 5.2, 5.7),  # sleeve nuts for M3 and M4, heads of M3
    4.0,  # dowels whose holes are reamed in place
    10.2,  # the base's rods
)
"""Diameters of plain holes that something passes which another part holds in its place; others save weight."""
_MOTOR_HOLES_MM = (3.5, 4.5, 5.5, 6.5)
"""Likewise of patterns for a motor's own screws, M3 to M6 (ISO 273, medium)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bore:
    """Holes of one circle or pattern, from one height to another."""

    shape: Circle | Pattern  #: where they are
    low: float  #: height of their lower end
    high: float
    through: bool  #: whether they go through all of the part's material there
    feature: Hole | None  #: what is cut into them, if the part says so
    fit: Fit | None  #: their tolerance, if they have one

    @property
    def radius(self) -> float:
        """Of each hole."""
        return float(self.shape.radius_mm)

    @property
    def count(self) -> int:
        """How many they are."""
        return int(self.shape.count) if isinstance(self.shape, Pattern) else 1

    @property
    def centres(self) -> list[tuple[float, float]]:
        """Where their axes are."""
        return centres_mm(self.shape)

    @property
    def place_mm(self) -> float | None:
        """Diameter of the zone in which their axes must lie; None where general tolerances do."""
        if self.count == 1 and max(map(abs, self.centres[0])) < _SAME_MM:
            return None
        if self.fit is not None:
            return PLACE_FITTED_MM
        widths = _HOLES_MM + (_MOTOR_HOLES_MM if self.count > 1 else ())
        passed = any(abs(2.0 * self.radius - width) < _SAME_MM for width in widths)
        return PLACE_SCREWS_MM if self.feature is not None or passed else None

    @property
    def mouths(self) -> tuple[Mouth | None, Mouth | None]:
        """The cones at the lower and the upper end."""
        return (None, None) if self.feature is None else (self.feature.low, self.feature.high)

    def size(self) -> str:
        """Thread or diameter with its fit and depth, as on the drawing."""
        thread = None if self.feature is None else self.feature.thread
        depth = "" if self.through else f", {number(self.high - self.low)} deep"
        if thread is not None:
            usable = self.feature.thread_mm if self.feature is not None else None
            long = f", {number(float(usable))} deep" if usable is not None else depth
            drill = f", drill Ø{number(2.0 * self.radius)}{depth or ' through'}" if long else " through"
            return f"{thread.text}{long}{drill}"
        zone = f" {self.fit.zone}" if self.fit is not None else ""
        return f"Ø{number(2.0 * self.radius)}{zone}{depth or ' through'}"

    def details(self, *, from_above: bool) -> Iterator[str]:
        """Countersinks, chamfers and lead-ins, by the side that they are on; a note gives those of threads.

        A thread that is shorter than its hole has the side that it is cut from, which no drawn edge shows; one to the
        bottom of its hole leaves no run-out to the usual tap.
        """
        threaded = self.feature is not None and self.feature.thread is not None
        said = [
            (self._countersink(mouth) if mouth.kind is Cone.COUNTERSINK else self._chamfer(mouth), above == from_above)
            for mouth, above in zip(self.mouths, (False, True), strict=True)
            if mouth is not None and (mouth.kind is Cone.COUNTERSINK or (not threaded and self._ends_at_mouth(above)))
        ]
        if threaded and self.through and self.feature is not None and self.feature.thread_mm is not None:
            near, far = (self.mouths[above] is not None for above in (from_above, not from_above))
            yield f"tapped from {'both sides' if near and far else 'this side' if near else 'the far side'}"
        if threaded and not self.through and self.feature is not None and self.feature.thread_mm is None:
            yield "bottoming tap"
        for text in dict.fromkeys(text for text, _ in said):
            sides = {near for other, near in said if other == text}
            yield f"{text}{', both sides' if len(sides) == 2 else '' if True in sides else ', far side'}"

    def _ends_at_mouth(self, above: bool) -> bool:
        """Return whether these holes end where the feature does: a narrower step of the same feature has no cone."""
        assert self.feature is not None
        end = float(self.feature.high_mm) - self.high if above else float(self.feature.low_mm) - self.low
        return abs(end) < _SAME_MM

    def _countersink(self, mouth: Mouth) -> str:
        angle = 2.0 * np.degrees(np.arctan2(float(mouth.radius_mm) - self.radius, float(mouth.depth_mm)))
        return f"countersink Ø{number(2.0 * float(mouth.radius_mm))} {TIMES} {number(angle)}°"

    def _chamfer(self, mouth: Mouth) -> str:
        return f"chamfer {chamfer_text(float(mouth.depth_mm), float(mouth.radius_mm) - self.radius)}"


def bores(part: Part, *, on_axis: bool = False) -> tuple[Bore, ...]:
    """Return the round holes of a part beside its axis, largest circle first; those on the axis too if asked for."""
    found: dict[Circle | Pattern, list[tuple[float, float]]] = {}
    for prism in sorted(part.prisms, key=lambda p: float(p.z0_mm)):
        for hole in prism.holes:
            if not isinstance(hole, Circle | Pattern):
                continue
            centred = max(abs(float(hole.x_mm)), abs(float(hole.y_mm))) < _SAME_MM
            if isinstance(hole, Circle) and centred and not on_axis:
                continue
            spans = found.setdefault(hole, [])
            low, high = float(prism.z0_mm), float(prism.z1_mm)
            if spans and abs(spans[-1][1] - low) < _SAME_MM:
                spans[-1] = (spans[-1][0], high)
            else:
                spans.append((low, high))
    return tuple(_bore(part, shape, low, high) for shape, spans in found.items() for low, high in spans)


def _bore(part: Part, shape: Circle | Pattern, low: float, high: float) -> Bore:
    feature = _feature(part, shape, low, high)
    # A tapping drill may have the diameter of a fitted hole.
    threaded = feature is not None and feature.thread is not None
    fits = () if threaded else (fit for fit in part.toleranced if fit.holds(2.0 * float(shape.radius_mm)))
    through, fit = _through(part, shape, low, high), next(iter(fits), None)
    return Bore(shape=shape, low=low, high=high, through=through, feature=feature, fit=fit)


def chamfer_text(along: float, across_mm: float) -> str:
    """Return a text such as ``0.5 x 45°``; the angle is measured from the axis."""
    return f"{number(along)} {TIMES} {number(round(float(np.degrees(np.arctan2(across_mm, along))), 1))}°"


def number(value: float) -> str:
    """Return a length or angle as it is written on a drawing: to a micrometre, without useless zeros."""
    text = f"{value:.3f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def _feature(part: Part, shape: Circle | Pattern, low: float, high: float) -> Hole | None:
    for feature in part.features:
        if not isinstance(feature, Hole) or shape not in feature.shapes:
            continue
        if float(feature.low_mm) < high - _SAME_MM and float(feature.high_mm) > low + _SAME_MM:
            return feature
    return None


def _through(part: Part, shape: Circle | Pattern, low: float, high: float) -> bool:
    """Return whether no material stands before either end of a hole."""
    x, y = centres_mm(shape)[0]
    reach = 0.98 * float(shape.radius_mm)  # a narrower hole beyond leaves a step
    points = [(x, y), (x + reach, y), (x - reach, y), (x, y + reach), (x, y - reach)]
    return not any(
        _covers(prism, *point)
        for prism in part.prisms
        if abs(float(prism.z0_mm) - high) < _SAME_MM or abs(float(prism.z1_mm) - low) < _SAME_MM
        for point in points
    )


def _covers(prism: Prism, x: float, y: float) -> bool:
    def within(shape: Shape) -> bool:
        return any(shapely.contains_xy(shapely.Polygon(polygon(contour)), x, y) for contour in contours(shape))

    return within(prism.outline) and not any(within(hole) for hole in prism.holes)
