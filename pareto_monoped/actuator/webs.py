"""Webs between the planets, which tie the second carrier to the first: their shape, and how stiff they are.

A web fills the gap between two neighbouring planets as far as their tips and those of the ring let it. It is cut from
one piece with the carrier; a screw clamps the second carrier to its end.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.screws import M3
from pareto_monoped.geometry.shapes import Arc, Line, Numbers, Path, Spread
from pareto_monoped.materials import ElasticMaterial

SCREW = M3
"""What clamps the second carrier to a web."""
_HEAD_WALL_MM = 0.3
"""Around a countersunk head; our own choice."""
_LEAST_PLANETS = 3
"""Between two planets, the gap is wider than their circles bound it; nobody builds webs there."""
_SHEAR_SHARE = 1.2
"""Mean shear stress over the shear stress that the deflection goes by, for a full section (Timoshenko)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Webs:
    """Webs of one carrier, or of arrays of them."""

    count: Numbers  #: as many as planets, or 0 where the gaps have no room for the screw
    room_mm: Numbers  #: metal around the screw's tapping hole beyond the least one, negative where there is too little
    r_out_mm: Numbers  #: outer radius
    r_screw_mm: Numbers  #: radius of the screws' circle
    phase_rad: Numbers  #: angle of the first web; the first planet is at 0
    path: Path  #: cross-section around the +x axis

    @property
    def reach_mm(self) -> Numbers:
        """Least outer radius of the second carrier: over the webs and the screws' countersunk heads."""
        return np.maximum(self.r_out_mm, self.r_screw_mm + SCREW.countersunk + _HEAD_WALL_MM)

    @property
    def outline(self) -> Spread:
        """All webs of a carrier."""
        return Spread(path=self.path, count=self.count, phase_rad=self.phase_rad)

    @property
    def present(self) -> NDArray[np.bool_]:
        """Which carriers have webs, shape (n,) or ()."""
        return np.asarray(self.count) > 0

    @property
    def section(self) -> "WebSection":
        """What the stiffness of one web follows from."""
        moments = self.path.moments()
        return WebSection(present=self.present, area_mm2=moments.area, second_moment_mm4=moments.yy)


@dataclass(frozen=True, slots=True, kw_only=True)
class WebSection:
    """Cross-section of one web."""

    present: NDArray[np.bool_]  #: whether the carrier has webs
    area_mm2: Numbers  #: of it
    second_moment_mm4: Numbers  #: of it, against bending around the carrier's axis

    def stiffness_n_per_mm(self, length_mm: Numbers, material: ElasticMaterial) -> Numbers:
        """Return a web's stiffness against a force around the axis, as a clamped beam; 0 without webs."""
        present = self.present
        area, second = (np.where(present, value, 1.0) for value in (self.area_mm2, self.second_moment_mm4))
        bending = length_mm**3 / (12.0 * material.youngs_modulus_mpa * second)
        shear = _SHEAR_SHARE * length_mm / (material.shear_modulus_mpa * area)
        return np.where(present, 1.0 / (bending + shear), 0.0)[()]


def webs_of(gears: GearSet, settings: ActuatorSettings) -> Webs:
    """Return the webs of a gear set, or of arrays of them; none if the settings ask for pins alone.

    Seen along the middle of a gap, the planets' pins are at angles of pi / n to either side. The sides of a web are
    arcs around the pins that keep clear of the tips, its outer face is an arc around the axis, its inner face is flat.
    """
    data, carrier = settings.parts.webs, settings.parts.carrier
    half, reach = np.pi / gears.planets, 0.5 * carrier.pin_diameter_mm + carrier.pin_wall_mm
    r_pins, keep = gears.carrier_radius_mm, gears.planet().tip_radius_mm + data.clearance_mm
    x_pin, y_pin = r_pins * np.cos(half), r_pins * np.sin(half)
    r_out = np.minimum(gears.ring().tip_radius_mm - data.clearance_mm, r_pins + reach + data.overhang_mm)
    # Where the outer face meets a side: the triangle of axis, pin and corner.
    cosine = (r_out**2 + r_pins**2 - keep**2) / (2.0 * r_out * r_pins)
    corner = half - np.arccos(np.clip(cosine, -1.0, 1.0))
    # The inner face lies where the gap is wide enough, and no further in than its narrowest place. Wide webs are
    # deeper, so that half the depth is left at their outer corners.
    neck = np.sqrt(np.maximum(keep**2 - np.square(y_pin - data.neck_mm), 0.0))
    x_corner = r_out * np.cos(corner)
    x_in = np.maximum(x_pin + neck, np.minimum(r_out - data.depth_mm, x_corner - 0.5 * data.depth_mm))
    y_in = y_pin - np.sqrt(np.maximum(keep**2 - np.square(x_in - x_pin), 0.0))
    hole = SCREW.core + data.screw_wall_mm
    r_screw = r_out - hole
    room = np.minimum(np.hypot(r_screw - x_pin, y_pin) - keep, r_screw - x_in) - hole
    fits = (room >= 0.0) & (x_corner > x_in) & (gears.planets >= _LEAST_PLANETS) & (settings.second_carrier == "webs")
    start = np.arctan2(r_out * np.sin(corner) - y_pin, x_corner - x_pin)
    end = np.arctan2(y_in - y_pin, x_in - x_pin)
    path = Path(
        (
            Arc(0.0, 0.0, r_out, -corner, corner),
            Arc(x_pin, y_pin, keep, start, end),
            Line(x_in, y_in, x_in, -y_in),
            Arc(x_pin, -y_pin, keep, -end, -start),
        )
    )
    return Webs(
        count=np.where(fits, gears.planets, 0)[()],
        room_mm=room,
        r_out_mm=r_out,
        r_screw_mm=r_screw,
        phase_rad=half,
        path=path,
    )
