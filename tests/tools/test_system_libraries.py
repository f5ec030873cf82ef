"""The set-up script on machines that lack the CAD kernel's system libraries, played by small programs on PATH."""

import os
import subprocess
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / "tools" / "system_libraries.sh"


@pytest.fixture
def machine(tmp_path):
    """Run the script on a machine with the given programs; returns the finished process."""

    def run(**programs: str) -> subprocess.CompletedProcess:
        tools = tmp_path / "bin"
        tools.mkdir()
        for name, body in ({"uname": "echo Linux"} | programs).items():
            program = tools / name.replace("_", "-")
            program.write_text(f"#!/bin/sh\n{body}\n")
            program.chmod(0o755)
        return subprocess.run(
            ["/bin/sh", str(SCRIPT), str(tools / "python")],
            env={"PATH": str(tools)},
            capture_output=True,
            text=True,
            check=False,
            cwd=tmp_path,
        )

    return run


def test_nothing_is_said_where_the_libraries_are_there(machine):
    done = machine(python="exit 0")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.parametrize(
    ("manager", "command"),
    [
        ("apt_get", "sudo apt-get install libgl1 libx11-6"),
        ("dnf", "sudo dnf install mesa-libGL libX11"),
        ("pacman", "sudo pacman -S libglvnd libx11"),
    ],
)
def test_an_ordinary_user_is_given_the_exact_command(machine, manager, command):
    done = machine(python="exit 1", id="echo 1000", **{manager: "exit 99"})
    assert done.returncode == 1
    assert done.stderr.strip().endswith(f"run: {command}")
    assert done.stderr.count("\n") == 1


def test_root_gets_them_installed(machine, tmp_path):
    marker = tmp_path / "installed"
    done = machine(
        python=f'test -e "{marker}"', id="echo 0", apt_get=f'case "$1" in install) : > "{marker}";; esac; exit 0'
    )
    assert done.returncode == 0, done.stderr
    assert marker.exists()


def test_a_failed_installation_is_reported(machine):
    done = machine(python="exit 1", id="echo 0", apt_get="exit 100")
    assert done.returncode == 1
    assert "libgl1" in done.stderr


def test_the_script_is_plain_shell():
    assert os.access(SCRIPT, os.X_OK)
    assert SCRIPT.read_text().startswith("#!/bin/sh\n")
