"""What comes after the apex: the leg falls, lands by a controller of its own, and may hop again.

A landing is a run of its own from the state at the apex, through the same engines, limits, delay and bookkeeping as the
jump. In flight, springs and dampers of the joints hold a posture with the foot below the hip. From the first touch on,
the leg is a spring and damper between hip and foot (``torques.push``); once they have caught the robot, the spring is
shortened to the crouch that jumps start from. docs/landing.md has the law.
"""

import math
from dataclasses import dataclass, fields
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from pareto_monoped.actuator.ratiomap import Maps, joint_maps
from pareto_monoped.config import Positive, Strict
from pareto_monoped.design import GRAVITY_M_PER_S2, NAMES, Floats, complete, control_of
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.controller_record import PUSH
from pareto_monoped.jump.end_stops import end_stops
from pareto_monoped.jump.engines import Jumping, population_of
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.model import stand_mass_kg, standing_torque_n_m, start_pose
from pareto_monoped.jump.population import Records, first_records
from pareto_monoped.jump.single import Then
from pareto_monoped.jump.variations import take
from pareto_monoped.measures import LANDING_MEASURES, LandingMeasures
from pareto_monoped.robot.population import RobotArrays, robot_arrays
from pareto_monoped.robot.units import JOINTS
from pareto_monoped.strength.factors import safeties, strength_factors
from pareto_monoped.strength.groups import REQUIRED_MEASURES
from pareto_monoped.strength.joint import loads_of

Share = Annotated[float, Field(gt=0.0, lt=1.0)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Landing(Strict):
    """How a leg lands; lengths and gains follow from these numbers, the robot and the height it falls from."""

    reach: Share = 0.9  #: distance from hip to foot at touchdown, over that of the straight leg; our own choice
    #: Of the way from there to where knee or base meet their end, what the spring is to need; our own choice
    stroke: Share = 0.7
    #: Of the critical damping; 0.4 stops a body within a way at the least peak force of any linear spring and damper:
    #: 1.04 times that of a constant force
    damping_ratio: Positive = 0.4
    lower_s: Positive = 0.2  #: from the lowest point to the crouch; our own choice


LANDING = Landing()
STATUSES = ("landed", "no_jump", "sank", "timeout", "diverged")
"""How a landing can end."""


_FLIGHT_RAD_PER_S, _FLIGHT_RATIO = 25.0, 0.6
"""How fast the posture's spring would swing the straight leg at most, and its damping; our own choice: it is there in
0.1 s."""
_MOST_STOPPED = 1.2
"""Share of a rotor's speed that the posture's damper may take from it until the next command acts. Our own choice: with
1.5, motors shake on their elastic drives; with less, the posture comes late."""
_FORWARD_RATIO = 0.3
"""Damping of the spring that keeps the foot below the hip; our own choice: with 0.75 the hip's motor shakes on its
elastic drive in some designs, because commands come once per millisecond."""
_BASE_ROOM_M = 0.15  # least height of the base that the stroke counts with; it falls at controller.SANK_M
_LEAST_FALL_M = 0.05  # for which springs are made at least, so that none is too soft to carry


def landing_records(
    robots: RobotArrays, control: Floats, calibration: Calibration, landing: Landing, ended: Records
) -> Records:
    """Return records of landings that begin in the states of jumps that have ended, shape (n,) of ``RECORD``."""
    records = first_records(robots, control, calibration)
    _begin(records, ended)
    for name in ("fade_length_m", "latch", "lags", "knee_release_rad", "regeneration_share"):
        records[name] = 0.0
    records["landing"], records["lower_s"], records["law"] = 1.0, landing.lower_s, PUSH
    moved_kg = robots.body_mass_kg.sum(axis=1) + stand_mass_kg(robots, calibration)
    thigh, shank = robots.thigh_length_m, robots.shank_length_m
    pose = start_pose(robots, calibration)
    records["crouch_m"] = _length_m(robots, pose.knee_rad)
    catch = records["catch_m"] = np.maximum(landing.reach * (thigh + shank), records["crouch_m"])
    knee = np.arccos(np.clip((catch**2 - thigh**2 - shank**2) / (2.0 * thigh * shank), -1.0, 1.0))
    hip = -np.arctan2(shank * np.sin(knee), thigh + shank * np.cos(knee))
    records["start_rad"] = np.stack([hip, knee], axis=1)
    # In flight, the leg that hangs straight down, with the rotor of the hip's motor.
    masses, thigh_at, shank_at = records["body_mass_kg"], records["thigh_com_m"], records["shank_com_m"]
    square = np.square(shank_at[:, 0]) + np.square(shank_at[:, 1] - thigh)
    inertia = masses[:, 1] * np.square(thigh_at).sum(axis=1) + masses[:, 2] * square
    inertia += records["link_inertia_kg_m2"].sum(axis=1) + records["armature_kg_m2"][:, 0]
    damping = 2.0 * _FLIGHT_RATIO * inertia * _FLIGHT_RAD_PER_S
    if calibration.drive.elastic:
        late_s = calibration.simulation.period_s + calibration.simulation.delay_s
        damping = np.minimum(damping, _MOST_STOPPED * records["armature_kg_m2"].min(axis=1) / late_s)
    records["flight_damping_n_m_s_per_rad"] = damping
    records["flight_stiffness_n_m_per_rad"] = np.square(damping / (2.0 * _FLIGHT_RATIO)) / inertia
    # In stance, the spring that stops the fall within the stroke.
    stop = end_stops(robots, calibration.joints)[1]
    folded = np.abs(thigh - shank) if stop is None else _length_m(robots, np.full(len(robots), stop.upper_rad))
    least = np.maximum(folded, _BASE_ROOM_M - robots.foot_radius_m)
    fall = np.maximum(ended["position"][:, 1] - catch - robots.foot_radius_m, _LEAST_FALL_M)
    speed = np.sqrt(2.0 * GRAVITY_M_PER_S2 * fall)
    stroke = landing.stroke * np.maximum(catch - least, 0.0)
    omega = _depth(landing.damping_ratio) * speed / np.maximum(stroke, 1e-3)
    records["catch_s"] = _to_lowest(landing.damping_ratio) / omega
    stiffness = moved_kg * omega**2
    # What carries the robot in the crouch, at the knee: its links need less than the whole weight.
    lever = shank * np.sin(pose.hip_rad + pose.knee_rad)
    records["force_n"][:, 1] = -standing_torque_n_m(robots, calibration, pose)[:, 1] / lever
    records["force_n_per_m"] = stiffness[:, None]
    ratios = np.array([min(landing.damping_ratio, _FORWARD_RATIO), landing.damping_ratio])
    records["force_n_s_per_m"] = 2.0 * ratios * (moved_kg * omega)[:, None]
    records["foot_m"][:, 1], records["force_limit_n_m"] = catch, np.inf
    return records


def _begin(records: Records, ended: Records) -> None:
    """Write states in which others have ended into records that begin."""
    noted = ("position", "velocity", "directions", "motor_rad", "motor_rad_per_s", "spin_up_rad_per_s2")
    for name in noted:
        records[name] = ended[name]
    records["height_m"] = ended["position"][:, 1]


def _length_m(robots: RobotArrays, knee_rad: Floats) -> Floats:
    """Return distances from hip to foot at angles of the knee, shape (n,)."""
    along = robots.thigh_length_m + robots.shank_length_m * np.cos(knee_rad)
    return np.asarray(np.hypot(along, robots.shank_length_m * np.sin(knee_rad)))


def _to_lowest(ratio: float) -> float:
    """Return when an impact has pressed a spring and damper most, times its natural frequency."""
    if abs(ratio - 1.0) < 1e-6:
        return 1.0
    root = math.sqrt(abs(ratio**2 - 1.0))
    return (math.atanh(root / ratio) if ratio > 1.0 else math.acos(ratio)) / root


def _depth(ratio: float) -> float:
    """Return how far an impact presses a spring and damper, times natural frequency over speed."""
    return math.exp(-ratio * _to_lowest(ratio))


@dataclass(frozen=True, slots=True, kw_only=True)
class Landings(LandingMeasures):
    """Landings of n designs, with the parameters of each."""

    landing: tuple[Landing, ...]  #: those that it landed by

    def __len__(self) -> int:
        return len(self.status)


def landed(
    designs: ArrayLike, maps: Maps, calibration: Calibration, landing: Landing = LANDING, *, workers: int = 1
) -> Landings:
    """Let designs, shape (n, 7) or (n, number of variables), jump and land.

    Example:
        >>> from pareto_monoped import PAPER_CASES, load_calibration
        >>> from pareto_monoped.actuator.search import map_for
        >>> from pareto_monoped.jump.landing import landed
        >>> case_c = PAPER_CASES["C"].design.as_array()
        >>> landed(case_c, map_for("VT8020"), load_calibration("reference")).status[0]
        np.str_('landed')
    """
    return _Fallen(designs, maps, calibration, workers).landed(landing)


def best_landed(designs: ArrayLike, maps: Maps, calibration: Calibration, *, workers: int = 1) -> Landings:
    """Return for each design the landing of greatest ``landing_safety`` among the default and those of ``TRIED``.

    A landing that comes to rest goes before every one that does not.
    """
    fallen = _Fallen(designs, maps, calibration, workers)
    best = fallen.landed(LANDING)
    for landing in TRIED:
        other = fallen.landed(landing)
        better = _merit(other) > _merit(best)
        values = {one.name: np.where(better, getattr(other, one.name), getattr(best, one.name)) for one in _ARRAYS}
        both = zip(better, other.landing, best.landing, strict=True)
        best = Landings(**values, landing=tuple(new if wins else old for wins, new, old in both))
    return best


TRIED = tuple(
    Landing(reach=reach, stroke=stroke, damping_ratio=ratio)
    for reach in (0.8, 0.9, 0.95)
    for stroke in (0.5, 0.7, 0.9)
    for ratio in (0.2, 0.4, 0.7)
)
"""What ``best_landed`` tries; our own choice: coarse, so that a design takes a second."""
_ARRAYS = fields(LandingMeasures)


def _merit(landings: Landings) -> Floats:
    return np.where(landings.status == "landed", np.nan_to_num(landings.landing_safety), -1.0)


def in_words(designs: ArrayLike, maps: Maps, calibration: Calibration) -> str:
    """Return sentences on whether a design survives its landing: by the usual law, or by the best one tried."""
    best = best_landed(designs, maps, calibration)
    if best.status[0] == "no_jump":
        return ""
    if best.landing_ok[0]:
        held = f"the weakest part has {best.landing_safety[0]:.2f} times its required safety"
        return f"It survives its own landing as simulated: {held}."
    why = "it does not come to rest"
    if best.status[0] == "landed":
        why = f"the weakest part would have {best.landing_safety[0]:.2f} times its required safety at best"
    return (
        f"It does not survive its own landing as simulated: {why}. Jumps end at the apex; catch the leg there, as on a "
        "test stand with a rope."
    )


class _Fallen:
    """Designs whose jumps have ended, which can land in several ways."""

    def __init__(self, designs: ArrayLike, maps: Maps, calibration: Calibration, workers: int) -> None:
        self.designs, self.maps, self.calibration = np.atleast_2d(complete(designs)), joint_maps(maps), calibration
        self.rows = np.flatnonzero(Evaluator(self.maps, calibration, workers)(self.designs).ok)
        self.robots = robot_arrays(self.designs[self.rows], self.maps, calibration.mass)
        self.control = control_of(self.designs[self.rows])
        pose = start_pose(self.robots, calibration)
        self.population = population_of(self.robots, self.control, pose, calibration, workers)
        self.population.run()
        self.jumped: Records = self.population.records.copy()

    def landed(self, landing: Landing) -> Landings:
        """Land by some parameters."""
        from pareto_monoped.jump import controller

        if len(self.rows):
            begun = landing_records(self.robots, self.control, self.calibration, landing, self.jumped)
            self.population.go_on(begun, self.calibration)
            self.population.run()
        names = {controller.LANDED: "landed", controller.SANK: "sank", controller.TIMEOUT: "timeout"}
        records = self.population.records
        status = np.full(len(self.designs), "no_jump", dtype="<U12")
        status[self.rows] = [names.get(int(one), "diverged") for one in records["status"]]
        found = {one.name: np.full(len(status), np.nan) for one in LANDING_MEASURES}
        for name, values in self._measured(records).items():
            found[name][self.rows] = np.where(records["status"] == controller.LANDED, values, np.nan)
        ok = (status == "landed") & (found["landing_safety"] >= 1.0)
        return Landings(status=status, landing_ok=ok, landing=(landing,) * len(status), **found)

    def _measured(self, records: Records) -> dict[str, Floats]:
        """Return all measures of landings that have ended."""
        calibration, robots = self.calibration, self.robots
        elapsed_s = (records["steps"] - 1.0) * calibration.simulation.timestep_s
        heat, energy, absorbed = (records[name] for name in ("joule_heat_j", "energy_j", "absorbed_j"))
        returned = _returned_j(records)
        kept = calibration.drive.regeneration_share * returned
        loads = _loads(robots, records)
        known = loads_of(loads | dict(zip(NAMES, self.designs[self.rows].T, strict=False)))
        groups = safeties(strength_factors(self.designs[self.rows], self.maps, known))
        required = [values for group, values in groups.items() if group in REQUIRED_MEASURES]
        peaks = {f"landing_{name}": values for name, values in loads.items()}
        touchdown_m = records["catch_m"] + robots.foot_radius_m
        return {name: peaks[name] for name in peaks if name in _NAMES} | {
            "landing_fall_m": self.jumped["position"][:, 1] - touchdown_m,
            "landing_time_s": elapsed_s - records["touched_s"],
            "landing_energy_j": energy.sum(axis=1),
            "landing_absorbed_j": absorbed.sum(axis=1),
            "landing_joule_heat_j": heat,
            "landing_electrical_energy_j": records["electrical_energy_j"]
            - kept
            + calibration.drive.standby_power_w * elapsed_s,
            "landing_returned_j": returned,
            "landing_safety": np.min(required, axis=0),
        }


_NAMES = tuple(one.name for one in LANDING_MEASURES)


def _returned_j(records: Records) -> Floats:
    """Return the energy that landings feed back, whose own records let nothing flow back: taken less work and heat."""
    work = (records["energy_j"] - records["absorbed_j"]).sum(axis=1)
    return np.asarray(records["electrical_energy_j"] - work - records["joule_heat_j"])


def _loads(robots: RobotArrays, records: Records) -> dict[str, Floats]:
    """Return the loads that strength reads (``strength.joint.LOAD_NAMES``), and the peak of both end stops."""
    loads = {name: records[name] for name in ("peak_chain_tension_n", "stop_energy_j")}
    loads |= {name: records[name] for name in ("peak_foot_force_n", "peak_knee_force_n")}
    for k, joint in enumerate(JOINTS):
        for name in ("peak_torque", "peak_gear_torque", "peak_stop_torque"):
            loads[f"{name}_{joint}_n_m"] = records[f"{name}_n_m"][:, k]
        travel_rad = getattr(robots.stops, joint).travel_rad
        loads[f"stop_compression_{joint}"] = records["peak_beyond_stop_rad"][:, k] / travel_rad
    return loads | {"peak_stop_torque_n_m": records["peak_stop_torque_n_m"].max(axis=1)}


def course(
    robots: RobotArrays, control: Floats, calibration: Calibration, landing: Landing = LANDING, hops: int = 1
) -> Then:
    """Return what lets jumps go on with their landing, and after it with the next of ``hops`` jumps."""
    from pareto_monoped.jump.controller import APEX, LANDED

    left = 2 * hops - 1

    def then(ended: Records) -> Records | None:
        nonlocal left
        goes_on = np.isin(ended["status"], (APEX, LANDED)).all()
        if not left or not goes_on:
            return None
        left -= 1
        if (ended["status"] == APEX).all():
            return landing_records(robots, control, calibration, landing, ended)
        records = first_records(robots, control, calibration)
        _begin(records, ended)
        return records

    return then


@dataclass(frozen=True, slots=True, kw_only=True)
class Hops:
    """Hops of one robot, each a jump with its landing, from the state in which the last one ended."""

    #: height_m: of each jump, in order; others of each jump with its landing, all of shape (hops made,)
    height_m: Floats
    energy_j: Floats  #: positive work of both motors
    electrical_energy_j: Floats  #: taken from the battery
    winding_heat_j: Floats  #: of the windings of hip and knee, shape (hops made, 2)
    period_s: Floats  #: from standing to standing
    standing_heat_w: Floats  #: of both windings after the last landing, shape (2,)
    hops_per_minute: float  #: that neither winding is too hot for, at the last hop; 0 if standing is too much already
    reason: str  #: why there are fewer than asked for; empty if there are not

    @property
    def steady_from(self) -> int:
        """Number, from 1, of the first hop from which height and energy repeat within 0.5 percent; 0 if none does."""
        found = 0
        for k in range(len(self.height_m) - 1, 0, -1):
            pairs = ((one[k - 1], one[k]) for one in (self.height_m, self.energy_j))
            if any(abs(one / other - 1.0) > _STEADY for one, other in pairs):
                break
            found = k
        return found


_STEADY = 5e-3


def hops(
    robots: RobotArrays, control: Floats, calibration: Calibration, count: int, landing: Landing = LANDING
) -> Hops:
    """Let the first robot, which can stand, hop ``count`` times.

    The rate is the greatest at which each winding sheds its heat: that of a hop, and that of standing until the next.
    """
    from pareto_monoped.jump.controller import APEX, LANDED

    first = take(robots, np.zeros(1, dtype=np.intp))
    then = course(first, control[:1], calibration, landing, count)
    population: Jumping = population_of(first, control[:1], start_pose(first, calibration), calibration)
    rows: list[tuple[float, ...]] = []
    jumped: Records | None = None
    hold_w = np.zeros(2)
    while True:
        population.run()
        ended = population.records.copy()
        if ended["status"][0] == APEX:
            jumped = ended
        elif ended["status"][0] == LANDED and jumped is not None:
            rows.append(_row(jumped, ended, calibration))
            hold_w = (ended["heat_w_per_n2_m2"] * np.square(ended["motor_torque_n_m"]))[0]
        following = then(ended)
        if following is None:
            break
        population.go_on(following, calibration)
    values = np.array(rows).reshape(-1, 6)
    what = "jump" if len(rows) == 0 and jumped is None else "hop"
    return Hops(
        height_m=values[:, 0],
        energy_j=values[:, 1],
        electrical_energy_j=values[:, 2],
        winding_heat_j=values[:, 3:5],
        period_s=values[:, 5],
        standing_heat_w=hold_w,
        hops_per_minute=_per_minute(ended, first, values[-1], hold_w) if rows else float("nan"),
        reason="" if len(rows) == count else f"{what} {len(rows) + 1} did not come to rest",
    )


def _row(jumped: Records, ended: Records, calibration: Calibration) -> tuple[float, ...]:
    """Return a hop's row of ``Hops``."""
    drive, step_s, both = calibration.drive, calibration.simulation.timestep_s, (jumped, ended)
    period_s = sum(float(one["steps"][0]) - 1.0 for one in both) * step_s
    energy = sum(float(one["energy_j"].sum()) for one in both)
    taken = sum(float(one["electrical_energy_j"][0]) for one in both) + drive.standby_power_w * period_s
    taken -= drive.regeneration_share * float(_returned_j(ended)[0])
    heat = (jumped["winding_heat_j"] + ended["winding_heat_j"])[0]
    return float(jumped["height_m"][0]), energy, taken, float(heat[0]), float(heat[1]), period_s


def _per_minute(records: Records, robots: RobotArrays, row: Floats, hold_w: Floats) -> float:
    """Return hops per minute: in a period T each winding has its hop's heat, and that of standing for the rest of T."""
    allowed_w = (records["heat_w_per_n2_m2"] * np.square(robots.continuous_torque_n_m))[0]
    heat, hop_s = row[3:5], float(row[5])
    period_s = hop_s
    for k in range(2):
        if heat[k] > allowed_w[k] * hop_s:
            if hold_w[k] >= allowed_w[k]:
                return 0.0
            period_s = max(period_s, float((heat[k] - hold_w[k] * hop_s) / (allowed_w[k] - hold_w[k])))
    return 60.0 / period_s
