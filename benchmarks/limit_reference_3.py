"""The best torque found for six robots of an earlier version, under the calibration ``reference-3``.

``benchmarks/data/limit_robots.json`` has the robots with the gearboxes of their time: of the least energy at two
heights, the paper's C, of the least energy from the battery, and the highest of the main job's front. The search is
that of ``pareto-monoped limit`` without strength; the jumps are MuJoCo's, as the compiled engine has none of
``reference-3``.

    python benchmarks/limit_reference_3.py [--jumps N] [--seed N] [--tracking NAME]

With ``--tracking``, one design is searched alone, and then the law ``tracking`` with half of the jumps, which begins
with the torques found over time; unlike that of the command, it need not bear delay and other motors.
"""

import argparse
import json
from dataclasses import fields
from pathlib import Path

import numpy as np

from pareto_monoped.actuator.search import map_for
from pareto_monoped.analysis import limit
from pareto_monoped.design import NAMES, Floats, complete, control_of
from pareto_monoped.jump.audit import finer
from pareto_monoped.jump.calibration import Calibration, load_calibration
from pareto_monoped.jump.engines import told_profiles
from pareto_monoped.jump.evaluate import Evaluations, evaluate_robots
from pareto_monoped.jump.variations import take
from pareto_monoped.robot.population import RobotArrays, robot_arrays

STORED = json.loads((Path(__file__).parent / "data" / "limit_robots.json").read_text())


def stored_robots(designs: Floats) -> RobotArrays:
    """Return the stored robots; what they lack, such as costs, is that of today and plays no part."""
    today = robot_arrays(designs, map_for("VT8020"))
    values = {field.name: getattr(today, field.name) for field in fields(today)}
    values |= {name: np.array(numbers) for name, numbers in STORED["robots"].items()}
    return RobotArrays(**values | {"rated_torque_n_m": values["peak_torque_n_m"]})


class Stored(limit._Hardware):
    """The jumps of one stored robot."""

    def __init__(self, design: Floats, robot: RobotArrays, calibration: Calibration, energy: str) -> None:
        super().__init__(design, map_for("VT8020"), calibration, energy, 2)
        self.robot = robot
        self.own = evaluate_robots(robot, control_of(design[None]), calibration)
        self.told = self.point_of(told_profiles(robot, control_of(design[None]), calibration, self.law)[0])

    def jumps_of(self, points: Floats, calibration: Calibration) -> Evaluations:
        """Let the robot jump with profiles."""
        robots = take(self.robot, np.zeros(len(points), dtype=np.intp))
        return evaluate_robots(robots, control_of(self.designs(points)), calibration, 2)

    def __call__(self, points: Floats) -> Evaluations:
        """Let the robot jump as the search asks."""
        return self.jumps_of(points, self.calibration)


class Tracked(Stored):
    """The same with the tracking law, whose search begins with torques over time."""

    law = limit.TRACKING

    def start(self, over_time: Floats) -> Floats:
        """Return the point nearest to the torques of a profile over time."""
        model, design = self.virtual.under(limit.LAW), over_time.copy()
        design[NAMES.index("damping_n_s_per_m")] = limit._DAMPING_N_S_PER_M
        most = limit._MOST[self.law]
        told = told_profiles(self.robot, control_of(design[None]), model, self.law, most=most)[0]
        return self.point_of(np.append(limit._DAMPING_N_S_PER_M, told[1:]))


def main() -> None:
    """Print the table of docs/limit.md."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--jumps", type=int, default=6000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--tracking", choices=STORED["names"], metavar="NAME")
    given = parser.parse_args()
    calibration, designs = load_calibration("reference-3"), complete(np.array(STORED["designs"]))
    robots = stored_robots(designs)
    title = "tracking" if given.tracking else "best torque"
    print(f"| design | height, m | energy, J | {title}, J | gap, % | half step, % | quarter step, % |")
    print("|---|---|---|---|---|---|---|")
    highest = ""
    for k, (name, energy) in enumerate(zip(STORED["names"], STORED["energies"], strict=True)):
        if given.tracking not in (None, name):
            continue
        one, high = take(robots, np.array([k])), energy == "height_m"
        hardware = Stored(designs[k], one, calibration, "energy_j" if high else energy)
        height_m, own_j = float(hardware.own.height_m[0]), float(hardware.own.of(hardware.energy)[0])
        steep = limit._STEEP * own_j / (height_m - 0.5)
        at_least_m = None if high else height_m
        goal = limit._Goal(at_least_m=at_least_m, held=False, energy=hardware.energy, steep_j_per_m=steep)
        best, point = limit._searched(hardware, goal, hardware.told, given.jumps, (given.seed, k))
        if given.tracking:
            over_time = hardware.designs(point[None])[0]
            hardware = Tracked(designs[k], one, calibration, energy)
            best, point = limit._searched(
                hardware, goal, hardware.start(over_time), given.jumps // 2, (given.seed, k, 2)
            )
        steps = [hardware.jumps_of(point[None], finer(hardware.calibration, n)) for n in (1, 2, 4)]
        if high:
            found = " | ".join(f"{jump.height_m[0]:.3f} m for {jump.energy_j[0]:.1f} J" for jump in steps)
            highest = f"| {name} | {height_m:.3f} m | {found} |"
            continue
        values = [float(jump.of(energy)[0]) for jump in steps]
        changes = " | ".join(f"{100.0 * (value / best - 1.0):+.3f}" for value in values[1:])
        gap = 100.0 * (1.0 - best / own_j)
        print(f"| {name} | {height_m:.3f} | {own_j:.2f} | {best:.2f} | {gap:.1f} | {changes} |", flush=True)
    if given.tracking:
        return
    print("\n| greatest height | virtual leg | best torque | half step | quarter step |")
    print("|---|---|---|---|---|")
    print(highest)


if __name__ == "__main__":
    main()
