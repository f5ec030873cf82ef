"""How far above the physical floor the best of a small study are: a table of docs/model.md.

python benchmarks/floor.py
"""

import tempfile
from pathlib import Path

import numpy as np

import pareto_monoped as pm
from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import NAMES
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.gravity import least_energy_j, least_of_all_j
from pareto_monoped.robot.population import robot_arrays

STUDY = Path(__file__).parents[1] / "studies" / "quick.toml"
MAP = map_for("VT8020")  # of the study's motor
HEIGHTS_M = np.array([0.7, 0.8, 0.9, 1.0, 1.1])


def main() -> None:
    """Run the study and print the table."""
    study = pm.Study.from_toml(STUDY)
    calibration = load_calibration(study.calibration)
    with tempfile.TemporaryDirectory() as folder:
        stored = pm.run(study, Path(folder) / "study.db")
        trials, front = stored.trials, stored.front()
    jumped = trials[trials["height_m"].notna()]
    robots = robot_arrays(jumped[list(NAMES)].to_numpy(dtype=np.float64), MAP, calibration.mass)
    line = least_of_all_j(robots, calibration, HEIGHTS_M)
    print("| height, m | line, J | its own floor, J | best found, J | over the line |\n|---|---|---|---|---|")
    for height, least in zip(HEIGHTS_M, line, strict=True):
        high = front[front["height_m"] >= height]
        best = high.loc[[high["energy_j"].idxmin()]]
        robot = robot_arrays(best[list(NAMES)].to_numpy(dtype=np.float64), MAP, calibration.mass)
        own = least_energy_j(robot, calibration, np.array([height]))[0]
        found = float(best["energy_j"].iloc[0])
        print(f"| {height:.1f} | {least:.1f} | {own:.1f} | {found:.1f} | {found / least:.1f} |")


if __name__ == "__main__":
    main()
