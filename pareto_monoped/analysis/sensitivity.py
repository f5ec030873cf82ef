"""Which variable of a trial and which assumption about the built robot moves its measures most, and by how much."""

from collections.abc import Sequence
from concurrent.futures import Executor

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from pareto_monoped.analysis.robustness import refuse_other_jumps
from pareto_monoped.compute.chunks import cores
from pareto_monoped.definition.variables import Bounds
from pareto_monoped.design import ALL_NAMES, KNOTS, RATIOS, VARIABLES, Variable, designs_of
from pareto_monoped.errors import InputError, SelectionError, complaint
from pareto_monoped.jump.evaluate import Evaluations, Evaluator
from pareto_monoped.measures import ENERGIES, measure, nominal
from pareto_monoped.search.space import gear_list
from pareto_monoped.storage.extra_rows import SENSITIVITY, key_of, read_sensitivity
from pareto_monoped.storage.meta import strict_json
from pareto_monoped.storage.place import StudyPlace, storage_of
from pareto_monoped.storage.reader import StudyData, read_study
from pareto_monoped.storage.store import Store
from pareto_monoped.study.simulator import stored_simulator
from pareto_monoped.uncertainty.samples import Floats, samples_at, variations
from pareto_monoped.uncertainty.sensitivity import (
    DEFAULT_BLOCKS,
    About,
    Factor,
    Sensitivity,
    Simulate,
    between,
    factors_of,
    indices,
    sensitivity_of,
)
from pareto_monoped.uncertainty.settings import DEFAULT_SEED, Uncertainty

WITHIN = 0.02
"""How far a variable moves to either side, as a share of its range. Our own choice: 2 percent is 4 mm of a link, as far
apart as two designs may be that nobody would call different robots."""
_ALWAYS = ("height_m", *ENERGIES)
FEWEST_RATED, MOST_RATED = 50, 4000
"""Trials that importances rest on; of more, as many are spread evenly. Our own choice: the best tenth are five, and it
takes a second."""


def importances(data: StudyData, names: Sequence[str]) -> dict[str, dict[str, float]]:
    """Return each measure -> variable -> its importance over the whole study; the importances of a measure sum to 1.

    It is what tells the best tenth of all trials that jumped from the others (PED-ANOVA, Watanabe et al. 2023), as
    Optuna's dashboard shows it: f-ANOVA, its other choice, takes minutes for 8,000 trials.
    """
    import warnings

    import optuna

    jumped = np.flatnonzero(data.trials["status"] == "ok")
    if len(jumped) < FEWEST_RATED:
        return {}
    trials = data.trials.iloc[jumped[np.unique(np.linspace(0, len(jumped) - 1, MOST_RATED).astype(np.intp))]]
    free = [name for name in data.study.free if trials[name].nunique() > 1]
    chosen = [name for name in data.study.motor_choices if trials[name].nunique() > 1]
    if not free and not chosen:
        return {}
    distributions: dict[str, optuna.distributions.BaseDistribution] = {
        name: optuna.distributions.FloatDistribution(float(trials[name].min()), float(trials[name].max()))
        for name in free
    } | {name: optuna.distributions.CategoricalDistribution(sorted(set(trials[name]))) for name in chosen}
    rated = [name for name in names if name in trials and trials[name].notna().all() and trials[name].nunique() > 1]
    # Less is better to Optuna.
    signs = {name: -1.0 if measure(name).direction == "maximise" else 1.0 for name in rated}
    values = {name: (trials[name] * sign).to_numpy() for name, sign in signs.items()}
    rows = trials[[*free, *chosen]].to_dict(orient="records")
    verbosity = optuna.logging.get_verbosity()
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that it is experimental, and that less is better
        study = optuna.create_study(storage=optuna.storages.InMemoryStorage())
        study.add_trials(optuna.trial.create_trial(params=row, distributions=distributions, value=0.0) for row in rows)
        optuna.logging.set_verbosity(verbosity)
        evaluator = optuna.importance.PedAnovaImportanceEvaluator()
        found: dict[str, dict[str, float]] = {}
        for name in rated:

            def value(trial: optuna.trial.FrozenTrial, name: str = name) -> float:
                return float(values[name][trial.number])

            found[name] = optuna.importance.get_param_importances(study, evaluator=evaluator, target=value)
        return found


def sensitivity(
    db: StudyPlace,
    trial: int,
    ranges: Uncertainty,
    *,
    blocks: int = DEFAULT_BLOCKS,
    within: float = WITHIN,
    seed: int = DEFAULT_SEED,
    workers: int | None = None,
    executor: Executor | None = None,
) -> tuple[Sensitivity, Sensitivity]:
    """Return the sensitivity of a trial to its variables and to what is uncertain, and store what is new.

    Each of the ``blocks``, base samples whose number is a power of two, takes two more jumps than there are factors.
    Each free variable moves to either side by ``within``, a share of its range, and a gearbox by one place in the list,
    within the bounds of the study. The number of workers does not change the numbers.

    Raises:
        InputError: a number out of range, or too many jumps that fail.
        SelectionError: no such trial, or one without a jump.
        StudyError: this code or machine computes other jumps than the stored ones.
        DatabaseError: the study is damaged, or in use by another process.
    """
    if not 0.0 < within <= 0.5:
        raise InputError(complaint("within", within, "a share above 0 and at most 0.5", "correct it"))
    with storage_of(db).locked():
        data = read_study(db)
        row = data.trials[(data.trials["trial"] == trial) & (data.trials["status"] == "ok")]
        if len(row) == 0:
            raise SelectionError(f"trial = {trial}: must be a trial of the study that jumped; give another number")
        ranges = ranges.where(stand=data.calibration.stand is not None)
        plain = {"samples": blocks, "seed": seed}
        wanted: dict[About, dict[str, object]] = {
            "variables": {**plain, "within": within},
            "assumptions": {**plain, "uncertainty": ranges.as_dict()},
        }
        stored = read_sensitivity(db)
        found: dict[About, Sensitivity] = {}
        for about, settings in wanted.items():
            known = stored.get((trial, about))
            if known is not None and known.settings == settings:
                found[about] = known.result
                continue
            evaluator = stored_simulator(data, workers=workers or cores(), executor=executor).evaluator
            refuse_other_jumps(data, row, evaluator)
            names = tuple(dict.fromkeys((*_ALWAYS, *map(nominal, data.study.objectives.names))))
            names = tuple(name for name in names if name in data.trials)
            if about == "variables":
                factors, simulate = _of_variables(data, row, evaluator, names, within)
            else:
                factors, simulate = _of_assumptions(data, row, evaluator, names, ranges)
            result = sensitivity_of(about, factors, indices(simulate, len(factors), blocks, seed), names)
            found[about] = result
            texts = strict_json(settings), strict_json(result.as_dict())
            with Store(db, data.study) as store:
                store.set_rows(SENSITIVITY, [(key_of(trial, about), *texts)])
    return found["variables"], found["assumptions"]


def _of_assumptions(
    data: StudyData, row: pd.DataFrame, evaluator: Evaluator, names: Sequence[str], ranges: Uncertainty
) -> tuple[tuple[Factor, ...], Simulate]:
    """Return what is uncertain and does vary, and the function of the design's jumps as built."""
    every = factors_of(ranges)
    moving = [k for k, factor in enumerate(every) if factor.lower < factor.upper]

    def simulate(points: Floats) -> tuple[NDArray[np.bool_], Floats]:
        whole = np.full((len(points), len(every)), 0.5)
        whole[:, moving] = points
        design = np.repeat(designs_of(row), len(points), axis=0)
        built = variations(samples_at(ranges, whole), 1, data.calibration)
        return _measured(evaluator(design, np.repeat(data.kit_numbers(row), len(points)), variations=built), names)

    return tuple(every[k] for k in moving), simulate


def _of_variables(
    data: StudyData, row: pd.DataFrame, evaluator: Evaluator, names: Sequence[str], within: float
) -> tuple[tuple[Factor, ...], Simulate]:
    """Return the free variables around the design, and the function of the jumps of the designs there."""
    places = [_places(data, row, name, within) for name in data.study.free]

    def simulate(points: Floats) -> tuple[NDArray[np.bool_], Floats]:
        designs = np.repeat(designs_of(row), len(points), axis=0)
        for column, (factor, listed) in enumerate(places):
            values = points[:, column]
            if listed is None:
                moved = between(factor, values)
            else:
                moved = listed[np.minimum((values * len(listed)).astype(np.intp), len(listed) - 1)]
            designs[:, ALL_NAMES.index(factor.name)] = moved
        return _measured(evaluator(designs, np.repeat(data.kit_numbers(row), len(points))), names)

    return tuple(factor for factor, _ in places), simulate


def _places(data: StudyData, row: pd.DataFrame, name: str, within: float) -> tuple[Factor, Floats | None]:
    """Return a free variable as a factor; for a gearbox also the ratios that it goes through."""
    value, bounds = float(row[name].iloc[0]), data.study.variables[name]
    assert isinstance(bounds, Bounds)
    variable = (*VARIABLES, *KNOTS)[ALL_NAMES.index(name)]
    if name in RATIOS and data.study.gear_list:
        kit = data.kit_of_trial(int(row["trial"].iloc[0]))
        ratios = np.array([gear.ratio for gear in gear_list(kit.of(name.removesuffix("_ratio")), bounds)])
        place = int(np.abs(ratios - value).argmin())
        listed = ratios[max(place - 1, 0) : place + 2]
        return _factor(variable, float(listed[0]), float(listed[-1])), listed
    step = within * (bounds.upper - bounds.lower)
    return _factor(variable, max(value - step, bounds.lower), min(value + step, bounds.upper)), None


def _factor(variable: Variable, lower: float, upper: float) -> Factor:
    return Factor(name=variable.name, label=variable.factor, lower=lower, upper=upper, unit=variable.unit)


def _measured(jumps: Evaluations, names: Sequence[str]) -> tuple[NDArray[np.bool_], Floats]:
    values = np.column_stack([getattr(jumps, name) for name in names])
    return jumps.ok & np.isfinite(values).all(axis=1), values
