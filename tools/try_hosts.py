"""Try robust evaluation on two hosts by SSH; the hosts are network namespaces of this machine.

    python tools/try_hosts.py

Each host has an address, a cable to a switch, and an SSH server with a key of its own, and runs what
``recipes/ssh_hosts.py`` starts there. The coordinator is on the switch. The same designs are made robust again and
again: undisturbed, with one host's cable pulled for ten seconds, with a worker killed, and with a whole host killed.
Every time the database must hold what threads of one process store, to the last bit.

Needs Linux, root, iproute2, OpenSSH's server and asyncssh. The package must be installed for this Python: hosts see
none of this terminal's settings. Exits with 1 if a number differs, or if a host had nothing to do.
"""

import argparse
import os
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.storage.extra_rows import read_robustness
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import run

ROOT = Path(__file__).parents[1]
_SWITCH, _NETWORK = "pmtry", "198.18.77"
"""Addresses for tests of networks (RFC 2544)."""
_CUT_S = 10.0
_TICKS = os.sysconf("SC_CLK_TCK")


def call(command: str, *, must: bool = True) -> str:
    """Run a program to its end, which must succeed; what it printed."""
    done = subprocess.run(shlex.split(command), check=False, capture_output=True, text=True)
    if must and done.returncode:
        raise SystemExit(f"{command}: {done.stderr.strip()}")
    return done.stdout


class Host:
    """A network namespace with a cable to the switch and an SSH server."""

    def __init__(self, number: int) -> None:
        self.name, self.address = f"{_SWITCH}{number}", f"{_NETWORK}.{number}"

    def start(self, folder: Path) -> None:
        """Connect it to the switch and let SSH in; keys are in the folder."""
        call(f"ip netns add {self.name}")
        call(f"ip link add {self.name} type veth peer name eth0 netns {self.name}")
        call(f"ip link set {self.name} master {_SWITCH} up")
        for words in ("link set lo up", f"addr add {self.address}/24 dev eth0", "link set eth0 up"):
            call(f"ip -n {self.name} {words}")
        call(f"ip -n {self.name} route add default via {_NETWORK}.254")
        key = folder / self.name
        call(f"ssh-keygen -q -t ed25519 -N '' -f {key}")
        with (folder / ".ssh" / "known_hosts").open("a") as known:
            known.write(f"{self.address} {key.with_suffix('.pub').read_text()}")
        settings = {
            "Port": 22,
            "ListenAddress": self.address,
            "HostKey": key,
            "AuthorizedKeysFile": folder / ".ssh" / "id_ed25519.pub",
            "PasswordAuthentication": "no",
            "PermitRootLogin": "prohibit-password",
            "PidFile": "none",
            "StrictModes": "no",
            "UsePAM": "no",
        }
        options = " ".join(f"-o {name}={value}" for name, value in settings.items())
        server = f"ip netns exec {self.name} {shutil.which('sshd')} -D -e -f /dev/null {options}"
        with (folder / "sshd.log").open("a") as log:
            subprocess.Popen(shlex.split(server), stdout=log, stderr=log)

    def processes(self, word: str) -> list[int]:
        """What runs here and has a word in its command line."""
        found = []
        for process in map(int, call(f"ip netns pids {self.name}", must=False).split()):
            with suppress(OSError):  # it has just ended
                if word.encode() in Path(f"/proc/{process}/cmdline").read_bytes():
                    found.append(process)
        return found

    def processor_s(self) -> float:
        """Processor time of what runs here now (Linux, ``proc(5)``: utime and stime)."""
        ticks = 0
        for process in self.processes("python"):
            with suppress(OSError):  # it has just ended
                values = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
                ticks += int(values[11]) + int(values[12])
        return ticks / _TICKS

    def cut(self) -> None:
        """Pull the cable for a while."""
        call(f"ip link set {self.name} down")
        time.sleep(_CUT_S)
        call(f"ip link set {self.name} up")

    def kill(self, word: str, most: int | None = None) -> None:
        """Kill what has a word in its command line, or the first of it."""
        for process in self.processes(word)[:most]:
            with suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)

    def remove(self) -> None:
        """End everything here, then the host, so far as there is one."""
        self.kill("")
        call(f"ip link del {self.name}", must=False)  # with its namespace it would go when the last process has ended
        call(f"ip netns del {self.name}", must=False)


@contextmanager
def hosts(folder: Path) -> Iterator[list[Host]]:
    """Two hosts, and the switch to which this process is connected, too."""
    (folder / ".ssh").mkdir()
    call(f"ssh-keygen -q -t ed25519 -N '' -f {folder}/.ssh/id_ed25519")
    Path("/run/sshd").mkdir(exist_ok=True)
    made = [Host(1), Host(2)]
    try:
        call(f"ip link add {_SWITCH} type bridge")
        call(f"ip addr add {_NETWORK}.254/24 dev {_SWITCH}")
        call(f"ip link set {_SWITCH} up")
        for host in made:
            host.start(folder)
        yield made
    finally:
        for host in made:
            host.remove()
        call(f"ip link del {_SWITCH}", must=False)


def robust_on(where: list[Host], command: list[str], db: Path, event: Callable[[], None] | None) -> str:
    """Robust evaluation of a study by the recipe, with an event once designs are stored; what the command said."""
    began_s, spent_s, happened = time.monotonic(), [0.0 for _ in where], event is None
    with (db.parent / f"{db.stem}.log").open("w") as log:
        process = subprocess.Popen(command, stdout=log, stderr=log, env=os.environ | {"HOME": str(db.parent)})
    try:
        while process.poll() is None:
            time.sleep(0.2)
            spent_s = [max(before, host.processor_s()) for before, host in zip(spent_s, where, strict=True)]
            if event and not happened and read_robustness(db):
                happened = True
                event()
    finally:
        process.terminate()
    text = Path(log.name).read_text()
    if process.returncode or min(spent_s) < 1.0 or not happened:
        raise SystemExit(f"{shlex.join(command)}: code {process.returncode}, processor time {spent_s} s\n{text}")
    print("".join(f"  {line}\n" for line in text.splitlines() if line.startswith(("worker ", "scheduler "))), end="")
    times = ", ".join(f"{host.name} {host_s:.1f} s" for host, host_s in zip(where, spent_s, strict=True))
    print(f"  {time.monotonic() - began_s:.0f} s; processor time: {times}", flush=True)
    return text


def main() -> None:
    """Try all; fails if anything differs."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--designs", type=int, default=64, help="at least 40: they are stored by 32")
    parser.add_argument("--workers", type=int, default=1, help="per host")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as place, hosts(Path(place)) as (one, other):
        study, folder = Path(place) / "study.db", Path(place)
        run(study_from_dict({"name": "s", "evaluations": 5 * asked.designs, "audit": False}, source="try"), study)
        every = max(len(read_study(study).front()) // asked.designs, 1)
        robust = ["robust", "--every", str(every)]
        threads = Path(shutil.copy(study, folder / "threads.db"))
        subprocess.run([sys.executable, "-m", "pareto_monoped", *robust, str(threads)], check=True, capture_output=True)
        expected = read_robustness(threads)
        print(f"{len(expected)} designs x 256 jumps, workers on each of two hosts: {asked.workers}", flush=True)
        events: dict[str, Callable[[], None] | None] = {
            "undisturbed": None,
            "cable pulled for 10 s": other.cut,
            "worker killed": lambda: other.kill("spawn_main", most=1),
            "host killed": lambda: other.kill("python"),
        }
        for name, happens in events.items():
            print(name, flush=True)
            db = Path(shutil.copy(study, folder / f"{name.replace(' ', '_')}.db"))
            recipe = [sys.executable, str(ROOT / "recipes" / "ssh_hosts.py"), "--workers", str(asked.workers)]
            command = [*recipe, f"{one.address},{other.address}", *robust, str(db)]
            said = robust_on([one, other], command, db, happens)
            if "killed" in name and "has gone; its work goes elsewhere" not in said:
                raise SystemExit(f"{name}: nobody missed it; try more designs\n{said}")
            if read_robustness(db) != expected:
                raise SystemExit(f"{name}: other numbers than on threads")
            print("  the same numbers as on threads", flush=True)


if __name__ == "__main__":
    main()
