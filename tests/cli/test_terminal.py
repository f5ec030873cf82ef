"""Names of files, studies and motors reach a terminal escaped."""

import ast
import json
import shutil
import sqlite3
from pathlib import Path

import pytest

from pareto_monoped.cli import _run as cli
from pareto_monoped.cli import terminal
from pareto_monoped.cli.terminal import echo, name, new_console, plain, wrapped
from tests.cli.support import ROOT, STORED

COMMAND_LINE = ROOT / "pareto_monoped" / "cli"
EVIL = "\x1b[2J\x9b31m\u202egnp\u2028\udcff\x07[bold]x[/]:smile:"
SHOWN = "\\u001b[2J\\u009b31m\\u202egnp\\u2028\\udcff\\u0007[bold]x[/]:smile:"


def test_what_a_terminal_obeys_or_hides_is_escaped_and_the_rest_is_not():
    assert plain(EVIL) == SHOWN
    assert plain("ζ ─ ö\u00a0\n\t") == "ζ ─ ö\u00a0\n\t"
    assert name("a\nb\tc") == "a\\nb\\tc"
    assert json.loads(f'"{plain(EVIL)}"') == EVIL


@pytest.mark.parametrize("err", [False, True])
def test_whatever_is_printed_is_escaped_even_where_a_command_forgot_to(err, capsys):
    """Click drops colours by itself where no terminal reads; it does not drop these."""
    echo("\x9b31m \u202egnp", err=err)
    said = capsys.readouterr()
    assert (said.err if err else said.out) == "\\u009b31m \\u202egnp\n"


def test_tables_show_names_as_they_are(capsys):
    from rich.table import Table

    table = Table(box=None, show_header=False)
    table.add_row(EVIL)
    new_console(width=200).print(table)
    new_console(width=200).print(EVIL)
    assert [line.strip() for line in capsys.readouterr().out.splitlines()] == [SHOWN, SHOWN]


def evil_study(folder):
    """A study whose names in the database are evil."""
    path = folder / "s\x1b]0;t\x07.db"
    shutil.copy(STORED, path)
    with sqlite3.connect(path) as connection:
        study = json.loads(connection.execute("SELECT value FROM monoped_meta WHERE key = 'study'").fetchone()[0])
        study |= {"name": "n\x1b[31m\nstate  forged", "description": "d\x1b[2J"}
        contents = json.loads(connection.execute("SELECT value FROM monoped_meta WHERE key = 'contents'").fetchone()[0])
        contents["motor"]["name"] = "m\x1b[31m[/]"
        for key, value in {"study": study, "motor": "m\x1b[2J", "calibration": "c\x9b", "contents": contents}.items():
            connection.execute("UPDATE monoped_meta SET value = ? WHERE key = ?", (json.dumps(value), key))
    return path


COMMANDS = {
    "status": ["status", "{db}"],
    "status --json": ["status", "{db}", "--json"],
    "front": ["front", "{db}"],
    "pick": ["pick", "{db}", "--knee"],
    "pick --json": ["pick", "{db}", "--knee", "--json"],
    "verify": ["verify", "{db}"],
    "resume": ["resume", "{db}"],
    "report": ["report", "{db}", "-o", "r\x1b[31m.html"],
    "front --csv": ["front", "{db}", "--csv", "r\x1b[31m.csv"],
    "missing": ["status", "no\x1b[31m\n.db"],
    "motor": ["actuators", "--motor", "no\x1b[31m.toml"],
    "motor file": ["simulate", "--motor", "m\x1b[31m.toml"],
    "bad study": ["run", "bad.toml"],
    "option": ["front", "{db}", "--no\x1b[31m"],
    "objectives": ["front", "{db}", "--objectives", "\x1b[31m,b"],
}


@pytest.mark.parametrize("words", COMMANDS.values(), ids=COMMANDS)
def test_no_command_prints_what_a_terminal_obeys(tmp_path, monkeypatch, capfd, words):
    monkeypatch.chdir(tmp_path)
    db = evil_study(tmp_path)
    (tmp_path / "m\x1b[31m.toml").write_text('name = "m\\u001b[31m[/]"\n')
    (tmp_path / "bad.toml").write_text('name = "n"\nevaluations = 10\n"k\\u001b[31m" = "\\u001b[2J"\n')
    cli([word.format(db=db) for word in words])
    out, err = capfd.readouterr()
    assert out + err
    for text in (out, err):
        assert text.replace("\n", "").isprintable()


def test_a_line_break_in_a_name_makes_no_line(tmp_path, capsys):
    assert cli(["status", str(evil_study(tmp_path))]) == 0
    out = capsys.readouterr().out
    assert "n\\u001b[31m\\nstate  forged" in out
    assert [line for line in out.splitlines() if line.startswith("state")] == [
        "state                  finished (the budget is used up)"
    ]


@pytest.mark.parametrize("path", sorted(COMMAND_LINE.glob("*.py")), ids=lambda path: path.name)
def test_nothing_is_printed_past_the_escapes(path):
    """Text is printed by ``terminal.echo`` and by the consoles of ``terminal.new_console``."""
    if path.name in ("terminal.py", "process.py"):
        return
    calls = [ast.unparse(node.func) for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Call)]
    assert not {"click.echo", "click.secho", "print", "Console", "sys.stdout.write", "sys.stderr.write"} & set(calls)


def test_a_note_fits_eighty_columns_and_goes_to_stderr(capsys):
    terminal.note("word " * 40 + "end")
    said = capsys.readouterr()
    lines = said.err.splitlines()
    assert said.out == ""
    assert len(lines) == 3
    assert max(map(len, lines)) <= 80
    assert lines[0].startswith("note: word")
    assert all(line.startswith("  word") for line in lines[1:])
    assert " ".join(said.err.split()) == "note: " + "word " * 40 + "end"


def test_every_note_of_the_command_line_goes_through_one_function():
    """Those printed by hand were longer than a line of the terminal."""
    folder = Path(terminal.__file__).parent
    by_hand = [
        path.name for path in folder.glob("*.py") if 'f"note: ' in path.read_text() or '"note: ' in path.read_text()
    ]
    assert by_hand == ["terminal.py"]


def test_no_line_breaks_between_a_number_and_its_percent_sign():
    text = wrapped("note: stiffness_n_per_m is at its lower bound of 5 N/m in 80 % of the front (99 % of height 0.7 m)")
    assert "\n  (99 % of" in text
    assert "%" not in [line.split()[0] for line in text.splitlines()]
