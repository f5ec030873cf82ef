"""The leg as lists of parts: what a link weighs follows from its real dimensions and changes smoothly with its length.

Lengths are metres, floats or arrays of shape (n,). Every part stands in the frame of its body: origin on the body's
proximal joint axis (the hip for base and thigh, the knee for the shank), x forward, y up along the link, z along the
joint axis with z = 0 in the middle plane of the leg; see ``dimensions`` for the lateral layout.
"""

from pareto_monoped.leg.base import base_parts, journal_parts
from pareto_monoped.leg.shank import foot_part, shank_parts
from pareto_monoped.leg.thigh import thigh_parts

__all__ = ["base_parts", "foot_part", "journal_parts", "shank_parts", "thigh_parts"]
