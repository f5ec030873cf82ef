"""Designs in, evaluations out, in the same order: search, report and command line jump through this module only."""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pareto_monoped.actuator.ratiomap import JointMaps, Maps, joint_maps
from pareto_monoped.design import (
    ALL_NAMES,
    GRAVITY_M_PER_S2,
    LEAST,
    MOST,
    Floats,
    complete,
    complete_control,
    control_of,
    nonsense,
)
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.controller_record import HIP, KNEE
from pareto_monoped.jump.engines import Jumping, population_of
from pareto_monoped.jump.gravity import rise_m, standing_height_m
from pareto_monoped.jump.model import longest_step_s, start_pose
from pareto_monoped.jump.population import Records
from pareto_monoped.jump.variations import Variations, joined, take, varied_control, varied_robots
from pareto_monoped.measures import MEASURE_NAMES, JumpMeasures
from pareto_monoped.robot.population import JointStops, RobotArrays, robot_arrays
from pareto_monoped.robot.units import JOINTS
from pareto_monoped.strength.factors import safeties, strength_factors
from pareto_monoped.strength.joint import LOAD_NAMES, loads_of

STATUSES = ("ok", "bad_input", "no_gearbox", "cannot_stand", "no_lift_off", "timeout", "diverged")
"""How a jump can end. Every status but ``ok`` comes with a reason, and without height and energy."""
# Jumps stepped together: enough to hide the cost of a call, few enough to stay in the processor's cache.
_CHUNK = 256


@dataclass(frozen=True, slots=True, kw_only=True)
class Evaluations(JumpMeasures):
    """Results of n jumps: one field per measure, with what it means in ``measures.MEASURES``."""

    def __len__(self) -> int:
        return len(self.height_m)

    @property
    def ok(self) -> NDArray[np.bool_]:
        """Which jumps have a height and an energy, shape (n,)."""
        return np.asarray(self.status == "ok")

    def of(self, name: str) -> Floats:
        """Return the measure of that name, shape (n,)."""
        values: Floats = getattr(self, name)
        return values

    def as_columns(self) -> dict[str, NDArray[np.generic]]:
        """Return column name to values of shape (n,), ``status`` and ``reason`` first."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return values | {"reason": np.array(self.reason, dtype=np.str_)}


class Evaluator:
    """Evaluates designs with the actuators of one or several kits of motors under one calibration, on threads.

    To the last bit, the result of a design does not depend on the rest of the batch, its order or the number of
    workers. ``actuator_map`` is of the first kit, ``actuator_maps`` of every kit.
    """

    executor: Executor | None = None  #: what shares out the jumps, see ``jump.shared``; None: these threads do them all

    def __init__(
        self, actuator_map: Maps, calibration: Calibration, workers: int = 1, *, others: Sequence[Maps] = ()
    ) -> None:
        self.actuator_map = actuator_map
        self.actuator_maps = tuple(map(joint_maps, (actuator_map, *others)))
        self.calibration = calibration
        self.workers = workers

    def __call__(
        self, designs: ArrayLike, motors: ArrayLike | None = None, *, variations: Variations | None = None
    ) -> Evaluations:
        """Jump with each design, shape (n, 7) or (n, number of variables).

        ``motors`` has the row of ``actuator_maps`` for each design, shape (n,); None means the first. Robots that
        depart from their designs by ``variations`` have parts that carry as much as designed.
        """
        values = np.atleast_2d(complete(designs))
        table, reasons = _Table(len(values)), _nonsense(values)
        for i, reason in reasons.items():
            table.fail(i, "bad_input", reason)
        sane = np.setdiff1d(np.arange(len(values)), list(reasons))
        chosen = np.zeros(len(values), dtype=np.intp) if motors is None else np.asarray(motors, dtype=np.intp)
        if len(sane):
            rows_of = {k: sane[chosen[sane] == k] for k in np.unique(chosen[sane]).tolist()}
            self._evaluate(values, rows_of, table, variations)
        return table.evaluations()

    def _evaluate(
        self, values: Floats, rows_of: Mapping[int, NDArray[np.intp]], table: "_Table", variations: Variations | None
    ) -> None:
        """Fill the table; ``rows_of`` has the rows of each kit of motors."""
        built = {
            k: robot_arrays(values[rows], self.actuator_maps[k], self.calibration.mass) for k, rows in rows_of.items()
        }
        # Robots with the same end stops share one model, so they jump together whatever their motors.
        for members in _alike(built):
            robots = joined([built[k] for k in members])
            rows = np.concatenate([rows_of[k] for k in members])
            own = None if variations is None else take(variations, rows)
            _jump(robots, control_of(values[rows]), self.calibration, self.workers, table, rows, own)
        for k, rows in rows_of.items():
            _add_safeties(values, self.actuator_maps[k], table, rows)


def _alike(robots: Mapping[int, RobotArrays]) -> list[list[int]]:
    """Return keys of populations that have the same end stops, and can thus be one population."""
    groups: dict[JointStops, list[int]] = {}
    for key, population in robots.items():
        groups.setdefault(population.stops, []).append(key)
    return list(groups.values())


def evaluate_robots(robots: RobotArrays, control: Floats, calibration: Calibration, workers: int = 1) -> Evaluations:
    """Jump with n built robots, each with its control (see ``design.complete_control``).

    The measures of strength are NaN, because robots alone do not say which gearboxes they have.
    """
    table = _Table(len(robots))
    _jump(robots, complete_control(control), calibration, workers, table, np.arange(len(robots)))
    return table.evaluations()


def _add_safeties(values: Floats, maps: JointMaps, table: "_Table", rows: NDArray[np.intp]) -> None:
    """Fill the measures of strength of ``rows`` from the loads of their jumps."""
    rows = rows[table.status[rows] == "ok"]
    known = dict(zip(ALL_NAMES, values.T, strict=False)) | table.columns
    loads = loads_of({name: known[name][rows] for name in LOAD_NAMES})
    for name, safety in safeties(strength_factors(values[rows], maps, loads)).items():
        table.columns[name][rows] = safety


def _nonsense(values: Floats) -> dict[int, str]:
    """Return the rows of ``values`` that are not designs, each with the reason."""
    with np.errstate(invalid="ignore"):
        wrong = ~((values >= LEAST[: values.shape[1]]) & (values <= MOST))
    reasons: dict[int, str] = {}
    for i, column in np.argwhere(wrong).tolist():
        reasons.setdefault(i, nonsense(ALL_NAMES[column], float(values[i, column])) or "")
    return reasons


class _Table:
    """Collects the rows of ``Evaluations``; every row is ``ok`` with NaN measures until it is written."""

    def __init__(self, n: int) -> None:
        self.status = np.full(n, "ok", dtype="<U12")
        self.reason = [""] * n
        self.columns = {name: np.full(n, np.nan) for name in MEASURE_NAMES}

    def fail(self, i: int, status: str, reason: str) -> None:
        self.status[i] = status
        self.reason[i] = reason

    def evaluations(self) -> Evaluations:
        return Evaluations(status=self.status, reason=tuple(self.reason), **self.columns)


def _jump(
    robots: RobotArrays,
    control: Floats,
    calibration: Calibration,
    workers: int,
    table: _Table,
    rows: NDArray[np.intp],
    variations: Variations | None = None,
) -> None:
    """Let ``robots`` jump and fill ``rows`` of the table, one row per robot."""
    if variations is not None:
        robots, control = varied_robots(robots, variations), varied_control(control, variations)
    built = np.array([not reason for reason in robots.reason], dtype=bool)
    for i in np.flatnonzero(~built):
        table.fail(rows[i], "no_gearbox", robots.reason[i])
    table.columns["mass_kg"][rows[built]] = robots.body_mass_kg[built].sum(axis=1)
    for name in ("cost_eur", "made_parts", "bought_parts"):
        table.columns[name][rows[built]] = getattr(robots, name)[built]
    pose = start_pose(robots, calibration)
    stands = np.array([not reason for reason in pose.reason], dtype=bool)
    for i in np.flatnonzero(built & ~stands):
        table.fail(rows[i], "cannot_stand", pose.reason[i])
    step_s, longest_s = calibration.simulation.timestep_s, longest_step_s(robots, calibration)
    follows = step_s <= longest_s
    for i in np.flatnonzero(built & stands & ~follows):
        most = f"timestep_s must be at most {1e6 * longest_s[i]:.0f} us"
        table.fail(rows[i], "diverged", f"a step of {1e6 * step_s:.0f} us is too long for its elastic drives; {most}")
    ready = np.flatnonzero(built & stands & follows)
    for start in range(0, len(ready), _CHUNK):
        chosen = ready[start : start + _CHUNK]
        jumping = take(robots, chosen)
        own = None if variations is None else take(variations, chosen)
        population = population_of(jumping, control[chosen], take(pose, chosen), calibration, workers, own)
        population.run()
        _collect(population, jumping, calibration, table, rows[chosen])


def _collect(
    population: Jumping,
    robots: RobotArrays,
    calibration: Calibration,
    table: _Table,
    rows: NDArray[np.intp],
) -> None:
    """Fill ``rows`` of the table with the ends and measures of a population that has run."""
    records, step, drive = population.records, calibration.simulation.timestep_s, calibration.drive
    energy = records["energy_j"][:, HIP] + records["energy_j"][:, KNEE]
    _name_failures(population, energy, step, table, rows)
    ok = table.status[rows] == "ok"
    mass = table.columns["mass_kg"][rows]
    rise = records["height_m"] - robots.start_height_m
    active = np.maximum(records["active_steps"], 1.0)
    travels_rad = np.array([getattr(robots.stops, joint).travel_rad for joint in JOINTS])  # of whole bumpers
    saturated = records["saturated_steps"] / active[:, None]
    measures = _as_recorded(records) | {
        "energy_j": energy,
        "absorbed_j": records["absorbed_j"][:, HIP] + records["absorbed_j"][:, KNEE],
        "drive_loss_j": records["drive_loss_j"][:, HIP] + records["drive_loss_j"][:, KNEE],
        "foot_clearance_m": records["clearance_m"],
        "lift_off_s": (records["lift_off_step"] - 1) * step,
        "apex_s": (records["steps"] - 1) * step,
        **_by_joint("saturation_{}", saturated),
        "efficiency": mass * GRAVITY_M_PER_S2 * rise / np.where(ok, energy, np.nan),
        "electrical_energy_j": records["electrical_energy_j"] + drive.standby_power_w * (records["steps"] - 1) * step,
        "sustained_jumps_per_minute": _sustained_per_minute(records, robots.continuous_torque_n_m),
        "peak_stop_torque_n_m": records["peak_stop_torque_n_m"].max(axis=1),
        **_by_joint("stop_compression_{}", records["peak_beyond_stop_rad"] / travels_rad),
        "rise_m": rise_m(robots, records),
        "above_standing_m": records["height_m"] - standing_height_m(robots, calibration),
        "agility_m_per_s": rise / np.where(ok, (records["steps"] - 1) * step, np.nan),
    }
    for name, values in measures.items():
        table.columns[name][rows[ok]] = values[ok]


def _sustained_per_minute(records: Records, continuous_torque_n_m: Floats) -> Floats:
    """Return jumps per minute at which neither motor makes more heat in its winding than at its continuous torque."""
    allowed_w = records["heat_w_per_n2_m2"] * np.square(continuous_torque_n_m)
    with np.errstate(divide="ignore"):
        return np.asarray((60.0 * allowed_w / records["winding_heat_j"]).min(axis=1))


def _as_recorded(records: Records) -> dict[str, Floats]:
    """The measures that the controller's records hold under their own names, with "hip" or "knee" left out of pairs."""
    recorded = records.dtype.names or ()
    found = {name: records[name] for name in MEASURE_NAMES if name in recorded}
    for k, joint in enumerate(JOINTS):
        pairs = {name: name.replace(f"_{joint}", "", 1) for name in MEASURE_NAMES if f"_{joint}" in name}
        found |= {name: records[pair][:, k] for name, pair in pairs.items() if pair in recorded}
    return found


def _by_joint(name: str, values: Floats) -> dict[str, Floats]:
    """The columns of hip and knee, of ``values`` with shape (n, 2); the joint takes the braces' place in ``name``."""
    return {name.format(joint): values[:, k] for k, joint in enumerate(JOINTS)}


def _name_failures(population: Jumping, energy_j: Floats, step_s: float, table: _Table, rows: NDArray[np.intp]) -> None:
    """Give every jump that did not reach its apex, or reached it without work, its status and reason."""
    from pareto_monoped.jump import controller

    complaints = population.complaints()
    for i, row in enumerate(rows):
        status = population.records["status"][i]
        time = (population.records["steps"][i] - 1) * step_s
        if complaints[i] or status == controller.DIVERGED:
            table.fail(row, "diverged", complaints[i] or f"positions or speeds left all bounds after {time:.3f} s")
        elif status == controller.SANK:
            table.fail(row, "no_lift_off", f"the base sank to {controller.SANK_M} m after {time:.3f} s")
        elif status == controller.NO_LIFT_OFF:
            table.fail(row, "no_lift_off", f"the foot had not left the floor after {time:.3f} s")
        elif status == controller.TIMEOUT:
            table.fail(row, "timeout", f"the base had not come to its apex after {time:.3f} s")
        elif energy_j[i] == 0.0:
            table.fail(row, "no_lift_off", f"the foot left the floor after {time:.3f} s without work of the motors")
