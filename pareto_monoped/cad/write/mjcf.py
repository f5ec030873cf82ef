"""MJCF: the simulated model with visual meshes and colliders, what else its jump needs, and a program that makes it."""

import json
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from importlib import resources

import numpy as np

from pareto_monoped.cad.write.meshes import Collider, Visual, numbers
from pareto_monoped.design import PAPER_CONTROL, Design, control_of
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.evaluate import evaluate_robots
from pareto_monoped.jump.population import first_records
from pareto_monoped.robot.population import RobotArrays

_NUMBERS = (
    *(*PAPER_CONTROL, "knee_release_rad", "rest_length_m"),
    *("timestep_s", "step_limit", "period_steps", "read_back_s", "delay_periods", "fade_length_m", "latch", "lags"),
    *("mean_speed", "voltage_limit", "loss_speed_rad_per_s", "regeneration_share", "thigh_length_m", "shank_length_m"),
    *("foot_radius_m", "weight_n", "torque_limit_n_m", "no_load_speed_rad_per_s", "corner_speed_rad_per_s", "loss"),
    *(
        "heat_w_per_n2_m2",
        "lower_stop_rad",
        "upper_stop_rad",
        "bumper_n_m",
        "bumper_per_rad",
        "bumper_s_per_rad",
        "bus",
        "ratio",
        "rotor_kg_m2",
        "sprocket_radius_m",
        "flight_stiffness_n_m_per_rad",
        "flight_damping_n_m_s_per_rad",
        "start_rad",
    ),
)
"""Fields of the controller's record that the replay reads, or that give loads; the start stands in the keyframe."""
_EXPECTED = (
    *("height_m", "energy_j", "electrical_energy_j", "peak_gear_torque_hip_n_m", "peak_gear_torque_knee_n_m"),
    *("peak_chain_tension_n", "peak_stop_torque_n_m", "peak_foot_force_n"),
)
"""Measures that the replay and other simulators are held against."""


def mjcf_with_meshes(document: str, shown: Sequence[Visual], solid: Sequence[Collider]) -> str:
    """Return the simulation's MJCF with visual meshes ``meshes/NAME.stl`` (group 2) and colliders (group 3) added.

    The colliders meet each other but not the floor (contype and conaffinity 2). The document therefore still makes the
    very jump that was simulated, in which only the foot touches the ground.
    """
    root = ET.fromstring(document, parser=ET.XMLParser(target=ET.TreeBuilder(insert_comments=True)))
    compiler = root.find("compiler")
    assert compiler is not None
    compiler.set("meshdir", "meshes")
    asset = ET.Element("asset")
    for visual in shown:
        ET.SubElement(asset, "mesh", name=visual.name, file=f"{visual.name}.stl")
    root.insert(list(root).index(compiler) + 1, asset)
    for body in root.iter("body"):
        for visual in shown:
            if visual.body == body.get("name"):
                _add_visual(body, visual)
        for collider in solid:
            if collider.body == body.get("name"):
                _add_collider(body, collider)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def _add_visual(body: ET.Element, visual: Visual) -> None:
    shown = {"name": f"{visual.name}_visual", "type": "mesh", "mesh": visual.name, "contype": "0", "conaffinity": "0"}
    ET.SubElement(body, "geom", shown, group="2", rgba=numbers(*visual.colour, 1.0))


def _add_collider(body: ET.Element, collider: Collider) -> None:
    shape = {"name": f"{collider.name}_collider", "type": collider.shape, "size": numbers(*collider.size)}
    shape |= {"pos": numbers(*collider.position), "contype": "2", "conaffinity": "2"}
    geom = ET.SubElement(body, "geom", shape, group="3", rgba="0.2 0.5 0.9 0.2")
    if collider.shape == "cylinder":
        geom.set("zaxis", "0 1 0")


def jump_record(arrays: RobotArrays, design: Design, calibration: Calibration) -> str:
    """Return the content of ``jump.json``, or of ``jump_stand.json`` under a calibration with a stand."""
    from pareto_monoped.jump.controller_record import TOUCH_M

    control = control_of(design.as_array()[None])
    record = first_records(arrays, control, calibration)[0]
    jump = evaluate_robots(arrays, control, calibration.by("mujoco"))
    numbers = {name: _finite(record[name]) for name in _NUMBERS}
    numbers |= calibration.controller.law.record_of(record)
    numbers |= {"touch_m": TOUCH_M, "standby_power_w": calibration.drive.standby_power_w}
    numbers["expected"] = {name: _finite(getattr(jump, name)[0]) for name in _EXPECTED}
    return json.dumps(numbers, indent=2) + "\n"


def _finite(value: np.ndarray) -> object:
    """Return plain numbers; an infinite one, such as the stop of a joint without any, becomes one out of reach."""
    return np.nan_to_num(np.asarray(value, dtype=np.float64), posinf=1e9, neginf=-1e9, nan=-1.0).tolist()


def replay_script() -> str:
    """Return the text of ``replay.py``, which needs MuJoCo and NumPy only."""
    return (resources.files("pareto_monoped") / "data" / "replay.py").read_text(encoding="utf-8")
