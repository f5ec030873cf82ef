"""The energy balance from the start of a jump to its apex: in full for one jump, and what remains open for many.

The audit of a front needs only what remains open, for hundreds of jumps. This takes the sum of all constraint forces
and no entry for the integrator, so all jumps step together.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import Floats
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.end_stops import end_stops, slow_torque_n_m
from pareto_monoped.jump.model import coordinates, gear_efficiency, joint_places, motor_places, start_pose
from pareto_monoped.jump.population import Population, prepare, states, threads_for
from pareto_monoped.jump.quiet import quiet
from pareto_monoped.jump.single import Moment, Then, constraint_forces, moments
from pareto_monoped.jump.variations import take
from pareto_monoped.robot.population import RobotArrays

_AT_ONCE = 32
"""Steps whose speeds and forces are kept together. A jump wastes half of this at its end: a hundredth of its steps."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EnergyBalance:
    """Where the work of the motors went, in joules."""

    motor_work_j: float  #: of both motors, less what they absorbed
    #: mesh_loss_j, chain_loss_j: lost in the gearboxes and in the chain
    mesh_loss_j: float
    chain_loss_j: float
    bodies_kinetic_j: float  #: change of the kinetic energy of the bodies, each moving as one piece
    rotors_kinetic_j: float  #: change of what the turning parts have beyond that
    potential_j: float  #: change of the potential energy
    #: drives_absorbed_j, drives_stored_j: lost in elastic drives, and what their springs hold at the end
    drives_absorbed_j: float
    drives_stored_j: float
    #: damping_j, friction_j: lost to viscous and Coulomb friction of the joints
    damping_j: float
    friction_j: float
    rails_j: float  #: lost to the friction of a stand's carriages
    stops_absorbed_j: float  #: lost in the end stops
    stops_stored_j: float  #: what their bumpers still hold
    contact_j: float  #: lost at the foot, in its rubber and by slip
    #: Lost by the integrator, which takes Coriolis and centrifugal forces at the speeds before a step and not at the
    #: mean speeds of the step
    integration_j: float

    @property
    def joint_work_j(self) -> float:
        """Work of the torques that reach the joints."""
        return self.motor_work_j - self.mesh_loss_j - self.chain_loss_j

    @property
    def residual_j(self) -> float:
        """The joints' work that the other terms do not explain."""
        moving = self.bodies_kinetic_j + self.rotors_kinetic_j + self.potential_j
        stops = self.stops_absorbed_j + self.stops_stored_j + self.drives_absorbed_j + self.drives_stored_j
        lost = self.damping_j + self.friction_j + self.rails_j + self.contact_j + self.integration_j
        return self.joint_work_j - moving - stops - lost

    @property
    def error(self) -> float:
        """What physics leaves open, as a share of the joints' work: the residual with what the integrator loses."""
        return abs(self.residual_j + self.integration_j) / max(abs(self.joint_work_j), 1e-12)


def energy_balance(
    robots: RobotArrays, control: Floats, calibration: Calibration, then: Then | None = None
) -> EnergyBalance:
    """Return where the energy of the first robot's jump went, and of what it goes on with (``single.moments``).

    The work of a force in a step is the force times the mean of the speeds before and after the step. With constant
    inertia this is exactly the change of kinetic energy that the force causes in MuJoCo's semi-implicit step. In a
    Runge-Kutta step only the actuators' force is constant; the others count with the mean of their values at both ends.
    """
    names = ("motor", "damping", "friction", "rails", "stops", "contact", "drives", "integration")
    work = dict.fromkeys(names, 0.0)
    motors, joints = motor_places(calibration), joint_places(calibration)
    rails = coordinates(calibration).index("slide_z")
    mesh, chain = np.zeros(2), np.zeros(2)
    mesh_share = _mesh_share(robots, calibration)
    first: Moment | None = None
    moved: Floats | float = 0.0
    for moment in moments(robots, control, calibration, then):
        first = first or moment
        if moment.last:
            break
        before, moved = moved, _moved(moment, calibration)
        motor = np.array(moment.record["motor_torque_n_m"]) * moved[motors]
        lost = motor - moment.data.ctrl[:2] * moved[motors]
        work["motor"] += float(motor.sum())
        mesh += mesh_share * lost
        chain += (1.0 - mesh_share) * lost
        mean = 0.5 * (before + moved) if calibration.simulation.integrator == "RK4" else moved
        friction, stops, contact = constraint_forces(moment.data)
        work["damping"] += float((moment.model.dof_damping * _damped(moment, calibration)) @ mean)
        work["friction"] -= float(friction[motors] @ mean[motors])
        work["rails"] -= float(friction[rails] * mean[rails])
        work["stops"] -= float(stops @ mean)
        if len(moment.data.ctrl) > 2:
            work["stops"] -= float(moment.data.ctrl[2:] @ mean[joints])
        if calibration.drive.elastic:
            rate = moment.qvel[motors] - moment.qvel[joints]
            work["drives"] += float((moment.model.tendon_damping[:2] * rate) @ (mean[motors] - mean[joints]))
        work["contact"] -= float(contact @ mean)
        work["integration"] += _integration_loss_j(moment, calibration, moved)
    assert first is not None
    start, end = (_energies(robots, calibration, each) for each in (first, moment))
    bodies, rotors, potential, stored, wound = end - start
    return EnergyBalance(
        motor_work_j=work["motor"],
        mesh_loss_j=float(mesh.sum()),
        chain_loss_j=float(chain.sum()),
        bodies_kinetic_j=float(bodies),
        rotors_kinetic_j=float(rotors),
        potential_j=float(potential),
        drives_absorbed_j=work["drives"],
        drives_stored_j=float(wound),
        damping_j=work["damping"],
        friction_j=work["friction"],
        rails_j=work["rails"],
        stops_absorbed_j=work["stops"] - float(stored),
        stops_stored_j=float(stored),
        contact_j=work["contact"],
        integration_j=work["integration"],
    )


def _moved(moment: Moment, calibration: Calibration) -> Floats:
    """Return how far the joints move in a step, as its work is booked, shape (nv,)."""
    if calibration.simulation.integrator == "RK4":
        return np.asarray(moment.after.qpos - moment.qpos)
    return np.asarray(0.5 * (moment.qvel + moment.after.qvel) * calibration.simulation.timestep_s)


def _damped(moment: Moment, calibration: Calibration) -> Floats:
    """The speed at which the integrator evaluates joint damping: MuJoCo's Euler step takes that after the step."""
    match calibration.simulation.integrator:
        case "Euler":
            return np.asarray(moment.after.qvel)
        case "RK4":
            return moment.qvel
    return np.asarray(0.5 * (moment.qvel + moment.after.qvel))


def _integration_loss_j(moment: Moment, calibration: Calibration, moved: Floats) -> float:
    """Work of Coriolis and centrifugal forces at the speeds before a step, beyond that at the step's mean speeds."""
    import mujoco

    if calibration.simulation.integrator == "RK4":
        return 0.0
    model, data = moment.model, moment.scratch
    forces = []
    for speed in (moment.qvel, 0.5 * (moment.qvel + moment.after.qvel)):
        data.qpos[:], data.qvel[:] = moment.qpos, speed
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        forces.append(data.qfrc_bias.copy())
    return float((forces[0] - forces[1]) @ moved)


def _mesh_share(robots: RobotArrays, calibration: Calibration) -> Floats:
    """Return the share of each drive's loss that its gearbox has; the chain, behind it, has the rest. Shape (2,)."""
    mesh = gear_efficiency(robots, calibration.drive)[0]
    chain = np.array([1.0, calibration.drive.chain_efficiency])
    lost = 1.0 - mesh * chain
    shares: Floats = np.divide(1.0 - mesh, lost, out=np.zeros(2), where=lost > 0.0)
    return shares


def back_s(calibration: Calibration) -> float:
    """Return how long before a state's speeds its positions are taken, see ``Simulation.positions_read``."""
    return 0.5 * calibration.simulation.timestep_s if calibration.simulation.positions_read != "state" else 0.0


def _energies(robots: RobotArrays, calibration: Calibration, moment: Moment) -> Floats:
    """Return kinetic energy of bodies and rotors, potential energy, what end stops and drives store, at a state."""
    import mujoco

    model, data = moment.model, moment.scratch
    data.qpos[:], data.qvel[:] = moment.qpos - back_s(calibration) * moment.qvel, moment.qvel
    mujoco.mj_forward(model, data)
    mujoco.mj_energyPos(model, data)
    mujoco.mj_energyVel(model, data)
    potential, kinetic = data.energy
    hip, knee = joint_places(calibration)
    rotors = _rotors_kinetic_j(robots, calibration, moment.qvel[hip], moment.qvel[motor_places(calibration)])
    stored, wound = _stored_j(robots, calibration, data.qpos[[hip, knee]]), 0.0
    if calibration.drive.elastic:
        play = 0.5 * calibration.drive.backlash_rad
        turned = np.maximum(np.abs(data.ten_length[:2]) - play, 0.0)
        wound = float(0.5 * model.tendon_stiffness[:2] @ np.square(turned))
    return np.array([kinetic - rotors, rotors, potential - wound, stored, wound])


def _rotors_kinetic_j(robots: RobotArrays, calibration: Calibration, thigh: float, speed: Floats) -> float:
    """Return what the turning parts have beyond the motion of the bodies that carry them, see ``robot.tables``.

    The thigh turns with the speed ``thigh``, and the motors with ``speed``, shape (2,), as speeds of their joints.
    """
    hip, knee = speed
    armature = robots.armature_kg_m2[0]
    if calibration.joints.rotors == "armature":
        return float(0.5 * armature @ np.square(speed))
    reflected, coupling = robots.knee_reflected_kg_m2[0], robots.knee_coupling_kg_m2[0]
    riding = 0.5 * (armature[0] * hip**2 + robots.rotor_excess_kg_m2[0] * thigh**2)
    return float(riding + coupling * thigh * knee + 0.5 * reflected * knee**2)


def _stored_j(robots: RobotArrays, calibration: Calibration, angles: Floats) -> float:
    """Work of a slow relief of both end stops, by the trapezoidal rule."""
    stored = 0.0
    parts = (robots.stops.hip, robots.stops.knee)
    for part, stop, angle in zip(parts, end_stops(robots, calibration.joints), angles, strict=True):
        if stop is not None:
            beyond = np.linspace(0.0, max(0.0, stop.lower_rad - angle, angle - stop.upper_rad), 1001)
            own = calibration.joints.stop_law == "hunt_crossley"
            torque = part.torque_n_m(beyond) if own else slow_torque_n_m(stop, beyond)
            stored += float(np.trapezoid(torque, beyond))
    return stored


@dataclass(frozen=True, slots=True, kw_only=True)
class Balanced:
    """Jumps of n robots with what their energy balances leave open."""

    ok: NDArray[np.bool_]  #: which of them reached the apex, shape (n,)
    #: height_m, energy_j: as in ``Evaluations``, shape (n,); meaningless where the jump failed
    height_m: Floats
    energy_j: Floats
    error: Floats  #: ``EnergyBalance.error``, shape (n,)


@quiet()
def balanced(robots: RobotArrays, control: Floats, calibration: Calibration, workers: int = 1) -> Balanced:
    """Return the jumps of n robots that can stand, with their balances."""
    if calibration.simulation.integrator == "RK4":
        # Its steps leave the forces of their last stage, not those of the state.
        population = prepare(robots, control, start_pose(robots, calibration), calibration, workers)
        population.run()
        alone = (take(robots, np.array([i])) for i in range(len(robots)))
        errors = [energy_balance(one, control[i : i + 1], calibration).error for i, one in enumerate(alone)]
        return _finished(population, np.array(errors))
    pose = start_pose(robots, calibration)
    threads = threads_for(len(robots), workers)
    population = prepare(robots, control, pose, calibration, threads)
    damping = np.asarray(population.batch.expand("dof_damping"))
    start = np.array(population.batch.bind("qpos"))
    supplied, lost, qpos, qvel = _jumped(population, calibration, damping)
    weighed = prepare(robots, control, pose, calibration, threads).batch
    gained = _energies_j(weighed, qpos - back_s(calibration) * qvel, qvel) - _energies_j(weighed, start, 0.0)
    return _finished(population, np.abs(supplied - gained - lost) / np.maximum(np.abs(supplied), 1e-12))


def _finished(population: Population, error: Floats) -> Balanced:
    from pareto_monoped.jump.controller import APEX

    records = population.records
    energy_j = records["energy_j"].sum(axis=1)
    return Balanced(
        ok=(records["status"] == APEX) & (energy_j > 0.0),
        height_m=np.array(records["height_m"]),
        energy_j=energy_j,
        error=error,
    )


def _jumped(population: Population, calibration: Calibration, damping: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Step all jumps to their ends; a jump in which MuJoCo raises an error or warns ends as diverged.

    ``damping`` of the joints has shape (n, nv). Return the joints' work and what dampers and constraints took of it, in
    joules, shape (n,), and positions and speeds at the end, shape (n, nv).
    """
    from mujoco.batch import SimulationError

    from pareto_monoped.jump.callback import controlled, untimed
    from pareto_monoped.jump.controller import DIVERGED, FLYING

    batch, records = population.batch, population.records
    status, steps, qvel = records["status"], records["steps"], batch.bind("qvel")
    motors, joints = motor_places(calibration), joint_places(calibration)
    springs = np.asarray(batch.expand("tendon_damping"))[:, None, :2] if calibration.drive.elastic else None
    supplied, lost = np.zeros((2, len(status)))
    sizes = {"qvel": batch.model.nv, "ctrl": batch.model.nu, "qfrc_constraint": batch.model.nv}
    room = {name: np.zeros((len(status), _AT_ONCE, size)) for name, size in sizes.items()}
    ids = np.arange(len(status))
    with controlled(), untimed():
        while len(ids):
            first, counted = qvel[ids, None], steps[ids]
            seen = {name: values[: len(ids)] for name, values in room.items()}
            try:
                batch.rollout(_AT_ONCE, record=tuple(seen), ids=ids, out=seen)
            except SimulationError as problem:
                status[problem.ids] = DIVERGED
            # A simulation that MuJoCo warns of stops, and it counts the warnings of the last call alone.
            status[ids[batch.warning[ids, :, 1].any(axis=1)]] = DIVERGED
            running = status[ids] <= FLYING
            after, ctrl, constraint = seen.values()
            before = np.concatenate((first, after[:, :-1]), axis=1)
            mean = 0.5 * (before + after)
            damped = after if calibration.simulation.integrator == "Euler" else mean
            moved = calibration.simulation.timestep_s * mean
            gave = np.sum(ctrl[..., :2] * moved[..., motors], axis=2)
            took = [np.sum((damping[ids, None] * damped - constraint) * moved, axis=2)]
            took.append(-np.sum(ctrl[..., 2:] * moved[..., joints[: ctrl.shape[2] - 2]], axis=2))
            if springs is not None:
                rate, wound = (each[..., motors] - each[..., joints] for each in (before, moved))
                took.append(np.sum(springs[ids] * rate * wound, axis=2))
            # The controller ends a jump at the beginning of a step, which then does not count, as those after it.
            made = np.arange(_AT_ONCE) < (steps[ids] - counted - ~running)[:, None]
            supplied[ids] = _added(supplied[ids], [gave], made)
            lost[ids] = _added(lost[ids], took, made)
            ids = ids[running]
    return supplied, lost, *states(records, calibration)


def _added(total: Floats, parts: Sequence[Floats], made: NDArray[np.bool_]) -> Floats:
    """Add parts of shape (n, steps) to totals, one after the other, so that no bit depends on how many are together."""
    parts_in_turn = np.where(made[..., None], np.stack(parts, axis=2), 0.0).reshape(len(total), -1)
    return np.cumsum(np.column_stack((total, parts_in_turn)), axis=1)[:, -1]


def _energies_j(batch: Any, qpos: Floats, qvel: Floats | float) -> Floats:
    """Return kinetic and potential energy of the simulations of a batch at given states, shape (n,)."""
    import mujoco

    batch.expand("opt.enableflags")[:] = int(mujoco.mjtEnableBit.mjENBL_ENERGY)
    energy = batch.bind("energy")  # before the call that fills it
    batch.bind("qpos")[:], batch.bind("qvel")[:] = qpos, qvel
    batch.forward()
    return np.asarray(energy.sum(axis=1))
