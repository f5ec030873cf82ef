"""From a searched design to what can be built: whole lengths, real ratios, one leg for both actuators, a pose."""

from dataclasses import dataclass

import numpy as np

from pareto_monoped.actuator.ratiomap import Maps, joint_maps
from pareto_monoped.cad.assembly import Pose
from pareto_monoped.design import Design
from pareto_monoped.errors import DesignError
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.model import start_pose
from pareto_monoped.leg.chain_drives import SAFETY
from pareto_monoped.leg.dimensions import LegDimensions, leg_dimensions
from pareto_monoped.robot.build import Robot, build_robot
from pareto_monoped.robot.population import RobotArrays, robot_arrays

LENGTH_STEP_M = 1e-4  #: Link lengths are made to 0.1 mm.
_SAME_CIRCLE_MM = 0.05  # pitch circles closer than this take each other's screws
_REST = Pose(hip_rad=-0.8, knee_rad=1.6)  # shown when the robot cannot stand in its start pose


@dataclass(frozen=True, slots=True, kw_only=True)
class Built:
    """A design as it is exported."""

    design: Design  #: with lengths of whole 0.1 mm and real ratios
    robot: Robot
    arrays: RobotArrays  #: the robot as it is simulated
    pose: Pose


def built_of(
    design: Design, maps: Maps, calibration: Calibration, *, hip_rad: float | None = None, knee_rad: float | None = None
) -> Built:
    """Build a design in the pose in which its jump starts, or at the given angles.

    Raises:
        DesignError: the robot cannot be built, or its actuators do not fit one leg.
    """
    design = as_built(design, maps)
    robot = build_robot(design, maps)
    require_fit(robot, leg_dimensions(maps))
    arrays = robot_arrays(design.as_array(), maps, calibration.mass)
    pose = assembly_pose(arrays, calibration, hip_rad=hip_rad, knee_rad=knee_rad)
    return Built(design=design, robot=robot, arrays=arrays, pose=pose)


def as_built(design: Design, maps: Maps) -> Design:
    """Return the design with lengths of whole 0.1 mm and its gearboxes' ratios; ``DesignError`` without a gearbox."""
    both = joint_maps(maps)
    thigh_m, shank_m = (
        round(round(length_m / LENGTH_STEP_M) * LENGTH_STEP_M, 4)
        for length_m in (design.thigh_length_m, design.shank_length_m)
    )
    hip, knee = both.hip.lookup(design.hip_ratio).ratio, both.knee.lookup(design.knee_ratio).ratio
    return design.replace({"thigh_length_m": thigh_m, "shank_length_m": shank_m, "hip_ratio": hip, "knee_ratio": knee})


def require_fit(robot: Robot, leg: LegDimensions) -> None:
    """Refuse actuators that do not fit the leg: each joint has one bolt circle at either end, the chain one strength.

    Raises:
        DesignError: a bolt circle differs from the leg's, or the knee's torque exceeds what the chain carries.
    """
    for joint, actuator in (("hip", robot.hip), ("knee", robot.knee)):
        mount, fit = actuator.mount, leg.of(joint)
        drilled = {"bolt circle": 2.0 * fit.mount_pitch_radius_mm, "back's bolt circle": 2.0 * fit.back_pitch_radius_mm}
        circles = (mount.bolts.pitch_circle_mm, mount.back_bolts.pitch_circle_mm)
        for (name, allowed), circle in zip(drilled.items(), circles, strict=True):
            if abs(circle - allowed) > _SAME_CIRCLE_MM:
                raise DesignError(
                    f"{name} of the {joint} actuator = {circle:.1f} mm: must be {allowed:.1f} mm, for which this "
                    f"motor's leg is drilled; choose ratios of one family, or give {actuator.motor.name} a frame as "
                    "wide as its frameless kit"
                )
    torque, allowed = robot.knee.peak_torque_n_m, leg.chain.torque_limit_n_m
    if torque > allowed:
        raise DesignError(
            f"peak torque of the knee actuator = {torque:.1f} N m: must be at most {allowed:.1f} N m, a share of "
            f"1/{SAFETY:g} of what breaks the thigh's chain ({leg.chain.name}); choose a lower knee_ratio"
        )


def assembly_pose(
    arrays: RobotArrays, calibration: Calibration, *, hip_rad: float | None = None, knee_rad: float | None = None
) -> Pose:
    """Return the pose in which the first robot is assembled: that in which its jump starts."""
    start = start_pose(arrays, calibration)
    rest = _REST
    if np.isfinite(start.hip_rad[0]):
        rest = Pose(hip_rad=float(start.hip_rad[0]), knee_rad=float(start.knee_rad[0]))
    return Pose(
        hip_rad=rest.hip_rad if hip_rad is None else hip_rad, knee_rad=rest.knee_rad if knee_rad is None else knee_rad
    )
