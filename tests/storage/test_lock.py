"""The lock against other real processes."""

import errno
import os
import signal
import subprocess
import sys

import pytest

from pareto_monoped.errors import DatabaseError, DiskError, OutputError
from pareto_monoped.storage.lock import holder, locked
from tests.storage.test_other_systems import _HOLD


@pytest.fixture
def other(tmp_path):
    """Another process that holds the lock of tmp_path / "s.db"."""
    process = subprocess.Popen([sys.executable, "-c", _HOLD, str(tmp_path / "s.db")], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "held\n"
    yield process
    process.kill()
    process.wait()
    process.stdout.close()


def test_a_second_process_is_refused_with_the_firsts_id(tmp_path, other):
    with pytest.raises(DatabaseError, match=f"is being run by process {other.pid};"), locked(tmp_path / "s.db"):
        pass
    assert holder(tmp_path / "s.db") == other.pid


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_a_dead_process_blocks_nobody(tmp_path, other, number):
    os.kill(other.pid, number)
    other.wait()
    assert holder(tmp_path / "s.db") is None
    with locked(tmp_path / "s.db"):
        assert holder(tmp_path / "s.db") == os.getpid()


def test_nothing_is_left_behind(tmp_path):
    with locked(tmp_path / "s.db"):
        assert [path.name for path in tmp_path.iterdir()] == ["s.db-lock"]
    assert list(tmp_path.iterdir()) == []
    assert holder(tmp_path / "s.db") is None


def test_it_is_freed_by_an_error_inside(tmp_path):
    with pytest.raises(RuntimeError), locked(tmp_path / "s.db"):
        raise RuntimeError
    with locked(tmp_path / "s.db"):
        pass


@pytest.mark.parametrize(("number", "kind"), [(errno.ENOSPC, DiskError), (errno.EACCES, DatabaseError)])
def test_a_full_disk_is_no_fault_of_what_was_given(tmp_path, monkeypatch, number, kind):
    def refuse(*_):
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr("pareto_monoped.storage.lock._write", refuse)
    with pytest.raises(kind, match=os.strerror(number)), locked(tmp_path / "s.db"):
        pass
    assert list(tmp_path.iterdir()) == []


def test_two_studies_do_not_block_each_other(tmp_path, other):
    with locked(tmp_path / "t.db"):
        assert holder(tmp_path / "s.db") == other.pid


def test_messages_say_what_to_do_on_the_command_line_and_in_python(tmp_path, other):
    named = r"\(--db, in Python db=\.\.\.\)$"
    with pytest.raises(DatabaseError, match=f"give another database file {named}"), locked(tmp_path / "s.db"):
        pass
    with pytest.raises(OutputError, match=f"give a database file in a writable folder {named}"):  # noqa: SIM117
        with locked(tmp_path / "nowhere" / "s.db"):
            pass
