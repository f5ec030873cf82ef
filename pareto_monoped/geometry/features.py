"""What a maker does to a part beside its prisms: holes with their threads and mouths, chamfers, countersunk heads.

The cylinders of holes and shafts stand in the prisms of the part. A feature says what they are and adds their cones.
All heights are along z in the part's frame, in millimetres; every number may be an array of shape (n,).
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

from pareto_monoped.geometry.bevels import Bevel
from pareto_monoped.geometry.shapes import Circle, Numbers, Pattern

COARSE_PITCHES_MM = {2.0: 0.4, 2.5: 0.45, 3.0: 0.5, 4.0: 0.7, 5.0: 0.8, 6.0: 1.0, 8.0: 1.25}
"""Pitch of the metric coarse thread by its diameter (ISO 261)."""


CHAMFER_MM = 0.3
"""Width of the chamfers at 45 degrees that lead one part into another: no more than the least corner radius of small
bearings' rings (ISO 582: 0.3 mm); our own choice."""
LEAD_IN_MM = (0.2, 0.6)
"""Width and depth of lead-ins for press fits: 18 degrees, where 5 to 20 are usual; our own choice."""


class Cone(StrEnum):
    """What a cone is for."""

    COUNTERSINK = "countersink"  # 90 degrees, takes a countersunk head
    CHAMFER = "chamfer"  # breaks an edge, or leads a tap into its hole
    LEAD_IN = "lead-in"  # long and slender, for pressing something in or on


@dataclass(frozen=True, slots=True, kw_only=True)
class Thread:
    """A metric thread in a hole.

    Attributes:
        diameter_mm, pitch_mm: nominal (ISO 261).
        tolerance: class after ISO 965-1.
        left_hand: whether it is left-handed.
    """

    diameter_mm: float
    pitch_mm: float
    tolerance: str = "6H"
    left_hand: bool = False

    @property
    def text(self) -> str:
        """As on drawings, such as ``M3x0.5 - 6H`` (ISO 965-1)."""
        return f"M{self.diameter_mm:g}x{self.pitch_mm:g}{' LH' if self.left_hand else ''} - {self.tolerance}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Mouth:
    """The cone at one end of a hole.

    Attributes:
        radius_mm: in the face.
        depth_mm: from the face to where the cone meets the hole.
        kind: what it is for.
    """

    radius_mm: Numbers
    depth_mm: Numbers
    kind: Cone = Cone.CHAMFER

    @classmethod
    def at_90_degrees(cls, radius_mm: Numbers, hole_mm: Numbers, kind: Cone = Cone.CHAMFER) -> "Mouth":
        """A cone of 90 degrees: as deep as it is wider than the hole of radius ``hole_mm``."""
        return cls(radius_mm=radius_mm, depth_mm=radius_mm - hole_mm, kind=kind)


@dataclass(frozen=True, slots=True, kw_only=True)
class Hole:
    """Round holes of one kind. The same shapes are holes of the part's prisms from ``low_mm`` to ``high_mm``.

    Attributes:
        shapes: where they are, all of one radius: that of the bore, clearance hole or tapping drill.
        low_mm, high_mm: heights of their ends.
        low, high: the cones at these ends; None: a plain edge, or the bottom of the hole.
        thread: what is cut into them.
        thread_mm: usable depth of the thread from the end at which the screw enters; None: all of the hole.
    """

    shapes: tuple[Circle | Pattern, ...]
    low_mm: Numbers
    high_mm: Numbers
    low: Mouth | None = None
    high: Mouth | None = None
    thread: Thread | None = None
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
    """A cone at the end of a cylinder around the part's z axis, or around other axes.

    Attributes:
        at: the cylinder, or the pattern of them.
        face_mm: height of its end face.
        inwards: 1 if its material lies above the face, -1 if below.
        width_mm: of the cone across the axis.
        depth_mm: of the cone along the axis.
        kind: what it is for.
    """

    at: Circle | Pattern
    face_mm: Numbers
    inwards: float
    width_mm: Numbers
    depth_mm: Numbers
    kind: Cone = Cone.CHAMFER

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
    """The head of a countersunk screw or nut of 90 degrees around the part's z axis, flush with a face.

    Attributes:
        shank_mm: radius of the cylinder that the head stands on, the prism that begins in the face.
        radius_mm: in the face.
        face_mm: height of the face.
        inwards: 1 if the shank lies above the face, -1 if below.
    """

    shank_mm: Numbers
    radius_mm: Numbers
    face_mm: Numbers
    inwards: float

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
    """Bores that take a bearing, bush or pin, or another part's step, with a cone where it enters.

    Args:
        shape: as it stands in the prisms.
        low_mm: height of its lower end.
        high_mm: height of its upper end.
        enters: the end or ends at which something enters.
        pressed: whether it is pressed in: a lead-in instead of a chamfer.
    """
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
    """The end of a turned part around its axis, with a cone that leads it into a bore.

    Args:
        radius_mm: of the cylinder, the prism that ends in the face.
        face_mm: height of its end face.
        inwards: 1 if its material lies above the face, -1 if below.
        pressed: whether it is pressed in: a lead-in instead of a chamfer.
    """
    width, depth = LEAD_IN_MM if pressed else (CHAMFER_MM, CHAMFER_MM)
    return ShaftEnd(
        at=Circle(radius_mm=radius_mm),
        face_mm=face_mm,
        inwards=inwards,
        width_mm=width,
        depth_mm=depth,
        kind=Cone.LEAD_IN if pressed else Cone.CHAMFER,
    )
