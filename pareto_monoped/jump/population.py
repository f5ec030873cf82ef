"""Many jumps at once, on MuJoCo's public batch interface: one model, fields per robot, one compiled controller."""

import functools
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import (
    CONTROL,
    GRAVITY_M_PER_S2,
    KNOT_NAMES,
    PAPER_CONTROL,
    REST_LENGTH_M,
    Floats,
    complete_control,
)
from pareto_monoped.errors import SimulationError
from pareto_monoped.jump import model
from pareto_monoped.jump.calibration import Calibration, FadeGate
from pareto_monoped.jump.controller_record import KNEE, OBSERVED, RECORD, RECORD_NUMBERS
from pareto_monoped.jump.document import template_mjcf
from pareto_monoped.jump.end_stops import EndStops, bumper_damping_s_per_m, constraints, end_stops
from pareto_monoped.jump.model import StartPose, start_pose
from pareto_monoped.jump.quiet import quiet
from pareto_monoped.jump.variations import Variations, vary_fields, vary_records
from pareto_monoped.leg.stops import JointStop
from pareto_monoped.robot.population import RobotArrays
from pareto_monoped.robot.units import BODIES, JOINTS

Records = NDArray[np.void]

# Steps between two checks for jumps that are over; a jump wastes half of this on average.
_STEPS_PER_CALL = 16
_FIRST_ROOM = 512  # steps of an observed jump that there is room for at first; most jumps end sooner
# Force evaluations per step, and so calls of the controller; integrators not listed use one.
_STAGES = {"RK4": 4}
_FULL = "it has more contacts than there is room for"
_WARNINGS = {
    "mjWARN_BADQACC": "its accelerations grew beyond all bounds",
    "mjWARN_BADQVEL": "its speeds grew beyond all bounds",
    "mjWARN_BADQPOS": "its positions grew beyond all bounds",
    "mjWARN_BADCTRL": "a motor's torque grew beyond all bounds",
    "mjWARN_INERTIA": "its mass matrix became singular",
    "mjWARN_CONTACTFULL": _FULL,
    "mjWARN_CNSTRFULL": _FULL,
}  #: MuJoCo's warnings in our words, those that say most first.


def threads_for(jumps: int, workers: int) -> int:
    """Return how many threads step jumps of which something is read every few steps.

    All threads meet there, which takes them as long as some jumps' steps. Our own choice: 16 jumps each.
    """
    return max(1, min(workers, jumps // 16))


@dataclass(slots=True, kw_only=True)
class Population:
    """The jumps of n robots in progress."""

    batch: Any  #: their simulations
    records: Records  #: the controller's record of each, shape (n,) of ``RECORD``; a view of the batch's user data
    errors: dict[int, str] = field(default_factory=dict)  #: what MuJoCo raised, by jump

    def run(self) -> None:
        """Step all jumps to their end; a jump in which MuJoCo raises an error ends as diverged.

        Without a call of the controller no jump would ever end, so that raises ``SimulationError``.
        """
        from mujoco import batch

        from pareto_monoped.jump.callback import controlled, untimed
        from pareto_monoped.jump.controller import DIVERGED, FLYING

        status, steps = self.records["status"], self.records["steps"]
        with controlled(), untimed():
            while len(ids := np.flatnonzero(status <= FLYING)):
                first = ids[0]
                before = steps[first]
                try:
                    self.batch.step(ids if len(ids) < len(status) else None, _STEPS_PER_CALL)
                except batch.SimulationError as problem:
                    for i in problem.ids:
                        self.errors[int(i)] = self.batch.error(int(i))
                    status[problem.ids] = DIVERGED
                if steps[first] == before and status[first] <= FLYING:
                    raise SimulationError(
                        "mjcb_control: was replaced while jumps ran; let no other thread set callbacks meanwhile"
                    )

    def observed(self) -> list[Floats]:
        """Make all jumps to their end, and return ``OBSERVED`` of each, n arrays of shape (steps, 16)."""
        from mujoco import batch

        from pareto_monoped.jump.callback import controlled
        from pareto_monoped.jump.controller import DIVERGED, FLYING

        records, status = self.records, self.records["status"]
        places, end = [], 0
        for name, size in OBSERVED.items():
            places.append((records[name], slice(end, end + size)))
            end += size
        seen, steps, step = np.zeros((len(records), _FIRST_ROOM, end)), np.zeros(len(records), dtype=np.intp), 0
        with controlled():
            while len(ids := np.flatnonzero(status <= FLYING)):
                if step == seen.shape[1]:
                    seen = np.concatenate((seen, np.zeros_like(seen)), axis=1)
                try:
                    self.batch.step(ids, 1)
                except batch.SimulationError as problem:
                    status[problem.ids] = DIVERGED
                for values, columns in places:
                    seen[ids, step, columns] = values[ids]
                steps[ids] += 1
                step += 1
        return [one[:count] for one, count in zip(seen, steps, strict=True)]

    def go_on(self, records: Records, calibration: Calibration) -> None:
        """Put all robots into the states in other records, with which they go on."""
        import mujoco

        for part, values in zip(("QPOS", "QVEL"), states(records, calibration), strict=True):
            _component(self.batch, mujoco.mjtState.__members__[f"mjSTATE_{part}"])[:] = values
        self.records[:] = records

    def complaints(self) -> list[str]:
        """Return what MuJoCo found wrong in each jump, in our words; empty where nothing was."""
        import mujoco

        texts = [" ".join(self.errors.get(i, "").split()) for i in range(len(self.records))]
        found = self.batch.warning[:, :, 1] > 0
        for name, words in _WARNINGS.items():
            for i in np.flatnonzero(found[:, int(mujoco.mjtWarning.__members__[name])]):
                texts[i] = texts[i] or words
        for i in np.flatnonzero(found.any(axis=1)):
            texts[i] = texts[i] or "something is wrong with its state"
        return texts


@quiet()
def prepare(
    robots: RobotArrays,
    control: Floats,
    pose: StartPose,
    calibration: Calibration,
    threads: int = 1,
    variations: Variations | None = None,
) -> Population:
    """Return a population of n robots that can stand, at rest in their start pose, stepped by ``threads`` threads.

    ``robots`` and ``control`` are varied already; the rest of ``variations`` is applied here.
    """
    import mujoco
    from mujoco.batch import Batch

    stops = constraints(robots, calibration.joints)
    batch = Batch(_template(calibration, stops), len(robots), nthread=threads)
    for name, values in model.model_fields(robots, calibration).items():
        batch.expand(name)[:] = values
    inverse_body_mass, inverse_joint_mass = batch.expand("body_invweight0"), batch.expand("dof_invweight0")
    batch.set_const()
    springs = model.spring_fields(calibration, stops, inverse_body_mass, inverse_joint_mass)
    if "geom_solref" in springs:
        batch.expand("geom_solref")[:, model.FOOT_GEOM] = springs["geom_solref"]
    if "jnt_solref" in springs:
        batch.expand("jnt_solref")[:, model.joint_places(calibration)] = springs["jnt_solref"]
    _component(batch, mujoco.mjtState.mjSTATE_QPOS)[:] = model.start_qpos(robots, calibration, pose)
    records = _component(batch, mujoco.mjtState.mjSTATE_USERDATA).view(RECORD)[:, 0]
    records[:] = first_records(robots, control, calibration)
    if variations is not None:
        vary_fields(batch, calibration, variations)
        vary_records(records, robots.stops, calibration, variations)
    return Population(batch=batch, records=records)


def _component(batch: Any, component: Any) -> Floats:
    """Return a view of one component of all simulations' states, shape (n, size of the component).

    ``batch.bind`` returns the same, but creates a costly ``MjData`` only to find the shape. A state is the
    ``mjSTATE_INTEGRATION`` of its simulation (documentation of ``mujoco.batch``), with its components in the order of
    their bits.
    """
    import mujoco

    before = int(mujoco.mjtState.mjSTATE_INTEGRATION) & (int(component) - 1)
    start = mujoco.mj_stateSize(batch.model, before)
    return np.asarray(batch.state[:, start : start + mujoco.mj_stateSize(batch.model, int(component))])


@functools.lru_cache(maxsize=16)
def _template(calibration: Calibration, stops: EndStops) -> Any:
    """Return a model of a robot with round numbers; ``prepare`` overwrites every field that differs between robots."""
    import mujoco

    return mujoco.MjModel.from_xml_string(template_mjcf(calibration, stops, RECORD_NUMBERS))


def states(records: Records, calibration: Calibration) -> tuple[Floats, Floats]:
    """Return positions and speeds of the states that n records have noted, shape (n, nv) each."""
    columns = ("slide_x", "slide_z", "hip", "knee", "hip_motor", "knee_motor")
    places = [columns.index(name) for name in model.coordinates(calibration)]
    noted = ((records["position"], records["motor_rad"]), (records["velocity"], records["motor_rad_per_s"]))
    positions, speeds = (np.hstack(pair)[:, places] for pair in noted)
    return positions, speeds


def first_records(robots: RobotArrays, control: Floats, calibration: Calibration) -> Records:
    """Return the controller's records before the first step, one per jump, shape (n,) of ``RECORD``."""
    from pareto_monoped.jump import controller

    drive, gate, simulation = calibration.drive, calibration.gate, calibration.simulation
    records = np.zeros(len(robots), dtype=RECORD)
    records["status"] = controller.RUNNING
    records["height_m"] = robots.start_height_m
    records["timestep_s"] = simulation.timestep_s
    records["read_back_s"] = 0.5 * simulation.timestep_s if simulation.positions_read == "half_step_back" else 0.0
    records["period_steps"] = simulation.period_steps
    records["delay_periods"] = round(simulation.delay_s / simulation.period_s)
    records["step_limit"] = round(simulation.time_limit_s / simulation.timestep_s)
    records["stages"] = _STAGES.get(simulation.integrator, 1)
    if isinstance(gate, FadeGate):
        records["fade_length_m"] = gate.length_m
        records["latch"] = gate.latch
    else:
        records["lags"] = gate.lags
    for name in ("loss_speed_rad_per_s", "regeneration_share", "voltage_limit"):
        records[name] = getattr(drive, name)
    records["mean_speed"] = simulation.work_speed == "mean"
    records["bus"] = drive.battery == "bus"

    for name in ("thigh_length_m", "shank_length_m", "foot_radius_m", "no_load_speed_rad_per_s"):
        records[name] = getattr(robots, name)
    given = dict(zip((*CONTROL, *KNOT_NAMES), complete_control(control).T, strict=True))
    for name in (*PAPER_CONTROL, "knee_release_rad"):
        records[name] = given[name]
    # A design that leaves the rest length at its default takes that of its calibration.
    free = given["rest_length_m"] != REST_LENGTH_M
    records["rest_length_m"] = np.where(free, given["rest_length_m"], calibration.controller.rest_length_m)
    calibration.controller.law.fill(records, given, robots)
    whole = calibration.controller.weight == "robot"
    mass_kg = robots.body_mass_kg.sum(axis=1) if whole else robots.body_mass_kg[:, BODIES.index("base")]
    records["weight_n"] = calibration.controller.gravity_feed_forward * (mass_kg * GRAVITY_M_PER_S2)
    if (flight := calibration.controller.flight) is not None:
        pose = start_pose(robots, calibration)
        records["flight_stiffness_n_m_per_rad"] = flight.stiffness_n_m_per_rad
        records["flight_damping_n_m_s_per_rad"] = flight.damping_n_m_s_per_rad
        records["start_rad"] = np.stack([pose.hip_rad, pose.knee_rad], axis=1)
    limit = model.torque_limit(robots, drive)
    records["torque_limit_n_m"] = limit
    # The voltage-speed line R i + k_t w = k_t w_0 meets the peak current at the corner speed.
    volts_per_speed = robots.ratio * robots.torque_constant_n_m_per_a
    current = limit / volts_per_speed
    resistance = model.winding_resistance_ohm(robots, drive)
    corner = robots.no_load_speed_rad_per_s - resistance * current / volts_per_speed
    records["corner_speed_rad_per_s"] = corner
    efficiency = model.gear_efficiency(robots, drive)
    efficiency[:, KNEE] *= drive.chain_efficiency
    records["loss"] = 1.0 - efficiency
    records["heat_w_per_n2_m2"] = resistance / volts_per_speed**2
    _set_load_constants(records, robots, calibration)
    return records


def _set_load_constants(records: Records, robots: RobotArrays, calibration: Calibration) -> None:
    """What ``controller`` computes the loads from: bodies, everything that turns, friction, and stops."""
    joints = calibration.joints
    records["body_mass_kg"] = robots.body_mass_kg
    records["stand_mass_kg"] = model.stand_mass_kg(robots, calibration)
    records["rail_friction_n"] = model.rail_friction_n(calibration)
    for name, body in (("thigh_com_m", "thigh"), ("shank_com_m", "shank")):
        records[name] = robots.body_com_m[:, BODIES.index(body)][:, [0, 2]]
    records["link_inertia_kg_m2"] = robots.body_inertia_kg_m2[:, 1:, 1, 1]
    records["armature_kg_m2"] = robots.armature_kg_m2
    if joints.rotors == "absolute":
        records["link_inertia_kg_m2"][:, 0] += robots.rotor_excess_kg_m2
        records["armature_kg_m2"][:, 1] = robots.knee_reflected_kg_m2
        records["coupling_kg_m2"] = robots.knee_coupling_kg_m2
    records["rotor_kg_m2"] = robots.rotor_inertia_kg_m2 * robots.ratio
    records["ratio"] = robots.ratio
    records["joint_damping_n_m_s_per_rad"] = model.joint_damping(robots, joints)
    for k, stop in enumerate(end_stops(robots, joints)):
        records["lower_stop_rad"][:, k] = -np.inf if stop is None else stop.lower_rad
        records["upper_stop_rad"][:, k] = np.inf if stop is None else stop.upper_rad
    if joints.stop_law == "hunt_crossley":
        for k, joint in enumerate(JOINTS):
            part: JointStop = getattr(robots.stops, joint)
            lever_m = 1e-3 * part.lever_mm
            records["bumper_n_m"][:, k] = lever_m * part.bumper.scale_n
            records["bumper_per_rad"][:, k] = part.lever_mm / part.bumper.diameter_mm
            chi_s_per_m = bumper_damping_s_per_m(part.bumper.elastomer.rebound_resilience)
            records["bumper_s_per_rad"][:, k] = chi_s_per_m * lever_m
    if calibration.drive.elastic:
        records["drive_n_m_per_rad"] = robots.drive_stiffness_n_m_per_rad
        records["drive_n_m_s_per_rad"] = model.drive_damping_n_m_s_per_rad(robots, calibration)
        records["backlash_rad"] = calibration.drive.backlash_rad
    records["sprocket_radius_m"] = robots.sprocket_radius_m
