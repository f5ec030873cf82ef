"""The script that installs packages shows what pip fetches, keeps all that it says, and passes on its failure."""

import subprocess

import pytest

from tests.tools.conftest import TOOLS

FETCHED = """Collecting numpy>=2.2
  Downloading https://files.example.org/aa/bb/numpy-2.4.6-cp311-cp311-linux.whl (18.1 MB)
  Using cached cadquery_ocp_novtk-8.0-cp311.whl (98.2 MB)
Installing collected packages: numpy, cadquery-ocp-novtk
Successfully installed numpy-2.4.6
"""


def installed(folder, said, code):
    """Run the script with a Python that says this as pip and ends with this code, in a folder with blanks."""
    place = folder / "dir mit Blank und Ümlaut"
    place.mkdir()
    python = place / "python"
    python.write_text(f"#!/bin/sh\ncat <<'END'\n{said}END\nexit {code}\n", encoding="utf-8")
    python.chmod(0o755)
    log = place / "install.log"
    run = subprocess.run(
        ["sh", str(TOOLS / "install.sh"), str(python), str(log), "1 of 3: search", "-e", "."],
        capture_output=True,
        text=True,
        check=False,
    )
    return run, log.read_text(encoding="utf-8")


def test_every_file_is_a_short_line_with_its_size(tmp_path):
    run, log = installed(tmp_path, FETCHED, 0)
    title, numpy, kernel, installing, done = run.stdout.splitlines()
    assert run.returncode == 0
    assert title == "1 of 3: search"
    assert numpy.split() == ["numpy", "(18.1", "MB)"]
    assert kernel.split() == ["cadquery_ocp_novtk", "(98.2", "MB)"]
    assert installing.strip() == "installing them"
    assert done.startswith("  done after ")
    assert max(map(len, run.stdout.splitlines())) <= 80
    assert FETCHED in log


@pytest.mark.parametrize("code", [1, 2])
def test_a_failure_ends_with_its_code_and_what_pip_said(tmp_path, code):
    run, _ = installed(tmp_path, "ERROR: No space left on device\n", code)
    assert run.returncode == code
    assert "ERROR: No space left on device" in run.stderr
    assert "done" not in run.stdout
    assert run.stderr.splitlines()[-1].startswith("error: pip has failed, see ")
