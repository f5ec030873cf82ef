"""What choosing by mechanical energy costs at the battery; competitors of the paper's design; numbered trials."""

import contextlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
import pandas as pd

from pareto_monoped.design import PAPER_CASES
from pareto_monoped.errors import SelectionError
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives
from pareto_monoped.pareto.pick import pick
from pareto_monoped.pareto.selectors import Among, MinHeight, Selector, Trial
from pareto_monoped.storage.reader import StudyData

HEIGHT_AND_BATTERY = Objectives(names=("height_m", "electrical_energy_j"))
"""What the owner of a robot pays for, in place of the paper's mechanical energy."""

WORDS = {"energy_j": "mechanical energy", "electrical_energy_j": "battery energy"}
"""The two energies, told apart in few words."""

HEIGHTS_M = (0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3)
"""Heights at which the designs of both fronts are compared: from the paper's cases to what few designs reach."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Choice:
    """A design that a front offers for a height: its trial, energies, motors, and the real ratios of its gearboxes."""

    trial: int
    energy_j: float
    electrical_energy_j: float
    hip_ratio: float
    knee_ratio: float
    motor: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Pair:
    """The designs of least energy for a height, by mechanical energy and by that at the battery; None: not reached."""

    height_m: float
    mechanical: Choice | None
    battery: Choice | None

    @property
    def cost(self) -> float | None:
        """Energy at the battery that choosing by mechanical energy costs, as a share of the least; None if unknown."""
        if self.mechanical is None or self.battery is None:
            return None
        share = self.mechanical.electrical_energy_j / self.battery.electrical_energy_j - 1.0
        return share if np.isfinite(share) else None


def counterpart(objectives: Objectives) -> Objectives | None:
    """Return the same search by the other energy; None if it is not one of height against one energy."""
    pairs = {HEIGHT_AND_ENERGY: HEIGHT_AND_BATTERY, HEIGHT_AND_BATTERY: HEIGHT_AND_ENERGY}
    return pairs.get(objectives)


def two_fronts(studies: Sequence[StudyData]) -> tuple[StudyData, StudyData] | None:
    """Return the studies by mechanical and by battery energy, if these are the two and else define the same search."""
    by = {data.study.objectives: data for data in studies}
    if len(studies) != 2 or set(by) != {HEIGHT_AND_ENERGY, HEIGHT_AND_BATTERY}:
        return None
    mechanical, battery = by[HEIGHT_AND_ENERGY], by[HEIGHT_AND_BATTERY]
    free = ("name", "description", "seed", "evaluations", "objectives", "reference_point", "stop")
    same = replace(battery.study, **{key: getattr(mechanical.study, key) for key in free}) == mechanical.study
    return (mechanical, battery) if same and mechanical.meta.contents == battery.meta.contents else None


def choices(mechanical: StudyData, battery: StudyData, heights_m: Sequence[float] = HEIGHTS_M) -> list[Pair]:
    """Return the designs that the fronts of both studies offer for each least height."""
    return [
        Pair(height_m=height, mechanical=_choice(mechanical, height), battery=_choice(battery, height))
        for height in heights_m
    ]


def _choice(data: StudyData, height_m: float) -> Choice | None:
    front = data.front()
    with contextlib.suppress(SelectionError):
        trial = pick(front, MinHeight(height_m=height_m), data.study.objectives).trial
        row, kit = front.set_index("trial").loc[trial], data.kit_of_trial(trial)
        return Choice(
            trial=trial,
            energy_j=float(row["energy_j"]),
            electrical_energy_j=float(row["electrical_energy_j"]),
            hip_ratio=kit.hip.lookup(float(row["hip_ratio"])).ratio,
            knee_ratio=kit.knee.lookup(float(row["knee_ratio"])).ratio,
            motor=kit.label,
        )
    return None


CASE = PAPER_CASES["C"]
"""The case of Table I in which all variables are free, as in the study of the main job."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Competitor:
    """One line of the comparison: a design in words, and its jump; NaN where that is not known."""

    label: str
    height_m: float
    energy_j: float
    rise_m: float = math.nan
    above_standing_m: float = math.nan


_COMPETED = tuple(one.name for one in fields(Competitor) if one.name != "label")


def headline(data: StudyData, knee_trial: int) -> tuple[Competitor, ...]:
    """Return the paper's design, published and simulated here, then the front's: as high, if any, and at the knee."""
    several = len(data.study.kits) > 1
    evaluations = Evaluator(data.case_kit, data.calibration)(CASE.design.as_array())
    simulated = Competitor(
        label=f"paper's Case {CASE.name}, simulated here" + (f" with {data.case_kit.label}" if several else ""),
        **{name: float(evaluations.of(name)[0]) for name in _COMPETED},
    )
    front, objectives = data.front(), data.study.objectives
    chosen = []
    with contextlib.suppress(SelectionError):
        wanted = MinHeight(height_m=simulated.height_m)
        chosen.append(("front: at least that height", pick(front, wanted, objectives).trial))
    chosen.append(("front: knee", knee_trial))
    jumps = front.set_index("trial")
    return (
        Competitor(label=f"paper's Case {CASE.name}, as published", height_m=CASE.height_m, energy_j=CASE.energy_j),
        simulated,
        *(
            Competitor(
                label=f"{label}, trial {trial}" + (f", {jumps.loc[trial, 'motor']}" if several else ""),
                **{name: float(jumps.loc[trial, name]) for name in _COMPETED},
            )
            for label, trial in chosen
        ),
    )


def numbered(selector: Selector | None) -> int | None:
    """Return the number of the trial that a selector names; None if it chooses in another way."""
    chooser = selector.chooser if isinstance(selector, Among) else selector
    return chooser.number if isinstance(chooser, Trial) else None


def with_numbered(data: StudyData, front: pd.DataFrame, selector: Selector | None) -> pd.DataFrame:
    """Return the front, and after it the trial that a selector names, if it is feasible and has not failed an audit."""
    number = numbered(selector)
    if number is None or (front["trial"] == number).any() or number in data.ill_conditioned:
        return front
    rows = data.trials[(data.trials["trial"] == number) & (data.trials["state"] == "feasible")]
    return pd.concat([front, rows], ignore_index=True) if len(rows) else front


def better_than(rows: pd.DataFrame, trial: int, objectives: Objectives) -> list[int]:
    """Return the trials that dominate one of them: no worse in any objective, and better in one."""
    loss = objectives.minimised(rows[list(objectives.names)].to_numpy(dtype=np.float64))
    own = loss[np.flatnonzero(rows["trial"] == trial)[0]]
    found = (loss <= own).all(axis=1) & (loss < own).any(axis=1)
    return [int(number) for number in rows["trial"][found]]
