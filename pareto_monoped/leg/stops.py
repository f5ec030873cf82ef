"""The end stops of hip and knee: at which angles they meet, how hard they push back, and where their faces lie.

A stop is a bumper on one link and a flat striker on the other. The bumper is a round bar of elastomer that lies on a
flat seat, parallel to the joint's axis, and is squeezed sideways. Everything that needs a stop reads it here: the parts
of the links, the sweep of every export, the joint limits of both robot models, and the simulation.

At the end of a joint's range the seat's face and the striker's are parallel, a bumper's diameter apart, and the line on
which the bumper is squeezed passes the joint's axis at the lever of ``JointStop``. One face of each pair is laid out
here; the other follows from it by the angle at which they meet.
"""

from dataclasses import dataclass, replace

import numpy as np

from pareto_monoped.geometry.shapes import Numbers, Path, polygon
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
    """A solid round bar of elastomer between two flat faces."""

    diameter_mm: float
    length_mm: float
    elastomer: Elastomer  #: its material

    def force_n(self, compression_mm: Numbers) -> Numbers:
        """Return the force of a slow compression.

        With c the compression over the diameter d, a bar of length l takes E d l (1.25 c^1.5 + 50 c^6): P. B. Lindley,
        "Compression characteristics of laterally-unrestrained rubber O-rings", J. Inst. Rubber Ind. 1 (1967), for a
        straight bar.
        """
        share = np.maximum(compression_mm, 0.0) / self.diameter_mm
        return self.scale_n * (1.25 * share**1.5 + 50.0 * share**6)

    @property
    def scale_n(self) -> float:
        """E d l of ``force_n``."""
        return self.elastomer.youngs_modulus_mpa * (self.diameter_mm * self.length_mm)


@dataclass(frozen=True, slots=True, kw_only=True)
class JointStop:
    """The end stops of one joint, equal at both ends of its range."""

    lower_rad: float  #: the joint's range: angle at which a striker meets a bumper
    upper_rad: float
    lever_mm: float  #: distance of the joint's axis from the line along which a striker squeezes a bumper
    half_face_mm: float  #: half length of the faces of seats and strikers along the bumper's squeezed width
    bumper: Bumper  #: of either end

    @property
    def travel_rad(self) -> float:
        """Angle beyond either end of the range at which a bumper is fully compressed."""
        return MOST_COMPRESSION * self.bumper.diameter_mm / self.lever_mm

    def torque_n_m(self, beyond_rad: Numbers) -> Numbers:
        """Return the torque with which a stop pushes back slowly at an angle beyond its end of the range."""
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
    """Return the stops of the hip: 100 degrees to both sides; their lever grows with the motor, as the rods do."""
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
    """Return the stops of the knee: 15 degrees before the straight leg, and at 133 degrees of flexion."""
    return JointStop(
        lower_rad=np.radians(15.0),
        upper_rad=np.radians(133.0),
        lever_mm=_KNEE_LEVER,
        half_face_mm=_KNEE_HALF_FACE,
        bumper=_KNEE_BUMPER,
    )


# Our own layout.
FACE_OUT = 45.5  # of a stop on the thigh's edge, mm from its axis: 1.4 mm and a foot of 10 mm outside the chain
_FLEXION_TILT = np.radians(-3.0)  # of the knee's seat for flexion: brings the striker between the shank's plates
_FLEXION_OUT = 46.5  # of that seat's middle from the thigh's axis, mm
# In front of the shank's axis, so that the folded leg's chain passes; the face lies in a plane through the knee's axis.
_EXTENSION_STRIKER = np.radians(57.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Face:
    """A flat face parallel to the joints' axes, seen along them."""

    x_mm: Numbers  #: the point of the face that meets the middle of a bumper
    y_mm: Numbers
    normal_rad: float  #: angle of the direction in which the face looks

    def point(self, along_mm: float, deep_mm: float) -> tuple[Numbers, Numbers]:
        """Return a point so far along the face, to the left of its normal, and so deep behind it."""
        cos, sin = float(np.cos(self.normal_rad)), float(np.sin(self.normal_rad))
        return self.x_mm - along_mm * sin - deep_mm * cos, self.y_mm + along_mm * cos - deep_mm * sin

    def polygon(self, *points: tuple[float, float]) -> Path:
        """Return the polygon through points given as (along, deep), anticlockwise."""
        return polygon([self.point(*point) for point in points])

    def opposite(self, gap_mm: float) -> "Face":
        """Return the parallel face that looks at this one over a gap."""
        x, y = self.point(0.0, -gap_mm)
        return Face(x_mm=x, y_mm=y, normal_rad=self.normal_rad + np.pi)

    def turned(self, angle_rad: float) -> "Face":
        """Return the face turned anticlockwise about the origin."""
        cos, sin = np.cos(angle_rad), np.sin(angle_rad)
        return Face(
            x_mm=float(cos * self.x_mm - sin * self.y_mm),
            y_mm=float(sin * self.x_mm + cos * self.y_mm),
            normal_rad=self.normal_rad + angle_rad,
        )

    def at(self, y_mm: Numbers) -> "Face":
        """Return the face moved so that the origin comes to (0, y_mm)."""
        return replace(self, y_mm=self.y_mm + y_mm)

    @property
    def centred(self) -> "Face":
        """The face with its middle in the origin."""
        return replace(self, x_mm=0.0, y_mm=0.0)


def bumper_place(seat: Face, stop: JointStop) -> tuple[Numbers, Numbers, float]:
    """Return where the axis of the bumper on a seat lies."""
    return (*seat.point(0.0, -0.5 * stop.bumper.diameter_mm), 0.0)


def hip_strikers(d: LegDimensions) -> tuple[Face, Face]:
    """Return the thigh's faces for the lower and the upper end of the hip's range, in the thigh's frame."""
    lever = hip_stop(d).lever_mm
    return (Face(x_mm=FACE_OUT, y_mm=-lever, normal_rad=0.0), Face(x_mm=-FACE_OUT, y_mm=-lever, normal_rad=np.pi))


def hip_seats(d: LegDimensions) -> tuple[Face, Face]:
    """Return the base's faces for both ends of the hip's range; it turns the thigh clockwise, seen along -z."""
    stop = hip_stop(d)
    lower, upper = (striker.opposite(stop.bumper.diameter_mm) for striker in hip_strikers(d))
    return lower.turned(-stop.lower_rad), upper.turned(-stop.upper_rad)


def knee_seats(d: LegDimensions) -> tuple[Face, Face]:
    """Return the thigh's faces for the lower and the upper end of the knee's range, about the knee axis.

    The upper end is flexion: its seat lies on the thigh's rear edge above the knee. That of the lower end, extension,
    lies on a heel of the thigh below the knee.
    """
    stop = knee_stop(d)
    gap = stop.bumper.diameter_mm
    # The striker's face for extension, in a plane through the axis, when the shank is at the lower end of its range.
    angle = -0.5 * np.pi + _EXTENSION_STRIKER - stop.lower_rad
    striker = Face(
        x_mm=float(stop.lever_mm * np.cos(angle)),
        y_mm=float(stop.lever_mm * np.sin(angle)),
        normal_rad=angle + 0.5 * np.pi,
    )
    normal = np.pi + _FLEXION_TILT
    # With the seat's plane at a height h over the axis, its middle is h n - lever t for tangent t to the left of n.
    height = (_FLEXION_OUT - stop.lever_mm * np.sin(_FLEXION_TILT)) / np.cos(_FLEXION_TILT)
    flexion = Face(
        x_mm=float(height * np.cos(normal) + stop.lever_mm * np.sin(normal)),
        y_mm=float(height * np.sin(normal) - stop.lever_mm * np.cos(normal)),
        normal_rad=float(normal),
    )
    return striker.opposite(gap), flexion


def knee_strikers(d: LegDimensions) -> tuple[Face, Face]:
    """Return the shank's faces for the lower and the upper end of the knee's range, in the shank's frame."""
    stop = knee_stop(d)
    lower, upper = (seat.opposite(stop.bumper.diameter_mm) for seat in knee_seats(d))
    return lower.turned(stop.lower_rad), upper.turned(stop.upper_rad)
