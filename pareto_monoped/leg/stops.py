"""The end stops of hip and knee: at which angles they meet, and how hard they push back.

A stop is a bumper on one link and a flat striker on the other. The bumper is a round bar of elastomer that lies on a
flat seat, parallel to the joint's axis, and is squeezed sideways. Everything that needs a stop reads it here: the parts
of the links, the sweep of every export, the joint limits of both robot models, and the simulation.
"""

from dataclasses import dataclass

import numpy as np

from pareto_monoped.geometry.shapes import Numbers
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.materials import MATERIALS, Elastomer

# Our own layout of the hip's stops.
_HIP_END = np.radians(100.0)  # to both sides of hanging straight down
_HIP_LEVER_TO_ROD = 25.0  # mm: the thigh's striker passes 2 mm from the seat's boss around the rod

MOST_COMPRESSION = 0.5
"""Of a bumper's diameter. Lindley's law was measured up to about this; the metal is clear of itself up to here.

A limit of the design, which ``stop_safety`` holds (``strength.stops``).
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bumper:
    """A solid round bar of elastomer between two flat faces.

    Attributes:
        diameter_mm, length_mm: of the bar.
        elastomer: its material.
    """

    diameter_mm: float
    length_mm: float
    elastomer: Elastomer

    def force_n(self, compression_mm: Numbers) -> Numbers:
        """Force of a slow compression.

        With c the compression over the diameter d, a bar of length l takes E d l (1.25 c^1.5 + 50 c^6): P. B. Lindley,
        "Compression characteristics of laterally-unrestrained rubber O-rings", J. Inst. Rubber Ind. 1 (1967), for a
        straight bar.
        """
        share = np.maximum(compression_mm, 0.0) / self.diameter_mm
        area = self.diameter_mm * self.length_mm
        return self.elastomer.youngs_modulus_mpa * area * (1.25 * share**1.5 + 50.0 * share**6)


@dataclass(frozen=True, slots=True, kw_only=True)
class JointStop:
    """The end stops of one joint, equal at both ends of its range.

    Attributes:
        lower_rad, upper_rad: angles at which a striker meets a bumper: the joint's range.
        lever_mm: distance of the joint's axis from the line along which a striker squeezes a bumper.
        half_face_mm: half length of the faces of seats and strikers along the bumper's squeezed width.
        bumper: of either end.
    """

    lower_rad: float
    upper_rad: float
    lever_mm: float
    half_face_mm: float
    bumper: Bumper

    @property
    def travel_rad(self) -> float:
        """Angle beyond either end of the range at which a bumper is fully compressed."""
        return MOST_COMPRESSION * self.bumper.diameter_mm / self.lever_mm

    def torque_n_m(self, beyond_rad: Numbers) -> Numbers:
        """Torque with which a stop pushes back slowly at an angle beyond its end of the range."""
        return 1e-3 * self.lever_mm * self.bumper.force_n(self.lever_mm * beyond_rad)


# The knee meets its stop with all the speed of the jump. Travel is what counts there: to stop the same energy over a
# larger angle takes less torque, and the rotor's share of that torque goes through chain and gears. A bar of 28 mm at
# 51 mm takes 23 J slowly where one of 20 mm at 60 mm takes 11 J, and the chain's pull falls by 30 percent. A larger
# bar, or a shorter lever, leaves no room between the bumper and the round end of the thigh's plates.
_KNEE_BUMPER = Bumper(diameter_mm=28.0, length_mm=28.0, elastomer=MATERIALS.fluoroelastomer)
_KNEE_LEVER, _KNEE_HALF_FACE = 51.0, 13.0
# The hip meets its stop at landing or when somebody swings the leg.
_HIP_BUMPER = Bumper(diameter_mm=20.0, length_mm=28.0, elastomer=MATERIALS.fluoroelastomer)
_HIP_HALF_FACE = 9.0


def hip_stop(d: LegDimensions) -> JointStop:
    """The stops of the hip: 100 degrees to both sides of hanging straight down.

    The bumpers hang on the base's rods, so that the lever grows with the motor.
    """
    x, y = d.lower_rod_mm
    rod_along_thigh_mm = float(x * np.sin(_HIP_END) - y * np.cos(_HIP_END))  # with the thigh at the end of its range
    return JointStop(
        lower_rad=-_HIP_END,
        upper_rad=_HIP_END,
        lever_mm=rod_along_thigh_mm + _HIP_LEVER_TO_ROD,
        half_face_mm=_HIP_HALF_FACE,
        bumper=_HIP_BUMPER,
    )


def knee_stop(d: LegDimensions) -> JointStop:
    """The stops of the knee: 15 degrees before the straight leg, and at 133 degrees of flexion."""
    return JointStop(
        lower_rad=np.radians(15.0),
        upper_rad=np.radians(133.0),
        lever_mm=_KNEE_LEVER,
        half_face_mm=_KNEE_HALF_FACE,
        bumper=_KNEE_BUMPER,
    )
