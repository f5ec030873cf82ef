"""The knee's axle and bearings: dowels between axle and shank, static load and life of the bearings."""

from typing import Any

import numpy as np

from pareto_monoped.actuator.bearings import rated_bearing
from pareto_monoped.leg.faces import knee_strikers
from pareto_monoped.leg.knee import AXLE_DOWEL, DOWEL_DEPTH, axle_dowels
from pareto_monoped.leg.stops import knee_stop
from pareto_monoped.materials import ALLOYS
from pareto_monoped.strength.joint import LegJoint, Structure

AXLE, PLATE = ALLOYS["aw_7075_t6"], ALLOYS["aw_6082_t6"]
_SHEAR = 1.0 / np.sqrt(3.0)  # yield in shear over that in tension (von Mises)
_BEARINGS = 2


def dowels_n_m(
    count: float, circle_mm: float, diameter_mm: float, layers: tuple[tuple[float, float], ...], pin_mpa: float
) -> float:
    """Torque at which a circle of dowels yields a hole, by its mean pressure, or the dowels, in shear.

    Args:
        count: of dowels.
        circle_mm: radius of their circle.
        diameter_mm: of a dowel.
        layers: depth in mm and yield stress in MPa of each part that a dowel stands in.
        pin_mpa: yield stress of the dowels.
    """
    holes = min(diameter_mm * depth * stress for depth, stress in layers)
    shear = 0.75 * 0.25 * np.pi * diameter_mm**2 * _SHEAR * pin_mpa  # 4 / 3 of the mean in the middle
    return float(1e-3 * count * circle_mm * min(holes, shear))


def bearing_safety(static_n: Any, lever_mm: Any, cross: Any, *loads: Any) -> Any:
    """Safety s0 = 2 C0 / P of the knee's two bearings (ISO 76).

    The chain pulls the shank along the thigh by F_c, and the stop pushes it by F_s = T / lever at an angle to that. The
    bearings balance both and what the shank needs, the force K at the knee, in whatever direction:
    P <= K + |F_c + F_s|.

    Args:
        static_n: static rating C0 of a bearing.
        lever_mm: of the stop.
        cross: cosine of the angle between both forces.
        loads: pull of the chain, torque of the stop, force at the knee.
    """
    return _BEARINGS * static_n / bearings_n(lever_mm, cross, *loads)


def bearings_n(lever_mm: Any, cross: Any, pull: Any, torque: Any, knee: Any) -> Any:
    """Load of both bearings of the knee together; arguments as of ``bearing_safety``."""
    push = 1e3 * torque / lever_mm
    together = np.sqrt(np.square(pull) + np.square(push) + 2.0 * cross * pull * push)
    return knee + together


def bearing_life(dynamic_n: Any, turns: Any, lever_mm: Any, cross: Any, *loads: Any) -> Any:
    """L10 of the knee's bearings (ISO 281) over the turns of the duty, if each turn had the peak load.

    Args:
        dynamic_n: C of a bearing.
        turns: of the duty.
        lever_mm: see ``bearing_safety``, as for the next two.
        cross: cosine.
        loads: of the jump.
    """
    return 1e6 * (_BEARINGS * dynamic_n / bearings_n(lever_mm, cross, *loads)) ** 3 / turns


def _dowels(s: Structure) -> float:
    """Of the chain's pull: both plates take the axle's torque."""
    holes, plate_mm = axle_dowels(), s.leg.shank_plate_mm
    layers = ((plate_mm, PLATE.yield_mpa), (DOWEL_DEPTH, AXLE.yield_mpa))
    one = dowels_n_m(
        float(holes.count), float(holes.pitch_radius_mm), AXLE_DOWEL.diameter_mm, layers, AXLE_DOWEL.alloy.yield_mpa
    )
    return 2.0 * one / (1e-3 * s.leg.chain.pitch_radius_mm)


def stop_direction(s: Structure) -> float:
    """Cosine of the angle between the chain's pull on the shank, towards the hip, and the push of the stop."""
    stop = knee_stop(s.leg)
    extension, _ = knee_strikers(s.leg)
    # The shank turns clockwise, seen along -z; the bumper pushes against the striker's face.
    return -float(np.sin(extension.normal_rad - stop.lower_rad))


def _bearings(s: Structure) -> tuple[float, ...]:
    static = float(rated_bearing(2.0 * s.leg.bearing_bore_radius_mm).static_rating_n)
    return static, knee_stop(s.leg).lever_mm, stop_direction(s)


def _life(s: Structure) -> tuple[float, ...]:
    """In each jump the knee swings through its range and back."""
    stop = knee_stop(s.leg)
    turns = s.settings.parts.duty.jumps * 2.0 * (stop.upper_rad - stop.lower_rad) / (2.0 * np.pi)
    dynamic = float(rated_bearing(2.0 * s.leg.bearing_bore_radius_mm).dynamic_rating_n)
    return dynamic, turns, stop.lever_mm, stop_direction(s)


_CURE = "release the knee's torque before its stop, a lower knee_ratio, or a motor of less torque"

JOINTS = (
    LegJoint(
        name="knee_axle_dowels",
        group="joints",
        formula="2 n r min(d t R_e, 3 pi d^2 tau_e / 16) / (F_chain r_sprocket)",
        source="pins in holes and in shear: Roloff/Matek, Maschinenelemente, chapter 9",
        required=1.5,
        required_source="our own choice: dowels and plates do not share a load quite evenly; friction is not counted",
        loads=("peak_chain_tension_n",),
        capacity=_dowels,
        parts=("knee_axle", "knee_axle_dowel_near", "knee_axle_dowel_far"),
        cure=_CURE,
    ),
    LegJoint(
        name="knee_bearing_static",
        group="joints",
        formula="2 C0 / (F_knee + |F_chain + T_stop / lever|), as vectors",
        source="ISO 76",
        required=1.0,
        required_source="makers' catalogues: 1 for normal demands; the bearing swings and does not run",
        loads=("peak_chain_tension_n", "peak_stop_torque_knee_n_m", "peak_knee_force_n"),
        capacity=_bearings,
        factor=bearing_safety,
        parts=("knee_bearing",),
        cure=_CURE,
    ),
    LegJoint(
        name="knee_bearing_life",
        group="joints",
        formula="1e6 (2 C / P)^3 / (jumps 2 range / 2 pi), P as of knee_bearing_static",
        source="ISO 281, L10; swings as parts of turns",
        required=1.0,
        required_source="a life of the duty's jumps; the peak is taken for all of the swing",
        loads=("peak_chain_tension_n", "peak_stop_torque_knee_n_m", "peak_knee_force_n"),
        capacity=_life,
        factor=bearing_life,
        parts=("knee_bearing",),
        cure=_CURE,
    ),
)
