"""Call the command line thousands of times with damaged files, odd words and a hostile environment.

Each call has a folder of its own with studies and files, of which some are damaged first. Most calls run in a fork of
one process that has imported everything, some in a fresh interpreter. A call must end with exit code 0, 1, 2 or 130,
without a traceback or warning, and with one line that says why; it must neither hang, nor leave temporary or
half-written files, nor change a file that it was not told to write, nor any study that it does not continue.

    python tools/fuzz.py --calls 10000 --seed 1 [--mount] [--only N] [--keep DIR] [--command NAME]
"""

import argparse
import atexit
import collections
import contextlib
import ctypes
import json
import os
import random
import resource
import selectors
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # no thread may run when a call is forked
sys.path.insert(0, str(Path(__file__).parents[1]))

from fuzz_calls import WEIGHTS, Call, call_of
from fuzz_checks import Result, findings, snapshot

ROOT = Path(__file__).parents[1]
STORED = ROOT / "tests" / "storage" / "data"
PATIENCE_S = 60.0
"""After which a call counts as one that hangs, on a busy machine, too; the longest calls are told at the end."""
_STRIKES = {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}
DISK_BYTES = 6_000_000


STUDY = """\
name = "s"
description = "to be damaged"
motor = "VT8020"
calibration = "reference"
evaluations = 30
seed = 1
audit = false
objectives = ["height_m", "energy_j"]

[variables]
thigh_length_m = 0.4
knee_ratio = { lower = 5.0, upper = 7.0 }
rest_length_m = { lower = 1.0, upper = 10.0 }

[constraints]
mass_kg = { max = 6.0 }
min_height_m = 0.55

[reference_point]
height_m = 0.5
energy_j = 100.0

[stop]
wall_time_s = 20.0

[algorithm]
name = "random"
population = 10
"""

CAMPAIGN = """\
name = "grid"

[study]
evaluations = 20
audit = false
stop = { wall_time_s = 20.0 }
algorithm = { name = "nsga2", population = 10 }

[axes]
motors = ["VT8020", "m.toml"]
seeds = [1]
"""


_WORTH_ALL = 20
"""Calls from which it saves time to import everything before they are forked: our own choice."""


def basis(folder: Path, *, ready: bool = True) -> None:
    """Make the files that every call finds; if ``ready``, import all of the package before calls are forked."""
    from pareto_monoped import cli

    folder.mkdir()
    (folder / "study.toml").write_text(STUDY)
    (folder / "grid.toml").write_text(CAMPAIGN)
    for name, source in {"old.db": "plain.db", "own.db": "own_files.db", "m.toml": "my_motor.toml"}.items():
        shutil.copy(STORED / source, folder / name)
    shutil.copy(STORED / "my_calibration.toml", folder / "cal.toml")
    shutil.copy(ROOT / "pareto_monoped" / "data" / "uncertainty.toml", folder / "unc.toml")
    (folder / "notes.txt").write_text("my notes\n")
    for name in ("folder", "busy"):
        (folder / name).mkdir()
        (folder / name / "keep.txt").write_text("keep\n")
    (folder / "loop").symlink_to("loop")
    (folder / "loop.toml").symlink_to("loop.toml")
    (folder / "design.json").write_text(json.dumps(_record(folder), indent=2) + "\n")
    study, db = folder / "study.toml", folder / "s.db"
    warm = folder.parent / "warm"
    warm.mkdir()
    most = None if ready else 1  # the study is a file that calls find
    for words in (
        ["run", study, "--db", db, "--workers", "1"], ["report", db, "-o", warm / "r.html", "--figures", warm],
        ["table1"], ["actuators", "--figure", warm / "a.svg"], ["actuators", "--rules", "paper"], ["verify", db],
        ["pick", db, "--knee", "--alternatives", "2"], ["robust", db, "--trial", "0", "--samples", "64"],
        ["status", db], ["trials", db], ["campaign", folder / "grid.toml", "--status", "--report", warm / "c.html"],
        ["robust", folder / "own.db", "--trial", "0", "--samples", "64"], ["front", folder / "own.db"],
    )[:most]:  # fmt: skip
        with contextlib.redirect_stdout(None), contextlib.redirect_stderr(None):
            cli._run([str(word) for word in words])
    if ready:
        from pareto_monoped.cli import exports, pareto  # noqa: F401


def _record(folder: Path) -> dict[str, Any]:
    """A record of an export that was never made."""
    from pareto_monoped.cad.export import simulated_jumps
    from pareto_monoped.cad.jobs import case_job
    from pareto_monoped.cad.records import expected_record

    job = case_job("C", folder=folder / "export", formats=["urdf"])
    record = expected_record(job)
    jumps = simulated_jumps({"searched": job.design, "as_built": job.design}, job.maps(), job.calibration)
    return {**record, "jumps": jumps, "formats": ["urdf"], "files": []}


def child(call: Call, folder: Path, streams: tuple[int, int]) -> None:
    """In the forked process: take on the limits and surroundings of a call, make it, and end."""
    os.setsid()
    options, environment = call.options, dict(os.environ)
    for name, text in call.environment.items():
        environment.pop(name, None)
        if text is not None:
            environment[name] = text
    for number, name in ((1, "stdout"), (2, "stderr")):
        os.dup2(streams[number - 1], number)
        _redirect(number, options.get(name))
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.closerange(3, 200)
    if "stdin" in options:
        os.close(0)
    os.chdir(folder)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    for name, limit in (("file_size", resource.RLIMIT_FSIZE), ("files", resource.RLIMIT_NOFILE)):
        if isinstance(value := options.get(name), int):
            resource.setrlimit(limit, (value, value))
    if "umask" in options:
        os.umask(int(str(options["umask"])))
    if "read_only" in options and os.getuid() == 0:
        _obey_permissions()
    words = ["pareto-monoped", *call.words]
    if "fresh" in options:
        environment["PYTHONPATH"] = str(ROOT)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, _STRIKES)
        os.execve(sys.executable, [sys.executable, "-m", "pareto_monoped", *words[1:]], environment)
    os.environ.clear()
    os.environ.update(environment)
    for number, stream in ((1, "stdout"), (2, "stderr")):
        try:
            os.fstat(number)
            encoding = environment.get("PYTHONIOENCODING") or "utf-8"
            setattr(sys, stream, open(number, "w", encoding=encoding, closefd=False))  # noqa: SIM115
        except OSError:
            setattr(sys, stream, None)
    from pareto_monoped import cli

    sys.argv = words
    try:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, _STRIKES)
    except KeyboardInterrupt:
        os._exit(130)
    try:
        cli.main()
    except SystemExit:
        atexit._run_exitfuncs()
    os._exit(99)  # never reached: the last handler ends the process


def _obey_permissions() -> None:
    """Give up what lets root write to files and folders that are read-only (capset(2), CAP_DAC_*)."""
    library, header, sets = ctypes.CDLL(None, use_errno=True), struct.pack("Ii", 0x20080522, 0), bytearray(24)
    buffer = (ctypes.c_char * len(sets)).from_buffer(sets)
    failed = library.capget(header, buffer)
    effective, permitted, *rest = struct.unpack("6I", sets)
    struct.pack_into("6I", sets, 0, effective & ~0b110, permitted & ~0b110, *rest)
    if failed or library.capset(header, buffer):
        raise OSError(ctypes.get_errno(), "capset")


def _redirect(number: int, how: object) -> None:
    if how == "closed":
        os.close(number)
    elif how == "full":
        os.dup2(os.open("/dev/full", os.O_WRONLY), number)
    elif how == "broken":
        reader, writer = os.pipe()
        os.dup2(writer, number)
        os.close(reader)
        os.close(writer)


def made(call: Call, folder: Path) -> tuple[Result, tuple[float, float]]:
    """Make a call: exit code (None if it hangs), output, messages; seconds that passed, and of processor time."""
    pipes = os.pipe(), os.pipe()
    # A signal that comes before the command has begun is none of its business.
    signal.pthread_sigmask(signal.SIG_BLOCK, _STRIKES)
    process = os.fork()
    if process:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, _STRIKES)
    else:
        try:
            child(call, folder, (pipes[0][1], pipes[1][1]))
        except BaseException as error:
            os.write(2, "".join(traceback.format_exception(error)).encode())
        os._exit(98)
    chooser, texts = selectors.DefaultSelector(), (bytearray(), bytearray())
    for k, (reader, writer) in enumerate(pipes):
        os.close(writer)
        chooser.register(reader, selectors.EVENT_READ, (reader, texts[k]))
    began = time.monotonic()
    strike = call.options.get("signal")
    while chooser.get_map():
        now = time.monotonic() - began
        if isinstance(strike, tuple) and now >= strike[1]:
            os.kill(process, signal.Signals[strike[0]])
            strike = None
        if now > PATIENCE_S:
            os.killpg(process, signal.SIGKILL)
            break
        for key, _ in chooser.select(0.01 if strike else 1.0):
            reader, text = key.data
            if part := os.read(reader, 65536):
                text += part
            else:
                chooser.unregister(reader)
    for reader, _ in pipes:
        os.close(reader)
    _, status, used = os.wait4(process, 0)
    passed = time.monotonic() - began
    code = None if passed > PATIENCE_S else os.waitstatus_to_exitcode(status)
    encoding = call.environment.get("PYTHONIOENCODING") or "utf-8"
    result = code, texts[0].decode(encoding, "replace"), texts[1].decode(encoding, "replace")
    return result, (passed, used.ru_utime + used.ru_stime)


def one(
    seed: int, number: int, source: Path, place: Path, given: argparse.Namespace
) -> tuple[Call, Result, tuple[float, float], list[str]]:
    """Make call ``number`` of a seed in a new folder; returns it, how it ended, its time, and what is wrong."""
    from pareto_monoped.cli import cli

    dice = random.Random(f"{seed}:{number}")
    call = call_of(dice, cli, given.command)
    for name in given.without:
        call.options.pop(name, None)
    disk = place.parent / "disk"
    if "tiny_disk" in call.options:
        if disk.is_mount():
            place = disk / "call"
        else:
            del call.options["tiny_disk"]
    shutil.copytree(source, place, symlinks=True)
    for harm in call.harm:
        with contextlib.suppress(OSError):
            harm(place)
    for name in ("pipe", "pipe.toml"):
        os.mkfifo(place / name)
    with contextlib.closing(socket.socket(socket.AF_UNIX)) as bound:
        bound.bind(os.path.relpath(place / "socket.toml"))  # an absolute path may be too long for a socket
    if place.parent == disk:
        free = shutil.disk_usage(disk).free - int(str(call.options["tiny_disk"]))
        (disk / "filler").write_bytes(bytes(max(free, 0)))
    before = snapshot(place)
    if "read_only" in call.options:
        place.chmod(0o555)
    result, seconds = made(call, place)
    place.chmod(0o755)
    wrong = list(findings(call, place, before, result))
    if wrong and given.keep:
        shutil.rmtree(given.keep / str(number), ignore_errors=True)
        special = shutil.ignore_patterns("pipe*", "socket.toml")
        shutil.copytree(place, given.keep / str(number), symlinks=True, ignore=special)
    shutil.rmtree(place)
    (disk / "filler").unlink(missing_ok=True)
    return call, result, seconds, wrong


_TELL_EVERY = 500
"""Calls between two lines of progress."""


def main() -> int:
    """Parse, prepare, make the calls, report."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--calls", type=int, default=300)
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(10**6))
    parser.add_argument("--first", type=int, default=0, help="number of the first call")
    parser.add_argument("--only", type=int, help="make this call alone")
    parser.add_argument("--keep", type=Path, help="keep the folders of calls that went wrong")
    parser.add_argument("--without", action="append", default=[], help="an option of calls, such as signal")
    parser.add_argument("--command", action="append", default=[], choices=WEIGHTS, help="call this one and no other")
    parser.add_argument("--mount", action="store_true", help="also calls on a full disk; needs root")
    given = parser.parse_args()
    print(f"seed {given.seed}", flush=True)
    numbers = range(given.first, given.first + given.calls) if given.only is None else [given.only]
    codes: collections.Counter[tuple[str, int | None]] = collections.Counter()
    failed, longest = 0, list[tuple[float, float, int, list[str]]]()
    with tempfile.TemporaryDirectory(prefix="fuzz-") as temporary, _disk(Path(temporary) / "disk", given.mount):
        root = Path(temporary)
        root.chmod(0o755)
        basis(root / "basis", ready=len(numbers) >= _WORTH_ALL)
        for done, number in enumerate(numbers, 1):
            call, (code, _, err), seconds, wrong = one(given.seed, number, root / "basis", root / "call", given)
            longest = sorted([*longest, (*seconds, number, call.words)], reverse=True)[:5]
            codes[call.words[0], code] += 1
            if wrong:
                failed += 1
                print(f"call {number}: {'; '.join(wrong)}\n  {call.words}\n  {call.environment} {call.options}")
                print("  " + "\n  ".join(err.splitlines()[-3:]), flush=True)
            if done % _TELL_EVERY == 0:
                print(f"{done} calls, {failed} with findings", flush=True)
    for command in sorted({command for command, _ in codes}):
        row = {code: count for (name, code), count in sorted(codes.items(), key=str) if name == command}
        print(f"{command:12} {sum(row.values()):6}  {row}")
    for passed, busy, number, words in longest:
        print(f"call {number} took {passed:.1f} s, {busy:.1f} s of them computing: {words}")
    print(f"{sum(codes.values())} calls, {failed} with findings, seed {given.seed}")
    return 1 if failed else 0


@contextlib.contextmanager
def _disk(path: Path, wanted: bool) -> Iterator[None]:
    """A small file system of its own, for calls on a full disk."""
    path.mkdir()
    if wanted:
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={DISK_BYTES},mode=755", "tmpfs", path], check=True)
    try:
        yield
    finally:
        if wanted:
            subprocess.run(["umount", "-l", path], check=True)


if __name__ == "__main__":
    sys.exit(main())
