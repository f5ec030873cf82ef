"""The leg that fits a motor, as the page weighs and draws it."""

import numpy as np

from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.shapes import Arc, Path
from pareto_monoped.leg.base import base_parts
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.shank import shank_parts
from pareto_monoped.leg.thigh import thigh_parts
from pareto_monoped.report.columns import column
from pareto_monoped.report.records import LegTable

_LENGTHS_M = np.linspace(0.15, 0.55, 81)  # of the link mass chart: the bounds of both links, and some more


def leg_table(d: LegDimensions) -> LegTable:
    """Masses of the links by their length, and the dimensions of the page's drawing."""
    top = _upper_end(d)
    return LegTable(
        length_m=column(_LENGTHS_M),
        thigh_kg=column(sum(part.mass_kg() for part in thigh_parts(_LENGTHS_M, d))),
        shank_kg=column(sum(part.mass_kg() for part in shank_parts(_LENGTHS_M, d))),
        housing_radius_m=1e-3 * d.housing_radius_mm,
        output_radius_m=1e-3 * d.coupler_radius_mm,
        base_top_m=1e-3 * float(top.y_mm),
        base_top_radius_m=1e-3 * float(top.radius_mm),
        thigh_half_width_m=1e-3 * d.thigh_half_width_mm,
        thigh_hip_radius_m=1e-3 * d.rim_radius_mm,
        thigh_knee_radius_m=1e-3 * d.knee_radius_mm,
        shank_knee_radius_m=1e-3 * d.shank_top_radius_mm,
        shank_foot_radius_m=1e-3 * d.shank_bottom_radius_mm,
    )


def _upper_end(d: LegDimensions) -> Arc:
    """The arc at the top of both cheeks, which does not depend on the knee actuator's length."""
    cheek = next(part for part in base_parts(0.1, d) if part.role is Role.PLATE)
    outline = cheek.prisms[0].outline
    assert isinstance(outline, Path)
    return max((piece for piece in outline.pieces if isinstance(piece, Arc)), key=lambda arc: float(arc.y_mm))
