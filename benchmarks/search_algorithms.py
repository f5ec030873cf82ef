"""Search algorithms on the real problem (Case C, VT8020, ``reference``): share of the front against number of jumps.

    python benchmarks/search_algorithms.py                       # a short look: 1,000 jumps, 2 seeds, small reference
    python benchmarks/search_algorithms.py --full                # what benchmarks/search_algorithms.md shows
    python benchmarks/search_algorithms.py --full --evaluations 5000 --only nsga2-100 random

All seeds of one algorithm advance together, and their generations are simulated as one batch; the result of a jump
does not depend on its batch. Quality is the hypervolume of all designs evaluated so far, not of the last population,
as a share of the hypervolume of the reference front. Results are kept in build/search_algorithms.json; the table
shows everything in that file.
"""

import argparse
import json
import platform
import statistics
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.pareto.front import front_mask
from pareto_monoped.pareto.indicators import epsilon, hypervolume, igd_plus, reference_point
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY
from pareto_monoped.study.algorithms import make_algorithm
from pareto_monoped.study.definition import Study, study_from_dict
from pareto_monoped.study.protocol import Algorithm
from pareto_monoped.study.run import default_workers
from pareto_monoped.study.scoring import judge, scores
from pareto_monoped.study.simulator import Evaluate, load_simulator

HERE = Path(__file__).parent
MARKS = (1_000, 2_000, 5_000, 10_000)
REFERENCE_POINT = reference_point(HEIGHT_AND_ENERGY)
# Ten weights of the paper's cost, chosen so that the runs end at points along the whole front.
WEIGHTS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95)

CONTENDERS: dict[str, dict[str, Any]] = {
    "nsga2-20": {"name": "nsga2", "population": 20},
    "nsga2-40": {"name": "nsga2", "population": 40},
    "nsga2-100": {"name": "nsga2", "population": 100},
    "nsga2-200": {"name": "nsga2", "population": 200},
    "nsga2-40, eta 5/10": {"name": "nsga2", "population": 40, "crossover_eta": 5.0, "mutation_eta": 10.0},
    "sms_emoa-40": {"name": "sms_emoa", "population": 40},
    "sms_emoa-100": {"name": "sms_emoa", "population": 100},
    "age_moea2-40": {"name": "age_moea2", "population": 40},
    "age_moea2-100": {"name": "age_moea2", "population": 100},
    "optuna_nsga2-50": {"name": "optuna_nsga2"},
    "optuna_tpe-8": {"name": "optuna_tpe"},
    "random": {"name": "random"},
    "weighted_cmaes, 10 weights": {"name": "weighted_cmaes", "height_weights": WEIGHTS},
}
# TPE takes longer than the jumps, and its time per trial grows with the number of trials.
TPE_EVALUATIONS = 2_000


def study(settings: dict[str, Any], seed: int, evaluations: int) -> Study:
    """Case C with these algorithm settings; the runs of a sweep over weights share the evaluations evenly."""
    if settings["name"] == "weighted_cmaes":
        settings = settings | {"iterations": max(1, evaluations // (8 * len(settings["height_weights"])))}
    values = {"name": "b", "case": "C", "evaluations": evaluations, "seed": seed, "algorithm": settings}
    return study_from_dict(values, source="benchmark")


class Archive:
    """The front of all designs that one search has evaluated, and its hypervolume at each mark."""

    def __init__(self, marks: tuple[int, ...]) -> None:
        self.front = np.zeros((0, 2))
        self.evaluations = 0
        self.volumes: dict[int, float] = {}
        self._marks = marks

    def add(self, points: NDArray[np.float64], feasible: NDArray[np.bool_]) -> None:
        """Add n evaluated designs, in order; ``points`` has shape (n, 2): height and energy."""
        for mark in self._marks:
            if self.evaluations < mark <= self.evaluations + len(points):
                part = mark - self.evaluations
                self.volumes[mark] = hypervolume(self._joined(points[:part][feasible[:part]]), REFERENCE_POINT)
        self.front = self._joined(points[feasible])
        self.evaluations += len(points)

    def _joined(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        every = np.vstack((self.front, points))
        return every[front_mask(every, HEIGHT_AND_ENERGY)]


def search(
    evaluate: Evaluate, settings: dict[str, Any], seeds: list[int], evaluations: int, marks: tuple[int, ...]
) -> tuple[list[Archive], float]:
    """One search per seed, all advancing together; their archives, and the seconds of the algorithm per 1,000 jumps."""
    studies = [study(settings, seed, evaluations) for seed in seeds]
    running: list[tuple[Algorithm, Archive, Study]] = [(make_algorithm(s), Archive(marks), s) for s in studies]
    archives = [archive for _, archive, _ in running]
    thinking = 0.0
    while running:
        began = time.perf_counter()
        asked = [(run, run[0].ask()) for run in running if run[1].evaluations < evaluations]
        thinking += time.perf_counter() - began
        alive = [(run, proposal) for run, proposal in asked if proposal is not None]
        if not alive:
            break
        result = evaluate(np.vstack([proposal.values for _, proposal in alive]))
        judgement = judge(result, alive[0][0][2].constraints)
        all_scores = scores(result, judgement)
        points = np.column_stack((result.height_m, result.energy_j))
        first = 0
        for (algorithm, archive, _), proposal in alive:
            rows = slice(first, first + len(proposal.values))
            first = rows.stop
            began = time.perf_counter()
            algorithm.tell(all_scores.of(rows))
            thinking += time.perf_counter() - began
            archive.add(points[rows], judgement.state[rows] == "feasible")
        running = [run for run, _ in alive]
    total = sum(archive.evaluations for archive in archives)
    return archives, 1000.0 * thinking / total


def reference(evaluate: Evaluate, evaluations: int) -> dict[str, Any]:
    """The front of many evaluations: half by NSGA-II with a population of 200, half by SMS-EMOA with 100."""
    fronts = []
    for settings in ({"name": "nsga2", "population": 200}, {"name": "sms_emoa", "population": 100}):
        # At least 5,000 jumps per search; with fewer, the reference is no better than the searches it measures.
        seeds = list(range(101, 101 + max(1, min(4, evaluations // 10_000))))
        archives, _ = search(evaluate, settings, seeds, evaluations // (2 * len(seeds)), ())
        fronts += [archive.front for archive in archives]
        print(f"reference: {settings['name']} done", file=sys.stderr, flush=True)
    points = np.vstack(fronts)
    front = points[front_mask(points, HEIGHT_AND_ENERGY)]
    return {"evaluations": evaluations, "front": front.tolist(), "hypervolume": hypervolume(front, REFERENCE_POINT)}


def contend(evaluate: Evaluate, name: str, seeds: list[int], evaluations: int, best: dict[str, Any]) -> dict[str, Any]:
    """The results of one contender: one row of the table."""
    settings = CONTENDERS[name]
    budget = min(evaluations, TPE_EVALUATIONS) if settings["name"] == "optuna_tpe" else evaluations
    marks = tuple(mark for mark in MARKS if mark <= budget)
    archives, thinking = search(evaluate, settings, seeds, budget, marks)
    front = np.array(best["front"])
    shares = {str(m): [a.volumes[m] / best["hypervolume"] for a in archives if m in a.volumes] for m in marks}
    if settings["name"] == "weighted_cmaes":
        # Its runs follow one another, so only the end is a fair mark; runs that converge early end the sweep early.
        shares = {str(budget): [hypervolume(a.front, REFERENCE_POINT) / best["hypervolume"] for a in archives]}
    return {
        "evaluations": budget,
        "shares": shares,
        "epsilon": [epsilon(archive.front, front) for archive in archives],
        "igd_plus": [igd_plus(archive.front, front) for archive in archives],
        "thinking_s_per_1000": thinking,
    }


def table(results: dict[str, Any]) -> str:
    """The table in Markdown."""

    def cell(values: list[float] | None, scale: float = 100.0) -> str:
        if not values:
            return ""
        low, middle, high = min(values) * scale, statistics.median(values) * scale, max(values) * scale
        return f"{middle:.2f} ({low:.2f} to {high:.2f})"

    lines = [
        "| algorithm, population | "
        + " | ".join(f"{mark:,}" for mark in MARKS)
        + " | epsilon % | IGD+ % | s / 1,000 |",
        "|---|" + "---|" * (len(MARKS) + 3),
    ]
    rows = sorted(
        results["rows"].items(), key=lambda item: -max(statistics.median(v) for v in item[1]["shares"].values())
    )
    for name, row in rows:
        cells = [cell(row["shares"].get(str(mark))) for mark in MARKS]
        extra = [cell(row["epsilon"]), cell(row["igd_plus"]), f"{row['thinking_s_per_1000']:.2f}"]
        lines.append(f"| {name} | " + " | ".join(cells + extra) + " |")
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--full", action="store_true", help="10,000 jumps, 5 seeds, reference of 200,000; keep results")
    parser.add_argument("--only", nargs="+", choices=CONTENDERS, help="run only these contenders")
    parser.add_argument("--evaluations", type=int, help="jumps per search, instead of 1,000 or 10,000")
    arguments = parser.parse_args()
    evaluations, seeds, effort = (10_000, [1, 2, 3, 4, 5], 200_000) if arguments.full else (1_000, [1, 2], 10_000)
    evaluations = arguments.evaluations or evaluations
    simulator = load_simulator(study({"name": "random"}, 1, 1), workers=default_workers())
    kept = HERE.parent / "build" / "search_algorithms.json"
    kept.parent.mkdir(exist_ok=True)
    results: dict[str, Any] = {"rows": {}}
    if arguments.full and kept.exists():
        results = json.loads(kept.read_text())
    # Results that were kept are of no use once the simulator has changed.
    if results.get("probe") != simulator.probe():
        results = {"probe": simulator.probe(), "machine": platform.machine(), "rows": {}}
    if "reference" not in results:
        results["reference"] = reference(simulator.evaluator, effort)
    default = ("nsga2-40", "random", "weighted_cmaes, 10 weights")
    for name in arguments.only or (CONTENDERS if arguments.full else default):
        results["rows"][name] = contend(simulator.evaluator, name, seeds, evaluations, results["reference"])
        print(f"{name} done", file=sys.stderr, flush=True)
        if arguments.full:
            kept.write_text(json.dumps(results, indent=1) + "\n")
    best = results["reference"]
    print(
        f"Reference front: {len(best['front'])} designs of {best['evaluations']:,} evaluations, "
        f"hypervolume {best['hypervolume']:.4f} m J.\n"
        f"Shares of it, epsilon and IGD+ in percent: median (least to greatest) of {len(seeds)} seeds.\n"
    )
    print(table(results))


if __name__ == "__main__":
    main()
