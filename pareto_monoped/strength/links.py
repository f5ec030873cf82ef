"""The plates of thigh and shank: bending, pull and the force across the link, in elastic theory.

The plates carry everything. The printed cores keep them apart and, bonded to them, keep their narrow sides from
buckling. Sections through holes and the buckling of the sides are in ``strength.plates``.

A plate with windows is a frame. Its two sides carry moment M and axial force N like a beam, M / Z + N / A at the outer
edge. The force V across it bends the sides between bridges and rungs as well (Vierendeel): each has V / 2, so that its
ends bend with V / 2 h / 2 over a clear height h. A rung between two windows takes V p / 2 at the sides' axes, where p
is the distance of rungs. Stresses are summed, although their peaks are not in the same instant (straight beams: Roark's
Formulas for Stress and Strain, chapter 8; the frame: any textbook of structural analysis).
"""

from typing import Any

import numpy as np

from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import Role
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.sandwich import BRIDGE, with_rungs
from pareto_monoped.leg.shank import bridges_of as shank_bridges
from pareto_monoped.leg.shank import shank_parts
from pareto_monoped.leg.thigh import bridges_of as thigh_bridges
from pareto_monoped.leg.thigh import thigh_parts
from pareto_monoped.strength.joint import Structure, link_row

REQUIRED = 1.2
_REASON = (
    "our own choice against yield: 1.1 of EN 1999-1-1 for the metal, and 10 percent for the scatter of an impact; the "
    "summed peaks are an upper bound"
)
_SOURCE = "beam and Vierendeel frame, see strength.links; yield of the plates' alloy from the materials"
_ANY_LENGTH_M = 0.4  # of a link whose plates are asked for their alloy


def section_modulus_mm3(half_width_mm: float, window_half_width_mm: float, thickness_mm: float) -> float:
    """Return Z of a plate across a window, bent in its plane."""
    return thickness_mm * ((2.0 * half_width_mm) ** 3 - (2.0 * window_half_width_mm) ** 3) / (12.0 * half_width_mm)


def side_stress_mpa(moment_n_m: Any, axial_n: Any, across_n: Any, clear_mm: Any, plate: "tuple[Any, Any, Any]") -> Any:
    """Return the stress at the edge of one plate (half width, half width of its window, thickness) beside a window."""
    half, window, thickness = plate
    side = half - window
    bending = 1e3 * moment_n_m / section_modulus_mm3(half, window, thickness)
    frame = 0.25 * across_n * clear_mm / (thickness * side**2 / 6.0)
    return bending + axial_n / (2.0 * thickness * side) + frame


def rung_stress_mpa(across_n: Any, pitch_mm: Any, plate: "tuple[Any, Any, Any]") -> Any:
    """Return the stress at the ends of a plate's rung, where it leaves the sides; see ``side_stress_mpa``."""
    half, window, thickness = plate
    moment = 0.5 * across_n * pitch_mm * window / (0.5 * (half + window))
    return moment / (thickness * (2.0 * BRIDGE) ** 2 / 6.0)


def _linear(heights_of: Any, d: LegDimensions) -> tuple[float, float]:
    """Return the distance of bridges and rungs as a + b length, mm."""
    (top, below, *_), (far_top, far_below, *_) = (heights_of(length, d) for length in (0.0, 1000.0))
    zero = float(top - below)
    return zero, 1e-3 * (float(far_top - far_below) - zero)


def _yield_mpa(parts: tuple[Part, ...]) -> float:
    return min(part.grade.yield_mpa for part in parts if part.role is Role.PLATE and part.grade is not None)


def _thigh(s: Structure) -> tuple[float, ...]:
    d = s.leg
    plate = (d.thigh_half_width_mm, d.thigh_window_half_width_mm, d.plate_mm)
    limit = _yield_mpa(thigh_parts(_ANY_LENGTH_M, d))
    return limit, *plate, *_linear(lambda length, leg: with_rungs(thigh_bridges(length, leg)), d)


def _shank(s: Structure) -> tuple[float, ...]:
    d = s.leg
    # The plates taper; beside the windows of the core they are nowhere narrower than at their lower end.
    plate = (d.shank_bottom_radius_mm, d.shank_window_half_width_mm, d.shank_plate_mm)
    return _yield_mpa(shank_parts(_ANY_LENGTH_M, d)), *plate, *_linear(shank_bridges, d), d.fork_mm


def _fork(s: Structure) -> tuple[float, ...]:
    d = s.leg
    # The fork's window ends in the upper half of the plates, which are wider there than on average.
    plate = (0.5 * (d.shank_top_radius_mm + d.shank_bottom_radius_mm), d.shank_window_half_width_mm, d.shank_plate_mm)
    return _yield_mpa(shank_parts(_ANY_LENGTH_M, d)), *plate, d.fork_mm


def _thigh_plate(limit: Any, half: Any, window: Any, thick: Any, zero: Any, slope: Any, *loads: Any) -> Any:
    """Return the factor of a thigh plate: half of the stop's torque at the knee, all of its own actuator's at the hip.

    The chain's pull and half of the force at the knee press the plate, and the other half goes across it.
    """
    gear, stop, chain, knee, length = loads
    clear = zero + slope * 1e3 * length - 2.0 * BRIDGE
    moment = np.maximum(gear, 0.5 * stop)
    return limit / side_stress_mpa(moment, 0.5 * (chain + knee), 0.5 * knee, clear, (half, window, thick))


def _thigh_rungs(limit: Any, half: Any, window: Any, thick: Any, zero: Any, slope: Any, knee: Any, length: Any) -> Any:
    return limit / rung_stress_mpa(0.5 * knee, zero + slope * 1e3 * length, (half, window, thick))


def _shank_fork(limit: Any, half: Any, window: Any, thick: Any, clear: Any, *loads: Any) -> Any:
    """Return the factor beside the fork's window: half of the knee's torque, or of the moment of the force there."""
    gear, knee, length = loads
    moment = 0.5 * np.maximum(gear, knee * length)
    return limit / side_stress_mpa(moment, 0.5 * knee, 0.5 * knee, clear, (half, window, thick))


def _shank_plate(
    limit: Any, half: Any, window: Any, thick: Any, zero: Any, slope: Any, fork: Any, knee: Any, length: Any
) -> Any:
    """Return the factor beside the core's windows: half of the moment of the knee's force about what is below."""
    clear = zero + slope * 1e3 * length - 2.0 * BRIDGE
    moment = 0.5 * knee * (length - 1e-3 * fork)
    return limit / side_stress_mpa(moment, 0.5 * knee, 0.5 * knee, clear, (half, window, thick))


_row = link_row(_SOURCE, REQUIRED, _REASON)


_SIDE = "yield / (M / Z + N / A + V h / 4 / Z_side)"
_RUNG = "yield / (V p / 2 / Z_rung)"
JOINTS = (
    *(
        _row(f"thigh_plate_{plate}",
            f"{_SIDE}; M = max(T_{side}, T_stop / 2), N = (F_chain + F_knee) / 2, V = F_knee / 2",
            (f"peak_gear_torque_{side}_n_m", "peak_stop_torque_knee_n_m", "peak_chain_tension_n", "peak_knee_force_n",
                "thigh_length_m"),
            _thigh, _thigh_plate, (f"thigh_plate_{plate}",))
        for plate, side in (("inner", "hip"), ("outer", "knee"))
    ),
    _row("thigh_plate_rungs", f"{_RUNG}; V = F_knee / 2", ("peak_knee_force_n", "thigh_length_m"), _thigh, _thigh_rungs,
        ("thigh_plate_inner", "thigh_plate_outer")),
    _row("shank_plate_fork", f"{_SIDE}; M = max(T_knee, F_knee l) / 2, N = V = F_knee / 2",
        ("peak_gear_torque_knee_n_m", "peak_knee_force_n", "shank_length_m"), _fork, _shank_fork,
        ("shank_plate_near", "shank_plate_far")),
    _row("shank_plate_sides", f"{_SIDE}; M = F_knee (l - fork) / 2, N = V = F_knee / 2",
        ("peak_knee_force_n", "shank_length_m"), _shank, _shank_plate, ("shank_plate_near", "shank_plate_far")),
)  # fmt: skip
