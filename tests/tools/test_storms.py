"""Storms of kills and of damage, short; the tools run long ones on demand."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
needs_compiler = pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler")


def storm(*words):
    """Run a tool; what it printed, if it found nothing."""
    done = subprocess.run([sys.executable, *words], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.long
def test_damage_never_passes():
    said = storm("tools/damage_storm.py", "--damages", "3", "--seed", "3")
    assert "3 damages" in said
    assert "refused by all" in said


@pytest.mark.long
def test_much_damage_never_passes():
    storm("tools/damage_storm.py", "--damages", "300", "--seed", "4")


@needs_compiler
@pytest.mark.long
def test_kills_at_all_moments():
    said = storm("tools/kill_storm.py", "--kills", "3", "--kinds", "1", "--seed", "5")
    assert "lost, bricked or different: 0" in said


@needs_compiler
@pytest.mark.long
def test_many_kills_at_all_moments():
    said = storm("tools/kill_storm.py", "--kills", "150", "--seed", "4")
    for moment in ("starting", "creating", "opening", "searching", "storing a generation", "auditing", "closing"):
        assert f"{moment} " in said
