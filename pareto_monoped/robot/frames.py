"""Bodies, joints and the frames that parts and bodies are described in."""

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.geometry.parts import MassProperties

Floats = NDArray[np.float64]

BODIES = ("base", "thigh", "shank")
JOINTS = ("hip", "knee")

PART_TO_BODY: Floats = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""From part frames (z along the joint axis, y up along the link) to body frames (y along the joint axis, z up)."""
UPRIGHT: Floats = np.eye(3)
"""Turn of a unit that stands in its body's part frame as it is drawn."""
OVER: Floats = np.diag([1.0, -1.0, -1.0])
"""Half a turn about x: the output of the knee actuator points to -z, at the thigh."""
for _matrix in (PART_TO_BODY, UPRIGHT, OVER):
    _matrix.flags.writeable = False


def in_body(properties: MassProperties, turn: Floats, z_mm: float) -> MassProperties:
    """Mass properties from a unit's frame to the body frame.

    Args:
        properties: of the unit, about the origin of its frame.
        turn: rotation from the unit's frame to the body's part frame, shape (3, 3).
        z_mm: where the unit's origin lies on the z axis of the body's part frame.
    """
    move = PART_TO_BODY @ np.array([0.0, 0.0, 1e-3 * z_mm])
    return properties.placed(PART_TO_BODY @ turn, move)
