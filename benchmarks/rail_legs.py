"""A published leg predicted: the tables and the figure of docs/legs.md.

python benchmarks/rail_legs.py [--figure FILE]
"""

import argparse
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from pareto_monoped.analysis.rail_legs import Predicted, fitted_leg, predicted
from pareto_monoped.errors import SimulationError
from pareto_monoped.jump.rail_leg import MEASURED, RailLeg, load_leg
from pareto_monoped.jump.replay import TERMS, Term, replay
from pareto_monoped.uncertainty.settings import Sampling, load_uncertainty

LEG = Path(__file__).parents[1] / "examples" / "legs" / "dfki_hopping_leg.toml"
FITTED_ON, TERM, SAMPLES = "3", "damping", 256
LABELS = {"push_s": "push, s", "take_off_m_per_s": "take-off, m/s", "apex_m": "apex of the hip, m"}
ENCODERS = (0.54, 1.90, 2.00)
"""The centre's speed at the end of the push by the logs' encoders, in m/s: last 8 samples, mean of the hops."""
UNITS = {"damping": "N m s/rad", "friction": "N m", "efficiency": "lost", "rail": "N"}


def bands(leg: RailLeg, fit: Term | None = None) -> list[Predicted]:
    """Return all series under what is uncertain."""
    return predicted(leg, Sampling(ranges=load_uncertainty(), samples=SAMPLES), fit)


def rigid(leg: RailLeg) -> RailLeg:
    """Return the leg without what its drives give way."""
    drives: dict[str, Any] = {
        name: replace(getattr(leg, name), stiffness_n_m_per_rad=None) for name in ("hip_drive", "knee_drive")
    }
    return replace(leg, **drives)


def errors(leg: RailLeg) -> str:
    """Return the errors of take-off speed and apex of every series, in percent, as cells."""
    cells = []
    for series in leg.series:
        found = replay(leg, series)
        assert series.measured is not None
        both = [100.0 * (found[name][0] / getattr(series.measured, name)[0] - 1.0) for name in MEASURED[1:]]
        cells.append(", ".join("-" if np.isnan(error) else f"{error:+.0f}" for error in both))
    return " | ".join(cells)


def print_predictions(leg: RailLeg, given: list[Predicted], after: list[Predicted]) -> None:
    """Print measured, predicted as given and predicted with the fitted term."""
    print("| series | quantity | measured | as given, 5 to 95 % | fitted, 5 to 95 % | error, % |")
    print("|---|---|---|---|---|---|")
    for series, one, other in zip(leg.series, given, after, strict=True):
        for name, label in LABELS.items():
            mean, deviation = getattr(series.measured, name)
            texts = [f"{b.nominal:.3f} ({b.p05:.3f} to {b.p95:.3f})" for b in (one.bands[name], other.bands[name])]
            error = 100.0 * (other.bands[name].nominal / mean - 1.0)
            text = "fitted" if (series.name, name) == (FITTED_ON, "take_off_m_per_s") else f"{error:+.1f}"
            print(f"| {series.name} | {label} | {mean:.3f} ± {deviation:.3f} | {' | '.join(texts)} | {text} |")


def print_terms(leg: RailLeg) -> None:
    """Print what each loss term predicts, fitted to each series."""
    print("| drives | term | fitted on | value | 1: take-off, apex, % | 2: take-off, apex, % | 3: take-off, apex, % |")
    print("|---|---|---|---|---|---|---|")
    for kind, described in (("elastic", leg), ("rigid", rigid(leg))):
        for term in TERMS:
            for series in leg.series:
                try:
                    found, value, _ = fitted_leg(described, term, series.name)
                except SimulationError:
                    print(f"| {kind} | {term} | {series.name} | none | - | - | - |")
                    continue
                print(f"| {kind} | {term} | {series.name} | {value:.3g} {UNITS[term]} | {errors(found)} |")


def draw(leg: RailLeg, given: list[Predicted], after: list[Predicted], path: Path) -> None:
    """Draw measured and predicted quantities side by side."""
    import matplotlib
    from actuator_bench_figure import STYLE
    from matplotlib.figure import Figure

    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(7.6, 3.0), layout="constrained", facecolor="white")
        for axes, (name, label) in zip(figure.subplots(1, 3), LABELS.items(), strict=True):
            places = np.arange(len(leg.series))
            for shift, found, tint, text in (
                (-0.12, given, "#d95f02", "as given"),
                (0.12, after, "#2a6fbb", f"{TERM} fitted on series {FITTED_ON}"),
            ):
                cells = [one.bands[name] for one in found]
                middle = np.array([cell.nominal for cell in cells])
                ends = np.abs([[cell.p05 for cell in cells], [cell.p95 for cell in cells]] - middle)
                axes.errorbar(
                    places + shift, middle, ends, fmt="s", ms=4.0, color=tint, capsize=3.0, lw=1.2, label=text
                )
            means, deviations = np.array([getattr(series.measured, name) for series in leg.series]).T
            axes.errorbar(places, means, deviations, fmt="o", ms=5.0, color="#222222", lw=1.2, label="measured")
            if name == "take_off_m_per_s":
                axes.plot(places, ENCODERS, "o", ms=5.0, mfc="none", color="#222222")
            axes.set(
                title=label, xlabel="series", xticks=places, xticklabels=[one.name for one in leg.series], ylim=0.0
            )
            axes.set_xlim(-0.5, len(places) - 0.5)
        figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=3)
        figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None, dpi=160)


def main() -> None:
    """Print the tables, and draw the figure if asked."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--figure", type=Path, help="also draw the figure to this file")
    figure: Path | None = parser.parse_args().figure
    leg = load_leg(LEG)
    found, _, term = fitted_leg(leg, TERM, FITTED_ON)
    given, after = bands(leg), bands(found, term)
    print_predictions(leg, given, after)
    print()
    print_terms(leg)
    if figure is not None:
        draw(leg, given, after, figure)


if __name__ == "__main__":
    main()
