"""The view of a round part along its axis: visible edges, patterns of holes and their callouts."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.drawing.bores import Bore, number
from pareto_monoped.cad.drawing.dimension import DATUM, callout, callout_height
from pareto_monoped.cad.drawing.paper import CHAIN, DASHED, SOLID, TIMES, WIDE_MM, Paper
from pareto_monoped.cad.drawing.profile import seen, visible_circles
from pareto_monoped.cad.drawing.section import RoundPart
from pareto_monoped.geometry.shapes import Pattern

_COLUMN_MM = 12.0  # from the outline to the callouts
_SAME_MM = 1e-3


def sees_more_from_above(part: RoundPart) -> bool:
    """Return whether more kinds of holes open towards the upper end than towards the lower one."""
    above = sum(_open(part, bore, from_above=True) for bore in part.bores)
    below = sum(_open(part, bore, from_above=False) for bore in part.bores)
    middle = 0.5 * (part.body.bounds[0] + part.body.bounds[2])
    return above > below or (above == below and part.datum >= middle)


def end_view(part: RoundPart, scale: float, datum: str | None) -> Paper:
    """Return the view with its callouts, the axis at the origin; ``datum`` is the axis that positions refer to."""
    paper = Paper()
    outer = part.body.bounds[3] * scale
    for radius in visible_circles(part.body, from_above=part.from_above):
        paper.circle(0.0, 0.0, radius * scale, width_mm=WIDE_MM)
    for teeth in part.teeth:
        paper.circle(0.0, 0.0, float(teeth.gear.pitch_radius_mm) * scale, dashes=CHAIN)
    for bore in part.bores:
        draw_bore(paper, bore, scale, visible=_visible(part, bore), from_above=part.from_above)
    paper.centre_mark(0.0, 0.0, outer + 3.0)
    _callouts(paper, part, scale, datum, outer)
    return paper


def draw_bore(paper: Paper, bore: Bore, scale: float, *, visible: bool, from_above: bool) -> None:
    """Draw holes as circles with their cones and threads, centre lines and pitch circle."""
    mirrored = 1.0 if from_above else -1.0
    centres = [(mirrored * x * scale, y * scale) for x, y in bore.centres]
    mouth = bore.mouths[1 if from_above else 0]
    thread = bore.feature.thread if bore.feature is not None else None
    width, dashes = (WIDE_MM, SOLID) if visible else (0.25, DASHED)
    for x, y in centres:
        paper.circle(x, y, bore.radius * scale, width_mm=width, dashes=dashes)
        if thread is not None:
            angles = np.radians(np.linspace(-10.0, 260.0, 28))
            radius = 0.5 * thread.diameter_mm * scale
            paper.line(np.stack([x + radius * np.cos(angles), y + radius * np.sin(angles)], axis=1))
        elif mouth is not None and visible:
            paper.circle(x, y, float(mouth.radius_mm) * scale, width_mm=WIDE_MM)
        paper.centre_mark(x, y, bore.radius * scale + 1.2)
    if isinstance(bore.shape, Pattern):
        centre = (mirrored * float(bore.shape.x_mm) * scale, float(bore.shape.y_mm) * scale)
        paper.circle(*centre, float(bore.shape.pitch_radius_mm) * scale, dashes=CHAIN)


def bore_lines(bore: Bore, *, from_above: bool, far_side: bool) -> list[str]:
    """Return a callout: number and size, circle, countersink; ``far_side`` holes open on the other side only."""
    times = f"{bore.count} {TIMES} " if bore.count > 1 else ""
    lines = [f"{times}{bore.size()}{', far side' if far_side else ''}"]
    if isinstance(bore.shape, Pattern):
        turn, degrees = 360.0 / bore.count, float(np.degrees(bore.shape.phase_rad))
        phase = degrees if from_above else 180.0 - degrees
        first = round(phase % turn, 3) % round(turn, 3)
        beginning = f", first at {number(first)}°" if first > 0.0 else ""
        lines.append(f"on Ø{number(2.0 * float(bore.shape.pitch_radius_mm))}, evenly spaced{beginning}")
    return lines + list(bore.details(from_above=from_above))


def _span(part: RoundPart, bore: Bore) -> list[str]:
    """Return between which running lengths holes stand, where others have another length or place.

    Flanges at both ends have holes that look alike from here.
    """
    if all(abs(bore.low - one.low) < _SAME_MM and abs(bore.high - one.high) < _SAME_MM for one in part.bores):
        return []
    near, far = sorted(abs(z - part.datum) for z in (bore.low, bore.high))
    return [f"between {number(near)} and {number(far)}"]


def _open(part: RoundPart, bore: Bore, *, from_above: bool) -> bool:
    """Return whether a viewer along the axis looks onto the mouth of a hole."""
    x, y = bore.centres[0]
    height = seen(part.body, float(np.hypot(x, y)), from_above=from_above)
    return height is not None and abs(height - (bore.high if from_above else bore.low)) < _SAME_MM


def _visible(part: RoundPart, bore: Bore) -> bool:
    """Return whether a hole is seen: at its mouth, or through a wider one before it."""
    wide = [other for other in part.bores if other.centres == bore.centres and other.radius >= bore.radius]
    return any(_open(part, other, from_above=part.from_above) for other in wide)


def _pointed(bores: Sequence[Bore], scale: float, from_above: bool) -> list[NDArray[np.float64]]:
    """Return the hole that each pattern's leader ends at: of the rightmost two, in turn the upper and the lower."""
    found, side = [], 1.0
    for bore in bores:
        mirrored = 1.0 if from_above else -1.0
        centres = np.array([(mirrored * cx * scale, cy * scale) for cx, cy in bore.centres])
        right = centres[centres[:, 0] >= centres[:, 0].max() - 1e-3]
        found.append(right[int(np.argmax(side * right[:, 1]))])
        side = -side if len(right) > 1 else side
    return found


def _callouts(paper: Paper, part: RoundPart, scale: float, datum: str | None, outer: float) -> None:
    # Without a seat, the first fitted pattern is the datum of the others.
    fitted = [bore for bore in part.bores if bore.fit is not None and bore.count > 1 and bore.place_mm is not None]
    own = fitted[0] if datum is None and fitted else None
    entries = [
        (
            bore,
            [
                *bore_lines(bore, from_above=part.from_above, far_side=not (bore.through or _visible(part, bore))),
                *_span(part, bore),
            ],
            ()
            if bore.place_mm is None
            else (f"Ø{number(bore.place_mm)}", *filter(None, (datum or (DATUM if own and bore is not own else None),))),
        )
        for bore in part.bores
    ]
    y = 0.5 * sum(callout_height(lines, place) for _, lines, place in entries)
    x = outer + _COLUMN_MM
    pointed = _pointed([bore for bore, _, _ in entries], scale, part.from_above)
    # From above in the order of the holes, so that no leader crosses another.
    for k in sorted(range(len(entries)), key=lambda k: (-round(float(pointed[k][1]), 3), k)):
        bore, lines, place = entries[k]
        y -= 4.0
        centre = pointed[k]
        towards = np.array([x - 3.0, y]) - centre
        tip = centre + bore.radius * scale * towards / np.hypot(*towards)
        callout(paper, lines, x, y, (float(tip[0]), float(tip[1])), place=place, letter=DATUM if bore is own else "")
        y -= callout_height(lines, place) - 4.0
