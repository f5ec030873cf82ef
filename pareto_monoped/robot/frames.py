"""Bodies, joints and the frames that parts and bodies are described in."""

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.geometry.parts import MassProperties, Part, total
from pareto_monoped.geometry.shapes import Numbers

Floats = NDArray[np.float64]

BODIES = ("base", "thigh", "shank")
JOINTS = ("hip", "knee")

PART_TO_BODY: Floats = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""Part frames have the joint axis along z and y up along the link; body frames have it along y and z up."""
PART_TO_BODY.flags.writeable = False
UPRIGHT = np.eye(3)
OVER = np.diag([1.0, -1.0, -1.0])
"""Half a turn about x: the knee actuator looks at the thigh from outside."""


def upright(parts: tuple[Part, ...]) -> MassProperties:
    """Parts that stand in a body's part frame, in the body frame."""
    return in_body(total(part.mass_properties() for part in parts), UPRIGHT, 0.0)


def in_body(properties: MassProperties, turn: Floats, z_mm: Numbers) -> MassProperties:
    """From a unit's frame to the body frame."""
    move = PART_TO_BODY @ np.array([0.0, 0.0, 1e-3 * float(z_mm)])
    return properties.placed(PART_TO_BODY @ turn, move)
