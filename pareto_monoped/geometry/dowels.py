"""Hardened parallel pins (ISO 8734, type A) as parts, and the holes that they stand in."""

from dataclasses import dataclass, replace

import numpy as np

from pareto_monoped.errors import DesignError
from pareto_monoped.geometry.making import Fit
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import RETAINER, Group, Joint, JointKind, Purchase, Role, Visibility
from pareto_monoped.geometry.screws import cylinder
from pareto_monoped.geometry.shapes import Numbers, Pattern
from pareto_monoped.materials import ALLOYS, MATERIALS, Alloy, Material

LENGTHS_MM = np.array([5, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30, 32, 35, 40], dtype=np.float64)
"""Lengths in which pins are sold (ISO 8734)."""
_SOLD_MM = {2.0: (5, 20), 2.5: (6, 24), 3.0: (8, 30), 4.0: (10, 40), 5.0: (12, 50)}
"""Least and greatest length by diameter (ISO 8734)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Dowel:
    """A size of dowel.

    Pressed into one part by H7/m6, which leaves aluminium elastic, and bonded there, because this fit may have play.
    The holes of the other parts are reamed together with it.
    """

    diameter_mm: float  #: nominal

    @property
    def radius_mm(self) -> float:
        """Half the diameter."""
        return 0.5 * self.diameter_mm

    @property
    def fit(self) -> Fit:
        """Tolerance of the dowel."""
        return Fit(diameter_mm=self.diameter_mm, zone="m6")

    @property
    def hole_fit(self) -> Fit:
        """Tolerance of its holes."""
        return Fit(diameter_mm=self.diameter_mm, zone="H7", together=True)

    @property
    def alloy(self) -> Alloy:
        """What it is made of."""
        return ALLOYS["dowel"]

    def holes(self, pitch_circle_mm: Numbers, count: Numbers, phase_rad: float) -> Pattern:
        """Return the holes for dowels on a circle."""
        return Pattern(
            radius_mm=self.radius_mm, pitch_radius_mm=0.5 * pitch_circle_mm, count=count, phase_rad=phase_rad
        )

    def between(self, bolts: Pattern, *, every: int = 1) -> Pattern:
        """Return the holes for dowels on the circle of bolts, in the middle of every gap, or of every second one."""
        return replace(
            bolts, radius_mm=self.radius_mm, count=bolts.count // every, phase_rad=float(np.pi / bolts.count)
        )

    def length_mm(self, room_mm: Numbers) -> Numbers:
        """Return the longest catalogue length that fits.

        Raises:
            DesignError: even the shortest is too long.
        """
        least, most = _SOLD_MM[self.diameter_mm]
        sold = LENGTHS_MM[(least <= LENGTHS_MM) & (most >= LENGTHS_MM)]
        row = np.searchsorted(sold, np.asarray(room_mm) + 1e-9, side="right") - 1
        if np.any(row < 0):
            raise DesignError(
                f"dowel of {self.diameter_mm:g} mm with room for {np.min(room_mm):g} mm: must have room for "
                f"{sold[0]:g} mm; make a plate thicker or the dowel thinner"
            )
        return sold[row][()]


def dowel_part(
    name: str,
    dowel: Dowel,
    *,
    end_mm: Numbers,
    room_mm: Numbers,
    direction: float,
    holes: Pattern,
    partner: str,
    material: Material = MATERIALS.steel,
    group: Group = Group.FIXED,
    note: str = "",
) -> Part:
    """Build a circle of bought dowels, each of the greatest length for which its holes have room.

    ``end_mm``: height of the end at which it begins, such as the bottom of its blind hole; ``room_mm``: from there to
    as far as it may reach; ``partner``: name of the part of the same unit in which it is pressed and bonded.

    Raises:
        DesignError: no catalogue length fits.
    """
    length = dowel.length_mm(room_mm)
    return Part(
        name=name,
        role=Role.PIN,
        visibility=Visibility.INSIDE,
        material=material,
        prisms=(cylinder(dowel.radius_mm, end_mm, end_mm + direction * length),),
        process="bought",
        count=holes.count,
        pitch_radius_mm=holes.pitch_radius_mm,
        phase_rad=holes.phase_rad,
        group=group,
        grade=dowel.alloy,
        fits=(dowel.fit,),
        # In a population the lengths differ; purchases are used only for single parts.
        purchases=() if np.ndim(length) else (_ordered(f"{dowel.diameter_mm:g} m6 x {float(length):g}"),),
        note=note,
        at_assembly=REAMED,
        joint=Joint(kind=JointKind.BONDED, how="pressed and bonded into", partner=partner, adhesive=RETAINER),
    )


REAMED = "into holes that were reamed together before the first step"
"""What is said where dowels are put in: the parts are closed and greased by then, and no chip may fall into them."""


def _ordered(size: str) -> Purchase:
    return Purchase(
        kind="pin",
        designation=f"parallel pin ISO 8734 - {size} - A - St",
        standard="ISO 8734",
        alternatives=(f"DIN 6325 - {size}",),
    )
