"""Rules of making: what stops a workshop although a solid is valid. Each looks at the record of one machined part.

A part is seen in sections across its axis, in which gears count by their root circles, and, as far as it is round, in a
section along its axis: a grid of heights and radii, each cell full or empty.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cached_property
from itertools import pairwise

import manifold3d as m3
import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.check.result import (
    CENTRES,
    COLLARS,
    DATUMS,
    GAUGES,
    SLOTS,
    TAPS,
    WALLS,
    WINDOWS,
    Check,
    Limit,
    count_of,
)
from pareto_monoped.cad.check.retention import toothless
from pareto_monoped.cad.product import ListedPart
from pareto_monoped.cad.shape.meshes import cross_section
from pareto_monoped.cad.shape.outlines import centres_mm
from pareto_monoped.geometry.features import POINT_SHARE, Cone, Hole, tap_run_out_mm
from pareto_monoped.geometry.making import GROOVE_ZONES, RELIEF_MM, Fit
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.shapes import Circle, Pattern, Shape
from pareto_monoped.materials import GearGrade

SLOT_DEPTHS = 5.0
"""Greatest depth of a slot or groove over its width: end mills of normal length reach 3 to 5 diameters, tools for face
grooves 4 to 6 widths (makers' catalogues)."""
TOOL_RADIUS_MM = 1.0
"""Least radius in windows: an end mill of 2 mm; our own choice, thinner ones break."""
WALL_MM = 0.5
"""Least metal between holes and edges across the axis; our own choice, half of the narrowest wall that is milled."""
LIP_MM = 0.75
"""Least thickness of what is turned: flanges, lips, tubes; our own choice: thinner ones give way to the tool."""
COLLAR_SHARE = 0.5
"""Least thickness of the collar beside a groove over the groove's depth; our own choice: slender ones bend under the
tool. DIN 471 and 472 ask for 3 if the ring is to carry its full load; what it has to carry, strength factors show."""
FLOOR_MM = 0.5
"""Least metal under a blind hole, under the drill's point where it is tapped; our own choice."""
OPEN_SHARE = 0.75
"""Of a tapped hole's section that is free beyond its end if it counts as through: the drill goes straight on and the
tap cuts a notch; our own choice."""
GAUGE_STEP_MM = 0.1
"""Plug and ring gauges are stocked by whole millimetres, and by tenths against a surcharge (makers' catalogues)."""
SPAN_SHARE = 0.5
"""Least length over which its seats guide a ground shaft, over the shaft's; our own choice: from a shorter one, the
error of a datum axis more than doubles towards the far end."""
_SEGMENTS = 32
_SPECK_MM2, _CORNER_MM2 = 0.02, 0.2
"""What may be lost with a thin wall by its facets alone, and of an acute corner."""
_CORNER_SHARE = 0.1
"""Of the square of a tool's radius, left in a corner: in a sharp one of 90 degrees, 1 - pi / 4."""
_FACETS_MM = 0.02
_TOUCH_MM = 1e-4

Bools = NDArray[np.bool_]
Found = Iterator[str]


class Made:
    """A machined part as the rules look at it."""

    def __init__(self, part: Part) -> None:
        self.part = part
        self.slices = self._slices(drilled=True)  # without their holes

    def _slices(self, *, drilled: bool) -> list[tuple[float, float, m3.CrossSection]]:
        """Return sections between heights at which they change, with or without round holes beside the axis."""
        pieces = []
        for prism in self.part.prisms:
            section = cross_section([toothless(prism.outline)], _FACETS_MM)
            holes = [toothless(hole) for hole in prism.holes if drilled or not _beside(hole)]
            if holes:
                section -= cross_section(holes, _FACETS_MM)
            pieces.append((float(prism.z0_mm), float(prism.z1_mm), section))
        found = []
        for low, high in pairwise(self.heights):
            here = [section for z0, z1, section in pieces if z0 < low + _TOUCH_MM and z1 > high - _TOUCH_MM]
            if here:
                found.append((low, high, m3.CrossSection.batch_boolean(here, m3.OpType.Add)))
        return found

    @cached_property
    def windows(self) -> list[tuple[float, float, m3.CrossSection]]:
        """What is open and has metal all around, without round holes, between two heights."""
        found = []
        for low, high, section in self._slices(drilled=False):
            around = [loop for loop in section.to_polygons() if _area(loop) > 0.0]
            inside = m3.CrossSection(around, m3.FillRule.NonZero) - section
            found += [(low, high, window) for window in inside.decompose() if not _is_disc(window)]
        return found

    @cached_property
    def heights(self) -> list[float]:
        """Edges of the rows of ``full``."""
        return sorted({round(float(z), 6) for prism in self.part.prisms for z in (prism.z0_mm, prism.z1_mm)})

    @cached_property
    def radii(self) -> list[float]:
        """Edges of its columns."""
        return sorted({0.0} | {round(r, 6) for _, _, *pair in self._rings for r in pair})

    @cached_property
    def _rings(self) -> list[tuple[float, float, float, float]]:
        """Heights, inner and outer radius of every prism that is round about the z axis."""
        found = []
        for prism in self.part.prisms:
            outer = _radius(prism.outline)
            if outer:
                inner = max((_radius(hole) for hole in prism.holes), default=0.0)
                found.append((float(prism.z0_mm), float(prism.z1_mm), inner, outer))
        return found

    @cached_property
    def full(self) -> Bools:
        """The section along the axis: which cells are full."""
        z, r = (0.5 * (np.array(edges[1:]) + np.array(edges[:-1])) for edges in (self.heights, self.radii))
        full = np.zeros((len(z), len(r)), dtype=bool)
        for z0, z1, inner, outer in self._rings:
            full |= ((z0 < z) & (z < z1))[:, None] & ((inner < r) & (r < outer))[None]
        return full

    def outer_mm(self, row: int) -> float:
        """Return the outer radius in a row."""
        filled = np.flatnonzero(self.full[row])
        return self.radii[filled[-1] + 1] if len(filled) else 0.0

    @cached_property
    def ground(self) -> list[Fit]:
        """The seats of a hardened shaft of several diameters; empty for all other parts."""
        if not isinstance(self.part.grade, GearGrade) and not any(fit.raceway for fit in self.part.fits):
            return []
        seats = [fit for fit in self.part.fits if fit.zone[0].islower() and fit.zone not in GROOVE_ZONES]
        return seats if len({self.outer_mm(row) for row in range(len(self.full))}) > 1 else []

    def seat_rows(self, fit: Fit) -> list[int]:
        """Return the rows in which the part's outside has a fit."""
        return [row for row in range(len(self.full)) if fit.holds(2.0 * self.outer_mm(row))]


def _beside(shape: Shape) -> bool:
    return isinstance(shape, Pattern) or (isinstance(shape, Circle) and not _radius(shape))


def _radius(shape: Shape) -> float:
    """Return the radius of what is round about the axis; 0 for all else."""
    shape = toothless(shape)
    if isinstance(shape, Circle) and abs(float(shape.x_mm)) + abs(float(shape.y_mm)) < _TOUCH_MM:
        return float(shape.radius_mm)
    return 0.0


def _area(loop: NDArray[np.float64]) -> float:
    (x, y), (x1, y1) = loop.T, np.roll(loop, -1, axis=0).T
    return 0.5 * float(np.sum(x * y1 - x1 * y))


def _is_disc(section: m3.CrossSection) -> bool:
    x0, y0, x1, y1 = section.bounds()
    return bool(abs(section.area() / (0.25 * np.pi * (x1 - x0) * (y1 - y0)) - 1.0) < 0.01)


def _moved(section: m3.CrossSection, by_mm: float) -> m3.CrossSection:
    """Return a section with its edges moved outwards."""
    return section.offset(by_mm, m3.JoinType.Round, circular_segments=_SEGMENTS)


def _runs(line: Bools, edges: Sequence[float]) -> Iterator[tuple[bool, int, int, float]]:
    """Yield what follows each other in a line of cells: whether it is full, its first and last edge, its length."""
    ends = [0, *(np.flatnonzero(line[1:] != line[:-1]) + 1).tolist(), len(line)] if len(line) else []
    for first, last in pairwise(ends):
        yield bool(line[first]), first, last, edges[last] - edges[first]


def _grooves(full: Bools, across: Sequence[float], along: Sequence[float]) -> Iterator[tuple[float, float]]:
    """Yield width and depth of every gap between two full cells of a line, where it is as wide over its depth."""
    seen: set[tuple[int, int, int]] = set()
    for k, line in enumerate(full):
        for is_full, first, last, width in _runs(line, across):
            if is_full or first == 0 or last == len(line) or (first, last, k) in seen:
                continue
            end = k
            while end < len(full) and not full[end, first:last].any() and full[end, first - 1] and full[end, last]:
                seen.add((first, last, end))
                end += 1
            yield width, along[end] - along[k]


def slots(made: Made) -> Found:
    """Compare depth and width of what is turned or cut into faces."""
    for full, across, along in ((made.full, made.radii, made.heights), (made.full.T, made.heights, made.radii)):
        for width, depth in _grooves(full, across, along):
            if depth > SLOT_DEPTHS * width + _TOUCH_MM:
                yield (
                    f"slot {width:.2f} mm wide, depth = {depth:.2f} mm: must be at most {SLOT_DEPTHS * width:.2f}; "
                    "fill it or take one of its walls away"
                )


def windows(made: Made) -> Found:
    """Look for corners and gaps of windows that no end mill reaches."""
    for low, high, window in made.windows:
        swept = _moved(_moved(window, -TOOL_RADIUS_MM), TOOL_RADIUS_MM + _FACETS_MM)
        for rest in (window - swept).decompose():
            if rest.area() > _CORNER_SHARE * TOOL_RADIUS_MM**2:
                yield (
                    f"window from {low:.2f} to {high:.2f} mm, radius at {_place(rest)}: must be at least "
                    f"{TOOL_RADIUS_MM:g} mm; round its corners or widen it"
                )


def walls(made: Made) -> Found:
    """Measure what is left between holes and edges across the axis, and the lips of what is turned along it."""
    for low, high, section in made.slices:
        # Where a wall is too thin, edges join when they are moved into the metal; an acute corner is lost alone.
        inside = _moved(section, -0.5 * WALL_MM)
        joined = inside.num_contour() != section.num_contour()
        for rest in (section - _moved(inside, 0.5 * WALL_MM + _FACETS_MM)).decompose():
            if rest.area() > (_SPECK_MM2 if joined else _CORNER_MM2):
                yield (
                    f"wall from {low:.2f} to {high:.2f} mm at {_place(rest)}: must be at least {WALL_MM:g} mm thick; "
                    "make the hole smaller or move it"
                )
    # Seen the other way round, a lip is a groove in the air.
    air = np.pad(~made.full, ((1, 1), (0, 1)), constant_values=True)
    heights = [made.heights[0] - 1.0, *made.heights, made.heights[-1] + 1.0]
    radii = [*made.radii, made.radii[-1] + 1.0]
    for full, across, along in ((air, radii, heights), (air.T, heights, radii)):
        for thick, high in _grooves(full, across, along):
            if thick < min(LIP_MM, high) - _TOUCH_MM:
                yield f"lip of {high:.2f} mm, thickness = {thick:.2f} mm: must be at least {LIP_MM:g}; make it thicker"


def _place(section: m3.CrossSection) -> str:
    x0, y0, x1, y1 = section.bounds()
    return f"({0.5 * (x0 + x1):.1f}, {0.5 * (y0 + y1):.1f})"


def taps(made: Made) -> Found:
    """Measure the room beyond threads for the tap, and the floors under blind holes."""
    for hole in made.part.features:
        if not isinstance(hole, Hole) or (hole.low is None) == (hole.high is None):
            continue
        depth = float(hole.high_mm - hole.low_mm)
        spare = 0.0 if hole.thread_mm is None else depth - float(hole.thread_mm)
        run_out = tap_run_out_mm(hole.thread.pitch_mm) if hole.thread else 0.0
        diameter = 2.0 * float(hole.shapes[0].radius_mm)
        floor = FLOOR_MM + (POINT_SHARE * diameter if hole.thread else 0.0)
        name = hole.thread.text if hole.thread else f"hole of {diameter:g} mm"
        for free, metal in {made_under(made, hole, x, y) for shape in hole.shapes for x, y in centres_mm(shape)}:
            if spare + free < run_out - _TOUCH_MM:
                yield f"{name}, run-out = {spare + free:.2f} mm: must be at least {run_out:g}; drill deeper"
            if free == 0.0 and metal < floor - _TOUCH_MM:
                yield f"{name}, floor = {metal:.2f} mm: must be at least {floor:g}; drill less deep"


def made_under(made: Made, hole: Hole, x_mm: float, y_mm: float) -> tuple[float, float]:
    """Return how far a hole's way is free beyond its inner end, and how thick the metal is that ends it."""
    disc = cross_section([Circle(radius_mm=float(hole.shapes[0].radius_mm), x_mm=x_mm, y_mm=y_mm)])
    upward = hole.high is None
    end = float(hole.high_mm if upward else hole.low_mm)
    free, metal = 0.0, 0.0
    for low, high, section in made.slices if upward else reversed(made.slices):
        near, far = (low - end, high - end) if upward else (end - high, end - low)
        if near < -_TOUCH_MM:
            continue
        if (section ^ disc).area() > (1.0 - OPEN_SHARE) * disc.area():
            if metal == 0.0:
                free = near
            elif near > free + metal + _TOUCH_MM:
                break
            metal = far - free
        elif metal:
            break
    return (round(free, 6), round(metal, 6)) if metal else (np.inf, np.inf)


def collars(made: Made) -> Found:
    """Compare the collars on both sides of a retaining ring's groove with its depth."""
    for fit in made.part.fits:
        if fit.zone not in GROOVE_ZONES:
            continue
        inner = fit.zone[0].islower()  # metal inside, as of a shaft
        edge = int(np.argmin(np.abs(np.array(made.radii) - 0.5 * float(fit.diameter_mm))))
        column = edge if inner else edge - 1
        runs = list(_runs(made.full[:, column], made.heights))
        for before, here, after in zip(runs, runs[1:], runs[2:], strict=False):
            if here[0]:
                continue
            for row, thick in ((here[1] - 1, before[3]), (here[2], after[3])):
                line = made.full[row, column:] if inner else made.full[row, column::-1]
                far = int(np.argmin(line)) if not line.all() else len(line)
                other = made.radii[column + far] if inner else made.radii[column + 1 - far]
                least = COLLAR_SHARE * abs(other - 0.5 * float(fit.diameter_mm))
                if thick < least - _TOUCH_MM:
                    yield (
                        f"collar beside the groove of {fit.text} = {thick:.2f} mm: must be at least {least:.2f}; "
                        "move the groove"
                    )


def gauges(made: Made) -> Found:
    """Ask for diameters with a gauge."""
    for fit in made.part.fits:
        if abs(np.remainder(float(fit.diameter_mm) / GAUGE_STEP_MM + 0.5, 1.0) - 0.5) > _TOUCH_MM:
            yield f"fit {fit.text}: must be a multiple of {GAUGE_STEP_MM:g} mm; round its diameter"


def centres(made: Made) -> Found:
    """Look for centre holes in both ends of a ground shaft, and for reliefs where its seats meet a shoulder."""
    if not made.ground:
        return
    mouths = [
        (float(face), mouth.kind)
        for hole in made.part.features
        if isinstance(hole, Hole) and _radius(hole.shapes[0])
        for face, mouth in ((hole.low_mm, hole.low), (hole.high_mm, hole.high))
        if mouth is not None
    ]
    for end in (made.heights[0], made.heights[-1]):
        if not any(abs(face - end) < _TOUCH_MM and kind is Cone.CENTRE for face, kind in mouths):
            yield f"end at {end:.2f} mm: must have a centre hole; add one of DIN 332"
    for fit in made.ground:
        for row in made.seat_rows(fit):
            for beyond in (row - 1, row + 1):
                if 0 <= beyond < len(made.full) and made.outer_mm(beyond) > made.outer_mm(row) + _TOUCH_MM:
                    yield (
                        f"seat {fit.text} at {made.heights[max(row, beyond)]:.2f} mm, relief = 0 mm: must be at least "
                        f"{RELIEF_MM[0]:g} wide; add one of DIN 509"
                    )


def datums(made: Made) -> Found:
    """Ask how far the seats of a ground shaft lie apart."""
    if made.ground:
        rows = [row for fit in made.ground for row in made.seat_rows(fit)]
        span = made.heights[max(rows) + 1] - made.heights[min(rows)] if rows else 0.0
        least = SPAN_SHARE * (made.heights[-1] - made.heights[0])
        if span < least - _TOUCH_MM:
            yield f"length between the ends of its seats = {span:.2f} mm: must be at least {least:.2f}; add a seat"


RULES: dict[Limit, Callable[[Made], Iterable[str]]] = {
    SLOTS: slots,
    WINDOWS: windows,
    WALLS: walls,
    TAPS: taps,
    COLLARS: collars,
    GAUGES: gauges,
    CENTRES: centres,
    DATUMS: datums,
}


def check(parts: Sequence[ListedPart]) -> tuple[Check, ...]:
    """Apply every rule to the parts that are machined."""
    made = {one.name: Made(one.part) for one in parts if one.part.process == "machined"}
    looked_at = f"{len(made)} machined parts"
    return tuple(
        count_of(
            limit, looked_at, [f"{name}: {text}" for name, one in made.items() for text in dict.fromkeys(rule(one))]
        )
        for limit, rule in RULES.items()
    )
