"""Simulate trials again under uncertainty and store the result; the front by what nineteen of twenty robots keep."""

import json
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import closing
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from pareto_monoped.compute.chunks import AT_ONCE, cores, in_turn
from pareto_monoped.definition.study import Study
from pareto_monoped.design import designs_of
from pareto_monoped.errors import InputError, SelectionError, StudyError, complaint
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.measures import MEASURES, STATISTICS
from pareto_monoped.pareto.pick import front_within
from pareto_monoped.storage.extra_rows import ROBUSTNESS, Stored, read_robustness
from pareto_monoped.storage.meta import strict_json
from pareto_monoped.storage.place import StudyPlace, storage_of
from pareto_monoped.storage.reader import StudyData, read_study
from pareto_monoped.storage.store import Store
from pareto_monoped.study.simulator import stored_simulator
from pareto_monoped.uncertainty.samples import DEFAULT_SAMPLES, Samples, sobol_samples, variations
from pareto_monoped.uncertainty.settings import DEFAULT_SEED, MOST_FAILED, Sampling, Uncertainty, load_uncertainty
from pareto_monoped.uncertainty.statistics import Robustness, robustness

LEAST_SAMPLES = 256
"""Fewest samples of a design that are stored: a 5th percentile then rests on 13 of them."""
_CHUNK = 4
"""Designs that are simulated and stored together; an interrupt loses at most these."""
_SHARED = 32
"""The same where an executor does the jumps; several such chunks are under way at a time."""


def robust(
    db: StudyPlace,
    uncertainty: Uncertainty,
    *,
    trials: Sequence[int] | None = None,
    samples: int = DEFAULT_SAMPLES,
    seed: int = DEFAULT_SEED,
    workers: int | None = None,
    executor: Executor | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> dict[int, Robustness]:
    """Simulate trials, by default the front, under uncertainty; store their robustness unless it is there already.

    All designs have the same samples, so that differences between them are of the designs. The same seed gives the same
    numbers, whatever the number of workers. ``samples`` is a power of two of at least ``LEAST_SAMPLES``. After each
    stored chunk, ``progress`` is called with the number of designs done and of all.

    Raises:
        InputError: too few samples, or ranges that the calibration cannot have.
        SelectionError: a trial that is not there or did not jump, or an empty front.
        StudyError: this code or machine computes other jumps than the stored ones.
        DatabaseError: the study is damaged, or in use by another process.
    """
    if samples < LEAST_SAMPLES:
        raise InputError(complaint("samples", samples, f"a power of two of at least {LEAST_SAMPLES}", "give more"))
    with storage_of(db).locked():
        data = read_study(db)
        uncertainty = uncertainty.where(stand=data.calibration.stand is not None)
        drawn = sobol_samples(uncertainty, samples, seed)
        rows = rows_of(data, trials)
        settings = {"uncertainty": uncertainty.as_dict(), "samples": samples, "seed": seed}
        known = {trial: stored.result for trial, stored in read_robustness(db).items() if stored.settings == settings}
        fresh = rows[~rows["trial"].isin(known)]
        done = len(rows) - len(fresh)
        if len(fresh):
            threads = workers or cores()
            evaluator = stored_simulator(data, workers=threads, executor=executor).evaluator
            step, at_once = (_CHUNK, 1) if executor is None else (_SHARED, AT_ONCE)
            chunks = [fresh.iloc[first : first + step] for first in range(0, len(fresh), step)]
            under_way = in_turn(lambda chunk: simulated(data, chunk, evaluator, drawn), chunks, at_once)
            with Store(db, data.study) as store, closing(under_way):
                for results in under_way:
                    text = strict_json(settings)
                    store.set_rows(
                        ROBUSTNESS, [(trial, text, strict_json(result.as_dict())) for trial, result in results.items()]
                    )
                    known |= results
                    done += len(results)
                    if progress is not None:
                        progress(done, len(rows))
    return {int(trial): known[int(trial)] for trial in rows["trial"]}


def simulated(data: StudyData, rows: pd.DataFrame, evaluator: Evaluator, samples: Samples) -> dict[int, Robustness]:
    """Return the robustness of some trials by number."""
    designs = designs_of(rows)
    motors = data.kit_numbers(rows)
    refuse_other_jumps(data, rows, evaluator)
    count = len(samples)
    jumps = evaluator(
        np.repeat(designs, count, axis=0),
        np.repeat(motors, count),
        variations=variations(samples, len(rows), data.calibration),
    )
    least = data.study.least_safeties
    return {
        int(trial): robustness(jumps, slice(k * count, (k + 1) * count), least) for k, trial in enumerate(rows["trial"])
    }


def refuse_other_jumps(data: StudyData, rows: pd.DataFrame, evaluator: Evaluator) -> None:
    """Refuse trials that do not jump as they are stored; name the first one."""
    height_m = evaluator(designs_of(rows), data.kit_numbers(rows)).height_m
    stored = rows["height_m"].to_numpy(dtype=np.float64)
    other = np.flatnonzero(height_m != stored)
    if len(other):
        k = other[0]
        raise StudyError(
            f"study database {str(data.db)!r}: trial {int(rows['trial'].iloc[k])} jumps {height_m[k]:.9g} m with this "
            f"code and machine, {stored[k]:.9g} m are stored; use the version that made the study, or run it anew"
        )


def rows_of(data: StudyData, trials: Sequence[int] | None, front: pd.DataFrame | None = None) -> pd.DataFrame:
    """Return the rows of some trials that jumped, each once; without any, those of a front, by default the study's.

    Raises:
        SelectionError: a trial that is not there or did not jump, or an empty front.
    """
    if trials is None:
        front = data.front() if front is None else front
        if len(front) == 0:
            raise SelectionError("front: has 0 designs, at least 1 is needed; run the study longer, or name trials")
        return front
    numbers = list(dict.fromkeys(trials))
    known = data.trials.set_index("trial", drop=False)
    for number in numbers:
        if number not in known.index or known.loc[number, "status"] != "ok":
            raise SelectionError(f"trial = {number}: must be a trial of the study that jumped; give another number")
    return known.loc[numbers].reset_index(drop=True)


_SIDES = {"maximise": "p05", "minimise": "p95", None: "mean"}
"""Which statistic stands for a measure, by its direction: of the two percentiles the worse one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RobustTrials:
    """Trials by what they keep under uncertainty."""

    #: As ``StudyData.trials``, of the trials that fail in at most ``MOST_FAILED`` of their jumps. A measure has its 5th
    #: percentile where it is to be maximised, its 95th where it is to be minimised, and else its mean. There are also
    #: columns of all statistics, such as "height_m.p05", ``failed_share`` and ``overloaded_share``.
    rows: pd.DataFrame
    fragile: int  #: how many trials fail more often
    settings: dict[str, object]  #: under which all of them were simulated
    others: int  #: how many trials were simulated under other settings, and are left out


def robust_trials(data: StudyData, stored: Mapping[int, Stored]) -> RobustTrials:
    """Return the trials whose robustness can be compared, simulated under the most common settings."""
    if not stored:
        raise SelectionError(f"study database {str(data.db)!r}: holds no robustness; simulate it with 'robust' first")
    texts = {trial: json.dumps(one.settings, sort_keys=True) for trial, one in stored.items()}
    usual = Counter(texts.values()).most_common(1)[0][0]
    alike = [trial for trial, text in texts.items() if text == usual]
    rows = data.trials[data.trials["trial"].isin(alike)].reset_index(drop=True)
    results = [stored[int(trial)].result for trial in rows["trial"]]
    columns = {
        "failed_share": np.array([result.failed for result in results]),
        "overloaded_share": np.array([result.overloaded for result in results]),
    }
    for entry in MEASURES:
        found = [result.measures.get(entry.name) for result in results]
        for side in STATISTICS:
            values = np.array([np.nan if one is None else getattr(one, side) for one in found])
            columns[f"{entry.name}.{side}"] = values
        columns[entry.name] = columns[f"{entry.name}.{_SIDES[entry.direction]}"]
    kept = columns["failed_share"] <= MOST_FAILED
    table = rows.drop(columns=[name for name in columns if name in rows])
    added = pd.DataFrame(columns, index=rows.index)
    return RobustTrials(
        rows=pd.concat([table, added], axis=1)[kept].reset_index(drop=True),
        fragile=int((~kept).sum()),
        settings=stored[alike[0]].settings,
        others=len(stored) - len(alike),
    )


def robust_front(data: StudyData, trials: RobustTrials) -> pd.DataFrame:
    """Return the trials that no other dominates under uncertainty, as ``StudyData.front``; refuse an empty front."""
    objectives, rows = data.study.objectives, trials.rows
    if len(rows) == 0:
        raise SelectionError(
            f"robust front: has 0 designs, because all {trials.fragile} fail in more than {100 * MOST_FAILED:g} "
            "percent of their jumps; simulate more trials with 'robust'"
        )
    able = (rows["state"] == "feasible").to_numpy() & ~rows["trial"].isin(data.ill_conditioned).to_numpy()
    if not able.any():
        raise SelectionError(
            f"robust front: has 0 designs, because none of the {len(rows)} is feasible and well-conditioned as "
            "designed; simulate others with 'robust'"
        )
    mask = front_within(rows, (), objectives, able)
    return rows[mask].sort_values(objectives.names[0], kind="stable", ignore_index=True)


def as_built(
    data: StudyData, stored: Mapping[int, Stored], *, notify: Callable[[str], object]
) -> tuple[StudyData, RobustTrials]:
    """Return a study whose trials are those of known robustness, with what they keep; refuse one without a front."""
    trials = robust_trials(data, stored)
    if trials.others:
        notify(f"left out: {trials.others} trials with other ranges, samples or seed")
    robust_front(data, trials)
    return replace(data, trials=trials.rows), trials


def sampling(
    study: Study, ranges: Uncertainty | None, samples: int | None, seed: int | None
) -> tuple[Uncertainty, int, int]:
    """Return ranges, number of samples and seed that are asked for; those left out are the study's, or the shipped."""
    own = study.uncertainty or Sampling(ranges=load_uncertainty())
    return (
        own.ranges if ranges is None else ranges,
        max(own.samples, DEFAULT_SAMPLES) if samples is None else samples,
        own.seed if seed is None else seed,
    )
