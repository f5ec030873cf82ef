"""Speed of the batch evaluation, paired against raw ``mj_step`` and against the naive way.

Raw: the same steps of the same models with the recorded torques, (a) by ``mujoco.rollout``, which has a compiled loop
over ``mj_step``, and (b) by a Python loop over ``mj_step``. Naive: the XML of each design is compiled, and the
controller is written in Python and NumPy (the tests' oracle). The script compares the results first. Every round then
times all methods alternately, and medians of the rounds' ratios are printed. Ratios are of processor time, which
other work on the machine disturbs little; the gain by a second thread is of wall time and needs a quiet machine. The
last two columns leave out the weighing of the robots.

    python benchmarks/jump_speed.py [ROUNDS]
"""

import statistics
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import mujoco
import mujoco.rollout
import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import CONTROL, LOWER, PAPER_CONTROL, UPPER, columns
from pareto_monoped.jump.calibration import Calibration, FadeGate, load_calibration
from pareto_monoped.jump.document import mjcf
from pareto_monoped.jump.evaluate import Evaluator, evaluate_robots
from pareto_monoped.robot.population import RobotArrays, robot_arrays
from tests.jump.oracle import Jump, jump, motors_of

Floats = NDArray[np.float64]
FULL = mujoco.mjtState.mjSTATE_FULLPHYSICS
AGREEMENT = 1e-9


def main(rounds: int) -> None:
    """Print one line per batch size; ``of raw`` is against ``mujoco.rollout``, ``of loop`` against the Python loop."""
    calibration, actuators = load_calibration("reference-3"), map_for("VT8020")
    one, two = Evaluator(actuators, calibration, 1), Evaluator(actuators, calibration, 2)
    heads = ("us per step, one core", "of raw", "of a Python loop", "x naive", "gain by a second core")
    built = ("us per step, robots built", "of raw, robots built")
    print(f"| batch | {' | '.join((*heads, *built))} |")
    print("|---:" * 8 + "|")

    def from_robots(robots: RobotArrays, designs: Floats) -> object:
        return evaluate_robots(robots, columns(designs, CONTROL), calibration)

    def naively(robots: RobotArrays, designs: Floats, rows: range) -> object:
        return [_naive(mjcf(robots, calibration, i), designs[i], robots, i, calibration) for i in rows]

    for size in (1, 8, 40, 200):
        designs = np.random.default_rng(size).uniform(LOWER, UPPER, (size, len(LOWER)))
        robots = robot_arrays(designs, actuators, calibration.mass)
        documents = [mjcf(robots, calibration, i) for i in range(size)]
        answers = one(designs)
        recorded = [_naive(documents[i], designs[i], robots, i, calibration) for i in range(size)]
        _same("naive", np.array([[j.height, j.energy] for j in recorded]), answers.height_m, answers.energy_j)
        torques = [np.array(j.torques) for j in recorded]
        raw = Raw(documents, torques)
        _same("raw", raw.heights(), answers.height_m)
        few = range(min(size, 8))
        naive_steps = sum(len(torques[i]) for i in few)
        ways: dict[str, Callable[[], object]] = {
            "ours": partial(one, designs),
            "built": partial(from_robots, robots, designs),
            "two": partial(two, designs),
            "raw": raw.rollout,
            "python": raw.python_loop,
            "naive": partial(naively, robots, designs, few),
        }
        wall: dict[str, list[float]] = {name: [] for name in ways}
        cpu: dict[str, list[float]] = {name: [] for name in ways}
        for _ in range(rounds):
            for name, way in ways.items():
                start, busy = time.perf_counter(), time.process_time()
                way()
                wall[name].append(time.perf_counter() - start)
                cpu[name].append(time.process_time() - busy)
        steps = sum(len(t) for t in torques)
        cells = (
            statistics.median(cpu["ours"]) / steps * 1e6,
            _ratio(cpu["raw"], cpu["ours"]),
            _ratio(cpu["python"], cpu["ours"]),
            _ratio(cpu["naive"], cpu["ours"]) * steps / naive_steps,
            _ratio(wall["ours"], wall["two"]),
            statistics.median(cpu["built"]) / steps * 1e6,
            _ratio(cpu["raw"], cpu["built"]),
        )
        print(f"| {size} | {' | '.join(f'{cell:.3g}' for cell in cells)} |")


class Raw:
    """The recorded jumps, stepped again with the recorded torques."""

    def __init__(self, documents: list[str], torques: list[Floats]) -> None:
        self.torques = torques
        self.models = [mujoco.MjModel.from_xml_string(document) for document in documents]
        self.data = [mujoco.MjData(model) for model in self.models]
        self.starts = []
        for model, data in zip(self.models, self.data, strict=True):
            mujoco.mj_resetDataKeyframe(model, data, 0)
            state = np.empty(mujoco.mj_stateSize(model, FULL))
            mujoco.mj_getState(model, data, state, FULL)
            self.starts.append(state)

    def rollout(self) -> list[Floats]:
        """Each jump's states, by MuJoCo's compiled loop."""
        states = []
        for model, data, start, torque in zip(self.models, self.data, self.starts, self.torques, strict=True):
            mujoco.mj_resetDataKeyframe(model, data, 0)
            states.append(mujoco.rollout.rollout(model, data, start, torque)[0])
        return states

    def heights(self) -> Floats:
        """Highest base height of each jump, shape (n, 1); the state is time, qpos, qvel."""
        return np.array([[max(0.5, states[0, :, 2].max())] for states in self.rollout()])

    def python_loop(self) -> None:
        """The same steps by a Python loop."""
        for model, data, torque in zip(self.models, self.data, self.torques, strict=True):
            mujoco.mj_resetDataKeyframe(model, data, 0)
            ctrl = data.ctrl
            for values in torque:
                ctrl[:] = values
                mujoco.mj_step(model, data)


def _naive(document: str, design: Floats, robots: RobotArrays, i: int, calibration: Calibration) -> Jump:
    """Compile the XML and jump in plain Python."""
    gate = calibration.gate
    assert isinstance(gate, FadeGate)
    stiffness, damping, torsion = columns(design, PAPER_CONTROL).tolist()
    motors = motors_of(robots, i, calibration)
    return jump(document, stiffness, damping, torsion, motors, fade=gate.length_m, read_back=True)


def _ratio(these: list[float], those: list[float]) -> float:
    """The median of the rounds' ratios."""
    return statistics.median(a / b for a, b in zip(these, those, strict=True))


def _same(name: str, values: Floats, *expected: Floats) -> None:
    worst = np.max(np.abs(values / np.stack(expected, axis=1) - 1.0))
    if not worst < AGREEMENT:
        raise SystemExit(f"{name} disagrees by {worst:.2g}: no ratio is printed")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 7)
