"""The service sheet of one actuator under the stated duty: bearings, bushes, losses by source, stiffness, backlash."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.assumptions import ServiceData
from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.layout import layout
from pareto_monoped.actuator.service.bearing_life import BearingService, bearing_services
from pareto_monoped.actuator.service.loads import knee_forces_n, main_bearing_depth_mm, planet_turns
from pareto_monoped.actuator.service.stiffness import Stiffness, backlash_arcmin, greatest_backlash_arcmin, stiffness
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.shapes import Numbers

_PALMGREN_LOW, _PALMGREN = 160e-7, 1e-7  # N mm per mm3: Harris, Rolling Bearing Analysis, eqs. 14.11 and 14.12
_PALMGREN_ROW = 2.0  # f0 of a single row of deep groove balls in an oil bath, taken for needles too
_PALMGREN_BOUND = 2000.0  # viscosity in mm2/s times speed in 1/min


@dataclass(frozen=True, slots=True, kw_only=True)
class Losses:
    """Output power over input power if only this source took some, at the peak torque."""

    efficiency_mesh: float  #: both tooth meshes
    efficiency_planets: float  #: bushes or needles of the planets on their pins
    efficiency_bearings: float  #: rolling friction of the bearings under load
    efficiency_churning: float  #: of the lubricant in the bearings, at the duty's mean speed; 1 if they churn none

    @property
    def efficiency_total(self) -> float:
        """All sources together."""
        return self.efficiency_mesh * self.efficiency_planets * self.efficiency_bearings * self.efficiency_churning


def planet_bearing_loss(gears: GearSet, pin_diameter_mm: float, friction: float) -> Numbers:
    """Return the power that the planets' bushes or needles take, over the output power.

    Each pin passes its share of the output torque to the carrier: n F = T / r, with the carrier's radius r. Against the
    carrier, a planet turns at Nr / Np of the output's speed (Willis). The friction mu F acts at the pin's radius.
    """
    return friction * 0.5 * pin_diameter_mm * planet_turns(gears) / gears.carrier_radius_mm


def bearing_loss(bearings: Sequence[BearingService], peak_torque_n_m: float) -> float:
    """Return the power that rolling friction takes at the peak torque, over the output power.

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
    """Return the lubricant's power in the bearings at the mean speed over that at the peak torque (Palmgren)."""
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
    """Pressure and sliding speed of a planet's bush."""

    pressure_mpa: float  #: force over the projected area
    speed_m_per_s: float  #: at the pin's surface

    @property
    def pv_mpa_m_per_s(self) -> float:
        """Pressure times speed, which heats and wears the bush."""
        return self.pressure_mpa * self.speed_m_per_s


def bush_load(
    gears: GearSet, output_torque_n_m: float, output_speed_rad_per_s: float, pin_diameter_mm: float, length_mm: float
) -> BushLoad:
    """Return the load on each planet's bush at a torque and a speed of the output."""
    force_n = 1e3 * output_torque_n_m / (float(gears.planets) * float(gears.carrier_radius_mm))
    turns = float(planet_turns(gears))
    return BushLoad(
        pressure_mpa=force_n / (pin_diameter_mm * length_mm),
        speed_m_per_s=0.5e-3 * pin_diameter_mm * turns * output_speed_rad_per_s,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceSheet:
    """What an actuator is good for beside torque and mass."""

    bearings: tuple[BearingService, ...]  #: every rolling bearing; the main bearing at both joints
    #: Of the planets, at the continuous torque and the no-load speed, which bounds what lasts; None with needles
    bush: BushLoad | None
    bush_duty: BushLoad | None  #: of the planets at the duty's mean torque and mean speed; likewise
    output_tilt_n_m: float  #: bending moment in the knee's output face at the peak torque
    losses: Losses  #: by source
    stiffness: Stiffness  #: of the parts between rotor and output
    #: backlash_arcmin, greatest_backlash_arcmin: at the output, between both stops, at least and by tolerance of the
    #: teeth at most; without the play of bearings
    backlash_arcmin: float
    greatest_backlash_arcmin: float

    @property
    def bearing_life_h(self) -> float:
        """L10 of the bearing that fails first."""
        return min(found.life_h for found in self.bearings)


def service_sheet(actuator: Actuator, settings: ActuatorSettings, service: ServiceData | None = None) -> ServiceSheet:
    """Return the service sheet of an actuator."""
    service = service or settings.service
    gears, materials = actuator.gears, settings.materials
    thinning_mm = float(gears.backlash_mm)
    at = layout(actuator.motor, actuator.family, gears, actuator.face_width_mm, settings)
    bearings = bearing_services(actuator, at, settings, service)
    # The main bearing turns once; at the knee it carries more than at the hip.
    turning = [found for found in bearings if found.place not in ("main, hip", "planets")]
    pin_mm = settings.parts.carrier.pin_diameter_mm
    needles = settings.planet_bearing == "needles"
    friction = settings.parts.needles.friction_coefficient if needles else materials.bush_bronze.friction_coefficient
    bush, bush_duty = (None, None) if needles else _bush_loads(actuator, settings, service)
    near, _ = knee_forces_n(actuator.peak_torque_n_m, at, service)
    return ServiceSheet(
        bearings=bearings,
        bush=bush,
        bush_duty=bush_duty,
        output_tilt_n_m=float(1e-3 * near * main_bearing_depth_mm(at)),
        losses=Losses(
            efficiency_mesh=actuator.efficiency,
            efficiency_planets=1.0 - float(planet_bearing_loss(gears, pin_mm, friction)),
            efficiency_bearings=1.0 - bearing_loss(turning, actuator.peak_torque_n_m),
            efficiency_churning=1.0 - churning_loss(turning, actuator.peak_torque_n_m, service),
        ),
        stiffness=stiffness(actuator, at, settings),
        backlash_arcmin=backlash_arcmin(gears, thinning_mm),
        greatest_backlash_arcmin=greatest_backlash_arcmin(gears, thinning_mm, settings.thickness_series),
    )


def _bush_loads(actuator: Actuator, settings: ActuatorSettings, service: ServiceData) -> tuple[BushLoad, BushLoad]:
    """Return the loads at the continuous torque and the no-load speed, and at the duty's mean torque and mean speed."""
    gears, pin_mm = actuator.gears, settings.parts.carrier.pin_diameter_mm
    (bush,) = (part for part in actuator.parts if part.role is Role.BUSH)
    length_mm = sum(float(prism.z1_mm - prism.z0_mm) for prism in bush.prisms)
    mean_torque = settings.parts.duty.mean_share * actuator.peak_torque_n_m
    return (
        bush_load(gears, actuator.continuous_torque_n_m, actuator.no_load_speed_rad_per_s, pin_mm, length_mm),
        bush_load(gears, mean_torque, service.mean_speed_rad_per_s, pin_mm, length_mm),
    )
