"""Several studies side by side: hypervolume from one reference point, cost of given heights, spread over seeds."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.analysis.choices import Choice, choices, two_fronts
from pareto_monoped.pareto.front import best_at_height
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives, hypervolume
from pareto_monoped.report.packing import number
from pareto_monoped.report.schema import Comparison
from pareto_monoped.storage.reader import StudyData

Floats = NDArray[np.float64]

_POINTS = 160  # of a surface or a curve: more than a chart can show apart


def group_of(data: StudyData) -> str:
    """Return a text that is equal for studies which differ only in seed, name, description, budget or stopping rule."""
    values = data.study.as_dict()
    for key in ("name", "description", "seed", "evaluations", "stop"):
        values.pop(key, None)
    return json.dumps([values, data.meta.contents], sort_keys=True, default=str)


def seed_groups(studies: Sequence[StudyData]) -> list[list[int]]:
    """Return places of the studies that are runs of one study with several seeds and one length; each seed once."""
    groups: dict[tuple[str, int], dict[int, int]] = {}
    for index, data in enumerate(studies):
        groups.setdefault((group_of(data), len(data.trials)), {}).setdefault(data.study.seed, index)
    return [list(members.values()) for members in groups.values()]


def compare(studies: Sequence[StudyData], labels: Sequence[str], heights_m: Sequence[float]) -> Comparison:
    """Compare studies under the objectives of the first; all hypervolumes are measured from its reference point."""
    reference, objectives = studies[0].reference_point, studies[0].reference_point.objectives
    with_height = "height_m" in objectives.names
    fronts = [data.front()[list(objectives.names)].to_numpy(dtype=np.float64) for data in studies]
    rows: list[dict[str, Any]] = []
    for data, label, front in zip(studies, labels, fronts, strict=True):
        found = [best_at_height(front, objectives, height) for height in heights_m] if with_height else []
        values = {
            "label": label,
            "motor": data.study.motor_text,
            "calibration": data.meta.calibration,
            "algorithm": data.study.algorithm.name,
            "seed": data.study.seed,
            "evaluations": len(data.trials),
            "front": len(front),
            "hypervolume": round(hypervolume(front, reference), 4),
            "at_height": [None if best is None or best.value is None else number(best.value) for best in found],
        }
        rows.append(values)
    several = [members for members in seed_groups(studies) if len(members) > 1]
    named = [[labels[i] for i in members] for members in several]
    runs = list(zip(several, named, strict=True)) if len(objectives.names) == 2 else []
    return Comparison(
        reference=reference.text(),
        hypervolume_unit=objectives.volume_unit,
        other=objectives.other_than("height_m").name,
        heights_m=list(heights_m) if with_height else [],
        rows=rows,
        surfaces=[_surface([fronts[i] for i in members], names, objectives) for members, names in runs],
        growth=[_growth([studies[i] for i in members], names) for members, names in zip(several, named, strict=True)],
        choices=_choices(studies),
    )


def _choices(studies: Sequence[StudyData]) -> list[dict[str, Any]]:
    """Return what two fronts by the two energies offer at some heights, as JSON values, if there are such fronts."""
    pair = two_fronts(studies)
    if pair is None:
        return []
    found = []
    for row in choices(*pair):
        sides = {"mechanical": _plain(row.mechanical), "battery": _plain(row.battery)}
        found.append({"height_m": row.height_m, "cost": row.cost, **sides})
    return found


def _plain(choice: Choice | None) -> dict[str, Any] | None:
    if choice is None:
        return None
    return {name: value if isinstance(value, str) else number(value) for name, value in asdict(choice).items()}


def least_second(front: Floats, levels: Floats, objectives: Objectives = HEIGHT_AND_ENERGY) -> Floats:
    """Return the best second objective of a front, shape (n, 2), per level of the first or better, shape (m,).

    In the sign that makes less better; infinite where no design reaches the level. With the paper's objectives it is
    the least energy for at least each height.
    """
    points = objectives.minimised(front)
    reach = points[:, 0][None, :] <= (levels * objectives.signs[0])[:, None]
    return np.asarray(np.where(reach, points[:, 1][None, :], np.inf).min(axis=1, initial=np.inf))


def _surface(
    fronts: Sequence[Floats], labels: Sequence[str], objectives: Objectives = HEIGHT_AND_ENERGY
) -> dict[str, Any]:
    """Return empirical attainment surfaces (Grunert da Fonseca et al. 2001): what one, half, all of the runs reached.

    For two objectives, a surface is an order statistic of the runs' best second objectives at each level of the first,
    such as their least energies at each height. The median is what half of the runs reach: of an even number, the
    better one of the middle two. Two runs have none.
    """
    everything = np.concatenate(fronts)
    if len(everything) == 0:
        return {"labels": list(labels), "first": [], "best": [], "median": [], "worst": []}
    levels = np.linspace(everything[:, 0].min(), everything[:, 0].max(), _POINTS)
    ranked = np.sort(np.stack([least_second(front, levels, objectives) for front in fronts]), axis=0)
    ranked *= objectives.signs[1]
    return {
        "labels": list(labels),
        "first": [round(level, 4) for level in levels.tolist()],
        "best": [number(v) for v in ranked[0]],
        "median": [number(v) for v in ranked[(len(fronts) - 1) // 2]] if len(fronts) > 2 else [],
        "worst": [number(v) for v in ranked[-1]],
    }


def _growth(studies: Sequence[StudyData], labels: Sequence[str]) -> dict[str, Any]:
    """Return least, median and greatest hypervolume over evaluations, where all runs have values."""
    histories = [data.history[["evaluations", "hypervolume"]].to_numpy(dtype=np.float64) for data in studies]
    histories = [history for history in histories if len(history)]
    if not histories:
        return {"labels": list(labels), "evaluations": [], "low": [], "median": [], "high": [], "middle": ""}
    last = min(float(history[-1, 0]) for history in histories)
    first = max(float(history[0, 0]) for history in histories)
    at = np.unique(np.linspace(min(first, last), last, _POINTS).round())
    volumes = np.stack([_held(history, at) for history in histories])
    return {
        "labels": list(labels),
        "evaluations": at.tolist(),
        "low": [number(v) for v in volumes.min(axis=0)],
        "median": [number(v) for v in np.median(volumes, axis=0)],
        "middle": "mean of 2 seeds" if len(volumes) == 2 else f"median of {len(volumes)} seeds",
        "high": [number(v) for v in volumes.max(axis=0)],
    }


def _held(history: Floats, at: Floats) -> Floats:
    """Return the latest value at each number of evaluations, 0 before the first."""
    place = np.searchsorted(history[:, 0], at, side="right") - 1
    return np.where(place >= 0, history[np.maximum(place, 0), 1], 0.0)
