"""The main job's front under the paper's controller, with free torque, and the floor: the table of docs/limit.md.

python benchmarks/limit_fronts.py [--evaluations N] [--knots N] [--folder DIR]
"""

import argparse
import tempfile
from pathlib import Path

import numpy as np

import pareto_monoped as pm
from pareto_monoped.actuator.search import map_for
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.gravity import least_energy_j
from pareto_monoped.robot.population import robot_arrays

HEIGHTS = (0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--evaluations", type=int, default=8000)
    parser.add_argument("--knots", type=int, default=6)
    parser.add_argument("--folder", type=Path)
    given = parser.parse_args()
    profile = {"kind": "torque_over_time", "knots": given.knots}
    searches = {"virtual leg": {}, "free torque": {"controller": profile, "algorithm": "nsga2"}}
    fronts = {}
    with tempfile.TemporaryDirectory() as temporary:
        folder = given.folder or Path(temporary)
        for name, keys in searches.items():
            study = pm.Study.define(name=name, evaluations=given.evaluations, **keys)
            fronts[name] = pm.run(study, folder / f"{name.replace(' ', '_')}.db").front()
    print("| height, m | virtual leg, J | free torque, J | less, % | links of it, m | floor of it, J |")
    print("|---|---|---|---|---|---|")
    maps, calibration = map_for("VT8020"), load_calibration("reference")
    for height in HEIGHTS:
        cells = []
        for front in fronts.values():
            high = front[front["height_m"] >= height]
            cells.append(None if high.empty else high.loc[high["energy_j"].idxmin()])
        virtual, free = cells
        if free is None:
            continue
        names = list(pm.VARIABLES[:10])
        robots = robot_arrays([free[one.name] for one in names], maps, calibration.mass)
        floor = least_energy_j(robots, calibration, np.array([height]))[0]
        own = "-" if virtual is None else f"{virtual['energy_j']:.2f}"
        less = "-" if virtual is None else f"{100.0 * (1.0 - free['energy_j'] / virtual['energy_j']):.1f}"
        links = f"{free['thigh_length_m']:.3f} / {free['shank_length_m']:.3f}"
        print(f"| {height} | {own} | {free['energy_j']:.2f} | {less} | {links} | {floor:.2f} |")
    highest = (f"{front['height_m'].max():.3f} m" for front in fronts.values())
    print(f"| highest | {' | '.join(highest)} | - | - | - |")


if __name__ == "__main__":
    main()
