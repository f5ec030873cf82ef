"""Fast weighing: the units of a map's actuators as arrays, and those of the links as functions of their length."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.actuator.service.sheet import service_sheet
from pareto_monoped.geometry.parts import MassProperties, Part, total
from pareto_monoped.geometry.tabulated import Tabulated, tabulate
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.robot.frames import Floats
from pareto_monoped.robot.rotation import actuator_coupling_kg_m2, rotor_excess_kg_m2, rotor_inertia_kg_m2
from pareto_monoped.robot.units import UNITS, ActuatorSized, LinkSized

_TABULATED_M = (0.25, 0.55)  # the paper's lengths, 0.3 to 0.5 m, and some more


@dataclass(frozen=True, slots=True, kw_only=True)
class ActuatorTable:
    """The k actuators of a map as arrays of shape (k,).

    Attributes:
        row: row of each interval's actuator, shape (intervals,); any row where the interval has none.
        ratio: real ratio of the gearbox.
        armature_kg_m2: reflected inertia at the joint.
        coupling_kg_m2, rotor_inertia_kg_m2, rotor_excess_kg_m2: see ``rotation``.
        peak_torque_n_m, continuous_torque_n_m, no_load_speed_rad_per_s, efficiency: see ``Actuator``.
        efficiency_total: of the whole gearbox, see ``actuator.service.losses.Losses``.
    """

    row: NDArray[np.intp]
    ratio: Floats
    armature_kg_m2: Floats
    coupling_kg_m2: Floats
    rotor_inertia_kg_m2: Floats
    rotor_excess_kg_m2: Floats
    peak_torque_n_m: Floats
    continuous_torque_n_m: Floats
    no_load_speed_rad_per_s: Floats
    efficiency: Floats
    efficiency_total: Floats


@lru_cache(maxsize=16)
def actuator_table(actuator_map: ActuatorMap) -> ActuatorTable:
    """The actuators of a map in numbers. The result is kept, as a map is asked for many times."""
    actuators = _actuators(actuator_map)
    row = np.cumsum([entry.actuator is not None for entry in actuator_map.entries]) - 1
    return ActuatorTable(
        row=np.maximum(row, 0),
        ratio=np.array([a.ratio for a in actuators]),
        armature_kg_m2=np.array([a.reflected_inertia_kg_m2 for a in actuators]),
        coupling_kg_m2=np.array([actuator_coupling_kg_m2(a) for a in actuators]),
        rotor_inertia_kg_m2=np.array([rotor_inertia_kg_m2(a) for a in actuators]),
        rotor_excess_kg_m2=np.array([rotor_excess_kg_m2(a) for a in actuators]),
        peak_torque_n_m=np.array([a.peak_torque_n_m for a in actuators]),
        continuous_torque_n_m=np.array([a.continuous_torque_n_m for a in actuators]),
        no_load_speed_rad_per_s=np.array([a.no_load_speed_rad_per_s for a in actuators]),
        efficiency=np.array([a.efficiency for a in actuators]),
        efficiency_total=np.array([service_sheet(a, actuator_map.settings).losses.efficiency_total for a in actuators]),
    )


def _actuators(actuator_map: ActuatorMap) -> list[Actuator]:
    return [entry.actuator for entry in actuator_map.entries if entry.actuator is not None]


@lru_cache(maxsize=128)
def actuator_units(joint: str, actuator_map: ActuatorMap, leg: LegDimensions) -> Mapping[str, MassProperties]:
    """Weigh the units that depend on the actuator of a joint, with every actuator of a map. The result is kept.

    Args:
        joint: ``hip`` or ``knee``.
        actuator_map: of that joint.
        leg: dimensions, which depend on the motors of both joints.

    Returns:
        Name -> mass properties of the joint's ``ActuatorSized`` units in their body frames, one row per actuator.
    """
    actuators = _actuators(actuator_map)
    return {
        unit.name: unit.in_body(_stacked(unit.parts(actuator, leg) for actuator in actuators), leg)
        for unit in UNITS
        if isinstance(unit, ActuatorSized) and unit.joint == joint
    }


def _stacked(units: Iterable[tuple[Part, ...]]) -> MassProperties:
    """Mass properties of several units, one row per unit."""
    masses = [total(part.mass_properties() for part in parts) for parts in units]
    return MassProperties(
        mass_kg=np.array([m.mass_kg for m in masses]),
        first_kg_m=np.array([m.first_kg_m for m in masses]),
        second_kg_m2=np.array([m.second_kg_m2 for m in masses]),
    )


def _weigh(length: str, leg: LegDimensions, lengths_m: Floats) -> list[MassProperties]:
    """The units of one link length in their body frames, part by part, one row per length."""
    return [
        unit.in_body(total(part.mass_properties() for part in unit.parts(lengths_m, leg)), leg)
        for unit in link_units(length)
    ]


def link_units(length: str) -> list[LinkSized]:
    """The units that depend on a link length, in the order of the table."""
    return [unit for unit in UNITS if isinstance(unit, LinkSized) and unit.length == length]


@lru_cache(maxsize=128)
def _link_table(length: str, leg: LegDimensions) -> Tabulated:
    return tabulate(lambda lengths_m: _weigh(length, leg, lengths_m), *_TABULATED_M)


def weighed(length: str, leg: LegDimensions, lengths_m: Floats) -> dict[str, MassProperties]:
    """Name -> mass properties of the units that depend on a link length, in their body frames, one row per length.

    Lengths within the table are interpolated to 12 digits; those beyond its ends are weighed part by part.

    Args:
        length: which length, a name of ``design.NAMES``.
        leg: dimensions.
        lengths_m: shape (n,).
    """
    table = _link_table(length, leg)
    beyond = ~table.covers(lengths_m)
    masses = table(np.clip(lengths_m, table.low_m, table.high_m))
    if beyond.any():
        for mass, exact in zip(masses, _weigh(length, leg, lengths_m[beyond]), strict=True):
            mass.mass_kg[beyond] = exact.mass_kg
            mass.first_kg_m[beyond] = exact.first_kg_m
            mass.second_kg_m2[beyond] = exact.second_kg_m2
    return dict(zip((unit.name for unit in link_units(length)), masses, strict=True))
