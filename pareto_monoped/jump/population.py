"""Many jumps at once on MuJoCo's public batch interface: one model, per-jump fields, one compiled controller."""

import functools
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import BASE_START_HEIGHT_M, GRAVITY_M_PER_S2
from pareto_monoped.errors import SimulationError
from pareto_monoped.jump import model
from pareto_monoped.jump.calibration import Calibration, FadeGate
from pareto_monoped.jump.pose import StartPose
from pareto_monoped.robot.population import RobotArrays

Floats = NDArray[np.float64]

# Steps between two looks at the jumps; what is stepped beyond an end is lost, half of this on average.
_STEPS_A_CALL = 16
# Evaluations of the forces in a step of MuJoCo's integrators, where it is not one.
_STAGES = {"RK4": 4}


@dataclass(slots=True, kw_only=True)
class Population:
    """The jumps of n robots under way.

    Attributes:
        batch: their simulations.
        rows: what the controller knows of each, see ``kernel``, shape (n, kernel.N_ROW); the batch's user data.
        errors: what MuJoCo raised, by jump.
    """

    batch: Any
    rows: Floats
    errors: dict[int, str] = field(default_factory=dict)

    def run(self) -> None:
        """All jumps to their end; one in which MuJoCo raises an error ends as diverged.

        Raises:
            SimulationError: MuJoCo did not call the controller; without it no jump would ever end.
        """
        from mujoco import batch

        from pareto_monoped.jump import controller as k
        from pareto_monoped.jump.callback import controlled

        status, steps = self.rows[:, k.STATUS], self.rows[:, k.STEPS]
        with controlled():
            while len(ids := np.flatnonzero(status <= k.FLYING)):
                first = ids[0]
                before = steps[first]
                try:
                    self.batch.step(ids if len(ids) < len(status) else None, _STEPS_A_CALL)
                except batch.SimulationError as problem:
                    for i in problem.ids:
                        self.errors[int(i)] = self.batch.error(int(i))
                    status[problem.ids] = k.DIVERGED
                if steps[first] == before and status[first] <= k.FLYING:
                    raise SimulationError(
                        "mjcb_control: was replaced while jumps ran; let no other thread set callbacks meanwhile"
                    )

    def complaints(self) -> list[str]:
        """What MuJoCo raised or warned of in each jump; empty where nothing."""
        import mujoco

        texts = [self.errors.get(i, "") for i in range(len(self.rows))]
        for i, kind in np.argwhere(self.batch.warning[:, :, 1] > 0):
            texts[i] = texts[i] or f"MuJoCo warned: {mujoco.mjtWarning(int(kind)).name.removeprefix('mjWARN_')}"
        return texts


def prepare(
    robots: RobotArrays, control: Floats, pose: StartPose, calibration: Calibration, threads: int = 1
) -> Population:
    """A population at rest.

    Args:
        robots: n robots that can stand.
        control: K, C and T of each, shape (n, 3).
        pose: their start pose.
        calibration: the model.
        threads: that step the simulations.
    """
    import mujoco
    from mujoco.batch import Batch

    batch = Batch(_template(calibration), len(robots), nthread=threads)
    for name, values in model.model_fields(robots, calibration).items():
        batch.expand(name)[:] = values
    inverse_body_mass, inverse_joint_mass = batch.expand("body_invweight0"), batch.expand("dof_invweight0")
    batch.set_const()
    springs = model.spring_fields(calibration, inverse_body_mass, inverse_joint_mass)
    if "geom_solref" in springs:
        batch.expand("geom_solref")[:, model.FOOT_GEOM] = springs["geom_solref"]
    if "jnt_solref" in springs:
        batch.expand("jnt_solref")[:, -2:] = springs["jnt_solref"]
    _component(batch, mujoco.mjtState.mjSTATE_QPOS)[:] = model.start_qpos(calibration, pose.hip_rad, pose.knee_rad)
    rows = _component(batch, mujoco.mjtState.mjSTATE_USERDATA)
    rows[:] = first_rows(robots, control, calibration)
    return Population(batch=batch, rows=rows)


def _component(batch: Any, component: Any) -> Floats:
    """A part of all simulations' states, as ``batch.bind`` would give it, which makes a costly ``MjData`` for shapes.

    A state is the ``mjSTATE_INTEGRATION`` of its simulation (documentation of ``mujoco.batch``): its components in the
    order of their bits.
    """
    import mujoco

    before = int(mujoco.mjtState.mjSTATE_INTEGRATION) & (int(component) - 1)
    start = mujoco.mj_stateSize(batch.model, before)
    return np.asarray(batch.state[:, start : start + mujoco.mj_stateSize(batch.model, int(component))])


@functools.lru_cache(maxsize=16)
def _template(calibration: Calibration) -> Any:
    """A model of no robot in particular: all that differs between robots is written over."""
    import mujoco

    from pareto_monoped.jump.controller import N_ROW

    return mujoco.MjModel.from_xml_string(model.template_mjcf(calibration, N_ROW))


def first_rows(robots: RobotArrays, control: Floats, calibration: Calibration) -> Floats:
    """What the controller knows of each jump before the first step, shape (n, kernel.N_ROW).

    Args:
        robots: n robots.
        control: K, C and T of each, shape (n, 3).
        calibration: the model.
    """
    from pareto_monoped.jump import controller as k

    drive, gate, simulation = calibration.drive, calibration.gate, calibration.simulation
    rows = np.zeros((len(robots), k.N_ROW))
    rows[:, k.STATUS], rows[:, k.HEIGHT] = k.RUNNING, BASE_START_HEIGHT_M

    rows[:, k.REST_LENGTH] = calibration.controller.rest_length_m
    rows[:, k.TIMESTEP] = simulation.timestep_s
    rows[:, k.STEP_LIMIT] = round(simulation.time_limit_s / simulation.timestep_s)
    rows[:, k.STAGES] = _STAGES.get(simulation.integrator, 1)
    if isinstance(gate, FadeGate):
        rows[:, k.FADE_LENGTH], rows[:, k.LATCH] = gate.length_m, gate.latch
    else:
        rows[:, k.LAGS] = gate.lags
    rows[:, k.LOSS_SPEED] = drive.loss_speed_rad_per_s
    rows[:, k.MEAN_SPEED] = simulation.work_speed == "mean"
    rows[:, k.VOLTAGE_LIMIT] = drive.voltage_limit

    peak = drive.peak_torque_scale * robots.peak_torque_n_m
    efficiency = robots.efficiency.copy() if drive.mesh_losses else np.ones_like(robots.efficiency)
    efficiency[:, 1] *= drive.chain_efficiency
    # The voltage-speed line R i + k_t w = k_t w_0 meets the peak current at the corner speed.
    current = peak / (robots.ratio * robots.torque_constant_n_m_per_a)
    volts_per_speed = robots.ratio * robots.torque_constant_n_m_per_a
    corner = robots.no_load_speed_rad_per_s - robots.winding_resistance_ohm * current / volts_per_speed
    rows[:, k.THIGH], rows[:, k.SHANK] = robots.thigh_length_m, robots.shank_length_m
    rows[:, k.FOOT_RADIUS] = robots.foot_radius_m
    rows[:, k.STIFFNESS : k.TORSION + 1] = control
    weight_n = robots.body_mass_kg.sum(axis=1) * GRAVITY_M_PER_S2
    rows[:, k.WEIGHT] = calibration.controller.gravity_feed_forward * weight_n
    rows[:, k.PEAK_HIP : k.PEAK_KNEE + 1] = peak
    rows[:, k.NO_LOAD_HIP : k.NO_LOAD_KNEE + 1] = robots.no_load_speed_rad_per_s
    rows[:, k.CORNER_HIP : k.CORNER_KNEE + 1] = corner
    rows[:, k.LOSS_HIP : k.LOSS_KNEE + 1] = 1.0 - efficiency
    rows[:, k.HEAT_HIP : k.HEAT_KNEE + 1] = robots.winding_resistance_ohm / volts_per_speed**2
    return rows
