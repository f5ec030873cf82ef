"""Parts that both families share: gears, carriers, pins, bearings at the front."""

import numpy as np

from pareto_monoped.actuator.bearings import Bearing
from pareto_monoped.actuator.layout import RETAINING_RING_MM, Layout
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.gears import DEDENDUM
from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Group, Joint, JointKind, Role, Visibility
from pareto_monoped.geometry.screws import M3, screw_part
from pareto_monoped.geometry.shapes import Circle, Numbers, Pattern, Shape
from pareto_monoped.materials import Material

GEAR_NOTE = "{} teeth, module {} mm, 20 degrees, tooth thinned by {} mm; hardened steel, wire-cut"
M3_THREAD_MM = M3.core
"""Radius of a tapping hole for M3 (2.5 mm)."""
M3_CLEARANCE_MM = M3.hole
"""Radius of a clearance hole for M3, fine (ISO 273: 3.2 mm)."""
BUSH_PLAY_MM = 0.2
"""Between the ends of a planet's bush and the carriers: the bush stands out of the planet and holds it in its place."""
PIN_THREAD_MM = 6.0
"""Of the screw in a planet pin: twice the diameter of M3; its hole is 2 mm deeper."""
SPIGOT_MM = 1.5
"""Height of the steps that centre one piece of the housing in another."""
RING_GROOVE_MM = 1.0
"""Depth of a retaining ring's groove: DIN 471 and DIN 472 have 1.0 to 1.5 mm in the range used."""


def told(text: str, *numbers: Numbers) -> str:
    """A note with numbers filled in; empty for arrays of actuators, whose notes nobody reads."""
    if any(np.ndim(number) for number in numbers):
        return ""
    return text.format(*(f"{float(number):g}" for number in numbers))


def slab(z0_mm: Numbers, z1_mm: Numbers, outline: Numbers | Shape, *holes: Numbers | Shape) -> tuple[Prism, ...]:
    """One prism between two heights, lower first, from radii or shapes; none if the one described has no height.

    Of an array nothing is left out: a prism without height weighs nothing.
    """
    if np.ndim(z0_mm) == 0 and np.ndim(z1_mm) == 0 and float(z1_mm) - float(z0_mm) < 1e-9:
        return ()
    shapes = tuple(Circle(radius_mm=hole) if isinstance(hole, float | int | np.ndarray) else hole for hole in holes)
    disc = Circle(radius_mm=outline) if isinstance(outline, float | int | np.ndarray) else outline
    return (Prism(outline=disc, z0_mm=z0_mm, z1_mm=z1_mm, holes=shapes),)


def tube(z0_mm: Numbers, z1_mm: Numbers, outer_mm: Numbers, inner_mm: Numbers, *holes: Shape) -> tuple[Prism, ...]:
    """As ``slab``, for a ring; none if the one described has no wall."""
    if np.ndim(outer_mm) == 0 and np.ndim(inner_mm) == 0 and float(outer_mm) - float(inner_mm) < 1e-9:
        return ()
    return slab(z0_mm, z1_mm, outer_mm, inner_mm, *holes)


def output_holes(settings: ActuatorSettings, radius_mm: float = M3_THREAD_MM) -> Pattern:
    """Bolt pattern of the output flange."""
    data = settings.parts.interface
    return Pattern(radius_mm=radius_mm, pitch_radius_mm=0.5 * data.output_bolt_circle_mm, count=data.output_bolt_count)


def case_holes(at: Layout, settings: ActuatorSettings, radius_mm: float = M3_THREAD_MM) -> Pattern:
    """Bolt pattern of the housing's face towards what carries it, and of the backplate."""
    return Pattern(radius_mm=radius_mm, pitch_radius_mm=at.r_bolts, count=settings.parts.interface.mount_bolt_count)


def vents(inner_mm: Numbers, outer_mm: Numbers, wall_mm: float) -> tuple[Pattern, ...]:
    """As many round holes as fit between two radii, with ``wall_mm`` around each; none if they would be too small."""
    radius, middle = 0.5 * (outer_mm - inner_mm) - wall_mm, 0.5 * (outer_mm + inner_mm)
    count = np.floor(np.pi / np.arcsin(np.clip((radius + wall_mm) / middle, 0.01, 1.0)))
    count = np.where(radius >= M3_CLEARANCE_MM, count, 0.0)[()]
    if np.ndim(count) == 0 and count == 0.0:
        return ()
    return (Pattern(radius_mm=radius, pitch_radius_mm=middle, count=count),)


def spigot(z_plate_mm: Numbers, at: Layout, settings: ActuatorSettings) -> tuple[Prism, ...]:
    """The backplate's step that centres it in the casing."""
    return tube(z_plate_mm, z_plate_mm + SPIGOT_MM, at.r_case, at.r_case - settings.parts.case.vent_wall_mm)


def bought_bearing(
    name: str,
    material: Material,
    bearing: Bearing,
    z_front_mm: Numbers,
    group: Group,
    note: str,
    joint: Joint | None = None,
) -> Part:
    """A ball bearing as the ring it fills, with its catalogue mass."""
    inner, outer = 0.5 * bearing.inner_diameter_mm, 0.5 * bearing.outer_diameter_mm
    return Part(
        name=name,
        role=Role.BEARING,
        visibility=Visibility.INSIDE,
        material=material,
        prisms=tube(z_front_mm - bearing.width_mm, z_front_mm, outer, inner),
        process="bought",
        group=group,
        catalogue_mass_kg=bearing.mass_kg,
        note=told(
            "{} x {} x {} mm (ISO 15), " + note, bearing.inner_diameter_mm, bearing.outer_diameter_mm, bearing.width_mm
        ),
        joint=joint,
    )


def planet_prisms(at: Layout, settings: ActuatorSettings) -> tuple[Prism, ...]:
    """A planet: recessed on both faces between hub and rim where there is room for it.

    The rim keeps 1.2 tooth depths (AGMA 2001-D04), the web a share of the face width, which is usual for turned blanks.
    """
    data = settings.parts.gears
    gears = at.gears
    shape = gears.planet(data.backlash_mm)
    bore = 0.5 * data.planet_bore_mm
    hub = bore + data.planet_hub_wall_mm
    rim = shape.root_radius_mm - 1.2 * (1.0 + DEDENDUM) * gears.module_mm
    recessed = rim - hub >= data.planet_recess_min_mm
    low, high = at.z_gear_back, at.z_gear_front
    if np.ndim(recessed) == 0 and not recessed:
        return slab(low, high, shape, bore)
    rim = np.where(recessed, rim, hub)[()]
    depth = 0.5 * (1.0 - data.planet_web_share) * at.face_width_mm
    return (
        *slab(low, low + depth, shape, rim),
        *tube(low, low + depth, hub, bore),
        *slab(low + depth, high - depth, shape, bore),
        *slab(high - depth, high, shape, rim),
        *tube(high - depth, high, hub, bore),
    )


def gear_parts(at: Layout, settings: ActuatorSettings) -> tuple[Part, ...]:
    """Planets with bushes, pins and the pins' screws, ring."""
    data, materials = settings.parts, settings.materials
    carrier, gears = data.carrier, at.gears
    pin = 0.5 * carrier.pin_diameter_mm
    pin_low = at.z_secondary_front - carrier.pin_depth_mm
    pin_front = z_pin_front(carrier.thread_depth_mm, carrier.diaphragm_mm)
    stands_out = carrier.planet_clearance_mm - BUSH_PLAY_MM
    return (
        Part(
            name="planet",
            role=Role.GEAR,
            visibility=Visibility.INSIDE,
            material=materials.gear_steel,
            prisms=planet_prisms(at, settings),
            process="machined",
            group=Group.PLANET,
            note=told(GEAR_NOTE, gears.planet_teeth, gears.module_mm, data.gears.backlash_mm),
            joint=Joint(kind=JointKind.PRESSED, how="pressed onto", partner="planet_bush"),
            count=gears.planets,
            pitch_radius_mm=at.r_pins,
        ),
        Part(
            name="planet_bush",
            role=Role.BUSH,
            visibility=Visibility.INSIDE,
            material=materials.bush_bronze,
            prisms=tube(
                at.z_gear_back - stands_out, at.z_gear_front + stands_out, 0.5 * data.gears.planet_bore_mm, pin
            ),
            process="bought",
            group=Group.PLANET,
            note=f"PTFE bronze bush, {stands_out:g} mm longer than the planet on either side",
            count=gears.planets,
            pitch_radius_mm=at.r_pins,
        ),
        Part(
            name="planet_pin",
            role=Role.PIN,
            visibility=Visibility.INSIDE,
            material=materials.steel,
            prisms=(
                *slab(pin_low, pin_low + PIN_THREAD_MM + 2.0, pin, M3_THREAD_MM),
                *slab(pin_low + PIN_THREAD_MM + 2.0, pin_front, pin),
            ),
            process="machined",
            group=Group.OUTPUT,
            note="hardened dowel, M3 thread in the rear end",
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
            room_mm=PIN_THREAD_MM,
            direction=1.0,
            material=materials.steel,
            count=gears.planets,
            pitch_radius_mm=at.r_pins,
            group=Group.OUTPUT,
            note="holds the secondary carrier on its pin",
        ),
        Part(
            name="ring",
            role=Role.GEAR,
            visibility=Visibility.INSIDE,
            material=materials.gear_steel,
            prisms=slab(at.z_gear_back, at.z_gear_front, at.r_ring, gears.ring(data.gears.backlash_mm)),
            process="machined",
            group=Group.HOUSING,
            note=told(GEAR_NOTE, gears.ring_teeth, gears.module_mm, data.gears.backlash_mm),
            joint=Joint(kind=JointKind.BONDED, how="bonded into", partner="ring_housing"),
        ),
    )


def z_pin_front(thread_depth_mm: float, diaphragm_mm: float) -> float:
    """Height of the pins' front ends: behind the carrier's diaphragm."""
    return -(thread_depth_mm + diaphragm_mm)


def carrier_parts(at: Layout, settings: ActuatorSettings) -> tuple[Part, ...]:
    """Carrier with output flange, retaining ring, main and end bearing, secondary carrier."""
    data, materials = settings.parts, settings.materials
    carrier = data.carrier
    threads = output_holes(settings)
    z_diaphragm = -carrier.thread_depth_mm
    z_pins = z_pin_front(carrier.thread_depth_mm, carrier.diaphragm_mm)
    pins = Pattern(radius_mm=0.5 * carrier.pin_diameter_mm, pitch_radius_mm=at.r_pins, count=at.gears.planets)
    screws = Pattern(radius_mm=M3_CLEARANCE_MM, pitch_radius_mm=at.r_pins, count=at.gears.planets)
    seat = 0.5 * at.end_bearing.outer_diameter_mm
    z_ring = at.z_bearing_front + RETAINING_RING_MM
    z_split = at.z_secondary_front - carrier.pin_depth_mm
    r_groove = at.r_bore - RING_GROOVE_MM
    body = (
        *slab(-carrier.flange_thickness_mm, 0.0, carrier.flange_radius_mm, seat, threads),
        *slab(z_ring, -carrier.flange_thickness_mm, at.r_bore, seat, threads),
        *slab(z_diaphragm, z_ring, r_groove, seat, threads),
        *slab(at.z_bearing_front, z_diaphragm, r_groove, seat - data.case.lip_mm),
        *slab(z_pins, at.z_bearing_front, at.r_bore, seat - data.case.lip_mm),
        *slab(at.z_bearing_back, z_pins, at.r_bore, at.r_carrier_in, pins),
        *slab(at.z_shoulder, at.z_bearing_back, at.r_bore + carrier.shoulder_height_mm, at.r_carrier_in, pins),
    )
    return (
        Part(
            name="carrier",
            role=Role.CARRIER,
            material=materials.aluminium,
            prisms=body,
            process="machined",
            group=Group.OUTPUT,
            note=told(
                "EN AW-7075; seats {} h6 for the main bearing, {} J7 for the end bearing; bores {} H7 for the pins",
                2.0 * at.r_bore,
                2.0 * seat,
                carrier.pin_diameter_mm,
            ),
        ),
        Part(
            name="secondary_carrier",
            role=Role.CARRIER,
            visibility=Visibility.INSIDE,
            material=materials.aluminium,
            prisms=(
                *slab(z_split, at.z_secondary_front, at.r_secondary_out, at.r_secondary_in, pins),
                *slab(at.z_secondary_back, z_split, at.r_secondary_out, at.r_secondary_in, screws),
            ),
            process="machined",
            group=Group.OUTPUT,
            note=told("EN AW-7075; bores {} H7 for the pins; countersink the back", carrier.pin_diameter_mm),
        ),
        Part(
            name="retaining_ring",
            role=Role.RETAINING_RING,
            visibility=Visibility.INSIDE,
            material=materials.steel,
            prisms=tube(at.z_bearing_front, z_ring, at.r_bore + 2.0, r_groove),
            process="bought",
            group=Group.OUTPUT,
            note=told("DIN 471 for {} mm, in the carrier's groove before the main bearing", 2.0 * at.r_bore),
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
        ),
    )
