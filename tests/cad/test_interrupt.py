"""Ctrl-C during an export, with real processes and signals: it ends at once and leaves nothing behind."""

import itertools
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from pareto_monoped.cad.write.folder import beside, move_in, noted, unbroken, without_unfinished, write

WORDS = ["export", "--case", "C", "--formats", "step", "-o"]
EXPORT = [sys.executable, "-m", "pareto_monoped", *WORDS]
UNCHECKED = "import sys; from pareto_monoped.cad import export; from pareto_monoped.cli import main\n"
UNCHECKED += "export.run_checks = lambda *_, **__: (); main(sys.argv[1:])"
PATIENCE_S = 300.0
"""For a machine that is busy with other things; what is tested ends in a second or never."""


def children(pid: int) -> list[int]:
    """Processes that a process has started, from the system's table."""
    return [int(word) for word in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def is_running(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


def wait_for(condition):
    end = time.monotonic() + PATIENCE_S
    while not (value := condition()):
        assert time.monotonic() < end
        time.sleep(0.02)
    return value


needs_proc = pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="needs the process table of Linux")


@needs_proc
@pytest.mark.parametrize(
    "phase",
    [
        pytest.param("building", marks=pytest.mark.long),
        pytest.param("simulating", marks=pytest.mark.long),
        pytest.param("checking", marks=pytest.mark.long),
        pytest.param("writing", marks=pytest.mark.long),
    ],
)
def test_an_interrupt_in_any_phase_leaves_nothing(phase, tmp_path):
    """The kernel is stopped, so that whoever waits for it waits for ever."""
    words = [sys.executable, "-c", UNCHECKED, *WORDS] if phase == "writing" else EXPORT
    with subprocess.Popen([*words, tmp_path / "c"], stderr=subprocess.PIPE, text=True) as export:
        assert export.stderr is not None
        kernel = None
        for line in export.stderr:
            if line.startswith("building"):
                (kernel,) = wait_for(lambda: children(export.pid))
            if line.startswith(phase):
                break
        os.kill(kernel, signal.SIGSTOP)
        export.send_signal(signal.SIGINT)
        rest = export.stderr.read()
        assert export.wait(PATIENCE_S) == 130
    assert "interrupted" in rest.splitlines()
    assert rest.count("interrupted") == 1
    assert "Traceback" not in rest
    assert list(tmp_path.iterdir()) == []
    wait_for(lambda: not is_running(kernel))


@pytest.mark.long
def test_an_interrupt_is_answered_where_the_shell_had_it_ignored(tmp_path):
    """A shell starts background jobs with SIGINT ignored."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        export = subprocess.Popen([*EXPORT, tmp_path / "c"], stderr=subprocess.PIPE, text=True)
    finally:
        signal.signal(signal.SIGINT, before)
    with export:
        assert export.stderr is not None
        assert export.stderr.readline().startswith("building")
        export.send_signal(signal.SIGINT)
        assert "interrupted" in export.stderr.read()
    assert export.returncode == 130
    assert list(tmp_path.iterdir()) == []


def test_a_guard_ends_a_process_that_does_not_hear(tmp_path):
    """The exception is swallowed, as by a library's callback, and the program goes on."""
    code = f"""
import signal, sys, time
from pathlib import Path
from pareto_monoped.cad.interrupt import ending_at
from pareto_monoped.cad.write.folder import beside
with ending_at(signal.SIGINT), beside(Path({str(tmp_path / "out")!r})) as folder:
    (folder / "half").write_text("x")
    while True:
        try:
            print("deaf", flush=True)
            time.sleep(1000)
        except KeyboardInterrupt:
            pass
"""
    words = [sys.executable, "-c", code]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as deaf:
        assert deaf.stdout is not None
        assert deaf.stdout.readline() == "deaf\n"
        assert len(list(tmp_path.iterdir())) == 1
        deaf.send_signal(signal.SIGINT)
        assert deaf.wait(PATIENCE_S) == 130
        assert deaf.stderr is not None
        assert deaf.stderr.read() == "interrupted\n"
    assert list(tmp_path.iterdir()) == []


def test_an_interrupt_waits_until_an_export_has_taken_its_place(tmp_path, monkeypatch):
    """Of two files one is moved, then the signal comes: both are there when it is delivered."""
    old, new = tmp_path / "old", tmp_path / "new"
    for folder in (old, new):
        folder.mkdir()
        for name in ("README.md", "bom.csv", "design.json"):
            (folder / name).write_text(folder.name)
    (old / "design.json").write_text('{"files": ["README.md", "bom.csv", "design.json"]}')
    replace, moved = Path.replace, []

    def interrupted(self, target):
        moved.append(replace(self, target))
        if len(moved) == 1:
            os.kill(os.getpid(), signal.SIGINT)
        return moved[-1]

    monkeypatch.setattr(Path, "replace", interrupted)
    # A shell starts its background jobs, such as a test run, with Ctrl-C ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            move_in(new, old)
    finally:
        signal.signal(signal.SIGINT, before)
    assert {path.name: path.read_text() for path in old.iterdir()} == dict.fromkeys(
        ["README.md", "bom.csv", "design.json"], "new"
    )


def test_a_signal_that_nothing_handles_ends_the_process_after_the_move():
    """Such as SIGTERM for a script that exports; Python handles Ctrl-C itself."""
    code = """
import signal
from pareto_monoped.cad.write.folder import unbroken
signal.signal(signal.SIGTERM, signal.SIG_DFL)
with unbroken():
    signal.raise_signal(signal.SIGTERM)
    print("moved", flush=True)
print("went on", flush=True)
"""
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout) == (-signal.SIGTERM, "moved\n")


def test_a_folder_to_which_a_thread_still_writes_is_deleted_and_stays_away(tmp_path):
    """An export that was interrupted while it wrote left its temporary folder behind, once in a while."""
    folder = tmp_path / "half"
    folder.mkdir()
    began, refused = threading.Event(), threading.Event()

    def write_on():
        for k in itertools.count():
            try:
                write(folder, f"sub_{k % 7}/{k}.txt", "x")
            except (FileNotFoundError, FileExistsError):
                # ``mkdir(exist_ok=True)`` says that a folder exists if it is deleted while mkdir looks what it is.
                if not folder.exists():
                    refused.set()
                    return
            began.set()

    with noted(folder):
        writer = threading.Thread(target=write_on, daemon=True)
        writer.start()
        assert began.wait(PATIENCE_S)
        with without_unfinished():
            assert refused.wait(PATIENCE_S)
            assert list(tmp_path.iterdir()) == []


def test_an_interrupt_as_soon_as_the_folder_is_made_leaves_nothing(tmp_path, monkeypatch):
    """The folder was noted only after it had been made, and stayed there if the signal came in between."""
    mkdir = Path.mkdir

    def interrupted(self, *args, **kwargs):
        mkdir(self, *args, **kwargs)
        if self.name.startswith(".c-"):
            raise KeyboardInterrupt

    monkeypatch.setattr(Path, "mkdir", interrupted)
    with pytest.raises(KeyboardInterrupt), beside(tmp_path / "c"):
        pass
    assert list(tmp_path.iterdir()) == []


def test_an_interrupt_before_the_block_is_entered_leaves_nothing(tmp_path):
    """Between a context manager's beginning and its block an exception leaves the manager suspended."""
    code = f"""
import signal
from pathlib import Path
from pareto_monoped.cad.interrupt import ending_at
from pareto_monoped.cad.write.folder import beside
manager = beside(Path({str(tmp_path / "c")!r}))
try:
    with ending_at(signal.SIGINT, grace_s={PATIENCE_S}):
        manager.__enter__()
        print(len(list(Path({str(tmp_path)!r}).iterdir())))
        signal.raise_signal(signal.SIGINT)
except KeyboardInterrupt:
    print(len(list(Path({str(tmp_path)!r}).iterdir())))
"""
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert ended.stdout.split() == ["1", "0"]


def test_unfinished_folders_can_be_deleted_from_outside_but_not_while_one_is_moved(tmp_path):
    folder = tmp_path / "half"
    folder.mkdir()
    with noted(folder), without_unfinished():
        assert not folder.exists()
    with unbroken():
        # The lock is not reentrant: whoever deletes has to wait.
        from pareto_monoped.cad.write import folder as module

        assert not module._moving.acquire(blocking=False)
