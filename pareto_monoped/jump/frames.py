"""The course of many jumps in a few frames each, for an animation or a chart over time.

Batches jump by the engine of the calibration and are read from the controller's records after every step. A trace of
``jump.single`` is MuJoCo's, has more columns and every step, and takes thirty times as long.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import GRAVITY_M_PER_S2, Floats, complete_control
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.engines import Jumping, population_of
from pareto_monoped.jump.model import start_pose
from pareto_monoped.jump.population import Records, threads_for
from pareto_monoped.jump.variations import take
from pareto_monoped.robot.population import RobotArrays

FRAME_COLUMNS = (
    "base_x_m", "base_z_m", "hip_rad", "knee_rad", "hip_rad_per_s", "knee_rad_per_s",
    "hip_motor_torque_n_m", "knee_motor_torque_n_m", "contact_z_n",
)  # fmt: skip
"""Columns of a recording, with the meaning that they have in ``jump.single.TRACE_COLUMNS``."""

# Jumps stepped together: few enough that their whole course fits into some thirty megabytes.
_CHUNK = 64


@dataclass(frozen=True, slots=True, kw_only=True)
class Recording:
    """A jump in a few frames."""

    height_m: float  #: of the apex
    step_s: float  #: time of one step
    lift_off_step: int  #: number of the last step with contact, from 0
    steps: NDArray[np.intp]  #: number of every frame's step
    columns: Mapping[str, Floats]  #: ``FRAME_COLUMNS`` to values, each of shape (frames,)

    @property
    def time_s(self) -> Floats:
        """Time of each frame, shape (frames,)."""
        return self.steps.astype(np.float64) * self.step_s


def frame_steps(lift_off_step: int, last_step: int, frames: int) -> NDArray[np.intp]:
    """Return which steps are kept: two thirds of them before lift-off, when most of the motion takes place.

    Before lift-off and after it, frames lie equally many steps apart except at the first and last frame.
    """
    stance = 2 * frames // 3
    before = max(-(-lift_off_step // (stance - 1)), 1)
    after = max(-(-(last_step - lift_off_step) // (frames - stance)), 1)
    steps = {0, *range(lift_off_step, 0, -before), *range(lift_off_step, last_step, after), last_step}
    return np.array(sorted(steps), dtype=np.intp)


def recordings(
    robots: RobotArrays, control: Floats, calibration: Calibration, frames: int, workers: int = 1
) -> list[Recording | None]:
    """Jump with robots that can stand, and keep at most ``frames`` frames (at least 4) of each jump.

    The list has one recording per robot, in their order; None for a jump that does not reach its apex.
    """
    result: list[Recording | None] = []
    control = complete_control(control)
    for start in range(0, len(robots), _CHUNK):
        rows = np.arange(start, min(start + _CHUNK, len(robots)))
        chosen = take(robots, rows)
        pose = start_pose(chosen, calibration)
        population = population_of(chosen, control[rows], pose, calibration, threads_for(len(rows), workers))
        result += _chosen_frames(_course(population), population.records, frames)
    return result


def _course(population: Jumping) -> list[Floats]:
    """Return ``FRAME_COLUMNS`` at every step of each jump, n arrays of shape (steps, columns)."""
    seen, records = population.observed(), population.records
    body, rails_n = _Bodies.of(records), records["rail_friction_n"]
    return [_of_jump(one, take(body, np.array([i])), rails_n[i]) for i, one in enumerate(seen)]


def _of_jump(seen: Floats, body: "_Bodies", rails_n: float) -> Floats:
    """Return ``FRAME_COLUMNS`` of a jump from ``OBSERVED`` after each of its steps, shape (steps, 16)."""
    position, velocity, directions, torque, _ = np.split(seen, (4, 8, 12, 14), axis=1)
    touches = body.clearance_m(position, directions) <= 0.0
    course: Floats = np.column_stack((position, velocity[:, 2:], torque, touches.astype(np.float64)))
    course[-1:, 6:8] = 0.0  # the controller ends a jump at the beginning of a step
    risen = body.momentum_kg_m_per_s(velocity, directions)
    # What changes the upward momentum is the floor's force against the weight and the friction of rails.
    weight_n = body.mass_kg.sum(axis=1) * GRAVITY_M_PER_S2
    course[:-1, 8] *= np.diff(risen) / body.step_s + weight_n + np.copysign(rails_n, velocity[1:, 1])
    return course


@dataclass(frozen=True, slots=True, kw_only=True)
class _Bodies:
    """What does not change in n jumps, as in ``controller_record.RECORD``."""

    step_s: Floats
    mass_kg: Floats
    thigh_com_m: Floats
    shank_com_m: Floats
    thigh_length_m: Floats
    shank_length_m: Floats
    foot_radius_m: Floats

    @classmethod
    def of(cls, records: Records) -> "_Bodies":
        names = ("thigh_com_m", "shank_com_m", "thigh_length_m", "shank_length_m", "foot_radius_m")
        given = {name: records[name].copy() for name in names}
        mass_kg = records["body_mass_kg"].copy()
        mass_kg[:, 0] += records["stand_mass_kg"]
        return cls(step_s=records["timestep_s"].copy(), mass_kg=mass_kg, **given)

    def clearance_m(self, position: Floats, directions: Floats) -> Floats:
        """Return the gap between foot and floor."""
        reach = self.thigh_length_m * directions[:, 1] + self.shank_length_m * directions[:, 3]
        return np.asarray(position[:, 1] - reach - self.foot_radius_m)

    def momentum_kg_m_per_s(self, velocity: Floats, directions: Floats) -> Floats:
        """Return the upward momentum of the whole robot."""
        rise, hip, below = velocity[:, 1], velocity[:, 2], velocity[:, 2] + velocity[:, 3]
        sin_hip, cos_hip, sin_knee, cos_knee = directions.T
        thigh, shank = self.thigh_com_m, self.shank_com_m
        at_thigh = rise - hip * (cos_hip * thigh[:, 0] + sin_hip * thigh[:, 1])
        at_knee = rise + hip * sin_hip * self.thigh_length_m
        at_shank = at_knee - below * (cos_knee * shank[:, 0] + sin_knee * shank[:, 1])
        return np.asarray(self.mass_kg[:, 0] * rise + self.mass_kg[:, 1] * at_thigh + self.mass_kg[:, 2] * at_shank)


def _chosen_frames(course: list[Floats], records: Records, frames: int) -> list[Recording | None]:
    from pareto_monoped.jump.controller import APEX

    found: list[Recording | None] = []
    for values, record in zip(course, records, strict=True):
        if record["status"] != APEX:
            found.append(None)
            continue
        lift_off = int(record["lift_off_step"]) - 1
        steps = frame_steps(lift_off, int(record["steps"]) - 1, frames)
        found.append(
            Recording(
                height_m=float(record["height_m"]),
                step_s=float(record["timestep_s"]),
                lift_off_step=lift_off,
                steps=steps,
                columns=dict(zip(FRAME_COLUMNS, values[steps].T, strict=True)),
            )
        )
    return found
