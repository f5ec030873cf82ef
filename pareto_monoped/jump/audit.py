"""How far a jump's height and energy can be trusted: energy balance, finer steps, perturbations.

A number that moves when a link grows by a micrometre is an accident, not a result.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pareto_monoped.actuator.search import ActuatorMap
from pareto_monoped.design import NAMES
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.evaluate import Evaluations, Evaluator
from pareto_monoped.jump.single import energy_balance
from pareto_monoped.robot.population import robot_arrays

Floats = NDArray[np.float64]

PERTURBATION = 1e-6
"""Relative size of the perturbations."""
CONTINUOUS = tuple(k for k, name in enumerate(NAMES) if not name.endswith("_ratio"))
"""Columns that are perturbed: a gear ratio only chooses a gearbox, the robot does not change with it in between."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """What a well-conditioned jump keeps within.

    Attributes:
        spread_height_m, spread_energy: 90th percentile of the change under perturbations.
        step_height_m, step_energy: change when the step is halved.
        balance: what the energy balance may leave open, as a share of the actuator work.
    """

    spread_height_m: float = 0.001
    spread_energy: float = 0.005
    step_height_m: float = 0.003
    step_energy: float = 0.01
    balance: float = 0.01


LIMITS = Limits()


@dataclass(frozen=True, slots=True, kw_only=True)
class Audits:
    """The audit of n designs, a row a design; NaN for a design without a jump. Energy changes are shares.

    Attributes:
        status: of the jump, as in ``Evaluations``.
        height_m, energy_j: as evaluated.
        energy_balance_error: see ``EnergyBalance.error``.
        half_step_height_m, half_step_energy, quarter_step_height_m, quarter_step_energy: absolute change with the step
            halved and quartered.
        spread_height_m, spread_energy: 90th percentile of the absolute change over perturbations of 1e-6.
        worst_height_m, worst_energy: the largest of these changes.
        well_conditioned: whether all is within the limits.
        reason: what is not.
    """

    status: NDArray[np.str_]
    height_m: Floats
    energy_j: Floats
    energy_balance_error: Floats
    half_step_height_m: Floats
    half_step_energy: Floats
    quarter_step_height_m: Floats
    quarter_step_energy: Floats
    spread_height_m: Floats
    spread_energy: Floats
    worst_height_m: Floats
    worst_energy: Floats
    well_conditioned: NDArray[np.bool_]
    reason: tuple[str, ...] = field(default=())

    def as_columns(self) -> dict[str, NDArray[np.generic]]:
        """Column name to values of shape (n,)."""
        return {f.name: np.asarray(getattr(self, f.name)) for f in fields(self)}


def perturbed(designs: Floats, count: int, rng: np.random.Generator) -> Floats:
    """``count`` copies of each design, its continuous variables moved by up to 1e-6 of their value, (n * count, 7)."""
    copies = np.repeat(np.atleast_2d(designs), count, axis=0)
    copies[:, CONTINUOUS] *= 1.0 + PERTURBATION * rng.uniform(-1.0, 1.0, (len(copies), len(CONTINUOUS)))
    return copies


def finer(calibration: Calibration, parts: int) -> Calibration:
    """The calibration with its step divided by ``parts``."""
    simulation = calibration.simulation
    return replace(calibration, simulation=replace(simulation, timestep_s=simulation.timestep_s / parts))


def audit(
    designs: ArrayLike,
    actuator_map: ActuatorMap,
    calibration: Calibration,
    *,
    workers: int = 1,
    perturbations: int = 10,
    seed: int = 0,
    limits: Limits = LIMITS,
) -> Audits:
    """Audit the jumps of designs.

    Args:
        designs: shape (n, 7).
        actuator_map: the gearboxes.
        calibration: the jump model.
        workers: threads.
        perturbations: how many perturbed copies of each design jump.
        seed: of the perturbations; the same seed gives the same audit.
        limits: for ``well_conditioned``.
    """
    values = np.atleast_2d(np.asarray(designs, dtype=np.float64))
    n = len(values)
    base = Evaluator(actuator_map, calibration, workers)(values)
    half = Evaluator(actuator_map, finer(calibration, 2), workers)(values)
    quarter = Evaluator(actuator_map, finer(calibration, 4), workers)(values)
    rng = np.random.default_rng(seed)
    spread = Evaluator(actuator_map, calibration, workers)(perturbed(values, perturbations, rng))
    height = np.abs(spread.height_m.reshape(n, perturbations) - base.height_m[:, None])
    energy = np.abs(spread.energy_j.reshape(n, perturbations) / base.energy_j[:, None] - 1.0)
    balance = np.full(n, np.nan)
    ok = np.flatnonzero(base.ok)
    for i in ok:
        robots = robot_arrays(values[i : i + 1], actuator_map, calibration.mass)
        balance[i] = energy_balance(robots, values[i : i + 1, 4:7], calibration).error
    columns = {
        "energy_balance_error": balance,
        **_changes("half_step", base, half),
        **_changes("quarter_step", base, quarter),
        # A perturbed jump that fails is the worst of changes: NaN becomes infinity.
        "spread_height_m": _percentile(height, ok),
        "spread_energy": _percentile(energy, ok),
        "worst_height_m": _percentile(height, ok, 100.0),
        "worst_energy": _percentile(energy, ok, 100.0),
    }
    reasons = tuple(_reason(base, columns, i, limits) for i in range(n))
    return Audits(
        status=base.status,
        height_m=base.height_m,
        energy_j=base.energy_j,
        **columns,
        well_conditioned=np.array([not reason for reason in reasons], dtype=bool),
        reason=reasons,
    )


def _changes(prefix: str, base: Evaluations, other: Evaluations) -> dict[str, Floats]:
    lost = base.ok & ~other.ok
    height = np.where(lost, np.inf, np.abs(other.height_m - base.height_m))
    energy = np.where(lost, np.inf, np.abs(other.energy_j / base.energy_j - 1.0))
    return {f"{prefix}_height_m": height, f"{prefix}_energy": energy}


def _percentile(changes: Floats, ok: NDArray[np.intp], percent: float = 90.0) -> Floats:
    result = np.full(len(changes), np.nan)
    known = np.sort(np.where(np.isnan(changes[ok]), np.inf, changes[ok]), axis=1)
    # The next change above the percentile, not an interpolation, which infinity would spoil.
    rank = int(np.ceil(percent / 100.0 * changes.shape[1])) - 1
    result[ok] = known[:, rank]
    return result


def _reason(base: Evaluations, columns: dict[str, Floats], i: int, limits: Limits) -> str:
    if not base.ok[i]:
        return f"no jump: {base.status[i]}"
    checks: Sequence[tuple[str, str, float, float, str]] = (
        ("spread_height_m", "height under perturbations", 1e3, limits.spread_height_m, "mm"),
        ("spread_energy", "energy under perturbations", 1e2, limits.spread_energy, "percent"),
        ("half_step_height_m", "height with the step halved", 1e3, limits.step_height_m, "mm"),
        ("half_step_energy", "energy with the step halved", 1e2, limits.step_energy, "percent"),
        ("energy_balance_error", "energy balance", 1e2, limits.balance, "percent"),
    )
    over = [
        f"{text} off by {columns[name][i] * scale:.3g} {unit} (limit {limit * scale:g})"
        for name, text, scale, limit, unit in checks
        if not columns[name][i] <= limit
    ]
    return "; ".join(over)
