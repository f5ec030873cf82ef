"""A script for test_kill.py: runs a study once in one go and once killed by SIGKILL again and again.

    python -m tests.study.killed STUDY.toml FOLDER KILLS SEED

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

from pareto_monoped.study.algorithms import create
from pareto_monoped.study.definition import load_study
from pareto_monoped.study.physics import load_physics
from pareto_monoped.study.reader import read_study
from pareto_monoped.study.run import run


def start(study, db, workers):
    """Run in a forked process; returns its id and a pipe with a number of safe trials a line."""
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


def main():
    study, folder = load_study(Path(sys.argv[1])), Path(sys.argv[2])
    kills, generator = int(sys.argv[3]), random.Random(int(sys.argv[4]))
    # Compiled code is loaded once, here; a single worker leaves no thread behind that a fork would lose.
    load_physics(study, workers=1).probe()
    create(study)

    began = time.monotonic()
    child, pipe = start(study, folder / "whole.db", 1)
    pipe.read()
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    seconds = time.monotonic() - began

    db, report = folder / "killed.db", []
    while len(report) < kills:
        child, pipe = start(study, db, 1 + len(report) % 2)
        # Every other kill comes while it is at work for sure; the rest may hit the start, too.
        first = pipe.readline() if len(report) % 2 else ""
        time.sleep(generator.uniform(0.0, seconds / kills))
        os.kill(child, signal.SIGKILL)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        lines = (first + pipe.read()).splitlines(keepends=True)
        acknowledged = [int(line) for line in lines if line.endswith("\n")]
        if not db.exists():
            stored, sound = 0, "ok"
        else:
            stored = len(read_study(db).trials)
            connection = sqlite3.connect(db)
            sound = connection.execute("PRAGMA integrity_check").fetchone()[0]
            connection.close()
        report.append({"code": code, "acknowledged": max(acknowledged, default=0), "stored": stored, "sound": sound})
    child, pipe = start(study, db, 2)
    pipe.read()
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    print(json.dumps({"seconds": seconds, "kills": report}))


if __name__ == "__main__":
    main()
