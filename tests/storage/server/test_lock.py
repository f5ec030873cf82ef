"""One writer at a time: a second is refused, and a killed one blocks nobody."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from pareto_monoped.definition.study import load_study
from pareto_monoped.errors import DatabaseError
from pareto_monoped.storage.lock import holder, locked
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.server import lock as server_lock
from pareto_monoped.storage.store import Store
from pareto_monoped.study.run import resume, run
from tests.study.same import assert_same_study
from tests.study.support import made_database

ROOT = Path(__file__).parents[3]
TOML = 'name = "s"\nevaluations = {n}\naudit = false\nstrength = false\n[algorithm]\nname = "nsga2"\npopulation = 20\n'


@pytest.fixture
def impatient(monkeypatch):
    """Nobody is being killed: whoever holds a lock keeps it."""
    monkeypatch.setattr(server_lock, "_WAIT_S", 0.1)


def test_a_second_run_is_refused_and_told_who_runs(cluster, place, impatient):
    made_database(place)
    assert holder(place) is None
    with locked(place):
        assert holder(place) == os.getpid()
        words = rf"is being run by process {os.getpid()} on .*another schema"
        with pytest.raises(DatabaseError, match=words), locked(place):
            pass
        with locked(place.of_schema("another")):  # other studies of the server go their own way
            pass
    assert holder(place) is None
    with locked(place):
        pass


def test_a_run_whose_lock_is_lost_still_keeps_others_from_writing(cluster, place, impatient):
    """The session that writes has a lock of its own."""
    study, _ = made_database(place)
    with Store(place, study), pytest.raises(DatabaseError, match="is being run by process"):
        Store(place, study)
    with Store(place, study):
        pass


def test_killed_in_mid_run_and_resumed(cluster, tmp_path, place, address):
    """Killed by SIGKILL after acknowledged generations, three times, a study ends where it would have without."""
    (tmp_path / "s.toml").write_text(TOML.format(n=400))
    command = [sys.executable, "-m", "pareto_monoped", "run", str(tmp_path / "s.toml"), "--db", address, "--json"]
    for kill in range(2):
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT) as process:
            for _ in range(2 + kill):
                line = process.stdout.readline()
            assert '"generation"' in line, process.stderr.read()
            process.kill()
        # The next comes at once: the server may not have noticed yet.
        stored = len(read_study(place).trials)
        assert 40 <= stored < 400
    resume(place)
    run(load_study(tmp_path / "s.toml"), tmp_path / "s.db")
    assert_same_study(tmp_path / "s.db", place)
