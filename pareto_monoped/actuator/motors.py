"""Motors by name or file: the six that ship with the package, a user's own, and those that a study or export stores.

A motor that is read from a file is checked: do its values agree with each other and with what can be built? One that a
study stores is not, because it was accepted once.
"""

import json
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, fields, replace
from functools import lru_cache
from os.path import isfile
from pathlib import Path
from typing import Any

from pareto_monoped.actuator.motor import MOUNT_BORE_MM, OUTPUT_BORE_MM, FramedMotor, HolePattern, Motor, mass_share
from pareto_monoped.actuator.windings import PER_PHASE_AMPLITUDE, PER_PHASE_RMS, torque_constant_n_m_per_a
from pareto_monoped.config import checked, read_shipped, read_toml
from pareto_monoped.errors import InputError, MotorError, unknown_name
from pareto_monoped.materials import MATERIALS

KV_TOLERANCE = 0.10
"""Greatest difference between k_t and 60 / (2 pi Kv), as a share. Makers' k_t are up to 5 percent low, that of
a sinusoidal motor under block commutation; k_t per ampere of a phase current differs by 13 or 22 percent."""
_LOOKS_LIKE = 0.03
"""How close k_t must be to that of another convention to be taken for it; our own choice."""
VOLTAGE_MOST_V = 1500.0
"""Where low voltage ends for direct current (directive 2014/35/EU)."""
RIM_SPEED_MOST_M_PER_S = 150.0
"""Of a rotor with glued magnets, at no-load speed: 50 to 100 m/s are usual, about 150 m/s need a sleeve (Hendershot and
Miller, Design of Brushless Permanent-Magnet Machines). The motors here run at 16 to 33 m/s."""
SHEAR_MOST_KPA = 100.0
"""Of the air gap at peak torque: torque over gap radius and gap surface. Large liquid-cooled machines reach 70 to 100
kPa (Hendershot and Miller, as above); the motors here 16 to 25."""
LENGTH_LEAST_MM = 12.0
"""Of a framed motor: face and base with the threads of their screws, up to 5 mm each, and magnets between them."""
HOLE_MOST_MM = 8.0
"""Largest hole: no motor of up to 400 mm here has larger screws, and M10 needs a thicker face."""
HOLE_WALL_MM = 1.0
"""Least metal around a motor's holes; our own choice."""
DIAMETER_LEAST_MM = MOUNT_BORE_MM + 2.0 * (4.0 + HOLE_WALL_MM)
"""Of a motor: the base's bore, an M4 hole on either side, and metal outside them."""
DENSITY_KG_PER_M3 = (800.0, 8000.0)
"""Least and greatest mass over volume of a motor's body: half of the lightest motor here (U8, 1530), and solid metal
(laminations 7800, magnets 7500, copper 8960). The framed motors here have 1530 to 2340, the frameless ones, without the
stator's bore, 2380 to 4970."""
POWER_OVER_INPUT = (0.1, 3.0)
"""Limits of rated power over rated voltage and continuous current. Makers of propeller motors give the power at
another voltage: 0.97 to 2.0 here (U10). Drives of joints, rated by their shaft power, have less."""
INERTIA_OVER_MASS = (0.005, 1.0)
"""Least and greatest rotor inertia over the motor's mass and squared outer radius: a tenth of a solid rotor of half
the radius and 0.4 of the mass, and a thin ring that has the whole mass. The motors here have 0.13 to 0.29."""


def contradiction(motor: Motor) -> str | None:
    """Return what is wrong with a motor: key, value, what is allowed, cure; None if nothing is."""
    checks = (_wrong_speeds, _wrong_sizes, _wrong_torques, _wrong_masses)
    return next((found for check in checks for found in check(motor)), None)


def _wrong_speeds(motor: Motor) -> Iterator[str]:
    if motor.rated_voltage_v > VOLTAGE_MOST_V:
        yield (
            f"rated_voltage_v = {motor.rated_voltage_v:g}: must be at most {VOLTAGE_MOST_V:g} V, the end of low "
            "voltage; correct it"
        )
    rim = 0.5e-3 * motor.outer_diameter_mm * motor.no_load_speed_rad_per_s
    if rim > RIM_SPEED_MOST_M_PER_S:
        yield (
            f"kv_rpm_per_v = {motor.kv_rpm_per_v:g}: the rotor's rim would run at {rim:.4g} m/s with rated_voltage_v = "
            f"{motor.rated_voltage_v:g}, must be at most {RIM_SPEED_MOST_M_PER_S:g} m/s; correct one of them"
        )
    given, wanted = motor.torque_constant_n_m_per_a, torque_constant_n_m_per_a(motor.kv_rpm_per_v)
    if not abs(given / wanted - 1.0) <= KV_TOLERANCE:
        cure = "correct one of them or leave out torque_constant_n_m_per_a"
        for words, factor in (("amplitude", PER_PHASE_AMPLITUDE), ("RMS value", PER_PHASE_RMS)):
            if abs(given / (factor * wanted) - 1.0) <= _LOOKS_LIKE:
                cure = f"it looks like that per ampere of the phase current's {words}, divide it by {factor:.4f}"
        yield (
            f"torque_constant_n_m_per_a = {given:g}: must be within {KV_TOLERANCE:.0%} of {wanted:.4g} N m/A, "
            f"60 / (2 pi kv_rpm_per_v) with kv_rpm_per_v = {motor.kv_rpm_per_v:g}; {cure}"
        )


def _wrong_sizes(motor: Motor) -> Iterator[str]:
    if not motor.outer_diameter_mm >= DIAMETER_LEAST_MM:
        body = "framed" if motor.frameless is None else "frameless"
        yield (
            f"{body}.outer_diameter_mm = {motor.outer_diameter_mm:g}: must be at least {DIAMETER_LEAST_MM:g} mm to "
            "hold the bolts of its base; choose a larger motor"
        )
    if motor.framed is not None and motor.framed.length_mm < LENGTH_LEAST_MM:
        yield (
            f"framed.length_mm = {motor.framed.length_mm:g}: must be at least {LENGTH_LEAST_MM:g} mm for face, base "
            "and magnets; correct it or leave out framed"
        )
    assert motor.mount_holes is not None
    yield from _wrong_circle("mount_holes", motor.mount_holes, motor, MOUNT_BORE_MM, "the rear bearing's seat")
    assert motor.output_holes is not None
    if motor.framed is not None:  # only the framed motor's turning face has them
        yield from _wrong_circle("output_holes", motor.output_holes, motor, OUTPUT_BORE_MM, "the coupling's hub")


def _wrong_circle(key: str, holes: HolePattern, motor: Motor, bore_mm: float, what: str) -> Iterator[str]:
    circle, hole = holes.pitch_circle_mm, holes.diameter_mm
    most = motor.outer_diameter_mm - hole - 2.0 * HOLE_WALL_MM
    least = bore_mm + hole
    apart = circle * math.sin(math.pi / holes.count)
    if hole > HOLE_MOST_MM:
        yield f"{key}.diameter_mm = {hole:g}: must be at most {HOLE_MOST_MM:g} mm; give smaller holes"
    if circle > most:
        yield (
            f"{key}.pitch_circle_mm = {circle:.4g}: must be at most {most:.4g} mm, so that holes of {hole:g} mm lie "
            f"within outer_diameter_mm = {motor.outer_diameter_mm:g}; correct one of them"
        )
    if circle < least:
        yield (
            f"{key}.pitch_circle_mm = {circle:.4g}: must be at least {least:.4g} mm, with holes of {hole:g} mm around "
            f"{what}, {bore_mm:g} mm across; give a larger circle or smaller holes"
        )
    if apart < hole + HOLE_WALL_MM:
        yield (
            f"{key}.count = {holes.count}: the holes of {hole:g} mm stand {apart:.3g} mm apart on a circle of "
            f"{circle:.4g} mm, must be {hole + HOLE_WALL_MM:g} mm or more; give fewer or smaller holes"
        )


def _wrong_torques(motor: Motor) -> Iterator[str]:
    current = motor.current_a(motor.peak_torque_n_m)
    needed = motor.terminal_resistance_ohm * current
    if not needed <= motor.rated_voltage_v:
        yield (
            f"peak_torque_n_m = {motor.peak_torque_n_m:.4g}: its current of {current:.4g} A needs {needed:.4g} V in "
            f"{motor.terminal_resistance_ohm:g} ohm (winding_resistance_ohm), must be at most rated_voltage_v = "
            f"{motor.rated_voltage_v:g}; correct one of them"
        )
    _, outer = motor.stator_diameters_mm
    body = motor.frameless or motor.framed
    assert body is not None
    shear_kpa = 1e-3 * motor.peak_torque_n_m / (0.5e-9 * math.pi * outer**2 * body.length_mm)
    if not shear_kpa <= SHEAR_MOST_KPA:
        yield (
            f"peak_torque_n_m = {motor.peak_torque_n_m:.4g}: would shear an air gap of {outer:.4g} mm by "
            f"{body.length_mm:g} mm with {shear_kpa:.4g} kPa, must be at most {SHEAR_MOST_KPA:g} kPa; correct it, "
            "kv_rpm_per_v, max_continuous_current_a or the motor's size"
        )


def _wrong_masses(motor: Motor) -> Iterator[str]:
    """Find bodies that are lighter than any motor or heavier than solid metal, and what contradicts their masses."""
    low, high = DENSITY_KG_PER_M3
    for key, body in (("framed", motor.framed), ("frameless", motor.frameless)):
        if body is None:
            continue
        bore = 0.0 if isinstance(body, FramedMotor) else body.stator_inner_diameter_mm
        volume_m3 = 0.25e-9 * math.pi * (body.outer_diameter_mm**2 - bore**2) * body.length_mm
        density = body.mass_kg / volume_m3
        if not low <= density <= high:
            yield (
                f"{key}.mass_kg = {body.mass_kg:g}: {density:.4g} kg/m3 over the motor's size, must be from {low:g} to "
                f"{high:g} kg/m3, or {low * volume_m3:.3g} to {high * volume_m3:.3g} kg; correct it or the motor's size"
            )
    low, high = (share * (motor.rated_voltage_v * motor.max_continuous_current_a) for share in POWER_OVER_INPUT)
    if motor.rated_power_w is not None and not low <= motor.rated_power_w <= high:
        yield (
            f"rated_power_w = {motor.rated_power_w:g}: must be from {low:.4g} to {high:.4g} W, {POWER_OVER_INPUT[0]:g} "
            f"to {POWER_OVER_INPUT[1]:g} times rated_voltage_v times max_continuous_current_a; correct one of them or "
            "leave it out"
        )
    whole = motor.framed or motor.frameless
    assert whole is not None
    most = whole.mass_kg * (0.5e-3 * whole.outer_diameter_mm) ** 2
    low, high = (share * most for share in INERTIA_OVER_MASS)
    if not low <= motor.rotor_inertia_kg_m2 <= high:
        yield (
            f"rotor_inertia_kg_m2 = {motor.rotor_inertia_kg_m2:.4g}: must be from {low:.3g} to {high:.3g} kg m2 for "
            f"one of {whole.mass_kg:g} kg and {whole.outer_diameter_mm:g} mm; correct it, the motor's mass or its size"
        )
    try:
        _ = motor.peak_torque_time_s
    except ValueError as problem:
        yield f"thermal.{problem}"


@lru_cache(maxsize=1)
def _shipped() -> dict[str, dict[str, Any]]:
    return read_shipped("motors.toml", what="motor file", error=MotorError)


def motor_names() -> tuple[str, ...]:
    """Return the motors that ship with the package; the first is the default."""
    return tuple(_shipped())


def _shipped_name(name_or_path: str) -> str | None:
    return next((name for name in _shipped() if name.lower() == name_or_path.lower()), None)


def motor_source(name_or_path: str) -> str:
    """Return what error messages call a motor: ``motor U8`` or ``motor file 'my.toml'``."""
    name = _shipped_name(name_or_path)
    return f"motor file {str(Path(name_or_path))!r}" if name is None else f"motor {name}"


def load_motor(name_or_path: str) -> Motor:
    """Return a motor by the name of a shipped one (any case), or from a user's TOML file with one motor at its top
    level.

    Raises:
        MotorError: unknown name, unreadable file, a field that is missing, unknown or impossible, or fields that
            contradict each other.
    """
    name, source = _shipped_name(name_or_path), motor_source(name_or_path)
    values = _user_values(name_or_path) if name is None else {"name": name} | _shipped()[name]
    motor = checked(Motor, values, source=source, error=MotorError)
    problem = contradiction(motor)
    if problem is not None:
        raise MotorError(f"{source}: {problem}")
    return motor


def require_motor_name(name_or_path: str, *, key: str = "motor") -> None:
    """Refuse what is neither the name of a shipped motor nor may be a file, which is not opened.

    Raises:
        MotorError: an unknown name.
    """
    path = Path(name_or_path)
    if _shipped_name(name_or_path) is None and path.suffix != ".toml" and not isfile(path):
        raise MotorError(unknown_name(key, name_or_path, motor_names(), ", or a TOML file"))


def _user_values(name_or_path: str) -> dict[str, Any]:
    require_motor_name(name_or_path)
    path = Path(name_or_path)
    values = read_toml(path, what="motor file", error=MotorError)
    known = {field.name for field in fields(Motor)}
    if len(values) == 1 and not known & set(values):
        # A file in the shipped form, with the motor's name as its one table.
        ((name, inner),) = values.items()
        if isinstance(inner, dict):
            values = {"name": name} | inner
    return {"name": path.stem} | values


def motor_values(motor: Motor) -> dict[str, Any]:
    """Return every value of a motor as JSON has it; ``stored_motor`` reads it back.

    A field that motors did not always have is left out at the value that ``stored_motor`` gives it, so that studies and
    exports stored before it came keep their hash.
    """
    values: dict[str, Any] = json.loads(json.dumps(asdict(motor)))
    return {name: value for name, value in values.items() if name not in _LATER or value != _LATER[name](motor)}


def stored_motor(values: Mapping[str, Any], *, source: str, error: type[InputError] = MotorError) -> Motor:
    """Return a motor from what a study or an export stores; its values may contradict each other, as they did then.

    Raises:
        MotorError: (or ``error``) a field is missing, unknown or impossible.
    """
    motor = checked(Motor, values, source=source, error=error)
    return replace(motor, **{name: earlier(motor) for name, earlier in _LATER.items() if name not in values})


_LATER: Mapping[str, Callable[[Motor], Any]] = {
    "winding_resistance_kind": lambda _: "line_to_line",
    # Version 0.1.0 took these densities, which leave out the stator's copper.
    "rotor_mass_share": lambda motor: mass_share(
        motor, MATERIALS.motor_rotor.density_kg_per_m3, MATERIALS.motor_stator.density_kg_per_m3
    ),
    "thermal": lambda _: None,
    "price_eur": lambda _: None,
}
"""Fields that motors did not always have, and what they were before."""
