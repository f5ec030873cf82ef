"""Kinetic energy of the parts that turn against the body that carries them.

A part with the moment of inertia J about the joint axis that turns at c times the joint's speed, relative to the body
that carries it, has the absolute speed w_body + c w_joint. Summed over all such parts, the kinetic energy of turning is

    1/2 (S w_body^2 + 2 B w_body w_joint + C w_joint^2),    S = sum J,  B = sum J c,  C = sum J c^2.

S is part of the body's own inertia. C is the reflected inertia, which MuJoCo calls armature. B couples the joint to the
rotation of the body. The base does not rotate, so that the coupling matters for the knee actuator only, which the thigh
carries.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

from pareto_monoped.actuator.actuator import Actuator, turning_terms
from pareto_monoped.geometry.roles import Group, Role
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.thigh import thigh_parts

_LENGTHS_M = (0.3, 0.5)  # two lengths fix a straight line; any two do


def actuator_coupling_kg_m2(actuator: Actuator) -> float:
    """B of rotor, planets and carrier of an actuator, against its housing."""
    terms = turning_terms(actuator.parts, actuator.gears, actuator.motor)
    return sum(inertia * speed for part in terms for inertia, speed in part)


def rotor_inertia_kg_m2(actuator: Actuator) -> float:
    """Moment of inertia of everything that turns at the motor's speed: rotor, coupling, sun."""
    terms = turning_terms(actuator.parts, actuator.gears, actuator.motor)
    return sum(inertia for part in terms for inertia, speed in part if speed == actuator.ratio)


def rotor_excess_kg_m2(actuator: Actuator) -> float:
    """Inertia of the motor's rotor by its data sheet, less that of the envelope that weighs it among the parts."""
    drawn = sum(
        float(part.mass_properties().inertia_kg_m2[2, 2]) for part in actuator.parts if part.role is Role.MOTOR_ROTOR
    )
    return actuator.motor.rotor_inertia_kg_m2 - drawn


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveTurning:
    """Drive sprocket with its coupling, and the chain, which run against the thigh at the knee's speed.

    Attributes:
        coupling_kg_m2: B, as a line over the thigh's length in metres: constant and slope.
        reflected_kg_m2: C, likewise.
    """

    coupling_kg_m2: tuple[float, float]
    reflected_kg_m2: tuple[float, float]


@lru_cache(maxsize=64)
def drive_turning(leg: LegDimensions) -> DriveTurning:
    """The turning parts of the knee's drive in a leg.

    The chain runs around two equal sprockets of pitch radius r at the speed r w. A closed loop of linear density rho
    that encloses the area A has the angular momentum 2 rho A r w about every axis, and no linear momentum. The
    turnbuckles take the place of some chain in both strands, at the distance r from the axis.
    """
    radius_m = 1e-3 * leg.chain.pitch_radius_mm
    coupling, reflected = [], []
    for length_m in _LENGTHS_M:
        parts = thigh_parts(length_m, leg)
        turning = sum(float(p.mass_properties().inertia_kg_m2[2, 2]) for p in parts if p.group is Group.KNEE_DRIVE)
        running = sum(float(p.mass_kg()) for p in parts if p.role in (Role.CHAIN, Role.TURNBUCKLE)) * radius_m**2
        # The links around the knee have the mean of sin over a half turn, 2 / pi, of their momentum m r w across the
        # thigh, at the thigh's length from the hip.
        links_kg = leg.chain.kg_per_m * 0.5e-3 * leg.chain.teeth * leg.chain.pitch_mm
        around_knee = 2.0 / math.pi * links_kg * radius_m * length_m
        coupling.append(turning + running + around_knee)
        reflected.append(turning + running)
    return DriveTurning(coupling_kg_m2=_line(coupling), reflected_kg_m2=_line(reflected))


def _line(values: list[float]) -> tuple[float, float]:
    """Constant and slope of the line through two values at ``_LENGTHS_M``."""
    (low, high), (at_low, at_high) = _LENGTHS_M, values
    slope = (at_high - at_low) / (high - low)
    return at_low - slope * low, slope
