"""A motor: its record, and what follows from it where a maker does not publish it."""

import math
from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import Field

from pareto_monoped.actuator.windings import ResistanceKind, ThermalData, line_to_line_ohm, torque_constant_n_m_per_a
from pareto_monoped.config import Positive, Strict
from pareto_monoped.geometry.making import Length
from pareto_monoped.geometry.roles import Purchase
from pareto_monoped.geometry.shapes import Numbers

# The search tries all tooth numbers that fit. Beyond this size it takes many seconds, and no leg needs such a motor.
Diameter = Annotated[float, Field(gt=0.0, le=400.0, allow_inf_nan=False)]
Share = Annotated[float, Field(gt=0.0, lt=1.0, allow_inf_nan=False)]
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
_STATOR_KG_PER_M3 = 7100.0
"""Mean of a stator: laminations (7.8 g/cm3) fill 60 percent, and copper (8.96 g/cm3) 45 percent of the slots; end turns
add half of the copper again: 0.6 x 7.8 + 1.5 x 0.4 x 0.45 x 8.96."""
_ROTOR_KG_PER_M3 = 6930.0
"""Mean of a rotor's ring: half back iron (7.85 g/cm3), half NdFeB magnets (7.5 g/cm3) on 80 percent of the circle.
The shares are usual ones; with them the U8's inertia lies between the two published for its class."""
MOUNT_BORE_MM = 25.0
"""Across what lies within the mounting holes: the rear bearing's seat (6800, 19 mm, with 2.5 mm of wall) and the rim of
the thread pad. It also leaves room for the journal behind."""
OUTPUT_BORE_MM = 14.0
"""Across the coupling's hub within the holes of the turning face: a spline of 10 mm in 2 mm of metal."""
AIR_GAP_MM = 0.5
"""Magnetic air gap of small outrunners, per side; an estimate."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HolePattern(Strict):
    """Holes evenly spread on a circle."""

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
class FramedMotor(Strict):
    """The motor as sold, with its own bearings and base: mass and envelope."""

    mass_kg: Positive
    outer_diameter_mm: Diameter
    length_mm: Positive


@dataclass(frozen=True, slots=True, kw_only=True)
class FramelessMotor(Strict):
    """Stator and rotor alone; the gearbox goes into the stator's bore. Its default height leaves a bell."""

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
class Motor(Strict):
    """A brushless outrunner. Values that are not given are derived.

    Example:
        >>> from dataclasses import replace
        >>> from pareto_monoped import load_motor
        >>> known = load_motor("U8")
        >>> cooler = replace(known, name="U8 cooler", winding_resistance_ohm=0.8 * known.winding_resistance_ohm)
        >>> cooler.name, cooler.kv_rpm_per_v == known.kv_rpm_per_v
        ('U8 cooler', True)
    """

    name: str  #: as asked for
    description: str = ""  #: maker and type
    kv_rpm_per_v: Positive  #: speed constant
    rated_voltage_v: Positive  #: as published
    rated_power_w: Positive | None = None  #: as published
    max_continuous_current_a: Positive  #: as published, of the equivalent DC machine, see ``windings``
    winding_resistance_ohm: Positive  #: as published, at 25 C
    #: Of the DC-equivalent current; default 60 / (2 pi Kv), the speed constant in SI
    torque_constant_n_m_per_a: Positive = 0.0
    continuous_torque_n_m: Positive = 0.0  #: default torque constant times continuous current
    peak_torque_n_m: Positive = 0.0  #: default ``PEAK_TO_CONTINUOUS`` times the continuous torque
    framed: FramedMotor | None = None  #: for a gearbox outside the motor (ESSPG), or None
    frameless: FramelessMotor | None = None  #: for a gearbox inside the stator (ISSPG), or None
    #: In the base of the framed motor; default: the VT8020's circle scaled to the diameter, 4 x M4
    mount_holes: HolePattern | None = None
    output_holes: HolePattern | None = None  #: in the rotor's face; default: likewise, 6 x M3
    rotor_inertia_kg_m2: Positive = 0.0  #: about the axis; default: the estimate of ``estimated_rotor_inertia_kg_m2``
    #: Which resistance that is; line to line unless something else is known
    winding_resistance_kind: ResistanceKind = "line_to_line"
    #: Of the rotor in the motor's active mass; default: the estimate of ``estimated_rotor_mass_share``
    rotor_mass_share: Share = 0.0
    thermal: ThermalData | None = None  #: measured thermal properties, or None
    price_eur: Positive | None = None  #: list price, or None for that of its class in ``data/cost.toml``

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
        fill("torque_constant_n_m_per_a", torque_constant_n_m_per_a(self.kv_rpm_per_v))
        fill("continuous_torque_n_m", self.torque_constant_n_m_per_a * self.max_continuous_current_a)
        fill("peak_torque_n_m", PEAK_TO_CONTINUOUS * self.continuous_torque_n_m)
        if self.peak_torque_n_m < self.continuous_torque_n_m:
            raise ValueError(
                f"peak_torque_n_m = {self.peak_torque_n_m}: must be at least the continuous torque, "
                f"{self.continuous_torque_n_m:.4g} N m; correct one of them"
            )
        fill("mount_holes", self._usual_holes(_MOUNT_CIRCLE_MM, MOUNT_BORE_MM, diameter_mm=4.0, count=4))
        fill("output_holes", self._usual_holes(_OUTPUT_CIRCLE_MM, OUTPUT_BORE_MM, diameter_mm=3.0, count=6))
        fill("rotor_mass_share", self.estimated_rotor_mass_share())
        fill("rotor_inertia_kg_m2", self.estimated_rotor_inertia_kg_m2())

    def _usual_holes(self, circle_mm: float, bore_mm: float, *, diameter_mm: float, count: int) -> HolePattern:
        """Return the holes on the VT8020's circle, scaled to this motor's diameter; around ``bore_mm`` at least."""
        scaled = circle_mm * self.outer_diameter_mm / _DIAMETER_MM
        return HolePattern(pitch_circle_mm=max(scaled, bore_mm + diameter_mm), diameter_mm=diameter_mm, count=count)

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

    @property
    def terminal_resistance_ohm(self) -> float:
        """Line to line; its product with the square of torque over torque constant is the heat of all phases."""
        return line_to_line_ohm(self.winding_resistance_ohm, self.winding_resistance_kind)

    def price_share_eur(self, share: float) -> float | None:
        """Return the price of one of the parts that a motor is drawn as; None where the motor's file has no price."""
        return None if self.price_eur is None else share * self.price_eur

    def current_a(self, torque_n_m: float) -> float:
        """Return DC-equivalent current of a torque."""
        return torque_n_m / self.torque_constant_n_m_per_a

    def winding_heat_w(self, torque_n_m: float) -> float:
        """Return the heat of all phases together at a torque and 25 C."""
        return self.terminal_resistance_ohm * self.current_a(torque_n_m) ** 2

    @property
    def peak_torque_time_s(self) -> float | None:
        """How long the peak torque may be held from cold, infinite if for ever; None where ``thermal`` is not known."""
        return self._time_to_limit_s(self.peak_torque_n_m)

    @property
    def continuous_torque_time_s(self) -> float | None:
        """The same for the published continuous torque; many makers mean a motor in the wind of its propeller."""
        return self._time_to_limit_s(self.continuous_torque_n_m)

    @property
    def peak_is_assumed(self) -> bool:
        """Whether the peak torque is ``PEAK_TO_CONTINUOUS`` times the continuous one, as where none is published."""
        return self.peak_torque_n_m == PEAK_TO_CONTINUOUS * self.continuous_torque_n_m

    @property
    def lasting_torque_n_m(self) -> float | None:
        """What the winding stands for ever in still air; None where ``thermal`` is not known."""
        if self.thermal is None:
            return None
        heat_w = self.thermal.lasting_heat_w(continuous_heat_w=self.winding_heat_w(self.continuous_torque_n_m))
        return self.torque_constant_n_m_per_a * math.sqrt(heat_w / self.terminal_resistance_ohm)

    def _time_to_limit_s(self, torque_n_m: float) -> float | None:
        if self.thermal is None:
            return None
        return self.thermal.time_to_limit_s(
            self.winding_heat_w(torque_n_m), continuous_heat_w=self.winding_heat_w(self.continuous_torque_n_m)
        )

    def estimated_rotor_mass_share(self) -> float:
        """Return the rotor's share in the active mass, estimated from the cross-sections of rotor ring and stator."""
        return mass_share(self, _ROTOR_KG_PER_M3, _STATOR_KG_PER_M3)

    def estimated_rotor_inertia_kg_m2(self) -> float:
        """Return the rotor as a ring between air gap and outer diameter, with its share of the active mass.

        The active mass is that of the frameless motor, or a share of the framed one's. The bell is thin and its radius
        of gyration smaller, so counting its mass into the ring errs to the high side by a few percent. For the U8 the
        estimate is 6.2e-5 kg m2; 6.07e-5 and 6.3e-5 are published for motors of its class, see ``data/motors.toml``.
        """
        if self.frameless is not None:
            active = self.frameless.mass_kg
        else:
            assert self.framed is not None  # one of both is there
            active = _ACTIVE_SHARE * self.framed.mass_kg
        _, outer = self.stator_diameters_mm
        r_in, r_out = 0.5e-3 * outer + 1e-3 * AIR_GAP_MM, 0.5e-3 * self.outer_diameter_mm
        return self.rotor_mass_share * active * 0.5 * (r_in**2 + r_out**2)


def mass_share(motor: Motor, rotor_kg_per_m3: float, stator_kg_per_m3: float) -> float:
    """Return the share of the rotor ring in the mass of rotor ring and stator, for mean densities of both."""
    inner, outer = motor.stator_diameters_mm
    # In g/cm3; the share does not depend on the unit.
    rotor = 1e-3 * rotor_kg_per_m3 * (motor.outer_diameter_mm**2 - (outer + 2.0 * AIR_GAP_MM) ** 2)
    stator = 1e-3 * stator_kg_per_m3 * (outer**2 - inner**2)
    return rotor / (rotor + stator)


_ENVELOPE_MM = 0.1
"""Within which a motor is as long as its drawing says; our own assumption, as the data sheets give no limits."""


def envelope_length(z0_mm: Numbers, z1_mm: Numbers, name: str = "length") -> Length:
    """Return a length of a motor with its limits."""
    return Length(name=name, z0_mm=z0_mm, z1_mm=z1_mm, lower_mm=-_ENVELOPE_MM, upper_mm=_ENVELOPE_MM)


def motor_order(motor: Motor, variant: Literal["framed", "frameless"]) -> Purchase:
    """Return the order of a motor; stator and rotor come together."""
    designation = f"motor {motor.name}, {variant}, {motor.kv_rpm_per_v:g} rpm/V"
    remark, kit = motor.description, motor.frameless
    if variant == "frameless" and kit is not None:
        # Not every maker lists it: sizes tell the seller what is meant.
        inner, outer = motor.stator_diameters_mm
        sizes = f"stator {inner:g} x {outer:g} mm, {1e3 * kit.mass_kg:g} g together"
        remark = ", ".join(filter(None, (remark, f"stator and rotor without frame, {sizes}")))
    return Purchase(kind="motor", designation=designation, remark=remark)
