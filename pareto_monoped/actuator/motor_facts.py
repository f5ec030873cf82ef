"""What a motor is and can do, in words for a table and as plain values for JSON."""

import math
from typing import Any

from pareto_monoped.actuator.motor import Motor

_NOT_KNOWN = "not known"


def motor_values_shown(motor: Motor) -> dict[str, Any]:
    """Plain values; a time is None where it is not known, and also where the torque may be held for ever."""
    return {
        "name": motor.name,
        "kv_rpm_per_v": motor.kv_rpm_per_v,
        "torque_constant_n_m_per_a": motor.torque_constant_n_m_per_a,
        "terminal_resistance_ohm": motor.terminal_resistance_ohm,
        "peak_torque_n_m": motor.peak_torque_n_m,
        "peak_torque_time_s": _finite(motor.peak_torque_time_s),
        "continuous_torque_n_m": motor.continuous_torque_n_m,
        "continuous_torque_time_s": _finite(motor.continuous_torque_time_s),
        "rotor_inertia_kg_m2": motor.rotor_inertia_kg_m2,
    }


def motor_facts(motor: Motor) -> list[tuple[str, str]]:
    """Lines of a table: name and value with its unit."""
    return [
        ("motor", f"{motor.name}, {motor.kv_rpm_per_v:g} rpm/V, {motor.rated_voltage_v:g} V"),
        ("torque constant", f"{motor.torque_constant_n_m_per_a:.4g} N m/A, DC-equivalent current"),
        ("resistance", f"{motor.terminal_resistance_ohm:.4g} ohm, line to line"),
        ("peak torque", _torque(motor, motor.peak_torque_n_m, motor.peak_torque_time_s)),
        ("continuous torque", _torque(motor, motor.continuous_torque_n_m, motor.continuous_torque_time_s)),
        ("rotor inertia", f"{motor.rotor_inertia_kg_m2:.3g} kg m2"),
    ]


def _torque(motor: Motor, torque_n_m: float, time_s: float | None) -> str:
    if time_s is None:
        how_long = f"time from cold: {_NOT_KNOWN}"
    elif math.isinf(time_s):
        how_long = "for ever"
    else:
        how_long = f"{time_s:.1f} s from cold"
    current_a, heat_w = motor.current_a(torque_n_m), motor.winding_heat_w(torque_n_m)
    return f"{torque_n_m:.3g} N m, {current_a:.3g} A, {heat_w:.3g} W, {how_long}"


def _finite(time_s: float | None) -> float | None:
    return time_s if time_s is not None and math.isfinite(time_s) else None
