"""``model/jump.json`` and ``model/replay.py``: what the jump needs besides the MJCF, and a program that makes it."""

import json
from importlib import resources

import numpy as np

from pareto_monoped.design import CONTROL, Design, columns
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.evaluate import evaluate_robots
from pareto_monoped.jump.population import first_records
from pareto_monoped.robot.population import RobotArrays

_NUMBERS = (
    *CONTROL[:-1],
    "timestep_s",
    "step_limit",
    "period_steps",
    "read_back_s",
    "delay_periods",
    "fade_length_m",
    "latch",
    "lags",
    "mean_speed",
    "voltage_limit",
    "loss_speed_rad_per_s",
    "regeneration_share",
    "thigh_length_m",
    "shank_length_m",
    "foot_radius_m",
    "weight_n",
    "torque_limit_n_m",
    "no_load_speed_rad_per_s",
    "corner_speed_rad_per_s",
    "loss",
    "heat_w_per_n2_m2",
    "lower_stop_rad",
    "flight_stiffness_n_m_per_rad",
    "flight_damping_n_m_s_per_rad",
    "start_rad",
)
"""Fields of the controller's record that the replay reads; the start height stands in the MJCF's keyframe."""
_EXPECTED = ("height_m", "energy_j", "electrical_energy_j")


def jump_record(arrays: RobotArrays, design: Design, calibration: Calibration) -> str:
    """The content of ``jump.json``.

    Args:
        arrays: the robot as it is simulated, one row.
        design: as it is built.
        calibration: the jump model.
    """
    from pareto_monoped.jump.controller import TOUCH_M

    control = columns(design.as_array()[None], CONTROL)
    record, jump = first_records(arrays, control, calibration)[0], evaluate_robots(arrays, control, calibration)
    numbers = {name: _finite(record[name]) for name in _NUMBERS}
    numbers |= {"touch_m": TOUCH_M, "standby_power_w": calibration.drive.standby_power_w}
    numbers["expected"] = {name: _finite(getattr(jump, name)[0]) for name in _EXPECTED}
    return json.dumps(numbers, indent=2) + "\n"


def _finite(value: np.ndarray) -> object:
    """Plain numbers; an infinite one, such as the stop of a joint without any, becomes one that no joint reaches."""
    return np.nan_to_num(np.asarray(value, dtype=np.float64), posinf=1e9, neginf=-1e9, nan=-1.0).tolist()


def replay_script() -> str:
    """The text of ``replay.py``, which needs MuJoCo and NumPy only."""
    return (resources.files("pareto_monoped") / "data" / "replay.py").read_text(encoding="utf-8")
