"""The audit of a jump, and what "well-conditioned" means.

A jump is well-conditioned if its height and energy are properties of the design and not accidents of the simulation:
its energy balance closes, and neither a finer step nor a link longer by less than a micrometre changes it much.
``LIMITS`` says how much; ``Audits.well_conditioned`` is the verdict.
"""

from collections.abc import Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pareto_monoped.actuator.ratiomap import Maps, joint_maps
from pareto_monoped.compute.chunks import pace_of, spread, task_threads
from pareto_monoped.design import ALL_DEFAULTS, ALL_NAMES, NAMES, PAPER_NAMES, RATIOS, Floats, complete, control_of
from pareto_monoped.jump.balance import Balanced, balanced
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.controller_record import MOST_DELAY
from pareto_monoped.jump.evaluate import Evaluations, Evaluator
from pareto_monoped.jump.shared import Setup, built, evaluator_of, setup_text
from pareto_monoped.jump.variations import joined
from pareto_monoped.measures import AuditMeasures, measure
from pareto_monoped.robot.population import robot_arrays

PERTURBATION = 1e-6  #: Relative size of the perturbations: half a micrometre of a link, less than any tolerance.
SPREAD_PERCENTILE = 90.0  #: Percentile of the changes under perturbations that has a limit; the worst has none.
PERTURBED = tuple(name for name in PAPER_NAMES if name not in RATIOS)
"""Without gear ratios, which only select a gearbox."""
FIRST_COPIES = 2  #: How many perturbed copies of a design jump first in a brief audit.
CLEAR_SPREAD, CLEAR_HALF_STEP = 0.01, 0.2
"""Shares of their limits that the changes of these copies and of the halved step may reach if no more copies are to
jump. Our own choice, measured by ``benchmarks/audit_time.py``: jumps that are smooth in their design stay far below.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Limit:
    """The most that a measure of the audit may be."""

    name: str  #: of the measure, in ``measures.AUDIT_MEASURES``
    most: float  #: in the stored unit of the measure
    text: str  #: what is off if the limit is exceeded


LIMITS: tuple[Limit, ...] = (
    # A change this small in the design must not show: 1 mm is less than a jump can be filmed to, and 0.5 percent is the
    # same share of the energy as 1 mm is of a rise by 0.2 m.
    Limit(name="spread_height_m", most=0.001, text="height under perturbations"),
    Limit(name="spread_energy", most=0.005, text="energy under perturbations"),
    # The error of the step is systematic and shifts similar designs alike, so it may be larger: 3 mm is 1 percent of a
    # rise by 0.3 m.
    Limit(name="half_step_height_m", most=0.003, text="height with the step halved"),
    Limit(name="half_step_energy", most=0.01, text="energy with the step halved"),
    # Energy that is unaccounted for is no better than energy that changes with the step.
    Limit(name="energy_balance_error", most=0.01, text="energy balance"),
)  #: All conditions on a well-conditioned jump, besides that there is a jump.


SAME = 1e-6
"""Most by which MuJoCo's height, in metres, and energy, as a share, may differ from those of another engine.

They differ by rounding, which reaches 1e-9 where a drive has play; a micrometre is still no difference to anybody.
"""


def exceeded(values: Mapping[str, float]) -> tuple[str, ...]:
    """Return one line for each of ``LIMITS`` that an audited jump does not keep; the value NaN keeps none."""
    lines = []
    for limit in LIMITS:
        shown = measure(limit.name)
        unit = "percent" if shown.shown_unit == "%" else shown.shown_unit
        value = values[limit.name]
        if not value <= limit.most:
            lines.append(f"{limit.text} off by {value * shown.scale:.3g} {unit} (limit {limit.most * shown.scale:g})")
    return tuple(lines)


@dataclass(frozen=True, slots=True, kw_only=True)
class Jumps:
    """What an audit needs to know of the jumps of n designs; the fields are those of ``Evaluations``."""

    status: NDArray[np.str_]
    height_m: Floats
    energy_j: Floats

    @property
    def ok(self) -> NDArray[np.bool_]:
        """Which jumps have a height and an energy, shape (n,)."""
        return np.asarray(self.status == "ok")


@dataclass(frozen=True, slots=True, kw_only=True)
class Audits(AuditMeasures):
    """The audits of n designs; ``measures.AUDIT_MEASURES`` says what each measure means."""

    @property
    def well_conditioned(self) -> NDArray[np.bool_]:
        """Which designs jump and keep all ``LIMITS``, shape (n,)."""
        return np.array([not reason for reason in self.reason], dtype=bool)

    def as_columns(self) -> dict[str, NDArray[np.generic]]:
        """Return column name to values of shape (n,), ``well_conditioned`` and ``reason`` last."""
        values = {f.name: np.asarray(getattr(self, f.name)) for f in fields(self) if f.name != "reason"}
        return values | {"well_conditioned": self.well_conditioned, "reason": np.asarray(self.reason)}


def perturbed(designs: Floats, count: int, rng: np.random.Generator) -> Floats:
    """Return perturbed copies of designs: each continuous variable in use is changed by up to 1e-6 of its value.

    The copies of the first design come first, then those of the second, ..., shape (n * count, number of variables).
    """
    copies = np.repeat(np.atleast_2d(complete(designs)), count, axis=0)
    places = [NAMES.index(name) for name in PERTURBED]
    copies[:, places] *= 1.0 + PERTURBATION * rng.uniform(-1.0, 1.0, (len(copies), len(places)))
    for place, name in enumerate(ALL_NAMES[: copies.shape[1]]):
        if (default := ALL_DEFAULTS.get(name)) is None:
            continue
        factor = 1.0 + PERTURBATION * rng.uniform(-1.0, 1.0, len(copies))
        copies[:, place] *= np.where(copies[:, place] == default, 1.0, factor)
    return copies


@dataclass(frozen=True, slots=True, kw_only=True)
class MedianEvaluator:
    """Evaluates designs by medians over copies, each independently of the others to the last bit.

    The first copy is the design itself; the continuous variables of the others are changed by up to 1e-6 of their
    values, by the same factors for every design. A design jumps if more than half of its copies jump, and each measure
    is its median over these. Else it ends as most of its copies do, of which the first says why.
    """

    evaluator: Evaluator  #: simulates
    copies: int  #: per design, at least 1

    def __call__(self, designs: ArrayLike, motors: ArrayLike | None = None) -> Evaluations:
        """Jump with all copies of each design, shape (n, number of variables); see ``Evaluator``."""
        values = np.atleast_2d(complete(designs))
        copies = np.vstack([perturbed(one, self.copies, np.random.default_rng(0)) for one in values])
        copies[:: self.copies] = values
        jumps = self.evaluator(copies, None if motors is None else np.repeat(np.asarray(motors), self.copies))
        ok = jumps.ok.reshape(-1, self.copies)
        jumped = 2 * ok.sum(axis=1) > self.copies
        place = np.arange(len(values)) * self.copies
        place += [
            0 if whole else _like_most(row)
            for whole, row in zip(jumped, np.split(jumps.status, len(values)), strict=True)
        ]
        measures = {}
        for name in (field.name for field in fields(jumps) if field.name not in ("status", "reason")):
            every = jumps.of(name)
            measures[name] = every[place]
            for k in np.flatnonzero(jumped):
                measures[name][k] = np.median(every.reshape(ok.shape)[k, ok[k]])
        reasons = ("" if whole else jumps.reason[k] for whole, k in zip(jumped, place, strict=True))
        return Evaluations(status=np.where(jumped, "ok", jumps.status[place]), reason=tuple(reasons), **measures)


def _like_most(status: NDArray[np.str_]) -> int:
    """Return the place of the first copy that ends as most of those do that fail."""
    names, counts = np.unique(status[status != "ok"], return_counts=True)
    return int(np.argmax(status == names[counts.argmax()]))


def finer(calibration: Calibration, parts: int) -> Calibration:
    """Return the calibration with its step divided by ``parts``.

    The control period stays if the calibration names one, or if the controller could not keep the commands of a longer
    delay. Otherwise each step is a period, and both become shorter.
    """
    simulation = calibration.simulation
    step_s, period_s = simulation.timestep_s / parts, simulation.control_period_s
    if period_s is None and simulation.delay_s > MOST_DELAY * step_s * (1.0 + 1e-9):
        period_s = simulation.timestep_s
    return replace(calibration, simulation=replace(simulation, timestep_s=step_s, control_period_s=period_s))


def audit(
    designs: ArrayLike,
    actuator_map: Maps,
    calibration: Calibration,
    *,
    workers: int = 1,
    executor: Executor | None = None,
    perturbations: int = 10,
    seed: int = 0,
    known: Jumps | None = None,
    judged: "Judged | None" = None,
    brief: bool = False,
) -> Audits:
    """Audit the jumps of designs, which may be ``known`` and ``judged``; ``executor`` makes others in place of threads.

    Each design has ``perturbations`` copies; the same ``seed`` gives the same audit. A brief audit measures only what
    has a limit, and perturbs less often where the result is clear.
    """
    values = np.atleast_2d(complete(designs))
    jumps = evaluator_of(actuator_map, calibration, workers, executor=executor)
    base = known or jumps(values)
    half = evaluator_of(actuator_map, finer(calibration, 2), workers, executor=executor)(values)
    halved = _changes("half_step", base, half)
    copies = perturbed(values, perturbations, np.random.default_rng(seed))
    copies = copies.reshape(len(values), perturbations, -1)
    if brief:
        spread = _brief_spread(copies, base, jumps, _within(CLEAR_HALF_STEP, halved))
        rest = dict.fromkeys(ONLY_IN_FULL, np.full(len(values), np.nan))
    else:
        spread = _spread(copies, base, jumps)
        quarter = evaluator_of(actuator_map, finer(calibration, 4), workers, executor=executor)(values)
        held, prompt = _with_two_periods(values, jumps, quarter)
        rest = {**_changes("quarter_step", base, quarter), **_changes("control_period", held, prompt)}
    if judged is None:
        judged = judge(values, actuator_map, calibration, base, workers=workers, executor=executor)
    measured = {**judged.as_columns(), **halved, **spread, **rest}
    apart = judged.apart(base)
    reasons = tuple(
        "; ".join((*exceeded({name: float(column[i]) for name, column in measured.items()}), *filter(None, [apart[i]])))
        if base.ok[i]
        else f"no jump: {base.status[i]}"
        for i in range(len(values))
    )
    return Audits(status=base.status, height_m=base.height_m, energy_j=base.energy_j, **measured, reason=reasons)


@dataclass(frozen=True, slots=True, kw_only=True)
class Judged:
    """What MuJoCo says of n jumps, whatever engine made them; NaN where there was none."""

    #: energy_balance_error, mujoco_height_m, mujoco_energy_j: as in ``AuditMeasures``, shape (n,)
    energy_balance_error: Floats
    mujoco_height_m: Floats
    mujoco_energy_j: Floats

    def as_columns(self) -> dict[str, Floats]:
        """Return column name to values of shape (n,)."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    def clear(self, jumps: Jumps | Evaluations) -> NDArray[np.bool_]:
        """Return where MuJoCo makes the same jump and its energy balance closes, shape (n,)."""
        (most,) = (limit.most for limit in LIMITS if limit.name == "energy_balance_error")
        return np.array([not apart for apart in self.apart(jumps)]) & (self.energy_balance_error <= most)

    def apart(self, jumps: Jumps | Evaluations) -> tuple[str, ...]:
        """Return for each jump how far MuJoCo's is from it, if by more than ``SAME``; empty where it is the same."""
        height = np.abs(self.mujoco_height_m - jumps.height_m)
        energy = np.abs(self.mujoco_energy_j / jumps.energy_j - 1.0)
        same = (height <= SAME) & (energy <= SAME)
        return tuple(
            "" if fine or not ok else f"by MuJoCo {h:.7g} m on {e:.7g} J, not the same jump"
            for fine, ok, h, e in zip(same, jumps.ok, self.mujoco_height_m, self.mujoco_energy_j, strict=True)
        )


def judge(
    designs: Floats,
    actuator_map: Maps,
    calibration: Calibration,
    jumps: Jumps | Evaluations,
    *,
    workers: int = 1,
    executor: Executor | None = None,
) -> Judged:
    """Jump with each design again by MuJoCo, shape (n, number of variables), and close its energy balance."""
    columns_of = {name: np.full(len(designs), np.nan) for name in (field.name for field in fields(Judged))}
    ok = np.flatnonzero(jumps.ok)
    if len(ok):
        setup = ((joint_maps(actuator_map),), calibration.by("mujoco"))
        if executor is None:
            found = _balanced(setup, designs[ok], workers)
        else:
            text = setup_text(*setup)
            pace = pace_of(executor, _balanced_of, text)
            found = joined(spread(executor, pace, len(ok), _balanced_of, lambda rows: (text, designs[ok][rows])))
        columns_of["energy_balance_error"][ok] = found.error
        columns_of["mujoco_height_m"][ok] = np.where(found.ok, found.height_m, np.nan)
        columns_of["mujoco_energy_j"][ok] = np.where(found.ok, found.energy_j, np.nan)
    return Judged(**columns_of)


def _balanced_of(text: str, values: Floats) -> Balanced:
    return _balanced(built(text), values, task_threads())


def _balanced(setup: Setup, values: Floats, workers: int) -> Balanced:
    (maps,), calibration = setup
    robots = robot_arrays(values, maps, calibration.mass)
    return balanced(robots, control_of(values), calibration, workers)


ONLY_IN_FULL = ("quarter_step_height_m", "quarter_step_energy", "control_period_height_m", "control_period_energy")
"""Measures of a full audit that no limit is about and that take jumps of their own."""


def _spread(copies: Floats, base: Jumps | Evaluations, jumps: Evaluator) -> dict[str, Floats]:
    """Return the changes of height and energy in ``copies`` of each design, shape (n, copies, number of variables)."""
    found = jumps(copies.reshape(-1, copies.shape[-1]))
    height = np.abs(found.height_m.reshape(copies.shape[:2]) - base.height_m[:, None])
    energy = np.abs(found.energy_j.reshape(copies.shape[:2]) / base.energy_j[:, None] - 1.0)
    ok = np.flatnonzero(base.ok)
    return {
        "spread_height_m": _percentile(height, ok, SPREAD_PERCENTILE),
        "spread_energy": _percentile(energy, ok, SPREAD_PERCENTILE),
        "worst_height_m": _percentile(height, ok, 100.0),
        "worst_energy": _percentile(energy, ok, 100.0),
    }


def _brief_spread(
    copies: Floats, base: Jumps | Evaluations, jumps: Evaluator, smooth: NDArray[np.bool_]
) -> dict[str, Floats]:
    """``_spread`` of the first copies where these hardly change and the design is ``smooth``, else of all copies."""
    found = _spread(copies[:, :FIRST_COPIES], base, jumps)
    unclear = np.flatnonzero(~(smooth & _within(CLEAR_SPREAD, found)) & base.ok)
    if len(unclear):
        some = Jumps(status=base.status[unclear], height_m=base.height_m[unclear], energy_j=base.energy_j[unclear])
        for name, values in _spread(copies[unclear], some, jumps).items():
            found[name][unclear] = values
    return found


def _within(share: float, changes: Mapping[str, Floats]) -> NDArray[np.bool_]:
    """Return where all changes that have a limit lie within a share of it; NaN does not."""
    limited = [changes[limit.name] <= share * limit.most for limit in LIMITS if limit.name in changes]
    within: NDArray[np.bool_] = np.logical_and.reduce(limited)
    return within


def _with_two_periods(values: Floats, jumps: Evaluator, quarter: Evaluations) -> tuple[Evaluations, Evaluations]:
    """Return jumps at a quarter of the step without delay, with the full control period and with a quarter of it.

    Without delay, ``quarter``, the jumps under ``finer(calibration, 4)``, are one of both.
    """
    calibration = jumps.calibration
    simulation = calibration.simulation
    period_s, step_s = simulation.period_s, simulation.timestep_s / 4
    of_quarter = step_s if simulation.control_period_s is None else period_s
    known = of_quarter if simulation.delay_s == 0.0 else None

    def timed_jumps(control_period_s: float) -> Evaluations:
        if control_period_s == known:
            return quarter
        timed = replace(simulation, timestep_s=step_s, control_period_s=control_period_s, delay_s=0.0)
        changed = replace(calibration, simulation=timed)
        return evaluator_of(jumps.actuator_map, changed, jumps.workers, executor=jumps.executor)(values)

    return timed_jumps(period_s), timed_jumps(period_s / 4)


def _changes(prefix: str, base: Jumps | Evaluations, other: Evaluations) -> dict[str, Floats]:
    """Return absolute change of height and relative change of energy; infinite where ``other`` has lost the jump."""
    lost = base.ok & ~other.ok
    height = np.where(lost, np.inf, np.abs(other.height_m - base.height_m))
    energy = np.where(lost, np.inf, np.abs(other.energy_j / base.energy_j - 1.0))
    return {f"{prefix}_height_m": height, f"{prefix}_energy": energy}


def _percentile(changes: Floats, ok: NDArray[np.intp], percent: float) -> Floats:
    """Return a percentile of each row of ``changes``, shape (n, copies); NaN for rows not in ``ok``.

    A failed copy (NaN) counts as an infinite change. The percentile is the smallest change that at least ``percent`` of
    the copies do not exceed, not interpolated, because infinity would spoil it.
    """
    result = np.full(len(changes), np.nan)
    known = np.sort(np.where(np.isnan(changes[ok]), np.inf, changes[ok]), axis=1)
    rank = int(np.ceil(percent / 100.0 * changes.shape[1])) - 1
    result[ok] = known[:, rank]
    return result
