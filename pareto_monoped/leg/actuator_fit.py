"""What the leg needs to know of the actuators of one joint: bolt circles, dowels, sizes, and their motor's driver."""

from dataclasses import dataclass

import numpy as np

from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.errors import DesignError
from pareto_monoped.geometry.dowels import Dowel
from pareto_monoped.geometry.shapes import Pattern
from pareto_monoped.leg.motor_drivers import MotorDriver, motor_driver_for

_THREAD_SPARE_MM = 0.5  # between a screw's end and the end of its thread; our own choice


@dataclass(frozen=True, slots=True, kw_only=True)
class ActuatorFit:
    """Dimensions that a leg takes from the actuators of a joint.

    Attributes:
        mount_pitch_radius_mm, mount_holes: bolts between the actuator's housing and a plate (M3).
        mount_thread_mm: usable depth of their threads in the housing.
        mount_dowel_mm, mount_dowels: dowels in gaps between these bolts, as deep as their threads.
        housing_radius_mm: of the actuator's case.
        output_pitch_radius_mm, output_holes: bolts between output flange and coupling (M3).
        output_thread_mm: usable depth of their threads in the flange.
        output_dowel_mm, output_dowels: dowels in gaps between these bolts, as deep as their threads.
        coupler_radius_mm: of the output flange.
        back_pitch_radius_mm, back_holes, back_screw_mm: bolts of the motor's own mounting pattern, at the back, and
            their diameter.
        driver: the motor driver.
        driver_note: what the parts list says beside its name: that it limits the motor, where it does.
        torque_n_m: largest peak torque of the joint's actuators.
    """

    mount_pitch_radius_mm: float
    mount_holes: int
    mount_thread_mm: float
    mount_dowel_mm: float
    mount_dowels: int
    housing_radius_mm: float
    output_pitch_radius_mm: float
    output_holes: int
    output_thread_mm: float
    output_dowel_mm: float
    output_dowels: int
    coupler_radius_mm: float
    back_pitch_radius_mm: float
    back_holes: int
    back_screw_mm: float
    driver: MotorDriver
    driver_note: str
    torque_n_m: float

    @property
    def output_dowel(self) -> Pattern:
        """Holes of the dowels between the output flange and its coupling, as they are in the actuator's frame."""
        gap = np.pi / self.output_holes
        return Dowel(diameter_mm=self.output_dowel_mm).holes(2.0 * self.output_pitch_radius_mm, self.output_dowels, gap)

    @property
    def mount_dowel(self) -> Pattern:
        """Holes of the dowels between the actuator's housing and a plate, likewise."""
        gap = np.pi / self.mount_holes
        return Dowel(diameter_mm=self.mount_dowel_mm).holes(2.0 * self.mount_pitch_radius_mm, self.mount_dowels, gap)

    @property
    def rim_radius_mm(self) -> float:
        """Radius of the round plate that carries the actuator's housing: 6 mm of plate outside the screws' circle."""
        return self.mount_pitch_radius_mm + 6.0


def actuator_fit(actuator_map: ActuatorMap) -> ActuatorFit:
    """What a leg takes from the actuators of a map.

    All actuators of a map have the same output. Where its two families have different mounts, the leg fits the mount of
    the lowest ratio; an export refuses the other one.

    Raises:
        DesignError: the map has no actuator.
    """
    actuators = [entry.actuator for entry in actuator_map.entries if entry.actuator is not None]
    if not actuators:
        raise DesignError(
            f"actuators of {actuator_map.motor.name} = 0: a leg needs at least one to be drilled for; "
            "choose another motor or other actuator settings"
        )
    mount, output = actuators[0].mount, actuators[0].output
    motor = actuator_map.motor
    driver = motor_driver_for(motor)
    return ActuatorFit(
        mount_pitch_radius_mm=0.5 * mount.bolts.pitch_circle_mm,
        mount_holes=mount.bolts.count,
        mount_thread_mm=mount.thread_depth_mm - _THREAD_SPARE_MM,
        mount_dowel_mm=mount.dowels.diameter_mm,
        mount_dowels=mount.dowels.count,
        housing_radius_mm=mount.housing_radius_mm,
        output_pitch_radius_mm=0.5 * output.bolts.pitch_circle_mm,
        output_holes=output.bolts.count,
        output_thread_mm=output.thread_depth_mm - _THREAD_SPARE_MM,
        output_dowel_mm=output.dowels.diameter_mm,
        output_dowels=output.dowels.count,
        coupler_radius_mm=output.flange_radius_mm,
        back_pitch_radius_mm=0.5 * mount.back_bolts.pitch_circle_mm,
        back_holes=mount.back_bolts.count,
        back_screw_mm=mount.back_bolts.diameter_mm,
        driver=driver,
        driver_note="" if driver.carries(motor) else f"; {driver.limit(motor)}",
        torque_n_m=max(actuator.peak_torque_n_m for actuator in actuators),
    )
