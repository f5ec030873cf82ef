"""Killed while SQLite changes the journal mode, at the start of a run and at its end, a study heals by being read.

A small library, preloaded before libc, ends the process at the n-th removal of a file that ends with ``-journal``: the
journal is then complete on the disk, and SQLite must roll it back.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.errors import DatabaseError
from pareto_monoped.storage.lock import locked
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.status import status
from pareto_monoped.storage.store import Store
from pareto_monoped.study.run import run
from tests.study.support import copied_database, made_database, made_evaluations, made_generation, made_study

ROOT = Path(__file__).parents[2]
KILLER = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
int unlink(const char *path) {
    static int seen = 0;
    size_t n = strlen(path);
    if (n > 8 && !strcmp(path + n - 8, "-journal") && ++seen == atoi(getenv("KILL_AT"))) kill(getpid(), SIGKILL);
    return ((int (*)(const char *)) dlsym(RTLD_NEXT, "unlink"))(path);
}
"""
SESSION = """
import sys
from pathlib import Path
from tests.study.support import *
study = made_study()
with Store(Path(sys.argv[1]), study) as store:
    store.add(made_generation(study, 2, 6, made_evaluations([0.75], [8.5]), state={"after": 2}))
    print("added", flush=True)
"""

CLOSING = """
import os, signal, sys
from pathlib import Path
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.store import Store
path = Path(sys.argv[1])
Store(path, read_study(path).study).set_meta({"finished": True})
os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.fixture(scope="module")
def killer(tmp_path_factory):
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("needs a C compiler")
    folder = tmp_path_factory.mktemp("killer")
    (folder / "killer.c").write_text(KILLER)
    subprocess.run([compiler, "-shared", "-fPIC", "-o", "killer.so", "killer.c", "-ldl"], cwd=folder, check=True)
    return folder / "killer.so"


def killed_at(number, path, killer):
    """Run one session; the code it ended with, and whether it said that its generation is stored."""
    environment = os.environ | {"LD_PRELOAD": str(killer), "KILL_AT": str(number)}
    done = subprocess.run(
        [sys.executable, "-c", SESSION, str(path)], env=environment, cwd=ROOT, stdout=subprocess.PIPE, text=True
    )
    return done.returncode, "added" in done.stdout


@pytest.fixture(scope="module")
def sessions(tmp_path_factory, killer):
    """Sessions killed at each removal of a journal, and one that no kill came to: code, what it said, its files."""
    found = []
    for number in range(1, 9):
        path = tmp_path_factory.mktemp("killed") / "s.db"
        copied_database(path)
        found.append((*killed_at(number, path, killer), path.parent))
        if found[-1][0] == 0:
            break
    return found


@pytest.fixture
def hot(sessions, tmp_path):
    """A study whose last session was killed as it left the mode with a write-ahead log."""
    code, added, folder = sessions[1]
    assert (code, added) == (-9, True)
    shutil.copytree(folder, tmp_path, dirs_exist_ok=True)
    assert (tmp_path / "s.db-journal").stat().st_size > 0
    return tmp_path / "s.db"


def test_killed_at_every_removal_of_a_journal(sessions, tmp_path):
    seen, path = [], tmp_path / "s.db"
    *killed, last = sessions
    for code, added, folder in killed:
        shutil.copytree(folder, tmp_path, dirs_exist_ok=True)
        assert code == -9
        seen.append((added, Path(f"{path}-journal").exists()))
        assert status(path)["evaluations"] == (7 if added else 6)
        assert len(read_study(path).trials) == (7 if added else 6)
        assert "-journal" not in "".join(file.name for file in tmp_path.iterdir())
        study = made_study()
        with Store(path, study) as store:
            first = len(read_study(path).trials)
            store.add(made_generation(study, first - 4, first, made_evaluations([0.75], [8.5]), state={}))
        assert [file.name for file in tmp_path.iterdir()] == [path.name]
        path.unlink()
    # Both moments: before a generation was stored, on the way into the log, and after it, on the way out.
    assert last[0] == 0
    assert (False, True) in seen
    assert (True, True) in seen


def test_the_process_that_holds_the_lock_heals_too(hot, tmp_path):
    with locked(hot):
        assert len(read_study(hot).trials) == 7
    assert not (tmp_path / "s.db-journal").exists()


def test_where_nothing_can_be_written_the_journal_is_named(hot, monkeypatch):
    monkeypatch.setattr("pareto_monoped.storage.file._folder_writable", lambda path: False)
    with pytest.raises(DatabaseError, match=r"'s.db-journal' beside it, which must be rolled back; allow writing"):
        read_study(hot)
    monkeypatch.undo()
    assert len(read_study(hot).trials) == 7


def test_what_a_killed_creation_left_is_deleted(tmp_path):
    """Its journal, too: SQLite would roll it back into the next file of that name."""
    copied_database(tmp_path / "other.db")
    shutil.copy(tmp_path / "other.db", tmp_path / ".s.db-new")
    (tmp_path / ".s.db-new-journal").write_bytes(b"\xd9\xd5\x05\xf9\x20\xa1\x63\xd7" + bytes(504))
    made_database(tmp_path / "s.db")
    assert len(read_study(tmp_path / "s.db").trials) == 6
    assert sorted(path.name for path in tmp_path.iterdir()) == ["other.db", "s.db"]


def test_a_finished_study_that_was_killed_while_closing_becomes_a_single_file(tmp_path):
    """Nothing is left to run, but the log is still merged."""
    settings = {"name": "c", "evaluations": 8, "audit": False, "algorithm": {"name": "random", "population": 8}}
    study, path = study_from_dict(settings, source="test"), tmp_path / "s.db"
    run(study, path, workers=1)
    assert subprocess.run([sys.executable, "-c", CLOSING, str(path)], cwd=ROOT).returncode == -9
    assert Path(f"{path}-wal").exists()
    assert run(study, path, workers=1).new_evaluations == 0
    assert [file.name for file in tmp_path.iterdir()] == ["s.db"]
