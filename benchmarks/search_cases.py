"""Cases A, B and C as studies: the paper's designs, the weighted search and the front, at the same height.

    python benchmarks/search_cases.py               # what benchmarks/search_cases.md shows
    python benchmarks/search_cases.py --evaluations 1600
    python benchmarks/search_cases.py --calibration paper --evaluations 2400    # a table of docs/model.md

All energies are simulated here, under ``reference`` or ``paper``, except for the column "published".
"""

import argparse
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from pandas import DataFrame

from pareto_monoped.definition.study import filled
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import run
from pareto_monoped.study.simulator import evaluation_of, load_simulator

WEIGHTS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95)


def least_energy(front: DataFrame, height_m: float) -> str:
    """Least energy of the designs on a front that reach this height, as text."""
    high = front[front["height_m"] >= height_m]
    return f"{high['energy_j'].min():.2f}" if len(high) else "not reached"


def front(folder: Path, case: str, algorithm: dict[str, Any], evaluations: int, calibration: str) -> DataFrame:
    """The front of a study of this case."""
    values = {"name": case, "case": case, "evaluations": evaluations, "audit": False, "algorithm": algorithm}
    path = folder / f"{case}-{algorithm['name']}.db"
    run(filled(values | {"calibration": calibration}, source="benchmark"), path)
    return read_study(path).front()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--evaluations", type=int, default=8_000, help="jumps per search")
    parser.add_argument("--calibration", choices=("reference", "paper"), default="reference")
    arguments = parser.parse_args()
    evaluations, calibration = arguments.evaluations, arguments.calibration
    study = filled({"name": "cases", "evaluations": 1, "calibration": calibration}, source="benchmark")
    cases = [PAPER_CASES[name] for name in ("A", "B", "C")]
    evaluate = evaluation_of(study, load_simulator(study, workers=1).evaluator)
    simulated = evaluate(np.array([case.design.as_array() for case in cases]))
    print(
        "| case | published | paper's design here | weighted CMA-ES: least J at the published height | front: least J "
        "there | weighted: least J at the design's height here | front: least J there |\n|---|---|---|---|---|---|---|"
    )
    with tempfile.TemporaryDirectory() as name:
        for i, case in enumerate(cases):
            sweep = {
                "name": "weighted_cmaes",
                "height_weights": WEIGHTS,
                "iterations": max(1, evaluations // (8 * len(WEIGHTS))),
            }
            weighted = front(Path(name), case.name, sweep, evaluations, calibration)
            ours = front(Path(name), case.name, {"name": "surrogate"}, evaluations, calibration)
            here = float(simulated.height_m[i])
            cells = [
                case.name,
                f"{case.height_m:.3f} m, {case.energy_j:.2f} J",
                f"{here:.3f} m, {simulated.energy_j[i]:.2f} J",
                *(least_energy(rows, height) for height in (case.height_m, here) for rows in (weighted, ours)),
            ]
            print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
