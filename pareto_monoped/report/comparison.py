"""Several studies side by side: hypervolume from one reference point, energy at given heights, spread over seeds."""

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.pareto.indicators import hypervolume
from pareto_monoped.report.rounding import number
from pareto_monoped.report.schema import Comparison
from pareto_monoped.study.reader import StudyData

Floats = NDArray[np.float64]

_POINTS = 160  # of a surface or a curve: more than a chart can show apart


def group_of(data: StudyData) -> str:
    """A text that is equal for studies which differ only in seed, name, description, budget or stopping rule."""
    values = data.study.as_dict()
    for key in ("name", "description", "seed", "evaluations", "stop"):
        values.pop(key, None)
    contents = data.meta.contents
    return json.dumps([values, contents], sort_keys=True, default=str)


def compare(studies: Sequence[StudyData], labels: Sequence[str], heights_m: Sequence[float]) -> Comparison:
    """Compare studies; all hypervolumes are measured from the first one's reference point."""
    reference = studies[0].reference_point
    fronts = [data.front()[["height_m", "energy_j"]].to_numpy(dtype=np.float64) for data in studies]
    rows: list[dict[str, Any]] = []
    for data, label, front in zip(studies, labels, fronts, strict=True):
        energies = energy_at(front, np.asarray(heights_m))
        rows.append(
            {
                "label": label,
                "motor": data.study.motor,
                "calibration": data.meta.calibration,
                "algorithm": data.study.algorithm.name,
                "seed": data.study.seed,
                "evaluations": len(data.trials),
                "front": len(front),
                "hypervolume": round(hypervolume(front, reference), 4),
                "energy_j": [number(energy) for energy in energies],
            }
        )
    groups: dict[str, list[int]] = {}
    for index, data in enumerate(studies):
        groups.setdefault(group_of(data), []).append(index)
    several = [members for members in groups.values() if len(members) > 1]
    return Comparison(
        reference={"height_m": reference.height_m, "energy_j": reference.energy_j},
        heights_m=list(heights_m),
        rows=rows,
        surfaces=[_surface([fronts[i] for i in members], [labels[i] for i in members]) for members in several],
        growth=[_growth([studies[i] for i in members], [labels[i] for i in members]) for members in several],
    )


def energy_at(front: Floats, heights_m: Floats) -> Floats:
    """Least energy of a front, shape (n, 2), for at least each height, shape (m,); infinite where none reaches it."""
    reach = front[:, 0][None, :] >= heights_m[:, None]
    return np.where(reach, front[:, 1][None, :], np.inf).min(axis=1, initial=np.inf)


def _surface(fronts: Sequence[Floats], labels: Sequence[str]) -> dict[str, Any]:
    """Empirical attainment surfaces (Grunert da Fonseca et al. 2001): what one, half and all of the runs reached.

    For two objectives, a surface is an order statistic of the runs' least energies at each height. The median of an
    even number of runs is the upper one of the middle two, so that at least half of the runs reach it.
    """
    everything = np.concatenate(fronts)
    if len(everything) == 0:
        return {"labels": list(labels), "height_m": [], "best": [], "median": [], "worst": []}
    heights = np.linspace(everything[:, 0].min(), everything[:, 0].max(), _POINTS)
    ranked = np.sort(np.stack([energy_at(front, heights) for front in fronts]), axis=0)
    return {
        "labels": list(labels),
        "height_m": [round(h, 4) for h in heights.tolist()],
        "best": [number(v) for v in ranked[0]],
        "median": [number(v) for v in ranked[len(fronts) // 2]],
        "worst": [number(v) for v in ranked[-1]],
    }


def _growth(studies: Sequence[StudyData], labels: Sequence[str]) -> dict[str, Any]:
    """Least, median and greatest hypervolume over evaluations, where all runs have values."""
    histories = [data.history[["evaluations", "hypervolume"]].to_numpy(dtype=np.float64) for data in studies]
    histories = [history for history in histories if len(history)]
    if not histories:
        return {"labels": list(labels), "evaluations": [], "low": [], "median": [], "high": []}
    last = min(float(history[-1, 0]) for history in histories)
    first = max(float(history[0, 0]) for history in histories)
    at = np.unique(np.linspace(min(first, last), last, _POINTS).round())
    volumes = np.stack([_held(history, at) for history in histories])
    return {
        "labels": list(labels),
        "evaluations": at.tolist(),
        "low": [number(v) for v in volumes.min(axis=0)],
        "median": [number(v) for v in np.median(volumes, axis=0)],
        "high": [number(v) for v in volumes.max(axis=0)],
    }


def _held(history: Floats, at: Floats) -> Floats:
    """The latest value at each number of evaluations, 0 before the first."""
    place = np.searchsorted(history[:, 0], at, side="right") - 1
    return np.where(place >= 0, history[np.maximum(place, 0), 1], 0.0)
