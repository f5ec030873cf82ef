"""``run``, ``resume`` and ``status`` as a user types them."""

import json
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from pymoo.indicators.hv import HV

from pareto_monoped.cli import _run as cli
from pareto_monoped.measures import measure
from pareto_monoped.pareto.front import AtHeight
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import RunSummary
from pareto_monoped.study.session import Progress

STUDY = 'name = "s"\nevaluations = 40\naudit = false\n[algorithm]\nname = "nsga2"\npopulation = 20\n'


@pytest.fixture
def study(tmp_path):
    path = tmp_path / "s.toml"
    path.write_text(STUDY)
    return path


def test_run_resume_and_status(study, capsys):
    assert cli(["run", str(study), "--evaluations", "20"]) == 0
    said = capsys.readouterr()
    assert said.out.startswith("front: ")
    assert "20 evaluations (20 new" in said.err
    assert "the budget is used up" in said.err
    db = study.with_suffix(".db")
    assert cli(["resume", str(db), "--evaluations", "40", "--workers", "1"]) == 0
    assert "40 evaluations (20 new" in capsys.readouterr().err
    assert cli(["status", str(db), "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert (facts["evaluations"], facts["state"], facts["seed"]) == (40, "finished", 1)
    assert cli(["status", str(db)]) == 0
    text = capsys.readouterr().out
    assert "40 of 40" in text
    assert max(map(len, text.splitlines())) <= 80


def test_other_objectives_in_a_database_of_their_own(study, tmp_path, capsys):
    db = tmp_path / "battery.db"
    many = "[constraints]\n" + "".join(
        f"{name} = {{ max = 1000.0 }}\n"
        for name in ("mass_kg", "drift_m", "stop_energy_j", "peak_foot_force_n", "peak_gear_torque_knee_n_m")
    )
    study.write_text(STUDY.replace("[algorithm]", many + "[algorithm]"))
    names = "height_m, electrical_energy_j"
    assert cli(["run", str(study), "--objectives", names, "--db", str(db), "--evaluations", "20"]) == 0
    capsys.readouterr()
    assert cli(["status", str(db)]) == 0
    text = capsys.readouterr().out
    assert "objectives             height_m, electrical_energy_j\n" in text
    assert "other limits           max_mass_kg 1000, " in text
    assert "max_peak_gear_torque_knee_n_m 1000" in text
    assert max(map(len, text.splitlines())) <= 80


def test_another_database_and_seed(study, tmp_path, capsys):
    db = tmp_path / "other.db"
    assert cli(["run", str(study), "--seed", "7", "--db", str(db), "--evaluations", "20"]) == 0
    assert not study.with_suffix(".db").exists()
    capsys.readouterr()
    assert cli(["run", str(study), "--db", str(db)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "study.seed: 7 -> 1" in error


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["run", "missing.toml"], "no such file"),
        (["run", "{study}", "--evaluations", "0"], "evaluations"),
        (["run", "{study}", "--db", "{folder}/no/s.db"], "cannot be written to"),
        (["run", "{study}", "--db", "{study}"], "is not a study database"),
        (["resume", "missing.db"], "no such file"),
        (["status", "{study}"], "is not a study database"),
    ],
)
def test_bad_input_gets_one_line_and_leaves_nothing(study, tmp_path, capsys, arguments, words):
    filled = [argument.format(study=study, folder=tmp_path) for argument in arguments]
    assert cli(filled) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("error: ")
    assert said.err.count("\n") == 1
    assert words in said.err
    assert study.read_text() == STUDY
    assert [path.name for path in tmp_path.iterdir()] == ["s.toml"]


def test_without_a_terminal_progress_is_a_line_every_few_seconds(study, capsys, monkeypatch):
    monkeypatch.setattr("pareto_monoped.cli.studies._SECONDS_BETWEEN_LINES", 0.0)
    assert cli(["run", str(study)]) == 0
    lines = [line for line in capsys.readouterr().err.splitlines() if "/40, " in line]
    assert len(lines) == 2
    assert lines[0].startswith("20/40, ")
    assert "hypervolume" in lines[1]
    assert "J at 0.8 m" in lines[1]
    assert max(map(len, lines)) <= 80


def test_on_a_terminal_progress_is_a_bar(study, monkeypatch):
    """A real pseudo-terminal, because rich asks the stream."""
    import os
    import pty
    import sys

    ours, theirs = pty.openpty()
    with os.fdopen(theirs, "w") as stream:
        monkeypatch.setattr(sys, "stderr", stream)
        assert cli(["run", str(study)]) == 0
        stream.write("END")
        stream.flush()
        shown = ""
        while not shown.endswith("END"):
            shown += os.read(ours, 4096).decode(errors="replace")
    os.close(ours)
    assert "40/40" in shown
    assert "━" in shown


FACTS = {
    "name": "s",
    "motor": "VT8020",
    "calibration": "reference-4",
    "algorithm": "nsga2",
    "seed": 3,
    "free": ["knee_ratio", "hip_ratio"],
    "state": "finished",
    "process": None,
    "stop_reason": "plateau",
    "evaluations": 30,
    "budget": 40,
    "feasible": 20,
    "infeasible": 7,
    "failed": 3,
    "wall_time_s": 12.34,
    "evaluations_per_second": 2.43,
    "front": 9,
    "ill_conditioned": 1,
    "foreign": 0,
    "hypervolume": 12.34567,
    "reference_point": {"height_m": 0.55, "energy_j": 100.0},
    "hypervolume_unit": "m J",
    "left_to_gain": 0.0123,
    "objectives": {"height_m": "maximise", "energy_j": "minimise"},
    "best_at_0_8_m": {"energy_j": 23.456},
    "hash": "0123456789abcdef0123",
    "content_hash": "fedcba9876543210" * 4,
    "sealed": True,
    "strength": True,
    "settings": {"variables": dict.fromkeys("abcdefg"), "constraints": {"min_height_m": 0.6}},
}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, ("state", "finished (the hypervolume has stopped growing)")),
        ({"state": "running", "process": 77}, ("state", "running (process 77)")),
        ({"state": "unfinished", "stop_reason": "interrupted"}, ("state", "unfinished")),
        ({}, ("strength", "every joint has its required factor")),
        ({}, ("left to gain", "1.2% with 4 times as many evaluations (estimated)")),
        ({"strength": False}, ("strength", "strength was not asked for: designs may not hold")),
        ({"settings": FACTS["settings"] | {"rules": "iso6336"}}, ("gearbox rules", "iso6336")),
        ({}, ("free variables", "2 of 7")),
        ({}, ("least height", "0.6 m")),
        (
            {
                "settings": FACTS["settings"]
                | {"constraints": {"min_height_m": 0.6, "max_mass_kg": 4.5, "max_drift_m": None}}
            },
            ("other limits", "max_mass_kg 4.5"),
        ),
        ({}, ("evaluations", "30 of 40")),
        ({}, ("feasible", "20 (7 infeasible, 3 failed)")),
        ({}, ("front", "9 designs (1 ill-conditioned left out)")),
        ({}, ("hypervolume", "12.3457 m J from (0.55 m, 100 J)")),
        ({}, ("least energy at 0.8 m", "23.46 J")),
        ({"best_at_0_8_m": {"energy_j": None}}, ("least energy at 0.8 m", "not reached")),
        ({}, ("time", "12.3 s, 2 designs/s")),
        ({"evaluations_per_second": None}, ("time", "12.3 s")),
        ({}, ("settings hash", "0123456789abcdef")),
        ({}, ("content hash", "fedcba9876543210" * 2)),
    ],
)
def test_status_prints_each_fact_with_its_unit(monkeypatch, capsys, changes, words):
    monkeypatch.setattr("pareto_monoped.storage.status.status", lambda db: FACTS | changes)
    assert cli(["status", "s.db"]) == 0
    lines = [(line[:22].strip(), line[23:]) for line in capsys.readouterr().out.splitlines()]
    assert words in lines


SUMMARY = RunSummary(
    db=Path("s.db"),
    evaluations=40,
    new_evaluations=20,
    front_size=9,
    ill_conditioned=0,
    hypervolume=12.34567,
    hypervolume_unit="m J",
    seconds=3.21,
    stop_reason="budget",
    strength=True,
    data=None,
)


@pytest.mark.parametrize("command", [["run", "{study}"], ["resume", "s.db"]])
def test_an_interrupted_run_ends_with_code_130_and_says_how_to_continue(study, monkeypatch, capsys, command):
    history = pd.DataFrame({"evaluations": [20, 40], "hypervolume": [10.0, 12.5]})
    summary = replace(SUMMARY, stop_reason="interrupted", ill_conditioned=2, data=SimpleNamespace(history=history))
    given = {}
    name = f"pareto_monoped.study.run.{command[0]}"
    monkeypatch.setattr("pareto_monoped.analysis.remarks.remarks", lambda data: [])
    monkeypatch.setattr(name, lambda *_, **options: given.update(options) or summary)
    words = [word.format(study=study) for word in command]
    assert cli([*words, "--evaluations", "40", "--workers", "3"]) == 130
    assert (given["evaluations"], given["workers"]) == (40, 3)
    said = capsys.readouterr()
    assert said.out == "front: 9 designs, hypervolume 12.3457 m J, 2 ill-conditioned left out\n"
    first, second = said.err.splitlines()
    assert first == "s.db: 40 evaluations (20 new, 3.2 s), interrupted; continue it with 'resume'"
    # Each of two doublings gains 0.42 of the one before, which gained a fifth of today's.
    assert second.endswith("4 times as many evaluations would gain about 11.9% of this hypervolume")


def test_progress_gives_the_time_left_in_minutes_and_seconds():
    unreached = AtHeight(height_m=0.8, measure=measure("energy_j"), value=None)
    progress = Progress(
        evaluations=20, budget=40, per_second=12.6, seconds_left=125.4, hypervolume=1.234, at_height=unreached
    )
    assert progress.text() == "20/40, 13/s, 2:05 left, hypervolume 1.23, 0.8 m not reached"
    assert replace(progress, at_height=replace(unreached, value=9.876)).text().endswith("9.88 J at 0.8 m")
    assert replace(progress, at_height=None).text().endswith("hypervolume 1.23")


def shares_by_pymoo(*paths):
    """Percent of the hypervolume of both fronts joined that each has alone."""
    points = [read_study(path).front()[["height_m", "energy_j"]].to_numpy() * [-1.0, 1.0] for path in paths]
    corner = read_study(paths[0]).reference_point.values
    volume = HV(ref_point=np.array(corner) * [-1.0, 1.0])
    joined = volume(np.concatenate(points))
    return [100.0 * (1.0 - volume(points[other]) / joined) for other in (1, 0)]


def test_a_second_seed_searches_again_beside_the_first_and_compares_both(study, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    first, second = study.with_suffix(".db"), study.with_name("s_seed_2.db")
    for new in (40, 0):
        assert cli(["run", str(study), "--second-seed", "--workers", "1"]) == 0
        said = capsys.readouterr()
        assert f"{first}: 40 evaluations ({new} new" in said.err
        assert f"{second}: 40 evaluations ({new} new" in said.err
    assert (read_study(first).study.seed, read_study(second).study.seed) == (1, 2)
    lines = said.out.splitlines()
    assert max(map(len, lines)) <= 80
    shares = shares_by_pymoo(first, second)
    assert min(shares) > 0.0
    row = next(line for line in lines if "hypervolume alone" in line)
    assert re.findall(r"[0-9.]+ %", row) == [f"{share:.1f} %" for share in shares]
    assert "seed 1       seed 2   difference" in said.out
    rows = re.findall(r"least energy for ([0-9.]+) m or more +([0-9.]+) J +([0-9.]+) J +(\S+) %", said.out)
    assert rows
    for height, *energies, difference in rows:
        fronts = [read_study(db).front() for db in (first, second)]
        least = [front.energy_j[front.height_m >= float(height)].min() for front in fronts]
        assert energies == [f"{one:.2f}" for one in least]
        assert float(difference) == pytest.approx(100.0 * (least[1] / least[0] - 1.0), abs=0.051)
    assert lines[-1].endswith(".")


def test_a_second_seed_as_json_adds_a_line(study, capsys):
    assert cli(["run", str(study), "--second-seed", "7", "--json"]) == 0
    events = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [one["event"] for one in events if one["event"] != "generation"] == ["end", "end", "second_search"]
    assert events[-1]["seeds"] == [1, 7]
    shares = shares_by_pymoo(study.with_suffix(".db"), study.with_name("s_seed_7.db"))
    assert [100.0 * share for share in events[-1]["alone"]] == pytest.approx(shares)


@pytest.mark.parametrize("stopped", [1, 2])
def test_what_is_interrupted_is_not_compared(stopped, study, capsys, monkeypatch):
    """The first stop leaves no second database; the same command goes on."""
    from pareto_monoped.study import session

    go, calls = session.Session.go, []

    def interrupted(self, interrupt):
        calls.append(self)
        interrupt.asked = interrupt.asked or len(calls) == stopped
        return go(self, interrupt)

    monkeypatch.setattr(session.Session, "go", interrupted)
    words = ["run", str(study), "--second-seed", "--workers", "1"]
    assert cli(words) == 130
    assert "alone" not in capsys.readouterr().out
    assert study.with_name("s_seed_2.db").exists() == (stopped == 2)
    assert cli(words) == 0
    assert "alone" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (["{study}", "--second-seed", "1"], "second seed = 1: must be another one than the study's"),
        (["{study}", "--seed", "5", "--second-seed=5"], "second seed = 5: must be another one"),
        (["--second-seed", "{study}"], "must be a number or nothing; put it after STUDY.toml"),
        (["{study}", "--second-seed", "x"], "'x' is no whole number"),
    ],
)
def test_a_second_seed_that_cannot_be_is_refused_before_the_search(words, error, study, tmp_path, capsys):
    assert cli(["run", *(word.format(study=study) for word in words)]) == 2
    said = capsys.readouterr()
    assert error in said.err
    assert (said.out, said.err.count("\n")) == ("", 1)
    assert [path.name for path in tmp_path.iterdir()] == ["s.toml"]


def test_a_database_that_is_in_the_second_searchs_place_is_left_alone(study, capsys):
    """It may be another study; the first is finished, and the same command goes on after the cure."""
    second = study.with_name("s_seed_2.db")
    assert cli(["run", str(study), "--seed", "3", "--db", str(second)]) == 0
    before = second.read_bytes()
    capsys.readouterr()
    assert cli(["run", str(study), "--second-seed"]) == 2
    assert "study.seed: 3 -> 2" in capsys.readouterr().err
    assert second.read_bytes() == before
