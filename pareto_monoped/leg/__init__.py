"""The leg as lists of parts: links with a chain drive to the knee, the foot, and the base that carries the actuators.

What a link weighs follows from its parts and changes smoothly with its length. Lengths are metres, floats or arrays of
shape (n,). Every part is described in the frame of its body: origin on the body's proximal joint axis (the hip for base
and thigh, the knee for the shank), x forward, y up along the link, z along the joint axis, to the robot's right, with
z = 0 in the middle plane of the leg. ``dimensions`` shows the lateral layout.

Order of imports, lowest first: actuator_fit, sandwich; dimensions; chain, electronics, journal, sprocket,
stops; hip, knee, stop_parts; base, shank, thigh_outline; stand, thigh.
"""

__all__ = [
    "actuator_fit",
    "base",
    "chain",
    "dimensions",
    "electronics",
    "journal",
    "shank",
    "stand",
    "stops",
    "thigh",
    "thigh_outline",
]
