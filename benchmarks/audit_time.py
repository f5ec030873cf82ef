"""Processor time of a study's audits over that of its search, for Case C of the paper.

The verdicts come first: for every design on the fronts, and for random designs under the literal model with a finer
step, which most but not all of them fail, the brief audit of studies must give the verdict of a full one.

Run: python benchmarks/audit_time.py
"""

import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import LOWER, NAMES, UPPER, complete
from pareto_monoped.jump.audit import audit, finer
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.study import run as runs
from pareto_monoped.study.algorithm_settings import EvolutionSettings
from pareto_monoped.study.definition import Study, load_study
from pareto_monoped.study.reader import StudyData, read_study
from pareto_monoped.study.simulator import Simulator
from pareto_monoped.study.store import Store

STUDY = Path(__file__).parent.parent / "studies" / "case_c.toml"
BUDGETS = (1000, 2000)
RANDOM = 100


@contextmanager
def timed_audits() -> Iterator[list[float]]:
    """Processor times of the audits of all studies that run meanwhile."""
    original = runs.audit_front
    spent: list[float] = []

    def timed(db: Path, store: Store, simulator: Simulator, notify: Callable[[str], None]) -> None:
        started = time.process_time()
        original(db, store, simulator, notify)
        spent.append(time.process_time() - started)

    runs.audit_front = timed
    try:
        yield spent
    finally:
        runs.audit_front = original


def times(study: Study, folder: Path) -> tuple[StudyData, float, float]:
    """A run of the study: what it stored, and processor times of search and audits."""
    db = folder / f"{study.algorithm.name}_{study.evaluations}.db"
    with timed_audits() as spent:
        started = time.process_time()
        runs.run(study, db)
        everything = time.process_time() - started
    return read_study(db), everything - sum(spent), sum(spent)


def agree(data: StudyData) -> int:
    """Number of designs whose stored verdict is that of a full audit, which must be all."""
    motor_map, calibration = map_for("VT8020"), load_calibration("reference")
    rows = data.trials[data.trials["trial"].isin(data.audits["trial"])].sort_values("trial")
    stored = data.audits.sort_values("trial")["well_conditioned"].to_numpy(dtype=bool)
    full = audit(rows[list(NAMES)].to_numpy(), motor_map, calibration, workers=2)
    assert np.array_equal(full.well_conditioned, stored), "a brief audit has another verdict than a full one"
    return len(rows)


def agree_at_random() -> tuple[int, int]:
    """Number of random designs under the literal model, all with equal verdicts, and how many of them fail."""
    motor_map, calibration = map_for("VT8020", "paper"), finer(load_calibration("paper"), 8)
    designs = complete(np.random.default_rng(3).uniform(LOWER, UPPER, size=(RANDOM, len(LOWER))))
    full, brief = (audit(designs, motor_map, calibration, workers=2, brief=flag) for flag in (False, True))
    assert np.array_equal(full.well_conditioned, brief.well_conditioned), "verdicts of random designs differ"
    assert full.reason == brief.reason, "reasons of random designs differ"
    return len(designs), int((~full.well_conditioned).sum())


def main() -> None:
    count, failed = agree_at_random()
    print(f"random designs, literal model with an eighth of its step: {count} equal verdicts, of which {failed} fail")
    base = load_study(STUDY)
    print(f"{'algorithm':10} {'jumps':>6} {'audited':>8} {'equal':>6} {'search s':>9} {'audits s':>9} {'ratio':>6}")
    with tempfile.TemporaryDirectory() as folder:
        for algorithm in (base.algorithm, EvolutionSettings(name="nsga2")):
            for budget in BUDGETS:
                study = replace(base, evaluations=budget, algorithm=algorithm)
                data, search, spent = times(study, Path(folder))
                equal = agree(data)
                print(
                    f"{algorithm.name:10} {budget:6d} {len(data.audits):8d} {equal:6d} {search:9.2f} {spent:9.2f} "
                    f"{spent / search:6.2f}",
                    flush=True,
                )


if __name__ == "__main__":
    main()
