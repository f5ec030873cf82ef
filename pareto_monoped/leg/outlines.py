"""Outlines of the links: plates with a waist, and windows with round corners."""

import numpy as np

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
