"""The default search and NSGA-II where limits are tight, jumps fail or variables are many, and what is left to gain.

    python benchmarks/search_limits.py          # a short look: 400 jumps each, two seeds
    python benchmarks/search_limits.py --full   # seeds 61 to 70: the table of benchmarks/search_landscapes.md

The last column is what ``left_to_gain`` expects after a quarter of the jumps, over what the rest of them then gained.
"""

import argparse
import statistics
import tempfile
import tomllib
from pathlib import Path
from typing import Any

from pareto_monoped.definition.study import Study
from pareto_monoped.pareto.growth import AHEAD, left_to_gain
from pareto_monoped.storage.reader import StudyData, read_study
from pareto_monoped.study.run import run

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
    """A study after its search."""
    changed = {"name": "limits", "evaluations": evaluations, "seed": seed, "audit": False, "algorithm": algorithm}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "limits.db"
        run(Study.define(**(values | changed)), path)
        return read_study(path)


def held(study: StudyData) -> float:
    """Percent of the jumps after the first fifth that do not fail and hold all limits."""
    late = study.trials[len(study.trials) // 5 :]
    return 100.0 * float((late["state"] == "feasible").mean())


def estimate(study: StudyData) -> float | None:
    """What ``left_to_gain`` expects after one part in ``AHEAD`` of the jumps, over what the rest then gained."""
    done, volume = study.history[["evaluations", "hypervolume"]].to_numpy().T
    early = done <= done[-1] / AHEAD
    expected = left_to_gain(done[early], volume[early])
    return None if expected is None else float(expected / (volume[-1] / volume[early][-1] - 1.0))


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
        "| expected over gained |\n|---|---:|---|---|---|---|---|"
    )
    for name, (jumps, values) in STUDIES.items():
        count = jumps if full else 400
        ours, plain = (
            [searched(values, algorithm, seed, count) for seed in seeds] for algorithm in ("surrogate", "nsga2")
        )
        said = [ratio for study in ours if (ratio := estimate(study)) is not None]
        cells = [spread([float(study.history["hypervolume"].iloc[-1]) for study in some], 2) for some in (ours, plain)]
        cells += [spread([held(study) for study in some], 0) for some in (ours, plain)]
        print(f"| {name} | {count:,} | {' | '.join(cells)} | {spread(said, 2) if said else '-'} |", flush=True)


if __name__ == "__main__":
    main()
