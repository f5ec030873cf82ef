"""Many jumps at once on MuJoCo's public batch interface: one model, per-jump fields, one compiled controller."""

import functools
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import BASE_START_HEIGHT_M, GRAVITY_M_PER_S2
from pareto_monoped.jump import model
from pareto_monoped.jump.calibration import Calibration, FadeGate
from pareto_monoped.jump.pose import StartPose
from pareto_monoped.robot import RobotArrays

Floats = NDArray[np.float64]

# Steps between two looks at flying jumps; what is stepped beyond an apex is lost, half of this on average.
_FLIGHT_STEPS = 8


@dataclass(slots=True, kw_only=True)
class Population:
    """The jumps of n robots under way; see ``kernel`` for the columns of the arrays."""

    batch: Any
    ids: NDArray[np.int32]
    count: int
    qpos: Floats
    qvel: Floats
    ctrl: Floats
    constants: Floats
    memory: Floats
    status: NDArray[np.int32]
    settings: Floats
    errors: dict[int, str] = field(default_factory=dict)

    def advance(self) -> int:
        """Book the last step, set the torques of the next; returns how many jumps go on."""
        from pareto_monoped.jump.kernel import advance

        self.count = advance(
            self.ids,
            self.count,
            self.qpos,
            self.qvel,
            self.ctrl,
            self.constants,
            self.memory,
            self.status,
            self.settings,
        )
        return self.count

    def run(self) -> None:
        """All jumps to their end."""
        from pareto_monoped.jump.kernel import FLYING, fly

        while self.advance():
            self._call(self.batch.step)
        self.ids = np.flatnonzero(self.status == FLYING).astype(np.int32)
        self.count = len(self.ids)
        while self.count:
            shape = (self.count, _FLIGHT_STEPS)
            records = {"qpos": np.empty((*shape, self.qpos.shape[1])), "qvel": np.empty((*shape, self.qvel.shape[1]))}
            self._call(functools.partial(self._rollout, records))
            self.count = fly(
                self.ids,
                self.count,
                records["qpos"],
                records["qvel"],
                self.constants,
                self.memory,
                self.status,
                self.settings,
            )

    def _rollout(self, records: dict[str, Floats], ids: NDArray[np.int32]) -> None:
        self.batch.rollout(_FLIGHT_STEPS, record=tuple(records), ids=ids, out=records)

    def _call(self, function: Callable[[NDArray[np.int32]], None]) -> None:
        """Call the batch for all running jumps; a jump in which MuJoCo raises an error ends as diverged."""
        from mujoco.batch import SimulationError

        try:
            function(self.ids[: self.count])
        except SimulationError as problem:
            from pareto_monoped.jump.kernel import DIVERGED

            for i in problem.ids:
                self.errors[int(i)] = self.batch.error(int(i))
            self.status[problem.ids] = DIVERGED

    def complaints(self) -> list[str]:
        """What MuJoCo raised or warned of in each jump; empty where nothing."""
        import mujoco

        texts = [self.errors.get(i, "") for i in range(len(self.status))]
        for i, kind in np.argwhere(self.batch.warning[:, :, 1] > 0):
            texts[i] = texts[i] or f"MuJoCo warned: {mujoco.mjtWarning(int(kind)).name.removeprefix('mjWARN_')}"
        return texts


def prepare(robots: RobotArrays, control: Floats, pose: StartPose, calibration: Calibration) -> Population:
    """A population at rest.

    Args:
        robots: n robots that can stand.
        control: K, C and T of each, shape (n, 3).
        pose: their start pose.
        calibration: the model.
    """
    from mujoco.batch import Batch

    n = len(robots)
    batch = Batch(_template(calibration), n, nthread=1)
    for name, values in model.model_fields(robots, calibration).items():
        batch.expand(name)[:] = values
    inverse_body_mass, inverse_joint_mass = batch.expand("body_invweight0"), batch.expand("dof_invweight0")
    batch.set_const()
    springs = model.spring_fields(calibration, inverse_body_mass, inverse_joint_mass)
    if "geom_solref" in springs:
        batch.expand("geom_solref")[:, model.FOOT_GEOM] = springs["geom_solref"]
    if "jnt_solref" in springs:
        batch.expand("jnt_solref")[:, -2:] = springs["jnt_solref"]
    qpos = batch.bind("qpos")
    qpos[:] = model.start_qpos(calibration, pose.hip_rad, pose.knee_rad)
    return Population(
        batch=batch,
        ids=np.arange(n, dtype=np.int32),
        count=n,
        qpos=qpos,
        qvel=batch.bind("qvel"),
        ctrl=batch.bind("ctrl"),
        constants=constants(robots, control, calibration),
        memory=first_memory(n),
        status=np.zeros(n, dtype=np.int32),
        settings=settings(calibration),
    )


@functools.lru_cache(maxsize=16)
def _template(calibration: Calibration) -> Any:
    """A model of no robot in particular: all that differs between robots is written over."""
    import mujoco

    return mujoco.MjModel.from_xml_string(model.template_mjcf(calibration))


def first_memory(n: int) -> Floats:
    """What the controller remembers before the first step, shape (n, kernel.N_MEMORY)."""
    from pareto_monoped.jump import kernel

    memory = np.zeros((n, kernel.N_MEMORY))
    memory[:, kernel.HEIGHT] = BASE_START_HEIGHT_M
    return memory


def constants(robots: RobotArrays, control: Floats, calibration: Calibration) -> Floats:
    """The numbers of each jump that the controller needs, shape (n, kernel.N_CONSTANTS)."""
    from pareto_monoped.jump import kernel as k

    drive = calibration.drive
    peak = drive.peak_torque_scale * robots.peak_torque_n_m
    efficiency = robots.efficiency.copy() if drive.mesh_losses else np.ones_like(robots.efficiency)
    efficiency[:, 1] *= drive.chain_efficiency
    # The voltage-speed line R i + k_t w = k_t w_0 meets the peak current at the corner speed.
    current = peak / (robots.ratio * robots.torque_constant_n_m_per_a)
    volts_per_speed = robots.ratio * robots.torque_constant_n_m_per_a
    corner = robots.no_load_speed_rad_per_s - robots.winding_resistance_ohm * current / volts_per_speed
    heat = robots.winding_resistance_ohm / volts_per_speed**2
    result = np.zeros((len(robots), k.N_CONSTANTS))
    result[:, k.THIGH], result[:, k.SHANK] = robots.thigh_length_m, robots.shank_length_m
    result[:, k.FOOT_RADIUS] = robots.foot_radius_m
    result[:, k.STIFFNESS : k.TORSION + 1] = control
    weight_n = robots.body_mass_kg.sum(axis=1) * GRAVITY_M_PER_S2
    result[:, k.WEIGHT] = calibration.controller.gravity_feed_forward * weight_n
    result[:, k.PEAK_HIP : k.PEAK_KNEE + 1] = peak
    result[:, k.NO_LOAD_HIP : k.NO_LOAD_KNEE + 1] = robots.no_load_speed_rad_per_s
    result[:, k.CORNER_HIP : k.CORNER_KNEE + 1] = corner
    result[:, k.LOSS_HIP : k.LOSS_KNEE + 1] = 1.0 - efficiency
    result[:, k.HEAT_HIP : k.HEAT_KNEE + 1] = heat
    return result


def settings(calibration: Calibration) -> Floats:
    """The numbers that all jumps share, shape (kernel.N_SETTINGS,)."""
    from pareto_monoped.jump import kernel as k

    gate, simulation = calibration.gate, calibration.simulation
    result = np.zeros(k.N_SETTINGS)
    result[k.REST_LENGTH] = calibration.controller.rest_length_m
    result[k.TIMESTEP] = simulation.timestep_s
    result[k.STEP_LIMIT] = round(simulation.time_limit_s / simulation.timestep_s)
    if isinstance(gate, FadeGate):
        result[k.FADE_LENGTH], result[k.LATCH] = gate.length_m, float(gate.latch)
    else:
        result[k.LAGS] = float(gate.lags)
    result[k.LOSS_SPEED] = calibration.drive.loss_speed_rad_per_s
    result[k.MEAN_SPEED] = float(simulation.work_speed == "mean")
    result[k.VOLTAGE_LIMIT] = float(calibration.drive.voltage_limit)
    return result
