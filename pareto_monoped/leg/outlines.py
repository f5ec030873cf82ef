"""Outlines of the links: windows with round corners."""

import numpy as np

from pareto_monoped.geometry.shapes import Arc, Line, Numbers, Path


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
