"""The actuator map as plain values, for tables and JSON: one row per interval, gaps, and one interval in full."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pareto_monoped.actuator.layout import Family
from pareto_monoped.actuator.ratiomap import ActuatorMap, Candidate, MapEntry
from pareto_monoped.actuator.rules import CONSTRAINTS
from pareto_monoped.actuator.settings import ConstraintName
from pareto_monoped.geometry.parts import Part


@dataclass(frozen=True, slots=True, kw_only=True)
class Gap:
    """Neighbouring intervals without a gearbox.

    Attributes:
        ratio_low, ratio_high: the gap is [ratio_low, ratio_high).
        in_the_way: for each family, the constraints that forbid its gearboxes; empty if it has no tooth set there.
    """

    ratio_low: float
    ratio_high: float
    in_the_way: Mapping[Family, tuple[ConstraintName, ...]]


def summary(entry: MapEntry) -> dict[str, Any]:
    """One row of the map, for an interval that has a gearbox."""
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
        "face_width_mm": actuator.face_width_mm,
        "mass_kg": actuator.mass_kg,
        "peak_torque_n_m": actuator.peak_torque_n_m,
        "efficiency": actuator.efficiency,
    }


def details(entry: MapEntry) -> dict[str, Any]:
    """Everything known about an interval that has a gearbox; its parts from the heaviest to the lightest."""
    actuator = entry.actuator
    assert actuator is not None
    return summary(entry) | {
        "continuous_torque_n_m": actuator.continuous_torque_n_m,
        "no_load_speed_rad_per_s": actuator.no_load_speed_rad_per_s,
        "reflected_inertia_kg_m2": actuator.reflected_inertia_kg_m2,
        "contact_ratio_sun": actuator.contact_ratio_sun,
        "contact_ratio_ring": actuator.contact_ratio_ring,
        "length_mm": actuator.length_mm,
        "runner_up": None if entry.runner_up is None else {"type": entry.runner_up.family, **_best(entry.runner_up)},
        "binding": {name: CONSTRAINTS[name].says for name in entry.binding},
        "families": {
            family: {**_best(found.best), "constraints_in_the_way": list(found.in_the_way)}
            for family, found in entry.families.items()
        },
        "parts": [_part(part) for part in sorted(actuator.parts, key=lambda part: -float(part.mass_kg()))],
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
    )


def _best(found: Candidate | None) -> dict[str, Any]:
    return {"gears": None, "mass_kg": None} if found is None else {"gears": str(found.gears), "mass_kg": found.mass_kg}


def _part(part: Part) -> dict[str, Any]:
    """All instances of one part together; the inertia is about the gearbox axis."""
    second_moment = part.mass_properties().second_kg_m2
    return {
        "name": part.name,
        "material": part.material.name,
        "group": part.group,
        "count": int(part.count),
        "mass_kg": float(part.mass_kg()),
        "axial_inertia_kg_m2": float(second_moment[0, 0] + second_moment[1, 1]),
    }
