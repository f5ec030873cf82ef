"""Fast weighing: the actuators of a map as arrays, and the links as tables of their length."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.geometry.parts import MassProperties, Part, total
from pareto_monoped.geometry.tabulated import Tabulated, tabulate
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.links import base_parts, foot_part, journal_parts, shank_parts, thigh_parts
from pareto_monoped.robot.build import back_clearance_mm, leg_dimensions
from pareto_monoped.robot.frames import OVER, UPRIGHT, Floats, in_body, upright

_TABULATED_M = (0.25, 0.55)  # the paper's lengths, 0.3 to 0.5 m, and some more


@dataclass(frozen=True, slots=True, kw_only=True)
class ActuatorTable:
    """The map's k actuators as arrays, and the parts of the base whose size follows from the knee actuator's length.

    ``row`` leads from an interval of the map to its actuator's row; ``at_hip`` and ``at_knee`` are the actuators in the
    frames of the bodies that carry them.
    """

    row: NDArray[np.intp]
    at_hip: MassProperties
    at_knee: MassProperties
    frame: MassProperties
    journal: MassProperties
    ratio: Floats
    armature_kg_m2: Floats
    peak_torque_n_m: Floats
    continuous_torque_n_m: Floats
    no_load_speed_rad_per_s: Floats
    efficiency: Floats


@lru_cache(maxsize=16)
def actuator_table(actuator_map: ActuatorMap) -> ActuatorTable:
    """Weigh every actuator of a map once; kept for the next call."""
    actuators = [entry.actuator for entry in actuator_map.entries if entry.actuator is not None]
    leg = leg_dimensions(actuator_map)
    row = np.cumsum([entry.actuator is not None for entry in actuator_map.entries]) - 1
    length_m = np.array([1e-3 * a.length_mm for a in actuators])
    clearance_mm = np.array([back_clearance_mm(a) for a in actuators])
    return ActuatorTable(
        row=np.maximum(row, 0),
        at_hip=in_body(_stacked(a.parts for a in actuators), UPRIGHT, leg.hip_mount_mm),
        at_knee=in_body(_stacked(a.parts_bolted_at_back for a in actuators), OVER, leg.knee_mount_mm),
        frame=upright(base_parts(length_m, leg)),
        journal=upright(journal_parts(length_m, leg, back_clearance_mm=clearance_mm)),
        ratio=np.array([a.ratio for a in actuators]),
        armature_kg_m2=np.array([a.reflected_inertia_kg_m2 for a in actuators]),
        peak_torque_n_m=np.array([a.peak_torque_n_m for a in actuators]),
        continuous_torque_n_m=np.array([a.continuous_torque_n_m for a in actuators]),
        no_load_speed_rad_per_s=np.array([a.no_load_speed_rad_per_s for a in actuators]),
        efficiency=np.array([a.efficiency for a in actuators]),
    )


def _stacked(units: Iterable[tuple[Part, ...]]) -> MassProperties:
    """Mass properties of several units, a row a unit."""
    masses = [total(part.mass_properties() for part in parts) for parts in units]
    return MassProperties(
        mass_kg=np.array([m.mass_kg for m in masses]),
        first_kg_m=np.array([m.first_kg_m for m in masses]),
        second_kg_m2=np.array([m.second_kg_m2 for m in masses]),
    )


def _thigh(lengths_m: Floats, leg: LegDimensions) -> tuple[MassProperties, ...]:
    return (upright(thigh_parts(lengths_m, leg)),)


def _shank(lengths_m: Floats, leg: LegDimensions) -> tuple[MassProperties, ...]:
    return upright(shank_parts(lengths_m, leg)), upright((foot_part(lengths_m, leg),))


_LINKS = {"thigh": _thigh, "shank": _shank}


@lru_cache(maxsize=32)
def _link_table(link: str, leg: LegDimensions) -> Tabulated:
    return tabulate(lambda lengths_m: _LINKS[link](lengths_m, leg), *_TABULATED_M)


def weighed(link: str, leg: LegDimensions, lengths_m: Floats) -> tuple[MassProperties, ...]:
    """The units of a link that depend on its length: from the table, beyond its ends part by part."""
    table = _link_table(link, leg)
    beyond = ~table.covers(lengths_m)
    units = table(np.clip(lengths_m, table.low_m, table.high_m))
    if beyond.any():
        for unit, exact in zip(units, _LINKS[link](lengths_m[beyond], leg), strict=True):
            unit.mass_kg[beyond] = exact.mass_kg
            unit.first_kg_m[beyond] = exact.first_kg_m
            unit.second_kg_m2[beyond] = exact.second_kg_m2
    return units
