"""How well the energy balances of many jumps close, all stepped at once.

``balance.energy_balance`` says where the energy of one jump went. The audit of a front needs only what remains open,
for hundreds of jumps. That takes the sum of all constraint forces and no entry for the integrator, and all jumps step
together.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.jump.balance import HIP, back_s, energy_balance
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.population import Population, prepare
from pareto_monoped.jump.pose import start_pose
from pareto_monoped.jump.quiet import quiet
from pareto_monoped.jump.rows import take
from pareto_monoped.robot.population import RobotArrays

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Balanced:
    """Jumps of n robots with what their energy balances leave open.

    Attributes:
        ok: which of them reached the apex, shape (n,).
        height_m, energy_j: as in ``Evaluations``, shape (n,); meaningless where the jump failed.
        error: ``EnergyBalance.error``, shape (n,).
    """

    ok: NDArray[np.bool_]
    height_m: Floats
    energy_j: Floats
    error: Floats


def balance_errors(robots: RobotArrays, control: Floats, calibration: Calibration, workers: int = 1) -> Floats:
    """``EnergyBalance.error`` of the jumps of n robots that can stand, shape (n,).

    Args:
        robots: n robots.
        control: of each, see ``design.complete_control``.
        calibration: the jump model.
        workers: threads.
    """
    if calibration.simulation.integrator == "RK4":
        # Its steps leave the forces of their last stage, not those of the state.
        single = (take(robots, np.array([i])) for i in range(len(robots)))
        return np.array([energy_balance(one, control[i : i + 1], calibration).error for i, one in enumerate(single)])
    return balanced(robots, control, calibration, workers).error


@quiet()
def balanced(robots: RobotArrays, control: Floats, calibration: Calibration, workers: int = 1) -> Balanced:
    """The jumps of n robots that can stand, with their balances; not for the integrator RK4.

    Args:
        robots: n robots.
        control: of each, see ``design.complete_control``.
        calibration: the jump model.
        workers: threads.
    """
    from pareto_monoped.jump.controller import APEX

    pose = start_pose(robots, calibration)
    population = prepare(robots, control, pose, calibration, workers)
    damping = np.asarray(population.batch.expand("dof_damping"))
    start = np.array(population.batch.bind("qpos"))
    supplied, lost, qpos, qvel = _jumped(population, calibration, damping)
    weighed = prepare(robots, control, pose, calibration, workers).batch
    gained = _energies_j(weighed, qpos - back_s(calibration) * qvel, qvel) - _energies_j(weighed, start, 0.0)
    records = population.records
    energy_j = records["energy_j"].sum(axis=1)
    return Balanced(
        ok=(records["status"] == APEX) & (energy_j > 0.0),
        height_m=np.array(records["height_m"]),
        energy_j=energy_j,
        error=np.abs(supplied - gained - lost) / np.maximum(np.abs(supplied), 1e-12),
    )


def _jumped(population: Population, calibration: Calibration, damping: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Step all jumps to their ends.

    Args:
        population: n jumps, which have not begun.
        calibration: the jump model.
        damping: of the joints, shape (n, nv).

    A jump in which MuJoCo raises an error or warns ends as diverged.

    Returns:
        The joints' work and what dampers and constraints took of it, in joules, shape (n,); positions and speeds at the
        end, shape (n, nv).
    """
    from mujoco.batch import SimulationError

    from pareto_monoped.jump.callback import controlled
    from pareto_monoped.jump.controller import DIVERGED, FLYING

    batch, status = population.batch, population.records["status"]
    qpos, qvel = batch.bind("qpos"), batch.bind("qvel")
    torque, constraint = batch.bind("qfrc_actuator"), batch.bind("qfrc_constraint")
    supplied, lost = np.zeros((2, len(status)))
    last_qpos, last_qvel = np.array(qpos), np.array(qvel)
    ids = np.arange(len(status))
    with controlled():
        while len(ids):
            before = qvel[ids]
            last_qpos[ids], last_qvel[ids] = qpos[ids], before
            try:
                batch.step(ids, 1)
            except SimulationError as problem:
                status[problem.ids] = DIVERGED
            # MuJoCo resets a simulation that it warns of, and counts the warnings of the last call alone.
            status[ids[batch.warning[ids, :, 1].any(axis=1)]] = DIVERGED
            # The controller ends a jump at the beginning of a step, which then does not count.
            running = status[ids] <= FLYING
            ids, before = ids[running], before[running]
            mean = 0.5 * (before + qvel[ids])
            damped = qvel[ids] if calibration.simulation.integrator == "Euler" else mean
            moved = calibration.simulation.timestep_s * mean
            supplied[ids] += np.sum(torque[ids][:, HIP:] * moved[:, HIP:], axis=1)
            lost[ids] += np.sum((damping[ids] * damped - constraint[ids]) * moved, axis=1)
    return supplied, lost, last_qpos, last_qvel


def _energies_j(batch: Any, qpos: Floats, qvel: Floats | float) -> Floats:
    """Kinetic and potential energy of the simulations of a batch at given states, shape (n,)."""
    import mujoco

    batch.expand("opt.enableflags")[:] = int(mujoco.mjtEnableBit.mjENBL_ENERGY)
    energy = batch.bind("energy")  # before the call that fills it
    batch.bind("qpos")[:], batch.bind("qvel")[:] = qpos, qvel
    batch.forward()
    return np.asarray(energy.sum(axis=1))
