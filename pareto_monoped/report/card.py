"""One study -> its part of the page: pure functions of the stored study and of what was simulated again for it."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from pareto_monoped.actuator.ratiomap import JointMaps
from pareto_monoped.analysis.at_bounds import bound_lines
from pareto_monoped.analysis.choices import default_pick
from pareto_monoped.analysis.sensitivity import importances
from pareto_monoped.definition.algorithms import WeightedSettings
from pareto_monoped.definition.study import is_opened, opened_words
from pareto_monoped.definition.variables import MOTOR_KEYS, Bounds
from pareto_monoped.design import HEADLINE_HEIGHT_M, NAMES, PAPER_CASES, Variable, designs_of
from pareto_monoped.errors import SelectionError
from pareto_monoped.jump.end_stops import end_stops
from pareto_monoped.jump.gravity import least_of_all_j
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.leg.shank import foot_part
from pareto_monoped.pareto.pick import pick
from pareto_monoped.pareto.selectors import Knee, MinHeight, Selector, Trial
from pareto_monoped.report.comparison import group_of
from pareto_monoped.report.motors import gearbox_numbers
from pareto_monoped.report.packing import column
from pareto_monoped.report.packing import packed as packed_jumps
from pareto_monoped.report.quantities import LEADING
from pareto_monoped.report.resimulation import MOST_FRAMES, Resimulation, jumps_of, of_trials
from pareto_monoped.report.robust import alternatives_of, best_of, influences_of, robust_of
from pareto_monoped.report.schema import Model3D, Picked, StudyCard
from pareto_monoped.report.summary import command, notes, provenance, sentences
from pareto_monoped.report.trials import LETTERS, audit_records, history_columns, thinned, trial_columns
from pareto_monoped.robot.population import robot_arrays
from pareto_monoped.search.weighted import weighted_cost
from pareto_monoped.storage.extra_rows import Stored, StoredLimit, StoredSensitivity
from pareto_monoped.storage.reader import StudyData
from pareto_monoped.uncertainty.sensitivity import About

if TYPE_CHECKING:
    from pareto_monoped.jump.frames import Recording

DEFAULT = "default"
"""Name of the design that the page opens on, where that is not the knee."""
HEADLINES_M = (0.7, HEADLINE_HEIGHT_M, 0.9)
"""Heights at which designs are pointed out and studies compared: that of the paper's Case C and 0.1 m around it."""


FLOOR_HEIGHTS_M = (*np.round(np.arange(0.36, 2.0, 0.01), 2).tolist(), 2.5, 3.0, 4.0, 5.0, 7.0, 10.0)
"""Heights at which the floor of a front is computed. So near each other, straight lines between lie at most 10 mJ above
it, and 0.1 J in the centimetre in which it leaves zero. From where no leg touches the ground, they lie below."""
_AT_ONCE = 20_000  #: designs that are weighed together for it: 80 MB


@dataclass(frozen=True, slots=True, kw_only=True)
class MapPlace:
    """Where the page has the stage 1 map of a motor: number of the map, and of its first gearbox."""

    number: int
    first_gearbox: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Places:
    """Where the page has what the designs of a study are built from."""

    maps: Mapping[str, MapPlace]  #: name of a motor -> its stage 1 map
    kits: Mapping[str, int]  #: label of a kit of motors -> number of the kit


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """A stored study, what was simulated again for it, its exported models, robustness, sensitivities and limits."""

    data: StudyData
    resimulation: Resimulation
    models: Mapping[int, Model3D]
    robustness: Mapping[int, Stored] = field(default_factory=dict)
    sensitivities: Mapping[tuple[int, About], StoredSensitivity] = field(default_factory=dict)
    limits: Mapping[int, StoredLimit] = field(default_factory=dict)


def study_card(
    source: Source,
    label: str,
    most_rows: int,
    places: Places,
    variables: Sequence[Variable],
    goals: Sequence[str] = (),
    studies: Sequence[StudyData] = (),
) -> StudyCard:
    """Return what the page says of a study with at most ``most_rows`` trials.

    ``goals`` are the objectives of all ``studies`` on the page.
    """
    data, study, again = source.data, source.data.study, source.resimulation
    front = data.front()
    weights = best_of_weights(data)
    told = [*front["trial"], *data.ill_conditioned, *(trial for _, trial in weights), *source.robustness]
    told += [*(trial for trial, _ in source.sensitivities), *source.limits]
    always = np.isin(data.trials["trial"], told)
    trials = thinned(data.trials, always, most_rows)
    row_of = {int(trial): row for row, trial in enumerate(trials["trial"])}
    state = data.trials["state"]
    foot_kg, foot_radius_m = _foot(data)
    cases = pd.DataFrame([case.design.as_array() for case in PAPER_CASES.values()], columns=list(NAMES))
    several = len(study.kits) > 1
    bases = [one.study for one in studies if is_opened(study, one.study)]
    freed = [f"More free than in {bases[0].name}: {opened_words(study, bases[0])}."] if bases else []
    picks, masses_kg = _picks(data, studies or (data,), front, row_of), _body_masses_kg(data, front)
    failed = data.trials.loc[state == "failed", "status"].value_counts()
    chosen: dict[str, Sequence[int]] = dict(_gearboxes(trials, data.kit_rows(trials), places.maps))
    if several:
        chosen["motor"] = [places.kits[name] for name in trials["motor"]]
    return StudyCard(
        label=label,
        name=study.name,
        description=study.description,
        database=str(data.db),
        motor=", ".join(kit.label for kit in data.kits) if study.motor is not None else study.motor_text,
        case_motor=data.case_kit.label,
        motor_names={str(places.kits[kit.label]): given for kit, given in zip(data.kits, study.kits, strict=True)},
        calibration=data.meta.calibration,
        calibration_name=study.calibration,
        kit=places.kits[data.case_kit.label],
        algorithm=study.algorithm.name,
        seed=study.seed,
        objectives=study.objectives.names,
        group=group_of(data),
        wider=[place for place, one in enumerate(studies) if is_opened(one.study, study)],
        state="finished" if data.meta.finished else "unfinished",
        budget=data.meta.budget,
        seconds=data.wall_time_s,
        counts={name: int((state == name).sum()) for name in LETTERS} | {"total": len(data.trials)},
        reasons={str(status): int(count) for status, count in failed.items()},
        hypervolume=float(data.history["hypervolume"].iloc[-1]) if len(data.history) else 0.0,
        hypervolume_unit=study.objectives.volume_unit,
        reference=data.reference_point.text(),
        bounds={
            name: list(data.coordinates.limits(name)) if isinstance(value, Bounds) else [value, value]
            for name, value in study.variables.items()
        },
        at_bounds=list(bound_lines(data, front).values()),
        summary=[*sentences(data, front, again.cases), *freed],
        notes=notes(data, again),
        trials=trial_columns(trials, chosen, len(data.trials), variables, goals),
        front=[row_of[int(trial)] for trial in front["trial"]],
        ill_conditioned=[row_of[trial] for trial in sorted(data.ill_conditioned.tolist())],
        picks=picks,
        more={f"{body}_kg": column(masses_kg[:, i]) for i, body in enumerate(("base", "thigh", "shank"))},
        audits=audit_records(data.audits),
        jumps=packed_jumps(_with_those_pointed_out(data, again, picks, trials), again.frames),
        case_jumps=packed_jumps(again.case_jumps, MOST_FRAMES),
        stops_rad={str(places.kits[kit.label]): _stops_rad(data, kit) for kit in data.kits},
        models={str(trial): model for trial, model in source.models.items()},
        cases=again.cases,
        case_gearboxes=_gearboxes(cases, [(data.case_kit, np.arange(len(cases)))], places.maps, suffix=""),
        history=history_columns(data.history),
        weighted=[[weight, row_of[trial]] for weight, trial in weights],
        floor_j=_floor_j(data),
        foot_mass_kg=foot_kg,
        foot_radius_m=foot_radius_m,
        provenance=provenance(data),
        reproduce=command(data),
        importances=importances(data, tuple(dict.fromkeys((*goals, *LEADING)))),
        robust=robust_of(data, source.robustness, row_of),
        sensitivity=influences_of(source.sensitivities),
        best=best_of(data, source.limits, row_of),
    )


def _gearboxes(
    designs: pd.DataFrame,
    kit_rows: Iterable[tuple[JointMaps, NDArray[np.intp]]],
    maps: Mapping[str, MapPlace],
    suffix: str = "_gearbox",
) -> dict[str, list[int]]:
    """Return the numbers of designs' gearboxes by joint; ``kit_rows`` has the positions of each kit's designs."""
    found = {joint: np.full(len(designs), -1) for joint in ("hip", "knee")}
    for kit, rows in kit_rows:
        for joint, numbers in found.items():
            actuator_map = kit.of(joint)
            first = maps[actuator_map.motor.name].first_gearbox
            ratios = designs[f"{joint}_ratio"].to_numpy(dtype=float)[rows]
            numbers[rows] = gearbox_numbers(actuator_map, ratios, first)
    return {f"{joint}{suffix}": numbers.tolist() for joint, numbers in found.items()}


def _body_masses_kg(data: StudyData, designs: pd.DataFrame) -> NDArray[np.float64]:
    """Return the masses of base, thigh and shank of n simulated designs, shape (n, 3)."""
    masses = np.zeros((len(designs), 3))
    for kit, rows in data.kit_rows(designs):
        values = designs_of(designs.iloc[rows])
        masses[rows] = robot_arrays(values, kit, data.calibration.mass).body_mass_kg
    return masses


def _floor_j(data: StudyData) -> list[float]:
    """Return the least energy of every design that jumped, at ``FLOOR_HEIGHTS_M``, rounded down."""
    needed = data.trials[[name for name in (*data.study.names, *MOTOR_KEYS) if name in data.trials]]
    jumped = data.trials["height_m"].notna().to_numpy()
    least = np.full(len(FLOOR_HEIGHTS_M), np.inf)
    for kit, rows in data.kit_rows(needed):
        rows = rows[jumped[rows]]
        for some in np.array_split(rows, len(rows) // _AT_ONCE + 1):
            designs = designs_of(needed.iloc[some])
            robots = robot_arrays(designs, kit, data.calibration.mass)
            least = least_of_all_j(robots, data.calibration, np.array(FLOOR_HEIGHTS_M), least)
    return (np.floor(1e4 * least) / 1e4).tolist() if np.isfinite(least).all() else []


def _with_those_pointed_out(
    data: StudyData, again: Resimulation, picks: Sequence[Picked], trials: pd.DataFrame
) -> "dict[int, Recording]":
    """Return the jumps of the front, if it has any, and of picks and alternatives, most of which are just behind it."""
    jumps = dict(again.jumps)
    if not jumps:
        return jumps
    rows = trials.iloc[sorted({other.row for one in picks for other in one.alternatives} | {one.row for one in picks})]
    rows = rows[~rows["trial"].isin(list(jumps))]
    for kit, places in data.kit_rows(rows):
        members = rows.iloc[places]
        made = jumps_of(designs_of(members), kit, data.calibration, again.frames)
        jumps |= of_trials(members, made)
    return jumps


def _stops_rad(data: StudyData, kit: JointMaps) -> list[list[float | None]]:
    """Return the ends of hip's and knee's ranges with a kit, whatever the design; None where there is no stop."""
    robot = robot_arrays(PAPER_CASES["nominal"].design.as_array()[None], kit, data.calibration.mass)
    stops = end_stops(robot, data.calibration.joints)
    return [[None, None] if stop is None else [stop.lower_rad, stop.upper_rad] for stop in stops]


def _foot(data: StudyData) -> tuple[float, float]:
    """Return mass in kg, which the shank's includes, and radius in m of the simulated foot; no motor changes it."""
    given, leg = data.calibration.mass, leg_dimensions(data.case_kit)
    mass_kg = float(foot_part(0.0, leg).mass_kg()) if given.foot_mass_kg is None else given.foot_mass_kg
    radius_m = 1e-3 * leg.foot_radius_mm if given.foot_radius_m is None else given.foot_radius_m
    return mass_kg, radius_m


def _picks(
    data: StudyData, studies: Sequence[StudyData], front: pd.DataFrame, row_of: Mapping[int, int]
) -> list[Picked]:
    """Return the design to begin with, the knee, and, if height is an objective, the best at the headline heights."""
    objectives = data.study.objectives
    heights = HEADLINES_M if "height_m" in objectives.names else ()
    if len(front) == 0:
        return []
    first, knee = default_pick(data, studies), pick(front, Knee(), objectives)
    named: list[tuple[str, Selector]] = [] if first.trial == knee.trial else [(DEFAULT, Trial(number=first.trial))]
    named.append(("knee", Knee()))
    named += [(f"{height:g} m", MinHeight(height_m=height)) for height in heights]
    found: list[Picked] = []
    for name, selector in named:
        try:
            picked = first if name == DEFAULT else pick(front, selector, objectives)
        except SelectionError:
            continue
        if row_of[picked.trial] not in [p.row for p in found]:
            others = alternatives_of(data, picked.trial, row_of)
            found.append(Picked(name=name, row=row_of[picked.trial], why=picked.why, alternatives=others))
    return found


def best_of_weights(data: StudyData) -> list[tuple[float, int]]:
    """Return each run of a weighted search: the weight of the first objective, and the trial of least cost."""
    settings = data.study.algorithm
    if not isinstance(settings, WeightedSettings):
        return []
    rows = data.trials[(data.trials["state"] == "feasible") & data.trials["height_weight"].notna()]
    best = []
    for weight, run in rows.groupby("height_weight"):
        share = float(weight)
        values = run[list(data.study.objectives.names)].to_numpy(dtype=np.float64)
        cost = weighted_cost(values, share, data.reference_point, settings.height_scale_j)
        best.append((share, int(run["trial"].iloc[int(np.argmin(cost))])))
    return best
