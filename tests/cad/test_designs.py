"""Robots over the whole design space pass every check: both families, all published gear sets, all link lengths."""

import csv
from itertools import pairwise

import mujoco
import numpy as np
import pytest

from pareto_monoped.actuator.motors import motor_names
from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.assembly import Pose
from pareto_monoped.cad.check.run import run_checks
from pareto_monoped.cad.export import export_design
from pareto_monoped.cad.product import build_product
from pareto_monoped.cad.write import files
from pareto_monoped.cad.write.meshes import visuals
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.robot.build import build_robot
from pareto_monoped.robot.population import robot_arrays

# Lengths at and between their bounds; the published ratios 4.0, 6.0, 7.9, the ends of both families, and others.
_RATIOS = (4.0, 6.0, 7.9, 8.6, 4.55, 5.25, 5.95, 6.45, 7.05, 8.25)
_LENGTHS = np.random.default_rng(20250101).uniform(0.3, 0.5, size=(20, 2)).round(4)
_LENGTHS[:4] = [(0.3, 0.3), (0.5, 0.5), (0.3, 0.5), (0.5, 0.3)]
DESIGNS = [(*lengths, _RATIOS[k % 10], _RATIOS[(3 * k + k // 10) % 10]) for k, lengths in enumerate(_LENGTHS.tolist())]


def failures(product, arrays):
    others = files.other_meshes(product, visuals(product), ("3mf", "glb"))
    checks = run_checks(product, arrays, part_files=files.part_meshes(product), other_files=others)
    return [failure for check in checks for failure in check.failures]


@pytest.mark.long
@pytest.mark.parametrize("numbers", DESIGNS, ids=lambda numbers: "-".join(f"{number:g}" for number in numbers))
def test_a_design_passes_every_check(actuator_map, numbers):
    thigh, shank, knee_ratio, hip_ratio = numbers
    design = PAPER_CASES["C"].design.replace(
        {"thigh_length_m": thigh, "shank_length_m": shank, "knee_ratio": knee_ratio, "hip_ratio": hip_ratio}
    )
    product = build_product(build_robot(design, actuator_map), Pose(hip_rad=-0.6, knee_rad=1.2))
    assert failures(product, robot_arrays(design.as_array(), actuator_map)) == []


# Both families, where a motor has both.
_MOTORS = {"U12": (8.0, 4.5), "U8": (5.0, 6.8), "U10": (8.0, 4.5), "MN8014": (8.0, 4.5), "MAD_M6C12": (6.0, 5.0)}


@pytest.mark.long
@pytest.mark.parametrize("motor", motor_names())
def test_a_robot_of_any_motor_is_exported(motor, calibration, tmp_path):
    """Its actuators fit one leg, its files load, its parts list adds up to its mass; a short thigh, a long shank."""
    knee_ratio, hip_ratio = _MOTORS.get(motor, (7.9, 4.0))
    design = PAPER_CASES["C"].design.replace(
        {"thigh_length_m": 0.3, "shank_length_m": 0.5, "knee_ratio": knee_ratio, "hip_ratio": hip_ratio}
    )
    formats = ("dxf", "mjcf", "urdf")
    summary = export_design(design, map_for(motor), calibration, tmp_path / "robot", formats=formats)
    assert all(check.passed for check in summary.checks)
    assert summary.record["jumps"]["as_built"]["status"] == "ok"
    for name in ("monoped.xml", "monoped.urdf"):
        mujoco.MjModel.from_xml_path(str(tmp_path / "robot" / "model" / name))
    with (tmp_path / "robot" / "bom.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert sum(float(row["total_g"]) for row in rows) == pytest.approx(1e3 * summary.record["mass_kg"], abs=0.5)
    assert {row["made_or_bought"] for row in rows} == {"made", "bought"}
    assert all("links of" in row["note"] for row in rows if row["part"].startswith("chain_"))
    for path in (tmp_path / "robot" / "laser").iterdir():
        codes = [line.strip() for line in path.read_text().split("ENTITIES")[1].splitlines()]
        assert {following for code, following in pairwise(codes) if code == "8"} == {"CUT", "NOTES"}


@pytest.mark.long
@pytest.mark.parametrize("motor", _MOTORS)
def test_a_robot_of_any_motor_passes_every_check(motor):
    knee_ratio, hip_ratio = _MOTORS[motor]
    design = PAPER_CASES["C"].design.replace({"thigh_length_m": 0.3, "knee_ratio": knee_ratio, "hip_ratio": hip_ratio})
    actuator_map = map_for(motor)
    product = build_product(build_robot(design, actuator_map), Pose(hip_rad=-0.6, knee_rad=1.2))
    assert failures(product, robot_arrays(design.as_array(), actuator_map)) == []
