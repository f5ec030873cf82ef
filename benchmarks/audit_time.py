"""Processor time of a study's audits over that of its search, for Case C of the paper.

The verdicts come first. For every design on the fronts, screened or audited briefly, a study must have the verdict of a
full audit. So must the brief audit for random designs under the literal model with a finer step, which most but not all
of them fail, and the screen for random designs under the reference with other steps, gates and motors.

    python benchmarks/audit_time.py            # 1,000 and 2,000 jumps, 60 random designs per variant
    python benchmarks/audit_time.py --full     # the main job's 8,000 jumps, too, and 400 random designs per variant
"""

import argparse
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from unittest.mock import patch

import numpy as np

from pareto_monoped.actuator.search import map_for
from pareto_monoped.definition.algorithms import EvolutionSettings
from pareto_monoped.definition.study import Study, load_study
from pareto_monoped.design import LOWER, NAMES, UPPER, complete
from pareto_monoped.jump.audit import Jumps, audit, finer
from pareto_monoped.jump.calibration import Calibration, FadeGate, load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.screen import screened
from pareto_monoped.storage.reader import StudyData, read_study
from pareto_monoped.storage.store import Store
from pareto_monoped.study import run as runs
from pareto_monoped.study.audits import audit_front
from pareto_monoped.study.simulator import Simulator

STUDY = Path(__file__).parent.parent / "studies" / "case_c.toml"
BUDGETS = (1000, 2000)
RANDOM = 100
MOTORS = ("VT8020", "U8", "U12", "MN8014")
STEPS_MS = (0.5, 1.0, 2.0, 4.0)
FADES_MM = (0.3, 1.0, 10.0)


@contextmanager
def timed_audits() -> Iterator[list[float]]:
    """Processor times of the audits of all studies that run meanwhile."""
    spent: list[float] = []

    def timed(db: Path, store: Store, simulator: Simulator, notify: Callable[[str], None]) -> None:
        started = time.process_time()
        audit_front(db, store, simulator, notify)
        spent.append(time.process_time() - started)

    with patch.object(runs, "audit_front", timed):
        yield spent


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


def variants() -> Iterator[tuple[str, str, Calibration]]:
    """Name, motor and calibration of everything that the screen is compared with full audits under."""
    for motor in MOTORS:
        yield f"{motor}, reference", motor, load_calibration("reference")
    reference = load_calibration("reference-3")
    for step_ms in STEPS_MS:
        step_s = step_ms * 1e-3
        timed = replace(reference.simulation, timestep_s=step_s, control_period_s=max(step_s, 1e-3))
        for fade_mm in FADES_MM:
            gate = FadeGate(rule="fade", length_m=fade_mm * 1e-3)
            yield f"step {step_ms:g} ms, fade {fade_mm:g} mm", "VT8020", replace(reference, simulation=timed, gate=gate)


def screens_agree(count: int) -> None:
    """Print how many of ``count`` random designs are clear under each variant; all of these must pass full audits."""
    print(f"{'screen of random designs':28} {'jumps':>6} {'clear':>6} {'pass':>6} {'fail':>6}")
    for at, (label, motor, calibration) in enumerate(variants()):
        motor_map = map_for(motor)
        designs = complete(np.random.default_rng(100 + at).uniform(LOWER, UPPER, size=(count, len(LOWER))))
        found = Evaluator(motor_map, calibration, workers=2)(designs)
        known = Jumps(status=found.status, height_m=found.height_m, energy_j=found.energy_j)
        clear = screened(designs, motor_map, calibration, known, workers=2).clear
        good = audit(designs, motor_map, calibration, workers=2, known=known).well_conditioned
        assert not (clear & ~good).any(), f"{label}: the screen clears a design that a full audit does not"
        jumped = int(found.ok.sum())
        print(f"{label:28} {jumped:6d} {clear.sum():6d} {good.sum():6d} {jumped - good.sum():6d}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--full", action="store_true", help="8,000 jumps, too, and more random designs")
    full = parser.parse_args().full
    count, failed = agree_at_random()
    print(f"random designs, literal model with an eighth of its step: {count} equal verdicts, of which {failed} fail")
    screens_agree(400 if full else 60)
    base = load_study(STUDY)
    print(f"{'algorithm':10} {'jumps':>6} {'audited':>8} {'equal':>6} {'search s':>9} {'audits s':>9} {'ratio':>6}")
    with tempfile.TemporaryDirectory() as folder:
        runs.run(replace(base, evaluations=80, audit=True), Path(folder) / "warm.db")
        for algorithm in (base.algorithm, EvolutionSettings(name="nsga2")):
            for budget in (*BUDGETS, 8000) if full else BUDGETS:
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
