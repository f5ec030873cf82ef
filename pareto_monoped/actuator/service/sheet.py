"""The service sheet of one actuator: bearings, bushes, losses, stiffness and backlash, each under the stated duty."""

from dataclasses import dataclass

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.layout import layout
from pareto_monoped.actuator.service.bearing_life import BearingService, bearing_services
from pareto_monoped.actuator.service.data import ServiceData, default_service
from pareto_monoped.actuator.service.losses import (
    BushLoad,
    Losses,
    bearing_loss,
    bush_load,
    bush_loss,
    churning_loss,
)
from pareto_monoped.actuator.service.stiffness import Stiffness, backlash_arcmin, stiffness
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.roles import Role


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceSheet:
    """What an actuator is good for beside torque and mass.

    Attributes:
        bearings: every bearing; the main bearing at both joints.
        bush: of the planets, at the continuous torque and the no-load speed, which bounds what lasts.
        bush_duty: of the planets at the duty's mean torque and mean speed.
        losses: by source.
        stiffness: of the parts between rotor and output.
        backlash_arcmin: at the output, between both stops.
    """

    bearings: tuple[BearingService, ...]
    bush: BushLoad
    bush_duty: BushLoad
    losses: Losses
    stiffness: Stiffness
    backlash_arcmin: float

    @property
    def output_tilt_n_m(self) -> float:
        """Largest tilting moment on the main bearing at the peak torque."""
        return max(found.tilt_n_m for found in self.bearings)

    @property
    def bearing_life_h(self) -> float:
        """L10 of the bearing that fails first."""
        return min(found.life_h for found in self.bearings)


def service_sheet(actuator: Actuator, settings: ActuatorSettings, service: ServiceData | None = None) -> ServiceSheet:
    """The service sheet of an actuator.

    Args:
        actuator: the actuator, as built with ``settings``.
        settings: of stage 1, with the duty.
        service: pace, forces and fits; default ``default_service()``.
    """
    service = service or default_service()
    gears, materials = actuator.gears, settings.materials
    at = layout(actuator.motor, actuator.family, gears, actuator.face_width_mm, settings)
    bearings = bearing_services(actuator, at, settings, service)
    # The main bearing turns once; at the knee it carries more than at the hip.
    turning = [found for found in bearings if found.place != "main, hip"]
    pin_mm = settings.parts.carrier.pin_diameter_mm
    (bush,) = (part for part in actuator.parts if part.role is Role.BUSH)
    length_mm = sum(float(prism.z1_mm - prism.z0_mm) for prism in bush.prisms)
    duty = settings.parts.duty
    levels = zip(duty.torque_shares, duty.output_angles_rad, strict=True)
    mean_share = sum(share * angle for share, angle in levels) / sum(duty.output_angles_rad)
    return ServiceSheet(
        bearings=bearings,
        bush=bush_load(gears, actuator.continuous_torque_n_m, actuator.no_load_speed_rad_per_s, pin_mm, length_mm),
        bush_duty=bush_load(
            gears, mean_share * actuator.peak_torque_n_m, service.mean_speed_rad_per_s, pin_mm, length_mm
        ),
        losses=Losses(
            efficiency_mesh=actuator.efficiency,
            efficiency_bushes=1.0 - float(bush_loss(gears, pin_mm, materials.bush_bronze.friction_coefficient)),
            efficiency_bearings=1.0 - bearing_loss(turning, actuator.peak_torque_n_m, service),
            efficiency_churning=1.0 - churning_loss(turning, actuator.peak_torque_n_m, service),
        ),
        stiffness=stiffness(actuator, at, settings),
        backlash_arcmin=backlash_arcmin(gears, settings.parts.gears.backlash_mm),
    )
