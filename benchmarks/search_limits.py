"""The default search and NSGA-II where limits are tight, jumps fail or variables are many.

    python benchmarks/search_limits.py          # a short look: 400 jumps each, two seeds
    python benchmarks/search_limits.py --full   # seeds 61 to 70: the table of benchmarks/search_landscapes.md

The default search takes longer to choose a design than NSGA-II. The last columns are of NSGA-II with four times as many
jumps, and of how much longer than the default search it takes for them, jumps by the compiled engine included.
"""

import argparse
import statistics
import tempfile
import time
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pareto_monoped.definition.study import Study
from pareto_monoped.storage.reader import StudyData, read_study
from pareto_monoped.study.run import run

LONGER = 4
"""How many times as many jumps NSGA-II makes in about the time of the default search."""
WIDE = Path(__file__).parents[1] / "studies" / "wide.toml"
TIGHT = {"height_m": {"min": 1.0}, "energy_j": {"max": 35.0}, "peak_gear_torque_knee_n_m": {"max": 33.0}}
OPTIONAL = {
    "knee_release_rad": {"lower": 0.0, "upper": 0.6},
    "rest_length_m": {"lower": 1.0, "upper": 20.0},
    "start_height_m": {"lower": 0.4, "upper": 0.6},
}
#: Jumps of each search, and the study's other keys. Ten knots per joint make 25 variables.
STUDIES: dict[str, tuple[int, dict[str, Any]]] = {
    "Case C": (2000, {"case": "C"}),
    "Case C within tight limits": (1000, {"case": "C", "constraints": TIGHT}),
    "`wide.toml`": (1500, tomllib.loads(WIDE.read_text(encoding="utf-8"))),
    "torque over time": (1500, {"controller": {"kind": "torque_over_time", "knots": 10}}),
    "MAD_M6C12": (2000, {"case": "C", "motor": "MAD_M6C12"}),
    "ten variables": (4000, {"variables": OPTIONAL}),
}


def searched(values: dict[str, Any], algorithm: str, seed: int, evaluations: int) -> StudyData:
    """A study after its search, without audits."""
    changed = {"name": "limits", "evaluations": evaluations, "seed": seed, "audit": False, "algorithm": algorithm}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "limits.db"
        run(Study.define(**(values | changed)), path)
        return read_study(path)


def held(study: StudyData) -> float:
    """Percent of the jumps after the first fifth that do not fail and hold all limits."""
    late = study.trials[len(study.trials) // 5 :]
    return 100.0 * float((late["state"] == "feasible").mean())


def timed(
    values: dict[str, Any], algorithm: str, seeds: Iterable[int], evaluations: int
) -> tuple[list[StudyData], float]:
    """Studies after their searches, and the processor time that these took, in seconds."""
    began = time.process_time()
    studies = [searched(values, algorithm, seed, evaluations) for seed in seeds]
    return studies, time.process_time() - began


def volumes(studies: list[StudyData]) -> str:
    """Hypervolumes at the end."""
    return spread([float(study.history["hypervolume"].iloc[-1]) for study in studies], 2)


def spread(values: list[float], digits: int) -> str:
    """Median (least to greatest)."""
    return f"{statistics.median(values):.{digits}f} ({min(values):.{digits}f} to {max(values):.{digits}f})"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--full", action="store_true", help="1,000 to 4,000 jumps each, seeds 61 to 70")
    full = parser.parse_args().full
    seeds = range(61, 71) if full else (1, 2)
    print(
        "| study | jumps | hypervolume, `surrogate` | `nsga2` | within all limits, %, `surrogate` | `nsga2` "
        "| `nsga2`, 4 x jumps | its time |\n|---|---:|---|---|---|---|---|---:|"
    )
    for name, (jumps, values) in STUDIES.items():
        count = jumps if full else 400
        (ours, ours_s), (plain, _) = (timed(values, one, seeds, count) for one in ("surrogate", "nsga2"))
        longer, longer_s = timed(values, "nsga2", seeds, LONGER * count)
        cells = [volumes(ours), volumes(plain), *(spread([held(one) for one in some], 0) for some in (ours, plain))]
        print(f"| {name} | {count:,} | {' | '.join(cells)} | {volumes(longer)} | {longer_s / ours_s:.1f} |", flush=True)


if __name__ == "__main__":
    main()
