"""Does any torque bring a base higher on less work than ``jump.gravity.least_energy_j`` says?

Robots drawn over the paper's bounds jump without losses (calibration ``ideal``, steps of 0.5 ms) with random torques of
hip and knee, up to three times their peaks; then CMA-ES looks for the torques of least work to 0.8 m. Prints how far
above the floor the nearest jump of each robot is, in J and as a share of the floor, among those that rise by 5 cm.

    python benchmarks/least_energy.py [ROBOTS [PROFILES [OPTIMISED]]]
"""

import sys
from typing import Any

import cma
import mujoco
import numpy as np

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import LOWER, UPPER, Floats
from pareto_monoped.jump.calibration import Calibration, load_calibration
from pareto_monoped.jump.document import mjcf
from pareto_monoped.jump.gravity import least_energy_j
from pareto_monoped.jump.variations import take
from pareto_monoped.robot.population import RobotArrays, robot_arrays

KNOTS, PERIOD = 10, 0.05  # torques change linearly between knots, s apart
TARGET_M, STEP_S = 0.8, 5e-4


def jump(model: Any, data: Any, torques: Floats) -> tuple[float, float]:
    """Return the highest base and the positive work of the motors up to there, with torques at knots, (KNOTS, 2)."""
    mujoco.mj_resetDataKeyframe(model, data, 0)
    times = np.arange(round(KNOTS * PERIOD / STEP_S)) * STEP_S
    torque = np.stack([np.interp(times, PERIOD * np.arange(KNOTS), one) for one in torques.T], axis=1)
    ctrl, qpos, qvel, step = data.ctrl, data.qpos, data.qvel, mujoco.mj_step
    work, highest, worked = 0.0, float(qpos[-3]), 0.0
    for k in range(3 * len(times)):
        hip, knee = torque[k] if k < len(times) else (0.0, 0.0)
        ctrl[0], ctrl[1] = hip, knee
        hip_before, knee_before = qvel[-2], qvel[-1]
        step(model, data)
        power = max(hip * (hip_before + qvel[-2]), 0.0) + max(knee * (knee_before + qvel[-1]), 0.0)
        work += 0.5 * STEP_S * power
        z = qpos[-3]
        if z > highest:
            highest, worked = float(z), work
        elif z < highest - 0.1:
            break
    return highest, worked


def main(count: int = 20, profiles: int = 5000, optimised: int = 5) -> None:
    """Print the nearest of all jumps of each robot."""
    rng = np.random.default_rng(0)
    calibration = load_calibration("ideal-3")  # whose stops MuJoCo has
    designs = rng.uniform(LOWER, UPPER, (count, len(LOWER)))
    robots = robot_arrays(designs, map_for("VT8020"), calibration.mass)
    for i in range(count):
        model = mujoco.MjModel.from_xml_string(mjcf(robots, calibration, i))
        data = mujoco.MjData(model)
        model.opt.timestep = STEP_S
        peak = model.actuator_ctrlrange[:, 1].copy()
        model.actuator_ctrlrange[:] *= 3.0
        found = []
        for _ in range(profiles):
            size, bias = rng.uniform(0.05, 3.0), rng.uniform(-0.7, 0.2)
            shape = np.clip(rng.normal([0.0, bias], 0.5, (KNOTS, 2)), -1.0, 1.0)
            found.append(jump(model, data, size * shape * peak))
        print(f"robot {i:2} random     {told(robots, calibration, i, found)}", flush=True)
        if i >= optimised:
            continue
        found = []

        options = {"maxfevals": 4000, "seed": i + 1, "verbose": -9, "bounds": [-3.0, 3.0]}
        search = cma.CMAEvolutionStrategy(np.tile([0.0, -0.5], KNOTS), 0.3, options)
        while not search.stop():
            asked = search.ask()
            made = [jump(model, data, np.reshape(x, (KNOTS, 2)) * peak) for x in asked]
            search.tell(asked, [work + 300.0 * max(TARGET_M - height, 0.0) for height, work in made])
            found += made
        print(f"robot {i:2} optimised  {told(robots, calibration, i, found)}", flush=True)


def told(robots: RobotArrays, calibration: Calibration, i: int, found: list[tuple[float, float]]) -> str:
    """Return how far above the floor the nearest of some jumps is."""
    heights, works = np.array(found).T
    floor = least_energy_j(take(robots, np.full(len(found), i)), calibration, heights)
    above = works - floor
    risen = np.flatnonzero(heights > 0.55)
    shares = above[risen] / floor[risen]
    near = risen[shares.argmin()]
    return (
        f"{len(found)} jumps, {len(risen)} rise; least {above[risen].min():.3f} J above the floor, "
        f"{100.0 * shares.min():.1f} % ({works[near]:.3f} J to {heights[near]:.3f} m)"
    )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
