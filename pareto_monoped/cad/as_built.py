"""From a searched design to what can be built: whole lengths, real ratios, one leg for both actuators, a pose.

What was built, what it was made with and what came out stand in its record, ``design.json``, from which an export can
be made again.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pareto_monoped import __version__
from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.motors import motor_values
from pareto_monoped.actuator.ratiomap import JointMaps, Maps, joint_maps
from pareto_monoped.cad.assembly import Pose
from pareto_monoped.definition.provenance import digest
from pareto_monoped.design import Design
from pareto_monoped.errors import DesignError
from pareto_monoped.jump.calibration import Calibration, calibration_values
from pareto_monoped.jump.model import start_pose
from pareto_monoped.leg.dimensions import SAFETY, LegDimensions, leg_dimensions
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


_DIGITS = 12  # of a design's hash: two of a million designs share one with a probability of 0.2 percent
MADE_BY = f"pareto-monoped {__version__}"  #: Program and version, as written into every record.


def design_record(
    *,
    searched: Design,
    built: Built,
    maps: JointMaps,
    calibration: Calibration,
    source: Mapping[str, Any] | None,
    formats: Sequence[str],
    strength: bool,
) -> dict[str, Any]:
    """Return the content of ``design.json`` before its jumps are simulated, apart from the list of files."""
    rules, values = maps.rules, [motor_values(motor) for motor in maps.motors]
    # Records with one motor hold it alone, as they did before there could be two.
    motor_data = values[0] if len(values) == 1 else dict(zip(("hip", "knee"), values, strict=True))
    return {
        "made_by": MADE_BY,
        "motor": maps.label,
        "calibration": calibration.label,
        # Records made before there were other rules do not name them.
        **({} if rules == "paper" else {"rules": rules}),
        "source": dict(source or {}),
        "searched": searched.as_dict(),
        "design_hash": digest({"searched": searched.as_dict(), "rules": rules, "motor": motor_data})[:_DIGITS],
        "as_built": built.design.as_dict(),
        "jumps": {},
        "mass_kg": built.robot.mass_kg,
        "cost_eur": float(built.robot.cost.total_eur),
        "strength": strength,
        "pose": {"hip_rad": built.pose.hip_rad, "knee_rad": built.pose.knee_rad},
        "actuators": {
            name: _actuator(actuator) | ({"stand_in": note} if (note := maps.of(name).stand_in(ratio)) else {})
            for name, actuator, ratio in (
                ("hip", built.robot.hip, searched.hip_ratio),
                ("knee", built.robot.knee, searched.knee_ratio),
            )
        },
        "formats": list(formats),
        "motor_data": motor_data,
        "calibration_data": calibration_values(calibration),
    }


def _actuator(actuator: Actuator) -> dict[str, Any]:
    """Return gears and figures of an actuator; profile shifts (over the module) and rating only where it has them."""
    gears, rating = actuator.gears, actuator.rating
    shifts = {
        "sun_shift": float(gears.sun_shift),
        "planet_shift": float(gears.planet_shift),
        "ring_shift": float(gears.ring_shift),
        "centre_distance_mm": float(gears.carrier_radius_mm),
    }
    return {
        "family": actuator.family,
        "sun_teeth": int(gears.sun_teeth),
        "planet_teeth": int(gears.planet_teeth),
        "ring_teeth": int(gears.ring_teeth),
        "module_mm": float(gears.module_mm),
        "planets": int(gears.planets),
        **(shifts if gears.is_shifted else {}),
        "face_width_mm": actuator.face_width_mm,
        "ratio": actuator.ratio,
        "mass_kg": actuator.mass_kg,
        "peak_torque_n_m": actuator.peak_torque_n_m,
        "length_mm": actuator.length_mm,
        **({} if rating is None else {"rating": rating.as_dict()}),
    }
