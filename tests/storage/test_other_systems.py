"""What Windows lacks: the package imports, locks and runs a study without it."""

import subprocess
import sys

import pytest

_HOLD = """
import sys, time
from pathlib import Path
from pareto_monoped.storage.lock import locked
with locked(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(60)
"""
_WITHOUT = """
import os, signal, sys

sys.modules["fcntl"] = None  # importing it fails
import asyncio, concurrent.futures, multiprocessing.connection, sqlite3, subprocess
LIBRARIES
for module, names in (
    (os, "pread pwrite O_CLOEXEC O_NOFOLLOW O_NONBLOCK O_DIRECTORY O_SYNC fork forkpty killpg getuid link "
         "sched_getaffinity mkfifo fchmod fchown posix_fallocate statvfs setsid wait3 wait4"),
    (signal, "SIGHUP SIGALRM SIGKILL SIGUSR1 SIGUSR2 SIGCHLD alarm setitimer pause sigwait"),
):
    for name in names.split():
        if hasattr(module, name):
            delattr(module, name)
"""
"""Hides what Windows has not, once the libraries are there, which have their own ways."""


def without(program, *words, libraries=""):
    return [sys.executable, "-c", _WITHOUT.replace("LIBRARIES", libraries) + program, *map(str, words)]


@pytest.fixture
def other(tmp_path):
    """Another process that holds the lock of tmp_path / "s.db", without ``fcntl``."""
    with subprocess.Popen(without(_HOLD, tmp_path / "s.db"), stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "held\n"
        yield process
        process.kill()


_SAID = """
from pathlib import Path
from pareto_monoped.errors import DatabaseError
from pareto_monoped.storage.lock import holder, locked
db = Path(sys.argv[1])
print(holder(db))
try:
    with locked(db) as lock:
        lock.confirm(3)
        print("got it", holder(db) == os.getpid())
except DatabaseError as error:
    print(error)
print(*sorted(path.name for path in db.parent.iterdir()))
"""


def said(tmp_path):
    done = subprocess.run(without(_SAID, tmp_path / "s.db"), capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


def test_a_second_process_is_refused_until_the_first_is_killed(tmp_path, other):
    for _ in range(2):  # who is refused takes nothing away from who holds it
        first, refused, _ = said(tmp_path)
        assert first == str(other.pid)
        assert f"is being run by process {other.pid};" in refused
    other.kill()
    other.wait()
    assert said(tmp_path) == ["None", "got it True", ""]


_STUDY = """
import pareto_monoped as pm
folder = sys.argv[1]
study = pm.Study.define(name="small", evaluations=6, algorithm={"name": "random", "population": 5}, audit=False)
stored = pm.run(study, folder + "/small.db")
stored = pm.resume(folder + "/small.db", evaluations=8)
pm.write_report(stored, folder + "/small.html")
from pareto_monoped.compute.processes import Processes
with Processes() as processes:
    assert processes.submit(int, "7").result() == 7
assert "pareto_monoped.storage.lock" in sys.modules
assert "psycopg" not in sys.modules  # files need nothing of a server
print(len(stored.trials), *sorted(os.listdir(folder)))
"""


def test_a_study_runs_and_goes_on(tmp_path):
    done = subprocess.run(
        without(_STUDY, tmp_path, libraries="import matplotlib, numba, optuna, pandas"),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stderr == ""
    assert done.stdout == "8 small.db small.html\n"
