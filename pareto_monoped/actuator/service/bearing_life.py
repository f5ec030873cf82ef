"""Loads on the bearings of one actuator, and what they leave: life and static safety.

At the knee, the chain pulls between two supports: the actuator's main bearing, a single row of balls, and a needle
bearing in the hip coupling, on the far side of the sprocket. At the hip, leg and knee actuator rest in the main bearing
and that of the far cheek. All four are taken as pivots: no row of balls has to carry a tilting moment. End and rear
bearing hold sun and rotor; planets turn on bushes or needles.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.assumptions import ServiceData, life_turns, output_turns_per_hour
from pareto_monoped.actuator.bearings import RatedBearing, rated_bearing
from pareto_monoped.actuator.gearset import load_sharing
from pareto_monoped.actuator.layout import Layout
from pareto_monoped.actuator.needles import LIFE_EXPONENT, RollerBearing, as_bearing, needle_rows, roller_bearing
from pareto_monoped.actuator.service.loads import (
    knee_forces_n,
    line_tilt_rad,
    main_bearing_depth_mm,
    planet_force_n,
    planet_turns,
    row_load,
)
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.design import GRAVITY_M_PER_S2
from pareto_monoped.geometry.gears import PRESSURE_ANGLE_RAD
from pareto_monoped.geometry.roles import Group, Role
from pareto_monoped.geometry.shapes import Floats

Place = Literal["main, knee", "far, knee", "main, hip", "end", "rear", "planets"]


@dataclass(frozen=True, slots=True, kw_only=True)
class BearingService:
    """One bearing under the duty."""

    place: Place  #: which bearing, and for the main bearing at which joint
    bearing: RatedBearing | RollerBearing  #: of the catalogue, or the needles of one planet
    force_n: float  #: radial force at the actuator's peak torque
    equivalent_n: float  #: dynamic equivalent load there
    tilt_rad: float  #: by which the rings turn against each other
    life_h: float  #: L10 under the duty
    static_safety: float  #: at the peak torque
    overload_safety: float  #: static safety under the overload
    turns_per_output: float  #: its speed over the output's
    friction_coefficient: float  #: at the radius of its bore


@dataclass(frozen=True, slots=True, kw_only=True)
class _Context:
    """What every bearing of an actuator is rated with; ``levels`` are the duty's torques, the peak and the overload."""

    settings: ActuatorSettings
    service: ServiceData
    levels: Floats


def bearing_services(
    actuator: Actuator, at: Layout, settings: ActuatorSettings, service: ServiceData
) -> tuple[BearingService, ...]:
    """Return every bearing of an actuator at both joints; the same actuator is taken for hip and knee."""
    levels = np.array([*settings.parts.duty.torque_shares, 1.0, settings.parts.rating.overload_factor])
    context = _Context(settings=settings, service=service, levels=levels)
    main = rated_bearing(float(at.bearing.inner_diameter_mm))
    near, far = (float(force) for force in knee_forces_n(actuator.peak_torque_n_m, at, service))
    tilt = float(line_tilt_rad(actuator.peak_torque_n_m, at, service))
    support = roller_bearing(service.drive_support_bearing)
    # Sun and rotor rest in two bearings; the carrier of an ESSPG and the motor's own bearings share the sun's load.
    sun = 0.5 * uneven_force_n(actuator, settings)
    end = rated_bearing(float(at.end_bearing.inner_diameter_mm))
    found = [
        _balls("main, knee", main, levels * near, 1.0, context, tilt),
        _rollers("far, knee", support, levels * far, 1.0, context, service.needle_friction_coefficient, tilt),
        _balls("main, hip", main, levels * hip_force_n(actuator, at, service), 1.0, context),
        _balls("end", end, levels * sun, actuator.ratio - 1.0, context),
    ]
    if actuator.family == "ISSPG":
        assert actuator.motor.frameless is not None
        rotor = 0.5 * actuator.motor.rotor_mass_share * actuator.motor.frameless.mass_kg * GRAVITY_M_PER_S2
        bearing = rated_bearing(float(at.rear_bearing.inner_diameter_mm))
        found.append(_balls("rear", bearing, levels * sun + rotor, actuator.ratio, context))
    if settings.planet_bearing == "needles":
        found.append(_needles(actuator, context))
    return tuple(found)


def _needles(actuator: Actuator, context: _Context) -> BearingService:
    settings, gears = context.settings, actuator.gears
    (part,) = (p for p in actuator.parts if p.role is Role.BEARING and p.group is Group.PLANET)
    bearing = as_bearing(
        needle_rows(actuator.face_width_mm, settings),
        pin_mm=settings.parts.carrier.pin_diameter_mm,
        bore_mm=settings.planet_bore_mm,
        mass_kg=float(part.mass_kg()) / float(gears.planets),
    )
    force = float(planet_force_n(gears, actuator.peak_torque_n_m, settings))
    friction = settings.parts.needles.friction_coefficient
    return _rollers("planets", bearing, context.levels * force, float(planet_turns(gears)), context, friction)


def hip_force_n(actuator: Actuator, at: Layout, service: ServiceData) -> float:
    """Return the radial force on the hip's main bearing: its share of foot force and weight, which act in the leg's
    middle plane.

    The other support is the far cheek's bearing, behind the knee actuator. Both are taken as pivots.
    """
    near = service.leg_offset_mm + float(main_bearing_depth_mm(at))
    far = service.chain_offset_mm + actuator.length_mm + service.far_bearing_mm
    return (service.foot_force_n + service.leg_weight_n) * far / (near + far)


def uneven_force_n(actuator: Actuator, settings: ActuatorSettings) -> float:
    """Return the sun's radial force at the peak torque: (K_gamma - 1) of one planet's mean tooth force."""
    gears = actuator.gears
    radius_m = 0.5e-3 * float(gears.module_mm) * float(gears.sun_teeth)
    tangential = actuator.motor.peak_torque_n_m / (radius_m * float(gears.planets))
    uneven = float(load_sharing(gears.planets, settings)) - 1.0
    return float(uneven * tangential / np.cos(PRESSURE_ANGLE_RAD))


def _balls(
    place: Place, bearing: RatedBearing, force: Floats, turns: float, context: _Context, tilt_rad: float = 0.0
) -> BearingService:
    """Rate a row of balls by the loads of its balls (ISO/TS 16281); ``force`` is at the context's levels."""
    loads = row_load(bearing, force, 0.0 * force, context.service.bearing_clearance_mm)
    rated = (loads.equivalent_n, loads.static_safety, 3.0)  # ISO 281, clause 5.3
    return _rated(place, bearing, force, turns, context, *rated, context.service.bearing_friction_coefficient, tilt_rad)


def _rollers(
    place: Place,
    bearing: RollerBearing,
    force: Floats,
    turns: float,
    context: _Context,
    friction: float,
    tilt_rad: float = 0.0,
) -> BearingService:
    """Rate a roller bearing, whose equivalent load is the radial force (ISO 281, ISO 76)."""
    rated = (force, bearing.static_rating_n / force, LIFE_EXPONENT)
    return _rated(place, bearing, force, turns, context, *rated, friction, tilt_rad)


def _rated(
    place: Place,
    bearing: RatedBearing | RollerBearing,
    force: Floats,
    turns: float,
    context: _Context,
    equivalent: Floats,
    static: Floats,
    exponent: float,
    friction: float,
    tilt_rad: float,
) -> BearingService:
    duty = context.settings.parts.duty
    peak = len(duty.torque_shares)
    lasts = life_turns(list(equivalent[:peak]), bearing.dynamic_rating_n, exponent, duty)
    return BearingService(
        place=place,
        bearing=bearing,
        force_n=float(force[peak]),
        equivalent_n=float(equivalent[peak]),
        tilt_rad=tilt_rad,
        life_h=float(lasts) / (output_turns_per_hour(duty, context.service) * turns),
        static_safety=float(static[peak]),
        overload_safety=float(static[peak + 1]),
        turns_per_output=turns,
        friction_coefficient=friction,
    )
