"""Radii and heights that both families have in common, for one gear set or for arrays of them.

Actuator frame: z is the gearbox axis. The housing is bolted to what carries it by its face at z = 0. The output flange
is flush with this face and points to +z; everything lies at z <= 0. From the front:

    output flange, main bearing around the carrier | planets between sun and ring | secondary carrier | coupling, motor

In the ISSPG, the stator sits on the ring housing around the gears. In the ESSPG, the motor follows behind them.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from pareto_monoped.actuator.bearings import Bearing, main_bearing, small_bearing
from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.motors import AIR_GAP_MM, Motor
from pareto_monoped.actuator.retaining_rings import RetainingRing, retaining_ring
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.actuator.webs import Webs, webs_of
from pareto_monoped.geometry.shapes import Numbers

Family = Literal["ISSPG", "ESSPG"]
FAMILIES: tuple[Family, ...] = ("ISSPG", "ESSPG")

SHAFT_GROOVE_WALL_MM = 0.75
"""What is left of the carrier in front of a retaining ring's groove; our own choice. The rings keep the bearing in its
place and carry no load of the leg. 1 kN along the axis bends the walls of a 50 mm shaft and a 65 mm bore with 54 and
59 MPa."""
BORE_GROOVE_WALL_MM = 0.6
"""The same of the ring housing, behind the other ring's groove; our own choice."""
_PLANET_TO_SEAT_MM = 0.2
"""From that wall to the planets, which turn past it; our own choice."""
END_BEARING_BORE_MM = 6.0
"""Bore of the bearing that carries the sun's end in the carrier; our own choice."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Layout:
    """What the parts of both families have in common, in mm; r are radii, z are heights and negative."""

    gears: GearSet
    face_width_mm: Numbers
    bearing: Bearing
    end_bearing: Bearing
    rear_bearing: Bearing
    shaft_ring: RetainingRing  # in the carrier, before the main bearing
    bore_ring: RetainingRing  # in the ring housing of the ESSPG, behind the main bearing
    webs: Webs
    # Radii.
    r_plate: float
    r_casing: float
    r_bolts: float
    r_motor: float
    r_stator_in: float
    r_stator_out: float
    r_rotor_in: float
    r_bore: Numbers
    r_seat: Numbers
    r_open: Numbers
    r_pins: Numbers
    r_ring: Numbers
    r_carrier_in: Numbers
    r_secondary_in: Numbers
    r_secondary_out: Numbers
    # Heights, from the front.
    z_bearing_front: Numbers
    z_bearing_back: Numbers
    z_shoulder: Numbers
    z_gear_front: Numbers
    z_gear_back: Numbers
    z_secondary_front: Numbers
    z_secondary_back: Numbers


def radial_room_mm(motor: Motor, family: Family, settings: ActuatorSettings) -> float:
    """D_GB, the largest diameter of the gearbox (paper, after eq. 5)."""
    if family == "ISSPG":
        assert motor.frameless is not None
        return motor.frameless.stator_inner_diameter_mm - settings.diameter_clearance_mm
    assert motor.framed is not None
    return motor.framed.outer_diameter_mm - settings.diameter_clearance_mm


def ring_radius_mm(gears: GearSet, family: Family, settings: ActuatorSettings) -> Numbers:
    """Outer radius of the ring gear: fixed beyond the pitch circle (``paper``), or a rim that grows with the module."""
    data = settings.parts.gears
    if settings.rules == "iso6336":
        return gears.ring_root_radius_mm + data.ring_rim_modules * gears.module_mm
    return gears.ring_pitch_radius_mm + (
        data.ring_width_internal_mm if family == "ISSPG" else data.ring_width_external_mm
    )


def layout(motor: Motor, family: Family, gears: GearSet, face_width_mm: Numbers, settings: ActuatorSettings) -> Layout:
    """The common layout of an actuator."""
    data = settings.parts
    carrier, casing = data.carrier, data.casing
    r_pins = gears.carrier_radius_mm
    least_bore = np.maximum(
        2.0 * r_pins + carrier.bearing_clearance_mm, 2.0 * carrier.flange_radius_mm + carrier.flange_clearance_mm
    )
    bearing = main_bearing(least_bore, settings.bearings)
    body = motor.frameless if family == "ISSPG" else motor.framed
    assert body is not None
    r_motor = 0.5 * body.outer_diameter_mm
    stator_in, stator_out = motor.stator_diameters_mm
    r_ring = ring_radius_mm(gears, family, settings)
    if family == "ESSPG" and settings.rules == "iso6336":
        # The main bearing passes through the ring's shoulder.
        r_ring = np.maximum(r_ring, 0.5 * bearing.outer_diameter_mm + casing.ring_lip_mm)
    shaft_ring = retaining_ring("DIN 471", bearing.inner_diameter_mm)
    bore_ring = retaining_ring("DIN 472", bearing.outer_diameter_mm)
    z_bearing_front = -(carrier.flange_thickness_mm + SHAFT_GROOVE_WALL_MM + shaft_ring.thickness_mm)
    z_bearing_back = z_bearing_front - bearing.width_mm
    shoulder_mm: Numbers = carrier.shoulder_thickness_mm
    if family == "ESSPG":
        # The ring behind the bearing, and the wall behind its groove, end before the gears begin.
        room_mm = bore_ring.thickness_mm + BORE_GROOVE_WALL_MM + _PLANET_TO_SEAT_MM
        shoulder_mm = np.maximum(shoulder_mm, room_mm - settings.planet_clearance_mm)
    z_shoulder = z_bearing_back - shoulder_mm
    z_gear_front = z_shoulder - settings.planet_clearance_mm
    z_gear_back = z_gear_front - face_width_mm
    z_secondary_front = z_gear_back - settings.planet_clearance_mm
    webs = webs_of(gears, settings)
    pin_reach = 0.5 * carrier.pin_diameter_mm + carrier.pin_wall_mm
    return Layout(
        gears=gears,
        face_width_mm=face_width_mm,
        bearing=bearing,
        end_bearing=small_bearing(END_BEARING_BORE_MM),
        rear_bearing=small_bearing(2.0 * data.coupling.shaft_radius_mm),
        shaft_ring=shaft_ring,
        bore_ring=bore_ring,
        webs=webs,
        r_plate=r_motor + casing.flange_width_mm,
        r_casing=r_motor + casing.motor_clearance_mm,
        r_bolts=r_motor + casing.bolt_offset_mm,
        r_motor=r_motor,
        r_stator_in=0.5 * stator_in,
        r_stator_out=0.5 * stator_out,
        r_rotor_in=0.5 * stator_out + AIR_GAP_MM,
        r_bore=0.5 * bearing.inner_diameter_mm,
        r_seat=0.5 * bearing.outer_diameter_mm,
        r_open=0.5 * bearing.outer_diameter_mm - casing.lip_mm,
        r_pins=r_pins,
        r_ring=r_ring,
        r_carrier_in=r_pins - pin_reach,
        r_secondary_in=np.maximum(r_pins - pin_reach, gears.sun().tip_radius_mm + carrier.sun_clearance_mm),
        r_secondary_out=np.maximum(r_pins + pin_reach, np.where(webs.present, webs.reach_mm, 0.0))[()],
        z_bearing_front=z_bearing_front,
        z_bearing_back=z_bearing_back,
        z_shoulder=z_shoulder,
        z_gear_front=z_gear_front,
        z_gear_back=z_gear_back,
        z_secondary_front=z_secondary_front,
        z_secondary_back=z_secondary_front - carrier.secondary_thickness_mm,
    )
