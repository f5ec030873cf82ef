"""Studies -> what the page shows: a pure function of study data and what was simulated again for it."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from pareto_monoped import __version__
from pareto_monoped.design import NAMES, PAPER_CASES, VARIABLES
from pareto_monoped.errors import SelectionError
from pareto_monoped.pareto.pick import Knee, MinHeight, Selector, pick
from pareto_monoped.report.columns import column
from pareto_monoped.report.comparison import compare, group_of
from pareto_monoped.report.physics import Extras
from pareto_monoped.report.quantities import AUDIT, EVERY_TRIAL, QUANTITIES
from pareto_monoped.report.records import (
    ActuatorTable,
    Column,
    Gearbox,
    Model3D,
    Payload,
    Picked,
    StudyCard,
    Trials,
)
from pareto_monoped.report.summary import notes, sentences
from pareto_monoped.study.definition import Bounds
from pareto_monoped.study.reader import StudyData
from pareto_monoped.study.settings import WeightedSettings

MOST_ROWS = 20_000
"""Trials on one page over all its studies; beyond that only every n-th dominated one is kept, which the page says."""
HEADLINES_M = (0.7, 0.8, 0.9)
"""Heights at which studies are compared; 0.8 m is that of the paper's Case C."""
_LETTER = {"feasible": "f", "infeasible": "i", "failed": "x"}
_HISTORY = 300  # points of a convergence curve


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """One database: its file name, what it holds, what was simulated again, and exported models by trial."""

    database: str
    data: StudyData
    extras: Extras
    models: Mapping[int, Model3D]


def build(sources: Sequence[Source], literal: Sequence[Mapping[str, Any]] = ()) -> Payload:
    """The page's content.

    Args:
        sources: one a database, in the order of the command line.
        literal: the paper's cases under the ``paper`` calibration, as in ``jump.table1.Spread``.
    """
    motors: list[Any] = []
    firsts: list[int] = []
    gearboxes: list[Gearbox] = []
    maps: list[ActuatorTable] = []
    for source in sources:
        motor = source.extras.actuator_map.motor
        if motor not in motors:
            table = source.extras.table(first=len(gearboxes))
            motors.append(motor)
            firsts.append(len(gearboxes))
            maps.append(table.map)
            gearboxes.extend(table.gearboxes)
    labels = _labels(sources)
    shares = _shares([len(source.data.trials) for source in sources])
    cards = []
    for source, label, most in zip(sources, labels, shares, strict=True):
        number = motors.index(source.extras.actuator_map.motor)
        cards.append(_card(source, label, most, number, firsts[number]))
    return Payload(
        version=__version__,
        title=cards[0].name if len(cards) == 1 else f"{cards[0].name} and {len(cards) - 1} more",
        variables=[asdict(variable) for variable in VARIABLES],
        quantities=QUANTITIES,
        published=[
            {"name": c.name, "height_m": c.height_m, "energy_j": c.energy_j, "design": c.design.as_dict()}
            for c in PAPER_CASES.values()
        ],
        literal=literal,
        gearboxes=gearboxes,
        maps=maps,
        studies=cards,
        comparison=compare([source.data for source in sources], labels, HEADLINES_M) if len(sources) > 1 else None,
    )


def _labels(sources: Sequence[Source]) -> list[str]:
    """Name of the study, and what tells it from others on the page that have the same name."""
    names = [source.data.study.name for source in sources]
    labels: list[str] = []
    for source, name in zip(sources, names, strict=True):
        label = name if names.count(name) == 1 else f"{name}, seed {source.data.study.seed}"
        tries = [label, f"{label}, {source.database}", *(f"{label} ({n})" for n in range(2, len(sources) + 2))]
        labels.append(next(text for text in tries if text not in labels))
    return labels


def _shares(sizes: list[int]) -> list[int]:
    """How many rows of each study fit on the page."""
    total = sum(sizes)
    return [size if total <= MOST_ROWS else max(size * MOST_ROWS // total, 1) for size in sizes]


def _kept(trials: pd.DataFrame, always: NDArray[np.bool_], most: int) -> NDArray[np.intp]:
    """Positions of the rows on the page: all, or the front, the audited and every n-th of the others."""
    if len(trials) <= most:
        return np.arange(len(trials))
    others = np.flatnonzero(~always)
    room = max(most - int(always.sum()), 0)
    chosen = others[np.linspace(0, len(others) - 1, room).astype(np.intp)] if room else others[:0]
    return np.sort(np.concatenate((np.flatnonzero(always), chosen)))


def _card(source: Source, label: str, most: int, map_number: int, first_gearbox: int) -> StudyCard:
    data, study, extras = source.data, source.data.study, source.extras
    front = data.front()
    bad = set(data.ill_conditioned.tolist())
    weights = _weighted(data)
    number = data.trials["trial"].to_numpy()
    always = np.isin(number, [*front["trial"], *bad, *(trial for _, trial in weights)])
    trials = data.trials.iloc[_kept(data.trials, always, most)].reset_index(drop=True)
    row_of = {int(trial): row for row, trial in enumerate(trials["trial"])}
    picks = _picks(front, row_of)
    feasible = data.trials[data.trials["state"] == "feasible"]
    bodies_kg = extras.body_masses_kg(front[list(NAMES)].to_numpy(dtype=np.float64))
    counts = {state: int((data.trials["state"] == state).sum()) for state in _LETTER} | {"total": len(data.trials)}
    failed = data.trials.loc[data.trials["state"] == "failed", "status"].value_counts()
    return StudyCard(
        label=label,
        name=study.name,
        description=study.description,
        database=source.database,
        motor=extras.actuator_map.motor.name,
        motor_name=study.motor,
        calibration=data.meta.calibration,
        calibration_name=study.calibration,
        map=map_number,
        algorithm=study.algorithm.name,
        seed=study.seed,
        group=group_of(data),
        state="finished" if data.meta.finished else "unfinished",
        budget=data.meta.budget,
        seconds=data.wall_time_s,
        counts=counts,
        reasons={str(status): int(count) for status, count in failed.items()},
        hypervolume=float(data.history["hypervolume"].iloc[-1]) if len(data.history) else 0.0,
        reference=asdict(data.reference_point),
        bounds={
            name: [value.lower, value.upper] if isinstance(value, Bounds) else [value, value]
            for name, value in study.variables.items()
        },
        summary=sentences(data, front, extras.cases),
        notes=notes(data, extras),
        trials=_trials(trials, extras, first_gearbox, len(data.trials)),
        front=[row_of[int(trial)] for trial in front["trial"]],
        ill_conditioned=[row_of[trial] for trial in sorted(bad)],
        picks=picks,
        more=_more(front, bodies_kg),
        audits=_audits(data.audits),
        jumps={str(trial): jump for trial, jump in extras.jumps.items()},
        models={str(trial): model for trial, model in source.models.items()},
        cases=extras.cases,
        history=_history(data.history),
        weighted=[[weight, row_of[trial]] for weight, trial in weights],
        floor_mass_kg=float(feasible["mass_kg"].min()) if len(feasible) else None,
        foot_mass_kg=extras.foot_kg,
        foot_radius_m=extras.foot_radius_m,
        provenance=_provenance(source),
        reproduce=_reproduce(data),
    )


def _trials(trials: pd.DataFrame, extras: Extras, first_gearbox: int, total: int) -> Trials:
    names = [*NAMES, "height_m", "energy_j", *EVERY_TRIAL]
    columns: dict[str, Column] = {name: column(trials[name]) for name in names}
    for joint in ("hip", "knee"):
        local = extras.gearboxes(trials[f"{joint}_ratio"].to_numpy(dtype=np.float64))
        columns[f"{joint}_gearbox"] = np.where(local >= 0, local + first_gearbox, -1).tolist()
    return Trials(
        trial=trials["trial"].tolist(),
        state="".join(_LETTER.get(str(state), "x") for state in trials["state"]),
        columns=columns,
        total=total,
    )


def _more(front: pd.DataFrame, bodies_kg: NDArray[np.float64]) -> dict[str, Column]:
    names = [q.name for q in QUANTITIES if q.name in front.columns and q.name not in (*NAMES, "height_m", "energy_j")]
    bodies = {f"{body}_kg": column(bodies_kg[:, i]) for i, body in enumerate(("base", "thigh", "shank"))}
    return {name: column(front[name]) for name in names} | bodies


def _audits(audits: pd.DataFrame) -> dict[str, dict[str, Any]]:
    names = [name for name in AUDIT if name in audits.columns]
    values = {name: column(audits[name]) for name in names}
    # An infinite change (the jump failed when it was perturbed) becomes None; the reason says so in words.
    reasons = audits["reason"].tolist() if "reason" in audits.columns else [""] * len(audits)
    return {
        str(int(trial)): {name: values[name][i] for name in names} | {"good": bool(good), "reason": str(reasons[i])}
        for i, (trial, good) in enumerate(zip(audits["trial"], audits["well_conditioned"], strict=True))
    }


def _history(history: pd.DataFrame) -> dict[str, Column]:
    kept = np.unique(np.linspace(0, len(history) - 1, min(len(history), _HISTORY)).astype(int))
    return {
        name: column(history[name].to_numpy()[kept], 6) if len(history) else []
        for name in ("evaluations", "hypervolume")
    }


def _picks(front: pd.DataFrame, row_of: Mapping[int, int]) -> list[Picked]:
    """The knee and the cheapest designs at the headline heights."""
    found: list[Picked] = []
    named: list[tuple[str, Selector]] = [
        ("knee", Knee()),
        *((f"{height:g} m", MinHeight(height_m=height)) for height in HEADLINES_M),
    ]
    for name, selector in named:
        try:
            picked = pick(front, selector)
        except SelectionError:
            continue
        if row_of[picked.trial] not in [p.row for p in found]:
            found.append(Picked(name=name, row=row_of[picked.trial], why=picked.why))
    return found


def _weighted(data: StudyData) -> list[tuple[float, int]]:
    """The result of each run of a weighted search: its height weight and the trial of least cost."""
    settings = data.study.algorithm
    if not isinstance(settings, WeightedSettings):
        return []
    rows = data.trials[(data.trials["state"] == "feasible") & data.trials["height_weight"].notna()]
    best = []
    for weight, run in rows.groupby("height_weight"):
        share = float(weight)
        cost = share * settings.height_scale_j * np.exp(-run["height_m"]) + (1.0 - share) * run["energy_j"]
        best.append((share, int(run.loc[cost.idxmin(), "trial"])))
    return best


def _provenance(source: Source) -> list[list[str]]:
    data = source.data
    meta, study = data.meta, data.study
    rows = [
        ("study", study.name),
        ("database", source.database),
        ("created", meta.created),
        ("state", "finished" if meta.finished else "unfinished"),
        ("ended because of", meta.stop_reason or "nothing yet"),
        ("seed", study.seed),
        ("motor", study.motor),
        ("calibration", meta.calibration),
        ("settings hash (SHA-256)", meta.hash),
        *((f"version of {name}", version) for name, version in meta.versions.items()),
        *((name, value) for name, value in meta.environment.items()),
    ]
    settings = _flat(study.as_dict())
    skipped = ("name", "description", "seed", "motor", "calibration")
    return [[str(k), str(v)] for k, v in (*rows, *((k, v) for k, v in settings if k not in skipped))]


def _flat(values: Mapping[str, Any], prefix: str = "") -> list[tuple[str, str]]:
    """Nested settings as ``table.key``, value."""
    rows: list[tuple[str, str]] = []
    for key, value in values.items():
        if isinstance(value, Mapping):
            rows += _flat(value, f"{prefix}{key}.")
        elif value is not None:
            rows.append((f"{prefix}{key}", f"{value:g}" if isinstance(value, float) else str(value)))
    return rows


def _reproduce(data: StudyData) -> str:
    """The command that runs the same study again, from its study file."""
    return f"pareto-monoped run STUDY.toml --seed {data.study.seed} --evaluations {data.meta.budget}"
