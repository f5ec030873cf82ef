"""What a maker does to a part beside its prisms: holes with their threads and mouths, chamfers, countersunk heads.

The cylinders of holes and shafts stand in the prisms of the part. A feature says what they are and adds their cones,
with exact integrals. Heights are along z in the part's frame, in millimetres; every number may be an array of shape
(n,).
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

import numpy as np

from pareto_monoped.geometry.shapes import Circle, Moments, Numbers, Pattern


@dataclass(frozen=True, slots=True, kw_only=True)
class Bevel:
    """A ring of triangular section between a cylinder and a cone on one axis along z.

    The cone meets the cylinder at ``end_mm`` and has the radius ``edge_mm`` in the face. On a hole, the wider cone
    takes the ring away: a countersink or chamfer. On a shaft, a narrower cone takes the ring away: a chamfer. A wider
    one adds it: a countersunk head. With ``edge_mm`` equal to the cylinder's radius there is no ring.
    """

    at: Circle | Pattern  #: the cylinder, or the pattern of them; its radius is that of the hole or shaft
    edge_mm: Numbers  #: radius of the cone in the face
    face_mm: Numbers  #: height z of the face
    end_mm: Numbers  #: height z at which the cone meets the cylinder, on either side of the face
    hole: bool  #: whether the cylinder is a hole, with material outside, or a shaft, with material inside

    def integrals(self) -> tuple[Numbers, ...]:
        """Return what the ring adds to the integrals of ``Prism``, in the same order; negative where it takes away.

        With R the radius that goes linearly from a in the face to b at the end, the disc between has the area pi R^2
        and the second moment pi R^4 / 4 about either diameter. Its integrals along z are polynomials in a and b:

            int R^2 = (a^2 + ab + b^2) / 3            int t R^2   = (a^2 + 2ab + 3b^2) / 12
            int R^4 = (a^4 + a^3 b + ... + b^4) / 5    int t^2 R^2 = (a^2 + 3ab + 6b^2) / 30

        for t from 0 to 1. The cylinder's, with R = b, are subtracted.
        """
        a, b = np.asarray(self.edge_mm, dtype=np.float64), np.asarray(self.at.radius_mm, dtype=np.float64)
        face, along = np.asarray(self.face_mm, dtype=np.float64), np.asarray(self.end_mm - self.face_mm)
        # Each difference to the cylinder is written with the factor a - b, so that thin rings lose no digits.
        size = (-1.0 if self.hole else 1.0) * np.pi * np.abs(along) * (a - b)
        ring = size * (a + 2.0 * b) / 3.0
        ring_t = size * (a + 3.0 * b) / 12.0
        ring_tt = size * (a + 4.0 * b) / 30.0
        across = 0.25 * size * (a**3 + 2.0 * a**2 * b + 3.0 * a * b**2 + 4.0 * b**3) / 5.0
        height = face * ring + along * ring_t
        return _spread(self.at, ring, across, height, face**2 * ring + 2.0 * face * along * ring_t + along**2 * ring_tt)

    def volume_mm3(self) -> Numbers:
        """Return the first of ``integrals``, for searches that weigh thousands of parts."""
        a, b = np.asarray(self.edge_mm, dtype=np.float64), np.asarray(self.at.radius_mm, dtype=np.float64)
        size = (-1.0 if self.hole else 1.0) * np.pi * np.abs(self.end_mm - self.face_mm) * (a - b)
        count = self.at.count if isinstance(self.at, Pattern) else 1.0
        return count * (size * (a + 2.0 * b) / 3.0)

    def centres_mm(self) -> list[tuple[float, float]]:
        """Return where the axes are, for a bevel of plain numbers."""
        if isinstance(self.at, Pattern):
            return self.at.centres_mm()
        return [(float(self.at.x_mm), float(self.at.y_mm))]


def _spread(
    at: Circle | Pattern, volume: Numbers, across: Numbers, height: Numbers, heights: Numbers
) -> tuple[Numbers, ...]:
    """Return the integrals over a ring on each axis, from those of 1, xx (which equals yy), z and zz about its own."""
    flat = Moments(volume, 0.0, 0.0, across, across, 0.0)
    if isinstance(at, Pattern):
        # As in ``Pattern.moments``, the two second moments are taken as equal.
        spread = across + 0.5 * volume * np.square(at.pitch_radius_mm)
        flat = Moments(volume, 0.0, 0.0, spread, spread, 0.0).scaled(at.count)
        height, heights = height * at.count, heights * at.count
    flat = flat.moved(at.x_mm, at.y_mm)
    return (flat.area, flat.x, flat.y, height, flat.xx, flat.yy, heights, flat.xy, height * at.x_mm, height * at.y_mm)


COARSE_PITCHES_MM = {2.0: 0.4, 2.5: 0.45, 3.0: 0.5, 4.0: 0.7, 5.0: 0.8, 6.0: 1.0, 8.0: 1.25}
"""Pitch of the metric coarse thread by its diameter (ISO 261)."""
_TAP_RUN_OUTS_MM = {0.4: 1.5, 0.45: 1.6, 0.5: 1.8, 0.7: 2.4, 0.8: 2.7, 1.0: 3.2, 1.25: 3.9}
"""What a blind hole is deeper than its thread, by the pitch (DIN 76-1, short run-outs e2)."""
CHAMFER_MM = 0.3
"""Width of the chamfers at 45 degrees that lead one part into another: no more than the least corner radius of small
bearings' rings (ISO 582: 0.3 mm); our own choice."""
CENTRE_MM = (0.5, 1.06, 2.2)
"""Radius, radius in the face, and depth of a centre hole for shafts of 6 to 10 mm (DIN 332-1, A 1 x 2.12)."""
POINT_SHARE = 0.3
"""Height of a drill's point over its diameter (118 degrees)."""
LEAD_IN_MM = (0.2, 0.6)
"""Width and depth of lead-ins for press fits: 18 degrees, where 5 to 20 are usual; our own choice."""


class Cone(StrEnum):
    """What a cone is for."""

    COUNTERSINK = "countersink"  # 90 degrees, takes a countersunk head
    CHAMFER = "chamfer"  # breaks an edge, or leads a tap into its hole
    LEAD_IN = "lead-in"  # long and slender, for pressing something in or on
    CENTRE = "centre"  # 60 degrees, takes the point between which a shaft is ground


def tap_run_out_mm(pitch_mm: float) -> float:
    """Return how much deeper than its thread a blind hole is drilled; by the next pitch above if it is not listed."""
    return next((value for pitch, value in _TAP_RUN_OUTS_MM.items() if pitch >= pitch_mm - 1e-9), 4.0 * pitch_mm)


@dataclass(frozen=True, slots=True, kw_only=True)
class Thread:
    """A metric thread in a hole."""

    diameter_mm: float  #: nominal (ISO 261)
    pitch_mm: float
    tolerance: str = "6H"  #: class after ISO 965-1
    left_hand: bool = False  #: whether it is left-handed

    @property
    def text(self) -> str:
        """As on drawings, such as ``M3x0.5 - 6H`` (ISO 965-1)."""
        return f"M{self.diameter_mm:g}x{self.pitch_mm:g}{' LH' if self.left_hand else ''} - {self.tolerance}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Mouth:
    """The cone at one end of a hole."""

    radius_mm: Numbers  #: in the face
    depth_mm: Numbers  #: from the face to where the cone meets the hole
    kind: Cone = Cone.CHAMFER  #: what it is for

    @classmethod
    def of_centre(cls, radius_mm: Numbers, hole_mm: Numbers) -> "Mouth":
        """Return a cone of 60 degrees around a hole of radius ``hole_mm``, for the point of a lathe or grinder."""
        return cls(radius_mm=radius_mm, depth_mm=np.sqrt(3.0) * (radius_mm - hole_mm), kind=Cone.CENTRE)

    @classmethod
    def at_90_degrees(cls, radius_mm: Numbers, hole_mm: Numbers, kind: Cone = Cone.CHAMFER) -> "Mouth":
        """Return a cone of 90 degrees: as deep as it is wider than the hole of radius ``hole_mm``."""
        return cls(radius_mm=radius_mm, depth_mm=radius_mm - hole_mm, kind=kind)


@dataclass(frozen=True, slots=True, kw_only=True)
class Hole:
    """Round holes of one kind. The same shapes are holes of the part's prisms from ``low_mm`` to ``high_mm``."""

    #: Where they are, all of one radius: that of the bore, clearance hole or tapping drill
    shapes: tuple[Circle | Pattern, ...]
    low_mm: Numbers  #: height of their lower ends
    high_mm: Numbers  #: height of their upper ends
    low: Mouth | None = None  #: cone at the lower end; None: a plain edge, or the bottom of the hole
    high: Mouth | None = None  #: at the upper end, likewise
    thread: Thread | None = None  #: what is cut into them
    #: Usable depth of the thread from the end at which the screw enters; None: all of the hole
    thread_mm: Numbers | None = None

    @property
    def bevels(self) -> tuple[Bevel, ...]:
        """The cones at both ends of every hole."""
        return tuple(
            Bevel(at=shape, edge_mm=mouth.radius_mm, face_mm=face, end_mm=face + inwards * mouth.depth_mm, hole=True)
            for shape in self.shapes
            for mouth, face, inwards in ((self.low, self.low_mm, 1.0), (self.high, self.high_mm, -1.0))
            if mouth is not None
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class ShaftEnd:
    """A cone at the end of a cylinder around the part's z axis, or around other axes."""

    at: Circle | Pattern  #: the cylinder, or the pattern of them
    face_mm: Numbers  #: height of its end face
    inwards: float  #: 1 if its material lies above the face, -1 if below
    width_mm: Numbers  #: of the cone across the axis
    depth_mm: Numbers  #: of the cone along the axis
    kind: Cone = Cone.CHAMFER  #: what it is for

    @property
    def bevels(self) -> tuple[Bevel, ...]:
        """The cone."""
        return (
            Bevel(
                at=self.at,
                edge_mm=self.at.radius_mm - self.width_mm,
                face_mm=self.face_mm,
                end_mm=self.face_mm + self.inwards * self.depth_mm,
                hole=False,
            ),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class CountersunkHead:
    """The head of a countersunk screw or nut of 90 degrees around the part's z axis, flush with a face."""

    shank_mm: Numbers  #: radius of the cylinder that the head stands on, the prism that begins in the face
    radius_mm: Numbers  #: in the face
    face_mm: Numbers  #: height of the face
    inwards: float  #: 1 if the shank lies above the face, -1 if below

    @property
    def bevels(self) -> tuple[Bevel, ...]:
        """The cone around the shank."""
        return (
            Bevel(
                at=Circle(radius_mm=self.shank_mm),
                edge_mm=self.radius_mm,
                face_mm=self.face_mm,
                end_mm=self.face_mm + self.inwards * (self.radius_mm - self.shank_mm),
                hole=False,
            ),
        )


Feature = Hole | ShaftEnd | CountersunkHead


def bored(
    shape: Circle | Pattern,
    low_mm: Numbers,
    high_mm: Numbers,
    *,
    enters: Literal["low", "high", "both"],
    pressed: bool = False,
) -> Hole:
    """Return the bores that take a part, with a chamfer where it enters, or a lead-in if it is pressed in."""
    width, depth = LEAD_IN_MM if pressed else (CHAMFER_MM, CHAMFER_MM)
    mouth = Mouth(radius_mm=shape.radius_mm + width, depth_mm=depth, kind=Cone.LEAD_IN if pressed else Cone.CHAMFER)
    return Hole(
        shapes=(shape,),
        low_mm=low_mm,
        high_mm=high_mm,
        low=mouth if enters != "high" else None,
        high=mouth if enters != "low" else None,
    )


def turned(radius_mm: Numbers, face_mm: Numbers, inwards: float, *, pressed: bool = False) -> ShaftEnd:
    """Return a turned part's end with a chamfer or, if pressed, a lead-in; ``inwards`` is 1 above the face."""
    width, depth = LEAD_IN_MM if pressed else (CHAMFER_MM, CHAMFER_MM)
    return ShaftEnd(
        at=Circle(radius_mm=radius_mm),
        face_mm=face_mm,
        inwards=inwards,
        width_mm=width,
        depth_mm=depth,
        kind=Cone.LEAD_IN if pressed else Cone.CHAMFER,
    )
