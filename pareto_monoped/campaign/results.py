"""What the studies of a campaign found: the part of each database that tables and charts compare."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.campaign.folder import Place, Stored, stored_state
from pareto_monoped.pareto.knees import knee
from pareto_monoped.pareto.objectives import Objectives
from pareto_monoped.study.reader import read_study

Floats = NDArray[np.float64]

LEVELS_M = (0.7, 0.8, 0.9)
"""Heights at which tables say what they cost: those of the report of a study."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """A study of a campaign and what it found.

    Attributes:
        place: the study.
        stored: how far it is.
        calibration: name and version; the name alone before the study began.
        front: values of the objectives of the designs on the front, shape (n, m).
        history: evaluations and hypervolume after each generation, shape (k, 2).
        feasible: share of its trials that are feasible; NaN without trials.
    """

    place: Place
    stored: Stored
    calibration: str
    front: Floats
    history: Floats
    feasible: float

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
        return np.asarray(self.front[int(np.argmax(knee(self.front, self.objectives).score))])

    @property
    def most(self) -> float:
        """The best value of ``pair_of``'s first objective; NaN without a front."""
        values = self.front[:, self.objectives.names.index(pair_of(self.objectives)[0])]
        if not len(values):
            return float("nan")
        maximised = self.objectives.directions[pair_of(self.objectives)[0]] == "maximise"
        return float(values.max() if maximised else values.min())

    def least(self, levels: Floats) -> Floats:
        """The best second objective of ``pair_of`` among designs that reach each level of the first, shape (k,).

        NaN where none does.
        """
        names = pair_of(self.objectives)
        columns = [self.objectives.names.index(name) for name in names]
        signs = self.objectives.signs[columns]
        points = self.front[:, columns] * signs
        reach = points[:, 0][None, :] <= (levels * signs[0])[:, None]
        best = np.where(reach, points[:, 1][None, :], np.inf).min(axis=1, initial=np.inf)
        return np.where(np.isfinite(best), best * signs[1], np.nan)


def pair_of(objectives: Objectives) -> tuple[str, str]:
    """The two objectives that a curve shows: the height, where it is one, else the first, and the first other one."""
    heights = [name for name in objectives.names if is_height(name)]
    first = (heights or list(objectives.names))[0]
    return first, objectives.other_than(first).name


def is_height(name: str) -> bool:
    """Whether an objective is the height, or what built robots keep of it."""
    return name.partition(".")[0] == "height_m"


def levels_of(objectives: Objectives) -> tuple[float, ...]:
    """Levels at which tables give the second objective of ``pair_of``; none where the first is no height."""
    return LEVELS_M if is_height(pair_of(objectives)[0]) else ()


def results_of(places: Sequence[Place], failed: Mapping[str, str] | None = None) -> list[Result]:
    """What each study found; those that have not begun or cannot be read found nothing.

    Args:
        places: of the studies.
        failed: name -> reason of studies that could not be run just now, which their databases do not say.

    Raises:
        DatabaseError: a database does not match its running hash.
    """
    return [_result(place, (failed or {}).get(place.name)) for place in places]


def _result(place: Place, reason: str | None) -> Result:
    stored = stored_state(place)
    if reason is not None:
        stored = replace(stored, state="failed", reason=reason)
    if stored.summary is None:
        nothing = np.zeros((0, len(place.study.objectives.names)))
        empty = np.zeros((0, 2))
        return Result(
            place=place,
            stored=stored,
            calibration=place.study.calibration,
            front=nothing,
            history=empty,
            feasible=float("nan"),
        )
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
