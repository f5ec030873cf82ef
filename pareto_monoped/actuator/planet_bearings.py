"""What the planets turn on, as parts: a bush each, or rows of needle rollers between washers."""

from dataclasses import replace
from functools import partial

import numpy as np

from pareto_monoped.actuator.features import tube
from pareto_monoped.actuator.layout import BUSH_PLAY_MM, Layout
from pareto_monoped.actuator.needles import NeedleRows, needle_rows
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.making import Length
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import GREASE, GREASE_G_PER_MM3, Group, Joint, JointKind, Purchase, Role, Visibility
from pareto_monoped.geometry.shapes import Numbers

_BUSH_LENGTHS_MM = (4.0, 6.0, 8.0, 10.0)
"""Of bushes for pins of 6 mm (ISO 3547-1; makers add the shortest)."""
_BUSH_LESS_MM = 0.1
"""By how much it may be shorter, as it is cut; our own choice."""
_SUPPORT_RING_MM = 1.2
"""Least thickness of a support ring for these pins (DIN 988)."""
_WASHER_LESS_MM = 0.05
"""By how much a washer of 1 to 2 mm may be thinner (DIN 988)."""
_SPACER_PLAY_MM = 0.2
"""Radial play of a spacer ring on the pin and in the planet; our own choice."""
_LEAST_SPACER_MM = 0.75
"""Thinner spacers cannot be turned: one of twice the thickness stands at one end instead, and below that none, so that
needles have half as much room to either side; our own choice."""
_IN_PLANET = Joint(kind=JointKind.STUCK, how="stuck with grease into the bore of", partner="planet")
"""Of loose needles: a planet comes with all of them, or they fall out."""
Place = tuple[Numbers, Numbers, Numbers]


def planet_bearing_parts(at: Layout, settings: ActuatorSettings) -> tuple[Part, ...]:
    """Build what is between planets and pins, for one gear set or for arrays of them."""
    return _bushes(at, settings) if settings.planet_bearing == "bushes" else _needle_parts(at, settings)


def _bushes(at: Layout, settings: ActuatorSettings) -> tuple[Part, ...]:
    stands_out = settings.planet_clearance_mm - BUSH_PLAY_MM
    pin, planet_part = 0.5 * settings.parts.carrier.pin_diameter_mm, _planet_part(at)
    return (
        planet_part(
            name="planet_bush",
            role=Role.BUSH,
            material=settings.materials.bush_bronze,
            prisms=tube(at.z_gear_back - stands_out, at.z_gear_front + stands_out, 0.5 * settings.planet_bore_mm, pin),
            process="bought",
            lengths=(
                Length(
                    name="length",
                    z0_mm=at.z_gear_back - stands_out,
                    z1_mm=at.z_gear_front + stands_out,
                    lower_mm=-_BUSH_LESS_MM,
                    upper_mm=0.0,
                ),
            ),
            purchases=_ordered_bushes(at.face_width_mm + 2.0 * stands_out, settings),
            note="end to end; longer than the planet on either side",
        ),
    )


def _planet_part(at: Layout) -> "partial[Part]":
    """Return what makes a part that turns with the planets."""
    gears = at.gears
    return partial(
        Part, visibility=Visibility.INSIDE, group=Group.PLANET, count=gears.planets, pitch_radius_mm=at.r_pins
    )


def _ordered_bushes(length_mm: Numbers, settings: ActuatorSettings) -> tuple[Purchase, ...]:
    """Return which bushes of the catalogue make a planet's bush: end to end, cut to equal lengths."""
    if np.ndim(length_mm):
        return ()
    pieces = int(np.ceil(float(length_mm) / _BUSH_LENGTHS_MM[-1]))
    each = float(length_mm) / pieces
    bought = next(length for length in _BUSH_LENGTHS_MM if length >= each)
    size = f"{settings.parts.carrier.pin_diameter_mm:g} x {settings.planet_bore_mm:g} x {bought:g}"
    return (
        Purchase(
            kind="bush",
            designation=f"PTFE bronze bush ISO 3547 - {size} mm",
            standard="ISO 3547",
            count=pieces,
            remark=f"cut to {each:.1f} mm",
        ),
    )


def _needle_parts(at: Layout, settings: ActuatorSettings) -> tuple[Part, ...]:
    """Build the needle rollers, spacers that fill what they leave of the planet's bore, and washers at either end."""
    data, pin, bore = settings.parts.needles, settings.parts.carrier.pin_diameter_mm, settings.planet_bore_mm
    rows = needle_rows(at.face_width_mm, settings)
    needles, spacers, spacer = _stacked(at, rows)
    one_kg = settings.materials.bearing_steel.density_kg_per_m3 * 1e-9 * 0.25 * np.pi * data.diameter_mm**2
    washer_places: tuple[Place, ...] = (
        (0.0, 0.0, at.z_gear_front + data.washer_play_mm),
        (0.0, 0.0, at.z_gear_back - data.washer_play_mm - data.washer_mm),
    )
    length, planet_part = rows.total_mm / len(needles), _planet_part(at)
    parts = [
        planet_part(
            name="planet_needles",
            role=Role.BEARING,
            material=settings.materials.bearing_steel,
            prisms=tube(0.0, length, 0.5 * bore, 0.5 * pin),
            process="bought",
            catalogue_mass_kg=rows.needles * one_kg * length,
            purchases=_ordered_needles(rows, data.diameter_mm),
            note="full complement, greased",
            at_assembly=f"{rows.needles} loose rollers in each row: set them all into the grease before the planet "
            "goes over its pin",
            joint=_IN_PLANET,
            places_mm=needles,
        ),
        planet_part(
            name="planet_washer",
            role=Role.SPACER,
            material=settings.materials.steel,
            prisms=tube(0.0, data.washer_mm, 0.5 * data.washer_diameter_mm, 0.5 * pin),
            process="bought",
            lengths=(
                Length(name="thickness", z0_mm=0.0, z1_mm=data.washer_mm, lower_mm=-_WASHER_LESS_MM, upper_mm=0.0),
            ),
            purchases=(
                Purchase(
                    kind="washer",
                    designation=f"{_ring_kind(data.washer_mm)} {pin:g} x {data.washer_diameter_mm:g} x "
                    f"{data.washer_mm:g}",
                    standard="DIN 988",
                ),
            ),
            places_mm=washer_places,
        ),
    ]
    if np.ndim(spacer) or spacer:
        parts.append(
            planet_part(
                name="needle_spacer",
                role=Role.SPACER,
                material=settings.materials.aluminium,
                prisms=tube(0.0, spacer, 0.5 * bore - _SPACER_PLAY_MM, 0.5 * pin + _SPACER_PLAY_MM),
                process="machined",
                note="fills the planet's bore beside its needles",
                joint=_IN_PLANET,
                places_mm=spacers,
            )
        )
    return tuple(parts)


def _ring_kind(thickness_mm: float) -> str:
    """Return which rings of DIN 988 have a thickness: the hard ones, of 1.2 mm at the least, or thinner shims."""
    return "support ring DIN 988 - S" if thickness_mm >= _SUPPORT_RING_MM else "shim ring DIN 988 - PS"


def _ordered_needles(rows: NeedleRows, diameter_mm: float) -> tuple[Purchase, ...]:
    """Return the rollers of a row, and the grease between them; () for arrays."""
    if np.ndim(rows.length_mm):
        return ()
    size = f"{diameter_mm:g} x {float(rows.length_mm):g}"
    rollers = Purchase(
        kind="needle roller",
        designation=f"needle roller ISO 3096 - {size} mm - G2",
        standard="ISO 3096",
        alternatives=(f"INA NRB {size} G2",),
        count=float(rows.needles),
    )
    # A ring of the rollers' diameter has 1 - pi / 4 of its section beside them.
    free_mm3 = (4.0 / np.pi - 1.0) * float(rows.needles) * 0.25 * np.pi * diameter_mm**2 * float(rows.length_mm)
    return rollers, replace(GREASE, count=GREASE_G_PER_MM3 * free_mm3)


def _stacked(at: Layout, rows: NeedleRows) -> tuple[tuple[Place, ...], tuple[Place, ...], Numbers]:
    """Return the lower ends of the needles and of the spacers along a planet's bore, and the length of a spacer.

    One row stands in the middle, with a spacer at either end, or against the only one. Two rows stand at the ends, the
    spacer between them. In arrays, one row and any spacer are drawn as two halves that touch.
    """
    rest, low, high = at.face_width_mm - rows.total_mm, at.z_gear_back, at.z_gear_front
    spacer = np.where(rest >= _LEAST_SPACER_MM, rest, 0.0)[()]
    half = 0.5 * spacer
    single, apart = rows.rows == 1, rest >= 2.0 * _LEAST_SPACER_MM
    # Of one row: from the planet's lower face to the needles.
    below = np.where(apart | (spacer == 0.0), 0.5 * rest, spacer)[()]
    if np.ndim(single) == 0 and np.ndim(rest) == 0:
        if single and apart:
            return ((0.0, 0.0, low + below),), ((0.0, 0.0, low), (0.0, 0.0, high - half)), half
        if single:
            return ((0.0, 0.0, low + below),), ((0.0, 0.0, low),), spacer
        length = 0.5 * rows.total_mm
        return ((0.0, 0.0, low), (0.0, 0.0, high - length)), ((0.0, 0.0, low + length),), spacer
    length = 0.5 * rows.total_mm
    needles = (
        np.where(single, low + below, low),
        np.where(single, low + below, high) + np.where(single, length, -length),
    )
    first = np.where(single, low, low + length)
    spacers = (first, np.where(single & apart, high - half, first + half))
    return tuple((0.0, 0.0, z) for z in needles), tuple((0.0, 0.0, z) for z in spacers), half
