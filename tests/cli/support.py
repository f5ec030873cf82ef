"""Commands in this process and in processes of their own."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from pareto_monoped.cli import main

ROOT = Path(__file__).parents[2]
STORED = ROOT / "tests" / "storage" / "data" / "plain.db"


def run(capsys, *words):
    """Exit code, output and messages of a command."""
    with pytest.raises(SystemExit) as ended:
        main([str(word) for word in words])
    printed = capsys.readouterr()
    return ended.value.code, printed.out, printed.err


def own_process(folder, words, *, stdout=None, closed=(), environment=None):
    """Exit code, output and messages of a command; ``{db}`` in its words is a copy of a stored study in the folder."""
    db = folder / "s.db"
    if not db.exists():
        shutil.copy(STORED, db)
    line = [sys.executable, "-m", "pareto_monoped", *(word.format(db=db) for word in words)]
    variables = os.environ | {"PYTHONPATH": str(ROOT)} | (environment or {})
    target = os.open(stdout, os.O_WRONLY) if stdout else subprocess.PIPE
    done = subprocess.run(
        line,
        cwd=folder,
        env=variables,
        stdout=target,
        stderr=subprocess.PIPE,
        preexec_fn=lambda: [os.close(number) for number in closed],
        check=False,
    )
    if stdout:
        os.close(target)
    return done.returncode, (done.stdout or b"").decode(), done.stderr.decode()
