"""The files of a study are deleted, renamed or replaced under a run, or after a kill; links lead to its lock."""

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from pareto_monoped.errors import DatabaseError, LostTrialsError, OutputError
from pareto_monoped.storage.lock import holder, locked
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.store import Store
from pareto_monoped.study.run import resume
from tests.study.support import copied_database, made_evaluations, made_generation, made_study

ROOT = Path(__file__).parents[2]


def one(number):
    return made_generation(made_study(), number, number + 4, made_evaluations([0.75], [8.5]), state={})


def renamed(file):
    file.rename(file.with_name("elsewhere"))


def replaced(file):
    shutil.copy(file, file.with_name("copy"))
    file.with_name("copy").replace(file)


@pytest.mark.parametrize("harm", [Path.unlink, renamed, replaced])
@pytest.mark.parametrize("name", ["s.db", "s.db-wal"])
def test_it_is_noticed_before_anything_more_is_acknowledged(tmp_path, name, harm):
    copied_database(tmp_path / "s.db")
    with locked(tmp_path / "s.db") as lock, Store(tmp_path / "s.db", made_study(), lock=lock) as store:
        store.add(one(2))
        safe = (tmp_path / "s.db-lock").read_bytes()
        harm(tmp_path / name)
        with pytest.raises(DatabaseError, match=f"{name}' was deleted, renamed or replaced during the run"):
            store.add(one(3))
        assert (tmp_path / "s.db-lock").read_bytes() == safe


@pytest.fixture(scope="module")
def killed_once(tmp_path_factory):
    """A study killed at work: database, log with acknowledged trials, lock."""
    folder = tmp_path_factory.mktemp("killed")
    toml = folder / "s.toml"
    toml.write_text('name = "s"\nevaluations = 100000\naudit = false\n[algorithm]\nname = "random"\npopulation = 20\n')
    words = [sys.executable, "-m", "pareto_monoped", "run", str(toml), "--workers", "1"]
    process = subprocess.Popen(words, cwd=ROOT, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    deadline, db = time.monotonic() + 100.0, folder / "s.db"
    while time.monotonic() < deadline and not (db.exists() and len(read_study(db).trials) >= 40):
        time.sleep(0.05)
    process.send_signal(signal.SIGKILL)
    process.wait()
    return folder


@pytest.fixture
def killed(killed_once, tmp_path):
    """The database among a copy of its files."""
    shutil.copytree(killed_once, tmp_path, dirs_exist_ok=True)
    return tmp_path / "s.db"


def test_a_lost_log_is_told(killed):
    stored = len(read_study(killed).trials)
    assert stored >= 40
    (killed.parent / "log").write_bytes(Path(f"{killed}-wal").read_bytes())
    Path(f"{killed}-wal").unlink()
    Path(f"{killed}-shm").unlink(missing_ok=True)
    lost = len(read_study(killed).trials)
    assert lost < stored
    with locked(killed):  # by a command that does not ask
        pass
    for _ in range(2):
        with pytest.raises(
            LostTrialsError, match=r"lacks the last \d+ transactions of a killed run.*'s.db-lock' to go on"
        ):
            resume(killed, evaluations=60, workers=1)
    assert len(read_study(killed).trials) == lost
    Path(f"{killed}-lock").unlink()
    assert resume(killed, evaluations=60, workers=1).evaluations == 60


def test_after_a_kill_with_everything_in_place_it_goes_on(killed):
    stored = len(read_study(killed).trials)
    assert resume(killed, evaluations=stored + 20, workers=1).evaluations == stored + 20
    assert sorted(path.name for path in killed.parent.iterdir()) == ["s.db", "s.toml"]


def test_a_link_named_like_the_lock_is_not_followed(tmp_path):
    (tmp_path / "victim").write_text("precious")
    (tmp_path / "s.db-lock").symlink_to("victim")
    with pytest.raises(OutputError, match=r"s.db-lock': something else has its name"), locked(tmp_path / "s.db"):
        pass
    assert holder(tmp_path / "s.db") is None
    assert (tmp_path / "victim").read_text() == "precious"


@pytest.mark.parametrize("make", [Path.mkdir, os.mkfifo, lambda path: path.write_text("my notes on locks\n")])
def test_what_is_no_lock_is_left_alone(tmp_path, make):
    path = tmp_path / "s.db-lock"
    make(path)
    before = path.stat()
    with pytest.raises(OutputError, match="something else has its name"), locked(tmp_path / "s.db"):
        pass
    assert (path.stat().st_mode, path.stat().st_size) == (before.st_mode, before.st_size)


def test_through_a_link_it_is_the_same_study(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "b").symlink_to("a")
    (tmp_path / "a" / "t.db").symlink_to("s.db")
    with locked(tmp_path / "a" / "s.db"):
        for other in (tmp_path / "b" / "s.db", tmp_path / "a" / "t.db"):
            assert holder(other) == os.getpid()
            with pytest.raises(DatabaseError, match="is being run by process"), locked(other):
                pass


# In any command: tests/cli/test_process.py; what a run does with each: tests/study/test_interrupt.py; a run that one
# of them ends: tests/study/test_run.py.
@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_other_signals_end_it_as_ctrl_c_does(tmp_path, number):
    toml = tmp_path / "s.toml"
    toml.write_text('name = "s"\nevaluations = 100000\naudit = false\n')
    words = [sys.executable, "-m", "pareto_monoped", "run", str(toml), "--workers", "1"]
    # Under nohup the tests ignore SIGHUP, and the command would inherit that.
    inherited = signal.signal(number, signal.SIG_DFL)
    process = subprocess.Popen(words, cwd=ROOT, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
    signal.signal(number, inherited)
    try:
        deadline, db = time.monotonic() + 100.0, tmp_path / "s.db"
        while time.monotonic() < deadline and not (db.exists() and len(read_study(db).trials)):
            time.sleep(0.05)
        process.send_signal(number)
        _, said = process.communicate(timeout=100)
    finally:
        process.kill()
        process.communicate()
    assert process.returncode == 130
    assert "ending after this generation" in said
    assert read_study(db).meta.stop_reason == "interrupted"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["s.db", "s.toml"]
