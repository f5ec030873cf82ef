"""A leg that others built as a robot of this package, and its pushes replayed by the compiled engine."""

import math
from dataclasses import replace
from typing import Literal

import numpy as np

from pareto_monoped.design import CONTROL, Floats
from pareto_monoped.errors import SimulationError
from pareto_monoped.jump.calibration import Calibration, Joints, Simulation, Stand, load_calibration
from pareto_monoped.jump.controller_record import PUSH
from pareto_monoped.jump.engines import population_of
from pareto_monoped.jump.gravity import left_m, rise_m
from pareto_monoped.jump.model import StartPose
from pareto_monoped.jump.rail_leg import LegDrive, Link, Push, RailLeg, Series, contact_of
from pareto_monoped.jump.variations import Variations, take, varied_robots
from pareto_monoped.leg.stand import CARRIAGES
from pareto_monoped.leg.stops import Bumper, JointStop
from pareto_monoped.materials import MATERIALS
from pareto_monoped.robot.population import JointStops, RobotArrays

_STEP_S = 0.0002  #: At most; that of the calibration ``reference``.
_BUMPER = Bumper(diameter_mm=28.0, length_mm=28.0, elastomer=MATERIALS.fluoroelastomer)
_FREE = JointStop(lower_rad=-math.inf, upper_rad=math.inf, lever_mm=51.0, half_face_mm=13.0, bumper=_BUMPER)
"""Stops that no joint meets; the numbers of their bumpers do not matter."""

Term = Literal["damping", "friction", "efficiency", "rail"]
TERMS: dict[Term, float] = {"damping": 2.0, "friction": 6.0, "efficiency": 1.0, "rail": 60.0}
"""Loss terms that may be fitted, each with the largest value tried: N m s/rad and N m at each joint, the share that the
drives lose under load, N on the rail."""


def calibration_of_leg(leg: RailLeg) -> Calibration:
    """Return what a jump of the leg depends on besides its bodies and drives."""
    known, period = load_calibration("reference"), leg.control.period_s
    drives = (leg.hip_drive, leg.knee_drive)
    # 1 / omega of each motor on its spring, well below the longest step (``model.longest_step_s``).
    swings_s = [
        drive.ratio * math.sqrt(drive.rotor_inertia_kg_m2 / drive.stiffness_n_m_per_rad)
        for drive in drives
        if drive.stiffness_n_m_per_rad is not None
    ]
    steps = math.ceil(period / min([_STEP_S, *swings_s]) - 1e-9)
    joints = Joints(
        damping_n_m_s_per_rad=leg.joints.damping_n_m_s_per_rad,
        friction_n_m=leg.joints.friction_n_m,
        rotors="absolute",
    )
    simulation = Simulation(
        integrator="Euler",
        timestep_s=period / steps,
        engine="compiled",
        base_slides=False,
        control_period_s=period,
        delay_s=leg.control.delay_s,
        positions_read="half_step_back",
    )
    return replace(
        known,
        name=leg.name,
        version=1,
        joints=joints,
        drive=replace(
            known.drive,
            chain_efficiency=1.0,
            winding_rise_k=0.0,
            elastic=bool(swings_s),
            drive_damping_ratio=leg.joints.drive_damping_ratio,
        ),
        contact=contact_of(leg),
        simulation=simulation,
        stand=Stand(rail_friction_n=leg.base.friction_n / CARRIAGES),
    )


def robot_of_leg(leg: RailLeg, push: Push) -> RobotArrays:
    """Return the leg in the crouch of a push as one robot."""
    drives = (leg.hip_drive, leg.knee_drive)
    links = (leg.thigh, leg.shank)

    def each(name: str) -> Floats:
        return np.array([[getattr(drive, name) for drive in drives]], dtype=float)

    ratio, rotor = each("ratio"), each("rotor_inertia_kg_m2")
    armature, one = rotor * ratio**2, np.ones(1)
    efficiency, torque = each("efficiency"), each("peak_torque_n_m")
    return RobotArrays(
        thigh_length_m=one * leg.thigh.length_m,
        shank_length_m=one * leg.shank.length_m,
        body_mass_kg=np.array([[leg.base.mass_kg, leg.thigh.mass_kg, leg.shank.mass_kg]]),
        body_com_m=np.array([[(0.0, 0.0, 0.0), *((link.com_m[0], 0.0, -link.com_m[1]) for link in links)]]),
        body_inertia_kg_m2=np.array([[np.eye(3), *(np.eye(3) * link.inertia_kg_m2 for link in links)]]),
        foot_radius_m=one * leg.foot.radius_m,
        start_height_m=one * (push.crouch_m + leg.foot.radius_m),
        ratio=ratio,
        armature_kg_m2=armature,
        rotor_inertia_kg_m2=rotor,
        knee_reflected_kg_m2=armature[:, 1],
        knee_coupling_kg_m2=rotor[:, 1] * ratio[:, 1],
        rotor_excess_kg_m2=np.zeros(1),
        sprocket_radius_m=one,
        drive_stiffness_n_m_per_rad=np.nan_to_num(each("stiffness_n_m_per_rad"), nan=1.0),
        peak_torque_n_m=torque,
        rated_torque_n_m=torque,
        continuous_torque_n_m=torque,
        no_load_speed_rad_per_s=each("no_load_speed_rad_per_s"),
        efficiency=efficiency,
        efficiency_total=efficiency,
        torque_constant_n_m_per_a=each("torque_constant_n_m_per_a"),
        winding_resistance_ohm=each("winding_resistance_ohm"),
        cost_eur=np.zeros(1),
        made_parts=np.zeros(1),
        bought_parts=np.zeros(1),
        stand_mass_kg=np.zeros(1),
        reason=("",),
        stops=JointStops(hip=_FREE, knee=_FREE),
    )


def _angles(thigh: float, shank: float, foot_m: tuple[float, float]) -> tuple[float, float]:
    """Return hip and knee with the foot at a place (forward, down) of the hip and the knee in front."""
    forward, down = foot_m
    knee = math.acos((forward**2 + down**2 - thigh**2 - shank**2) / (2.0 * thigh * shank))
    return math.atan2(-forward, down) - math.atan2(shank * math.sin(knee), thigh + shank * math.cos(knee)), knee


def _command(leg: RailLeg, push: Push) -> dict[str, float | tuple[float, float]]:
    """Return the fields of the controller's record that make it push."""
    thigh, shank = leg.thigh.length_m, leg.shank.length_m
    none = (0.0, 0.0)
    limit = push.force_limit_n_m or (leg.hip_drive.peak_torque_n_m, leg.knee_drive.peak_torque_n_m)
    fields: dict[str, float | tuple[float, float]] = {
        "law": PUSH,
        "until_m": push.until_m,
        "at_target": float(push.jacobian == "target"),
        "joint_n_m_per_rad": push.joint_stiffness_n_m_per_rad,
        "joint_n_m_s_per_rad": push.joint_damping_n_m_s_per_rad,
        "force_n": push.force_n,
        "force_n_per_m": push.stiffness_n_per_m,
        "force_n_s_per_m": push.damping_n_s_per_m,
        "foot_m": push.foot_m,
        "foot_m_per_s": push.foot_m_per_s,
        "force_limit_n_m": limit,
        "added_n_m": push.added_n_m,
    }
    if push.foot_m == none:
        return fields
    angles = _angles(thigh, shank, push.foot_m)
    forward, down = push.foot_m
    below = sum(angles)
    # d forward = -down d hip - shank cos d knee; d down = forward d hip - shank sin d knee.
    jacobian = np.array([[-down, -shank * math.cos(below)], [forward, -shank * math.sin(below)]])
    hip, knee = np.linalg.solve(jacobian, push.foot_m_per_s).tolist()
    return fields | {"target_rad": angles, "target_rad_per_s": (hip, knee)}


def replay(leg: RailLeg, series: Series, variations: Variations | None = None) -> dict[str, Floats]:
    """Return push time, take-off speed and apex of a push, as in ``Measured``, with n variations or as given.

    NaN where a push does not lift the foot off the floor by the length of the gate of ``reference``, 10 mm.
    """
    from pareto_monoped.jump.controller import APEX

    calibration, push = calibration_of_leg(leg), series.push
    robots = robot_of_leg(leg, push)
    if variations is not None:
        robots = varied_robots(take(robots, np.zeros(len(variations), dtype=np.intp)), variations)
    angles = _angles(leg.thigh.length_m, leg.shank.length_m, (push.forward_m, push.crouch_m))
    hip, knee = (np.full(len(robots), angle) for angle in angles)
    pose = StartPose(hip_rad=hip, knee_rad=knee, reason=("",) * len(robots))
    jumps = population_of(robots, np.zeros((len(robots), len(CONTROL))), pose, calibration, 1, variations)
    records = jumps.records
    for name, value in _command(leg, push).items():
        records[name] = value
    if variations is not None:  # the drives follow their commands as well as gains are followed
        forces, dampers = variations.gains[:, 0], variations.gains[:, 1]
        for name in ("force_n", "force_n_per_m", "added_n_m"):
            records[name] *= forces[:, None]
        records["joint_n_m_per_rad"] *= forces
        records["force_n_s_per_m"] *= dampers[:, None]
        records["joint_n_m_s_per_rad"] *= dampers
    jumps.run()
    left, speed = left_m(robots, records)
    flown = (records["status"] == APEX) & (records["pushed_s"] > 0.0)
    apex = left + rise_m(robots, records) + _hip_above_com_m(leg) - robots.foot_radius_m
    found = {"push_s": records["pushed_s"], "take_off_m_per_s": speed, "apex_m": apex}
    return {name: np.where(flown, values, np.nan) for name, values in found.items()}


def _hip_above_com_m(leg: RailLeg) -> float:
    """Return how far the hip is above the centre of mass of the leg as it flies."""
    hip, knee = _angles(leg.thigh.length_m, leg.shank.length_m, (0.0, leg.flight_leg_m))

    def below(link: Link, angle: float) -> float:
        return link.com_m[1] * math.cos(angle) + link.com_m[0] * math.sin(angle)

    thigh, shank = leg.thigh, leg.shank
    moment = thigh.mass_kg * below(thigh, hip)
    moment += shank.mass_kg * (thigh.length_m * math.cos(hip) + below(shank, hip + knee))
    return moment / (leg.base.mass_kg + thigh.mass_kg + shank.mass_kg)


def with_term(leg: RailLeg, term: Term, value: float) -> RailLeg:
    """Return the leg with another value of one loss term."""

    def lossy(drive: LegDrive) -> LegDrive:
        return replace(drive, efficiency=max(1.0 - value, 1e-6))

    if term == "efficiency":
        return replace(leg, hip_drive=lossy(leg.hip_drive), knee_drive=lossy(leg.knee_drive))
    if term == "rail":
        return replace(leg, base=replace(leg.base, friction_n=value))
    name = "damping_n_m_s_per_rad" if term == "damping" else "friction_n_m"
    return replace(leg, joints=replace(leg.joints, **{name: value}))


def fitted(leg: RailLeg, series: Series, term: Term) -> float:
    """Return the value of a loss term with which the take-off speed of one series is the measured one.

    More loss, less speed: bisection from no loss up. A push that no longer lifts off counts as too slow.

    Raises:
        SimulationError: even without this loss the leg is too slow.
    """
    assert series.measured is not None
    wanted = series.measured.take_off_m_per_s[0]

    def fast(value: float) -> bool:
        return bool(replay(with_term(leg, term, value), series)["take_off_m_per_s"][0] > wanted)

    low, high = 0.0, TERMS[term]
    if not fast(low):
        raise SimulationError(f"fit of {term}: series {series.name!r} is too slow without it; choose another loss term")
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if fast(middle) else (low, middle)
    return 0.5 * (low + high)
