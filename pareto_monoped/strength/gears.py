"""Gears in the stop: the largest torque of a jump against what teeth carry once, and in every jump of their duty.

Gears are rated for their duty in stage 1. What an end stop or a landing sends through them is a single event of a
higher torque, against which standards have a static limit: rows of the group ``gears``. A joint that strikes its stop
in every jump loads its teeth with that torque as often as it jumps: rows of the group ``gear_strikes``, which inform.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from pareto_monoped.actuator.gearset import joined
from pareto_monoped.actuator.layout import FAMILIES
from pareto_monoped.actuator.rating.build import build_stage
from pareto_monoped.actuator.rating.strike import strike_safeties, strike_shares
from pareto_monoped.actuator.rating.width import lewis_form_factor
from pareto_monoped.strength.joint import SIDES, ActuatorJoint, Structure, Together

_CLOSE, _MOST_STEPS = 1e-12, 100  # the fixed point below gains about a digit per step
_LIFE_DIGITS = 1e-6  # of the logarithm of a number of jumps
MOST_JUMPS = 1e9
"""Lives are cut here: both standards end their curves at 1e10 load cycles."""


def static_torques_n_m(s: Structure) -> tuple[float, float]:
    """Return the output torques at which the weakest flank and the weakest root have the static safety that the rating
    requires.

    Stress grows with the torque and a little less than in proportion to it, because misalignment weighs less under a
    high load. The torque is therefore the limit of T <- T (S_H / S_H,min)^2 and of T <- T S_F / S_F,min.
    """
    actuator, data = s.actuator, s.settings.parts.rating
    stage = build_stage(actuator.gears, actuator.motor, actuator.family, s.settings)
    required = np.array([data.overload_flank_safety, data.overload_root_safety])
    shares = np.ones(2)
    for _ in range(_MOST_STEPS):
        flank, root = stage.static_safeties(actuator.face_width_mm, shares)
        spare = np.array([np.asarray(flank)[0], np.asarray(root)[1]]) / required
        step = np.array([np.square(spare[0]), spare[1]])
        shares = shares * step
        if np.all(np.abs(step - 1.0) < _CLOSE):
            break
    torques = shares * actuator.peak_torque_n_m
    return float(torques[0]), float(torques[1])


def strike_torques_n_m(structures: Sequence[Structure]) -> list[float]:
    """Return the output torques that the gears of one motor carry in every jump of their duty, with the safeties that
    it requires.

    They depend on no length and no jump, so that they are computed once per actuator map, all gearboxes of a family
    together. The least of flanks and roots; NaN under the rules ``paper``, which know no fatigue.
    """
    torques = np.full(len(structures), np.nan)
    for family in FAMILIES:
        rows = [k for k, s in enumerate(structures) if s.actuator.family == family and s.settings.rules == "iso6336"]
        if not rows:
            continue
        actuators, settings = [structures[k].actuator for k in rows], structures[rows[0]].settings
        stage = build_stage(joined([a.gears for a in actuators]), actuators[0].motor, family, settings)
        required = (settings.parts.rating.flank_safety, settings.parts.rating.root_safety)
        shares = strike_shares(stage, np.array([a.face_width_mm for a in actuators]), required)
        torques[rows] = np.minimum(*shares) * [a.peak_torque_n_m for a in actuators]
    return torques.tolist()


def struck_safeties(s: Structure, torque_n_m: float, jumps: float | None = None) -> tuple[float, float]:
    """Return S_H and S_F against fatigue of an actuator's gears if so many jumps strike with this torque.

    By default as many as their duty has. NaN under the rules ``paper``.
    """
    if s.settings.rules == "paper":
        return float("nan"), float("nan")
    actuator, parts = s.actuator, s.settings.parts
    stage = build_stage(actuator.gears, actuator.motor, actuator.family, s.settings)
    share = torque_n_m / actuator.peak_torque_n_m
    flank, root = strike_safeties(stage, actuator.face_width_mm, share, parts.duty.jumps if jumps is None else jumps)
    return float(flank), float(root)


def strike_life_jumps(s: Structure, torque_n_m: float) -> float:
    """Return the jumps that an actuator's gears last if each of them strikes with this torque, at the safeties of their
    duty.

    0 if they do not last a single one, ``MOST_JUMPS`` if they last that many; NaN under the rules ``paper``.
    """
    if s.settings.rules == "paper":
        return float("nan")
    data = s.settings.parts.rating

    def lasts(jumps: float) -> bool:
        flank, root = struck_safeties(s, torque_n_m, jumps)
        return flank >= data.flank_safety and root >= data.root_safety

    low, high = 0.0, float(np.log10(MOST_JUMPS))
    if not lasts(1.0):
        return 0.0
    if lasts(MOST_JUMPS):
        return MOST_JUMPS
    while high - low > _LIFE_DIGITS:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if lasts(10.0**middle) else (low, middle)
    return float(10.0**low)


def lewis_torque_n_m(s: Structure) -> float:
    """Return the output torque at which the sun's teeth reach the allowable bending stress of the rules ``paper``.

    Every mesh of the sun carries an equal share. The stress is that of ``lewis_width_mm`` without
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
    """Return the output torques that flanks and roots carry once; the rules ``paper`` have no limit of flanks."""
    return static_torques_n_m(s) if s.settings.rules == "iso6336" else (np.inf, lewis_torque_n_m(s))


_STRIKES = Together(of=strike_torques_n_m)
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
_ONCE = tuple(
    ActuatorJoint(name=f"{side}_gear_{tooth}", group="gears", side=side,
        formula=f"T_limit / T, with the static safety of rating.overload_{tooth}_safety at T_limit", source=source,
        required=1.0, required_source="the required static safety is in T_limit",
        loads=(f"peak_gear_torque_{side}_n_m",), capacity=_torques_n_m, factor=factor, parts=("sun", "planet", "ring"),
        cure=f"release the {side}'s torque before its stop, or another {side}_ratio")
    for side in SIDES
    for tooth, (source, factor) in _TEETH.items()
)  # fmt: skip
_ALWAYS = tuple(
    ActuatorJoint(name=f"{side}_gear_strikes", group="gear_strikes", side=side,
        formula="T_limit / T, with rating.flank_safety and rating.root_safety under duty and strikes at T_limit",
        source="ISO 6336-2, -3 and -6, one load cycle per jump; the rules paper know no fatigue", required=1.0,
        required_source="it informs: below 1, the gears last fewer jumps than duty.jumps if each strikes like this one",
        loads=(f"peak_gear_torque_{side}_n_m",), capacity=_STRIKES, parts=("sun", "planet", "ring"),
        cure=f"release the {side}'s torque before its stop, or a heavier gearbox")
    for side in SIDES
)  # fmt: skip
JOINTS = (*_ONCE, *_ALWAYS)
