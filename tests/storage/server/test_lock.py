"""One writer at a time: a second is refused, and a killed one blocks nobody."""

import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from pareto_monoped.definition.study import load_study
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import resume, run
from tests.study.same import assert_same_study

ROOT = Path(__file__).parents[3]
TOML = 'name = "s"\nevaluations = {n}\naudit = false\nstrength = false\n[algorithm]\nname = "nsga2"\npopulation = 20\n'


@pytest.mark.long
def test_killed_in_mid_run_and_resumed(cluster, tmp_path, place, address):
    """Killed by SIGKILL after acknowledged generations, and resumed at once, a study ends where it would have."""
    (tmp_path / "s.toml").write_text(TOML.format(n=200))
    command = [sys.executable, "-m", "pareto_monoped", "run", str(tmp_path / "s.toml"), "--db", address, "--json"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT) as process:
        for _ in range(2):
            line = process.stdout.readline()
        assert '"generation"' in line, process.stderr.read()
        process.kill()
    # The next comes at once: the server may not have noticed yet.
    stored = len(read_study(place).trials)
    assert 40 <= stored < 200
    resume(place)
    run(load_study(tmp_path / "s.toml"), tmp_path / "s.db")
    assert_same_study(tmp_path / "s.db", place)


def test_a_lock_that_is_freed_within_moments_is_taken():
    """A server notices late that a run was killed: the first answers are no."""
    pytest.importorskip("psycopg", reason="the extra postgres is not installed")
    from pareto_monoped.storage.server import ServerStorage

    answers = [False, False, True]
    connection = SimpleNamespace(execute=lambda *_: SimpleNamespace(fetchone=lambda: [answers.pop(0)]))
    ServerStorage(SimpleNamespace(schema="s"))._take(connection, "run")
    assert answers == []
