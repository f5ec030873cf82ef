"""The best known front of a motor: many surrogate-assisted searches, one after the other, their fronts merged.

    python benchmarks/search_reference.py                             # a short look: 2 searches of 400 jumps
    python benchmarks/search_reference.py --full                      # VT8020: 25 searches of 8,000 jumps
    python benchmarks/search_reference.py --full --motor U8 --searches 6
    python benchmarks/search_reference.py --full --first 14 --folder build/second   # 25 more searches at the same time
    python benchmarks/search_reference.py --full --take build/second                # and their front taken in

Each search has its own seed, from 1001 on, which no other benchmark uses. Its front is added to
``benchmarks/search_reference/MOTOR.csv`` as soon as it ends. The script can therefore be stopped at any time; started
again, it continues with the next seed. The file's first line says what it was made with, and the file is begun anew if
jumps have changed. The last step is the refinement: ``--refine`` further searches start from the merged front instead
of from designs spread over the space.
"""

import argparse
import itertools
import json
import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.definition.study import Study, load_study, study_from_dict
from pareto_monoped.design import NAMES
from pareto_monoped.jump.calibration_defaults import rules_for, strength_for
from pareto_monoped.pareto.front import front_mask
from pareto_monoped.pareto.objectives import hypervolume
from pareto_monoped.search.algorithm import Scores
from pareto_monoped.search.registry import make_algorithm
from pareto_monoped.search.scoring import judge, scores
from pareto_monoped.search.space import coordinates_of
from pareto_monoped.study.simulator import Simulator, load_simulator

HERE = Path(__file__).parent
FOLDER = HERE / "search_reference"
STUDIES = HERE.parent / "studies"
FIRST_SEED = 1001
MOST_KEPT = 3000
"""Designs of a merged front that are stored: their hypervolume is 0.01 percent less than that of 13,000."""

Floats = NDArray[np.float64]


def corner_of(motor: str) -> dict[str, float]:
    """Reference point of a motor's studies: what the file of its Case C in ``studies`` has, or the default one."""
    for path in (STUDIES / "case_c.toml", *sorted(STUDIES.glob("motor_*.toml"))):
        if (study := load_study(path)).motor == motor:
            return study.reference_point.as_dict()
    return {}


def study_of(motor: str, seed: int, evaluations: int) -> Study:
    """Case C of a motor under ``reference``, as in studies/motor_*.toml."""
    values: dict[str, Any] = {
        "name": "r",
        "case": "C",
        "motor": motor,
        "calibration": "reference",
        "rules": rules_for("reference"),
    }
    values |= {"strength": strength_for("reference"), "gear_list": True, "reference_point": corner_of(motor)}
    values |= {"evaluations": evaluations, "seed": seed, "algorithm": {"name": "surrogate"}}
    return study_from_dict(values, source="benchmark")


def searched(simulator: Simulator, study: Study, known: Floats) -> tuple[Floats, Floats]:
    """The front of one search: coordinates, shape (k, d), and objectives, shape (k, m).

    Args:
        simulator: of the study.
        study: the search, its seed and its budget.
        known: coordinates of designs that it begins with, shape (n, d), n may be 0; they are simulated, too.
    """
    coordinates = simulator.coordinates(study)
    algorithm = make_algorithm(study, coordinates)
    values, points = np.zeros((0, len(coordinates.space.names))), np.zeros((0, 2))

    def simulated(asked: Floats) -> Scores:
        result = simulator.evaluator(coordinates.designs(asked))
        return scores(result, judge(result, study.constraints, study.objectives), study.objectives)

    def added(asked: Floats, found: Scores) -> None:
        nonlocal values, points
        good = found.violation == 0.0
        values, points = np.vstack((values, asked[good])), np.vstack((points, found.values[good]))
        mask = front_mask(points, study.objectives)
        values, points = values[mask], points[mask]

    if len(known):
        found = simulated(known)
        added(known, found)
        algorithm.restore({"generation": study.evaluations}, [(known, found)])
    done = 0
    while done < study.evaluations and (proposal := algorithm.ask()) is not None:
        found = simulated(proposal.values)
        algorithm.tell(found)
        added(proposal.values, found)
        done += len(proposal.values)
    return values, points


def thinned(points: Floats, most: int) -> NDArray[np.intp]:
    """Rows of at most ``most`` points of a front of two objectives, by the first one.

    The point whose loss costs the least hypervolume goes first, so thin parts of the front stay. Both ends stay, too.
    """
    order = np.argsort(points[:, 0])
    while len(order) > most:
        along, across = points[order].T
        lost = np.abs(along[1:-1] - along[:-2]) * np.abs(across[2:] - across[1:-1])
        order = np.delete(order, 1 + lost.argmin())
    return order


def read(path: Path, probe: Any, names: tuple[str, ...]) -> tuple[dict[str, Any], Floats]:
    """What a file says of itself, and its rows; a new one if there is none or if jumps have changed since."""
    if path.exists():
        first, *_ = path.read_text().splitlines()
        about: dict[str, Any] = json.loads(first.removeprefix("# "))
        if about["probe"] == probe:
            return about, np.loadtxt(path, delimiter=",", skiprows=2, ndmin=2)
    return {"probe": probe, "seeds": [], "evaluations": 0, "refinements": 0, "seconds": 0.0}, np.zeros((0, len(names)))


def merged(rows: Floats, study: Study) -> Floats:
    """The front of designs with their objectives in the last two columns, thinned to ``MOST_KEPT``."""
    rows = rows[front_mask(rows[:, -2:], study.objectives)]
    return rows[thinned(rows[:, -2:], MOST_KEPT)]


def keep(path: Path, about: dict[str, Any], rows: Floats, study: Study) -> None:
    """Write a file of a front."""
    about["hypervolume"] = round(hypervolume(rows[:, -2:], study.reference_point), 5)
    header = f"{json.dumps(about)}\n{','.join((*study.free, *study.objectives.names))}"
    np.savetxt(path, rows, delimiter=",", fmt="%.9g", header=header)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--motor", default="VT8020")
    parser.add_argument("--full", action="store_true", help="25 searches of 8,000 jumps; keep the front")
    parser.add_argument("--searches", type=int, help="searches in all, those in the file included")
    parser.add_argument("--refine", type=int, default=2, help="searches from the merged front")
    parser.add_argument("--evaluations", type=int, help="jumps per search")
    parser.add_argument("--workers", type=int, default=1, help="threads that simulate")
    parser.add_argument("--folder", type=Path, help="where the front is kept")
    parser.add_argument("--first", type=int, default=1, help="number of the first search, where others run elsewhere")
    parser.add_argument("--take", type=Path, nargs="*", default=[], help="folders whose fronts are taken in")
    arguments = parser.parse_args()
    searches, evaluations, folder = (25, 8_000, FOLDER) if arguments.full else (2, 400, HERE.parent / "build")
    searches, evaluations = arguments.searches or searches, arguments.evaluations or evaluations
    folder = arguments.folder or folder
    first = study_of(arguments.motor, FIRST_SEED, evaluations)
    simulator = load_simulator(first, workers=arguments.workers)
    names = (*first.free, *first.objectives.names)
    path = folder / f"{arguments.motor}.csv"
    folder.mkdir(exist_ok=True)
    about, rows = read(path, simulator.probe(), names)
    coordinates = coordinates_of(first, simulator.evaluator.actuator_map)
    free = [name in first.free for name in NAMES]
    for folder in arguments.take:
        more, others = read(folder / path.name, simulator.probe(), names)
        if not set(more["seeds"]) <= set(about["seeds"]):
            about |= {key: about[key] + more[key] for key in ("seeds", "evaluations", "refinements", "seconds")}
            rows = merged(np.vstack((rows, others)), first)
            keep(path, about, rows, first)
    while len(about["seeds"]) < searches or about["refinements"] < arguments.refine:
        began, refining = time.perf_counter(), len(about["seeds"]) >= searches
        unused = (k for k in itertools.count(FIRST_SEED - 1 + arguments.first) if k not in about["seeds"])
        seed = FIRST_SEED + 1000 + about["refinements"] if refining else next(unused)
        designs = np.tile(first.lower, (len(rows), 1))
        designs[:, free] = rows[:, :-2]
        known = coordinates.values(designs)[: MOST_KEPT if refining else 0]
        study = study_of(arguments.motor, seed, evaluations)
        values, points = searched(simulator, study, known)
        found = coordinates.designs(values)[:, free]
        rows = merged(np.vstack((rows, np.hstack((found, points)))), first)
        if refining:
            about["refinements"] += 1
        else:
            about["seeds"].append(seed)
        about["evaluations"] += evaluations + len(known)
        about["seconds"] = round(about["seconds"] + time.perf_counter() - began, 1)
        keep(path, about, rows, first)
        kind = "refinement" if refining else "seed"
        print(
            f"{arguments.motor} {kind} {seed}: hypervolume {about['hypervolume']:.4f}, {len(rows)} designs", flush=True
        )


if __name__ == "__main__":
    main()
