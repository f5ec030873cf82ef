"""A script for test_kill.py: runs each folder's s.toml once in one go and once killed by SIGKILL again and again.

    python -m tests.study.killed KILLS SEED FOLDER ...

Everything heavy is imported once; each run is a process of its own, forked from here. Prints JSON.
"""

import json
import os
import random
import signal
import sqlite3
import sys
import time
from pathlib import Path

from pareto_monoped.definition.study import load_study
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import run


def start(study, db, workers):
    """Run in a forked process; returns its id and a pipe that gives the number of safe trials, one per line."""
    reading, writing = os.pipe()
    child = os.fork()
    if child:
        os.close(writing)
        return child, os.fdopen(reading, "r")
    code = 1
    try:
        os.close(reading)
        run(study, db, workers=workers, progress=lambda p: os.write(writing, f"{p.evaluations}\n".encode()) and None)
        code = 0
    finally:
        os._exit(code)


def whole(study, db):
    """Run in one go; the seconds before the first acknowledged generation, and those after."""
    began = time.monotonic()
    child, pipe = start(study, db, 1)
    pipe.readline()
    first = time.monotonic()
    pipe.read()
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    return first - began, time.monotonic() - first


def kill(study, db, workers, delay, *, at_work):
    """Run, and kill after a delay: from the first acknowledged generation on, or from the start."""
    child, pipe = start(study, db, workers)
    first = pipe.readline() if at_work else ""
    time.sleep(delay)
    os.kill(child, signal.SIGKILL)
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    lines = (first + pipe.read()).splitlines(keepends=True)
    acknowledged = max((int(line) for line in lines if line.endswith("\n")), default=0)
    if not db.exists():
        return {"code": code, "acknowledged": acknowledged, "stored": 0, "sound": "ok"}
    stored = len(read_study(db).trials)
    connection = sqlite3.connect(db)
    sound = connection.execute("PRAGMA integrity_check").fetchone()[0]
    connection.close()
    return {"code": code, "acknowledged": acknowledged, "stored": stored, "sound": sound}


def main():
    kills, generator = int(sys.argv[1]), random.Random(int(sys.argv[2]))
    reports = []
    for folder in map(Path, sys.argv[3:]):
        study = load_study(folder / "s.toml")
        # All modules and compiled code are loaded once, here; a single worker leaves no thread that a fork would lose.
        run(study, folder / "loading.db", workers=1, evaluations=1)
        starting, working = whole(study, folder / "whole.db")
        db, report = folder / "killed.db", []
        for k in range(kills):
            # Two of three kills come while it is at work for sure, the third may hit the start or the restore.
            at_work = k % 3 != 2
            delay = generator.uniform(0.0, working / kills if at_work else starting)
            report.append(kill(study, db, 1 + k % 2, delay, at_work=at_work))
        child, pipe = start(study, db, 2)
        pipe.read()
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
        reports.append(report)
    print(json.dumps(reports))


if __name__ == "__main__":
    main()
