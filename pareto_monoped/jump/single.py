"""One jump, step by step: the trace and the energy balance, which a batch does not record.

The loop runs plain ``mj_step`` on the exported MJCF with the torques of the compiled controller. It makes the same jump
as the batch, to the last bit.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.design import CONTROL, GRAVITY_M_PER_S2, Design, columns
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.evaluate import Evaluations, Evaluator
from pareto_monoped.jump.model import mjcf
from pareto_monoped.measures import MEASURE_NAMES
from pareto_monoped.robot.population import RobotArrays, robot_arrays

Floats = NDArray[np.float64]

TRACE_COLUMNS = (
    "time_s", "base_x_m", "base_z_m", "base_x_m_per_s", "base_z_m_per_s",
    "foot_x_m", "foot_z_m", "foot_clearance_m", "hip_rad", "knee_rad", "hip_rad_per_s", "knee_rad_per_s",
    "hip_motor_torque_n_m", "knee_motor_torque_n_m", "hip_torque_n_m", "knee_torque_n_m",
    "contact_x_n", "contact_z_n", "kinetic_j", "potential_j",
)  # fmt: skip
"""Columns of a trace, one row per step: the state at the start of the step; the torques held during the step, at the
joint before and after losses; the floor's force on the foot; the robot's energy."""


@dataclass(frozen=True, slots=True, kw_only=True)
class JumpResult:
    """One jump.

    Attributes:
        design: the design that jumped.
        calibration: name and version of the calibration.
        status, reason: as in ``Evaluations``.
        measures: name to value of every measure of ``Evaluations``.
        trace: ``TRACE_COLUMNS`` to values, shape (steps,); empty if not asked for or if the robot could not start.
    """

    design: Design
    calibration: str
    status: str
    reason: str
    measures: dict[str, float]
    trace: dict[str, Floats]


@dataclass(frozen=True, slots=True, kw_only=True)
class EnergyBalance:
    """Where the work of one jump went, in joules, from the start to the apex.

    Attributes:
        actuator_work_j: work of the torques that reach the joints.
        kinetic_j, potential_j: change of the robot's energy.
        damping_j, friction_j: lost to viscous and Coulomb friction of the joints.
        stops_j: absorbed by the end stops, including what they still store.
        contact_j: lost at the foot, in its rubber and by slip.
    """

    actuator_work_j: float
    kinetic_j: float
    potential_j: float
    damping_j: float
    friction_j: float
    stops_j: float
    contact_j: float

    @property
    def residual_j(self) -> float:
        """The actuator work that the other terms do not explain."""
        spent = self.kinetic_j + self.potential_j + self.damping_j + self.friction_j + self.stops_j + self.contact_j
        return self.actuator_work_j - spent

    @property
    def error(self) -> float:
        """The residual as a share of the actuator work."""
        return abs(self.residual_j) / max(abs(self.actuator_work_j), 1e-12)


def simulate(design: Design, actuator_map: ActuatorMap, calibration: Calibration, *, trace: bool = False) -> JumpResult:
    """Jump once.

    Args:
        design: the design.
        actuator_map: the gearboxes.
        calibration: the jump model.
        trace: whether to record every step.
    """
    values = design.as_array()[None, :]
    evaluations = Evaluator(actuator_map, calibration)(values)
    rows: dict[str, Floats] = {}
    if trace and evaluations.status[0] not in ("bad_input", "no_gearbox", "cannot_stand"):
        robots = robot_arrays(values, actuator_map, calibration.mass)
        rows = trace_of(robots, columns(values, CONTROL), calibration)
    return result_of(design, calibration, evaluations, rows)


def result_of(
    design: Design, calibration: Calibration, evaluations: Evaluations, trace: dict[str, Floats]
) -> JumpResult:
    """The first row of ``evaluations`` as a single result."""
    return JumpResult(
        design=design,
        calibration=calibration.label,
        status=str(evaluations.status[0]),
        reason=evaluations.reason[0],
        measures={name: float(getattr(evaluations, name)[0]) for name in MEASURE_NAMES},
        trace=trace,
    )


@dataclass(slots=True, kw_only=True)
class _Moment:
    """One state of the loop and the step that starts there.

    Attributes:
        model: MuJoCo's model.
        data: MuJoCo's derived quantities of the state, and the torques held during the step.
        after: MuJoCo's data after the step.
        qpos, qvel: the state.
        record: the controller's record at that state.
        last: whether the jump ends here, without a step.
    """

    model: Any
    data: Any
    after: Any
    qpos: Floats
    qvel: Floats
    record: Any
    last: bool


def _moments(robots: RobotArrays, control: Floats, calibration: Calibration) -> Iterator[_Moment]:
    """Step the first robot to the end of its jump.

    MuJoCo computes the derived quantities of a state at the start of the step, and most integrators leave them in its
    data. A Runge-Kutta step leaves those of its last stage, so for it they are computed in a second ``MjData``.
    """
    import mujoco

    from pareto_monoped.jump.controller import FLYING
    from pareto_monoped.jump.controller import control as act
    from pareto_monoped.jump.population import first_records

    model = mujoco.MjModel.from_xml_string(mjcf(robots, calibration))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    record = first_records(robots, control, calibration)[0]
    derived = data if record["stages"] == 1.0 else mujoco.MjData(model)
    # This loop calls the controller once per step, whatever the integrator.
    record["stages"] = 1.0
    while True:
        qpos, qvel = data.qpos.copy(), data.qvel.copy()
        act(qpos, qvel, data.ctrl, record)
        running = record["status"] <= FLYING
        if derived is not data:
            derived.qpos[:], derived.qvel[:], derived.ctrl[:] = qpos, qvel, data.ctrl
        if not running or derived is not data:
            mujoco.mj_forward(model, derived)
        if running:
            mujoco.mj_step(model, data)
        yield _Moment(model=model, data=derived, after=data, qpos=qpos, qvel=qvel, record=record, last=not running)
        if not running:
            return


def trace_of(robots: RobotArrays, control: Floats, calibration: Calibration) -> dict[str, Floats]:
    """``TRACE_COLUMNS`` of the first robot's jump, each of shape (steps,)."""
    import mujoco

    rows = []
    weight_n = float(robots.body_mass_kg[0].sum()) * GRAVITY_M_PER_S2
    radius = float(robots.foot_radius_m[0])
    for index, moment in enumerate(_moments(robots, control, calibration)):
        data, q, v = moment.data, moment.qpos, moment.qvel
        slides = len(q) == 4
        foot = data.site_xpos[0]
        force = _contact_force(data)
        matrix = np.zeros((len(v), len(v)))
        mujoco.mj_fullM(moment.model, data, matrix)
        torques = (0.0,) * 4 if moment.last else (*moment.record["motor_torque_n_m"], *data.ctrl)
        rows.append(
            (
                index * calibration.simulation.timestep_s,
                q[0] if slides else 0.0,
                q[-3],
                v[0] if slides else 0.0,
                v[-3],
                foot[0],
                foot[2],
                foot[2] - radius,
                q[-2],
                q[-1],
                v[-2],
                v[-1],
                *torques,
                force[0] if slides else float("nan"),
                force[-3],
                0.5 * v @ matrix @ v,
                weight_n * float(data.subtree_com[0, 2]),
            )
        )
    return dict(zip(TRACE_COLUMNS, np.array(rows).T, strict=True))


def energy_balance(robots: RobotArrays, control: Floats, calibration: Calibration) -> EnergyBalance:
    """Where the work of the first robot's jump went.

    The work of a force in a step is the force times the mean of the speeds before and after the step. With constant
    inertia this is exactly the change of kinetic energy that the force causes in MuJoCo's semi-implicit step. In a
    Runge-Kutta step only the actuators' force is constant; the others count with the mean of their values at both ends.
    """
    import mujoco

    step = calibration.simulation.timestep_s
    work = dict.fromkeys(("actuator", "damping", "friction", "stops", "contact"), 0.0)
    energies: list[Floats] = []
    by_stages, moved = calibration.simulation.integrator == "RK4", 0.0
    for moment in _moments(robots, control, calibration):
        model, data = moment.model, moment.data
        if moment.last or not energies:
            ends = mujoco.MjData(model)
            ends.qpos[:], ends.qvel[:] = moment.qpos, moment.qvel
            mujoco.mj_forward(model, ends)
            mujoco.mj_energyPos(model, ends)
            mujoco.mj_energyVel(model, ends)
            energies.append(ends.energy.copy())
        if moment.last:
            break
        before, after = moved, moment.after.qvel
        moved = moment.after.qpos - moment.qpos if by_stages else 0.5 * (moment.qvel + after) * step
        work["actuator"] += float(data.qfrc_actuator @ moved)
        mean = 0.5 * (before + moved) if by_stages else moved
        # MuJoCo's Euler step evaluates joint damping at the speed after the step.
        damped = {"Euler": after, "RK4": moment.qvel}.get(
            calibration.simulation.integrator, 0.5 * (moment.qvel + after)
        )
        work["damping"] += float((model.dof_damping * damped) @ mean)
        work["friction"] -= float(_force(data, (mujoco.mjtConstraint.mjCNSTR_FRICTION_DOF,)) @ mean)
        work["stops"] -= float(_force(data, (mujoco.mjtConstraint.mjCNSTR_LIMIT_JOINT,)) @ mean)
        work["contact"] -= float(_contact_force(data) @ mean)
    potential, kinetic = energies[-1] - energies[0]
    return EnergyBalance(
        actuator_work_j=work["actuator"],
        kinetic_j=float(kinetic),
        potential_j=float(potential),
        damping_j=work["damping"],
        friction_j=work["friction"],
        stops_j=work["stops"],
        contact_j=work["contact"],
    )


def _contact_force(data: Any) -> Floats:
    """The generalised force of all contacts, shape (nv,); its slide entries are the floor's force on the foot."""
    import mujoco

    kinds = mujoco.mjtConstraint
    return _force(data, (kinds.mjCNSTR_CONTACT_PYRAMIDAL, kinds.mjCNSTR_CONTACT_ELLIPTIC))


def _force(data: Any, kinds: tuple[Any, ...]) -> Floats:
    """The generalised force of all constraints of the given kinds, shape (nv,)."""
    chosen = np.isin(data.efc_type, [int(kind) for kind in kinds])
    jacobian = data.efc_J.reshape(-1, len(data.qvel))
    return np.asarray(jacobian[chosen].T @ data.efc_force[chosen], dtype=np.float64)
