"""Completion, asked for as shells ask for it, and in bash itself."""

import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.test_architecture import SLOW

ROOT = Path(__file__).parents[2]
ENVIRONMENT = os.environ | {"PYTHONPATH": str(ROOT)}
PROGRAM = "import sys; from pareto_monoped.cli import main; sys.argv = ['pareto-monoped']; main()"


def completed(line, *, after=""):
    """What may stand in place of the last word of a line, as bash is told: kind,value."""
    words = line.split(" ")
    run = subprocess.run(
        [sys.executable, "-c", f"{PROGRAM}{after}"],
        env=ENVIRONMENT
        | {
            "_PARETO_MONOPED_COMPLETE": "bash_complete",
            "COMP_WORDS": line,
            "COMP_CWORD": str(len(words) - 1),
        },
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.stderr == ""
    return run.stdout.split()


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
def test_names_are_completed(line, offered):
    assert completed(line) == offered


def test_a_key_press_imports_nothing_heavy():
    """Motors are read with what checks their files, which takes a tenth of a second."""
    slow = [name for name in SLOW if name != "pydantic"]
    for line in ("pareto-monoped ", "pareto-monoped pick s.db --min ", "pareto-monoped actuators --motor "):
        words = line.split(" ")
        code = (
            "import sys\n"
            "from click.shell_completion import BashComplete\n"
            "from pareto_monoped.cli import cli\n"
            f"assert BashComplete(cli, {{}}, 'pareto-monoped', 'X').get_completions({words[1:-1]!r}, '')\n"
            f"print([name for name in {slow!r} if name in sys.modules])"
        )
        run = subprocess.run([sys.executable, "-c", code], env=ENVIRONMENT, capture_output=True, text=True, check=True)
        assert run.stdout.strip() == "[]", line


@pytest.mark.skipif(shutil.which("bash") is None, reason="there is no bash")
def test_bash_completes(tmp_path):
    """With the line of the README in a bash of its own, and the program on its path."""
    program = tmp_path / "pareto-monoped"
    program.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -m pareto_monoped "$@"\n', encoding="utf-8")
    program.chmod(0o755)
    (line,) = [
        line.strip() for line in (ROOT / "README.md").read_text("utf-8").splitlines() if "COMPLETE=bash_source" in line
    ]
    script = f"""{line}
COMP_WORDS=(pareto-monoped act) COMP_CWORD=1
_pareto_monoped_completion pareto-monoped act pareto-monoped
echo "${{COMPREPLY[@]}}"
complete -p pareto-monoped
"""
    run = subprocess.run(
        ["bash", "--norc", "-c", script],
        env=ENVIRONMENT | {"PATH": f"{tmp_path}:{os.environ['PATH']}"},
        capture_output=True,
        text=True,
        check=True,
    )
    first, second = run.stdout.splitlines()
    assert first.strip() == "actuators"
    assert "_pareto_monoped_completion" in second
