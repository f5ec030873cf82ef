"""Whatever a command raises ends in one line and an exit code."""

import errno
import json
import os
import pty
import sqlite3
import subprocess
import sys

import click
import pytest

from pareto_monoped import cli
from pareto_monoped.cli import process
from pareto_monoped.cli.process import told
from pareto_monoped.errors import DatabaseError, DiskError, InputError
from tests.cli.support import ROOT, STORED, own_process


def of_system(number, *files):
    return OSError(number, os.strerror(number), *files)


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (of_system(errno.ENOSPC), 1, ["output: cannot be written", "No space left", "make room"]),
        (of_system(errno.EIO, "a.db"), 1, ["file 'a.db'", "Input/output error", "health"]),
        (of_system(errno.EDQUOT, "a.db"), 1, ["'a.db'", "make room"]),
        (of_system(errno.EMFILE, "a.db"), 1, ["'a.db'", "ulimit -n"]),
        (of_system(errno.ENAMETOOLONG, "a" * 3000), 2, ["'aaaa", " ... ", "shorter name"]),
        (of_system(errno.EACCES, "a.db"), 2, ["'a.db'", "allow access"]),
        (of_system(errno.ENOENT, b"\xff.db"), 2, ["'\\udcff.db'", "check the path"]),
        (MemoryError(), 1, ["memory: is used up"]),
        (sqlite3.OperationalError("no such table:\nx"), 1, ["unexpected OperationalError", "no such table: x"]),
        (UnicodeDecodeError("utf-8", b"\xff", 0, 1, "invalid start byte"), 1, ["unexpected UnicodeDecodeError"]),
        (KeyError("mass_kg"), 1, ["unexpected KeyError", "mass_kg", "PARETO_MONOPED_TRACEBACK=1"]),
        (RecursionError(), 1, ["unexpected RecursionError", "without a message"]),
        (DatabaseError("study database 's\x1b[31m.db': is damaged (a\nb)"), 2, ["'s\\u001b[31m.db'", "(a b)"]),
        (DiskError("x"), 1, ["x"]),
        (click.UsageError("no such option: \x1b]0;title\x07"), 2, ["\\u001b]0;title\\u0007"]),
    ],
)
def test_every_error_is_one_line_with_its_code(error, code, words):
    line, found = told(error)
    assert found == code
    assert line.startswith("error: ")
    assert line.isprintable()
    assert len(line) < 1500
    for word in words:
        assert word in line


def test_a_fault_says_where_it_came_up(monkeypatch, capsys):
    monkeypatch.setattr("pareto_monoped.storage.status.status", lambda db: {})
    assert cli._run(["status", "x.db"]) == 1
    assert capsys.readouterr().err.startswith("error: unexpected KeyError in cli/studies.py, line ")
    monkeypatch.setenv("PARETO_MONOPED_TRACEBACK", "1")
    assert cli._run(["status", "x.db"]) == 1
    assert "Traceback" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words",
    [
        ["--help"],
        ["status", "{db}", "--json"],
        pytest.param(["status", "{db}"], marks=pytest.mark.long),
        pytest.param(["actuators", "--ratio", "6"], marks=pytest.mark.long),
    ],
)
def test_a_full_disk_behind_standard_output_ends_in_one_line(tmp_path, words):
    code, _, err = own_process(tmp_path, words, stdout="/dev/full")
    assert code == 1
    assert err == "error: output: cannot be written (No space left on device); make room and try again\n"


@pytest.mark.parametrize("closed", [*(pytest.param(one, marks=pytest.mark.long) for one in ((1,), (2,))), (0, 1, 2)])
def test_closed_standard_streams_take_nothing_into_a_study(tmp_path, capsys, closed):
    code, _, _ = own_process(tmp_path, ["status", "{db}"], closed=closed)
    assert code == 0
    assert own_process(tmp_path, ["status", "no.db"], closed=closed)[0] == 2
    assert cli._run(["verify", str(tmp_path / "s.db")]) == 0, capsys.readouterr().err


def test_an_encoding_that_lacks_letters_gets_escapes(tmp_path):
    code, out, err = own_process(
        tmp_path, ["actuators", "--motor", "ζ.toml"], environment={"PYTHONIOENCODING": "iso8859-1"}
    )
    assert code == 2
    assert "'\\u03b6.toml'" in err
    assert out == ""


def test_a_broken_pipe_behind_the_messages_ends_no_command(tmp_path):
    """Found by the fuzzer: a note that nobody read any more ended the command without its result."""
    reader, writer = os.pipe()
    os.close(reader)
    line = [sys.executable, "-m", "pareto_monoped", "front", str(STORED), "--json"]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(line, env=environment, cwd=tmp_path, stdout=subprocess.PIPE, stderr=writer, check=False)
    os.close(writer)
    assert done.returncode == 0
    assert json.loads(done.stdout)


@pytest.mark.parametrize("command", ["run", "resume", "verify", "robust", "export", "pareto"])
def test_more_threads_than_any_machine_has_are_refused(capsys, command):
    """Found by the fuzzer: a number of 400 digits reached the simulation."""
    assert cli._run([command, "x", "--workers", "9" * 400]) == 2
    assert "1024" in capsys.readouterr().err


def test_on_a_terminal_an_error_breaks_between_words(monkeypatch):
    """A line of 350 characters was broken by the terminal itself, within words. A pipe still gets one line."""
    ours, theirs = pty.openpty()
    with os.fdopen(theirs, "w") as stream:
        monkeypatch.setattr(process.sys, "stderr", stream)
        process.report(InputError("design: " + "width_mm and " * 20 + "height_mm are missing; give them"))
        stream.flush()
        shown = os.read(ours, 4096).decode()
    os.close(ours)
    lines = shown.splitlines()
    assert len(lines) > 3
    assert max(map(len, lines)) <= 80
    assert " ".join(line.strip() for line in lines).startswith("error: design: width_mm and width_mm and ")
    assert all(
        line.split()[-1] in ("and", "width_mm", "them", "give", "height_mm", "are", "missing;") for line in lines
    )


def test_an_error_without_a_stderr_only_has_its_code(monkeypatch):
    """A process may be started with stderr closed, which Python shows as None."""
    monkeypatch.setattr(process.sys, "stderr", None)
    assert process.report(InputError("width_mm: is missing; give it")) == 2
