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
from pareto_monoped.compute.chunks import pace_of, spread, task_threads
from pareto_monoped.design import CONTROL, Floats, columns
from pareto_monoped.jump.audit import LIMITS, Jumps, perturbed
from pareto_monoped.jump.balance import balanced
from pareto_monoped.jump.calibration import Calibration, FadeGate
from pareto_monoped.jump.model import start_pose
from pareto_monoped.jump.shared import built, setup_text
from pareto_monoped.jump.variations import joined, take
from pareto_monoped.measures import ScreenMeasures
from pareto_monoped.robot.population import robot_arrays

CLEAR: dict[str, float] = {"half_step_height_m": 0.5, "half_step_energy": 1.5, "energy_balance_error": 0.5}
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
            & (self.double_step_balance_error <= most["energy_balance_error"])
        )

    def as_columns(self) -> dict[str, Floats]:
        """Return column name to values of shape (n,)."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


def coarser(calibration: Calibration) -> Calibration | None:
    """Return the calibration with twice its step; None where one coarse jump does not tell enough, or cannot be made.

    The control period stays if it has an even number of steps. Otherwise it doubles, too. A gate that switches the
    whole torque from step to step needs an audit of every design: two jumps may agree by chance. The integrator RK4 has
    no balances of many jumps at once, and a delay may be no whole number of the longer periods.
    """
    simulation = calibration.simulation
    period_s = simulation.control_period_s
    if simulation.integrator == "RK4" or not isinstance(calibration.gate, FadeGate):
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
    if executor is not None and len(designs):
        text = setup_text([actuator_map], calibration)

        def of_rows(rows: slice) -> tuple[str, Floats, Jumps, int]:
            return text, designs[rows], take(known, np.arange(rows.start, rows.stop)), seed

        pace = pace_of(executor, _screened_of, text)
        return joined(spread(executor, pace, len(designs), _screened_of, of_rows))
    changes = {name: np.full(len(designs), np.nan) for name in (field.name for field in fields(Screened))}
    coarse = coarser(calibration)
    jumped = np.flatnonzero(known.ok)
    if coarse is not None and len(jumped):
        copies = np.vstack([perturbed(design, 1, np.random.default_rng(seed)) for design in designs[jumped]])
        robots = robot_arrays(copies, actuator_map, calibration.mass)
        stands = np.flatnonzero([not reason for reason in start_pose(robots, coarse).reason])
        rows = jumped[stands]
        found = balanced(take(robots, stands), columns(copies[stands], CONTROL), coarse, workers)
        height = np.abs(found.height_m - known.height_m[rows])
        energy = np.abs(found.energy_j / known.energy_j[rows] - 1.0)
        for name, values in zip(changes, (height, energy, found.error), strict=True):
            changes[name][rows] = np.where(found.ok, values, np.inf)
    return Screened(**changes)


def _screened_of(text: str, designs: Floats, known: Jumps, seed: int) -> Screened:
    (maps,), calibration = built(text)
    return screened(designs, maps, calibration, known, workers=task_threads(), seed=seed)
