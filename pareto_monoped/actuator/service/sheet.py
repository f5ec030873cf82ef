"""The service sheet of one actuator: bearings, bushes, losses, stiffness and backlash, each under the stated duty."""

from dataclasses import dataclass

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.layout import layout
from pareto_monoped.actuator.service.bearing_life import BearingService, bearing_services
from pareto_monoped.actuator.service.data import ServiceData
from pareto_monoped.actuator.service.losses import (
    BushLoad,
    Losses,
    bearing_loss,
    bush_load,
    churning_loss,
    planet_bearing_loss,
)
from pareto_monoped.actuator.service.output import knee_forces_n, main_bearing_depth_mm
from pareto_monoped.actuator.service.stiffness import (
    Stiffness,
    backlash_arcmin,
    greatest_backlash_arcmin,
    stiffness,
)
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.roles import Role


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceSheet:
    """What an actuator is good for beside torque and mass.

    Attributes:
        bearings: every rolling bearing; the main bearing at both joints.
        bush: of the planets, at the continuous torque and the no-load speed, which bounds what lasts; None with
            needles.
        bush_duty: of the planets at the duty's mean torque and mean speed; likewise.
        output_tilt_n_m: bending moment in the knee's output face at the peak torque.
        losses: by source.
        stiffness: of the parts between rotor and output.
        backlash_arcmin, greatest_backlash_arcmin: at the output, between both stops, at least and by tolerance of the
            teeth at most; without the play of bearings.
    """

    bearings: tuple[BearingService, ...]
    bush: BushLoad | None
    bush_duty: BushLoad | None
    output_tilt_n_m: float
    losses: Losses
    stiffness: Stiffness
    backlash_arcmin: float
    greatest_backlash_arcmin: float

    @property
    def bearing_life_h(self) -> float:
        """L10 of the bearing that fails first."""
        return min(found.life_h for found in self.bearings)


def service_sheet(actuator: Actuator, settings: ActuatorSettings, service: ServiceData | None = None) -> ServiceSheet:
    """The service sheet of an actuator.

    Args:
        actuator: the actuator, as built with ``settings``.
        settings: of stage 1, with the duty.
        service: pace, forces and fits; default those of the settings.
    """
    service = service or settings.service
    gears, materials = actuator.gears, settings.materials
    thinning_mm = float(settings.tooth_thinning_mm(gears.module_mm))
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
    """At the continuous torque and the no-load speed, and at the duty's mean torque and mean speed."""
    gears, pin_mm = actuator.gears, settings.parts.carrier.pin_diameter_mm
    (bush,) = (part for part in actuator.parts if part.role is Role.BUSH)
    length_mm = sum(float(prism.z1_mm - prism.z0_mm) for prism in bush.prisms)
    mean_torque = settings.parts.duty.mean_share * actuator.peak_torque_n_m
    return (
        bush_load(gears, actuator.continuous_torque_n_m, actuator.no_load_speed_rad_per_s, pin_mm, length_mm),
        bush_load(gears, mean_torque, service.mean_speed_rad_per_s, pin_mm, length_mm),
    )
