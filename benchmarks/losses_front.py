"""What losses of real drives do to the front of the main job: the table and the figure of docs/losses.md.

python benchmarks/losses_front.py [--evaluations N] [--seeds N] [--figure FILE]
"""

import argparse
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

import pareto_monoped as pm
from pareto_monoped.analysis.choices import default_pick
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.storage.reader import read_study

HEIGHTS = (0.7, 0.9, 1.1, 1.3)
LEG_DAMPING_N_M_S_PER_RAD, LEG_PEAK_N_M, LEG_RATIO = 0.35, 12.0, 6.0
"""Of the public leg (docs/legs.md), each joint; its viscous friction is scaled by peak torque and ratio."""
_EVERY = 5  # design of a front that the figure shows
TINTS = ("#222222", "#d95f02", "#2a6fbb")


def settings() -> dict[str, Calibration]:
    """Return the calibrations that are compared, by what stands in the table."""
    machined, printed = pm.load_calibration("reference"), pm.load_calibration("printed")
    share = LEG_DAMPING_N_M_S_PER_RAD / (LEG_PEAK_N_M * LEG_RATIO)
    rubbing = replace(machined.joints, motor_damping_share_s_per_rad=share)
    return {
        "machined": machined,
        "printed": printed,
        "as the public leg": replace(machined, name="public_leg", version=1, joints=rubbing),
    }


def front_under(calibration: Calibration, evaluations: int, seeds: int, folder: Path) -> tuple[pd.DataFrame, pd.Series]:
    """Return the front of all seeds together, by height, and its knee."""
    fronts, knees = [], []
    for seed in range(1, seeds + 1):
        study = pm.Study.define(name=f"{calibration.name}_{seed}", evaluations=evaluations, seed=seed)
        stored = pm.run(study, folder / f"{calibration.name}_{seed}.db", calibration=calibration)
        fronts.append(stored.front())
        data = read_study(stored.path)
        rows = data.sound  # of which the main job takes the knee that is not dear at the battery
        knees.append(rows.loc[rows["trial"] == default_pick(data, [data]).trial].iloc[0])
    front = pd.concat(fronts).sort_values("height_m")
    better = np.minimum.accumulate(front["energy_j"].to_numpy()[::-1])[::-1]
    return front[front["energy_j"].to_numpy() <= better], knees[0]


def row(title: str, text: str, front: pd.DataFrame, height: float) -> str:
    """Return the least energy at a height with what belongs to it."""
    reach = front[front["height_m"] >= height]
    if reach.empty:
        return f"| {title} | {text} | - | - | - | - |"
    return cells(title, text, reach.loc[reach["energy_j"].idxmin()])


def cells(title: str, text: str, one: pd.Series) -> str:
    """Return a design as a row of the table."""
    energies = f"{one['energy_j']:.1f} | {one['electrical_energy_j']:.1f}"
    return f"| {title} | {text} | {energies} | {one['hip_ratio']:.2f} | {one['knee_ratio']:.2f} |"


def draw(found: dict[str, tuple[pd.DataFrame, pd.Series]], path: Path) -> None:
    """Draw the fronts and their knees."""
    import matplotlib
    from actuator_bench_figure import STYLE
    from matplotlib.figure import Figure

    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(7.6, 3.4), layout="constrained", facecolor="white")
        for axes, name, label in zip(
            figure.subplots(1, 2),
            ("energy_j", "electrical_energy_j"),
            ("mechanical energy, J", "energy from the battery, J"),
            strict=True,
        ):
            for tint, (title, (front, knee)) in zip(TINTS, found.items(), strict=True):
                some = front.iloc[::_EVERY]
                axes.plot(some["height_m"], some[name], ".", ms=3.0, color=tint, label=title)
                axes.plot(knee["height_m"], knee[name], "D", ms=6.0, mfc="none", color=tint)
            axes.set(xlabel="height, m", ylabel=label, ylim=0.0)
        figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=3)
        figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None, dpi=160)


def main() -> None:
    """Run the studies, print the table, and draw the figure if asked."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--evaluations", type=int, default=4000, help="jumps per study")
    parser.add_argument("--seeds", type=int, default=1, help="studies per setting")
    parser.add_argument("--figure", type=Path, help="also draw the figure to this file")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        found = {
            title: front_under(one, options.evaluations, options.seeds, Path(folder))
            for title, one in settings().items()
        }
    print("| losses | height, m | energy, J | from the battery, J | hip ratio | knee ratio |")
    print("|---|---|---|---|---|---|")
    for title, (front, knee) in found.items():
        for height in HEIGHTS:
            print(row(title, f"{height:.1f}", front, height))
        print(row(title, f"highest, {front['height_m'].max():.3f}", front, front["height_m"].max()))
        print(cells(title, f"knee, {knee['height_m']:.3f}", knee))
    if options.figure is not None:
        draw(found, options.figure)


if __name__ == "__main__":
    main()
