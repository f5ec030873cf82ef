"""The replay in an export makes the simulated jump with MuJoCo and NumPy alone."""

import json
import runpy
import subprocess
import sys
from dataclasses import replace
from importlib import resources

import numpy as np
import pytest

from pareto_monoped.cad.write.mjcf import jump_record, replay_script
from pareto_monoped.design import Design
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.document import mjcf
from pareto_monoped.robot.population import robot_arrays

REFERENCE, FIRST = load_calibration("reference"), load_calibration("reference-1")
MACHINE = replace(
    REFERENCE,
    drive=replace(REFERENCE.drive, regeneration_share=0.5, standby_power_w=8.0),
    simulation=replace(REFERENCE.simulation, timestep_s=1e-4, control_period_s=1e-3, delay_s=2e-3),
)
CALIBRATIONS = {"reference": REFERENCE, "reference-1": FIRST, "paper": load_calibration("paper"), "machine": MACHINE}
CALIBRATIONS |= {name: load_calibration(name) for name in ("stand", "reference-3", "stand-1")}
DESIGNS = {
    "low and light": (0.3, 0.3, 4.05, 4.05, 30.0, 5.0, 10.0),
    "long thigh": (0.5, 0.31, 5.0, 6.0, 20.0, 2.0, 30.0),
    "long shank": (0.31, 0.5, 8.2, 4.05, 60.0, 0.0, 0.0),
    "strong": (0.5, 0.5, 8.2, 8.2, 200.0, 10.0, 50.0),
    "every variable": (0.45, 0.4, 6.0, 4.4, 40.0, 3.0, 12.0, 0.4, 4.0, 0.45),
}


def run(folder, *place):
    command = [sys.executable, "-I", "replay.py", *place]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


# Every design and every calibration in one case at least.
EVERY_TIME = {
    "low and light": ("reference", "stand-1"),
    "long thigh": ("reference-1",),
    "long shank": ("paper", "reference-3"),
    "strong": ("stand",),
    "every variable": ("machine",),
}


@pytest.mark.parametrize(
    ("name", "known"),
    [
        pytest.param(name, known, marks=() if known in EVERY_TIME[name] else pytest.mark.long)
        for name in DESIGNS
        for known in CALIBRATIONS
    ],
)
def test_five_very_different_designs_jump_the_same(name, known, actuator_map, tmp_path, monkeypatch, capsys):
    design, calibration = Design.from_array(DESIGNS[name]), CALIBRATIONS[known]
    arrays = robot_arrays(design.as_array(), actuator_map, calibration.mass)
    (tmp_path / "monoped.xml").write_text(mjcf(arrays, calibration))
    (tmp_path / "jump.json").write_text(jump_record(arrays, design, calibration))
    (tmp_path / "replay.py").write_text(replay_script())
    expected = json.loads((tmp_path / "jump.json").read_text())["expected"]
    if not np.isfinite(expected["height_m"]) or expected["height_m"] < 0.0:
        pytest.skip("this design does not jump under this calibration")
    ended = replayed(tmp_path, monkeypatch)
    assert ended == 0
    assert f"{expected['height_m']:.9f}" in capsys.readouterr().out


def replayed(folder, monkeypatch, *place):
    """How the replay ends in this process."""
    monkeypatch.chdir(folder)
    monkeypatch.setattr(sys, "argv", ["replay.py", *place])
    with pytest.raises(SystemExit) as ended:
        runpy.run_path("replay.py", run_name="__main__")
    return ended.value.code


def test_an_export_replays_its_own_jumps(exported, monkeypatch, capsys):
    """One as its user calls it: a process of its own, which sees nothing of this package."""
    found = run(exported.folder / "model")
    assert found.returncode == 0, found.stdout + found.stderr
    assert f"{exported.record['jumps']['as_built']['energy_j']:.9f}" in found.stdout
    assert replayed(exported.folder / "model", monkeypatch, "stand") == 0
    assert f"{exported.record['jumps']['stand']['energy_j']:.9f}" in capsys.readouterr().out


def test_a_changed_number_is_another_jump(exported, tmp_path, monkeypatch):
    for path in (exported.folder / "model").iterdir():
        if path.is_file():
            (tmp_path / path.name).write_bytes(path.read_bytes())
    (tmp_path / "meshes").symlink_to((exported.folder / "model" / "meshes").resolve())
    numbers = json.loads((tmp_path / "jump.json").read_text())
    numbers["loss"][1] += 1e-6
    (tmp_path / "jump.json").write_text(json.dumps(numbers))
    assert "not the jump of this export" in replayed(tmp_path, monkeypatch)


def test_the_replay_is_short_and_needs_two_packages():
    text = replay_script()
    assert len(text.splitlines()) <= 165
    imported = {line.split()[1].split(".")[0] for line in text.splitlines() if line.startswith(("import ", "from "))}
    assert imported == {"json", "sys", "pathlib", "mujoco", "numpy"}


def test_a_motor_that_brakes_has_its_whole_torque_and_one_that_drives_loses_it_with_speed():
    """No-load speed 30 rad/s, whole torque of 10 N m up to 10 rad/s: half of it is left at 20, either way round."""
    limited = runpy.run_path(str(resources.files("pareto_monoped") / "data" / "replay.py"))["limited"]
    jump = {
        "torque_limit_n_m": [10.0, 10.0],
        "voltage_limit": True,
        "no_load_speed_rad_per_s": [30.0, 30.0],
        "corner_speed_rad_per_s": [10.0, 10.0],
    }
    for speed, left in ((5.0, 10.0), (20.0, 5.0), (25.0, 2.5), (40.0, 0.0), (-20.0, 10.0), (-40.0, 10.0)):
        found = limited(jump, np.array([99.0, -99.0]), np.array([speed, -speed]))
        assert found.tolist() == [left, -left], speed
