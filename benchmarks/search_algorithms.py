"""Search algorithms on the real problem: share of the front against number of jumps.

    python benchmarks/search_algorithms.py                       # a short look: 1,000 jumps, 2 seeds, small reference
    python benchmarks/search_algorithms.py --full                # what benchmarks/search_algorithms.md shows
    python benchmarks/search_algorithms.py --full --evaluations 5000 --only nsga2-100 random
    python benchmarks/search_algorithms.py --motor U8 --objectives height_m,electrical_energy_j
    python benchmarks/search_algorithms.py --full --wall         # only the times by the clock, on a quiet machine

The problem is Case C of the VT8020 under ``reference`` unless an option says otherwise: strength is asked for, and gear
ratios go through the list of gearboxes.
All seeds of one algorithm advance together, and their generations are simulated as one batch; the result of a jump
does not depend on its batch. Quality is the hypervolume of all designs evaluated so far, not of the last population,
as a share of the hypervolume of the reference front, which takes in everything that the contenders found, too. A
second table has the least of the second objective at given heights, in percent above the best known. Results are kept
in build/, one file per problem; the tables show everything in that file.
"""

import argparse
import json
import platform
import statistics
import sys
import time
from pathlib import Path
from typing import Any

import moocore
import numpy as np
from numpy.typing import NDArray
from search_reference import FOLDER, corner_of, read

from pareto_monoped.compute.chunks import cores
from pareto_monoped.definition.study import Study, study_from_dict
from pareto_monoped.jump.calibration_defaults import rules_for, strength_for
from pareto_monoped.pareto.front import front_mask
from pareto_monoped.pareto.objectives import Objectives, ReferencePoint, hypervolume
from pareto_monoped.search.algorithm import Algorithm
from pareto_monoped.search.registry import make_algorithm
from pareto_monoped.search.scoring import judge, scores
from pareto_monoped.study.simulator import Simulator, load_simulator

HERE = Path(__file__).parent
Points = NDArray[np.float64]
MARKS = (1_000, 2_000, 5_000, 8_000)
HEIGHTS_M = (0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3)
# Ten weights of the paper's cost, chosen so that the runs end at points along the whole front.
WEIGHTS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95)

CONTENDERS: dict[str, dict[str, Any]] = {
    "surrogate-40": {"name": "surrogate"},
    "surrogate-20": {"name": "surrogate", "population": 20, "drawn_generations": 6},
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
#: Contenders and seeds of benchmarks/search_algorithms.md.
SHOWN: dict[str, range] = {
    "surrogate-40": range(11, 21),
    "sms_emoa-40": range(11, 16),
    "nsga2-40": range(11, 16),
    "age_moea2-40": range(11, 16),
    "weighted_cmaes, 10 weights": range(11, 16),
    "random": range(11, 16),
}
# TPE takes longer than the jumps, and its time per trial grows with the number of trials.
TPE_EVALUATIONS = 2_000
# Jumps of one search alone that are timed: the default algorithm has its largest generations by then.
TIMED = 3_000


def study(problem: dict[str, Any], settings: dict[str, Any], seed: int, evaluations: int) -> Study:
    """A problem with these algorithm settings; the runs of a sweep over weights share the evaluations evenly."""
    if settings["name"] == "weighted_cmaes":
        settings = settings | {"iterations": max(1, evaluations // (8 * len(settings["height_weights"])))}
    values = {"name": "b", "case": "C", "evaluations": evaluations, "seed": seed, "algorithm": settings}
    return study_from_dict(values | problem, source="benchmark")


def epsilon(points: Points, best: Points, objectives: Objectives) -> float:
    """Additive epsilon indicator (Zitzler et al. 2003) of a front, as a share of the reference's extent; 0 is best."""
    return float(moocore.epsilon_additive(*normalised(points, best, objectives)))


def igd_plus(points: Points, best: Points, objectives: Objectives) -> float:
    """IGD+ (Ishibuchi et al. 2015) of a front, as a share of the reference front's extent; 0 is best."""
    return float(moocore.igd_plus(*normalised(points, best, objectives)))


def normalised(points: Points, best: Points, objectives: Objectives) -> tuple[Points, Points]:
    """Points and reference front as shares of its extent, less is better."""
    reference = objectives.minimised(best)
    low, extent = reference.min(axis=0), np.ptp(reference, axis=0)
    return (objectives.minimised(points) - low) / extent, (reference - low) / extent


class Archive:
    """The front of all designs that one search has evaluated, and its hypervolume at each mark."""

    def __init__(self, corner: ReferencePoint, marks: tuple[int, ...]) -> None:
        self.front = np.zeros((0, len(corner.values)))
        self.evaluations = 0
        self.volumes: dict[int, float] = {}
        self._corner = corner
        self._marks = marks

    def add(self, points: NDArray[np.float64], feasible: NDArray[np.bool_]) -> None:
        """Add n evaluated designs, in order; ``points`` has the objectives, shape (n, m)."""
        for mark in self._marks:
            if self.evaluations < mark <= self.evaluations + len(points):
                part = mark - self.evaluations
                self.volumes[mark] = hypervolume(self._joined(points[:part][feasible[:part]]), self._corner)
        self.front = self._joined(points[feasible])
        self.evaluations += len(points)

    def _joined(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        every = np.vstack((self.front, points))
        return every[front_mask(every, self._corner.objectives)]


def search(
    simulator: Simulator, studies: list[Study], evaluations: int, marks: tuple[int, ...]
) -> tuple[list[Archive], float]:
    """Searches that advance together; their archives, and the algorithm's processor time in seconds per 1,000 jumps."""
    coordinates = simulator.coordinates(studies[0])
    corner, constraints, objectives = studies[0].reference_point, studies[0].constraints, studies[0].objectives
    running: list[tuple[Algorithm, Archive]] = [
        (make_algorithm(s, simulator.coordinates(s)), Archive(corner, marks)) for s in studies
    ]
    archives = [archive for _, archive in running]
    thinking = 0.0
    while running:
        began = time.process_time()
        asked = [(run, run[0].ask()) for run in running if run[1].evaluations < evaluations]
        thinking += time.process_time() - began
        alive = [(run, proposal) for run, proposal in asked if proposal is not None]
        if not alive:
            break
        result = simulator.evaluator(coordinates.designs(np.vstack([proposal.values for _, proposal in alive])))
        judgement = judge(result, constraints, objectives)
        all_scores = scores(result, judgement, objectives)
        first = 0
        for (algorithm, archive), proposal in alive:
            rows = slice(first, first + len(proposal.values))
            first = rows.stop
            began = time.process_time()
            algorithm.tell(all_scores.of(rows))
            thinking += time.process_time() - began
            archive.add(all_scores.values[rows], judgement.state[rows] == "feasible")
        running = [run for run, _ in alive]
    total = sum(archive.evaluations for archive in archives)
    return archives, 1000.0 * thinking / total


def reference(simulator: Simulator, problem: dict[str, Any], evaluations: int) -> dict[str, Any]:
    """The front of many evaluations, in equal parts by NSGA-II, SMS-EMOA and the surrogate-assisted search."""
    fronts = []
    for settings in (
        {"name": "nsga2", "population": 200},
        {"name": "sms_emoa", "population": 100},
        {"name": "surrogate", "population": 80},
    ):
        # At least 5,000 jumps per search; with fewer, the reference is no better than the searches it measures.
        seeds = list(range(101, 101 + max(1, min(4, evaluations // 10_000))))
        part = evaluations // (3 * len(seeds))
        archives, _ = search(simulator, [study(problem, settings, seed, part) for seed in seeds], part, ())
        fronts += [archive.front for archive in archives]
        print(f"reference: {settings['name']} done", file=sys.stderr, flush=True)
    return {"evaluations": evaluations, "front": np.vstack(fronts).tolist()}


def contend(
    simulator: Simulator, problem: dict[str, Any], name: str, seeds: list[int], evaluations: int
) -> dict[str, Any]:
    """The results of one contender: one row of the table."""
    settings = CONTENDERS[name]
    budget = min(evaluations, TPE_EVALUATIONS) if settings["name"] == "optuna_tpe" else evaluations
    marks = tuple(mark for mark in MARKS if mark <= budget)
    studies = [study(problem, settings, seed, budget) for seed in seeds]
    archives, thinking = search(simulator, studies, budget, marks)
    volumes = {str(m): [a.volumes[m] for a in archives if m in a.volumes] for m in marks}
    if settings["name"] == "weighted_cmaes":
        # Its runs follow one another, so only the end is a fair mark; runs that converge early end the sweep early.
        volumes = {str(budget): [hypervolume(a.front, studies[0].reference_point) for a in archives]}
    return {
        "evaluations": budget,
        "volumes": volumes,
        "fronts": [archive.front.tolist() for archive in archives],
        "thinking_s_per_1000": thinking,
    }


def wall_s_per_1000(simulator: Simulator, problem: dict[str, Any], name: str) -> float:
    """Time by the clock of 1,000 designs of one search alone: its algorithm and its jumps, nothing stored."""
    settings = CONTENDERS[name]
    evaluations = min(TIMED, TPE_EVALUATIONS) if settings["name"] == "optuna_tpe" else TIMED
    began = time.perf_counter()
    (archive,), _ = search(simulator, [study(problem, settings, 1, evaluations)], evaluations, ())
    return 1000.0 * (time.perf_counter() - began) / archive.evaluations


def best_known(results: dict[str, Any], objectives: Objectives) -> NDArray[np.float64]:
    """The front of the reference and of everything that the contenders found, shape (k, m)."""
    fronts = [results["reference"]["front"], *(front for row in results["rows"].values() for front in row["fronts"])]
    points = np.vstack([np.array(front) for front in fronts if front])
    return np.asarray(points[front_mask(points, objectives)])


def cell(values: list[float] | None, scale: float = 100.0) -> str:
    """Median (least to greatest) of a quantity."""
    if not values:
        return ""
    low, middle, high = min(values) * scale, statistics.median(values) * scale, max(values) * scale
    return f"{middle:.2f} ({low:.2f} to {high:.2f})"


def best_first(results: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    """The contenders' rows, by their greatest median hypervolume, in whatever order they ran."""

    def best_median(item: tuple[str, dict[str, Any]]) -> float:
        return max((statistics.median(volumes) for volumes in item[1]["volumes"].values()), default=0.0)

    return sorted(results["rows"].items(), key=best_median, reverse=True)


def table(results: dict[str, Any], best: NDArray[np.float64], corner: ReferencePoint, *, wall: bool) -> str:
    """The table of shares in Markdown, with times by the clock if asked."""
    whole, objectives = hypervolume(best, corner), corner.objectives
    lines = [
        "| algorithm, population | "
        + " | ".join(f"{mark:,}" for mark in MARKS)
        + f" | epsilon % | IGD+ % | own s / 1,000 |{' wall s / 1,000 |' if wall else ''}",
        "|---|" + "---|" * (len(MARKS) + 3 + wall),
    ]
    for name, row in best_first(results):
        fronts = [np.array(front) for front in row["fronts"]]
        cells = [cell(row["volumes"].get(str(mark)), 100.0 / whole) for mark in MARKS]
        cells += [cell([measure(front, best, objectives) for front in fronts]) for measure in (epsilon, igd_plus)]
        cells.append(f"{row['thinking_s_per_1000']:.2f}")
        if wall:
            cells.append(f"{row['wall_s_per_1000']:.2f}" if "wall_s_per_1000" in row else "")
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def least_at_heights(results: dict[str, Any], best: NDArray[np.float64]) -> str:
    """The least of the second objective at the end, in percent above the best known: a table in Markdown."""

    def least(front: NDArray[np.float64], height: float) -> float:
        return float(front[front[:, 0] >= height, 1].min(initial=np.inf))

    heights = [height for height in HEIGHTS_M if np.isfinite(least(best, height))]
    lines = ["| percent above the best known at | " + " | ".join(f"{h:g} m" for h in heights) + " |"]
    lines += ["|---|" + "---|" * len(heights)]
    for name, row in best_first(results):
        fronts = [np.array(front) for front in row["fronts"]]
        cells = [cell([least(front, h) / least(best, h) - 1.0 for front in fronts]) for h in heights]
        lines.append(f"| {name}, {row['evaluations']:,} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--full", action="store_true", help="what the page shows: 8,000 jumps, 5 or 10 seeds; keep results"
    )
    parser.add_argument("--only", nargs="+", choices=CONTENDERS, help="run only these contenders")
    parser.add_argument("--wall", action="store_true", help="only time those that have been run, one after the other")
    parser.add_argument("--evaluations", type=int, help="jumps per search, instead of 1,000 or 8,000")
    parser.add_argument("--seeds", nargs=2, type=int, metavar=("FIRST", "LAST"), help="of each contender")
    parser.add_argument("--reference", type=int, help="jumps for a reference front that no file has")
    parser.add_argument("--motor", default="VT8020")
    parser.add_argument("--calibration", default="reference")
    parser.add_argument("--objectives", default="height_m,energy_j", help="two or three measures, separated by commas")
    arguments = parser.parse_args()
    evaluations, effort = (8_000, 200_000) if arguments.full else (1_000, 10_000)
    evaluations, effort = arguments.evaluations or evaluations, arguments.reference or effort
    given = None if arguments.seeds is None else range(arguments.seeds[0], arguments.seeds[1] + 1)
    problem: dict[str, Any] = {
        "motor": arguments.motor,
        "calibration": arguments.calibration,
        "rules": rules_for(arguments.calibration),
        "strength": strength_for(arguments.calibration),
        "gear_list": True,
        "objectives": arguments.objectives.split(","),
    }
    default_problem = arguments.calibration == "reference" and arguments.objectives == "height_m,energy_j"
    if default_problem:
        problem["reference_point"] = corner_of(arguments.motor)
    first = study(problem, {"name": "random"}, 1, 1)
    simulator = load_simulator(first, workers=cores())
    words = [Path(arguments.motor).stem, Path(arguments.calibration).stem, *problem["objectives"]]
    kept = HERE.parent / "build" / f"search_algorithms-{'-'.join(words)}.json"
    kept.parent.mkdir(exist_ok=True)
    results: dict[str, Any] = {"rows": {}}
    if arguments.full and kept.exists():
        results = json.loads(kept.read_text())
    # Results that were kept are of no use once the simulator has changed.
    if results.get("probe") != simulator.probe():
        results = {"probe": simulator.probe(), "machine": platform.machine(), "rows": {}}
    stored, points = read(FOLDER / f"{Path(arguments.motor).stem}.csv", simulator.probe(), first.free)
    if default_problem and stored["evaluations"]:
        results["reference"] = {"evaluations": stored["evaluations"], "front": points[:, -2:].tolist()}
    if "reference" not in results:
        results["reference"] = reference(simulator, problem, effort)
    default = ("surrogate-40", "nsga2-40", "random")
    for name in arguments.only or (results["rows"] if arguments.wall else SHOWN if arguments.full else default):
        seeds = given or (SHOWN.get(name, range(1, 6)) if arguments.full else range(1, 3))
        if arguments.wall:
            results["rows"][name]["wall_s_per_1000"] = wall_s_per_1000(simulator, problem, name)
        else:
            results["rows"][name] = contend(simulator, problem, name, list(seeds), evaluations)
        print(f"{name} done", file=sys.stderr, flush=True)
        if arguments.full:
            kept.write_text(json.dumps(results, indent=1) + "\n")
    best, corner = best_known(results, first.objectives), first.reference_point
    print(
        f"Reference front: {len(best)} designs of {results['reference']['evaluations']:,} evaluations and of all "
        f"contenders, hypervolume {hypervolume(best, corner):.4f} {first.objectives.volume_unit} "
        f"from {corner.text()}.\n"
        "Shares of it, epsilon and IGD+ in percent: median (least to greatest) of the seeds.\n"
    )
    print(table(results, best, corner, wall=arguments.wall))
    if first.objectives.names[0] == "height_m" and len(first.objectives.names) == 2:
        print(least_at_heights(results, best))


if __name__ == "__main__":
    main()
