"""Stages whose end stop is struck in every jump: fatigue under the duty and the strikes together.

The strike is one more level of the duty, to which Miner's rule adds the others (ISO 6336-6). Its K_A is 1, because the
torque is that of a simulated jump, with the dynamics of stop, leg and rotor in it. Its K_V is 1 too: the torque peaks
where the joint turns back and the gears stand still. It acts in the direction of the push, and on the same teeth each
time, so that it is one load cycle per jump.
"""

import numpy as np

from pareto_monoped.actuator.rating.capacity import (
    FLANK_CURVES,
    ROOT_CURVES,
    highest_share,
    mean_stress_factor,
    passes_per_rad,
    reversal_ratio,
)
from pareto_monoped.actuator.rating.stage import Member, MeshLoad, Stage
from pareto_monoped.geometry.shapes import Floats, Numbers

_CLOSE, _MOST_STEPS = 1e-13, 100
"""Of the logarithm of safety over required safety, where the search of a torque ends; it takes about ten steps."""
_HIGHEST_SHARE = 50.0
"""Strikes are looked for up to this torque over the peak torque: twenty times what gears are rated for once."""
_LOWEST_SHARE = 0.01
"""And down to this one, which does no damage."""


def strike_safeties(stage: Stage, width_mm: Numbers, share: Numbers, jumps: Numbers) -> tuple[Numbers, Numbers]:
    """Return the least S_H and S_F under the duty with a strike in every jump.

    They are those at the highest torque of all. A strike below the duty's own highest level times K_A adds only its
    load cycle.

    ``share``: torque of the strike over the peak torque.
    """
    passes = dict(zip(("sun", "planet", "ring"), passes_per_rad(stage.gears), strict=True))
    highest = np.maximum(share, _usual_share(stage))
    pairs = zip((stage.sun_mesh, stage.ring_mesh), stage.single_loads(width_mm, highest), strict=True)
    found = [
        _safeties(stage, member, load, passes[member.gear], (share, highest), jumps)
        for mesh, load in pairs
        for member in (mesh.pinion, mesh.wheel)
    ]
    flanks, roots = zip(*found, strict=True)
    return np.min(np.array(flanks), axis=0), np.min(np.array(roots), axis=0)


def _usual_share(stage: Stage) -> float:
    """Return the duty's highest level times K_A, over the peak torque."""
    return stage.settings.parts.rating.application_factor * highest_share(stage.settings.parts.duty)


def strike_shares(stage: Stage, width_mm: Floats, required: tuple[float, float]) -> tuple[Floats, Floats]:
    """Return the torques of a strike in every jump, over the peak torque, at which flanks and roots have the required
    safeties.

    Found in logarithms, in which safety over torque is nearly straight, by the Illinois variant of the false position.
    0 for gears that do not even last their duty.

    ``required``: S_H and S_F.
    """
    jumps = stage.settings.parts.duty.jumps

    def spare(log_shares: Floats) -> Floats:
        flank, root = strike_safeties(stage, width_mm, np.exp(log_shares), jumps)
        least = np.stack([np.asarray(flank)[0], np.asarray(root)[1]])
        logs: Floats = np.log(least / np.array(required)[:, None])
        return logs

    usual = np.full((2, len(width_mm)), np.log(_usual_share(stage)))
    # Gears that are just wide enough for their duty do not carry one more cycle of its highest level in each jump.
    less = spare(usual) < 0.0
    low, high = np.where(less, np.log(_LOWEST_SHARE), usual), np.where(less, usual, np.log(_HIGHEST_SHARE))
    at_low, at_high = spare(low), spare(high)
    lasts, best = at_low >= 0.0, low
    moving = lasts
    for _ in range(_MOST_STEPS):
        now = (low * at_high - high * at_low) / (at_high - at_low)
        at_now = spare(now)
        best = np.where(moving, now, best)
        moving = moving & (np.abs(at_now) > _CLOSE) & (now > low) & (now < high)
        if not moving.any():
            break
        above = at_now > 0.0
        # An end that stays counts half, so that the other moves too.
        at_low, at_high = np.where(above, at_now, 0.5 * at_low), np.where(above, 0.5 * at_high, at_now)
        low, high = np.where(above, now, low), np.where(above, high, now)
    shares = np.where(lasts, np.exp(best), 0.0)
    return shares[0], shares[1]


def _safeties(
    stage: Stage, member: Member, load: MeshLoad, passes: Numbers, shares: tuple[Numbers, Numbers], jumps: Numbers
) -> tuple[Numbers, Numbers]:
    """Return S_H and S_F of one gear in one mesh, from what it carries under the usual duty and the change of its
    factors.

    ``shares`` are those of the strike and of the highest torque, at which ``load`` is.
    """
    duty = stage.settings.parts.duty
    idler, treatment = member.gear == "planet", member.steel.treatment
    flank_curve, root_curve = FLANK_CURVES[treatment], ROOT_CURVES[treatment]
    flank_life = flank_curve.factor(jumps * _passes(stage, passes, shares, 0.5 / flank_curve.exponent, idler=idler))
    root_life = root_curve.factor(jumps * _passes(stage, passes, shares, 1.0 / root_curve.exponent, idler=idler))
    if not idler:
        before = mean_stress_factor(member.steel, member.form, reversal_ratio(duty))
        root_life = root_life * mean_stress_factor(member.steel, member.form, _reversal(stage, shares[1])) / before
    # What a gear carries is for the peak torque; here the load is that of the highest torque itself.
    highest = highest_share(duty)
    flank = member.carries.flank * highest * np.square(flank_life / member.flank_life)
    root = member.carries.root * highest * root_life / member.root_life
    return np.sqrt(flank / load.flank_n_per_mm), root / load.root_n_per_mm


def _passes(
    stage: Stage, passes_per_rad: Numbers, shares: tuple[Numbers, Numbers], slope: float, *, idler: bool
) -> Numbers:
    """Return load cycles per jump that do the damage of duty and strike, see ``equivalent_cycles``."""
    (share, highest), duty = shares, stage.settings.parts.duty
    factor = stage.settings.parts.rating.application_factor

    def cycles(levels: tuple[tuple[float, float], ...]) -> Numbers:
        found: Numbers = np.zeros(np.shape(passes_per_rad))[()]
        for level, angle in levels:
            found = found + np.ceil(np.round(passes_per_rad * angle, 9)) * (factor * level / highest) ** slope
        return found

    front, back = (share / highest) ** slope + cycles(duty.forward_levels), cycles(duty.reversed_levels)
    return front + back if idler else np.maximum(front, back)


def _reversal(stage: Stage, highest: Numbers) -> Numbers:
    """Return the highest torque against the push over that of the push, see ``reversal_ratio``."""
    backward = max((level for level, _ in stage.settings.parts.duty.reversed_levels), default=0.0)
    return stage.settings.parts.rating.application_factor * backward / highest
