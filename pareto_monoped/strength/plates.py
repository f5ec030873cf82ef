"""The plates of thigh and shank where holes weaken them, and where their sides are pressed.

Sections through holes are elastic, as those beside windows in ``strength.links``, with the same loads. A side of a
plate is a column. Where a printed core is bonded to it, the core is its elastic foundation. Where there is none, in the
shank's fork, the side is clamped at both ends. Short columns yield before they buckle: Johnson's parabola.
"""

from typing import Any

import numpy as np

from pareto_monoped.geometry.screws import M3, Screw
from pareto_monoped.geometry.shapes import Pattern, Shape
from pareto_monoped.leg.sandwich import BRIDGE_BOLT_X, sleeve_hole
from pareto_monoped.leg.shank import FORK_WINDOW_END, FORK_WINDOW_TOP, bottom_axis_mm
from pareto_monoped.leg.shank import bridges_of as shank_bridges
from pareto_monoped.leg.thigh import inner_hip_holes, outer_hip_holes
from pareto_monoped.materials import ALLOYS, MATERIALS
from pareto_monoped.strength.connections import MISES
from pareto_monoped.strength.joint import Structure, link_row, over

PLATE = ALLOYS["aw_6082_t6"]
"""Of all plates of the links."""
CORE_MPA = 2000.0
"""Young's modulus of printed PETG; makers' data sheets: 2.0 to 2.2 GPa in the plane of the layers."""


def sunk_width_mm(screw: Screw, thickness_mm: float) -> float:
    """Return what a countersunk hole takes from the width of a plate: its section over the thickness."""
    radius = sleeve_hole(screw)
    return 2.0 * radius + (screw.countersunk - radius) ** 2 / thickness_mm


def net_section(half_mm: Any, thickness_mm: float, place_mm: float, hole_mm: float) -> tuple[Any, Any]:
    """Return section modulus in mm3 and area in mm2 of a plate bent in its plane, across two holes off its middle."""
    second = (2.0 * half_mm) ** 3 / 12.0 - 2.0 * (hole_mm * place_mm**2 + hole_mm**3 / 12.0)
    return thickness_mm * second / half_mm, thickness_mm * (2.0 * half_mm - 2.0 * hole_mm)


def column_mpa(euler_mpa: Any, yield_mpa: Any) -> Any:
    """Return the stress at which a column fails: Euler's up to half the yield stress, then Johnson's parabola."""
    return np.where(
        euler_mpa < 0.5 * yield_mpa,
        euler_mpa,
        yield_mpa * (1.0 - yield_mpa / (4.0 * np.maximum(euler_mpa, 0.5 * yield_mpa))),
    )


def bedded_mpa(side_mm: float, thickness_mm: float, bed_mm: float, depth_mm: float, modulus_mpa: float) -> float:
    """Return the Euler stress of a long strip on a bed of a depth: N = 2 sqrt(k E I), k = E b / depth."""
    stiffness = CORE_MPA * bed_mm / depth_mm
    second = side_mm * thickness_mm**3 / 12.0
    return float(2.0 * np.sqrt(stiffness * modulus_mpa * second) / (side_mm * thickness_mm))


def clamped_mpa(length_mm: float, thickness_mm: float, modulus_mpa: float) -> float:
    """Return the Euler stress of a strip that is clamped at both ends: 4 pi^2 E / (l / i)^2, i^2 = t^2 / 12."""
    return float(4.0 * np.pi**2 * modulus_mpa * thickness_mm**2 / 12.0 / length_mm**2)


def pressed_mpa(moment_n_m: Any, axial_n: Any, half_mm: Any, window_mm: Any, thickness_mm: Any) -> Any:
    """Return the mean pressure in a plate's pressed side: M over the distance of the sides' axes, and half of N."""
    side = half_mm - window_mm
    return (1e3 * moment_n_m / (half_mm + window_mm) + 0.5 * axial_n) / (side * thickness_mm)


def ring_torque_n_m(holes: tuple[Shape, ...], pitch_radius_mm: float, thickness_mm: float) -> float:
    """Return the torque at which what is left between the holes of a circle yields in shear."""
    taken = sum(
        2.0 * float(hole.radius_mm) * float(hole.count)
        for hole in holes
        if isinstance(hole, Pattern) and np.isclose(float(hole.pitch_radius_mm), pitch_radius_mm)
    )
    net = 2.0 * np.pi * pitch_radius_mm - taken
    return float(1e-3 * MISES * PLATE.yield_mpa * net * thickness_mm * pitch_radius_mm)


def spoke_force_n(hole_radius_mm: float, neck_mm: float, thickness_mm: float) -> float:
    """Return the force across a neck between two round holes at which it yields, bent about its middle, where it is
    straight.

    At a distance s from its narrowest place it is neck + 2 (r - sqrt(r^2 - s^2)) wide and carries the moment F s. The
    mean shear stress is added by von Mises.
    """
    s = np.linspace(0.0, 0.99, 400) * hole_radius_mm
    width = neck_mm + 2.0 * (hole_radius_mm - np.sqrt(hole_radius_mm**2 - s**2))
    bent, sheared = 6.0 * s / (thickness_mm * width**2), 1.0 / (thickness_mm * width)
    return float(PLATE.yield_mpa / np.max(np.hypot(bent, sheared / MISES)))


def _circles(holes: tuple[Shape, ...]) -> tuple[Pattern, ...]:
    return tuple(hole for hole in holes if isinstance(hole, Pattern))


def _around_hip(holes: tuple[Shape, ...], thickness_mm: float) -> float:
    """Return the torque about the hip's axis that a plate carries: the least over all circles of holes."""
    torques = [ring_torque_n_m(holes, float(hole.pitch_radius_mm), thickness_mm) for hole in _circles(holes)]
    for hole in _circles(holes):
        radius, pitch, count = (float(v) for v in (hole.radius_mm, hole.pitch_radius_mm, hole.count))
        neck = 2.0 * pitch * np.sin(np.pi / count) - 2.0 * radius
        torques.append(1e-3 * count * pitch * spoke_force_n(radius, neck, thickness_mm))
    return min(torques)


def inner_hub(s: Structure) -> float:
    """Return the torque of the hip that the inner plate carries around its axis."""
    return _around_hip(inner_hip_holes(s.leg), s.leg.plate_mm)


def outer_hub(s: Structure) -> float:
    """Return the torque of the knee's housing that the outer plate carries around the hip's axis."""
    return _around_hip(outer_hip_holes(s.leg), s.leg.plate_mm)


def _thigh_net(s: Structure) -> tuple[float, ...]:
    d = s.leg
    hole = sunk_width_mm(M3, d.plate_mm)
    return PLATE.yield_mpa, *net_section(d.thigh_half_width_mm, d.plate_mm, BRIDGE_BOLT_X, hole)


def _thigh_bridge(limit: Any, modulus: Any, area: Any, *loads: Any) -> Any:
    """Return the factor; the loads are those of a plate beside its windows."""
    gear, stop, chain, knee = loads
    return limit / (1e3 * np.maximum(gear, 0.5 * stop) / modulus + 0.5 * (chain + knee) / area)


def _shank_net(s: Structure) -> tuple[float, ...]:
    d = s.leg
    at_mm = -shank_bridges(1000.0, d)[0]
    hole = sunk_width_mm(M3, d.shank_plate_mm)
    ends = d.shank_top_radius_mm, d.shank_bottom_radius_mm
    return PLATE.yield_mpa, d.shank_plate_mm, hole, float(at_mm), *ends, -float(bottom_axis_mm(0.0, d))


def _shank_bridge(limit: Any, thick: Any, hole: Any, at: Any, top: Any, bottom: Any, zero: Any, *loads: Any) -> Any:
    """Return the factor across the upper bridge's bolts: half of the moment of the knee's force about what is below."""
    knee, length = loads
    half = top + (bottom - top) * at / (1e3 * length + zero)
    modulus, area = net_section(half, thick, BRIDGE_BOLT_X, hole)
    return limit / (500.0 * knee * (length - 1e-3 * at) / modulus + 0.5 * knee / area)


def _thigh_column(s: Structure) -> tuple[float, ...]:
    d = s.leg
    half, window = d.thigh_half_width_mm, d.thigh_window_half_width_mm
    bed = d.thigh_core_half_width_mm - d.thigh_core_window_half_width_mm
    modulus = MATERIALS.aluminium.youngs_modulus_mpa
    euler = bedded_mpa(half - window, d.plate_mm, bed, 0.5 * d.gap_mm, modulus)
    return float(column_mpa(euler, PLATE.yield_mpa)), half, window, d.plate_mm


def _thigh_side(limit: Any, half: Any, window: Any, thick: Any, *loads: Any) -> Any:
    gear, stop, chain, knee = loads
    return limit / pressed_mpa(np.maximum(gear, 0.5 * stop), 0.5 * (chain + knee), half, window, thick)


def _fork_column(s: Structure) -> tuple[float, ...]:
    d = s.leg
    free = d.fork_mm - FORK_WINDOW_END - FORK_WINDOW_TOP
    euler = clamped_mpa(free, d.shank_plate_mm, MATERIALS.aluminium.youngs_modulus_mpa)
    # As of ``strength.links``: the window ends in the upper half of the plates.
    half = 0.5 * (d.shank_top_radius_mm + d.shank_bottom_radius_mm)
    return float(column_mpa(euler, PLATE.yield_mpa)), half, d.shank_window_half_width_mm, d.shank_plate_mm


def _fork_side(limit: Any, half: Any, window: Any, thick: Any, *loads: Any) -> Any:
    gear, knee, length = loads
    return limit / pressed_mpa(0.5 * np.maximum(gear, knee * length), 0.5 * knee, half, window, thick)


_section = link_row(
    "elastic net sections, see strength.plates; yield of the plates' alloy from the materials",
    1.2,
    "our own choice against yield, as beside the windows: see strength.links",
)
_column = link_row(
    "Johnson's parabola and Euler: Roark, chapter 15; foundation: Hetenyi",
    1.5,
    "our own choice: columns are never quite straight; EN 1999-1-1 has 1.1 on top of its imperfections",
)
_BENT = ("peak_stop_torque_knee_n_m", "peak_chain_tension_n", "peak_knee_force_n")
_KNEE = ("peak_knee_force_n", "shank_length_m")
_SHANK = ("shank_plate_near", "shank_plate_far")
JOINTS = (
    *(
        _section(f"thigh_hub_{plate}",
            "least of tau_y t (2 pi r - sum d) r and n r F_neck over the circles of holes, over T",
            (f"peak_gear_torque_{side}_n_m",), capacity, over, (f"thigh_plate_{plate}",))
        for plate, side, capacity in (("inner", "hip", inner_hub), ("outer", "knee", outer_hub))
    ),
    *(
        row
        for plate, side in (("inner", "hip"), ("outer", "knee"))
        for row in (
            _section(f"thigh_bridge_{plate}",
                f"yield / (M / Z_net + N / A_net); M = max(T_{side}, T_stop / 2), N = (F_chain + F_knee) / 2",
                (f"peak_gear_torque_{side}_n_m", *_BENT), _thigh_net, _thigh_bridge, (f"thigh_plate_{plate}",)),
            _column(f"thigh_side_{plate}", "sigma_c A_side / (M / s + N / 2), on the core; M and N as of thigh_bridge",
                (f"peak_gear_torque_{side}_n_m", *_BENT), _thigh_column, _thigh_side,
                (f"thigh_plate_{plate}", "thigh_core")),
        )
    ),
    _section("shank_bridge", "yield / (M / Z_net + N / A_net); M = F_knee (l - a) / 2, N = F_knee / 2", _KNEE,
        _shank_net, _shank_bridge, _SHANK),
    _column("shank_fork_side", "sigma_c A_side / (M / s + N / 2), free; M = max(T_knee, F_knee l) / 2, N = F_knee / 2",
        ("peak_gear_torque_knee_n_m", *_KNEE), _fork_column, _fork_side, _SHANK),
)  # fmt: skip
