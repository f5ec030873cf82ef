"""A short run of the fuzzer; a long one is ``python tools/fuzz.py --calls 10000``."""

import os
import subprocess
import sys

import pytest

from tests.tools.conftest import TOOLS

CALLS, SEED = 4, 1


def fuzzed(*words):
    done = subprocess.run(
        [sys.executable, str(TOOLS / "fuzz.py"), *words],
        env=os.environ | {"PYTHONPATH": str(TOOLS.parent)},
        capture_output=True,
        text=True,
        check=False,
    )
    return done.returncode, done.stdout + done.stderr


def test_no_call_ends_in_a_traceback_or_damage():
    code, said = fuzzed("--calls", str(CALLS), "--seed", str(SEED), "--without", "signal")
    assert code == 0, said
    assert said.startswith(f"seed {SEED}\n")
    assert f"{CALLS} calls, 0 with findings, seed {SEED}" in said


@pytest.mark.long
def test_no_call_of_many_ends_in_a_traceback_or_damage():
    code, said = fuzzed("--calls", "1000", "--seed", "29")
    assert code == 0, said
