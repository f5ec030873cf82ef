"""``run``, ``resume`` and ``status`` as a user types them."""

import json

import pytest

from pareto_monoped.cli import _run as cli

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
