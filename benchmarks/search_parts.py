"""What each part of the default search is worth: the hypervolume that a search without it has, on twelve landscapes.

    python benchmarks/search_parts.py          # a short look: two parts on two landscapes
    python benchmarks/search_parts.py --full   # every part on every landscape: an hour and a quarter

Each part is taken out by a value of its constant at which it does nothing. The seeds are the same with and without it,
but the searches then take other courses, so a difference means little that is not beyond the spread of the whole
search. The script has no means to make a part look good: it runs the package's own search and measures with its own
or pymoo's hypervolume.
"""

import argparse
import statistics
from contextlib import ExitStack
from unittest.mock import patch

import numpy as np
import search_landscapes
from pymoo.indicators.hv import HV
from search_limits import STUDIES, held, searched

SEARCH = "pareto_monoped.search"
# What is taken out, and the constants that do it.
PARTS: dict[str, dict[str, object]] = {
    "nothing": {},
    "Gaussian process": {"archive._FEW_DESIGNS": 0},
    "two drawn generations with bounds and corners": {"surrogate._ON_BOUND": (0.0, 0.0)},
    "small steps around the best": {"surrogate._STEPS": 0},
    "climbs": {"prediction.Prediction.determined": False},
    "scans within climbs, but for the bounds": {"variation._SCANNED": 2},
    "explorers": {"surrogate._EXPLORING": 0.0},
    "plain evolution": {"surrogate._PLAIN_ENDS": (0.0, 0.0)},
    "smaller generations at first": {"surrogate._SMALLER": (1, 1)},
    "tolerance that follows what holds": {"surrogate._HELD": -1.0},
    "corrections by kriging": {"prediction._REACH": 1e-9},
    "points behind the front in the fit": {"prediction._SPREAD_SHARE": 0.0},
    "weights of the fit": {"prediction._NEARNESS": 1e3},
    "learned share of failed jumps": {"prediction._RISK": 10.0},
    "distance from the front in what is behind it": {"archive._APART": 0.0},
}
LANDSCAPES: dict[str, int] = {
    "Case C": 10,
    "Case C, 300 jumps": 8,
    "Case C, 8,000 jumps": 3,
    "MAD_M6C12": 5,
    "U10": 3,
    "Case C within tight limits": 5,
    "`wide.toml`": 5,
    "ten variables": 4,
    "osy": 3,
    "zdt4": 3,
    "kursawe": 3,
    "dtlz2": 3,
}
"""Landscapes and how many seeds each has, from 101 on, which no other benchmark uses."""
OTHERS = {
    "Case C, 300 jumps": (300, {"case": "C"}),
    "Case C, 8,000 jumps": (8000, {"case": "C"}),
    "U10": (1000, {"case": "C", "motor": "U10"}),
    "ten variables": (2000, STUDIES["ten variables"][1]),
}
HELD = ("Case C", "Case C within tight limits", "`wide.toml`")
"""Studies of which the second table says how many jumps hold all limits."""


def searches(landscape: str, seeds: range) -> tuple[list[float], list[float]]:
    """Hypervolume of each search, that of studies in m J, and of studies the percent of jumps that hold all limits."""
    if landscape in search_landscapes.PROBLEMS:
        volume = HV(ref_point=np.array(search_landscapes.PROBLEMS[landscape][1]))
        return [float(volume(search_landscapes.search(landscape, "surrogate", seed, 1000))) for seed in seeds], []
    jumps, values = (STUDIES | OTHERS)[landscape]
    studies = [searched(values, "surrogate", seed, jumps) for seed in seeds]
    return [float(study.history["hypervolume"].iloc[-1]) for study in studies], [held(study) for study in studies]


def without(constants: dict[str, object], landscape: str, count: int) -> tuple[list[float], list[float]]:
    """``searches`` with other constants."""
    with ExitStack() as stack:
        for name, value in constants.items():
            stack.enter_context(patch(f"{SEARCH}.{name}", value))
        return searches(landscape, range(101, 101 + count))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--full", action="store_true")
    parser.add_argument("--only", nargs="+", choices=PARTS, help="these parts alone")
    given = parser.parse_args()
    parts = {part: PARTS[part] for part in given.only or (PARTS if given.full else ("nothing", "explorers"))}
    landscapes = LANDSCAPES if given.full else {"U10": 2, "zdt4": 2}
    print(f"| without | {' | '.join(landscapes)} |\n|---|{'---:|' * len(landscapes)}", flush=True)
    whole: dict[str, float] = {}
    shares: dict[str, list[str]] = {part: [] for part in parts}
    for part, constants in parts.items():
        cells = []
        for landscape, count in landscapes.items():
            found, kept = without(constants, landscape, count)
            mean = statistics.mean(found)
            if landscape in whole:
                cells.append(f"{100.0 * (mean / whole[landscape] - 1.0):+.1f} %")
            else:
                whole[landscape] = mean
                cells.append(f"{mean:.4g} ± {100.0 * statistics.stdev(found) / count**0.5 / mean:.1f} %")
            if landscape in HELD:
                shares[part].append(f"{statistics.mean(kept):.0f} ({min(kept):.0f})")
        print(f"| {part} | {' | '.join(cells)} |", flush=True)
    if given.full:
        print(f"\n| within all limits, %, without | {' | '.join(HELD)} |\n|---|{'---:|' * len(HELD)}")
        for part, texts in shares.items():
            print(f"| {part} | {' | '.join(texts)} |")


if __name__ == "__main__":
    main()
