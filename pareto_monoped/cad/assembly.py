"""Where every instance of every part stands: the robot taken apart into named, placed instances.

Frames are 4 x 4 matrices in millimetres. The assembly's frame has its origin on the hip axis in the middle plane of the
leg, x forward, y to the left (the joint axes), z up, as the body frames of ``robot`` at zero joint angles.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import Group
from pareto_monoped.robot.build import Robot, Unit
from pareto_monoped.robot.units import PART_TO_BODY

if TYPE_CHECKING:
    from pareto_monoped.actuator.actuator import Actuator

Matrix = NDArray[np.float64]

ACTUATOR_UNITS: Mapping[str, str] = {"hip_actuator": "hip", "knee_actuator": "knee"}
"""The units that are actuators, each with the joint that it drives."""
_TURNED_BY: Mapping[str, str] = {**ACTUATOR_UNITS, "thigh": "knee"}
"""The joint with which the moving parts of a unit turn; in the thigh these are the chain's sprocket and its axle."""
_APART_MM = 6.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Pose:
    """Joint angles about +y; at zero the leg hangs straight down."""

    hip_rad: float
    knee_rad: float

    def angle_rad(self, joint: str) -> float:
        """Return the angle of a joint, ``hip`` or ``knee``."""
        return {"hip": self.hip_rad, "knee": self.knee_rad}[joint]


@dataclass(frozen=True, slots=True, kw_only=True)
class Instance:
    """One instance of a part."""

    name: str  #: unique in the assembly, ``unit/part`` with a number if there are several
    unit: str
    part: Part  #: instances of one part of one unit share it
    body: str  #: ``base``, ``thigh`` or ``shank``: what its mass counts for
    in_body: Matrix  #: from the part's frame to the body frame, at zero joint angles
    moves: Matrix  #: the same at the asked pose, with what turns inside the actuators turned
    world: Matrix  #: from the part's frame to the assembly's frame at the asked pose


def instances(robot: Robot, pose: Pose, *, only: str | None = None) -> tuple[Instance, ...]:
    """Return every instance of every part of a robot in a pose, or of the unit named ``only``."""
    frames = body_frames(robot, pose)
    found = []
    for unit in robot.units:
        if only not in (None, unit.name):
            continue
        joint = _TURNED_BY.get(unit.name)
        output_rad = 0.0 if joint is None else pose.angle_rad(joint)
        for part in unit.parts:
            rest = list(_places(robot, unit, part, 0.0))
            turned = list(_places(robot, unit, part, output_rad))
            for k, (at_rest, at_pose) in enumerate(zip(rest, turned, strict=True)):
                number = f"_{k + 1}" if len(rest) > 1 else ""
                found.append(
                    Instance(
                        name=f"{unit.name}/{part.name}{number}",
                        unit=unit.name,
                        part=part,
                        body=unit.body,
                        in_body=at_rest,
                        moves=at_pose,
                        world=frames[unit.body] @ at_pose,
                    )
                )
    return tuple(found)


def body_frames(robot: Robot, pose: Pose) -> dict[str, Matrix]:
    """Return the matrices from each body frame to the assembly's frame (forward kinematics)."""
    base = np.eye(4)
    thigh = base @ turn_y(pose.hip_rad)
    shank = thigh @ shift(0.0, 0.0, -1000.0 * robot.design.thigh_length_m) @ turn_y(pose.knee_rad)
    return {"base": base, "thigh": thigh, "shank": shank}


def unit_frame(unit: Unit) -> Matrix:
    """Return the matrix from a unit's frame to its body's frame."""
    frame = np.eye(4)
    frame[:3, :3] = PART_TO_BODY @ unit.turn
    frame[:3, 3] = PART_TO_BODY @ np.array([0.0, 0.0, unit.z_mm])
    return frame


def turn_y(angle_rad: float) -> Matrix:
    """Return a rotation about the y axis."""
    matrix = np.eye(4)
    cos, sin = np.cos(angle_rad), np.sin(angle_rad)
    matrix[0, 0], matrix[0, 2], matrix[2, 0], matrix[2, 2] = cos, sin, -sin, cos
    return matrix


def turn_z(angle_rad: float) -> Matrix:
    """Return a rotation about the z axis."""
    matrix = np.eye(4)
    cos, sin = np.cos(angle_rad), np.sin(angle_rad)
    matrix[0, 0], matrix[0, 1], matrix[1, 0], matrix[1, 1] = cos, -sin, sin, cos
    return matrix


def shift(x: float, y: float, z: float) -> Matrix:
    """Return a translation."""
    matrix = np.eye(4)
    matrix[:3, 3] = (x, y, z)
    return matrix


def _places(robot: Robot, unit: Unit, part: Part, output_rad: float) -> Iterator[Matrix]:
    """Yield the matrix from each instance of a part to the unit's body frame, the output turned by ``output_rad``."""
    frame = unit_frame(unit)
    # The joint axis is the unit's z axis up to its sign.
    theta = output_rad * float(frame[1, 2])
    actuator = {"hip": robot.hip, "knee": robot.knee}.get(ACTUATOR_UNITS.get(unit.name, ""))
    whole, spin = turns(actuator, part, theta)
    for place in part.places_mm:
        at = frame @ shift(*(float(v) for v in place))
        radius, count = float(part.pitch_radius_mm), int(part.count)
        for k in range(count):
            angle = 2.0 * np.pi * k / count
            if radius == 0.0:
                yield at @ turn_z(whole)
                continue
            around = float(part.phase_rad) + angle
            yield at @ turn_z(whole + around) @ shift(radius, 0.0, 0.0) @ turn_z(spin(angle))


def turns(actuator: "Actuator | None", part: Part, theta_rad: float) -> tuple[float, Callable[[float], float]]:
    """Return the turn of a part about its unit's z axis when the unit's output has turned by ``theta_rad``.

    The first value turns the whole circle of instances, the second leads from an instance's angle on it to its own turn
    on its place. A planetary gear has a fixed ring: the carrier is the output, the sun turns by the ratio, and a planet
    turns against its carrier by -z_ring / z_planet of the carrier's angle. The planet's outline is drawn for the place
    on the x axis; at angle a it is turned on by a z_sun / z_planet against its carrier to meet the sun's teeth.
    """
    if actuator is None:
        return (theta_rad if part.group is Group.KNEE_DRIVE else 0.0), lambda _: 0.0
    if part.group is Group.ROTOR:
        return actuator.ratio * theta_rad, lambda _: 0.0
    if part.group is Group.OUTPUT:
        return theta_rad, lambda _: 0.0
    if part.group is Group.PLANET:
        gears = actuator.gears
        rolled = -theta_rad * gears.ring_teeth / gears.planet_teeth
        return theta_rad, lambda place: place * gears.sun_teeth / gears.planet_teeth + rolled
    return 0.0, lambda _: 0.0


def pulled_apart(boxes_mm: NDArray[np.float64], axis: int) -> list[float]:
    """Return how far boxes, corners of shape (n, 6), move along an axis so that those behind each other come apart."""
    low, high = boxes_mm[:, axis], boxes_mm[:, axis + 3]
    order = np.argsort(0.5 * (low + high), kind="stable")
    moved = np.zeros(len(boxes_mm))
    middle = float(np.median(0.5 * (low + high)))
    right = [k for k in order.tolist() if 0.5 * (low[k] + high[k]) >= middle]
    left = [k for k in reversed(order.tolist()) if 0.5 * (low[k] + high[k]) < middle]
    done: list[int] = []  # of both sides: a screw may lie on the other side of the middle than what it is in
    for side, sign in ((right, 1.0), (left, -1.0)):
        for k in side:
            front = float(low[k] if sign > 0.0 else high[k])
            for other in done:
                if _beside(boxes_mm[k], boxes_mm[other], axis):
                    continue
                back = float((high if sign > 0.0 else low)[other] + moved[other])
                moved[k] = sign * max(sign * moved[k], sign * (back - front) + _APART_MM)
            done.append(k)
    return [float(move) for move in moved]


def _beside(one: NDArray[np.float64], other: NDArray[np.float64], axis: int) -> bool:
    """Return whether two boxes do not lie behind each other along the axis."""
    across = [k for k in range(3) if k != axis]
    return any(one[k] >= other[k + 3] or other[k] >= one[k + 3] for k in across)
