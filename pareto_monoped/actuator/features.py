"""Building blocks of an actuator's parts: slabs, hole patterns, gears, coupling, bearings, encoder, notes.

The encoder's sensor, RLS's RM08 (data sheet RM08D01), has a sealed body of 8 mm diameter and 7 mm length. It reads a
magnet of 4 x 4 mm in the end of the motor's shaft, magnetised across, over a gap of 1 mm within 0.5 mm: 12 bit per turn
of the motor, up to 30,000 rpm. It is bonded into a cap, which is bonded into the backplate's bore once the gap is set.
At the knee, sensor and cable stand in the journal's bore.
"""

from functools import partial
from typing import Any

import numpy as np

from pareto_monoped.actuator.bearings import Bearing, bearing_width, ordered_bearing
from pareto_monoped.actuator.layout import (
    COUPLING_DOWEL,
    NECK_NOTE,
    THIN_WALL_MM,
    Layout,
    SunNeck,
    hub_note,
    shoulder_note,
    spline_note,
)
from pareto_monoped.actuator.motor import Motor
from pareto_monoped.actuator.rating.load import runout_um
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.dowels import Dowel, dowel_part
from pareto_monoped.geometry.features import CENTRE_MM, Hole, Mouth, tap_run_out_mm
from pareto_monoped.geometry.gears import ExternalGear, InternalGear, active_diameters_mm
from pareto_monoped.geometry.making import RELIEF_MM, Fit, ToothMaking, wider
from pareto_monoped.geometry.parts import Part, Prism, steel_part, strong_part
from pareto_monoped.geometry.roles import EPOXY, RETAINER, Group, Joint, JointKind, Purchase, Role, Visibility
from pareto_monoped.geometry.screws import M3, screw_part
from pareto_monoped.geometry.shapes import Circle, Numbers, Pattern, Shape
from pareto_monoped.materials import ALLOYS, MATERIALS, GearGrade, Material

SPIGOT_MM = 1.5
"""Height of the backplate's step that centres it in the casing; our own choice."""
END_PLAY_MM = 0.5
"""From the end of the sun's shaft to the output face; our own choice."""
MOTOR_CLEARANCE_HOLE_MM = 0.5
"""Clearance hole less screw diameter for the motor's mounting pattern (ISO 273, medium, M4 and M5)."""
_BESIDE_MM = 0.05
"""From the casing's thinner wall to the tapped holes above it; our own choice."""
MOTOR_TAPPED_HOLE_MM = -0.8
"""Tapping hole less thread diameter for the motor's mounting pattern (ISO 2306: 4.2 mm for M5)."""


def gear_part(settings: ActuatorSettings, steel: GearGrade) -> "partial[Part]":
    """Return what makes the part of a gear; the rules of the paper name neither its steel nor its accuracy."""
    rated = settings.rules != "paper"
    return partial(
        Part,
        role=Role.GEAR,
        visibility=Visibility.INSIDE,
        material=settings.materials.gear_steel,
        process="machined",
        grade=steel if rated else None,
        accuracy_class=settings.parts.rating.accuracy_class if rated else None,
    )


def sun_part(
    at: Layout,
    neck: SunNeck,
    settings: ActuatorSettings,
    spline: ExternalGear,
    shaft_mm: float,
    *,
    behind: tuple[Prism, ...],
    seat_mm: float,
    rear: Hole,
) -> Part:
    """Build the sun in one piece with its splined shaft, whose prisms ``behind`` the teeth depend on the family.

    It is ground between centres, of which ``rear`` is one, on its journal and on a seat behind.
    """
    teeth, steel = at.gears.sun(), settings.gear_steels.sun
    relief, depth = RELIEF_MM
    front = centre_hole(-END_PLAY_MM, -1.0)
    return gear_part(settings, steel)(
        name="sun",
        prisms=(
            *slab(front.low_mm, -END_PLAY_MM, neck.r_journal, *front.shapes),
            *slab(neck.z + relief, front.low_mm, neck.r_journal),
            *slab(neck.z, neck.z + relief, neck.r_journal - depth),
            *slab(at.z_gear_front, neck.z, neck.r),
            *slab(at.z_gear_back, at.z_gear_front, teeth),
            *behind,
        ),
        group=Group.ROTOR,
        teeth=made(
            rated_teeth(at.gears.sun(), steel, settings, at.gears.planet(), centre_mm=at.r_pins),
            spline_teeth(spline, settings),
        ),
        fits=tuple(Fit(diameter_mm=2.0 * radius, zone="h6", seat=True) for radius in (neck.r_journal, seat_mm)),
        features=(front, rear),
        note=f"one piece with its shaft, {spline_note(spline, shaft_mm)}; ground between centres, reliefs E 0.2 x 0.1 "
        f"(DIN 509); {shoulder_note(teeth, neck.r, seat_mm)}{NECK_NOTE}; {gear_note(teeth, settings)}",
        joint=Joint(kind=JointKind.BONDED, how="splined and bonded into", partner="coupling", adhesive=RETAINER),
    )


def coupling_part(
    prisms: tuple[Prism, ...], spline: ExternalGear, screws: Hole, screwed_to: str, settings: ActuatorSettings
) -> Part:
    """Build the coupling between motor and sun."""
    return strong_part(
        name="coupling",
        role=Role.COUPLING,
        visibility=Visibility.INSIDE,
        material=settings.materials.aluminium,
        prisms=prisms,
        group=Group.ROTOR,
        teeth=(spline_teeth(spline, settings),),
        fits=(COUPLING_DOWEL.hole_fit,),
        lengths=(wider("height", prisms[-1].z0_mm, prisms[0].z1_mm),),
        features=(screws,),
        note=f"screwed to the {screwed_to}; bore {hub_note(settings)}",
    )


def coupling_dowels(holes: Pattern, end_mm: Numbers, room_mm: Numbers, reamed: str, settings: ActuatorSettings) -> Part:
    """Build the dowels through the coupling into what turns it."""
    return dowel_part(
        "coupling_dowel",
        COUPLING_DOWEL,
        end_mm=end_mm,
        room_mm=room_mm,
        direction=1.0,
        material=settings.materials.steel,
        holes=holes,
        group=Group.ROTOR,
        partner="coupling",
        note=f"drill and ream the {reamed} through the coupling, which is the jig",
    )


def gear_note(gear: ExternalGear | InternalGear, settings: ActuatorSettings) -> str:
    """Return a gear's note; '' for arrays. Wire-cutting after hardening would take a hard case off."""
    if np.ndim(gear.teeth):
        return ""
    shift = f"profile shift {gear.shift * gear.module_mm:+.3f} mm (outwards), " if gear.shift else ""
    making = "; hardened steel, wire-cut" if settings.rules == "paper" else ""
    return (
        f"{gear.teeth:g} teeth, module {gear.module_mm:g} mm, 20 degrees, {shift}"
        f"tooth thinned by {gear.backlash_mm:g} mm{making}"
    )


_NUMBER = (float, int, np.ndarray)


def slab(z0_mm: Numbers, z1_mm: Numbers, outline: Numbers | Shape, *holes: Numbers | Shape) -> tuple[Prism, ...]:
    """Build one prism from radii or shapes; none if a single slab has no height, which arrays keep."""
    if _is_single(z0_mm) and _is_single(z1_mm) and float(z1_mm) - float(z0_mm) < 1e-9:
        return ()
    shapes = tuple(Circle(radius_mm=hole) if isinstance(hole, _NUMBER) else hole for hole in holes)
    disc = Circle(radius_mm=outline) if isinstance(outline, _NUMBER) else outline
    return (Prism(outline=disc, z0_mm=z0_mm, z1_mm=z1_mm, holes=shapes),)


def tube(z0_mm: Numbers, z1_mm: Numbers, outer_mm: Numbers, inner_mm: Numbers, *holes: Shape) -> tuple[Prism, ...]:
    """Build a slab with a central bore; none if a single tube has no wall."""
    if _is_single(outer_mm) and _is_single(inner_mm) and float(outer_mm) - float(inner_mm) < 1e-9:
        return ()
    return slab(z0_mm, z1_mm, outer_mm, inner_mm, *holes)


def _is_single(value: Numbers) -> bool:
    """Return ``np.ndim(value) == 0``, which takes ten times as long for a float; a map asks it five thousand times."""
    return getattr(value, "ndim", 0) == 0


def output_holes(settings: ActuatorSettings) -> Pattern:
    """Return the bolt pattern of the output flange."""
    data = settings.parts.interface
    return Pattern(radius_mm=M3.core, pitch_radius_mm=0.5 * data.output_bolt_circle_mm, count=data.output_bolt_count)


def output_dowel_holes(settings: ActuatorSettings) -> Pattern:
    """Return the holes for dowels in the output flange, in every second gap of its bolts."""
    return Dowel(diameter_mm=settings.parts.interface.output_dowel_mm).between(output_holes(settings), every=2)


def casing_dowel_holes(at: Layout, settings: ActuatorSettings) -> Pattern:
    """Return the holes for dowels in the mounting face, in every gap of its bolts."""
    return Dowel(diameter_mm=settings.parts.interface.mount_dowel_mm).between(casing_holes(at, settings))


def casing_holes(at: Layout, settings: ActuatorSettings, radius_mm: float | None = None) -> Pattern:
    """Return the bolt pattern of the mounting face, and of the backplate on the casing; by default for threads."""
    radius_mm = M3.core if radius_mm is None else radius_mm
    return Pattern(radius_mm=radius_mm, pitch_radius_mm=at.r_bolts, count=settings.parts.interface.mount_bolt_count)


def housing_screw(name: str, settings: ActuatorSettings, **own: Any) -> Part:
    """Build the screws of a joint of the housing; ``own`` is as for ``screw_part``."""
    room_mm, steel = settings.parts.casing.flange_mm, settings.materials.steel
    return screw_part(name, M3, room_mm=room_mm, material=steel, group=Group.HOUSING, **own)


def backplate_screw(at: Layout, z_end_mm: Numbers, grip_mm: float, settings: ActuatorSettings) -> Part:
    """Build the screws of the backplate."""
    return housing_screw(
        "backplate_screw",
        settings,
        head="cap",
        seat_mm=z_end_mm,
        grip_mm=grip_mm,
        direction=1.0,
        holes=casing_holes(at, settings),
        note="into the casing",
    )


# The envelopes of a motor, whose parts are one.
stator_part = partial(
    Part,
    name="motor_stator",
    role=Role.MOTOR_STATOR,
    visibility=Visibility.INSIDE,
    process="bought",
    group=Group.HOUSING,
)
rotor_part = partial(Part, name="motor_rotor", role=Role.MOTOR_ROTOR, process="bought", group=Group.ROTOR)


def skirt(
    low_mm: Numbers, high_mm: Numbers, at: Layout, settings: ActuatorSettings, threads_mm: Numbers
) -> tuple[Prism, ...]:
    """Build the casing's wall from its flange up to threads on a circle of radius ``threads_mm``.

    Threads at either end stand half above the wall. There it is turned thinner, so that their taps run out.
    """
    wall, run_out = at.r_casing + settings.parts.casing.wall_mm, tap_run_out_mm(M3.thread.pitch_mm)

    def beside(radius_mm: Numbers) -> Numbers:
        thin = np.clip(radius_mm - M3.core - _BESIDE_MM, at.r_casing + THIN_WALL_MM, wall)
        return np.where(radius_mm > at.r_casing, thin, wall)[()]

    return (
        *tube(low_mm, low_mm + run_out, beside(at.r_bolts), at.r_casing),
        *tube(low_mm + run_out, high_mm - run_out, wall, at.r_casing),
        *tube(high_mm - run_out, high_mm, beside(threads_mm), at.r_casing),
    )


def motor_holes(motor: Motor, play_mm: float) -> Pattern:
    """Return the motor's mounting pattern; ``play_mm`` is hole less screw diameter."""
    holes = motor.mount_holes
    assert holes is not None
    return Pattern(
        radius_mm=0.5 * (holes.diameter_mm + play_mm), pitch_radius_mm=0.5 * holes.pitch_circle_mm, count=holes.count
    )


def spigot(z_plate_mm: Numbers, at: Layout, settings: ActuatorSettings) -> tuple[Prism, ...]:
    """Build the backplate's step that centres it in the casing."""
    return tube(z_plate_mm, z_plate_mm + SPIGOT_MM, at.r_casing, at.r_casing - settings.parts.casing.vent_wall_mm)


def bought_bearing(
    name: str,
    material: Material,
    bearing: Bearing,
    z_front_mm: Numbers,
    group: Group,
    note: str,
    joint: Joint | None = None,
) -> Part:
    """Build a ball bearing as the ring it fills, with its catalogue mass."""
    inner, outer = 0.5 * bearing.inner_diameter_mm, 0.5 * bearing.outer_diameter_mm
    return steel_part(
        name=name,
        role=Role.BEARING,
        visibility=Visibility.INSIDE,
        material=material,
        prisms=tube(z_front_mm - bearing.width_mm, z_front_mm, outer, inner),
        lengths=(bearing_width(bearing, z_front_mm),),
        group=group,
        catalogue_mass_kg=bearing.mass_kg,
        purchases=ordered_bearing(bearing.inner_diameter_mm),
        note=note,
        joint=joint,
    )


housing_part = partial(Part, role=Role.HOUSING, process="machined", group=Group.HOUSING, grade=ALLOYS["aw_6082_t6"])
"""Builds a part of the housing, of the alloy that all of them are made of."""
BODY_RADIUS_MM, _BODY_MM = 4.0, 7.0
MAGNET_RADIUS_MM, MAGNET_MM = 2.0, 4.0
_GAP_MM = 1.0
_BODY_KG = 0.002
"""Body and 0.3 m of its cable; our own estimate, the data sheet gives none."""
_CENTRE_EDGE_MM = 0.5
"""Width of the centre around the magnet's bore; our own choice."""
_CAP_MM = 1.5
"""Thickness of the cap: 0.5 mm from the inner ring of an ISSPG's rear bearing; our own choice."""


def encoder_parts(z_shaft_mm: Numbers, z_back_mm: Numbers, bore_mm: Numbers, shaft: str) -> tuple[Part, ...]:
    """Build magnet, sensor and cap; ``shaft`` is the part whose end takes the magnet, see ``shaft_end``."""
    z_sensor = z_shaft_mm - _GAP_MM
    return (
        Part(
            name="encoder_magnet",
            role=Role.ELECTRONICS,
            visibility=Visibility.INSIDE,
            material=MATERIALS.magnet,
            prisms=slab(z_shaft_mm, z_shaft_mm + MAGNET_MM, MAGNET_RADIUS_MM),
            process="bought",
            group=Group.ROTOR,
            purchases=(
                Purchase(
                    kind="magnet",
                    designation=f"magnet {2.0 * MAGNET_RADIUS_MM:g} x {MAGNET_MM:g} mm, SmCo, "
                    "magnetised across its axis",
                    alternatives=("RLS RMM44A2C00",),
                ),
            ),
            joint=Joint(kind=JointKind.BONDED, how="bonded into", partner=shaft, adhesive=EPOXY),
        ),
        Part(
            name="encoder",
            role=Role.ELECTRONICS,
            visibility=Visibility.DETAIL,
            material=MATERIALS.electronics,
            prisms=slab(z_sensor - _BODY_MM, z_sensor, BODY_RADIUS_MM),
            process="bought",
            group=Group.HOUSING,
            catalogue_mass_kg=_BODY_KG,
            purchases=(
                Purchase(kind="encoder", designation="RLS RM08, 12 bit", remark="output A, B, Z; supply of the driver"),
            ),
            note=(gap := f"{_GAP_MM:g} mm from the magnet, within 0.5 mm"),
            at_assembly=f"bond it so deep in its cap that it is {gap}, with the backplate on",
            joint=Joint(kind=JointKind.BONDED, how="bonded into", partner="encoder_cap", adhesive=EPOXY, first=True),
        ),
        housing_part(
            name="encoder_cap",
            visibility=Visibility.INSIDE,
            material=MATERIALS.aluminium,
            prisms=tube(z_back_mm, z_back_mm + _CAP_MM, bore_mm, BODY_RADIUS_MM),
            registers=(Fit(diameter_mm=2.0 * bore_mm, zone="g6"), Fit(diameter_mm=2.0 * BODY_RADIUS_MM, zone="F7")),
            note="flush with the backplate",
            joint=Joint(kind=JointKind.BONDED, how="bonded into", partner="backplate", adhesive=EPOXY),
        ),
    )


def shaft_end(z0_mm: Numbers, z1_mm: Numbers, radius_mm: Numbers) -> tuple[Prism, ...]:
    """Build a shaft whose lower end at ``z0_mm`` has a bore for the magnet."""
    split = np.minimum(z0_mm + MAGNET_MM, z1_mm)[()]
    return (*tube(z0_mm, split, radius_mm, MAGNET_RADIUS_MM), *slab(split, z1_mm, radius_mm))


def centre_hole(face_mm: Numbers, inwards: float) -> Hole:
    """Return the centre hole in a shaft's end (DIN 332-1, A 1 x 2.12); ``inwards`` is 1 above the face."""
    radius, edge, depth = CENTRE_MM
    end, mouth = face_mm + inwards * depth, Mouth.of_centre(edge, radius)
    return Hole(
        shapes=(Circle(radius_mm=radius),),
        low_mm=np.minimum(face_mm, end)[()],
        high_mm=np.maximum(face_mm, end)[()],
        low=mouth if inwards > 0.0 else None,
        high=mouth if inwards < 0.0 else None,
    )


def magnet_centre(z_end_mm: Numbers) -> Hole:
    """Return the bore of the magnet in a shaft's lower end, whose mouth is a centre."""
    edge = MAGNET_RADIUS_MM + _CENTRE_EDGE_MM
    return Hole(
        shapes=(Circle(radius_mm=MAGNET_RADIUS_MM),),
        low_mm=z_end_mm,
        high_mm=z_end_mm + MAGNET_MM,
        low=Mouth.of_centre(edge, MAGNET_RADIUS_MM),
    )


def seat_between(low_mm: Numbers, high_mm: Numbers, radius_mm: float) -> tuple[Prism, ...]:
    """Build a ground seat between two shoulders, with a relief beside each."""
    relief, depth = RELIEF_MM
    return (
        *slab(low_mm, low_mm + relief, radius_mm - depth),
        *slab(low_mm + relief, high_mm - relief, radius_mm),
        *slab(high_mm - relief, high_mm, radius_mm - depth),
    )


SPLINE_CLASS = 8
"""ISO 1328-1 class of splines; our own choice: they are bonded and do not roll."""


def rated_teeth(
    gear: ExternalGear | InternalGear,
    steel: GearGrade,
    settings: ActuatorSettings,
    *mates: ExternalGear | InternalGear,
    centre_mm: Numbers,
    crowning_um: float = 0.0,
) -> ToothMaking | None:
    """Return how a rated gear is made, and its mates, whose axes are ``centre_mm`` away.

    None under the rules of the paper, and for arrays.
    """
    if settings.rules == "paper" or np.ndim(gear.teeth):
        return None
    data, module = settings.parts.rating, float(gear.module_mm)
    low, high = steel.layer_modules or (0.0, 0.0)
    runout = runout_um(2.0 * float(gear.pitch_radius_mm), module, data.accuracy_class)
    return ToothMaking(
        teeth=int(gear.teeth),
        module_mm=module,
        accuracy_class=data.accuracy_class,
        making=steel.making,
        mates_mm=tuple(2.0 * float(mate.pitch_radius_mm) for mate in mates),
        quality=steel.quality,
        core_hardness=steel.core_hardness,
        layer=steel.layer,
        layer_mm=(
            float(np.ceil(100.0 * low * module - 1e-9)) / 100.0,
            float(np.floor(100.0 * high * module + 1e-9)) / 100.0,
        ),
        flank_rz_um=data.flank_roughness_um,
        root_rz_um=data.root_roughness_um,
        runout_mm=1e-3 * float(np.floor(runout)),
        active_mm=active_diameters_mm(gear, mates, float(centre_mm)),
        crowning_um=crowning_um,
    )


def spline_teeth(spline: ExternalGear, settings: ActuatorSettings) -> ToothMaking:
    """Return how a spline is made, on the shaft and in the hub."""
    return ToothMaking(
        teeth=int(spline.teeth),
        module_mm=float(spline.module_mm),
        accuracy_class=SPLINE_CLASS,
        making="hobbed; hub wire-cut to fit",
        mates_mm=(2.0 * float(spline.pitch_radius_mm),),
        play_mm=settings.parts.spline.play_mm,
    )


def made(*teeth: ToothMaking | None) -> tuple[ToothMaking, ...]:
    """Return those that are known."""
    return tuple(one for one in teeth if one is not None)
