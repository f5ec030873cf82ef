"""What the studies of a campaign found, with medians and bands over those that can be compared, and as CSV."""

import csv
import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from pareto_monoped.campaign.folder import Place, Stored, stored_state
from pareto_monoped.campaign.grid import Campaign
from pareto_monoped.design import Floats
from pareto_monoped.pareto.objectives import Objectives
from pareto_monoped.pareto.trade_offs import knee
from pareto_monoped.storage.reader import read_study

LEVELS_M = (0.7, 0.8, 0.9)  #: Heights at which tables say what they cost: those of the report of a study.
LOW, HIGH = 0.1, 0.9  #: Ends of the bands: what a tenth of the studies and nine tenths of them reach.
POINTS = 120  #: Of a curve: more than a chart can show apart.
SEEDS = "seeds"  #: The axis that says nothing of the robot; its studies are repetitions.


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """A study of a campaign and what it found."""

    place: Place
    stored: Stored  #: how far it is
    calibration: str  #: name and version; the name alone before the study began
    front: Floats  #: values of the objectives of the designs on the front, shape (n, m)
    history: Floats  #: evaluations and hypervolume after each generation, shape (k, 2)
    feasible: float  #: share of its trials that are feasible; NaN without trials

    @property
    def finished(self) -> bool:
        """Whether the study has all its trials and a front, and can be compared."""
        return self.stored.state == "finished"

    @property
    def objectives(self) -> Objectives:
        """Of the study."""
        return self.place.study.objectives

    @property
    def knee(self) -> Floats:
        """Objectives of the knee of the front, shape (m,); NaN without a front."""
        if not len(self.front):
            return np.full(len(self.objectives.names), np.nan)
        return np.asarray(self.front[int(np.argmax(knee(self.front, self.front, self.objectives).score))])

    @property
    def most(self) -> float:
        """The best value of ``pair_of``'s first objective; NaN without a front."""
        values = self.front[:, self.objectives.names.index(pair_of(self.objectives)[0])]
        if not len(values):
            return float("nan")
        maximised = self.objectives.directions[pair_of(self.objectives)[0]] == "maximise"
        return float(values.max() if maximised else values.min())

    def least(self, levels: Floats) -> Floats:
        """Return the best second objective of ``pair_of`` per level reached in the first, shape (k,); else NaN."""
        names = pair_of(self.objectives)
        columns = [self.objectives.names.index(name) for name in names]
        signs = self.objectives.signs[columns]
        points = self.front[:, columns] * signs
        reach = points[:, 0][None, :] <= (levels * signs[0])[:, None]
        best = np.where(reach, points[:, 1][None, :], np.inf).min(axis=1, initial=np.inf)
        return np.where(np.isfinite(best), best * signs[1], np.nan)


def pair_of(objectives: Objectives) -> tuple[str, str]:
    """Return the two objectives that a curve shows: the height, else the first, and the first other one."""
    heights = [name for name in objectives.names if is_height(name)]
    first = (heights or list(objectives.names))[0]
    return first, objectives.other_than(first).name


def is_height(name: str) -> bool:
    """Return whether an objective is the height, or what built robots keep of it."""
    return name.partition(".")[0] == "height_m"


def levels_of(objectives: Objectives) -> tuple[float, ...]:
    """Return levels at which tables give the second objective of ``pair_of``; none where the first is no height."""
    return LEVELS_M if is_height(pair_of(objectives)[0]) else ()


def results_of(places: Sequence[Place], failed: Mapping[str, str] | None = None) -> list[Result]:
    """Return what each study found; those that have not begun or cannot be read found nothing.

    ``failed`` has, by name, why studies could not be run just now. A database that does not match its running hash is a
    ``DatabaseError``.
    """
    return [_result(place, (failed or {}).get(place.name)) for place in places]


def _result(place: Place, reason: str | None) -> Result:
    stored = stored_state(place)
    if reason is not None:
        stored = replace(stored, state="failed", reason=reason)
    if stored.summary is None:
        nothing, name = np.zeros((0, len(place.study.objectives.names))), place.study.calibration
        history = np.zeros((0, 2))
        return Result(place=place, stored=stored, calibration=name, front=nothing, history=history, feasible=math.nan)
    # Read whole, because only then everything is checked against the running hash.
    data = read_study(place.db)
    states = data.trials["state"]
    return Result(
        place=place,
        stored=stored,
        calibration=data.meta.calibration,
        front=data.front()[list(data.study.objectives.names)].to_numpy(dtype=np.float64),
        history=data.history[["evaluations", "hypervolume"]].to_numpy(dtype=np.float64),
        feasible=float((states == "feasible").mean()) if len(states) else float("nan"),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Group:
    """Finished studies that have something in common, such as all seeds with one motor."""

    label: str
    results: tuple[Result, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """Finished studies that can be compared: the same objectives under the same calibration."""

    objectives: Objectives
    calibration: str
    axes: tuple[str, ...]  #: that vary among them
    results: tuple[Result, ...]
    groups: tuple[Group, ...]  #: those that differ in nothing but the seed

    def by(self, axis: str) -> tuple[Group, ...]:
        """Return the studies by their value on one axis, whatever they have on the others."""
        return _grouped(self.results, (axis,))


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """What half of some values reach, a tenth of them and nine tenths; NaN where so many reach nothing."""

    middle: float
    low: float
    high: float


def sections_of(results: Sequence[Result], axes: Sequence[str]) -> list[Section]:
    """Return the finished studies by what can be compared, in the order of the campaign."""
    found: dict[tuple[tuple[str, ...], str], list[Result]] = {}
    for result in results:
        if result.finished:
            found.setdefault((result.objectives.names, result.calibration), []).append(result)
    sections = []
    for (names, calibration), members in found.items():
        varying = tuple(axis for axis in axes if _values(members, axis) > 1)
        section = Section(
            objectives=Objectives(names=names),
            calibration=calibration,
            axes=varying,
            results=tuple(members),
            groups=_grouped(members, [axis for axis in varying if axis != SEEDS]),
        )
        sections.append(section)
    return sections


def _values(results: Sequence[Result], axis: str) -> int:
    return len({result.place.member.labels.get(axis) for result in results})


def _grouped(results: Sequence[Result], axes: Sequence[str]) -> tuple[Group, ...]:
    groups: dict[str, list[Result]] = {}
    for result in results:
        label = ", ".join(result.place.member.labels[axis] for axis in axes)
        groups.setdefault(label, []).append(result)
    return tuple(Group(label=label or "all", results=tuple(members)) for label, members in groups.items())


def spread_of(values: Sequence[float] | Floats) -> Spread:
    """Return median and band as order statistics (the lower median), for which NaN is the greatest value.

    Of fewer than ten values the band has all.
    """
    middle, low, high = quantiles(np.asarray(values, dtype=np.float64)[:, None])[:, 0]
    return Spread(middle=float(middle), low=float(low), high=float(high))


def quantiles(values: Floats) -> Floats:
    """Return median, low and high end of the bands of n runs at k places, shape (3, k) from shape (n, k)."""
    ranked = np.sort(values, axis=0)  # NaN last
    ranks = [max(int(np.ceil(share * len(ranked) - 1e-9)) - 1, 0) for share in (0.5, LOW, HIGH)]
    return np.asarray(ranked[ranks])


def levels_of_section(section: Section) -> Floats:
    """Return levels of the first objective of ``pair_of`` from the least to the most on any front, shape (k,)."""
    first = section.objectives.names.index(pair_of(section.objectives)[0])
    values = np.concatenate([result.front[:, first] for result in section.results])
    return np.linspace(values.min(), values.max(), POINTS)


def attainment(group: Group, levels: Floats) -> Floats:
    """Return what half, a tenth and nine tenths of the runs need at most for each level, shape (3, k).

    These are empirical attainment surfaces (Grunert da Fonseca et al. 2001): order statistics of the runs' best second
    objectives at each level of the first, such as their least energies at each height.
    """
    objectives = group.results[0].objectives
    sign = objectives.signs[objectives.names.index(pair_of(objectives)[1])]
    return np.asarray(sign * quantiles(np.stack([sign * result.least(levels) for result in group.results])))


def growth(group: Group) -> tuple[Floats, Floats]:
    """Return evaluations, shape (k,), and median and band of the hypervolume there, shape (3, k); the last is held."""
    histories = [result.history for result in group.results if len(result.history)]
    if not histories:
        return np.zeros(0), np.zeros((3, 0))
    last = max(float(history[-1, 0]) for history in histories)
    first = max(float(history[0, 0]) for history in histories)  # from there on all of them have a value
    at = np.unique(np.linspace(first, last, POINTS).round())
    return at, quantiles(np.stack([_held(history, at) for history in histories]))


def _held(history: Floats, at: Floats) -> Floats:
    """Return the latest value at each number of evaluations, none of them before the first."""
    return np.asarray(history[np.searchsorted(history[:, 0], at, side="right") - 1, 1])


def relative(section: Section) -> dict[str, float]:
    """Return each study's hypervolume as a share of the median of the studies that differ in the seed only."""
    shares = {}
    for group in section.groups:
        middle = spread_of([result.stored.hypervolume for result in group.results]).middle
        for result in group.results:
            shares[result.place.name] = result.stored.hypervolume / middle if middle > 0.0 else float("nan")
    return shares


def csv_text(campaign: Campaign, results: Sequence[Result]) -> str:
    """Return the table as CSV, with an empty cell for what a study does not have.

    ``knee_NAME`` are the objectives of the knee, ``best_NAME`` is the best value of the first objective,
    ``NAME_at_0_8_m`` the best second one among the designs that reach 0.8 m.
    """
    rows = [_row(campaign, result) for result in results]
    names = list(dict.fromkeys(name for row in rows for name in row))
    stream = io.StringIO()
    writer = csv.DictWriter(stream, names, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return stream.getvalue()


def _row(campaign: Campaign, result: Result) -> dict[str, Any]:
    study, stored = result.place.study, result.stored
    counts = {} if stored.summary is None else stored.summary.counts
    first, second = pair_of(study.objectives)
    at_levels = result.least(np.array(levels_of(study.objectives))).tolist()
    knee_values = zip(study.objectives.names, result.knee.tolist(), strict=True)
    return {
        "study": result.place.name,
        "database": str(result.place.db),
        **{axis: result.place.member.labels[axis] for axis in campaign.axes},
        "motor": study.motor_text,
        "calibration": result.calibration,
        "objective_names": " ".join(study.objectives.names),
        "algorithm": study.algorithm.name,
        "seed": study.seed,
        "state": stored.state,
        "evaluations": stored.evaluations,
        "budget": stored.budget,
        **{state: counts.get(state, 0) for state in ("feasible", "infeasible", "failed")},
        "wall_time_s": stored.seconds,
        "front": stored.front,
        "hypervolume": _number(stored.hypervolume if stored.evaluations else math.nan),
        "hypervolume_unit": stored.hypervolume_unit,
        f"best_{first}": _number(result.most),
        **{f"knee_{name}": _number(value) for name, value in knee_values},
        **{
            f"{second}_at_{str(level).replace('.', '_')}_m": _number(value)
            for level, value in zip(LEVELS_M, at_levels, strict=False)
        },
        "reason": stored.reason,
    }


def _number(value: float) -> float | str:
    return value if math.isfinite(value) else ""
