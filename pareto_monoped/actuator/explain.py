"""The actuator map as plain values, for tables and JSON: one row per interval, gaps, and one interval in full."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.constraint_names import ConstraintName
from pareto_monoped.actuator.layout import Family
from pareto_monoped.actuator.motor import Motor
from pareto_monoped.actuator.motor_facts import CONTINUOUS_BASIS, how_long, motor_values_shown, peak_basis
from pareto_monoped.actuator.ratiomap import ActuatorMap, Candidate, MapEntry, cures
from pareto_monoped.actuator.rules import CONSTRAINTS
from pareto_monoped.actuator.service.bearing_life import BearingService
from pareto_monoped.actuator.service.losses import BushLoad
from pareto_monoped.actuator.service.sheet import ServiceSheet
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import Role


@dataclass(frozen=True, slots=True, kw_only=True)
class Gap:
    """Neighbouring intervals without a gearbox.

    Attributes:
        ratio_low, ratio_high: the gap is [ratio_low, ratio_high).
        in_the_way: for each family, the constraints that forbid its gearboxes; empty if it has no tooth set there.
        cures: what would help in the first interval.
    """

    ratio_low: float
    ratio_high: float
    in_the_way: Mapping[Family, tuple[ConstraintName, ...]]
    cures: tuple[str, ...]


def summary(entry: MapEntry, sheet: ServiceSheet) -> dict[str, Any]:
    """One row of the map, for an interval that has a gearbox, with the service sheet of its actuator."""
    actuator = entry.actuator
    assert actuator is not None
    gears = actuator.gears
    return {
        "ratio_low": entry.ratio_low,
        "ratio": actuator.ratio,
        "type": actuator.family,
        "sun_teeth": gears.sun_teeth,
        "planet_teeth": gears.planet_teeth,
        "ring_teeth": gears.ring_teeth,
        "module_mm": gears.module_mm,
        "planets": gears.planets,
        "sun_shift": float(gears.sun_shift),
        "planet_shift": float(gears.planet_shift),
        "ring_shift": float(gears.ring_shift),
        "centre_distance_mm": float(gears.carrier_radius_mm),
        "face_width_mm": actuator.face_width_mm,
        "mass_kg": actuator.mass_kg,
        "peak_torque_n_m": actuator.peak_torque_n_m,
        "efficiency": actuator.efficiency,
        "continuous_torque_n_m": actuator.continuous_torque_n_m,
        "no_load_speed_rad_per_s": actuator.no_load_speed_rad_per_s,
        "length_mm": actuator.length_mm,
        "reflected_inertia_kg_m2": actuator.reflected_inertia_kg_m2,
        "efficiency_mesh": sheet.losses.efficiency_mesh,
        "efficiency_planets": sheet.losses.efficiency_planets,
        "efficiency_bearings": sheet.losses.efficiency_bearings,
        "efficiency_total": sheet.losses.efficiency_total,
        "bearing_life_h": sheet.bearing_life_h,
        "output_tilt_n_m": sheet.output_tilt_n_m,
        "backlash_arcmin": sheet.backlash_arcmin,
        "greatest_backlash_arcmin": sheet.greatest_backlash_arcmin,
        "stiffness_n_m_per_rad": sheet.stiffness.stiffness_n_m_per_rad,
        **_caveats(actuator),
        **_safeties(actuator),
    }


def _caveats(actuator: Actuator) -> dict[str, Any]:
    """What the torques of a row are worth: both are before losses."""
    motor = actuator.motor
    return {
        "peak_torque_basis": peak_basis(motor),
        "peak_torque_time": how_long(motor.peak_torque_time_s),
        "continuous_torque_basis": CONTINUOUS_BASIS,
        "continuous_torque_time": how_long(motor.continuous_torque_time_s),
        "lasting_torque_n_m": None if (lasting := motor.lasting_torque_n_m) is None else actuator.ratio * lasting,
    }


def _safeties(actuator: Actuator) -> dict[str, float]:
    """The least safety factors over the meshes, where the gears are rated."""
    rating = actuator.rating
    if rating is None:
        return {}
    return {
        "flank_safety": rating.flank_safety,
        "root_safety": rating.root_safety,
        "overload_flank_safety": min(gear.overload_flank_safety for gear in rating.gears),
        "overload_root_safety": min(gear.overload_root_safety for gear in rating.gears),
    }


def details(entry: MapEntry, sheet: ServiceSheet) -> dict[str, Any]:
    """Everything known about an interval that has a gearbox; its parts from the heaviest to the lightest."""
    actuator = entry.actuator
    assert actuator is not None
    return summary(entry, sheet) | {
        "contact_ratio_sun": actuator.contact_ratio_sun,
        "contact_ratio_ring": actuator.contact_ratio_ring,
        "efficiency_churning": sheet.losses.efficiency_churning,
        "compliance_rad_per_n_m": dataclasses.asdict(sheet.stiffness),
        "bearings": [_bearing(found) for found in sheet.bearings],
        **{
            name: _bush(load)
            for name, load in (("bush", sheet.bush), ("bush_duty", sheet.bush_duty))
            if load is not None
        },
        "runner_up": None if entry.runner_up is None else {"type": entry.runner_up.family, **_best(entry.runner_up)},
        "binding": {name: CONSTRAINTS[name].says for name in entry.binding},
        "families": {
            family: {**_best(found.best), "constraints_in_the_way": list(found.in_the_way)}
            for family, found in entry.families.items()
        },
        **({} if actuator.rating is None else {"rating": actuator.rating.as_dict()}),
        "motor": motor_values_shown(actuator.motor),
        "parts": [
            _part(part, actuator.motor) for part in sorted(actuator.parts, key=lambda part: -float(part.mass_kg()))
        ],
    }


def gaps(actuator_map: ActuatorMap) -> tuple[Gap, ...]:
    """Where the map has no gearbox, from the lowest ratio to the highest."""
    runs: list[list[MapEntry]] = []
    previous_has_gearbox = True
    for entry in actuator_map.entries:
        has_gearbox = entry.actuator is not None
        if not has_gearbox and previous_has_gearbox:
            runs.append([])
        if not has_gearbox:
            runs[-1].append(entry)
        previous_has_gearbox = has_gearbox
    return tuple(_gap(run) for run in runs)


def _gap(entries: list[MapEntry]) -> Gap:
    return Gap(
        ratio_low=entries[0].ratio_low,
        ratio_high=entries[-1].ratio_high,
        in_the_way={
            family: tuple(sorted({name for entry in entries for name in entry.forbidden_by.get(family, ())}))
            for family in entries[0].forbidden_by
        },
        cures=cures(entries[0]),
    )


def _best(found: Candidate | None) -> dict[str, Any]:
    return {"gears": None, "mass_kg": None} if found is None else {"gears": str(found.gears), "mass_kg": found.mass_kg}


def _bearing(found: BearingService) -> dict[str, Any]:
    rated = found.bearing
    return {
        "place": found.place,
        "designation": rated.designation,
        "size_mm": [rated.inner_diameter_mm, rated.outer_diameter_mm, rated.width_mm],
        "dynamic_rating_n": rated.dynamic_rating_n,
        "static_rating_n": rated.static_rating_n,
        "force_n": found.force_n,
        "equivalent_n": found.equivalent_n,
        "tilt_rad": found.tilt_rad,
        "life_h": found.life_h,
        "static_safety": found.static_safety,
        "overload_safety": found.overload_safety,
    }


def _bush(load: BushLoad) -> dict[str, float]:
    return {
        "pressure_mpa": load.pressure_mpa,
        "speed_m_per_s": load.speed_m_per_s,
        "pv_mpa_m_per_s": load.pv_mpa_m_per_s,
    }


def _part(part: Part, motor: Motor) -> dict[str, Any]:
    """All instances of one part together; the inertia is about the gearbox axis.

    The motor's rotor has the inertia that is simulated: that of its data sheet or its estimate. Its solid is an
    envelope of even density, which only weighs it.
    """
    second_moment = part.mass_properties().second_kg_m2
    inertia = float(second_moment[0, 0] + second_moment[1, 1])
    return {
        "name": part.name,
        "material": part.material.name,
        "group": part.group,
        "count": int(part.count),
        "mass_kg": float(part.mass_kg()),
        "axial_inertia_kg_m2": motor.rotor_inertia_kg_m2 if part.role is Role.MOTOR_ROTOR else inertia,
    }
