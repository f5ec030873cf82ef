"""The front of both families: gears, carriers, pins, main and end bearing."""

import numpy as np

from pareto_monoped.actuator.bearings import groove, ring_thickness
from pareto_monoped.actuator.features import (
    bought_bearing,
    gear_note,
    gear_part,
    made,
    output_dowel_holes,
    output_holes,
    rated_teeth,
    slab,
    tube,
)
from pareto_monoped.actuator.layout import Layout
from pareto_monoped.actuator.planet_bearings import planet_bearing_parts
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.actuator.webs import SCREW as WEB_SCREW
from pareto_monoped.geometry.dowels import Dowel
from pareto_monoped.geometry.features import POINT_SHARE, bored, tap_run_out_mm, turned
from pareto_monoped.geometry.gears import ADDENDUM, DEDENDUM, ExternalGear
from pareto_monoped.geometry.making import FINE_MM, Fit, Length, limits, narrower, raceway_note, wider
from pareto_monoped.geometry.parts import Part, Prism, steel_part, strong_part
from pareto_monoped.geometry.roles import BEARING_RETAINER, RETAINER, Group, Joint, JointKind, Role, Visibility
from pareto_monoped.geometry.screws import M3, clearance, screw_part, tapped
from pareto_monoped.geometry.shapes import Circle, Numbers, Pattern
from pareto_monoped.materials import ALLOYS

_PIN_THREAD_MM = 6.0
"""Of the screw in a planet pin: twice the diameter of M3."""
_PIN_SPARE_MM = 2.0
"""How much deeper its hole is, for the tap's lead."""
_WEB_THREAD_MM = 5.0
"""Of the screw in a web: M3 x 10 through the second carrier. Its hole ends before the shortest web does."""
_PIN_ZONE, _RACEWAY_ZONE = "m6", "F7"
"""Of a planet's pin, and of the bore in which needles run around it."""
_RACEWAY_CASE = 0.1
"""Least case depth of a raceway over the rolling elements' diameter, for loads up to C0 (SKF, Raceways on shafts and in
housings)."""
_RIM_TOOTH_DEPTHS = 1.2
"""Least rim under the planet's roots, in tooth depths (AGMA 2001-D04, rim thickness factor 1)."""
_FLOOR_MM = 0.5
"""Least metal between the drill's point under an output thread and a pin's hole; our own choice."""
_RECESS_DEPTHS = 5.0
"""Greatest depth of a planet's recess over its width: tools for face grooves reach 4 to 6 widths."""
_PIN_TO_GROOVE_MM = 0.1
"""Least axial distance of the pins' ends from the retaining ring's groove, of wide grooves; our own choice."""


def planet_prisms(at: Layout, settings: ActuatorSettings) -> tuple[Prism, ...]:
    """Build a planet, recessed on both faces between hub and rim where there is room for it."""
    data = settings.parts.gears
    gears = at.gears
    shape = gears.planet()
    bore = 0.5 * settings.planet_bore_mm
    hub = bore + data.planet_hub_wall_mm
    rim = shape.root_radius_mm - _RIM_TOOTH_DEPTHS * (ADDENDUM + DEDENDUM) * gears.module_mm
    recessed = rim - hub >= data.planet_recess_min_mm
    low, high = at.z_gear_back, at.z_gear_front
    if np.ndim(recessed) == 0 and not recessed:
        return slab(low, high, shape, bore)
    rim = np.where(recessed, rim, hub)[()]
    depth = np.minimum(0.5 * (1.0 - data.planet_web_share) * at.face_width_mm, _RECESS_DEPTHS * (rim - hub))
    if settings.rules != "paper":  # whose face widths are not rounded either
        step = settings.parts.rating.face_step_mm
        depth = np.round(depth / step) * step
    return (
        *slab(low, low + depth, shape, rim),
        *tube(low, low + depth, hub, bore),
        *slab(low + depth, high - depth, shape, bore),
        *slab(high - depth, high, shape, rim),
        *tube(high - depth, high, hub, bore),
    )


def gear_parts(at: Layout, settings: ActuatorSettings) -> tuple[Part, ...]:
    """Build the planets with their bearings, pins and the pins' screws, ring."""
    return (_planet(at, settings), *planet_bearing_parts(at, settings), *_pins(at, settings), _ring(at, settings))


def _planet(at: Layout, settings: ActuatorSettings) -> Part:
    gears, steel, bushes = at.gears, settings.gear_steels.planet, settings.planet_bearing == "bushes"
    bore = Circle(radius_mm=0.5 * settings.planet_bore_mm)
    return gear_part(settings, steel)(
        name="planet",
        prisms=planet_prisms(at, settings),
        group=Group.PLANET,
        features=(bored(bore, at.z_gear_back, at.z_gear_front, enters="both", pressed=bushes),),
        teeth=made(
            rated_teeth(
                gears.planet(),
                steel,
                settings,
                gears.sun(),
                gears.ring(),
                centre_mm=at.r_pins,
                crowning_um=settings.parts.rating.planet_crowning_um,
            )
        ),
        note=_planet_note(gears.planet(), settings),
        fits=planet_fits(settings),
        lengths=(narrower("face", at.z_gear_back, at.z_gear_front),),
        joint=Joint(kind=JointKind.PRESSED, how="pressed onto", partner="planet_bush") if bushes else None,
        count=gears.planets,
        pitch_radius_mm=at.r_pins,
    )


def _pins(at: Layout, settings: ActuatorSettings) -> tuple[Part, ...]:
    """Build the planets' pins, and the screws that hold the second carrier on them."""
    materials, carrier, gears = settings.materials, settings.parts.carrier, at.gears
    pin = 0.5 * carrier.pin_diameter_mm
    pin_low = at.z_secondary_front - carrier.pin_depth_mm
    pin_tap = pin_low + _PIN_THREAD_MM + _PIN_SPARE_MM
    pin_front = z_pin_front(at, settings)
    needles = settings.planet_bearing == "needles"
    return (
        Part(
            name="planet_pin",
            role=Role.PIN,
            visibility=Visibility.INSIDE,
            material=materials.steel,
            prisms=(*slab(pin_low, pin_tap, pin, M3.core), *slab(pin_tap, pin_front, pin)),
            process="machined",
            group=Group.OUTPUT,
            grade=ALLOYS["raceway_pin" if needles else "dowel"],
            fits=(Fit(diameter_mm=carrier.pin_diameter_mm, zone=_PIN_ZONE, raceway=needles),),
            lengths=(_pin_length(pin_low, pin_front, settings),),
            features=(
                tapped(M3, (Circle(radius_mm=M3.core),), pin_low, pin_tap, enters="low", usable_mm=_PIN_THREAD_MM),
                turned(pin, pin_low, 1.0, pressed=True),
                turned(pin, pin_front, -1.0, pressed=True),
            ),
            note=f"{_raceway(carrier.pin_diameter_mm, _PIN_ZONE)}; M3 tapped before hardening" if needles else "dowel",
            at_assembly="into the carrier first; the secondary carrier is pushed onto their other ends when it comes",
            joint=Joint(kind=JointKind.PRESSED, how="pressed into secondary_carrier and", partner="carrier"),
            count=gears.planets,
            pitch_radius_mm=at.r_pins,
        ),
        screw_part(
            "planet_pin_screw",
            M3,
            head="countersunk",
            seat_mm=at.z_secondary_back,
            grip_mm=carrier.secondary_thickness_mm - carrier.pin_depth_mm,
            room_mm=_PIN_THREAD_MM,
            direction=1.0,
            material=materials.steel,
            holes=Pattern(radius_mm=M3.hole, pitch_radius_mm=at.r_pins, count=gears.planets),
            group=Group.OUTPUT,
            note="holds the secondary carrier on its pin",
        ),
    )


def _ring(at: Layout, settings: ActuatorSettings) -> Part:
    gears, steel = at.gears, settings.gear_steels.ring
    teeth = gears.ring()
    return gear_part(settings, steel)(
        name="ring",
        prisms=slab(at.z_gear_back, at.z_gear_front, at.r_ring, teeth),
        group=Group.HOUSING,
        fits=(Fit(diameter_mm=2.0 * at.r_ring, zone="h6", seat=True),),
        lengths=(narrower("face", at.z_gear_back, at.z_gear_front),),
        teeth=made(rated_teeth(gears.ring(), steel, settings, gears.planet(), centre_mm=at.r_pins)),
        note=gear_note(teeth, settings),
        at_assembly="bonded when the carrier comes, once the dowels are in: the planets centre it; with the "
        "carrier in its bearings, turn it by hand some turns before the adhesive sets",
        joint=Joint(kind=JointKind.BONDED, how="bonded into", partner="ring_housing", adhesive=RETAINER),
    )


def _pin_length(low_mm: Numbers, high_mm: Numbers, settings: ActuatorSettings) -> Length:
    """Return the pins' length with its limits: with webs they must not keep the carriers apart, else they do so."""
    off_mm = (-2.0 * FINE_MM, 0.0) if settings.second_carrier == "webs" else (0.0, FINE_MM)
    return Length(name="length", z0_mm=low_mm, z1_mm=high_mm, lower_mm=off_mm[0], upper_mm=off_mm[1])


def _pin_hole(low_mm: Numbers, high_mm: Numbers, settings: ActuatorSettings) -> Length:
    """Return the depth of the pins' holes with its limits, as for their length."""
    made = wider if settings.second_carrier == "webs" else narrower
    return made("pin hole", low_mm, high_mm)


def planet_fits(settings: ActuatorSettings) -> tuple[Fit, ...]:
    """Return the tolerance of the planets' bores; needles have 1 to 24 um between a raceway and a pin of m6."""
    needles = settings.planet_bearing == "needles"
    return (
        Fit(diameter_mm=settings.planet_bore_mm, zone=_RACEWAY_ZONE if needles else "H7", seat=True, raceway=needles),
    )


def _planet_note(gear: ExternalGear, settings: ActuatorSettings) -> str:
    """Return a planet's note; with needles, what its bore needs as their outer raceway."""
    note = gear_note(gear, settings)
    if settings.planet_bearing == "bushes" or not note:
        return note
    case = ""
    if settings.gear_steels.planet.treatment == "case_hardened":
        least = _RACEWAY_CASE * settings.parts.needles.diameter_mm
        case = f", case of {least:.2f} mm or more after honing, in one charge with the teeth"
    return f"{note}; bore is {_raceway(settings.planet_bore_mm, _RACEWAY_ZONE)}{case}"


def _raceway(diameter_mm: float, zone: str) -> str:
    found = limits(diameter_mm, zone)
    return raceway_note(found.upper_mm - found.lower_mm)


def z_pin_front(at: Layout, settings: ActuatorSettings) -> Numbers:
    """Return the height of the pins' front ends: behind the output's threads and the retaining ring's groove."""
    return output_bottoms(at, settings)[1]


def output_bottoms(at: Layout, settings: ActuatorSettings) -> tuple[Numbers, Numbers]:
    """Return how deep the output's tapped holes are, and the face behind them from which the pins stand.

    They go through where the carrier is hollow behind. Elsewhere they are deeper than their threads for the tap's lead,
    with a floor below the drill's point.
    """
    carrier, floor = settings.parts.carrier, _FLOOR_MM + POINT_SHARE * 2.0 * M3.core
    hollow = at.r_carrier_in >= 0.5 * settings.parts.interface.output_bolt_circle_mm + M3.core
    blind = -(carrier.thread_depth_mm + tap_run_out_mm(M3.thread.pitch_mm))
    shallow = np.minimum(-at.end_bearing.width_mm - carrier.diaphragm_mm, _z_groove(at) - _PIN_TO_GROOVE_MM)
    shallow = np.minimum(shallow, -carrier.thread_depth_mm)
    face = np.where(hollow, shallow, np.minimum(shallow, blind - floor))[()]
    return np.where(hollow, face, blind)[()], face


def _z_groove(at: Layout) -> Numbers:
    """Return the height of the back of the retaining ring's groove; its play is on this side, under the bearing."""
    return at.z_bearing_front - at.shaft_ring.play_mm


def carrier_parts(at: Layout, settings: ActuatorSettings) -> tuple[Part, ...]:
    """Build the carrier with output flange and webs, retaining ring, main and end bearing, secondary carrier."""
    data, materials = settings.parts, settings.materials
    carrier = data.carrier
    threads, dowels = output_holes(settings), output_dowel_holes(settings)
    z_diaphragm, z_groove = -at.end_bearing.width_mm, _z_groove(at)
    z_tap, z_pins = output_bottoms(at, settings)
    pins = Pattern(radius_mm=0.5 * carrier.pin_diameter_mm, pitch_radius_mm=at.r_pins, count=at.gears.planets)
    seat, ring = 0.5 * at.end_bearing.outer_diameter_mm, at.shaft_ring
    bore = seat - data.casing.lip_mm
    z_ring = at.z_bearing_front + ring.thickness_mm
    body: tuple[Prism, ...] = (
        *slab(-carrier.flange_thickness_mm, 0.0, carrier.flange_radius_mm, seat, threads, dowels),
        *slab(z_ring, -carrier.flange_thickness_mm, at.r_bore, seat, threads, dowels),
        *slab(z_diaphragm, z_ring, ring.r_groove, seat, threads, dowels),
        # Wide grooves end behind the threads, narrow ones before them.
        *slab(np.maximum(z_groove, z_tap), z_diaphragm, ring.r_groove, bore, threads),
        *slab(z_tap, np.maximum(z_groove, z_tap), at.r_bore, bore, threads),
        *slab(z_groove, np.maximum(z_groove, z_tap), ring.r_groove, bore),
        *slab(z_pins, np.minimum(z_groove, z_tap), at.r_bore, bore),
        *slab(at.z_bearing_back, z_pins, at.r_bore, at.r_carrier_in, pins),
        *slab(at.z_shoulder, at.z_bearing_back, at.r_bore + carrier.shoulder_height_mm, at.r_carrier_in, pins),
    )
    web_holes, z_tapped = _web_holes(at, WEB_SCREW.core), at.z_secondary_front + _WEB_THREAD_MM + _PIN_SPARE_MM
    if web_holes:
        body += slab(at.z_secondary_front, z_tapped, at.webs.outline, *web_holes)
        body += slab(z_tapped, at.z_shoulder, at.webs.outline)
    return (
        strong_part(
            name="carrier",
            role=Role.CARRIER,
            material=materials.aluminium,
            prisms=body,
            group=Group.OUTPUT,
            fits=(
                Fit(diameter_mm=2.0 * at.r_bore, zone="h6", seat=True),
                Fit(diameter_mm=2.0 * seat, zone="H7", seat=True),
                Fit(diameter_mm=carrier.pin_diameter_mm, zone="H7"),
                Dowel(diameter_mm=data.interface.output_dowel_mm).hole_fit,
                Fit(diameter_mm=ring.groove_diameter_mm, zone=ring.groove_zone),
            ),
            lengths=(
                wider("inner seat", at.z_bearing_back, z_ring),
                groove(z_groove, ring),
                wider("shoulder", at.z_shoulder, at.z_bearing_back),
                _pin_hole(at.z_shoulder, z_pins, settings),
                *((wider("web", at.z_secondary_front, at.z_shoulder),) if web_holes else ()),
            ),
            note=f"{ring.groove_note}; the point of the drill of the dowels' holes may come through their floor",
            features=(
                tapped(M3, (threads,), z_tap, 0.0, enters="high", usable_mm=carrier.thread_depth_mm),
                bored(Circle(radius_mm=seat), z_diaphragm, 0.0, enters="high"),
                bored(pins, at.z_shoulder, z_pins, enters="low", pressed=True),
                turned(at.r_bore, -carrier.flange_thickness_mm, -1.0),
                *(
                    tapped(WEB_SCREW, (hole,), at.z_secondary_front, z_tapped, enters="low", usable_mm=_WEB_THREAD_MM)
                    for hole in web_holes
                ),
            ),
        ),
        _secondary_carrier(at, settings, pins),
        steel_part(
            name="retaining_ring",
            role=Role.RETAINING_RING,
            visibility=Visibility.INSIDE,
            material=materials.steel,
            prisms=tube(at.z_bearing_front, z_ring, ring.r_free, ring.r_groove),
            lengths=(ring_thickness(ring, at.z_bearing_front),),
            group=Group.OUTPUT,
            catalogue_mass_kg=ring.mass_kg,
            purchases=ring.purchases,
            note="in the carrier's groove before the main bearing",
        ),
        bought_bearing(
            "main_bearing", materials.bearing_steel, at.bearing, at.z_bearing_front, Group.OUTPUT, "thin-section"
        ),
        bought_bearing(
            "end_bearing",
            materials.bearing_steel,
            at.end_bearing,
            0.0,
            Group.OUTPUT,
            "carries the sun's end in the carrier",
            joint=Joint(
                kind=JointKind.BONDED, how="bonded into", partner="carrier", adhesive=BEARING_RETAINER, first=True
            ),
        ),
        *_web_screws(at, settings),
    )


def _secondary_carrier(at: Layout, settings: ActuatorSettings, pins: Pattern) -> Part:
    """Build the ring that holds the far ends of the planets' pins, screwed to these and to the webs."""
    carrier, materials = settings.parts.carrier, settings.materials
    screws = Pattern(radius_mm=M3.hole, pitch_radius_mm=at.r_pins, count=at.gears.planets)
    web_holes = _web_holes(at, WEB_SCREW.hole)
    z_split = at.z_secondary_front - carrier.pin_depth_mm
    return strong_part(
        name="secondary_carrier",
        role=Role.CARRIER,
        visibility=Visibility.INSIDE,
        material=materials.aluminium,
        prisms=(
            *slab(z_split, at.z_secondary_front, at.r_secondary_out, at.r_secondary_in, pins, *web_holes),
            *slab(at.z_secondary_back, z_split, at.r_secondary_out, at.r_secondary_in, screws, *web_holes),
        ),
        group=Group.OUTPUT,
        fits=(Fit(diameter_mm=carrier.pin_diameter_mm, zone="H7"),),
        lengths=(
            _pin_hole(z_split, at.z_secondary_front, settings),
            narrower("thickness", at.z_secondary_back, at.z_secondary_front),
        ),
        features=(
            clearance(M3, (screws,), at.z_secondary_back, z_split, countersunk="low"),
            bored(pins, z_split, at.z_secondary_front, enters="high", pressed=True),
            *(
                clearance(WEB_SCREW, (hole,), at.z_secondary_back, at.z_secondary_front, countersunk="low")
                for hole in web_holes
            ),
        ),
    )


def _web_holes(at: Layout, radius_mm: float) -> tuple[Pattern, ...]:
    webs = at.webs
    if not np.any(webs.present):  # of arrays, any may have webs
        return ()
    return (Pattern(radius_mm=radius_mm, pitch_radius_mm=webs.r_screw_mm, count=webs.count, phase_rad=webs.phase_rad),)


def _web_screws(at: Layout, settings: ActuatorSettings) -> tuple[Part, ...]:
    """Build the screws that clamp the second carrier to the webs from behind."""
    return tuple(
        screw_part(
            "web_screw",
            WEB_SCREW,
            head="countersunk",
            seat_mm=at.z_secondary_back,
            grip_mm=settings.parts.carrier.secondary_thickness_mm,
            room_mm=_WEB_THREAD_MM,
            direction=1.0,
            material=settings.materials.steel,
            holes=holes,
            group=Group.OUTPUT,
            note="clamps the secondary carrier to a web",
        )
        for holes in _web_holes(at, WEB_SCREW.hole)
    )
