"""The sun's shaft: its end in the carrier's end bearing, and the spline by which the motor drives it."""

from dataclasses import dataclass

import numpy as np

from pareto_monoped.actuator.layout import Layout
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.dowels import Dowel
from pareto_monoped.geometry.gears import ExternalGear
from pareto_monoped.geometry.shapes import Numbers

_NECK_RADIUS_MM = 3.8
"""Of the sun's neck, which touches the inner ring of its end bearing only (619/6: abutment from 7.6 mm diameter)."""
_NECK_PLAY_MM = 0.2
"""Axial play of the rotor between end bearing and rear bearing; our own choice."""
COUPLING_DOWEL = Dowel(diameter_mm=2.5)
"""Between the coupling and what turns it; our own choice: they stand between screws of M3 or M4 on 22 mm."""
DOWEL_STANDS_OUT_MM = 1.0
"""How far such a dowel may stand out: half of ``motor_carrier_clearance_mm``."""
_RUN_OUT_MM = 2.0
"""Along the shaft, of a hob of 24 mm that cuts 0.125 mm into it: sqrt(12^2 - 11.875^2) = 1.7 mm, rounded up."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SunNeck:
    """The front end of the sun's shaft, in mm.

    Attributes:
        z: back of the end that turns in the end bearing.
        r_journal, r: radii of this end and of the neck behind it.
    """

    z: Numbers
    r_journal: Numbers
    r: Numbers


def sun_neck(at: Layout, settings: ActuatorSettings) -> SunNeck:
    """The neck keeps the sun from moving forwards and clears the carrier."""
    r_journal = 0.5 * at.end_bearing.inner_diameter_mm
    room = at.r_carrier_in - settings.parts.casing.rotor_clearance_mm
    return SunNeck(
        z=-at.end_bearing.width_mm - _NECK_PLAY_MM,
        r_journal=r_journal,
        r=np.maximum(r_journal, np.minimum(_NECK_RADIUS_MM, room))[()],
    )


def hub_note(settings: ActuatorSettings) -> str:
    """How the coupling is made to fit."""
    return f"wire-cut to the shaft's spline, {settings.parts.spline.play_mm:g} mm play"


def spline_note(spline: ExternalGear, shaft_radius_mm: float) -> str:
    """The spline in words. It is toothed like a gear, so that a hob and a wire-cutter do, not a tool of its own.

    Args:
        spline: its teeth.
        shaft_radius_mm: of the shaft beside them.
    """
    note = f"splined end of {spline.teeth:g} teeth, module {spline.module_mm:g} mm, 20 degrees"
    root, shaft = 2.0 * float(spline.root_radius_mm), 2.0 * shaft_radius_mm
    if root >= shaft:
        return note
    return (
        f"{note}, roots of {root:g} mm below the shaft's {shaft:g} mm: hob may run out into it over {_RUN_OUT_MM:g} mm"
    )
