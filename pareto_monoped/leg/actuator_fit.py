"""What the leg needs to know of the actuators of one joint: bolt circles, dowels, sizes, and the motor's driver."""

from dataclasses import dataclass

import numpy as np

from pareto_monoped.actuator.actuator import MountInterface, OutputInterface
from pareto_monoped.actuator.motor import Motor
from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.actuator.windings import PER_PHASE_AMPLITUDE
from pareto_monoped.errors import DesignError
from pareto_monoped.geometry.dowels import Dowel
from pareto_monoped.geometry.screws import M3, M25, Screw
from pareto_monoped.geometry.shapes import Pattern


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorDriver:
    """A motor driver as a bare board."""

    name: str  #: of the board, as it is ordered
    mass_kg: float  #: of the bare board
    width_mm: float  #: of the board with everything on it
    length_mm: float  #: along its longer side
    height_mm: float
    hole_width_mm: float  #: between its mounting holes, along the width
    hole_length_mm: float  #: along the length
    screw: Screw  #: for these holes
    voltage_v: float  #: largest supply voltage
    peak_current_a: float  #: largest phase current, for a few seconds

    def carries(self, motor: Motor) -> bool:
        """Return whether it stands the motor's rated voltage and its peak current."""
        return motor.rated_voltage_v <= self.voltage_v and peak_current_a(motor) <= self.peak_current_a

    def limit(self, motor: Motor) -> str:
        """Return what a motor cannot do with it, in words, where it does not carry the motor."""
        needed = peak_current_a(motor)
        if motor.rated_voltage_v > self.voltage_v:
            return f"takes {self.voltage_v:g} V, less than the {motor.rated_voltage_v:g} V of {motor.name}"
        return (
            f"gives {self.peak_current_a:g} A of the {needed:.0f} A that {motor.name} takes at its peak torque, and so "
            f"{self.peak_current_a / needed:.0%} of that torque"
        )


# Holes: the authors' published actuator design files (motor driver mounts). All other figures: the makers' data sheets.
# Neither says where the holes lie on the board; they are taken as centred on it.
# The height of the first is our own estimate from its connectors; the data sheet gives none.
MOTOR_DRIVERS = (
    MotorDriver(name="moteus r4.11", mass_kg=0.0142, width_mm=46.0, length_mm=53.0, height_mm=10.0,
        hole_width_mm=40.0, hole_length_mm=38.0, screw=M25, voltage_v=44.0, peak_current_a=100.0),
    MotorDriver(name="ODrive Pro", mass_kg=0.032, width_mm=51.0, length_mm=64.0, height_mm=17.5,
        hole_width_mm=45.0, hole_length_mm=42.0, screw=M3, voltage_v=58.0, peak_current_a=120.0),
)  # fmt: skip
"""From the lightest to the heaviest."""


def peak_current_a(motor: Motor) -> float:
    """Return the phase current at the motor's peak torque, as an amplitude, by which drivers are rated."""
    return motor.peak_torque_n_m / (PER_PHASE_AMPLITUDE * motor.torque_constant_n_m_per_a)


def motor_driver_for(motor: Motor) -> MotorDriver:
    """Return the lightest driver that carries a motor, or the strongest one, whose note then says what it lacks."""
    return next((driver for driver in MOTOR_DRIVERS if driver.carries(motor)), MOTOR_DRIVERS[-1])


_THREAD_SPARE_MM = 0.5  # between a screw's end and the end of its thread; our own choice


@dataclass(frozen=True, slots=True, kw_only=True)
class ActuatorFit:
    """Dimensions that a leg takes from the actuators of a joint."""

    mount_pitch_radius_mm: float  #: of the bolts between the actuator's housing and a plate (M3)
    mount_holes: int
    mount_thread_mm: float  #: usable depth of their threads in the housing
    mount_dowel_mm: float  #: of the dowels in gaps between these bolts, as deep as their threads
    mount_dowels: int
    housing_radius_mm: float  #: of the actuator's case
    output_pitch_radius_mm: float  #: of the bolts between output flange and coupling (M3)
    output_holes: int
    output_thread_mm: float  #: usable depth of their threads in the flange
    output_dowel_mm: float  #: of the dowels in gaps between these bolts, as deep as their threads
    output_dowels: int
    coupler_radius_mm: float  #: of the output flange
    #: back_pitch_radius_mm, back_holes, back_screw_mm: bolts of the motor's own mounting pattern, at the back, and
    #: their diameter
    back_pitch_radius_mm: float
    back_holes: int
    back_screw_mm: float
    driver: MotorDriver  #: the motor driver
    driver_note: str  #: what the parts list says beside its name: that it limits the motor, where it does
    torque_n_m: float  #: largest peak torque of the joint's actuators

    @property
    def output_bolts(self) -> Pattern:
        """Clearance holes of the bolts between output flange and coupling."""
        return Pattern(radius_mm=M3.hole, pitch_radius_mm=self.output_pitch_radius_mm, count=self.output_holes)

    @property
    def mount_bolts(self) -> Pattern:
        """Clearance holes of the bolts between the actuator's housing and a plate."""
        return Pattern(radius_mm=M3.hole, pitch_radius_mm=self.mount_pitch_radius_mm, count=self.mount_holes)

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
    """Return what a leg takes from the actuators of a map.

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
    motor = actuator_map.motor
    driver = motor_driver_for(motor)
    note = "" if driver.carries(motor) else driver.limit(motor)
    torque_n_m = max(actuator.peak_torque_n_m for actuator in actuators)
    return fit_of(actuators[0].mount, actuators[0].output, driver, note, torque_n_m)


def fit_of(
    mount: MountInterface, output: OutputInterface, driver: MotorDriver, driver_note: str, torque_n_m: float
) -> ActuatorFit:
    """Return what a leg takes from an actuator's interfaces."""
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
        driver_note=driver_note,
        torque_n_m=torque_n_m,
    )
