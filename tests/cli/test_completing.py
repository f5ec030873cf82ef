"""Completion, asked for as shells ask for it, and in bash itself."""

import os
import select
import shlex
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import pytest

from pareto_monoped.cli import _run as cli
from tests.study.support import made_database
from tests.test_architecture import SLOW

ROOT = Path(__file__).parents[2]
ENVIRONMENT = os.environ | {"PYTHONPATH": str(ROOT)}
PROGRAM = "import sys; from pareto_monoped.cli import main; sys.argv = ['pareto-monoped']; main()"


@pytest.fixture
def completed(monkeypatch, capsys):
    """A function: what may stand in place of the last word of a line, as bash is told: kind,value."""

    def asked(line):
        monkeypatch.setenv("_PARETO_MONOPED_COMPLETE", "bash_complete")
        monkeypatch.setenv("COMP_WORDS", line)
        monkeypatch.setenv("COMP_CWORD", str(len(line.split(" ")) - 1))
        with pytest.raises(SystemExit):
            cli([])
        out, err = capsys.readouterr()
        assert err == ""
        return out.split()

    return asked


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("pareto-monoped si", ["plain,simulate"]),
        ("pareto-monoped simulate --kn", ["plain,--knee-motor"]),
        ("pareto-monoped simulate --case n", ["plain,nominal"]),
        ("pareto-monoped simulate --set hip", ["plain,hip_ratio="]),
        ("pareto-monoped actuators --motor U1", ["plain,U10", "plain,U12", "file,U1"]),
        ("pareto-monoped actuators --without sun", ["plain,sun_rim"]),
        ("pareto-monoped simulate --calibration pa", ["plain,paper", "file,pa"]),
        ("pareto-monoped init qu", ["plain,quick"]),
        ("pareto-monoped export --formats step,st", ["plain,step,step", "plain,step,stl"]),
        ("pareto-monoped run --objectives height_m,energy_j", ["plain,height_m,energy_j"]),
        ("pareto-monoped pick s.db --min thigh", ["plain,thigh_length_m="]),
        ("pareto-monoped front s", ["file,s"]),
    ],
)
def test_names_are_completed(completed, line, offered):
    assert completed(line) == offered


def test_a_key_press_imports_nothing_heavy(db):
    """Motors are read with what checks their files, which takes a tenth of a second."""
    slow = [name for name in SLOW if name != "pydantic"]
    options = ("pick s.db --min ", "actuators --motor ", f"pick {db} --trial ")
    before = [line.split(" ")[:-1] for line in ("", *options)]
    code = (
        "import sys\n"
        "from click.shell_completion import BashComplete\n"
        "from pareto_monoped.cli import cli\n"
        f"for words in {before!r}:\n"
        "    assert BashComplete(cli, {}, 'pareto-monoped', 'X').get_completions(words, '')\n"
        f"    assert not (heavy := [name for name in {slow!r} if name in sys.modules]), (words, heavy)"
    )
    run = subprocess.run([sys.executable, "-c", code], env=ENVIRONMENT, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, "")


@pytest.fixture
def db(tmp_path):
    """Its front: trials 4 (0.7 m, 8 J), 0 (0.8 m, 9 J), 3 (1.1 m, 30 J)."""
    made_database(tmp_path / "s.db")
    return str(tmp_path / "s.db")


@pytest.mark.parametrize("command", ["pick", "export", "robust"])
def test_numbers_of_trials_are_completed_from_the_front(completed, command, db):
    assert completed(f"pareto-monoped {command} {db} --trial ") == ["plain,4", "plain,0", "plain,3"]
    assert completed(f"pareto-monoped {command} {db} --trial 3") == ["plain,3"]


def test_trials_of_what_is_no_study_are_not_completed(completed, db, tmp_path):
    (tmp_path / "no.db").write_text("nothing")
    with sqlite3.connect(db) as connection:
        connection.execute("UPDATE monoped_front SET trials = '[4'")
    for line in (f"pick {db}", f"pick {tmp_path}/no.db", "pick", "pick nowhere.db", "export"):
        assert completed(f"pareto-monoped {line} --trial ") == []


def test_shells_that_show_help_show_the_objectives_of_a_trial(db):
    run = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        env=ENVIRONMENT
        | {
            "_PARETO_MONOPED_COMPLETE": "fish_complete",
            "COMP_WORDS": f"pareto-monoped pick {db} --trial ",
            "COMP_CWORD": "",
        },
        capture_output=True,
        text=True,
        check=True,
    )
    assert run.stdout.splitlines() == [
        "plain,4\t0.700 m on 8.00 J",
        "plain,0\t0.800 m on 9.00 J",
        "plain,3\t1.100 m on 30.00 J",
    ]


@pytest.fixture
def program(tmp_path):
    """A folder with the program, for PATH."""
    folder = tmp_path / "bin"
    folder.mkdir()
    program = folder / "pareto-monoped"
    program.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -m pareto_monoped "$@"\n', encoding="utf-8")
    program.chmod(0o755)
    return ENVIRONMENT | {"PATH": f"{folder}:{os.environ['PATH']}"}


def documented_line(shell):
    """What the page puts at the end of the shell's configuration."""
    lines = (ROOT / "docs" / "getting_started.md").read_text("utf-8").splitlines()
    (line,) = [line.strip() for line in lines if f"COMPLETE={shell}_source" in line]
    return line


@pytest.mark.skipif(shutil.which("fish") is None, reason="there is no fish")
def test_fish_completes(program, db):
    """With the documented line in a fish of its own."""
    script = (
        f"{documented_line('fish')}\ncomplete -C 'pareto-monoped act'\ncomplete -C 'pareto-monoped pick {db} --trial '"
    )
    run = subprocess.run(
        ["fish", "--no-config", "-c", script], env=program, capture_output=True, text=True, check=True, timeout=120
    )
    first, *trials = run.stdout.splitlines()
    assert first.split("\t")[0] == "actuators"
    assert sorted(trials) == ["0\t0.800 m on 9.00 J", "3\t1.100 m on 30.00 J", "4\t0.700 m on 8.00 J"]


@pytest.mark.skipif(shutil.which("zsh") is None, reason="there is no zsh")
def test_zsh_completes(program, db):
    """With the documented line in a zsh of its own, in a terminal where Tab is pressed."""
    import pty

    child, terminal = pty.fork()
    if child == 0:
        os.execvpe("zsh", ["zsh", "-f", "-i"], program | {"TERM": "dumb", "PS1": "> "})
    try:
        typed = f"autoload -Uz compinit; compinit -u -D; {documented_line('zsh')}; echo rea''dy\n"
        os.write(terminal, typed.encode())
        said_by(terminal, "ready")
        os.write(terminal, b"pareto-monoped act\t")
        said_by(terminal, "actuators")
        os.write(terminal, f"\x15pareto-monoped pick {db} --trial \t\t".encode())
        said_by(terminal, "0.800 m on 9.00 J")
    finally:
        os.kill(child, signal.SIGKILL)
        os.close(terminal)
        os.waitpid(child, 0)


def said_by(terminal, words):
    """Read until the words are on the screen."""
    screen, deadline = "", time.monotonic() + 120.0
    while words not in screen:
        left = deadline - time.monotonic()
        assert left > 0.0, screen
        assert select.select([terminal], [], [], left)[0], screen
        screen += os.read(terminal, 65536).decode(errors="replace")


@pytest.mark.skipif(shutil.which("bash") is None, reason="there is no bash")
def test_bash_completes(program):
    """With the documented line in a bash of its own, and the program on its path."""
    script = f"""{documented_line("bash")}
COMP_WORDS=(pareto-monoped act) COMP_CWORD=1
_pareto_monoped_completion pareto-monoped act pareto-monoped
echo "${{COMPREPLY[@]}}"
complete -p pareto-monoped
"""
    run = subprocess.run(
        ["bash", "--norc", "-c", script],
        env=program,
        capture_output=True,
        text=True,
        check=True,
    )
    first, second = run.stdout.splitlines()
    assert first.strip() == "actuators"
    assert "_pareto_monoped_completion" in second
