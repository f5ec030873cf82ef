"""A screen before the audit: one coarse jump shows that most designs would pass their audit.

The jump has twice the step, and the design is perturbed: together this takes in what the audit measures one by one, and
first-order errors of the step are twice as large. Where even this jump is close to the one evaluated, an audit finds
nothing.
"""

from concurrent.futures import Executor
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.ratiomap import Maps
from pareto_monoped.design import Floats
from pareto_monoped.jump.audit import LIMITS, Jumps, perturbed
from pareto_monoped.jump.calibration import Calibration, FadeGate
from pareto_monoped.jump.shared import evaluator_of
from pareto_monoped.measures import ScreenMeasures

CLEAR: dict[str, float] = {"half_step_height_m": 0.5, "half_step_energy": 1.5}
"""Shares of the audit's limits that a coarse jump may reach if its design needs no audit. Our own choice, measured by
``benchmarks/audit_time.py``. Energy has more room, as a doubled control period changes it by half a percent,
smoothly.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Screened(ScreenMeasures):
    """What coarse jumps say of n designs; ``measures.SCREEN_MEASURES`` says what each measure means."""

    @property
    def clear(self) -> NDArray[np.bool_]:
        """Which designs need no audit because it would find them well-conditioned, shape (n,)."""
        most = {limit.name: CLEAR.get(limit.name, np.nan) * limit.most for limit in LIMITS}
        return np.asarray(
            (self.double_step_height_m <= most["half_step_height_m"])
            & (self.double_step_energy <= most["half_step_energy"])
        )

    def as_columns(self) -> dict[str, Floats]:
        """Return column name to values of shape (n,)."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


def coarser(calibration: Calibration) -> Calibration | None:
    """Return the calibration with twice its step; None where one coarse jump does not tell enough, or cannot be made.

    The control period stays if it has an even number of steps. Otherwise it doubles, too. A gate that switches the
    whole torque from step to step needs an audit of every design: two jumps may agree by chance. A delay may be no
    whole number of the longer periods.
    """
    simulation = calibration.simulation
    period_s = simulation.control_period_s
    if not isinstance(calibration.gate, FadeGate):
        return None
    if period_s is not None and simulation.period_steps % 2:
        period_s *= 2.0
    try:
        coarse = replace(simulation, timestep_s=2.0 * simulation.timestep_s, control_period_s=period_s)
    except ValueError:  # the delay
        return None
    return replace(calibration, simulation=coarse)


def screened(
    designs: Floats,
    actuator_map: Maps,
    calibration: Calibration,
    known: Jumps,
    *,
    workers: int = 1,
    executor: Executor | None = None,
    seed: int = 0,
) -> Screened:
    """Compare ``known`` jumps of designs with coarse ones; no design's result depends on the others in any bit."""
    changes = {name: np.full(len(designs), np.nan) for name in (field.name for field in fields(Screened))}
    coarse = coarser(calibration)
    rows = np.flatnonzero(known.ok)
    if coarse is not None and len(rows):
        copies = np.vstack([perturbed(design, 1, np.random.default_rng(seed)) for design in designs[rows]])
        found = evaluator_of(actuator_map, coarse, workers, executor=executor)(copies)
        # A copy that cannot stand says nothing of its design, which can.
        told = found.status != "cannot_stand"
        height = np.abs(found.height_m - known.height_m[rows])
        energy = np.abs(found.energy_j / known.energy_j[rows] - 1.0)
        for name, values in zip(changes, (height, energy), strict=True):
            changes[name][rows] = np.where(found.ok, values, np.where(told, np.inf, np.nan))
    return Screened(**changes)
