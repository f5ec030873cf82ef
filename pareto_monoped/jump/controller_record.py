"""What the controller knows about one jump: settings, robot, memory and measures, as one record of numbers.

``jump.evaluate`` takes a measure from here if the record holds it under its own name, or, as a pair, without "hip" or
"knee". Unlike the controller, this module does not import numba.
"""

import zlib
from pathlib import Path
from typing import Any

import numpy as np

from pareto_monoped.design import KNOT_NAMES

HIP, KNEE = 0, 1
VIRTUAL_LEG, OVER_TIME, OVER_LENGTH, PUSH, OWN, TRACKING = range(6)
"""``law``: what the motors are told, see ``torques.torques``."""
TOUCH_M = 1e-9  #: Clearance that still counts as touching, because of rounding in the start pose.
MOST_DELAY = 8  #: Control periods that a command can be late: 3 ms (bus and driver) at 0.5 ms each, and two more.

_ONE, _BOTH, _STATE = np.float64, (np.float64, (2,)), (np.float64, (4,))
_COMMANDS = (np.float64, (MOST_DELAY + 1, 4))


def _each(kind: Any, *names: str) -> list[tuple[str, Any]]:
    return [(name, kind) for name in names]


RECORD = np.dtype(
    [
        ("status", _ONE),  # one of RUNNING ... TIMEOUT
        # Settings, the same for all jumps under one calibration. Flags are 0 or 1.
        ("rest_length_m", _ONE),
        ("timestep_s", _ONE),
        ("read_back_s", _ONE),  # by which positions belong to a later time than speeds; the controller looks back
        ("period_steps", _ONE),  # steps of one control period, in which the motors' torques are held
        ("delay_periods", _ONE),
        ("step_limit", _ONE),
        ("stages", _ONE),  # calls per step: 4 for a Runge-Kutta integrator
        ("fade_length_m", _ONE),  # 0: torque only while the foot touches the floor
        *_each(_ONE, "latch", "loss_speed_rad_per_s", "voltage_limit", "lags", "mean_speed", "regeneration_share"),
        ("bus", _ONE),  # whether both motors' electrical power is summed before what flows back is cut off
        # The robot.
        *_each(_ONE, "thigh_length_m", "shank_length_m", "foot_radius_m"),
        *_each(_ONE, "stiffness_n_per_m", "damping_n_s_per_m", "torsional_stiffness_n_m_per_rad"),
        ("weight_n", _ONE),  # the term m g of F_z
        *_each(_BOTH, "torque_limit_n_m", "no_load_speed_rad_per_s", "corner_speed_rad_per_s"),
        ("loss", _BOTH),  # share of the torque lost in gears and chain
        ("heat_w_per_n2_m2", _BOTH),  # Joule heat per squared joint torque
        ("knee_release_rad", _ONE),  # 0: the knee's torque does not fade before its stop
        # A second controller, which holds the start pose while the foot is off the floor; 0: no torque there.
        ("flight_stiffness_n_m_per_rad", _ONE),
        ("flight_damping_n_m_s_per_rad", _ONE),
        ("start_rad", _BOTH),
        ("law", _ONE),
        # A torque profile (``torques.between``): its variables, in the order of ``design.KNOT_NAMES``, where or when
        # its first knot is, one over the way to the last one, how many knots it has, and whether it is smooth. An own
        # law has its variables there, too, and the address of its function.
        ("profile", (np.float64, (len(KNOT_NAMES),))),
        *_each(_ONE, "first_knot", "per_profile", "knots", "cubic", "own_address"),
        # The push (``torques.push``) until the foot is ``until_m`` below the hip, which is 0 for other laws. Pairs are
        # forward, down of the foot, or hip, knee.
        *_each(_ONE, "until_m", "at_target", "joint_n_m_per_rad", "joint_n_m_s_per_rad"),
        *_each(_BOTH, "force_n", "force_n_per_m", "force_n_s_per_m", "foot_m", "foot_m_per_s"),
        *_each(_BOTH, "target_rad", "target_rad_per_s", "force_limit_n_m", "added_n_m"),
        # A landing (``landing``): whether this is one; when the foot touched the floor, and over which times from there
        # the leg is caught and then lowered; the foot's depth below the hip in the catch and in the crouch; and for how
        # many steps nothing has moved. The catch is a push whose spring has this place of the foot.
        *_each(_ONE, "landing", "touched_s", "catch_s", "lower_s", "catch_m", "crouch_m", "still_steps"),
        # What the loads are computed from, see ``_loads``.
        ("body_mass_kg", (np.float64, (3,))),
        *_each(_ONE, "stand_mass_kg", "rail_friction_n"),  # what the base lifts besides the robot; of all carriages
        ("thigh_com_m", _BOTH),  # x, z
        ("shank_com_m", _BOTH),
        ("link_inertia_kg_m2", _BOTH),  # of thigh and shank about y, through their centres of mass
        ("armature_kg_m2", _BOTH),
        ("coupling_kg_m2", _ONE),  # of the knee's turning parts with the thigh's rotation
        ("rotor_kg_m2", _BOTH),  # of what turns at the motor's speed, times the ratio: torque per motor acceleration
        *_each(_BOTH, "ratio", "joint_damping_n_m_s_per_rad", "lower_stop_rad", "upper_stop_rad"),
        ("sprocket_radius_m", _ONE),
        # Bumpers under Hunt and Crossley's law: torque, compression over diameter per angle, chi per joint speed.
        *_each(_BOTH, "bumper_n_m", "bumper_per_rad", "bumper_s_per_rad"),
        # Of an elastic drive: stiffness and damping between motor and joint, and the play between them.
        *_each(_BOTH, "drive_n_m_per_rad", "drive_n_m_s_per_rad"),
        ("backlash_rad", _ONE),
        # What the controller remembers from step to step.
        ("stage", _ONE),
        ("steps", _ONE),
        ("height_m", _ONE),  # highest so far
        ("clearance_m", _ONE),
        ("pushed_s", _ONE),  # when a replayed push ended; 0 before
        ("lift_off_step", _ONE),  # last step with contact
        ("lift_off_positions", (np.float64, (2, 4))),  # x, z, hip, knee at that step and at the next
        ("stood", _ONE),  # the foot has touched the floor
        ("off_floor", _ONE),  # the foot has left the floor after it has stood
        ("touched", _ONE),  # contact one step ago
        *_each(_BOTH, "energy_j", "absorbed_j", "drive_loss_j"),
        ("joule_heat_j", _ONE),
        ("winding_heat_j", _BOTH),
        ("electrical_energy_j", _ONE),
        *_each(_BOTH, "peak_torque_n_m", "peak_speed_rad_per_s", "peak_power_w"),
        ("active_steps", _ONE),
        ("saturated_steps", _BOTH),
        ("peak_gear_torque_n_m", _BOTH),
        ("peak_chain_tension_n", _ONE),
        ("peak_stop_torque_n_m", _BOTH),
        ("peak_beyond_stop_rad", _BOTH),  # by which a joint goes beyond an end of its range
        *_each(_ONE, "stop_energy_j", "peak_foot_force_n", "peak_knee_force_n", "drift_m"),
        ("speed_rad_per_s", _BOTH),  # at the start of the current step
        ("motor_torque_n_m", _BOTH),  # during the current step, at the joint before losses
        ("joint_torque_n_m", _BOTH),  # the same after losses
        ("stop_torque_n_m", _BOTH),  # of the bumpers during the current step, under Hunt and Crossley's law
        ("spin_up_rad_per_s2", _BOTH),  # mean acceleration of hip and knee in the last step
        ("periods", _ONE),  # control periods so far
        ("quiet_periods", _ONE),  # control periods since the torque was switched off for good
        ("commands", _COMMANDS),  # of the last periods, in a ring: torques wanted of hip and knee, share of each
        ("position", _STATE),  # x, z, hip, knee at the start of the current step
        ("velocity", _STATE),
        *_each(_BOTH, "motor_rad", "motor_rad_per_s"),  # of the motors there, as angles of their joints
        ("directions", _STATE),  # sine and cosine of the angles of thigh and shank there
    ],
    align=True,
)  #: Everything the controller knows about one jump; pairs are hip, knee. MuJoCo's user data must be float64.
RECORD_NUMBERS = RECORD.itemsize // 8  #: Length of a record in MuJoCo's user data.

OBSERVED = {"position": 4, "velocity": 4, "directions": 4, "motor_torque_n_m": 2, "motor_rad": 2}
"""Fields that tell the course of a jump, read after every call of the controller, with their numbers."""

_COMPILED = ("controller.py", "torques.py", "planar.py")


def origin() -> int:
    """Return a number for everything in this folder that is compiled into the controller and the engine.

    Numba's cache on disk notices changes of a function's own file and of what it closes over, but of no other file.
    """
    folder = Path(__file__).parent
    return zlib.crc32(b"".join((folder / name).read_bytes() for name in _COMPILED) + repr(RECORD.descr).encode())
