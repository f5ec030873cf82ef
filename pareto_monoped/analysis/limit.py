"""What the hardware of a design can do with the best torque found, whatever the controller: energy and height.

The torques of both joints go through knots over time (``jump.laws.TorqueOverTime``). CMA-ES moves them, beginning with
the torques that the virtual leg tells the motors. A jump counts if it presses no bumper beyond its travel, and counts
as held if it also overloads no part. A value found is a certificate: that jump reaches it. That nothing better exists
is not shown; the bound below which no controller can be is ``jump.gravity.least_energy_j``. What a profile is worth on
a robot with delay, other motors and all that is uncertain is told beside it, and so is a law that keeps to the leg.
"""

import copy
import functools
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from scipy.linalg import block_diag

from pareto_monoped.actuator.ratiomap import Maps
from pareto_monoped.analysis.robustness import refuse_other_jumps, rows_of, sampling
from pareto_monoped.compute.chunks import cores
from pareto_monoped.design import (
    ALL_DEFAULTS,
    ALL_NAMES,
    KNOT_NAMES,
    MOST_KNOTS,
    NAMES,
    Design,
    Floats,
    control_of,
    designs_of,
)
from pareto_monoped.errors import StudyError
from pareto_monoped.jump.audit import finer
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.controller_record import MOST_DELAY
from pareto_monoped.jump.engines import told_profiles
from pareto_monoped.jump.evaluate import Evaluations, Evaluator
from pareto_monoped.jump.gravity import least_energy_j
from pareto_monoped.jump.laws import OF_VIRTUAL_LEG, PAPER_LAW, Profile, TorqueOverTime, Tracking, law_of
from pareto_monoped.jump.variations import unvaried
from pareto_monoped.measures import ENERGIES, nominal
from pareto_monoped.robot.population import robot_arrays
from pareto_monoped.search.weighted import cma_es
from pareto_monoped.storage.extra_rows import LIMITS, Limit, Perturbed, Reached, read_limits
from pareto_monoped.storage.meta import strict_json
from pareto_monoped.storage.place import StudyPlace, storage_of
from pareto_monoped.storage.reader import StudyData, read_study
from pareto_monoped.storage.store import Store
from pareto_monoped.strength.groups import REQUIRED_MEASURES
from pareto_monoped.study.simulator import stored_simulator
from pareto_monoped.uncertainty.samples import Samples, sobol_samples, variations
from pareto_monoped.uncertainty.settings import load_uncertainty
from pareto_monoped.uncertainty.statistics import HIGH_PERCENT, LOW_PERCENT

LAW = TorqueOverTime(kind="torque_over_time", knots=MOST_KNOTS)
"""What is searched: cubics through as many knots as a profile can have."""
TRACKING = Tracking(kind="tracking", knots=MOST_KNOTS)
"""The law that is to survive delay and other motors."""
JUMPS = 3000
"""Jumps of each of the four searches of a design. Our own choice: 14 to 20 s per design on two cores."""
MOST_DESIGNS = 12
"""Designs of a front, thinned evenly, if none are named. Our own choice: some minutes on two cores."""
_POPULATION, _FEW = 12, 6
_SIGMA, _HIGH_SIGMA, _FINE_SIGMA = 0.2, 0.3, 0.08  # of energies, of heights, of both in the end
_FIRST = {LAW: ("push_time_s", 0.05, 1.0), TRACKING: ("damping_n_s_per_m", 0.0, 30.0)}  # moved besides the knots
_MOST = {LAW: 1.0, TRACKING: 1.5}  # of a knot; what the damper takes comes on top
_DAMPING_N_S_PER_M = 10.0  # that a search of the tracking law begins with, as much as studies allow
_DELAY_S, _TORQUE = 0.002, 0.05  # told of each law: a late command, and weak or strong motors
_SEARCHED = ((1.0, 1.0), (0.9, 0.9), (1.1, 1.1), (0.9, 1.1), (1.1, 0.9))
"""Torques of hip and knee of the jumps of each candidate of the tracking law, all but the first with the delay: about
the ends of what is uncertain as shipped, of which nothing else moves heights as much."""
_SHARE = 8  # the search has an eighth of the candidates of another one
_REACHES = 0.95  # of the height that was asked for, from which on a perturbed jump reaches it
_COMPRESSION = 1.0  # of a bumper, as a share of its travel, up to which a jump counts
_STEEP = 8.0  # energy that a missing height costs, in units of what the virtual leg needs per height
_MARGIN_M = 1e-4  # searched above the height that is asked for, so that the end of a search lies on the right side


class _Hardware:
    """Jumps of one design's hardware with profiles, points of the unit cube of shape (n, 25)."""

    law: Profile = LAW
    ways: int = 1  #: jumps of each point, one after the other, of which the first is as designed

    def __init__(self, design: Floats, maps: Maps, calibration: Calibration, energy: str, workers: int) -> None:
        self.design, self.maps, self.energy, self.workers = design, maps, energy, workers
        self.virtual, self.calibration = calibration, calibration.under(self.law)
        self._evaluator = Evaluator(maps, self.calibration, workers)
        first, *self._ends = _FIRST[self.law]
        self._places = [ALL_NAMES.index(name) for name in (first, *KNOT_NAMES[1:])]
        self.base = np.array([*design[: len(NAMES)], *(ALL_DEFAULTS[name] for name in KNOT_NAMES)])
        for name in OF_VIRTUAL_LEG:
            self.base[ALL_NAMES.index(name)] = ALL_DEFAULTS.get(name, 0.0)
        self.jumps = 0
        self.own = Evaluator(maps, calibration)(design)
        robots = robot_arrays(design, maps, calibration.mass)
        self.told = self.point_of(told_profiles(robots, control_of(design[None]), calibration, self.law)[0])
        self.floor_j = float(least_energy_j(robots, calibration, self.own.height_m)[0])

    def alone(self) -> "_Hardware":
        """Return the same with an evaluator and a count of its own, for another thread."""
        other = copy.copy(self)
        other._evaluator, other.jumps = Evaluator(self.maps, self.calibration, max(self.workers // 2, 1)), 0
        return other

    def designs(self, points: Floats) -> Floats:
        designs = np.tile(self.base, (len(points), 1))
        low, high = self._ends
        designs[:, self._places] = _MOST[self.law] * (2.0 * points - 1.0)
        designs[:, self._places[0]] = low + (high - low) * points[:, 0]
        return designs

    def point_of(self, profile: Floats) -> Floats:
        """Return the point of the unit cube whose profile, with what is moved besides its knots first, is nearest."""
        low, high = self._ends
        point = np.append((profile[0] - low) / (high - low), 0.5 * (profile[1:] / _MOST[self.law] + 1.0))
        return np.asarray(np.clip(point, 0.0, 1.0))

    def __call__(self, points: Floats) -> Evaluations:
        self.jumps += len(points)
        return self._evaluator(self.designs(points))


class _Tracked(_Hardware):
    """The same with the tracking law: each point jumps in the ways of ``_SEARCHED``."""

    law, ways = TRACKING, len(_SEARCHED)

    def __call__(self, points: Floats) -> Evaluations:
        self.jumps += self.ways * len(points)
        perturbed = unvaried(self.ways * len(points))
        perturbed.peak_torques[:] = np.tile(_SEARCHED, (len(points), 1))
        perturbed.delays_s[:] = _DELAY_S
        perturbed.delays_s[:: self.ways] = 0.0
        return self._evaluator(np.repeat(self.designs(points), self.ways, axis=0), variations=perturbed)

    def start(self, profile: Floats) -> Floats:
        """Return the point nearest to the torques of a profile over time."""
        model, design = self.virtual.under(LAW), profile.copy()
        design[NAMES.index("damping_n_s_per_m")] = _DAMPING_N_S_PER_M
        robots = robot_arrays(design, self.maps, model.mass)
        told = told_profiles(robots, control_of(design[None]), model, self.law, most=_MOST[self.law])[0]
        return self.point_of(np.append(_DAMPING_N_S_PER_M, told[1:]))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Goal:
    """What a search is for: the least energy at a height, or the greatest height if there is none."""

    at_least_m: float | None
    held: bool
    energy: str
    steep_j_per_m: float

    def missed(self, jumps: Evaluations) -> Floats:
        """Return how far jumps miss what they must keep, shape (n,); 0 if they keep it, infinite without an apex."""
        beyond = np.maximum(jumps.stop_compression_hip, jumps.stop_compression_knee) - _COMPRESSION
        missed = np.maximum(beyond, 0.0)
        for name in REQUIRED_MEASURES if self.held else ():
            missed = missed + np.maximum(1.0 - np.nan_to_num(jumps.of(name), nan=0.0), 0.0)
        return np.where(jumps.ok & np.isfinite(missed), missed, np.inf)

    def cost(self, jumps: Evaluations, ways: int) -> tuple[Floats, Floats]:
        """Return what CMA-ES minimises, and the objective itself, infinite where a point does not count.

        Of the ``ways`` in which each point jumps, the first has the objective. The others must reach nearly the height.
        """
        height_m, *others_m = np.nan_to_num(jumps.height_m).reshape(-1, ways).T
        missed, ok = self.missed(jumps).reshape(-1, ways).max(axis=1), jumps.ok.reshape(-1, ways).all(axis=1)
        if self.at_least_m is None:
            value, scale, short = -height_m, 1.0, np.zeros(len(height_m))
            counts = missed == 0.0
        else:
            value, scale = jumps.of(self.energy)[::ways], self.steep_j_per_m
            short = np.maximum(self.at_least_m + _MARGIN_M - height_m, 0.0)
            counts = (missed == 0.0) & (height_m >= self.at_least_m)
            for other_m in others_m:
                short = short + np.maximum(_REACHES * self.at_least_m + _MARGIN_M - other_m, 0.0)
                counts &= other_m >= _REACHES * self.at_least_m
        cost = value + scale * (short + np.minimum(missed, 10.0))
        return np.where(ok, cost, 1e3 * scale), np.where(counts, value, np.inf)


def _searched(hardware: _Hardware, goal: _Goal, start: Floats, jumps: int, seed: Sequence[int]) -> tuple[float, Floats]:
    """Return the best value of a search, infinite if no jump counts, and its point, shape (25,).

    Half of the jumps move few knots, which lead to wider changes, between which cubics lie; then every knot moves.
    """
    wide = _widened(_FEW)
    point, (_, (least, *_)) = start, goal.cost(hardware(start[None]), hardware.ways)
    sigma = _HIGH_SIGMA if goal.at_least_m is None else _SIGMA
    stages = [(wide, np.linalg.lstsq(wide, start, rcond=None)[0], sigma), (np.eye(len(start)), None, _FINE_SIGMA)]
    if hardware.ways > 1:  # which begins at the end of a search
        del stages[0]
    for stage, (matrix, first, sigma) in enumerate(stages):
        begin = np.clip(point if first is None else first, 0.0, 1.0)
        strategy = cma_es(begin, sigma, _POPULATION, np.random.default_rng((*seed, stage)))
        for _ in range(jumps // (len(stages) * _POPULATION)):
            asked = strategy.ask()
            points = np.clip(np.array(asked) @ matrix.T, 0.0, 1.0)
            cost, values = goal.cost(hardware(points), hardware.ways)
            strategy.tell(asked, cost.tolist())
            k = int(values.argmin())
            if values[k] < least:
                point, least = points[k], values[k]
            if strategy.stop():
                break
    return float(least), point


def _free_and_held(
    hardware: _Hardware, goal: _Goal, seed: Sequence[int], *, start: Floats, jumps: int
) -> dict[bool, tuple[float, Floats | None]]:
    """Return the best values without and with strength among the limits, and their points; None for the own jump."""
    own = hardware.own
    value = float(-own.height_m[0] if goal.at_least_m is None else own.of(goal.energy)[0])
    results: dict[bool, tuple[float, Floats | None]] = {}
    for held in (False, True):
        asked = replace(goal, held=held)
        results[held] = least, reached = _searched(hardware, asked, start, jumps, (*seed, held))
        if goal.at_least_m is not None:  # the greatest heights with and without strength have little in common
            start = reached
        if (not held or asked.missed(own)[0] == 0.0) and value <= least:
            results[held] = (value, None)
    # A jump that keeps more conditions keeps the fewer, too.
    results[False] = min(results.values(), key=lambda one: one[0])
    return results


def _widened(knots: int) -> Floats:
    """Return the matrix that makes points with all knots of those with few, shape (25, 1 + 2 knots)."""
    block = TorqueOverTime(kind="torque_over_time", knots=knots).basis(np.linspace(0.0, 1.0, LAW.knots))
    return np.asarray(block_diag(1.0, block, block))


def limit_of(
    design: Floats,
    maps: Maps,
    calibration: Calibration,
    *,
    energy: str = ENERGIES[0],
    jumps: int = JUMPS,
    seed: int = 1,
    workers: int = 1,
    trial: int | None = None,
    samples: Samples | None = None,
) -> Limit:
    """Search the best torques of one design's hardware, shape (number of variables,), with ``jumps`` per search.

    The design's own jump is among the candidates, so that no gap is below 0. The same seed gives the same numbers,
    whatever the number of workers. ``samples`` are of what is uncertain, by default as shipped.

    Raises:
        StudyError: the design does not jump under the virtual leg.
    """
    hardware = _Hardware(design, maps, calibration, energy, workers)
    own = hardware.own
    if not own.ok[0]:
        raise StudyError(f"design: does not jump ({own.reason[0]}); choose one that does")
    height_m, energy_j = float(own.height_m[0]), float(own.of(energy)[0])
    steep = _STEEP * energy_j / max(height_m - float(design[NAMES.index("start_height_m")]), 0.05)
    goals = (_Goal(at_least_m=at, held=False, energy=energy, steep_j_per_m=steep) for at in (height_m, None))
    # Two searches side by side share the cores better than the few jumps of one generation.
    sides = (hardware.alone(), hardware.alone()) if workers > 1 else (hardware, hardware)
    search = functools.partial(_free_and_held, start=hardware.told, jumps=jumps)
    with ThreadPoolExecutor(min(workers, 2)) as pool:
        pairs = list(pool.map(search, sides, goals, ((seed, 0), (seed, 1))))
    if workers > 1:
        hardware.jumps += sum(side.jumps for side in sides)
    found = {
        f"{name}_held" if held else name: _reached(hardware, point) if np.isfinite(least) else None
        for name, pair in zip(("least", "greatest"), pairs, strict=True)
        for held, (least, point) in pair.items()
    }
    least_free, greatest_free = found["least"], found["greatest"]
    assert least_free is not None
    assert greatest_free is not None
    least_held = found["least_held"]
    if samples is None:
        samples = sobol_samples(load_uncertainty().where(stand=calibration.stand is not None))
    goal = _Goal(at_least_m=height_m, held=least_held is not None, energy=energy, steep_j_per_m=steep)
    perturbed, over_time, tracking = _as_built(
        hardware, least_held or least_free, goal, samples, jumps // _SHARE, (seed, 2)
    )
    if tracking is not None:  # which may need less than torques over time, although these were searched for longer
        least_free = min(least_free, tracking, key=lambda one: one.energy_j)
        least_held = least_held and min(least_held, tracking, key=lambda one: one.energy_j)
    return Limit(
        trial=trial,
        energy=energy,
        controller_gap=100.0 * (1.0 - least_free.energy_j / energy_j),
        controller_gap_held=None if least_held is None else 100.0 * (1.0 - least_held.energy_j / energy_j),
        height_m=height_m,
        energy_j=energy_j,
        floor_j=hardware.floor_j,
        least=least_free,
        greatest=greatest_free,
        least_held=least_held,
        greatest_held=found["greatest_held"],
        over_time=over_time,
        tracking=tracking,
        perturbed=perturbed,
        jumps=hardware.jumps,
    )


def _as_built(
    hardware: _Hardware, over_time: Reached, goal: _Goal, samples: Samples, jumps: int, seed: Sequence[int]
) -> tuple[Perturbed | None, Reached, Reached | None]:
    """Return what robots as built make of the design and of torques over time, and the best tracking law found."""
    calibration, height_m = hardware.virtual, float(hardware.own.height_m[0])
    if not _may_be_late(samples, calibration):
        return None, over_time, None
    values, model = _jump_of(over_time, calibration)
    over_time = replace(over_time, perturbed=_perturbed(hardware, samples, values, model, height_m))
    profile = values if model.controller.law == LAW else hardware.designs(hardware.told[None])[0]
    tracked = _Tracked(hardware.design, hardware.maps, calibration, hardware.energy, hardware.workers)
    value, point = _searched(tracked, goal, tracked.start(profile), jumps, seed)
    hardware.jumps += tracked.jumps
    tracking = _reached(tracked, point) if np.isfinite(value) else None
    if tracking is not None:
        values, model = _jump_of(tracking, calibration)
        tracking = replace(tracking, perturbed=_perturbed(hardware, samples, values, model, height_m))
    return _perturbed(hardware, samples, hardware.design, calibration, height_m), over_time, tracking


def _jump_of(reached: Reached, calibration: Calibration) -> tuple[Floats, Calibration]:
    """Return the design of a jump as an array, and the calibration under its law."""
    law = law_of(reached.controller, source="limit")
    return designs_of({name: [value] for name, value in reached.design.items()})[0], calibration.under(law)


def _may_be_late(samples: Samples, calibration: Calibration) -> bool:
    """Return whether the control periods of a calibration have room for all delays."""
    longest_s = max(float(samples.values["delay_s"].max()), _DELAY_S) + calibration.simulation.delay_s
    return round(longest_s / calibration.simulation.period_s) <= MOST_DELAY


def _perturbed(
    hardware: _Hardware, samples: Samples, design: Floats, calibration: Calibration, height_m: float
) -> Perturbed:
    """Return what delay, other torques and all that is uncertain do to a jump for a height."""
    evaluator = Evaluator(hardware.maps, calibration, hardware.workers)
    told = unvaried(4)
    told.delays_s[1] = _DELAY_S
    told.peak_torques[2:] = [[1.0 - _TORQUE], [1.0 + _TORQUE]]
    jumps = evaluator(np.repeat(design[None], len(told), axis=0), variations=told)
    plain, late, weak, strong = np.nan_to_num(jumps.height_m).tolist()
    count = len(samples)
    built = evaluator(np.repeat(design[None], count, axis=0), variations=variations(samples, 1, calibration))
    heights = np.nan_to_num(built.height_m)
    missed = _Goal(at_least_m=None, held=True, energy=hardware.energy, steep_j_per_m=0.0).missed(built)
    hardware.jumps += len(told) + count
    low, high = np.percentile(heights, (LOW_PERCENT, HIGH_PERCENT)).tolist()
    return Perturbed(
        late_m=late - plain,
        weak_m=weak - plain,
        strong_m=strong - plain,
        p05_m=low,
        p95_m=high,
        reaches=float((heights >= _REACHES * height_m).mean()),
        holds=float((missed == 0.0).mean()),
    )


def _reached(hardware: _Hardware, point: Floats | None) -> Reached:
    """Return the jump of a point, or the design's own, with what a finer step changes."""
    model = hardware.virtual if point is None else hardware.calibration
    values = hardware.design[None] if point is None else hardware.designs(point[None])
    jump, fine = (Evaluator(hardware.maps, one)(values) for one in (model, finer(model, 2)))
    height_m, energy_j = float(jump.height_m[0]), float(jump.of(hardware.energy)[0])
    return Reached(
        height_m=height_m,
        energy_j=energy_j,
        design=Design.from_array(values[0]).as_dict(),
        controller=model.controller.law.as_dict(),
        half_step_height_m=float(fine.height_m[0]) - height_m,
        half_step_energy=float(fine.of(hardware.energy)[0]) / energy_j - 1.0,
    )


def chosen(data: StudyData, front: pd.DataFrame, trials: Sequence[int], most: int) -> pd.DataFrame:
    """Return the rows of some trials or, if none are named, of at most ``most`` of a front, evenly spread over it.

    Raises:
        SelectionError: a trial that is not there or did not jump, or an empty front.
    """
    rows = rows_of(data, trials or None, front)
    if trials:
        return rows
    ordered = rows.sort_values("height_m", kind="stable", ignore_index=True)
    places = np.unique(np.linspace(0, len(ordered) - 1, min(most, len(ordered))).round().astype(int))
    return ordered.iloc[places].reset_index(drop=True)


def limits(
    db: StudyPlace,
    rows: pd.DataFrame,
    *,
    jumps: int = JUMPS,
    seed: int = 1,
    workers: int | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> list[Limit]:
    """Find the limits of some trials, for the energy that is an objective of the study; store what is not there yet.

    After each search, ``progress`` is called with the number of designs searched and of those to be searched.

    Raises:
        StudyError: the study's designs do not jump under the virtual leg, or jump otherwise than they are stored.
        DatabaseError: the study is damaged, or in use by another process.
    """
    with storage_of(db).locked():
        data = read_study(db)
        if data.calibration.controller.law != PAPER_LAW:
            raise StudyError(
                f"controller = {data.calibration.controller.law.kind!r}: must be 'virtual_leg', with which limit "
                "compares; give a study of that controller"
            )
        names = [nominal(name) for name in data.study.objectives.names]
        ranges, count, sample_seed = sampling(data.study, None, None, None)
        ranges = ranges.where(stand=data.calibration.stand is not None)
        settings = {"jumps": jumps, "seed": seed, "controller": LAW.as_dict()}
        settings |= {"uncertainty": ranges.as_dict(), "samples": count, "sample_seed": sample_seed}
        known = {trial: stored.result for trial, stored in read_limits(db).items() if stored.settings == settings}
        fresh = rows[~rows["trial"].isin(known)]
        if len(fresh):
            refuse_other_jumps(data, fresh, stored_simulator(data, workers=workers or cores()).evaluator)
            with Store(db, data.study) as store:
                for done, (trial, design) in enumerate(zip(fresh["trial"].tolist(), designs_of(fresh), strict=True), 1):
                    known[trial] = limit_of(
                        design,
                        data.kit_of_trial(trial),
                        data.calibration,
                        energy=next((name for name in ENERGIES if name in names), ENERGIES[0]),
                        jumps=jumps,
                        seed=seed,
                        workers=workers or cores(),
                        trial=trial,
                        samples=sobol_samples(ranges, count, sample_seed),
                    )
                    store.set_rows(LIMITS, [(trial, strict_json(settings), strict_json(known[trial].as_dict()))])
                    progress(done, len(fresh))
    return [known[trial] for trial in rows["trial"].tolist()]
