"""The webs between the planets and the screws that clamp the second carrier to them.

The planets press their pins with half of their load into either carrier. What the second carrier gets, half of the
output's torque, goes back to the first one through the webs; that the pins are clamped as well is not counted.
"""

import numpy as np

from pareto_monoped.actuator.webs import SCREW as WEB_SCREW
from pareto_monoped.geometry.roles import Group, Role
from pareto_monoped.geometry.shapes import Arc
from pareto_monoped.geometry.tightening import YIELD_MPA, Fastening
from pareto_monoped.strength.drive import fastening, layout_of, yield_mpa
from pareto_monoped.strength.joint import SIDES, ActuatorJoint, Structure

_SHARE = 0.5
"""Of the output's torque, in the second carrier: both seats of a pin are alike."""
_REASON = (
    "our own choice against yield; countersunk heads have no play in their seats, so that all webs carry from the first"
)


def sheared_n(screw: Fastening) -> float:
    """Force across a tightened screw at which its core yields: what its preload leaves by von Mises.

    The torsion of tightening has gone by then. The friction of the joint comes on top and is not counted.
    """
    yielding = YIELD_MPA[screw.property_class]
    pulled = screw.preload_n / screw.thread.stress_area_mm2
    return float(screw.thread.core_area_mm2 * np.sqrt((yielding**2 - pulled**2) / 3.0))


def clamped_beam_n(length_mm: float, modulus_mm3: float, yield_mpa: float) -> float:
    """Force at the end of a beam, clamped at both ends, at which it yields: M = F L / 2."""
    return 2.0 * modulus_mm3 * yield_mpa / length_mm


def _at_output_n_m(force_n: float, count: float, radius_mm: float) -> float:
    return 1e-3 * count * force_n * radius_mm / _SHARE


def screws(s: Structure) -> float:
    """Output torque at which a screw of the webs yields in shear; infinite without webs."""
    webs = layout_of(s).webs
    if not webs.present:
        return float(np.inf)
    (screw,) = (
        part
        for part in s.actuator.parts
        if part.role is Role.SCREW
        and part.group is Group.OUTPUT
        and np.isclose(float(part.pitch_radius_mm), float(webs.r_screw_mm))
        and np.isclose(float(part.phase_rad), float(webs.phase_rad))
    )
    return _at_output_n_m(sheared_n(fastening(screw)), float(screw.count), float(screw.pitch_radius_mm))


def bending(s: Structure) -> float:
    """Output torque at which a web yields at its ends, as a beam clamped in both carriers; infinite without webs."""
    at = layout_of(s)
    webs = at.webs
    if not webs.present:
        return float(np.inf)
    outer = webs.path.pieces[0]
    assert isinstance(outer, Arc)
    half_width = float(outer.radius_mm) * float(np.sin(float(outer.end_rad)))
    modulus = (float(webs.section.second_moment_mm4) - 0.25 * np.pi * WEB_SCREW.core**4) / half_width
    length = float(at.z_shoulder - at.z_secondary_front)
    carrier = max(
        (part for part in s.actuator.parts if part.role is Role.CARRIER), key=lambda part: float(part.mass_kg())
    )
    force = clamped_beam_n(length, modulus, yield_mpa(carrier))
    return _at_output_n_m(force, float(webs.count), float(webs.r_screw_mm))


JOINTS: tuple[ActuatorJoint, ...] = tuple(
    ActuatorJoint(
        name=f"{side}_{name}",
        group="joints",
        side=side,
        formula=formula,
        source=source,
        required=1.2,
        required_source=_REASON,
        loads=(f"peak_gear_torque_{side}_n_m",),
        capacity=capacity,
        parts=parts,
        cure=f"release the {side}'s torque before its stop, or another {side}_ratio",
    )
    for side in SIDES
    for name, formula, source, capacity, parts in (
        (
            "web_screws",
            "n A_d3 sqrt((Rp0.2^2 - (F_M / A_s)^2) / 3) r / (T / 2)",
            "von Mises in the core of a tightened screw; VDI 2230-1, 5.5.6, for what overcomes friction",
            screws,
            ("web_screw", "carrier", "secondary_carrier"),
        ),
        (
            "webs",
            "n 2 W Rp0.2 r / L / (T / 2)",
            "beam clamped at both ends: Roark's Formulas for Stress and Strain, chapter 8",
            bending,
            ("carrier",),
        ),
    )
)
"""Two rows per side."""
