"""A campaign killed by SIGKILL again and again, and one that was not: for test_kill.py and the documented figures.

    python -m tests.campaign.killed CAMPAIGN.toml KILLS SEED

Runs the campaign once in one go into a folder beside the file, and once with kills of its coordinator, of one of its
workers, or of all of them at once, at random moments. Prints JSON: what was seen after each kill, and whether the
studies of both are equal.
"""

import json
import os
import random
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

from pareto_monoped.storage.lock import holder
from pareto_monoped.storage.reader import read_study

CORES = 2
"""Threads of a campaign here; the result does not depend on them."""


class Running:
    """The command in a process group of its own, with what it has acknowledged."""

    def __init__(self, file, folder, cores=CORES, *, stderr=subprocess.PIPE):
        line = [sys.executable, "-m", "pareto_monoped", "campaign", str(file), "--folder", str(folder), "--json"]
        self.process = subprocess.Popen(
            [*line, "--workers", str(cores)], stdout=subprocess.PIPE, stderr=stderr, text=True, start_new_session=True
        )
        self.acknowledged = {}
        self.ended = []
        self.states = []
        self.messages = ""
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()

    def _listen(self):
        for line in self.process.stdout:
            if not line.endswith("\n"):
                continue
            said = json.loads(line)
            if said["event"] == "end":
                self.states = said["studies"]
                continue
            if said["event"] == "study":
                self.ended.append(said)
            self.acknowledged[said["study"]] = max(said["evaluations"], self.acknowledged.get(said["study"], 0))

    def children(self):
        """Ids of the processes that are at work on studies."""
        said = subprocess.run(
            ["ps", "-ww", "-o", "pid=,args=", "--ppid", str(self.process.pid)],
            capture_output=True,
            text=True,
            check=False,
        )
        return [int(line.split()[0]) for line in said.stdout.splitlines() if "serve(int" in line]

    def until(self, condition, seconds=120.0):
        """Wait until something holds, or the command has ended."""
        end = time.monotonic() + seconds
        while not condition() and self.process.poll() is None:
            assert time.monotonic() < end, "it takes too long"
            time.sleep(0.02)

    def code(self):
        """Wait for the end; the exit code."""
        code = self.process.wait()
        self._thread.join()
        self.process.stdout.close()
        if self.process.stderr is not None:
            self.messages = self.process.stderr.read()
            self.process.stderr.close()
        return code


def gone(pid):
    """Whether a process has ended, or only waits to be told."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return True
    return state == "Z"


def killed(file, folder, delay, what):
    """Run, and kill some of it after a delay from the first acknowledged trials on."""
    run = Running(file, folder)
    run.until(lambda: any(run.acknowledged.values()) or run.ended)
    time.sleep(delay)
    workers = run.children()
    alone = what == "worker"
    if run.process.poll() is None:
        if what == "all":
            os.killpg(run.process.pid, signal.SIGKILL)
        elif alone and workers:
            os.kill(workers[0], signal.SIGKILL)
        else:
            os.kill(run.process.pid, signal.SIGKILL)
    if alone:
        # Its study goes on by itself; the coordinator is killed a little later.
        time.sleep(delay)
        if run.process.poll() is None:
            os.kill(run.process.pid, signal.SIGKILL)
    return {"what": what} | left_behind(run, workers, folder)


def left_behind(run, workers, folder):
    """What is there once a killed command has ended: its exit code, processes, trials, and studies that are held."""
    code = run.code()
    began = time.monotonic()
    while not all(map(gone, workers)) and time.monotonic() - began < 30.0:
        time.sleep(0.01)
    orphans = [pid for pid in workers if not gone(pid)]
    stored = {db.stem: len(read_study(db).trials) for db in sorted(Path(folder).glob("*.db"))}
    lost = {name: count for name, count in run.acknowledged.items() if count > stored.get(name, 0)}
    return {
        "code": code,
        "workers": len(workers),
        "orphans": orphans,
        "workers_gone_s": round(time.monotonic() - began, 2),
        "stored": stored,
        "lost": lost,
        "held": [db.stem for db in Path(folder).glob("*.db") if holder(db) is not None],
    }


def differences(one, other):
    """Names of studies that are not equal in both folders."""
    names = sorted(db.stem for db in Path(one).glob("*.db"))
    assert names == sorted(db.stem for db in Path(other).glob("*.db"))
    different = []
    for name in names:
        a, b = read_study(Path(one) / f"{name}.db"), read_study(Path(other) / f"{name}.db")
        equal = (
            a.trials.equals(b.trials)
            and a.front().equals(b.front())
            and a.checkpoint == b.checkpoint
            and a.meta.hash == b.meta.hash
            and a.history["hypervolume"].equals(b.history["hypervolume"])
            and a.audits.equals(b.audits)
        )
        if not equal:
            different.append(name)
    return names, different


def storm(file, kills, seed):
    """Both campaigns; what was seen."""
    generator = random.Random(seed)
    whole, broken = file.parent / "whole", file.parent / "killed"
    began = time.monotonic()
    run = Running(file, whole, stderr=None)
    code = run.code()
    assert code == 0, code
    seconds = time.monotonic() - began
    seen = []
    for k in range(kills):
        what = ("coordinator", "worker", "all")[k % 3]
        share = 0.5 if what == "worker" else 1.0
        seen.append(killed(file, broken, share * generator.uniform(0.0, seconds / kills), what))
        print(seen[-1], file=sys.stderr, flush=True)
    run = Running(file, broken, stderr=None)
    assert run.code() == 0
    names, different = differences(whole, broken)
    return {"seconds": seconds, "kills": seen, "studies": names, "different": different}


if __name__ == "__main__":
    print(json.dumps(storm(Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]))))
