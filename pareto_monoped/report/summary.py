"""The sentences at the head of the page, and where a study's numbers come from: versions, settings, command."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import pandas as pd

from pareto_monoped.analysis.remarks import warnings
from pareto_monoped.definition.study import NO_STRENGTH
from pareto_monoped.design import HEADLINE_HEIGHT_M, PAPER_CASES
from pareto_monoped.pareto.front import best_at_height
from pareto_monoped.pareto.growth import AHEAD, left_to_gain
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives
from pareto_monoped.report.schema import Case
from pareto_monoped.storage.reader import StudyData

if TYPE_CHECKING:
    from pareto_monoped.jump.calibration import Calibration
    from pareto_monoped.report.resimulation import Resimulation

_WORTH_TELLING = 0.001  # our own choice: a front that grows by less looks the same
_DRIFT_M = 0.001  # our own choice: the last digit in which the page shows a height
_ABOVE = ("name", "description", "seed", "motor", "hip_motor", "knee_motor", "calibration")
"""Settings that stand in the first rows of the table or elsewhere on the page."""


def sentences(data: StudyData, front: pd.DataFrame, cases: Sequence[Case]) -> list[str]:
    """Return what the front achieves: what the headline height costs, and a comparison with the paper's Case C."""
    done = len(data.trials)
    if done == 0:
        return ["No design has been simulated yet: run or resume the study, then make the report again."]
    if len(front) == 0:
        return [
            f"None of the {done} designs is feasible: there is no front to choose from. Run longer, widen the bounds, "
            "or relax the constraints."
        ]
    objectives = data.study.objectives
    if len(front) == 1:
        only = front.iloc[0][list(objectives.names)].tolist()
        lines = [f"One design is on the front: {objectives.text(only)}."]
    elif objectives != HEIGHT_AND_ENERGY:
        lines = [_extent(front, objectives)]
    else:
        low, high = front.iloc[0], front.iloc[-1]
        lines = [
            f"{_price(front, HEADLINE_HEIGHT_M)}; the front of {len(front)} designs runs "
            f"from {low['height_m']:.2f} m on {low['energy_j']:.1f} J "
            f"to {high['height_m']:.2f} m on {high['energy_j']:.1f} J."
        ]
    lines += _standing_up(front) if "height_m" in objectives.names else []
    lines += _against_paper(front, cases) if objectives == HEIGHT_AND_ENERGY else []
    return [*lines, _losses(data.calibration)]


def _standing_up(front: pd.DataFrame) -> list[str]:
    """Return how much of the heights at both ends of the front is standing up; empty for a study that lacks it."""
    ends = front.loc[[front["height_m"].idxmin(), front["height_m"].idxmax()]]
    height, above, rise = (ends[name].astype(float).tolist() for name in ("height_m", "above_standing_m", "rise_m"))
    if ends[["above_standing_m", "rise_m"]].isna().any(axis=None):
        return []
    low, high = (min(whole, whole - more) for whole, more in zip(height, above, strict=True))
    return [
        "Heights count from the floor to the base, as in the paper, so most of a height is standing up on a straight "
        f"leg: {low:.2f} m of the lowest, {height[0]:.2f} m, and {high:.2f} m of the highest, {height[1]:.2f} m. Their "
        f"centres of mass rise by {rise[0]:.2f} m and {rise[1]:.2f} m after lift-off."
    ]


def _losses(calibration: "Calibration") -> str:
    """Return which gears a study has, by what they lose."""
    drive = calibration.drive
    if not drive.mesh_losses or drive.gear_loss == 0.0:
        return "Gears lose nothing in this study."
    if drive.gear_loss == 1.0:
        return "Gears lose what machined ones do; printed ones lose 1.3 to 4 times as much under load."
    return (
        f"Gears lose {drive.gear_loss:g} times what machined ones do under load; printed ones lose 1.3 to 4 times that."
    )


def _extent(front: pd.DataFrame, objectives: Objectives) -> str:
    """Return what a height costs, where it is an objective, and how far the front reaches in every objective."""
    values = front[list(objectives.names)].to_numpy(dtype=float)
    ranges = [
        f"{entry.words} ({entry.text(column.min())} to {entry.text(column.max())})"
        for entry, column in zip(objectives.measures, values.T, strict=True)
    ]
    text = f"the front of {len(front)} designs covers {', '.join(ranges[:-1])} and {ranges[-1]}."
    best = best_at_height(values, objectives)
    if best is None:
        return f"{text[0].upper()}{text[1:]}"
    if best.value is None:
        return f"No design reaches {best.height_m:.2f} m; {text}"
    side = "allows at most" if best.measure.direction == "maximise" else "needs at least"
    return f"{best.height_m:.2f} m {side} {best.measure.text(best.value)} of {best.measure.label}; {text}"


def _price(front: pd.DataFrame, height_m: float) -> str:
    reach = front[front["height_m"] >= height_m]
    if len(reach) == 0:
        return f"No design reaches {height_m:.2f} m, the highest jump is {front['height_m'].max():.3f} m"
    return f"{height_m:.2f} m costs at least {reach['energy_j'].min():.1f} J"


def _against_paper(front: pd.DataFrame, cases: Sequence[Case]) -> list[str]:
    """Return the paper's Case C, published and simulated here, against the front at the height that it reaches here."""
    here = next((case for case in cases if case.name == "C"), None)
    published = PAPER_CASES["C"]
    if here is None:
        return []
    text = f"The paper's Case C (published: {published.height_m:.2f} m on {published.energy_j:.1f} J)"
    if here.height_m is None or here.energy_j is None:
        return [f"{text} does not jump under this study's motor and calibration: {here.reason or here.status}."]
    text += f" reaches {here.height_m:.2f} m on {here.energy_j:.1f} J under this study's calibration"
    reach = front[front["height_m"] >= here.height_m]
    if len(reach) == 0:
        return [f"{text}, higher than this front goes."]
    energy = float(reach["energy_j"].min())
    change = 100.0 * (energy / here.energy_j - 1.0)
    compared = f"{abs(change):.0f} % {'less' if change < 0.0 else 'more'}"
    return [f"{text}; the front gets that high on {energy:.1f} J, {compared}."]


def notes(data: StudyData, again: "Resimulation") -> list[str]:
    """Return what the reader has to know before using the page."""
    lines = []
    done, budget = len(data.trials), data.meta.budget
    if not data.meta.finished and done >= budget:
        lines.append(f"All {done} designs are simulated. The audit of the front is not finished: designs may leave it.")
    elif not data.meta.finished:
        lines.append(
            f"Unfinished: {done} of {budget} designs are simulated. The front will still move, and it is audited only "
            "at the end."
        )
    left = left_to_gain(*data.history[["evaluations", "hypervolume"]].to_numpy().T)
    if left is not None and left > _WORTH_TELLING:
        lines.append(
            f"{AHEAD} times as many designs would gain about {left:.1%} of the hypervolume, by how the front has grown."
        )
    bad = len(data.ill_conditioned)
    if bad:
        lines.append(
            f"{bad} design{' was' if bad == 1 else 's were'} taken off the front by the audit: their height or energy "
            "changes with the smallest change of the design or of the time step."
        )
    if data.study.copies > 1:
        lines.append(
            f"Measures are medians over {data.study.copies} copies of each design, changed by up to 1e-6, because "
            f"rounding decides a single jump under the calibration {data.study.calibration}. Films show the design's "
            "own jump."
        )
    elif again.drift_m > _DRIFT_M:
        lines.append(
            f"Heights simulated again for this page differ by up to {1000.0 * again.drift_m:.1f} mm from those stored: "
            "the code, a library version or the machine is not the one that the study ran with."
        )
    lines += [f"{line[0].upper()}{line[1:]}." for line in warnings(data, data.front())]
    if not data.study.strength:
        lines.append(f"{NO_STRENGTH[0].upper()}{NO_STRENGTH[1:]}.")
    return lines


def provenance(data: StudyData) -> list[list[str]]:
    """Return rows of name and value: the study, the versions and machine it ran on, and every setting."""
    meta, study = data.meta, data.study
    rows = [
        ("study", study.name),
        ("database", data.db),
        ("created", meta.created),
        ("state", "finished" if meta.finished else "unfinished"),
        ("ended because of", meta.stop_reason or "nothing yet"),
        ("seed", study.seed),
        ("motor", study.motor_text),
        ("calibration", meta.calibration),
        ("settings hash (SHA-256)", meta.hash),
        ("content hash (SHA-256)", data.content_hash),
        ("running hash", "intact" if data.sealed else "none"),
        *((f"version of {name}", version) for name, version in meta.versions.items()),
        *((name, value) for name, value in meta.environment.items()),
        *((key, value) for key, value in _flat(study.as_dict()) if key not in _ABOVE),
    ]
    return [[str(key), str(value)] for key, value in rows]


def _flat(values: Mapping[str, Any], prefix: str = "") -> list[tuple[str, str]]:
    """Return nested settings as rows of ``table.key`` and value."""
    rows: list[tuple[str, str]] = []
    for key, value in values.items():
        if isinstance(value, Mapping):
            rows += _flat(value, f"{prefix}{key}.")
        elif value is not None:
            rows.append((f"{prefix}{key}", f"{value:g}" if isinstance(value, float) else str(value)))
    return rows


def command(data: StudyData) -> str:
    """Return the command that runs the study again from its study file."""
    return f"pareto-monoped run STUDY.toml --seed {data.study.seed} --evaluations {data.meta.budget}"
