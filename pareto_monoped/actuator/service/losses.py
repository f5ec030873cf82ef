"""Losses of one actuator by source: tooth meshes, planets on their pins, bearings, churning."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.service.bearing_life import BearingService
from pareto_monoped.actuator.service.data import ServiceData
from pareto_monoped.actuator.service.planets import planet_turns
from pareto_monoped.geometry.shapes import Numbers

_PALMGREN_LOW, _PALMGREN = 160e-7, 1e-7  # N mm per mm3: Harris, Rolling Bearing Analysis, eqs. 14.11 and 14.12
_PALMGREN_ROW = 2.0  # f0 of a single row of deep groove balls in an oil bath, taken for needles too
_PALMGREN_BOUND = 2000.0  # viscosity in mm2/s times speed in 1/min


@dataclass(frozen=True, slots=True, kw_only=True)
class Losses:
    """Output power over input power if only this source took some, at the peak torque.

    Attributes:
        efficiency_mesh: both tooth meshes.
        efficiency_planets: bushes or needles of the planets on their pins.
        efficiency_bearings: rolling friction of the bearings under load.
        efficiency_churning: of the lubricant in the bearings, at the duty's mean speed; 1 if they churn none.
    """

    efficiency_mesh: float
    efficiency_planets: float
    efficiency_bearings: float
    efficiency_churning: float

    @property
    def efficiency_total(self) -> float:
        """All sources together."""
        return self.efficiency_mesh * self.efficiency_planets * self.efficiency_bearings * self.efficiency_churning


def planet_bearing_loss(gears: GearSet, pin_diameter_mm: float, friction: float) -> Numbers:
    """Power that the planets' bushes or needles take, over the output power.

    Each pin passes its share of the output torque to the carrier: n F = T / r, with the carrier's radius r. Against the
    carrier, a planet turns at Nr / Np of the output's speed (Willis). The friction mu F acts at the pin's radius.
    """
    return friction * 0.5 * pin_diameter_mm * planet_turns(gears) / gears.carrier_radius_mm


def bearing_loss(bearings: Sequence[BearingService], peak_torque_n_m: float) -> float:
    """Power that rolling friction takes at the peak torque, over the output power.

    Simple friction model: M = mu P d / 2 with the equivalent load P and the bore d (SKF, Rolling bearings, section
    bearing friction).
    """
    friction_n_m = sum(
        0.5e-3
        * found.friction_coefficient
        * found.equivalent_n
        * found.bearing.inner_diameter_mm
        * found.turns_per_output
        for found in bearings
    )
    return friction_n_m / peak_torque_n_m


def churning_loss(bearings: Sequence[BearingService], peak_torque_n_m: float, service: ServiceData) -> float:
    """Power that the bearings' lubricant takes at the mean speed, over that at the peak torque (Palmgren)."""
    if not service.lubricant_viscosity_mm2_per_s:
        return 0.0
    drag_n_m = 0.0
    for found in bearings:
        rpm = service.mean_speed_rad_per_s * found.turns_per_output * 30.0 / np.pi
        flow = service.lubricant_viscosity_mm2_per_s * rpm
        factor = _PALMGREN_LOW if flow < _PALMGREN_BOUND else _PALMGREN * flow ** (2.0 / 3.0)
        pitch_mm = 0.5 * (found.bearing.inner_diameter_mm + found.bearing.outer_diameter_mm)
        drag_n_m += 1e-3 * _PALMGREN_ROW * factor * pitch_mm**3 * found.turns_per_output
    return drag_n_m / peak_torque_n_m


@dataclass(frozen=True, slots=True, kw_only=True)
class BushLoad:
    """Pressure and sliding speed of a planet's bush.

    Attributes:
        pressure_mpa: force over the projected area.
        speed_m_per_s: at the pin's surface.
    """

    pressure_mpa: float
    speed_m_per_s: float

    @property
    def pv_mpa_m_per_s(self) -> float:
        """Pressure times speed, which heats and wears the bush."""
        return self.pressure_mpa * self.speed_m_per_s


def bush_load(
    gears: GearSet, output_torque_n_m: float, output_speed_rad_per_s: float, pin_diameter_mm: float, length_mm: float
) -> BushLoad:
    """Load on each planet's bush at a torque and a speed of the output."""
    force_n = 1e3 * output_torque_n_m / (float(gears.planets) * float(gears.carrier_radius_mm))
    turns = float(planet_turns(gears))
    return BushLoad(
        pressure_mpa=force_n / (pin_diameter_mm * length_mm),
        speed_m_per_s=0.5e-3 * pin_diameter_mm * turns * output_speed_rad_per_s,
    )
