"""What a run says is left to gain, against what four times the evaluations then gained.

    python benchmarks/search_left.py                                        # a short look: two searches
    python benchmarks/search_left.py --full --figure docs/images/left_to_gain.svg   # twenty searches, and the picture

The searches are of five studies with four seeds each, which no other benchmark uses, and of another length than those
by which the estimate was chosen.
"""

import argparse
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from search_limits import STUDIES, searched

from pareto_monoped.pareto.growth import AHEAD, left_to_gain

SAID_AT = (300, 500, 1000)
"""Evaluations after which the estimate is asked for; a search has ``AHEAD`` times the most."""
CASES: dict[str, dict[str, Any]] = {
    "VT8020": STUDIES["Case C"][1],
    "U10": {"case": "C", "motor": "U10"},
    "MAD_M6C12": STUDIES["MAD_M6C12"][1],
    "battery": {"case": "C", "objectives": ["height_m", "electrical_energy_j"]},
    "`wide.toml`": STUDIES["`wide.toml`"][1],
}


def pairs(values: dict[str, Any], seed: int) -> NDArray[np.float64]:
    """What is expected after each of ``SAID_AT`` and what is gained, as shares of the hypervolume, shape (k, 2)."""
    study = searched(values, "surrogate", seed, AHEAD * max(SAID_AT))
    done, volume = study.history[["evaluations", "hypervolume"]].to_numpy(dtype=np.float64).T
    found = []
    for at in SAID_AT:
        early = done <= at
        gained = np.interp(AHEAD * done[early][-1], done, volume) / volume[early][-1] - 1.0
        found.append((left_to_gain(done[early], volume[early]) or np.nan, gained))
    return np.array(found)


def draw(found: dict[str, NDArray[np.float64]], path: Path) -> None:
    """Draw estimates over gains, in percent, with the band of a factor of two."""
    import matplotlib as mpl

    mpl.use("svg")
    mpl.rcParams["svg.hashsalt"] = "left_to_gain"
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(6.4, 4.8), layout="constrained")
    ends = np.array([0.02, 50.0])
    axes.fill_between(ends, 0.5 * ends, 2.0 * ends, color="#dddddd", label="within a factor of two")
    axes.plot(ends, ends, color="#888888", linewidth=1.0)
    for name, shares in found.items():
        one, *_ = axes.plot(*100.0 * shares[:, 1, ::-1].T, "o", label=name.strip("`"))
        axes.plot(*100.0 * shares[:, 2, ::-1].T, "o", color=one.get_color(), fillstyle="none")
    axes.set(xscale="log", yscale="log", xlim=ends, ylim=ends)
    axes.set_xlabel("gained by four times the evaluations, %")
    axes.set_ylabel("said to be left to gain, %")
    axes.legend(title=f"filled: after {SAID_AT[1]}, open: after {SAID_AT[2]:,}", frameon=False)
    figure.savefig(path, metadata={"Date": None})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--full", action="store_true", help="five studies, seeds 121 to 124")
    parser.add_argument("--figure", type=Path, metavar="FILE.svg", help="draw estimates over gains")
    given = parser.parse_args()
    cases, seeds = (CASES, range(121, 125)) if given.full else ({"U10": CASES["U10"]}, range(121, 123))
    found = {name: np.array([pairs(values, seed) for seed in seeds]) for name, values in cases.items()}
    every = np.concatenate(list(found.values()))
    print(
        "| said after | searches | expected over gained, median (quartiles) | within a factor of two "
        "| gained, median, % |"
        "\n|---:|---:|---|---:|---:|"
    )
    for at, shares in zip(SAID_AT, every.transpose(1, 0, 2), strict=True):
        ratio = shares[:, 0] / np.maximum(shares[:, 1], 1e-6)
        low, middle, high = np.nanpercentile(ratio, (25, 50, 75))
        near = int(np.sum((ratio > 0.5) & (ratio < 2.0)))
        print(
            f"| {at:,} | {len(ratio)} | {middle:.2f} ({low:.2f} to {high:.2f}) | {near} "
            f"| {100.0 * np.median(shares[:, 1]):.2f} |"
        )
    if given.figure:
        draw(found, given.figure)


if __name__ == "__main__":
    main()
