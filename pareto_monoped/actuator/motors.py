"""Motors: the six that ship with the package and a user's own from a TOML file, checked field by field."""

import math
from dataclasses import dataclass, fields
from functools import lru_cache
from importlib import resources
from pathlib import Path
from typing import Annotated, Any

from pydantic import ConfigDict, Field

from pareto_monoped.config import checked, read_toml
from pareto_monoped.errors import MotorError
from pareto_monoped.materials import MATERIALS

Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
# The search tries all tooth numbers that fit. Beyond this size it takes many seconds, and no leg needs such a motor.
Diameter = Annotated[float, Field(gt=0.0, le=400.0, allow_inf_nan=False)]
_STRICT = ConfigDict(extra="forbid")

PEAK_TO_CONTINUOUS = 5.5 / 3.82
"""Peak over continuous torque where a motor's peak torque is not published: the VT8020's own, 5.5 / 3.82 = 1.44."""

BELL_THICKNESS_MM = 2.0
"""Of an outrunner's bell where the stator's height is not published: VT8020 and U12 are 2.0 mm longer than theirs."""

_STATOR_OUTER_SHARE, _STATOR_INNER_SHARE = 0.90, 0.67
"""Stator diameters over motor diameter where they are not published: means over VT8020, U8, U10 and U12, rounded."""

_ACTIVE_SHARE = 0.79
"""Mass of a frameless motor over that of the framed one where it is not published (VT8020: 0.560 / 0.710)."""

_DIAMETER_MM, _MOUNT_CIRCLE_MM, _OUTPUT_CIRCLE_MM = 89.0, 51.0, 71.5
"""The VT8020's diameter and bolt circles, by which those of other motors are scaled if they are not published."""

AIR_GAP_MM = 0.5
"""Magnetic air gap of small outrunners, per side; an estimate."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HolePattern:
    """Holes evenly spread on a circle."""

    __pydantic_config__ = _STRICT

    pitch_circle_mm: Positive
    diameter_mm: Positive
    count: Annotated[int, Field(ge=2, le=24)]

    def __post_init__(self) -> None:
        if self.diameter_mm >= self.pitch_circle_mm:
            raise ValueError(
                f"diameter_mm = {self.diameter_mm}: must be less than pitch_circle_mm = {self.pitch_circle_mm}; "
                "correct one of them"
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class FramedMotor:
    """The motor as sold, with its own bearings and base: mass and envelope."""

    __pydantic_config__ = _STRICT

    mass_kg: Positive
    outer_diameter_mm: Diameter
    length_mm: Positive


@dataclass(frozen=True, slots=True, kw_only=True)
class FramelessMotor:
    """Stator and rotor alone; the gearbox goes into the stator's bore.

    ``stator_height_mm`` defaults to the length less a bell of 2 mm.
    """

    __pydantic_config__ = _STRICT

    mass_kg: Positive
    outer_diameter_mm: Diameter
    length_mm: Positive
    stator_inner_diameter_mm: Positive
    stator_outer_diameter_mm: Positive
    stator_height_mm: Positive | None = None

    def __post_init__(self) -> None:
        if self.stator_inner_diameter_mm >= self.stator_outer_diameter_mm:
            raise ValueError(
                f"stator_inner_diameter_mm = {self.stator_inner_diameter_mm}: must be less than "
                f"stator_outer_diameter_mm = {self.stator_outer_diameter_mm}; correct one of them"
            )
        if self.stator_outer_diameter_mm + 2.0 * AIR_GAP_MM >= self.outer_diameter_mm:
            raise ValueError(
                f"stator_outer_diameter_mm = {self.stator_outer_diameter_mm}: must leave an air gap of {AIR_GAP_MM} mm "
                f"and a rotor inside outer_diameter_mm = {self.outer_diameter_mm}; correct one of them"
            )
        if self.stator_height_mm is None:
            if self.length_mm <= BELL_THICKNESS_MM:
                raise ValueError(
                    f"length_mm = {self.length_mm}: must exceed the bell's {BELL_THICKNESS_MM} mm; correct it"
                )
            object.__setattr__(self, "stator_height_mm", self.length_mm - BELL_THICKNESS_MM)
        elif self.stator_height_mm >= self.length_mm:
            raise ValueError(
                f"stator_height_mm = {self.stator_height_mm}: must be less than length_mm = {self.length_mm}; "
                "correct one of them"
            )

    @property
    def bell_thickness_mm(self) -> float:
        """Length of the frameless motor less that of its stator."""
        assert self.stator_height_mm is not None
        return self.length_mm - self.stator_height_mm


@dataclass(frozen=True, slots=True, kw_only=True)
class Motor:
    """A brushless outrunner. Values that are not given are derived.

    Attributes:
        name: as asked for.
        description: maker and type.
        kv_rpm_per_v: speed constant.
        rated_voltage_v, rated_power_w, max_continuous_current_a, winding_resistance_ohm: as published.
        torque_constant_n_m_per_a: default 60 / (2 pi Kv), the speed constant in SI.
        continuous_torque_n_m: default torque constant times continuous current.
        peak_torque_n_m: default ``PEAK_TO_CONTINUOUS`` times the continuous torque.
        framed: for a gearbox outside the motor (ESSPG), or None.
        frameless: for a gearbox inside the stator (ISSPG), or None.
        mount_holes: in the base of the framed motor; default: the VT8020's circle scaled to the diameter, 4 x M4.
        output_holes: in the rotor's face; default: likewise, 6 x M3.
        rotor_inertia_kg_m2: about the axis; default: the estimate of ``estimated_rotor_inertia_kg_m2``.
    """

    __pydantic_config__ = _STRICT

    name: str
    description: str = ""
    kv_rpm_per_v: Positive
    rated_voltage_v: Positive
    rated_power_w: Positive | None = None
    max_continuous_current_a: Positive
    winding_resistance_ohm: Positive
    torque_constant_n_m_per_a: Positive = 0.0
    continuous_torque_n_m: Positive = 0.0
    peak_torque_n_m: Positive = 0.0
    framed: FramedMotor | None = None
    frameless: FramelessMotor | None = None
    mount_holes: HolePattern | None = None
    output_holes: HolePattern | None = None
    rotor_inertia_kg_m2: Positive = 0.0

    def __post_init__(self) -> None:
        # Zero stands for "not given": a value that is given is checked to be positive before it gets here.
        def fill(name: str, value: object) -> None:
            if not getattr(self, name):
                object.__setattr__(self, name, value)

        if self.framed is None and self.frameless is None:
            raise ValueError("framed and frameless are both missing; give at least one of them")
        if self.framed and self.frameless and self.frameless.mass_kg > self.framed.mass_kg:
            raise ValueError(
                f"frameless.mass_kg = {self.frameless.mass_kg}: must be at most "
                f"framed.mass_kg = {self.framed.mass_kg}; correct one of them"
            )
        fill("torque_constant_n_m_per_a", 60.0 / (2.0 * math.pi * self.kv_rpm_per_v))
        fill("continuous_torque_n_m", self.torque_constant_n_m_per_a * self.max_continuous_current_a)
        fill("peak_torque_n_m", PEAK_TO_CONTINUOUS * self.continuous_torque_n_m)
        if self.peak_torque_n_m < self.continuous_torque_n_m:
            raise ValueError(
                f"peak_torque_n_m = {self.peak_torque_n_m}: must be at least the continuous torque, "
                f"{self.continuous_torque_n_m:.4g} N m; correct one of them"
            )
        scale = self.outer_diameter_mm / _DIAMETER_MM
        fill("mount_holes", HolePattern(pitch_circle_mm=_MOUNT_CIRCLE_MM * scale, diameter_mm=4.0, count=4))
        fill("output_holes", HolePattern(pitch_circle_mm=_OUTPUT_CIRCLE_MM * scale, diameter_mm=3.0, count=6))
        fill("rotor_inertia_kg_m2", self.estimated_rotor_inertia_kg_m2())

    @property
    def outer_diameter_mm(self) -> float:
        """Of the frameless motor, or of the framed one if there is no frameless one."""
        motor = self.frameless or self.framed
        assert motor is not None
        return motor.outer_diameter_mm

    @property
    def no_load_speed_rad_per_s(self) -> float:
        """Speed constant times rated voltage."""
        return self.kv_rpm_per_v * self.rated_voltage_v * 2.0 * math.pi / 60.0

    @property
    def stator_diameters_mm(self) -> tuple[float, float]:
        """Inner and outer; by the usual proportions where they are not published."""
        if self.frameless is not None:
            return self.frameless.stator_inner_diameter_mm, self.frameless.stator_outer_diameter_mm
        return _STATOR_INNER_SHARE * self.outer_diameter_mm, _STATOR_OUTER_SHARE * self.outer_diameter_mm

    def rotor_share(self) -> float:
        """Estimated share of the rotor in the motor's active mass, from the cross-sections of rotor ring and stator."""
        inner, outer = self.stator_diameters_mm
        # In g/cm3; the share does not depend on the unit.
        rotor_density, stator_density = (
            1e-3 * material.density_kg_per_m3 for material in (MATERIALS.motor_rotor, MATERIALS.motor_stator)
        )
        rotor = rotor_density * (self.outer_diameter_mm**2 - (outer + 2.0 * AIR_GAP_MM) ** 2)
        stator = stator_density * (outer**2 - inner**2)
        return rotor / (rotor + stator)

    def estimated_rotor_inertia_kg_m2(self) -> float:
        """The rotor as a ring between air gap and outer diameter, with its share of the active mass.

        The active mass is that of the frameless motor, or a share of the framed one's. The bell is thin and its radius
        of gyration smaller, so counting its mass into the ring errs to the high side by a few percent. T-Motor gives no
        inertia for the U8; the estimate for it is 0.9e-4 kg m2. Published measurements on motors of that size are about
        1.2e-4 kg m2.
        """
        active = self.frameless.mass_kg if self.frameless else _ACTIVE_SHARE * self.framed.mass_kg  # type: ignore[union-attr]
        _, outer = self.stator_diameters_mm
        r_in, r_out = 0.5e-3 * outer + 1e-3 * AIR_GAP_MM, 0.5e-3 * self.outer_diameter_mm
        return self.rotor_share() * active * 0.5 * (r_in**2 + r_out**2)


@lru_cache(maxsize=1)
def _shipped() -> dict[str, dict[str, Any]]:
    with resources.as_file(resources.files("pareto_monoped") / "data" / "motors.toml") as path:
        return read_toml(path, what="motor file", error=MotorError)


def motor_names() -> tuple[str, ...]:
    """The motors that ship with the package; the first is the default."""
    return tuple(_shipped())


def load_motor(name_or_path: str) -> Motor:
    """A motor by the name of a shipped one (any case), or from a user's TOML file with one motor at its top level.

    Raises:
        MotorError: unknown name, unreadable file, or a field that is missing, unknown or impossible.
    """
    for name, values in _shipped().items():
        if name.lower() == name_or_path.lower():
            return checked(Motor, {"name": name} | values, source=f"motor {name}", error=MotorError)
    path = Path(name_or_path)
    if path.suffix != ".toml" and not path.is_file():
        raise MotorError(
            f"motor = {name_or_path!r}: must be one of {', '.join(motor_names())}, or a TOML file; correct the name"
        )
    values = read_toml(path, what="motor file", error=MotorError)
    known = {field.name for field in fields(Motor)}
    if len(values) == 1 and not known & set(values):
        # A file in the shipped form, with the motor's name as its one table.
        ((name, inner),) = values.items()
        if isinstance(inner, dict):
            values = {"name": name} | inner
    return checked(Motor, {"name": path.stem} | values, source=f"motor file {path}", error=MotorError)
