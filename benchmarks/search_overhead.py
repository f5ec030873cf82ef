"""What storing and resuming costs: a study's time against the bare simulation, and against Optuna's own loop.

    python benchmarks/search_overhead.py                      # the default algorithm, 4,000 jumps
    python benchmarks/search_overhead.py --full               # 8,000 jumps: what benchmarks/search_overhead.md shows
    python benchmarks/search_overhead.py --algorithm nsga2    # another algorithm

Bare simulation: only the evaluator, with the same designs, in the study's generations and in one batch. Optuna's loop:
``Study.optimize`` with its NSGA-II sampler on SQLite and one naive simulation per trial (XML, Python loop: the tests'
oracle), measured on fewer trials. No ratio is printed unless both sides compute the same. CPU times stand beside the
wall times for machines that have other work to do. The algorithm's own time is the processor time of its thread.
"""

import argparse
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
import optuna
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from pareto_monoped.compute.chunks import cores
from pareto_monoped.definition.algorithms import DEFAULT_ALGORITHM
from pareto_monoped.definition.study import Study
from pareto_monoped.definition.variables import Bounds
from pareto_monoped.design import NAMES, PAPER_NAMES
from pareto_monoped.jump.calibration import FadeGate
from pareto_monoped.jump.document import mjcf
from pareto_monoped.robot.population import robot_arrays
from pareto_monoped.search.algorithm import Algorithm, Proposal, Scores
from pareto_monoped.search.registry import make_algorithm
from pareto_monoped.search.space import Coordinates
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study import session
from pareto_monoped.study.run import run
from pareto_monoped.study.simulator import Simulator, load_simulator
from tests.jump.oracle import jump, motors_of


def timed(work: Callable[[], object]) -> tuple[float, float]:
    """Wall and CPU seconds that ``work`` takes."""
    began, cpu = time.perf_counter(), time.process_time()
    work()
    return time.perf_counter() - began, time.process_time() - cpu


def medians(times: list[tuple[float, float]]) -> tuple[float, float]:
    """Median wall and CPU seconds."""
    return statistics.median(wall for wall, _ in times), statistics.median(cpu for _, cpu in times)


def bare(simulator: Simulator, designs: NDArray[np.float64], ends: NDArray[np.intp]) -> NDArray[np.float64]:
    """Heights of the designs, simulated in batches; ``ends`` are the numbers of designs up to the end of each."""
    return np.concatenate([simulator.evaluator(part).height_m for part in np.split(designs, ends) if len(part)])


class Timed(Algorithm):
    """An algorithm that adds up the processor time of its thread."""

    def __init__(self, algorithm: Algorithm) -> None:
        self.seconds = 0.0
        self._algorithm = algorithm

    def ask(self) -> Proposal | None:
        """What the algorithm asks for."""
        began = time.thread_time()
        proposal = self._algorithm.ask()
        self.seconds += time.thread_time() - began
        return proposal

    def tell(self, scores: Scores) -> None:
        """Tell the algorithm."""
        began = time.thread_time()
        self._algorithm.tell(scores)
        self.seconds += time.thread_time() - began

    def state(self) -> dict[str, Any]:
        """The algorithm's state."""
        return self._algorithm.state()

    def restore(self, state: dict[str, Any], history: Iterable[tuple[NDArray[np.float64], Scores]]) -> None:
        """Let the algorithm continue."""
        self._algorithm.restore(state, history)


def timed_run(study: Study, db: Path, workers: int) -> tuple[float, float, float]:
    """Wall and CPU seconds of a run, and the seconds of its algorithm."""
    made: list[Timed] = []

    def make(study: Study, coordinates: Coordinates | None = None, own: Any = None) -> Algorithm:
        made.append(Timed(make_algorithm(study, coordinates, own)))
        return made[-1]

    with patch.object(session, "make_algorithm", make):
        wall, cpu = timed(partial(run, study, db, workers=workers))
    return wall, cpu, made[0].seconds


def optuna_loop(study: Study, simulator: Simulator, folder: Path, trials: int) -> list[optuna.trial.FrozenTrial]:
    """Optuna's own loop with a naive simulation."""
    gate = simulator.calibration.gate
    assert isinstance(gate, FadeGate)
    fade_m = gate.length_m

    def objective(trial: optuna.trial.Trial) -> tuple[float, float]:
        values = {
            n: trial.suggest_float(n, v.lower, v.upper) for n, v in study.variables.items() if isinstance(v, Bounds)
        }
        robots = robot_arrays(
            np.array([list(values.values())]), simulator.evaluator.actuator_map, simulator.calibration.mass
        )
        result = jump(
            mjcf(robots, simulator.calibration, 0),
            values["stiffness_n_per_m"],
            values["damping_n_s_per_m"],
            values["torsional_stiffness_n_m_per_rad"],
            motors_of(robots, 0, simulator.calibration),
            fade=fade_m,
            read_back=simulator.calibration.simulation.positions_read == "half_step_back",
        )
        return result.height, result.energy

    optuna.logging.set_verbosity(optuna.logging.WARNING)
    naive = optuna.create_study(
        storage=f"sqlite:///{folder}/optuna.db",
        directions=["maximize", "minimize"],
        sampler=optuna.samplers.NSGAIISampler(seed=1),
    )
    naive.optimize(objective, n_trials=trials)
    return naive.trials


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--full", action="store_true", help="8,000 jumps instead of 4,000")
    parser.add_argument("--algorithm", default=DEFAULT_ALGORITHM.name)
    parser.add_argument("--rounds", type=int, default=3, help="interleaved rounds; the medians are printed")
    parser.add_argument("--workers", type=int, default=cores())
    arguments = parser.parse_args()
    evaluations, searched = 8_000 if arguments.full else 4_000, arguments.algorithm
    study = Study.define(name="b", case="C", evaluations=evaluations, audit=False, algorithm=searched)
    simulator = load_simulator(study, workers=arguments.workers)
    simulator.probe()
    stored, own, generations, batch = [], [], [], []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        run(study, folder / "warm.db", evaluations=100, workers=arguments.workers)
        for k in range(arguments.rounds):
            db = folder / f"{k}.db"
            run_s, run_cpu_s, thought = timed_run(study, db, arguments.workers)
            stored.append((run_s, run_cpu_s))
            own.append(1000.0 * thought / evaluations)
            trials = read_study(db).trials
            designs = trials[list(NAMES)].to_numpy()
            ends = np.flatnonzero(np.diff(trials["generation"])) + 1
            generations.append(timed(partial(bare, simulator, designs, ends)))
            batch.append(timed(partial(bare, simulator, designs, ends[:0])))
        assert np.array_equal(bare(simulator, designs[:200], ends[:0]), trials["height_m"][:200], equal_nan=True)
        size = (folder / "0.db").stat().st_size
        few = 100
        loop_s, loop_cpu_s = timed(lambda: optuna_loop(study, simulator, folder, few))
        naive = optuna.load_study(study_name=None, storage=f"sqlite:///{folder}/optuna.db").trials
        ours = simulator.evaluator(np.array([[t.params[n] for n in PAPER_NAMES] for t in naive])).height_m
        theirs = np.array([t.values[0] if t.values else np.nan for t in naive])
        agree = np.isclose(ours, theirs, rtol=0.0, atol=1e-9).mean()
        assert agree >= 0.95, f"only {agree:.0%} of the naive loop's heights agree"
    (wall, cpu), (each_wall, each_cpu), (one_wall, one_cpu) = medians(stored), medians(generations), medians(batch)
    rate = evaluations / wall
    print(
        f"{evaluations:,} evaluations of Case C by {searched}, {arguments.workers} workers, {arguments.rounds} rounds:"
    )
    for label, seconds, busy in (
        ("study, stored and resumable", wall, cpu),
        (f"bare, in the same {len(ends) + 1} generations", each_wall, each_cpu),
        ("bare, in one batch", one_wall, one_cpu),
    ):
        print(f"{label:<32} {seconds:8.2f} s wall {busy:8.2f} s CPU {evaluations / seconds:8.0f} designs/s")
    print(f"{'the algorithm itself':<32} {statistics.median(own):8.3f} ms per design")
    print(f"{'study / bare in generations':<32} {wall / each_wall:8.3f} wall   {cpu / each_cpu:8.3f} CPU")
    print(f"{'study / bare in one batch':<32} {wall / one_wall:8.3f} wall   {cpu / one_cpu:8.3f} CPU")
    print(f"{'database':<32} {size / 1e6:8.1f} MB")
    print(
        f"{'loop of Optuna, naive':<32} {loop_s:8.2f} s wall {loop_cpu_s:8.2f} s CPU {few / loop_s:8.1f} designs/s "
        f"({few} trials, {agree:.0%} agree)"
    )
    times = (rate * loop_s / few, evaluations / cpu * loop_cpu_s / few)
    print(f"{'study faster than that loop':<32} {times[0]:8.1f} wall   {times[1]:8.1f} CPU")


if __name__ == "__main__":
    main()
