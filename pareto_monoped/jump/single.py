"""One jump, step by step: the trace, which a batch does not record.

The loop runs plain ``mj_step`` on the exported MJCF with the compiled controller, and makes the batch's jump to the
bit.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from pareto_monoped.actuator.ratiomap import Maps
from pareto_monoped.design import GRAVITY_M_PER_S2, Design, Floats, control_of
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.controller_record import origin
from pareto_monoped.jump.document import mjcf
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.model import coordinates, stand_mass_kg
from pareto_monoped.jump.quiet import quiet
from pareto_monoped.measures import MEASURE_NAMES
from pareto_monoped.robot.population import RobotArrays, robot_arrays
from pareto_monoped.robot.units import JOINTS

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
    """One jump."""

    design: Design  #: the design that jumped
    calibration: str  #: name and version of the calibration
    #: status, reason: as in ``Evaluations``
    status: str
    reason: str
    measures: dict[str, float]  #: name to value of every measure of ``Evaluations``
    #: ``TRACE_COLUMNS`` to values, shape (steps,); empty if not asked for or if the robot could not start
    trace: dict[str, Floats]


def simulate(design: Design, maps: Maps, calibration: Calibration, *, trace: bool = False) -> JumpResult:
    """Jump once by MuJoCo, with the gearboxes of both joints or of hip and knee; ``trace`` records every step."""
    values = design.as_array()[None, :]
    evaluations = Evaluator(maps, calibration.by("mujoco"))(values)
    rows: dict[str, Floats] = {}
    if trace and evaluations.status[0] not in ("bad_input", "no_gearbox", "cannot_stand"):
        robots = robot_arrays(values, maps, calibration.mass)
        rows = trace_of(robots, control_of(values), calibration)
    return JumpResult(
        design=design,
        calibration=calibration.label,
        status=str(evaluations.status[0]),
        reason=evaluations.reason[0],
        measures={name: float(getattr(evaluations, name)[0]) for name in MEASURE_NAMES},
        trace=rows,
    )


@dataclass(slots=True, kw_only=True)
class Moment:
    """One state of the loop and the step that starts there."""

    model: Any  #: MuJoCo's model
    data: Any  #: MuJoCo's derived quantities of the state, and the torques held during the step
    after: Any  #: MuJoCo's data after the step
    #: qpos, qvel: the state
    qpos: Floats
    qvel: Floats
    record: Any  #: the controller's record at that state
    scratch: Any  #: data of the same model for whatever else is to be computed
    last: bool  #: whether the jump ends here, without a step


Then = Callable[[Any], Any]  #: From records of jumps that have ended to those with which they go on; None: not at all.


def moments(
    robots: RobotArrays, control: Floats, calibration: Calibration, then: Then | None = None
) -> Iterator[Moment]:
    """Step the first robot to the end of its jump, and on as long as ``then`` has another record.

    MuJoCo computes the derived quantities of a state at the start of the step, and most integrators leave them in its
    data. A Runge-Kutta step leaves those of its last stage, so for it they are computed in a second ``MjData``.
    """
    import mujoco

    from pareto_monoped.jump.controller import FLYING
    from pareto_monoped.jump.population import first_records

    act = _controller(origin())
    model = mujoco.MjModel.from_xml_string(mjcf(robots, calibration))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    records = first_records(robots, control, calibration)
    record = records[0]
    derived = data if record["stages"] == 1.0 else mujoco.MjData(model)
    scratch = mujoco.MjData(model)
    # This loop calls the controller once per step, whatever the integrator.
    record["stages"] = 1.0
    with quiet():
        while True:
            qpos, qvel = data.qpos.copy(), data.qvel.copy()
            act(qpos, qvel, data.ctrl, record)
            while record["status"] > FLYING and then is not None and (others := then(records)) is not None:
                records = others
                record = records[0]
                record["stages"] = 1.0
                act(qpos, qvel, data.ctrl, record)
            running = record["status"] <= FLYING
            if derived is not data:
                derived.qpos[:], derived.qvel[:], derived.ctrl[:] = qpos, qvel, data.ctrl
            if not running or derived is not data:
                mujoco.mj_forward(model, derived)
            if running:
                mujoco.mj_step(model, data)
            yield Moment(
                model=model,
                data=derived,
                after=data,
                qpos=qpos,
                qvel=qvel,
                record=record,
                scratch=scratch,
                last=not running,
            )
            if not running:
                return


@lru_cache(maxsize=1)
def _controller(sources: int) -> Callable[[Floats, Floats, Floats, Any], None]:
    """Return the compiled controller, which closes over ``sources`` (``controller_record.origin``).

    It closes over the module: a compiled function would be another one in each process, and none be found on disk.
    """
    from pareto_monoped.compute.compiled import compiled
    from pareto_monoped.jump import controller

    @compiled
    def act(q: Floats, v: Floats, ctrl: Floats, jump: Any) -> None:
        _ = sources
        controller.control(q, v, ctrl, jump)

    return act


def trace_of(robots: RobotArrays, control: Floats, calibration: Calibration) -> dict[str, Floats]:
    """Return ``TRACE_COLUMNS`` of the first robot's jump, each of shape (steps,)."""
    import mujoco

    rows = []
    moved_kg = robots.body_mass_kg[0].sum() + stand_mass_kg(robots, calibration)[0]
    weight_n = float(moved_kg) * GRAVITY_M_PER_S2
    radius = float(robots.foot_radius_m[0])
    slides = calibration.simulation.base_slides
    z, hip, knee = (coordinates(calibration).index(name) for name in ("slide_z", *JOINTS))
    for index, moment in enumerate(moments(robots, control, calibration)):
        data, q, v = moment.data, moment.qpos, moment.qvel
        foot = data.site_xpos[0]
        force = constraint_forces(data)[2]
        matrix = np.zeros((len(v), len(v)))
        mujoco.mj_fullM(moment.model, data, matrix)
        torques = (0.0,) * 4 if moment.last else (*moment.record["motor_torque_n_m"], *data.ctrl[:2])
        base = (q[0] if slides else 0.0, q[z], v[0] if slides else 0.0, v[z])
        legs = (foot[0], foot[2], foot[2] - radius, q[hip], q[knee], v[hip], v[knee])
        floor = (force[0] if slides else float("nan"), force[z])
        energies = (0.5 * v @ matrix @ v, weight_n * float(data.subtree_com[0, 2]))
        rows.append((index * calibration.simulation.timestep_s, *base, *legs, *torques, *floor, *energies))
    return dict(zip(TRACE_COLUMNS, np.array(rows).T, strict=True))


def constraint_forces(data: Any) -> tuple[Floats, Floats, Floats]:
    """Return the generalised forces of friction in joints and rails, end stops and contacts, each of shape (nv,).

    The slide entries of the contacts' are the floor's force on the foot.
    """
    import mujoco

    kinds, kind = mujoco.mjtConstraint, data.efc_type
    pulls = data.efc_force[:, None] * data.efc_J.reshape(len(kind), len(data.qvel))
    friction, stops = kind == int(kinds.mjCNSTR_FRICTION_DOF), kind == int(kinds.mjCNSTR_LIMIT_JOINT)
    touching = (kind == int(kinds.mjCNSTR_CONTACT_PYRAMIDAL)) | (kind == int(kinds.mjCNSTR_CONTACT_ELLIPTIC))
    return pulls[friction].sum(axis=0), pulls[stops].sum(axis=0), pulls[touching].sum(axis=0)
