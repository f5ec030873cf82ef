"""Screws of catalogue lengths, as parts: sizes, standards, heads."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from pareto_monoped.errors import DesignError
from pareto_monoped.geometry.features import COARSE_PITCHES_MM, Cone, CountersunkHead, Hole, Mouth, Thread
from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Group, Purchase, Role, Visibility
from pareto_monoped.geometry.shapes import Circle, Numbers, Path, Pattern, Shape, polygon
from pareto_monoped.geometry.tightening import Fastening, thread_size
from pareto_monoped.materials import MATERIALS, Material

Head = Literal["cap", "countersunk", "hexagon"]
LENGTHS_MM = np.array([3, 4, 5, 6, 8, 10, 12, 16, 20, 25, 30, 35, 40, 45, 50, 55, 60], dtype=np.float64)
"""Lengths in which screws are sold (the standards below have the same series)."""
HEXAGON_HEIGHT_MM = {3.0: 2.0, 4.0: 2.8, 5.0: 3.5}
"""Of the head (ISO 4017), by thread."""
HEXAGON_FLATS_MM = {3.0: 5.5, 4.0: 7.0, 5.0: 8.0}
"""Width across flats of screws (ISO 4017) and nuts (ISO 4032), by thread."""
_EARLIER = {"ISO 4762": "DIN 912", "ISO 4017": "DIN 933", "ISO 10642": "DIN 7991"}
"""Standards under which screws of the same sizes are still sold."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Screw:
    """Radii of a metric screw in mm, and the height of its cap head."""

    shank: float  #: nominal
    hole: float  #: clearance hole (ISO 273, fine)
    core: float  #: tapping hole; a screw inside a thread is drawn with this radius, so that it overlaps nothing
    head: float  #: of a cap screw (ISO 4762)
    head_height: float  #: likewise
    countersunk: float  #: of a countersunk head in its face, the cone drawn sharp

    def flush(self, *, seat_mm: Numbers, grip_mm: Numbers, thread_mm: Numbers, direction: float) -> tuple[Prism, ...]:
        """Build a screw on the z axis without its head: through a grip into a thread, in ``direction`` (-1 or 1)."""
        split = seat_mm + direction * grip_mm
        return (cylinder(self.shank, seat_mm, split), cylinder(self.core, split, split + direction * thread_mm))

    @property
    def name(self) -> str:
        """Such as ``M3``."""
        return f"M{2.0 * self.shank:g}"

    def fastening(self, head: Head, property_class: str) -> Fastening:
        """Return how it is tightened and locked."""
        return Fastening(
            thread=thread_size(2.0 * self.shank),
            property_class=property_class,
            head=head,
            head_mm=HEXAGON_FLATS_MM[2.0 * self.shank] if head == "hexagon" else 2.0 * self.head,
            hole_mm=2.0 * self.hole,
        )

    @property
    def thread(self) -> Thread:
        """The thread that it is driven into."""
        diameter = 2.0 * self.shank
        return Thread(diameter_mm=diameter, pitch_mm=COARSE_PITCHES_MM.get(diameter, 2.0 * (self.shank - self.core)))

    def countersink(self, hole_mm: float) -> Mouth:
        """Return the mouth of a hole of radius ``hole_mm`` that takes a countersunk head flush with its face."""
        return Mouth.at_90_degrees(self.countersunk, hole_mm, Cone.COUNTERSINK)

    @property
    def tap_lead(self) -> Mouth:
        """The mouth of a tapped hole: a chamfer to the nominal diameter (DIN 76-1: 1 to 1.05 diameters)."""
        return Mouth.at_90_degrees(self.shank, self.core)


def clearance(
    screw: Screw,
    shapes: tuple[Circle | Pattern, ...],
    low_mm: Numbers,
    high_mm: Numbers,
    *,
    countersunk: Literal["low", "high"] | None = None,
) -> Hole:
    """Return the clearance holes for a screw, if asked for countersunk at one end; the shapes have their radius."""
    sink = None if countersunk is None else screw.countersink(float(shapes[0].radius_mm))
    return Hole(
        shapes=shapes,
        low_mm=low_mm,
        high_mm=high_mm,
        low=sink if countersunk == "low" else None,
        high=sink if countersunk == "high" else None,
    )


def tapped(
    screw: Screw,
    shapes: tuple[Circle | Pattern, ...],
    low_mm: Numbers,
    high_mm: Numbers,
    *,
    enters: Literal["low", "high", "both"],
    usable_mm: Numbers | None = None,
) -> Hole:
    """Return the tapped holes for a screw, chamfered where it enters; ``usable_mm`` is by default the whole depth."""
    return Hole(
        shapes=shapes,
        low_mm=low_mm,
        high_mm=high_mm,
        low=screw.tap_lead if enters in ("low", "both") else None,
        high=screw.tap_lead if enters in ("high", "both") else None,
        thread=screw.thread,
        thread_mm=usable_mm,
    )


def cylinder(radius_mm: float, one_mm: Numbers, other_mm: Numbers) -> Prism:
    """Build a cylinder on the z axis between two heights in either order."""
    return between(Circle(radius_mm=radius_mm), one_mm, other_mm)


def between(outline: Shape, one_mm: Numbers, other_mm: Numbers, *holes: Shape) -> Prism:
    """Build a prism between two heights in either order."""
    low, high = np.minimum(one_mm, other_mm)[()], np.maximum(one_mm, other_mm)[()]
    return Prism(outline=outline, z0_mm=low, z1_mm=high, holes=holes)


def hexagon(flats_mm: float, turn_rad: float = 0.0) -> Path:
    """Return a hexagon around the origin, drawn sharp, two of its flats across the x axis: it faces a circle's axis."""
    corner = flats_mm / np.sqrt(3.0)
    angles = turn_rad + np.pi / 6.0 + np.pi / 3.0 * np.arange(6)
    return polygon([(float(corner * np.cos(angle)), float(corner * np.sin(angle))) for angle in angles])


# Countersunk: ISO 7721 for M2.5, ISO 10642 from M3 up. ISO 14581 heads of short M3 lie 0.2 mm below the face.
M25 = Screw(shank=1.25, hole=1.35, core=1.025, head=2.25, head_height=2.5, countersunk=2.75)
M3 = Screw(shank=1.5, hole=1.6, core=1.25, head=2.75, head_height=3.0, countersunk=3.36)
M4 = Screw(shank=2.0, hole=2.15, core=1.65, head=3.5, head_height=4.0, countersunk=4.48)
M5 = Screw(shank=2.5, hole=2.65, core=2.1, head=4.25, head_height=5.0, countersunk=5.6)


def screw_for(diameter_mm: float, core_mm: float) -> Screw:
    """Return the screw for a motor's thread, with the core radius that the actuator draws there."""
    known = {2.0 * screw.shank: screw for screw in (M25, M3, M4, M5)}
    # Between the standard sizes: proportions that are no smaller than those of ISO 4762 and ISO 10642 from M3 up.
    other = Screw(
        shank=0.5 * diameter_mm,
        hole=0.5 * diameter_mm + 0.15,
        core=0.0,
        head=0.92 * diameter_mm,
        head_height=diameter_mm,
        countersunk=1.12 * diameter_mm,
    )
    return replace(known.get(diameter_mm, other), core=core_mm)


def screw_length_mm(grip_mm: Numbers, room_mm: Numbers) -> Numbers:
    """Return the longest catalogue length that fits grip and thread, measured from the seat or the flush face.

    Raises:
        DesignError: even the shortest screw is too long.
    """
    room = np.asarray(grip_mm + room_mm)
    row = np.searchsorted(LENGTHS_MM, room + 1e-9, side="right") - 1
    if np.any(row < 0):
        raise DesignError(
            f"screw with room for {np.min(room):g} mm: must have room for {LENGTHS_MM[0]:g} mm; make a plate thicker"
        )
    return LENGTHS_MM[row][()]


def ordered_screw(screw: Screw, head: Head, length_mm: float, grade: str) -> Purchase:
    """Return the order of a screw, such as ``cap screw ISO 4762 - M3 x 8 - 8.8``."""
    if head == "countersunk":
        # ISO 10642 begins at M3 and 8 mm.
        standard = "ISO 10642" if length_mm >= 8.0 and screw.shank >= 1.5 else "ISO 14581"
    else:
        standard = "ISO 4762" if head == "cap" else "ISO 4017"
    size, earlier = f"{screw.name} x {length_mm:g} - {grade}", _EARLIER.get(standard)
    return Purchase(
        kind="screw",
        designation=f"{head} screw {standard} - {size}",
        standard=standard,
        alternatives=(f"{earlier} - {size}",) if earlier else (),
    )


def ordered_nut(size: str, *, thin: bool = False, grade: str = "8") -> Purchase:
    """Return the order of a hexagon nut, such as ``nut ISO 4032 - M4 - 8``."""
    standard, earlier = ("ISO 4035", "DIN 439 B") if thin else ("ISO 4032", "DIN 934")
    return Purchase(
        kind="nut",
        designation=f"{'thin ' if thin else ''}nut {standard} - {size} - {grade}",
        standard=standard,
        alternatives=(f"{earlier} - {size} - {grade}",),
    )


_ALONE = Pattern(radius_mm=0.0, pitch_radius_mm=0.0, count=1)


def screw_part(
    name: str,
    screw: Screw,
    *,
    head: Head,
    seat_mm: Numbers,
    grip_mm: Numbers,
    room_mm: Numbers,
    direction: float,
    material: Material = MATERIALS.steel,
    holes: Pattern = _ALONE,
    places_mm: tuple[tuple[Numbers, Numbers, Numbers], ...] | None = None,
    group: Group = Group.FIXED,
    role: Role = Role.SCREW,
    visibility: Visibility = Visibility.DETAIL,
    grade: str = "8.8",
    note: str = "",
) -> Part:
    """Build a bought screw, of the greatest length for which the thread has room.

    ``head``: ``cap`` and ``hexagon`` stand on the seat; ``countersunk`` is flush with it; ``grip_mm``: from the seat to
    the beginning of the thread; ``room_mm``: depth of the thread; ``direction``: of driving along z, -1 or 1;
    ``holes``: of any size, one per screw.

    Raises:
        DesignError: no catalogue length fits the grip and leaves a thread.
    """
    length = screw_length_mm(grip_mm, room_mm)
    if np.any(length <= grip_mm):
        raise DesignError(
            f"{name}: grip of {np.max(grip_mm):g} mm leaves no thread of a catalogue length; make the plates thinner"
        )
    drawn = screw.flush(seat_mm=seat_mm, grip_mm=grip_mm, thread_mm=length - grip_mm, direction=direction)
    size = 2.0 * screw.shank
    if head == "cap":
        drawn = (cylinder(screw.head, seat_mm - direction * screw.head_height, seat_mm), *drawn)
    elif head == "hexagon":
        flats, height = hexagon(HEXAGON_FLATS_MM[size]), HEXAGON_HEIGHT_MM[size]
        drawn = (between(flats, seat_mm - direction * height, seat_mm), *drawn)
    features: tuple[CountersunkHead, ...] = ()
    if head == "countersunk":
        if np.any(grip_mm < screw.countersunk - screw.shank):
            raise DesignError(
                f"{name}: grip of {np.min(grip_mm):g} mm must be {screw.countersunk - screw.shank:g} mm or more, the "
                "height of its countersunk head; make the plate thicker"
            )
        features = (
            CountersunkHead(shank_mm=screw.shank, radius_mm=screw.countersunk, face_mm=seat_mm, inwards=direction),
        )
    part = Part(
        name=name,
        role=role,
        material=material,
        prisms=drawn,
        process="bought",
        count=holes.count,
        pitch_radius_mm=holes.pitch_radius_mm,
        phase_rad=holes.phase_rad,
        group=group,
        visibility=visibility,
        features=features,
        fastening=screw.fastening(head, grade),
        # In a population the lengths differ; purchases are used only for single parts.
        purchases=() if np.ndim(length) else (ordered_screw(screw, head, float(length), grade),),
        note=note,
    )
    return part if places_mm is None else replace(part, places_mm=places_mm)
