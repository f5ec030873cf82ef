"""Draw the figure of docs/bench.md, the 7.2:1 actuator predicted and measured, for ``actuator_bench.py``."""

from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from actuator_bench import MOTORS, PROPORTIONAL, SMALL, Floats, currents, held, line, no_load, own, pair
from matplotlib.figure import Figure

from pareto_monoped.actuator.motors import load_motor

PREDICTED = {0.1: ("greased steel", "#d95f02"), 0.3: ("dry plastic", "#7a3b9a")}  # by friction coefficient
STYLE: dict[Any, Any] = {"font.size": 9.0, "axes.titlesize": 9.5, "legend.fontsize": 8.0, "legend.frameon": False}
STYLE |= {"axes.grid": True, "grid.color": "#e4e4e4", "grid.linewidth": 0.5, "axes.linewidth": 0.6}
STYLE |= {"axes.axisbelow": True, "svg.hashsalt": "pareto_monoped", "legend.handlelength": 1.4}


def draw(runs: Any, found: Any, path: Path) -> None:
    """Write the figure: torque of the brake and power of the drive over the command, and what is left of both."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(7.6, 5.8), layout="constrained", facecolor="white")
        axes = figure.subplots(2, 2, sharex=True, gridspec_kw={"height_ratios": [1.9, 1.0]})
        _torque(axes[:, 0], runs, found)
        _power(axes[:, 1], runs, found)
        for bottom in axes[1]:
            bottom.set(xlabel="commanded torque, N m", xticks=range(2, 19, 2))
            bottom.axhline(0.0, color="#333333", lw=0.8)
        figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None, dpi=160)


def _points(axes: Any, runs: Any, y: Floats, *, labelled: bool = False) -> None:
    speeds = np.round(runs.speed * 30.0 / np.pi, -1)
    for i, speed in enumerate(np.unique(speeds)):
        rows, tint = speeds == speed, matplotlib.colormaps["viridis"](0.05 + 0.21 * i)
        text = f"measured, {speed:.0f} rpm" if labelled else None
        # Later speeds are smaller, so that points upon each other all show.
        axes.plot(runs.command_n_m[rows], y[rows], "o", ms=5.0 - 0.6 * i, mew=0.0, color=tint, label=text)


def _torque(axes: Any, runs: Any, found: Any) -> None:
    rows = np.searchsorted(found.command, runs.command_n_m)
    measured = runs.load_n_m * (found.braking / found.reported)[rows]
    both, motor = pair(found, PROPORTIONAL[::2]), line(found.command, found.driving)

    def arrives(command: Floats) -> Floats:
        return both.slope * (motor.slope * command - motor.offset) - both.offset

    command = np.array([1.0, 18.0])
    coulomb, viscous = no_load(SMALL)
    for friction, (text, tint) in PREDICTED.items():
        ends = [own(SMALL, friction) ** 2 * command - 2.0 * (coulomb + viscous * speed) for speed in (1.05, 5.24)]
        axes[0].fill_between(command, *ends, color=tint, alpha=0.5, lw=0.0, label=f"predicted, {text} ({friction})")
        axes[1].fill_between(command, *(end - arrives(command) for end in ends), color=tint, alpha=0.5, lw=0.0)
    axes[0].plot(runs.command_n_m, runs.cell_n_m, "x", ms=4.0, mew=0.8, color="#888888", label="load cell")
    _points(axes[0], runs, measured)
    axes[0].set(title="Torque at the braking motor", ylabel="N m", ylim=(-1.0, 19.5), yticks=range(0, 19, 3))
    axes[0].legend(loc="upper left")
    _points(axes[1], runs, measured - arrives(runs.command_n_m))
    axes[1].set(ylabel="less fitted, N m", ylim=(-2.4, 0.9))
    axes[1].set_title("2 numbers fitted to odd torques up to 13 N m", fontsize=8.0)


def _power(axes: Any, runs: Any, found: Any) -> None:
    resistance, command = load_motor(MOTORS[SMALL]).terminal_resistance_ohm, np.linspace(1.0, 18.0, 60)
    for speed, style in ((10.0, "-"), (50.0, "--")):
        watts = command * speed * np.pi / 30.0 + resistance * currents(SMALL, command) ** 2
        axes[0].plot(command, watts, style, color="#d95f02", lw=1.3, label=f"predicted, {speed:.0f} rpm")
    _points(axes[0], runs, runs.test_w, labelled=True)
    axes[0].set(title="Power into the driving actuator", ylabel="W", ylim=(-8.0, 205.0))
    axes[0].legend(loc="upper left")
    some = found[::2]
    (drop, warm), _ = held(SMALL, some)
    motor, current = line(some.command, some.driving), currents(SMALL, runs.command_n_m)
    watts = (motor.slope * runs.command_n_m - motor.offset) * runs.speed + drop * current + warm * current**2
    _points(axes[1], runs, runs.test_w - watts)
    axes[1].set(ylabel="less fitted, W", ylim=(-4.0, 4.0))
    axes[1].set_title("4 numbers fitted to odd torques", fontsize=8.0)
