"""What the hardware of a design can do with the best torque found, whatever the controller: energy and height.

The torques of both joints go through knots over time (``jump.laws.TorqueOverTime``). CMA-ES moves them, beginning with
the torques that the virtual leg tells the motors. A jump counts if it presses no bumper beyond its travel, and counts
as held if it also overloads no part. A value found is a certificate: that jump reaches it. That nothing better exists
is not shown; the bound below which no controller can be is ``jump.gravity.least_energy_j``.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from scipy.linalg import block_diag

from pareto_monoped.actuator.ratiomap import Maps
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
from pareto_monoped.errors import SelectionError, StudyError
from pareto_monoped.jump.audit import finer
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.engines import told_profiles
from pareto_monoped.jump.evaluate import Evaluations, Evaluator
from pareto_monoped.jump.gravity import least_energy_j
from pareto_monoped.jump.laws import OF_VIRTUAL_LEG, PAPER_LAW, TorqueOverTime
from pareto_monoped.measures import ENERGIES, nominal
from pareto_monoped.robot.population import robot_arrays
from pareto_monoped.search.weighted import cma_es
from pareto_monoped.storage.reader import StudyData
from pareto_monoped.strength.groups import REQUIRED_MEASURES

LAW = TorqueOverTime(kind="torque_over_time", knots=MOST_KNOTS)
"""What is searched: cubics through as many knots as a profile can have."""
JUMPS = 3000
"""Jumps of each of the four searches of a design. Our own choice: 15 s per design on two quiet cores."""
MOST_DESIGNS = 12
"""Designs of a front, thinned evenly, if none are named. Our own choice: some minutes on two cores."""
_POPULATION, _FEW = 12, 6
_SIGMA, _HIGH_SIGMA, _FINE_SIGMA = 0.2, 0.3, 0.08  # of energies, of heights, of both in the end
_TIMES_S = (0.05, 1.0)
_COMPRESSION = 1.0  # of a bumper, as a share of its travel, up to which a jump counts
_STEEP = 8.0  # energy that a missing height costs, in units of what the virtual leg needs per height
_MARGIN_M = 1e-4  # searched above the height that is asked for, so that the end of a search lies on the right side


@dataclass(frozen=True, slots=True, kw_only=True)
class Reached:
    """One jump with the hardware of a design: a certificate."""

    height_m: float
    energy_j: float  #: the energy that the search is for
    design: Design  #: with the knots of ``LAW``, or that of the virtual leg, where nothing better was found
    profile: bool  #: whether ``design`` jumps by ``LAW``
    #: half_step_height_m, half_step_energy: changes with the step halved; the energy's as a share
    half_step_height_m: float
    half_step_energy: float

    def as_dict(self) -> dict[str, Any]:
        """Return plain values; the controller is a table of a study file."""
        law = {"controller": LAW.as_dict()} if self.profile else {}
        numbers = {name: getattr(self, name) for name in ("height_m", "energy_j")}
        changes = {name: getattr(self, name) for name in ("half_step_height_m", "half_step_energy")}
        return numbers | changes | law | {"design": self.design.as_dict()}


@dataclass(frozen=True, slots=True, kw_only=True)
class Limit:
    """What the hardware of one design reaches."""

    trial: int | None
    energy: str  #: which energy, one of ``measures.ENERGIES``
    height_m: float  #: of the design's own jump
    energy_j: float
    floor_j: float  #: below which no controller can be at this height
    least: Reached  #: least energy of a jump at least as high
    greatest: Reached  #: greatest height
    #: The same among jumps that overload no part; None where none was found
    least_held: Reached | None
    greatest_held: Reached | None
    jumps: int  #: that were made

    @property
    def controller_gap(self) -> float:
        """Share of the design's energy in percent that the best torque found saves at its height."""
        return 100.0 * (1.0 - self.least.energy_j / self.energy_j)

    @property
    def controller_gap_held(self) -> float | None:
        """The same without overloading a part; below 0 only where the design's own jump overloads one."""
        return None if self.least_held is None else 100.0 * (1.0 - self.least_held.energy_j / self.energy_j)

    def as_dict(self) -> dict[str, Any]:
        """Return plain values."""
        reached = {
            name: None if (one := getattr(self, name)) is None else one.as_dict()
            for name in ("least", "least_held", "greatest", "greatest_held")
        }
        names = ("trial", "energy", "height_m", "energy_j", "floor_j", "controller_gap", "controller_gap_held")
        return {name: getattr(self, name) for name in names} | reached | {"jumps": self.jumps}


class _Hardware:
    """Jumps of one design's hardware with profiles, points of the unit cube of shape (n, 25)."""

    def __init__(self, design: Floats, maps: Maps, calibration: Calibration, energy: str, workers: int) -> None:
        self.design, self.maps, self.energy = design, maps, energy
        self.virtual, self.calibration = calibration, calibration.under(LAW)
        self._evaluator = Evaluator(maps, self.calibration, workers)
        self._places = [ALL_NAMES.index(name) for name in KNOT_NAMES]
        self.base = np.array([*design[: len(NAMES)], *(ALL_DEFAULTS[name] for name in KNOT_NAMES)])
        for name in OF_VIRTUAL_LEG:
            self.base[ALL_NAMES.index(name)] = ALL_DEFAULTS.get(name, 0.0)
        self.jumps = 0
        self.own = Evaluator(maps, calibration)(design)
        robots = robot_arrays(design, maps, calibration.mass)
        self.told = _point_of(told_profiles(robots, control_of(design[None]), calibration, LAW)[0])
        self.floor_j = float(least_energy_j(robots, calibration, self.own.height_m)[0])

    def designs(self, points: Floats) -> Floats:
        designs = np.tile(self.base, (len(points), 1))
        low, high = _TIMES_S
        designs[:, self._places] = 2.0 * points - 1.0
        designs[:, self._places[0]] = low + (high - low) * points[:, 0]
        return designs

    def __call__(self, points: Floats) -> Evaluations:
        self.jumps += len(points)
        return self._evaluator(self.designs(points))


def _point_of(profile: Floats) -> Floats:
    """Return the point of the unit cube whose profile is nearest."""
    low, high = _TIMES_S
    point = np.append((profile[0] - low) / (high - low), 0.5 * (profile[1:] + 1.0))
    return np.asarray(np.clip(point, 0.0, 1.0))


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

    def cost(self, jumps: Evaluations) -> tuple[Floats, Floats]:
        """Return what CMA-ES minimises, and the objective itself, infinite where a jump does not count."""
        height_m, missed = np.nan_to_num(jumps.height_m), self.missed(jumps)
        if self.at_least_m is None:
            value, scale, short = -height_m, 1.0, np.zeros(len(height_m))
            counts = missed == 0.0
        else:
            value, scale = jumps.of(self.energy), self.steep_j_per_m
            short = np.maximum(self.at_least_m + _MARGIN_M - height_m, 0.0)
            counts = (missed == 0.0) & (height_m >= self.at_least_m)
        cost = value + scale * (short + np.minimum(missed, 10.0))
        return np.where(jumps.ok, cost, 1e3 * scale), np.where(counts, value, np.inf)


def _searched(hardware: _Hardware, goal: _Goal, start: Floats, jumps: int, seed: Sequence[int]) -> tuple[float, Floats]:
    """Return the best value of a search, infinite if no jump counts, and its point, shape (25,).

    Half of the jumps move few knots, which lead to wider changes, between which cubics lie; then every knot moves.
    """
    wide = _widened(_FEW)
    point, (_, (least, *_)) = start, goal.cost(hardware(start[None]))
    sigma = _HIGH_SIGMA if goal.at_least_m is None else _SIGMA
    stages = ((wide, np.linalg.lstsq(wide, start, rcond=None)[0], sigma), (np.eye(len(start)), None, _FINE_SIGMA))
    for stage, (matrix, first, sigma) in enumerate(stages):
        begin = np.clip(point if first is None else first, 0.0, 1.0)
        strategy = cma_es(begin, sigma, _POPULATION, np.random.default_rng((*seed, stage)))
        for _ in range(jumps // (len(stages) * _POPULATION)):
            asked = strategy.ask()
            points = np.clip(np.array(asked) @ matrix.T, 0.0, 1.0)
            cost, values = goal.cost(hardware(points))
            strategy.tell(asked, cost.tolist())
            k = int(values.argmin())
            if values[k] < least:
                point, least = points[k], values[k]
            if strategy.stop():
                break
    return float(least), point


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
) -> Limit:
    """Search the best torques of one design's hardware, shape (number of variables,), with ``jumps`` per search.

    The design's own jump is among the candidates, so that no gap is below 0. The same seed gives the same numbers,
    whatever the number of workers.

    Raises:
        StudyError: the design does not jump under the virtual leg.
    """
    hardware = _Hardware(design, maps, calibration, energy, workers)
    own = hardware.own
    if not own.ok[0]:
        raise StudyError(f"design: does not jump ({own.reason[0]}); choose one that does")
    height_m, energy_j = float(own.height_m[0]), float(own.of(energy)[0])
    steep = _STEEP * energy_j / max(height_m - float(design[NAMES.index("start_height_m")]), 0.05)
    found: dict[str, Reached | None] = {}
    for number, (name, at_least_m) in enumerate((("least", height_m), ("greatest", None))):
        value, start = energy_j if at_least_m else -height_m, hardware.told
        results: dict[bool, tuple[float, Floats | None]] = {}
        for held in (False, True):
            goal = _Goal(at_least_m=at_least_m, held=held, energy=energy, steep_j_per_m=steep)
            results[held] = least, reached = _searched(hardware, goal, start, jumps, (seed, number, held))
            if at_least_m:  # the greatest heights with and without strength have little in common
                start = reached
            own_counts = not held or goal.missed(own)[0] == 0.0
            if own_counts and value <= least:
                results[held] = (value, None)
        # A jump that keeps more conditions keeps the fewer, too.
        results[False] = min(results.values(), key=lambda one: one[0])
        for held, (least, point) in results.items():
            found[f"{name}_held" if held else name] = _reached(hardware, point) if np.isfinite(least) else None
    least_free, greatest_free = found["least"], found["greatest"]
    assert least_free is not None
    assert greatest_free is not None
    return Limit(
        trial=trial,
        energy=energy,
        height_m=height_m,
        energy_j=energy_j,
        floor_j=hardware.floor_j,
        least=least_free,
        greatest=greatest_free,
        least_held=found["least_held"],
        greatest_held=found["greatest_held"],
        jumps=hardware.jumps,
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
        design=Design.from_array(values[0]),
        profile=point is not None,
        half_step_height_m=float(fine.height_m[0]) - height_m,
        half_step_energy=float(fine.of(hardware.energy)[0]) / energy_j - 1.0,
    )


def chosen(data: StudyData, front: pd.DataFrame, trials: Sequence[int], most: int) -> pd.DataFrame:
    """Return the rows of some trials or, if none are named, of at most ``most`` of a front, evenly spread over it.

    Raises:
        SelectionError: a trial that is not there or did not jump, or an empty front.
    """
    if trials:
        rows = data.trials.set_index("trial", drop=False)
        for trial in trials:
            if trial not in rows.index or rows.loc[trial, "status"] != "ok":
                raise SelectionError(f"trial {trial}: is not there or did not jump; choose another")
        return rows.loc[list(dict.fromkeys(trials))].reset_index(drop=True)
    if not len(front):
        raise SelectionError("front: is empty; name trials, or run the study longer")
    ordered = front.sort_values("height_m", kind="stable", ignore_index=True)
    places = np.unique(np.linspace(0, len(ordered) - 1, min(most, len(ordered))).round().astype(int))
    return ordered.iloc[places].reset_index(drop=True)


def limits(
    data: StudyData, rows: pd.DataFrame, *, jumps: int = JUMPS, seed: int = 1, workers: int | None = None
) -> Iterator[Limit]:
    """Yield the limit of each of some trials, for the energy that is an objective of the study.

    Raises:
        StudyError: the study's designs do not jump under the virtual leg.
    """
    if data.calibration.controller.law != PAPER_LAW:
        raise StudyError("limit: is that of designs under the virtual leg, the study has another controller; give one")
    names = [nominal(name) for name in data.study.objectives.names]
    energy = next((name for name in ENERGIES if name in names), ENERGIES[0])
    for position, design in enumerate(designs_of(rows)):
        row = rows.iloc[position]
        trial = int(row["trial"])
        kit = data.kit_of_trial(trial)
        yield limit_of(
            design,
            kit,
            data.calibration,
            energy=energy,
            jumps=jumps,
            seed=seed,
            workers=workers or cores(),
            trial=trial,
        )
