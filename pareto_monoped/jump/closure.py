"""How well the energy balances of many jumps close, all stepped at once.

``balance.energy_balance`` says where the energy of one jump went. The audit of a front needs only what remains open,
for hundreds of jumps. That takes the sum of all constraint forces and no entry for the integrator, and all jumps step
together.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.jump.balance import HIP, back_s, energy_balance
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.population import Population, prepare
from pareto_monoped.jump.pose import start_pose
from pareto_monoped.jump.rows import take
from pareto_monoped.robot.population import RobotArrays

Floats = NDArray[np.float64]


def balance_errors(robots: RobotArrays, control: Floats, calibration: Calibration, workers: int = 1) -> Floats:
    """``EnergyBalance.error`` of the jumps of n robots that can stand, shape (n,).

    Args:
        robots: n robots.
        control: of each, see ``design.complete_control``.
        calibration: the jump model.
        workers: threads.
    """
    everyone = range(len(robots))
    if calibration.simulation.integrator == "RK4":
        # Its steps leave the forces of their last stage, not those of the state.
        single = (take(robots, np.array([i])) for i in everyone)
        return np.array([energy_balance(one, control[i : i + 1], calibration).error for i, one in enumerate(single)])
    pose = start_pose(robots, calibration)
    population = prepare(robots, control, pose, calibration, workers)
    damping = np.asarray(population.batch.expand("dof_damping"))
    start = np.array(population.batch.bind("qpos"))
    supplied, lost, qpos, qvel = _jumped(population, calibration, damping)
    weighed = prepare(robots, control, pose, calibration, workers).batch
    gained = _energies_j(weighed, qpos - back_s(calibration) * qvel, qvel) - _energies_j(weighed, start, 0.0)
    return np.abs(supplied - gained - lost) / np.maximum(np.abs(supplied), 1e-12)


def _jumped(population: Population, calibration: Calibration, damping: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Step all jumps to their ends.

    Args:
        population: n jumps, which have not begun.
        calibration: the jump model.
        damping: of the joints, shape (n, nv).

    Returns:
        The joints' work and what dampers and constraints took of it, in joules, shape (n,); positions and speeds at the
        end, shape (n, nv).
    """
    from pareto_monoped.jump.callback import controlled
    from pareto_monoped.jump.controller import FLYING

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
            batch.step(ids, 1)
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
