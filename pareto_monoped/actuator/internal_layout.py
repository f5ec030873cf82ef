"""Radii and heights of the ISSPG behind the common front: ring housing, rotor, coupling, rear bearing, backplate."""

from dataclasses import dataclass

import numpy as np

from pareto_monoped.actuator.layout import Layout
from pareto_monoped.actuator.motors import FramelessMotor, Motor
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.actuator.sun_shaft import SunNeck, sun_neck
from pareto_monoped.geometry.shapes import Numbers

_FLANGE_LESS_MM = 1.0
"""By how much the ring housing's flange is narrower than the casing's, within whose bolts it stays."""


@dataclass(frozen=True, slots=True, kw_only=True)
class InternalLayout:
    """Radii and heights of ring housing, rotor, coupling, rear bearing and backplate, in mm, beyond ``Layout``.

    Attributes:
        z_flange, z_lip: backs of the ring housing's flange and of the lip behind the main bearing.
        z_bell, z_stator_back: front of the bell, back of the stator.
        z_coupling: front of the coupling, at the bell's back.
        z_seat, z_plate, z_end: front of the rear bearing, front and back of the backplate.
        neck: front end of the sun's shaft.
        r_seat_out, r_flange, r_flange_bolts, r_lip, r_ring_lip: of the ring housing: outside of its seat, its flange,
            the flange's bolt circle, the openings of the lips behind the main bearing and in front of the ring.
        r_rear_seat: of the rear bearing's seat.
    """

    z_flange: float
    z_lip: Numbers
    z_bell: Numbers
    z_stator_back: Numbers
    z_coupling: Numbers
    z_seat: Numbers
    z_plate: Numbers
    z_end: Numbers
    neck: SunNeck
    r_seat_out: Numbers
    r_flange: Numbers
    r_flange_bolts: Numbers
    r_lip: Numbers
    r_ring_lip: Numbers
    r_rear_seat: Numbers


def internal_layout(at: Layout, motor: Motor, settings: ActuatorSettings) -> InternalLayout:
    """The layout of an ISSPG behind its front, for one gear set or for arrays of them."""
    data, kit = settings.parts, frameless(motor)
    casing = data.casing
    assert kit.stator_height_mm is not None
    # Where the main bearing is too large for the stator's bore, its seat stands in front of the stator.
    fits = at.r_seat + casing.ring_wall_mm <= at.r_stator_in
    r_seat_out = np.where(fits, at.r_stator_in, at.r_seat + casing.ring_wall_mm)[()]
    z_flange = -(casing.plate_mm + casing.flange_mm)
    z_lip = at.z_shoulder
    z_free = np.where(fits, z_flange, z_lip)[()] - casing.rotor_clearance_mm
    # The rotor's cavity is as high as the stator, and the rotor needs axial clearance to the second carrier.
    z_bell = np.minimum(
        z_free - kit.stator_height_mm - casing.rotor_clearance_mm,
        at.z_secondary_back - casing.motor_carrier_clearance_mm,
    )
    z_coupling = z_bell - kit.bell_thickness_mm
    z_seat = z_coupling - data.coupling.thickness_mm - casing.bearing_play_mm
    z_plate = z_seat - at.rear_bearing.width_mm
    r_shoulder = at.r_bore + data.carrier.shoulder_height_mm
    r_flange = r_seat_out + casing.flange_width_mm - _FLANGE_LESS_MM
    return InternalLayout(
        z_flange=z_flange,
        z_lip=z_lip,
        z_bell=z_bell,
        z_stator_back=z_bell + casing.rotor_clearance_mm,
        z_coupling=z_coupling,
        z_seat=z_seat,
        z_plate=z_plate,
        z_end=z_plate - casing.wall_mm,
        neck=sun_neck(at, settings),
        r_seat_out=r_seat_out,
        r_flange=r_flange,
        r_flange_bolts=r_flange - 0.5 * (casing.flange_width_mm - _FLANGE_LESS_MM),
        # It holds the bearing's outer ring and the ring gear, and clears the carrier's shoulder.
        r_lip=np.maximum(
            np.minimum(at.r_seat - casing.lip_mm, at.r_ring - 0.5 * casing.ring_lip_mm),
            r_shoulder + casing.rotor_clearance_mm,
        ),
        # Its corner clears the shoulder's corner, which turns in the same plane.
        r_ring_lip=np.maximum(at.r_ring - 0.5 * casing.ring_lip_mm, r_shoulder + casing.shoulder_clearance_mm),
        r_rear_seat=0.5 * at.rear_bearing.outer_diameter_mm,
    )


def frameless(motor: Motor) -> FramelessMotor:
    """The frameless motor, which every ISSPG has."""
    assert motor.frameless is not None
    return motor.frameless
