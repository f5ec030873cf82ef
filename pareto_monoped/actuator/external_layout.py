"""Radii and heights of the ESSPG behind the common front: housing, coupling, motor, backplate."""

from dataclasses import dataclass

import numpy as np

from pareto_monoped.actuator.layout import BORE_GROOVE_WALL_MM, Layout
from pareto_monoped.actuator.motors import Motor
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.actuator.sun_shaft import SunNeck, sun_neck
from pareto_monoped.geometry.screws import LENGTHS_MM, screw_for
from pareto_monoped.geometry.shapes import Numbers

_FLANGE_WIDTH_MM = 6.0
"""Of the flange between ring housing and casing: 2.8 mm outside the bolt circle, a hexagon head's inner radius."""
_FLANGE_BOLTS_MM = 3.2
"""From the tube to that flange's bolt circle. A hexagon head of M3, 6.01 mm over its corners, turns beside the tube; a
spanner reaches it from the side, where the front plate bars a key."""
_THREAD_SHARE = 0.6
"""Least depth of thread over the screw's diameter, as the export's check of held parts asks for."""
_RING_STEP_MM = 1.0
"""How far the ring stands out of its housing into the casing, which it centres; our own choice."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ExternalLayout:
    """Radii and heights of coupling, motor and housing, in mm, beyond what ``Layout`` has.

    From the front: the neck of the sun's shaft; the ring housing's seat and its ring's groove; flange and web, where
    ring housing and casing meet; coupling; motor; backplate.
    """

    z_groove_back: Numbers
    z_seat_back: Numbers
    z_flange: Numbers
    z_web: Numbers
    z_coupling: Numbers
    z_motor: Numbers
    z_plate: Numbers
    z_end: Numbers
    r_boss: Numbers
    r_tube: Numbers
    r_tube_in: Numbers
    r_flange: Numbers
    r_web: Numbers
    r_bolts: Numbers
    neck: SunNeck
    coupling_mm: float
    base_mm: float


def external_layout(at: Layout, motor: Motor, settings: ActuatorSettings) -> ExternalLayout:
    """The layout of an ESSPG behind its front, for one gear set or for arrays of them."""
    casing, coupling_mm = settings.parts.casing, _coupling_mm(motor, settings)
    assert motor.framed is not None
    z_coupling = at.z_secondary_back - casing.motor_carrier_clearance_mm
    z_motor = z_coupling - coupling_mm
    z_plate = z_motor - motor.framed.length_mm
    z_groove_back = at.z_bearing_back - at.bore_ring.thickness_mm
    z_flange = at.z_gear_back + _RING_STEP_MM
    r_boss = at.r_seat + casing.seat_wall_mm
    r_tube = np.maximum(at.r_ring + casing.ring_wall_mm, r_boss)
    r_flange = r_tube + _FLANGE_WIDTH_MM
    return ExternalLayout(
        z_groove_back=z_groove_back,
        z_seat_back=z_groove_back - BORE_GROOVE_WALL_MM,
        z_flange=z_flange,
        z_web=z_flange - casing.flange_mm,
        z_coupling=z_coupling,
        z_motor=z_motor,
        z_plate=z_plate,
        z_end=z_plate - casing.plate_mm,
        r_boss=r_boss,
        r_tube=r_tube,
        r_tube_in=np.maximum(at.r_ring - casing.ring_lip_mm, r_boss),
        r_flange=r_flange,
        r_web=np.maximum(r_flange, at.r_casing + casing.wall_mm),
        r_bolts=r_tube + _FLANGE_BOLTS_MM,
        neck=sun_neck(at, settings),
        coupling_mm=coupling_mm,
        base_mm=_frame_base_mm(motor, coupling_mm),
    )


def _coupling_mm(motor: Motor, settings: ActuatorSettings) -> float:
    """Thickness of the coupling, in which the heads of its countersunk screws must find room, in steps of 0.1 mm."""
    assert motor.output_holes is not None
    screw = screw_for(motor.output_holes.diameter_mm, 0.0)
    return max(
        settings.parts.coupling.thickness_mm, float(np.ceil(10.0 * (screw.countersunk - screw.shank) - 1e-9)) / 10.0
    )


def _frame_base_mm(motor: Motor, coupling_mm: float) -> float:
    """Thickness of base and face in the envelope of a framed motor: 3 mm, less for short ones.

    It is more where the face would not hold the coupling's screws by ``_THREAD_SHARE`` of their diameter.
    """
    assert motor.framed is not None
    assert motor.output_holes is not None
    least = coupling_mm + _THREAD_SHARE * motor.output_holes.diameter_mm
    length = LENGTHS_MM[np.searchsorted(LENGTHS_MM, least - 1e-9)]
    return max(min(3.0, 0.1 * motor.framed.length_mm), float(length) - coupling_mm)
