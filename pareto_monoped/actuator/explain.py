"""Motors and the actuator map as plain values and words, for tables and JSON."""

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.layout import Family
from pareto_monoped.actuator.motor import PEAK_TO_CONTINUOUS, Motor
from pareto_monoped.actuator.rating.sheet import tip_depths_mm
from pareto_monoped.actuator.ratiomap import ActuatorMap, Candidate, MapEntry, cures
from pareto_monoped.actuator.rules import CONSTRAINTS
from pareto_monoped.actuator.service.bearing_life import BearingService
from pareto_monoped.actuator.service.sheet import ServiceSheet
from pareto_monoped.design import ConstraintName
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import Role

_NOT_KNOWN = "not known"
CONTINUOUS_BASIS = "rated by maker"
"""Makers of propeller motors rate them in the wind of their propeller, and not for a joint in its housing."""


def peak_basis(motor: Motor) -> str:
    """Return where the peak torque comes from."""
    if motor.peak_is_assumed:
        return f"assumed, {PEAK_TO_CONTINUOUS:.2f} times the continuous one"
    return "published"


def how_long(time_s: float | None) -> str:
    """Return how long a torque may be held, in words."""
    if time_s is None:
        return f"time {_NOT_KNOWN}"
    return "for ever" if math.isinf(time_s) else f"{time_s:.1f} s from cold"


def motor_values_shown(motor: Motor) -> dict[str, Any]:
    """Return plain values; a time is None where it is not known, and also where the torque may be held for ever."""
    return {
        "name": motor.name,
        "kv_rpm_per_v": motor.kv_rpm_per_v,
        "torque_constant_n_m_per_a": motor.torque_constant_n_m_per_a,
        "terminal_resistance_ohm": motor.terminal_resistance_ohm,
        "peak_torque_n_m": motor.peak_torque_n_m,
        "peak_torque_time_s": _finite(motor.peak_torque_time_s),
        "continuous_torque_n_m": motor.continuous_torque_n_m,
        "continuous_torque_time_s": _finite(motor.continuous_torque_time_s),
        "peak_torque_basis": peak_basis(motor),
        "continuous_torque_basis": CONTINUOUS_BASIS,
        "lasting_torque_n_m": motor.lasting_torque_n_m,
        "rotor_inertia_kg_m2": motor.rotor_inertia_kg_m2,
    }


def motor_facts(motor: Motor) -> list[tuple[str, str]]:
    """Return the lines of a table: name and value with its unit."""
    return [
        ("motor", f"{motor.name}, {motor.kv_rpm_per_v:g} rpm/V, {motor.rated_voltage_v:g} V"),
        ("torque constant", f"{motor.torque_constant_n_m_per_a:.4g} N m/A, DC-equivalent current"),
        ("resistance", f"{motor.terminal_resistance_ohm:.4g} ohm, line to line"),
        ("peak torque", _torque(motor, motor.peak_torque_n_m, motor.peak_torque_time_s)),
        ("", peak_basis(motor)),
        ("continuous torque", _torque(motor, motor.continuous_torque_n_m, motor.continuous_torque_time_s)),
        ("", CONTINUOUS_BASIS),
        *(
            ()
            if motor.lasting_torque_n_m is None
            else (("lasting torque", _torque(motor, motor.lasting_torque_n_m, math.inf)),)
        ),
        ("rotor inertia", f"{motor.rotor_inertia_kg_m2:.3g} kg m2"),
    ]


def _torque(motor: Motor, torque_n_m: float, time_s: float | None) -> str:
    current_a, heat_w = motor.current_a(torque_n_m), motor.winding_heat_w(torque_n_m)
    return f"{torque_n_m:.3g} N m, {current_a:.3g} A, {heat_w:.3g} W, {how_long(time_s)}"


def _finite(time_s: float | None) -> float | None:
    return time_s if time_s is not None and math.isfinite(time_s) else None


@dataclass(frozen=True, slots=True, kw_only=True)
class Gap:
    """Neighbouring intervals without a gearbox."""

    ratio_low: float
    ratio_high: float  #: end of the gap, which belongs to the next interval
    #: For each family, the constraints that forbid its gearboxes; empty if it has no tooth set there
    in_the_way: Mapping[Family, tuple[ConstraintName, ...]]
    cures: tuple[str, ...]  #: what would help in the first interval


_OF_ACTUATOR = (
    *("face_width_mm", "mass_kg", "peak_torque_n_m", "efficiency", "continuous_torque_n_m"),
    *("no_load_speed_rad_per_s", "length_mm", "reflected_inertia_kg_m2"),
)
_OF_LOSSES = ("efficiency_mesh", "efficiency_planets", "efficiency_bearings", "efficiency_total")
_OF_SHEET = ("bearing_life_h", "output_tilt_n_m", "backlash_arcmin", "greatest_backlash_arcmin")


def summary(entry: MapEntry, sheet: ServiceSheet) -> dict[str, Any]:
    """Return one row of the map, for an interval that has a gearbox, with the service sheet of its actuator."""
    actuator = entry.actuator
    assert actuator is not None
    gears = actuator.gears
    return {
        "ratio_low": entry.ratio_low,
        "ratio": actuator.ratio,
        "type": actuator.family,
        **{name: getattr(gears, name) for name in ("sun_teeth", "planet_teeth", "ring_teeth", "module_mm", "planets")},
        **{name: float(getattr(gears, name)) for name in ("sun_shift", "planet_shift", "ring_shift")},
        "centre_distance_mm": float(gears.carrier_radius_mm),
        **{name: getattr(actuator, name) for name in _OF_ACTUATOR},
        **{name: getattr(sheet.losses, name) for name in _OF_LOSSES},
        **{name: getattr(sheet, name) for name in _OF_SHEET},
        "stiffness_n_m_per_rad": sheet.stiffness.stiffness_n_m_per_rad,
        **_caveats(actuator),
        **_safeties(actuator),
    }


def _caveats(actuator: Actuator) -> dict[str, Any]:
    """Return what the torques of a row are worth: both are before losses."""
    motor = actuator.motor
    return {
        "peak_torque_basis": peak_basis(motor),
        "peak_torque_time": how_long(motor.peak_torque_time_s),
        "continuous_torque_basis": CONTINUOUS_BASIS,
        "continuous_torque_time": how_long(motor.continuous_torque_time_s),
        "lasting_torque_n_m": None if (lasting := motor.lasting_torque_n_m) is None else actuator.ratio * lasting,
    }


def _safeties(actuator: Actuator) -> dict[str, float]:
    """Return the least safety factors over the meshes, where the gears are rated."""
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
    """Return everything known about an interval that has a gearbox; its parts from the heaviest to the lightest."""
    actuator = entry.actuator
    assert actuator is not None
    return summary(entry, sheet) | {
        "contact_ratio_sun": actuator.contact_ratio_sun,
        "contact_ratio_ring": actuator.contact_ratio_ring,
        "tips_in_roots_mm": {f"{tip} in {root}": depth for (tip, root), depth in tip_depths_mm(actuator.gears).items()},
        "efficiency_churning": sheet.losses.efficiency_churning,
        "compliance_rad_per_n_m": dataclasses.asdict(sheet.stiffness),
        "bearings": [_bearing(found) for found in sheet.bearings],
        **{
            name: dataclasses.asdict(load) | {"pv_mpa_m_per_s": load.pv_mpa_m_per_s}
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
    """Return where the map has no gearbox, from the lowest ratio to the highest."""
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


_BEARING = ("force_n", "equivalent_n", "tilt_rad", "life_h", "static_safety", "overload_safety")


def _bearing(found: BearingService) -> dict[str, Any]:
    rated = found.bearing
    return {
        "place": found.place,
        "designation": rated.designation,
        "size_mm": [rated.inner_diameter_mm, rated.outer_diameter_mm, rated.width_mm],
        "dynamic_rating_n": rated.dynamic_rating_n,
        "static_rating_n": rated.static_rating_n,
        **{name: getattr(found, name) for name in _BEARING},
    }


def _part(part: Part, motor: Motor) -> dict[str, Any]:
    """Return all instances of one part together; the inertia is about the gearbox axis.

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
