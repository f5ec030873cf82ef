"""Gears in the stop: the largest torque of a jump against what teeth carry once.

Gears are rated for their duty in stage 1. What an end stop or a landing sends through them is a single event of a
higher torque, against which standards have a static limit.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from pareto_monoped.actuator.rating.build import build_stage
from pareto_monoped.actuator.strength import lewis_form_factor
from pareto_monoped.strength.joint import SIDES, ActuatorJoint, Structure

_CLOSE, _MOST_STEPS = 1e-12, 100  # the fixed point below gains about a digit per step


def static_torques_n_m(s: Structure) -> tuple[float, float]:
    """Output torques at which the weakest flank and the weakest root have the static safety that the rating requires.

    Stress grows with the torque and a little less than in proportion to it, because misalignment weighs less under a
    high load. The torque is therefore the limit of T <- T (S_H / S_H,min)^2 and of T <- T S_F / S_F,min.
    """
    actuator, data = s.actuator, s.settings.parts.rating
    stage = build_stage(actuator.gears, actuator.motor, actuator.family, s.settings)
    required = np.array([data.overload_flank_safety, data.overload_root_safety])
    shares = np.ones(2)
    for _ in range(_MOST_STEPS):
        flank, root = stage.static_safeties(actuator.face_width_mm, shares)
        spare = np.array([flank[0], root[1]]) / required  # type: ignore[index]
        step = np.array([np.square(spare[0]), spare[1]])
        shares = shares * step
        if np.all(np.abs(step - 1.0) < _CLOSE):
            break
    torques = shares * actuator.peak_torque_n_m
    return float(torques[0]), float(torques[1])


def lewis_torque_n_m(s: Structure) -> float:
    """Output torque at which the sun's teeth reach the allowable bending stress of the rules ``paper``.

    Every mesh of the sun carries an equal share. The stress is that of ``actuator.strength.face_width_mm`` without
    service factor and velocity factor: both stand for loads beyond the motor's torque, and here the load is measured.
    """
    actuator, data = s.actuator, s.settings.parts.gears
    gears = actuator.gears
    stress_mpa = s.settings.materials.gear_steel.allowable_stress_mpa / data.factor_of_safety
    weakest = min(float(gears.sun_teeth), float(gears.planet_teeth))
    force_n = stress_mpa * actuator.face_width_mm * float(gears.module_mm) * float(lewis_form_factor(weakest))
    radius_m = 0.5e-3 * float(gears.module_mm) * float(gears.sun_teeth)
    return force_n * radius_m * float(gears.planets) * actuator.ratio


def _torques_n_m(s: Structure) -> tuple[float, float]:
    """Output torques that flanks and roots carry once; the rules ``paper`` have no limit of flanks."""
    return static_torques_n_m(s) if s.settings.rules == "iso6336" else (np.inf, lewis_torque_n_m(s))


_TEETH: dict[str, tuple[str, Callable[..., Any]]] = {
    "flank": (
        "ISO 6336-2, static stress; the rules paper have no limit of flanks",
        lambda flank, root, torque: flank / torque,
    ),
    "root": (
        "ISO 6336-3, static stress; rules paper: Lewis (Shigley, section 14-1)",
        lambda flank, root, torque: root / torque,
    ),
}

JOINTS = tuple(
    ActuatorJoint(
        name=f"{side}_gear_{tooth}",
        group="gears",
        side=side,
        formula=f"T_limit / T, with the static safety of rating.overload_{tooth}_safety at T_limit",
        source=source,
        required=1.0,
        required_source="the required static safety is in T_limit",
        loads=(f"peak_gear_torque_{side}_n_m",),
        capacity=_torques_n_m,
        factor=factor,
        parts=("sun", "planet", "ring"),
        cure=f"release the {side}'s torque before its stop, or another {side}_ratio",
    )
    for side in SIDES
    for tooth, (source, factor) in _TEETH.items()
)
