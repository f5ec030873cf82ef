"""The motor drivers that the base can carry, and the choice by the motor's voltage and current."""

from dataclasses import dataclass

from pareto_monoped.actuator.motor import Motor
from pareto_monoped.actuator.windings import PER_PHASE_AMPLITUDE
from pareto_monoped.geometry.screws import M3, M25, Screw


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorDriver:
    """A motor driver as a bare board.

    Attributes:
        name: of the board, as it is ordered.
        mass_kg: of the bare board.
        width_mm, length_mm, height_mm: of the board with everything on it; the length runs along its longer side.
        hole_width_mm, hole_length_mm: distances of its four mounting holes along width and length.
        screw: for these holes.
        voltage_v: largest supply voltage.
        peak_current_a: largest phase current, for a few seconds.
    """

    name: str
    mass_kg: float
    width_mm: float
    length_mm: float
    height_mm: float
    hole_width_mm: float
    hole_length_mm: float
    screw: Screw
    voltage_v: float
    peak_current_a: float

    def carries(self, motor: Motor) -> bool:
        """Whether it stands the motor's rated voltage and its peak current."""
        return motor.rated_voltage_v <= self.voltage_v and peak_current_a(motor) <= self.peak_current_a

    def limit(self, motor: Motor) -> str:
        """What a motor cannot do with it, in words, where it does not carry the motor."""
        needed = peak_current_a(motor)
        if motor.rated_voltage_v > self.voltage_v:
            return f"takes {self.voltage_v:g} V, less than the {motor.rated_voltage_v:g} V of {motor.name}"
        return (
            f"gives {self.peak_current_a:g} A of the {needed:.0f} A that {motor.name} takes at its peak torque, and so "
            f"{self.peak_current_a / needed:.0%} of that torque"
        )


# Holes: the authors' published actuator design files (motor driver mounts). All other figures: the makers' data sheets.
# Neither says where the holes lie on the board; they are taken as centred on it.
MOTOR_DRIVERS = (
    MotorDriver(
        name="moteus r4.11",
        mass_kg=0.0142,
        width_mm=46.0,
        length_mm=53.0,
        height_mm=10.0,  # our own estimate from its connectors, the data sheet gives none
        hole_width_mm=40.0,
        hole_length_mm=38.0,
        screw=M25,
        voltage_v=44.0,
        peak_current_a=100.0,
    ),
    MotorDriver(
        name="ODrive Pro",
        mass_kg=0.032,
        width_mm=51.0,
        length_mm=64.0,
        height_mm=17.5,
        hole_width_mm=45.0,
        hole_length_mm=42.0,
        screw=M3,
        voltage_v=58.0,
        peak_current_a=120.0,
    ),
)
"""From the lightest to the heaviest."""


def peak_current_a(motor: Motor) -> float:
    """Phase current, as an amplitude, at the motor's peak torque.

    Drivers feed sinusoidal currents and are rated by their amplitude.
    """
    return motor.peak_torque_n_m / (PER_PHASE_AMPLITUDE * motor.torque_constant_n_m_per_a)


def motor_driver_for(motor: Motor) -> MotorDriver:
    """The lightest driver that carries a motor; the strongest one if none does, which its part's note then says."""
    return next((driver for driver in MOTOR_DRIVERS if driver.carries(motor)), MOTOR_DRIVERS[-1])
