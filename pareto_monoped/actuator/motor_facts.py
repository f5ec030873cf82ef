"""What a motor is and can do, in words for a table and as plain values for JSON."""

import math
from typing import Any

from pareto_monoped.actuator.motor import PEAK_TO_CONTINUOUS, Motor

_NOT_KNOWN = "not known"
CONTINUOUS_BASIS = "rated by maker"
"""Makers of propeller motors rate them in the wind of their propeller, and not for a joint in its housing."""


def peak_basis(motor: Motor) -> str:
    """Where the peak torque comes from."""
    if motor.peak_is_assumed:
        return f"assumed, {PEAK_TO_CONTINUOUS:.2f} times the continuous one"
    return "published"


def how_long(time_s: float | None) -> str:
    """How long a torque may be held, in words."""
    if time_s is None:
        return f"time {_NOT_KNOWN}"
    return "for ever" if math.isinf(time_s) else f"{time_s:.1f} s from cold"


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
        "peak_torque_basis": peak_basis(motor),
        "continuous_torque_basis": CONTINUOUS_BASIS,
        "lasting_torque_n_m": motor.lasting_torque_n_m,
        "rotor_inertia_kg_m2": motor.rotor_inertia_kg_m2,
    }


def motor_facts(motor: Motor) -> list[tuple[str, str]]:
    """Lines of a table: name and value with its unit."""
    return [
        ("motor", f"{motor.name}, {motor.kv_rpm_per_v:g} rpm/V, {motor.rated_voltage_v:g} V"),
        ("torque constant", f"{motor.torque_constant_n_m_per_a:.4g} N m/A, DC-equivalent current"),
        ("resistance", f"{motor.terminal_resistance_ohm:.4g} ohm, line to line"),
        ("peak torque", _torque(motor, motor.peak_torque_n_m, motor.peak_torque_time_s)),
        ("", peak_basis(motor)),
        ("continuous torque", _torque(motor, motor.continuous_torque_n_m, motor.continuous_torque_time_s)),
        ("", CONTINUOUS_BASIS),
        *(
            ()
            if motor.lasting_torque_n_m is None
            else (("lasting torque", _torque(motor, motor.lasting_torque_n_m, math.inf)),)
        ),
        ("rotor inertia", f"{motor.rotor_inertia_kg_m2:.3g} kg m2"),
    ]


def _torque(motor: Motor, torque_n_m: float, time_s: float | None) -> str:
    current_a, heat_w = motor.current_a(torque_n_m), motor.winding_heat_w(torque_n_m)
    return f"{torque_n_m:.3g} N m, {current_a:.3g} A, {heat_w:.3g} W, {how_long(time_s)}"


def _finite(time_s: float | None) -> float | None:
    return time_s if time_s is not None and math.isfinite(time_s) else None
