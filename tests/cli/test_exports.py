"""The export command: what it refuses, and one small export."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from pareto_monoped.cad import jobs
from pareto_monoped.cli.exports import _duration, _radians
from tests.cli.support import STORED, run


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("export", "-o", "x"), "no DB given"),
        (("export", "--case", "C", "--knee", "-o", "x"), "--case C takes no DB and no selector"),
        (("export", "study.db", "--front", "--knee", "-o", "x"), "--front takes no selector"),
        (("export", "study.db", "-o", "x"), "no selector given"),
        (("export", "missing.db", "--knee", "-o", "x"), "missing.db"),
        (("export", "study.db", "--knee", "--rules", "paper", "-o", "x"), "--rules goes with --case only"),
        (("export", "study.db", "--knee", "--motor", "U12", "-o", "x"), "--motor goes with --case only"),
        (("export", "--case", "C", "--motor", "U99", "-o", "x"), "motor = 'U99'"),
        (("export", "study.db", "--knee", "--knee-motor", "U8", "-o", "x"), "--knee-motor goes with --case only"),
        (("export", "--case", "C", "--hip-motor", "U8", "-o", "x"), "--knee-motor is missing"),
        (("export", "--case", "C", "--motor", "U8", "--hip-motor", "U8", "-o", "x"), "--motor stands for both joints"),
        (("export", "--case", "C", "--hip-motor", "U8", "--knee-motor", "U99", "-o", "x"), "motor = 'U99'"),
        (("export", "--case", "C", "--formats", "step,dwg", "-o", "x"), "format = 'dwg'"),
    ],
)
def test_bad_requests_are_one_line_and_write_nothing(capsys, tmp_path, monkeypatch, words, message):
    monkeypatch.chdir(tmp_path)
    code, out, err = run(capsys, *words)
    assert code == 2
    assert out == ""
    assert message in err
    assert len(err.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("unchecked")
def test_why_a_design_was_picked_is_said_in_lines_that_fit_a_terminal_and_drawings_can_be_left_out(capsys, tmp_path):
    folder = tmp_path / "knee"
    words = ("export", STORED, "--knee", "--formats", "dxf,pdf", "--no-drawings")
    code, _, err = run(capsys, *words, "-o", folder)
    assert code == 0
    assert json.loads((folder / "design.json").read_text())["formats"] == ["dxf"]
    assert not (folder / "drawings").exists()
    assert re.search(r"\ntrial 64 .*\n  ", err)  # in more than one line, and no line is too long
    assert max(len(line) for line in err.splitlines() if str(tmp_path) not in line) <= 80


@pytest.mark.usefixtures("unchecked")
@pytest.mark.long
def test_a_case_of_the_paper_is_exported_with_another_motor(capsys, tmp_path):
    folder = tmp_path / "case"
    code, out, err = run(capsys, "export", "--case", "C", "--motor", "U12", "--formats", "dxf", "-o", folder)
    assert code == 0
    assert [line.split()[0] for line in out.splitlines()] == ["searched", "as"]
    assert "building" in err
    record = json.loads((folder / "design.json").read_text())
    assert record["source"] == {"case": "C"}
    assert record["motor"] == record["motor_data"]["name"] == "U12"
    assert sorted(path.name for path in (folder / "laser").iterdir()) == [
        "base_near_cheek.dxf",
        "hip_driver_plate.dxf",
        "knee_driver_plate.dxf",
        "shank_plate_far.dxf",
        "shank_plate_near.dxf",
        "thigh_plate_inner.dxf",
        "thigh_plate_outer.dxf",
    ]


@pytest.mark.parametrize(("words", "strength"), [((), None), (("--no-strength",), False)])
def test_strength_is_asked_of_the_designs_of_a_front_unless_it_is_left_out(
    capsys, tmp_path, monkeypatch, words, strength
):
    asked = []
    monkeypatch.setattr(jobs, "front_jobs", lambda data, **how: asked.append(how) or [])
    run(capsys, "export", STORED, "--front", *words, "-o", tmp_path / "out")
    assert [how["strength"] for how in asked] == [strength]


@pytest.mark.long
@pytest.mark.parametrize(("hip", "knee"), [("U8", "VT8020"), ("U12", "MN8014")])
def test_a_case_is_exported_with_different_motors_and_again_from_its_record(capsys, tmp_path, hip, knee):
    """All checks of the machine hold: sweep, overlap, seats, watertight parts, masses."""
    words = ("export", "--case", "C", "--hip-motor", hip, "--knee-motor", knee, "--no-strength", "--formats", "dxf")
    code, _, _ = run(capsys, *words, "-o", tmp_path / "one")
    record = json.loads((tmp_path / "one" / "design.json").read_text())
    assert (code, record["motor"]) == (0, f"{hip} hip, {knee} knee")
    assert {joint: values["name"] for joint, values in record["motor_data"].items()} == {"hip": hip, "knee": knee}
    assert all(check["passed"] for check in json.loads((tmp_path / "one" / "checks.json").read_text()))
    assert f"with motor {hip} hip, {knee} knee" in (tmp_path / "one" / "README.md").read_text()
    code, _, _ = run(capsys, "export", "--record", tmp_path / "one" / "design.json", "-o", tmp_path / "two")
    assert code == 0
    for path in (tmp_path / "one").rglob("*"):
        if path.is_file():
            assert (tmp_path / "two" / path.relative_to(tmp_path / "one")).read_bytes() == path.read_bytes()


@pytest.mark.usefixtures("unchecked")
@pytest.mark.long
def test_a_motor_named_for_both_joints_is_exported_as_one(capsys, tmp_path):
    """Byte for byte."""
    for folder, words in (("one", ("--motor", "U8")), ("both", ("--hip-motor", "U8", "--knee-motor", "u8"))):
        code, _, _ = run(
            capsys, "export", "--case", "C", *words, "--no-strength", "--formats", "dxf,mjcf", "-o", tmp_path / folder
        )
        assert code == 0
    names = {path.relative_to(tmp_path / "one") for path in (tmp_path / "one").rglob("*") if path.is_file()}
    assert len(names) > 20
    for name in names:
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "both" / name).read_bytes()


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.4, "0 s"), (99.4, "99 s"), (99.6, "2 min"), (3569.0, "59 min"), (5969.0, "99 min"), (11100.0, "3 h 05 min")],
)
def test_a_time_to_wait_in_words(seconds, words):
    assert _duration(seconds) == words


@pytest.mark.long
def test_a_front_is_exported_in_parallel_stopped_and_continued(tmp_path):
    """Ctrl-C reaches the whole group of processes, as from a terminal; exports in progress leave nothing."""
    words = [sys.executable, "-m", "pareto_monoped"]
    study = Path(__file__).parent.parent.parent / "studies" / "quick.toml"
    db, folder = tmp_path / "quick.db", tmp_path / "front"
    subprocess.run([*words, "run", study, "--db", db, "--evaluations", "80"], check=True, capture_output=True)
    rows = subprocess.run([*words, "front", db], check=True, capture_output=True, text=True).stdout.splitlines()[1:]
    every = max(1, len(rows) // 8)
    export = [
        *words,
        "export",
        db,
        "--front",
        "--every",
        str(every),
        "--workers",
        "2",
        "--formats",
        "dxf",
        "-o",
        folder,
    ]
    with subprocess.Popen(export, stderr=subprocess.PIPE, text=True, start_new_session=True) as running:
        while not any(folder.glob("trial_*/design.json")):
            assert running.poll() is None
            time.sleep(0.1)
        os.killpg(running.pid, signal.SIGINT)
        message = running.communicate(timeout=120)[1]
    assert running.returncode == 130
    assert "Traceback" not in message
    assert "the same command continues from here" in message
    expected = -(-len(rows) // every)
    assert re.search(rf"wrote .*trial_\d+ \(1 of {expected}, \d+ (s|min) left\)", message)
    made = sorted(folder.iterdir())
    assert all((path / "design.json").is_file() for path in made)
    assert 1 <= len(made) < expected
    before = {path.name: (path / "design.json").stat().st_mtime_ns for path in made}
    again = subprocess.run(export, check=True, capture_output=True, text=True)
    assert again.stdout == f"{expected - len(made)} made, {len(made)} already there\n"
    assert len(list(folder.iterdir())) == expected
    assert {name: (folder / name / "design.json").stat().st_mtime_ns for name in before} == before


def test_angles_of_a_pose_are_given_in_degrees():
    assert _radians(180.0) == pytest.approx(3.141592653589793)
    assert _radians(None) is None
