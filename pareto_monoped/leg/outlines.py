"""Outlines that only the leg needs: plates with a waist, windows, sprockets."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.geometry.shapes import Arc, Line, Numbers, Path


def waisted(
    *,
    top_radius_mm: Numbers,
    bottom_radius_mm: Numbers,
    half_width_mm: Numbers,
    length_mm: Numbers,
    fillet_mm: float = 20.0,
) -> Path:
    """Two discs joined by a narrower straight bar with fillets: the outline of a link plate.

    The top disc is centred at the origin, the bottom one ``length_mm`` below; both radii must exceed
    ``half_width_mm``. Each fillet touches the bar at its side and the disc from outside.
    """

    def corner(radius: Numbers) -> tuple[Numbers, Numbers]:
        """Distance of the fillet's centre from the disc's along the bar, and its angle from the horizontal."""
        drop = np.sqrt((radius + fillet_mm) ** 2 - (half_width_mm + fillet_mm) ** 2)
        return drop, np.arctan2(drop, half_width_mm + fillet_mm)

    top, top_angle = corner(top_radius_mm)
    low, low_angle = corner(bottom_radius_mm)
    w, side, pi = half_width_mm, half_width_mm + fillet_mm, np.pi
    return Path(
        (
            Line(w, low - length_mm, w, -top),
            Arc(side, -top, fillet_mm, pi, pi - top_angle),
            Arc(0.0, 0.0, top_radius_mm, -top_angle, pi / 2),
            Arc(0.0, 0.0, top_radius_mm, pi / 2, pi + top_angle),
            Arc(-side, -top, fillet_mm, top_angle, 0.0),
            Line(-w, -top, -w, low - length_mm),
            Arc(-side, low - length_mm, fillet_mm, 0.0, -low_angle),
            Arc(0.0, -length_mm, bottom_radius_mm, pi - low_angle, 3 * pi / 2),
            Arc(0.0, -length_mm, bottom_radius_mm, 3 * pi / 2, 2 * pi + low_angle),
            Arc(side, low - length_mm, fillet_mm, pi + low_angle, pi),
        )
    )


def rounded(*, half_width_mm: Numbers, high_mm: Numbers, low_mm: Numbers, corner_mm: Numbers) -> Path:
    """A rectangle with round corners, upright on the y axis from ``low_mm`` to ``high_mm``."""
    w, r, pi = half_width_mm, corner_mm, np.pi
    return Path(
        (
            Line(w, low_mm + r, w, high_mm - r),
            Arc(w - r, high_mm - r, r, 0.0, pi / 2),
            Line(w - r, high_mm, r - w, high_mm),
            Arc(r - w, high_mm - r, r, pi / 2, pi),
            Line(-w, high_mm - r, -w, low_mm + r),
            Arc(r - w, low_mm + r, r, pi, 3 * pi / 2),
            Line(r - w, low_mm, w - r, low_mm),
            Arc(w - r, low_mm + r, r, 3 * pi / 2, 2 * pi),
        )
    )


@lru_cache(maxsize=8)
def sprocket(*, teeth: int, pitch_mm: float, roller_mm: float) -> Path:
    """A chain sprocket around the origin, with the middle of a tooth gap on the +x axis.

    Seats and tip after ISO 606: pitch diameter p / sin(180 deg / z), least seat radius 0.505 d1, tip diameter half way
    between its limits d + p (1 - 1.6 / z) - d1 and d + 1.25 p - d1. The seat spans 140 degrees, the greatest of ISO 606
    being 140 - 90 / z and the least 120 - 90 / z; the curved flanks are replaced by their tangents.
    """
    pitch_radius = sprocket_pitch_radius_mm(teeth=teeth, pitch_mm=pitch_mm)
    seat = 0.505 * roller_mm
    tip = pitch_radius + 0.25 * (pitch_mm * (1.0 - 1.6 / teeth) + 1.25 * pitch_mm) - 0.5 * roller_mm
    half_seat = np.radians(0.5 * (140.0 - 90.0 / teeth))
    # One gap, with u outward along its middle and v across: the seat ends at (u, v), its tangent runs on to the tip.
    end = np.array([pitch_radius - seat * np.cos(half_seat), seat * np.sin(half_seat)])
    along = np.array([np.sin(half_seat), np.cos(half_seat)])
    reach = -end @ along + np.sqrt((end @ along) ** 2 + tip**2 - end @ end)
    rim = end + reach * along
    rim_angle = float(np.arctan2(rim[1], rim[0]))
    pieces: list[Line | Arc] = []
    for tooth in range(teeth):
        angle = 2.0 * np.pi * tooth / teeth
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])

        def line(start: NDArray[np.float64], stop: NDArray[np.float64], turn: NDArray[np.float64] = turn) -> Line:
            a, b = turn @ start, turn @ stop
            return Line(float(a[0]), float(a[1]), float(b[0]), float(b[1]))

        x, y = turn @ np.array([pitch_radius, 0.0])
        mirror = np.array([1.0, -1.0])
        pieces += [
            line(rim * mirror, end * mirror),
            # The seat turns clockwise, its material lies outside: from the lower flank through the bottom to the upper.
            Arc(float(x), float(y), seat, angle + np.pi + half_seat, angle + np.pi - half_seat),
            line(end, rim),
            Arc(0.0, 0.0, tip, angle + rim_angle, angle + 2.0 * np.pi / teeth - rim_angle),
        ]
    return Path(tuple(pieces))


def sprocket_pitch_radius_mm(*, teeth: int, pitch_mm: float) -> float:
    """Radius on which the chain's pins run (ISO 606)."""
    return float(0.5 * pitch_mm / np.sin(np.pi / teeth))
