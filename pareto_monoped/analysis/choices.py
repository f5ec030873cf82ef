"""Designs chosen from stored studies, audited before they are the answer; what choosing by mechanical energy costs."""

import contextlib
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from pareto_monoped.analysis.at_bounds import front_alone
from pareto_monoped.analysis.remarks import refuse_empty
from pareto_monoped.definition.study import is_opened
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.errors import ParetoMonopedError, SelectionError
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives
from pareto_monoped.pareto.pick import Pick, condition_on, needs_front_only, pick
from pareto_monoped.pareto.selectors import (
    Among,
    Compromise,
    Condition,
    Knee,
    MaxEnergy,
    MinHeight,
    Selector,
    Trial,
    column,
    required_fits,
)
from pareto_monoped.storage.front_reader import StudyFront
from pareto_monoped.storage.place import StudyPlace, storage_of
from pareto_monoped.storage.reader import StudyData, read_study

BATTERY = "electrical_energy_j"
HEIGHT_AND_BATTERY = Objectives(names=("height_m", BATTERY))
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
    """Return the studies by mechanical and by battery energy, if these are the two and else define the same search.

    Studies in which variables of another one are opened are left aside.
    """
    studies = [data for data in studies if not any(is_opened(data.study, one.study) for one in studies)]
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


def saved(
    study: StudyData, opened: StudyData, heights_m: Sequence[float] = HEIGHTS_M
) -> list[tuple[float, Choice | None, Choice | None]]:
    """Return, for each least height, the designs of least energy on a study's front and with more variables free."""
    return [(height, _choice(study, height), _choice(opened, height)) for height in heights_m]


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


def headline(data: StudyData, chosen_trial: int) -> tuple[Competitor, ...]:
    """Return the paper's design, published and simulated, the front's of least energy that is as high, and that chosen.

    The front may have none as high, and the chosen one may be behind it, see ``default_pick``.
    """
    from pareto_monoped.jump.evaluate import Evaluator

    several = len(data.study.kits) > 1
    evaluations = Evaluator(data.case_kit, data.calibration)(CASE.design.as_array())
    simulated = Competitor(
        label=f"paper's Case {CASE.name}, simulated here" + (f" with {data.case_kit.label}" if several else ""),
        **{name: float(evaluations.of(name)[0]) for name in _COMPETED},
    )
    chosen = []
    with contextlib.suppress(SelectionError):
        wanted = MinHeight(height_m=simulated.height_m)
        chosen.append(("front: at least that height", pick(data.front(), wanted, data.study.objectives).trial))
    chosen.append(("exported", chosen_trial))
    jumps = data.sound.set_index("trial")
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


def better_than(rows: pd.DataFrame, trial: int, objectives: Objectives) -> list[int]:
    """Return the trials that dominate one of them: no worse in any objective, and better in one."""
    loss = objectives.minimised(rows[list(objectives.names)].to_numpy(dtype=np.float64))
    own = loss[np.flatnonzero(rows["trial"] == trial)[0]]
    found = (loss <= own).all(axis=1) & (loss < own).any(axis=1)
    return [int(number) for number in rows["trial"][found]]


DEAR = 1.5
"""From how many times the least battery energy stored for at least its height on a design is marked. Our own choice:
alternatives are worth a look at 2 percent, and what a search leaves unfound is a few percent; half as much again is
neither."""


def is_dear(rows: pd.DataFrame, studies: Sequence[StudyData]) -> NDArray[np.bool_]:
    """Return which designs take over ``DEAR`` times the least battery energy stored for their heights, shape (n,)."""
    sound = [data.sound for data in studies]
    height, energy = (np.concatenate([column(one, name) for one in sound]) for name in ("height_m", BATTERY))
    known = np.isfinite(height) & np.isfinite(energy)
    order = np.argsort(height[known])
    # From each height on, the least of all that jump higher.
    heights, least = height[known][order], np.minimum.accumulate(energy[known][order][::-1])[::-1]
    place = np.searchsorted(heights, column(rows, "height_m"))
    reached = place < len(heights)
    limits = np.full(len(rows), np.inf)
    limits[reached] = DEAR * least[place[reached]]
    return np.asarray(column(rows, BATTERY) > limits)


_WHOLE = 20_000
"""Trials of a study up to which all are read to mark a pick. Our own choice: that takes a second."""


def whole(data: StudyData, kept: StudyFront) -> StudyData | None:
    """Return a study with all its trials, read anew if only its front was; None if it has more than ``_WHOLE``."""
    if len(data.trials) == kept.count:
        return data
    return read_study(kept.db) if kept.count <= _WHOLE else None


def dear_words(data: StudyData | None, row: "pd.Series[Any]") -> str:
    """Return the sentence that marks a trial that takes much more from the battery than another; empty for others.

    Any trial may have the least, so all of ``data`` are looked at, but for those that failed their audit.
    """
    height_m, energy_j = float(row["height_m"]), float(row.get(BATTERY, math.nan))
    if data is None or not (math.isfinite(height_m) and math.isfinite(energy_j)):
        return ""
    sound = data.sound
    least_j = float(np.fmin.reduce(column(sound[sound["height_m"] >= height_m], BATTERY), initial=math.inf))
    if least_j <= 0.0 or energy_j <= DEAR * least_j:
        return ""
    return (
        f"dear at the battery: takes {energy_j:.2f} J from it, {energy_j / least_j:.1f} times the least that is stored "
        f"for this height, {least_j:.2f} J; --min-height {height_m - 0.0005:.3f} --least {BATTERY} picks that"
    )


def default_pick(data: StudyData, studies: Sequence[StudyData]) -> Pick:
    """Return the design to begin with: the knee, of three objectives the compromise, that is not dear at the battery.

    What is stored for a height is looked for in all ``studies``, such as those of one page, but for those in which
    variables of this one are opened.
    """
    studies = [one for one in studies if not is_opened(one.study, data.study)]
    objectives, rows = data.study.objectives, data.sound
    chooser = Knee() if len(objectives.names) == 2 else Compromise(values=(1.0,) * len(objectives.names))
    able, plain = ~is_dear(rows, studies), pick(rows, chooser, objectives)
    picked = pick(rows, chooser, objectives, able) if able.any() else plain
    if picked.trial == plain.trial:
        return plain
    named, _, why = picked.why.partition(": ")
    return replace(picked, why=f"{named}: of the designs below {DEAR:g} times the least battery energy, {why}")


Notify = Callable[[str], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Chosen:
    """A design of a study, and the front that it was chosen on."""

    data: StudyData  #: the study; of one whose kept front is enough, its other trials are not read
    picked: Pick
    rows: pd.DataFrame  #: the front of the designs that meet the conditions, and the chosen one, if it is behind


def numbered(selector: Selector | None) -> int | None:
    """Return the number of the trial that a selector names; None if it chooses in another way."""
    chooser = selector.chooser if isinstance(selector, Among) else selector
    return chooser.number if isinstance(chooser, Trial) else None


def choose_of(kept: StudyFront, selector: Selector, *, notify: Notify) -> Chosen:
    """Choose a design of a study whose front was read, see ``choose``; read all of it where that is not enough."""
    number = numbered(selector)
    enough = needs_front_only(selector, kept.study.objectives) and len(kept.rows) > 0
    if enough and (number is None or (kept.rows["trial"] == number).any()):
        return _chosen(front_alone(kept), selector, kept.study.objectives)
    return choose(read_study(kept.db), selector, notify=notify)


def choose(data: StudyData, selector: Selector, objectives: Objectives | None = None, *, notify: Notify) -> Chosen:
    """Choose a design of a study. A design without an audit gets one first; if it fails, the next best is chosen.

    Raises:
        SelectionError: there is no feasible design, none fits, or the selector does not suit the objectives.
    """
    goals = objectives or data.study.objectives
    if numbered(selector) is None:
        data = settled(data, lambda known: [_chosen(known, selector, goals).picked.trial], notify=notify)
    return _chosen(data, selector, goals)


def _chosen(data: StudyData, selector: Selector, objectives: Objectives) -> Chosen:
    rows = data.sound
    refuse_empty(rows, data)
    picked = pick(rows, selector, objectives)
    front = data.front(objectives=objectives, conditions=picked.conditions)
    if not (front["trial"] == picked.trial).any():
        front = pd.concat([front, rows[rows["trial"] == picked.trial]], ignore_index=True)
    return Chosen(data=data, picked=picked, rows=front)


def settled_front(db: StudyPlace, conditions: Sequence[Condition | MaxEnergy], *, notify: Notify) -> pd.DataFrame:
    """Return the front of the designs of a study that meet conditions, all of them audited; refuse an empty one."""
    data = read_study(db)
    objectives = data.study.objectives
    wanted = [condition_on(one, objectives) for one in conditions]
    refuse_empty(data.sound, data)
    required_fits(data.sound, wanted, objectives)
    data = settled(data, lambda known: known.front(conditions=wanted)["trial"].tolist(), notify=notify)
    required_fits(data.sound, wanted, objectives)
    return data.front(conditions=wanted)


def settled(data: StudyData, wanted: Callable[[StudyData], list[int]], *, notify: Notify) -> StudyData:
    """Return a study with audits of all trials that are ``wanted`` of it; those that fail make others wanted.

    The audits are stored. A study that has not ended is left as it is, because its audit comes at its end. Where an
    audit cannot be made or stored, ``notify`` says so.
    """
    if not (data.meta.finished and data.study.audit):
        return data
    while fresh := sorted(set(wanted(data)) - set(data.audits["trial"])):
        try:
            data = _audited(data, fresh)
        except ParetoMonopedError as error:
            notify(f"not audited: {', '.join(f'trial {trial}' for trial in fresh)} ({error})")
            break
    return data


def _audited(data: StudyData, trials: list[int]) -> StudyData:
    # Imported here: most picks simulate nothing.
    from pareto_monoped.analysis.robustness import refuse_other_jumps
    from pareto_monoped.compute.chunks import cores
    from pareto_monoped.storage.store import Store
    from pareto_monoped.study.audits import audit_trials
    from pareto_monoped.study.simulator import stored_simulator

    with storage_of(data.db).locked():
        # Somebody may have asked for the same since the study was read.
        now = read_study(data.db)
        rows = now.trials[now.trials["trial"].isin(set(trials) - set(now.audits["trial"]))]
        if len(rows):
            simulator = stored_simulator(now, workers=cores())
            refuse_other_jumps(now, rows, simulator.evaluator)
            with Store(now.db, now.study) as store:
                audit_trials(now, rows, store, simulator)
            now = read_study(data.db)
    return replace(data, audits=now.audits)
