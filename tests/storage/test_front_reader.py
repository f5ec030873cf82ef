"""What is read without all trials: the kept front, the status."""

import shutil
import sqlite3
import subprocess
import sys
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from pareto_monoped.analysis.at_bounds import front_alone
from pareto_monoped.analysis.choices import dear_words, whole
from pareto_monoped.analysis.verify import verify
from pareto_monoped.design import in_use
from pareto_monoped.errors import DatabaseError
from pareto_monoped.storage import file as file_module
from pareto_monoped.storage.file import FileConnection
from pareto_monoped.storage.front_reader import read_front
from pareto_monoped.storage.kept_front import kept_row
from pareto_monoped.storage.place import storage_of
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.status import status
from pareto_monoped.storage.store import Store
from tests.study.support import (
    UNSEALED,
    change,
    copied_database,
    made_database,
    made_evaluations,
    made_generation,
    made_study,
)

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def large_once(tmp_path_factory):
    """600 trials with an optional variable free, some front designs ill-conditioned, then 300 more."""
    path, study, generator = (
        tmp_path_factory.mktemp("large") / "s.db",
        made_study(variables={"knee_release_rad": {"lower": 0.0, "upper": 0.6}}),
        np.random.default_rng(4),
    )
    made_database(path, [], study)
    with Store(path, study) as store:
        for number in range(9):
            drawn = made_evaluations(generator.uniform(0.5, 1.0, 100), generator.uniform(1.0, 9.0, 100), seed=number)
            store.add(made_generation(study, number, 100 * number, drawn, state={}))
            if number == 5:
                store.set_audits([(int(t), k % 2 == 0, {}) for k, t in enumerate(read_study(path).front()["trial"])])
    return path


@pytest.fixture
def large(large_once, tmp_path):
    """A copy of it."""
    return Path(shutil.copy(large_once, tmp_path))


@pytest.mark.parametrize("statements", [(), UNSEALED], ids=["kept", "format 1"])
def test_the_kept_front_reads_as_the_front_of_all_trials(large, statements):
    change(large, *statements)
    data, kept = read_study(large), read_front(large)
    assert len(data.ill_conditioned) >= 2
    assert kept.rows.equals(data.front())
    assert kept.used == in_use(data.trials)
    assert (kept.study, kept.meta, kept.sealed) == (data.study, data.meta, not statements)
    facts = status(large)
    assert (facts["front"], facts["ill_conditioned"]) == (len(data.front()), len(data.ill_conditioned))
    counted = [facts[state] for state in ("feasible", "infeasible", "failed")]
    assert counted == [(data.trials["state"] == state).sum() for state in ("feasible", "infeasible", "failed")]
    assert facts["wall_time_s"] == data.wall_time_s


def test_a_pick_is_dear_by_the_least_of_all_feasible_trials_but_those_that_failed_their_audit(large):
    data = read_study(large)
    data = replace(data, trials=data.trials.assign(electrical_energy_j=data.trials["energy_j"]))
    ill = data.audits.loc[~data.audits["well_conditioned"].astype(bool), "trial"]
    told = 0
    for height_m in (0.0, *np.linspace(0.5, 1.0, 41), *data.front()["height_m"], 2.0):
        high = data.trials[(data.trials["state"] == "feasible") & (data.trials["height_m"] >= height_m)]
        expected = high.loc[~high["trial"].isin(ill), "energy_j"].min()
        row = pd.Series({"height_m": height_m, "electrical_energy_j": 1e4})
        assert f"stored for this height, {expected:.2f} J" in dear_words(data, row) or np.isnan(expected)
        cheap = pd.Series({"height_m": height_m, "electrical_energy_j": 1.49 * expected})
        assert dear_words(data, cheap) == ""
        told += high["energy_j"].min() < expected
    assert told


def test_a_damaged_trial_does_not_hide_the_least_from_pick(large, monkeypatch):
    """A flipped byte off the front made `pick` say nothing of a design that is dear at the battery."""
    kept = read_front(large)
    alone = front_alone(kept)
    other = read_study(large).sound["trial"]
    rest = other[~other.isin(kept.rows["trial"])]
    assert len(whole(alone, kept).trials) == kept.count > len(alone.trials)
    change(large, f"UPDATE monoped_trials SET energy_j = 1e6 WHERE trial = {rest.iloc[0]}")
    with pytest.raises(DatabaseError, match="does not match its hash"):
        whole(alone, kept)
    monkeypatch.setattr("pareto_monoped.analysis.choices._WHOLE", 10)
    assert whole(alone, kept) is None
    assert dear_words(None, kept.rows.iloc[0]) == ""


def test_the_front_is_read_without_the_other_trials_and_the_checkpoint(large):
    """Damage elsewhere is not seen by what does not read it; on the front it is."""
    front = read_front(large).rows["trial"]
    others = f"trial NOT IN ({', '.join(map(str, front))})"
    change(
        large, f"UPDATE monoped_trials SET hip_ratio = 'x' WHERE {others}", "UPDATE monoped_checkpoint SET state = '{'"
    )
    assert read_front(large).rows["trial"].equals(front)
    assert status(large)["front"] == len(front)
    change(large, f"UPDATE monoped_trials SET mass_kg = mass_kg + 1e-12 WHERE trial = {front[1]}")
    for reader in (read_front, status):
        with pytest.raises(DatabaseError, match=f"trial {front[1]} does not match its hash"):
            reader(large)
    change(large, f"DELETE FROM monoped_trials WHERE trial = {front[1]}")
    for reader in (read_front, status):
        with pytest.raises(DatabaseError, match=f"where trial {front[1]} must be"):
            reader(large)


@pytest.mark.parametrize(
    ("statement", "words"),
    [
        ("UPDATE monoped_front SET trials = '[1,2]'", "row 1 of its front"),
        ("UPDATE monoped_front SET used = '[]'", "row 1 of its front"),
        ("DELETE FROM monoped_front", "row 1 of its front is missing"),
        ("UPDATE monoped_meta SET value = json_set(value, '$.seed', 9) WHERE key = 'study'", "row study of its meta"),
        ("UPDATE monoped_seals SET trials = '' WHERE link = 3", "link 3 of its running hash"),
    ],
)
def test_a_bent_kept_front_is_refused(large, statement, words):
    change(large, statement)
    for reader in (read_front, status):
        with pytest.raises(DatabaseError, match=words):
            reader(large)


@pytest.mark.parametrize(
    ("statement", "words"),
    [
        ("UPDATE monoped_history SET seconds = seconds + 1 WHERE generation = 8", "row 8 of its history"),
        ("DELETE FROM monoped_history WHERE generation > 6", "last rows of its history are missing"),
        ("UPDATE monoped_audits SET well_conditioned = 1", "of its audits does not match"),
        ("DELETE FROM monoped_audits WHERE well_conditioned = 0", "of its audits is missing"),
    ],
)
def test_status_checks_what_it_prints(large, statement, words):
    change(large, statement)
    with pytest.raises(DatabaseError, match=words):
        status(large)


@pytest.fixture(scope="module")
def long_once(tmp_path_factory):
    """A study as killed: 900 trials that are all on the front, some ill-conditioned, then 71 one by one."""
    path, study, generator = tmp_path_factory.mktemp("long") / "s.db", made_study(), np.random.default_rng(6)
    made_database(path, [], study)
    with Store(path, study) as store:
        for number, (first, count) in enumerate([(0, 900), *((900 + k, 1) for k in range(71))]):
            height_m = generator.uniform(0.5, 1.0, count)
            store.add(made_generation(study, number, first, made_evaluations(height_m, 10.0 * height_m), state={}))
            if number == 0:
                store.set_audits([(t, t % 7 > 0, {}) for t in range(0, 900, 5)])
    return path, study


@pytest.fixture
def long(long_once, tmp_path):
    """A copy of it."""
    path, study = long_once
    return Path(shutil.copy(path, tmp_path)), study


def assert_same_front(path):
    data, kept = read_study(path), read_front(path)
    assert kept.rows.equals(data.front())
    facts = status(path)
    assert (facts["front"], facts["feasible"]) == (len(data.front()), (data.trials["state"] == "feasible").sum())
    assert not [
        finding for finding in verify(path, simulate=0).findings if "kept front" in finding or "counts" in finding
    ]


def kept_trials(path):
    with storage_of(path).reading() as connection:
        return sum(kept_row(connection)[1].values())


def test_a_long_front_is_kept_with_some_generations_and_read_with_all(long):
    path, study = long
    total = len(read_study(path).trials)
    assert 900 < kept_trials(path) < total == 971  # neither with the first alone nor with every one
    assert_same_front(path)
    with Store(path, study) as store:
        store.add(made_generation(study, 72, 971, made_evaluations([0.4999], [9.0]), state={}))
        assert kept_trials(path) < 972
        assert_same_front(path)
        store.set_meta({"finished": True})
    assert kept_trials(path) == 972  # a study at rest keeps all of it
    assert_same_front(path)


@pytest.mark.parametrize("what", ["energy_j = energy_j + 1e-12", "state = 'infeasible'"])
def test_a_bent_trial_after_the_kept_front_is_refused(long, what):
    path, _ = long
    change(path, f"UPDATE monoped_trials SET {what} WHERE trial = 970")
    with pytest.raises(DatabaseError, match="trial 970 does not match its hash"):
        read_front(path)


def alone(code, path):
    """What ``code`` prints in a process of its own, where ``path`` is the database."""
    code = f"import re, sys\nfrom pathlib import Path\npath = Path(sys.argv[1])\n{code}"
    return subprocess.run(
        [sys.executable, "-c", code, str(path)], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout


STATUS = "from pareto_monoped.storage.status import status\nstatus(path)\n"
FRONT = "from pareto_monoped.storage.front_reader import read_front\nread_front(path)\n"
PEAK_KB = r"print(re.search(r'VmHWM:\s+(\d+)', Path('/proc/self/status').read_text())[1])"
OTHERS = (
    "mujoco", "numba", "scipy", "optuna", "sqlalchemy", "psycopg", "pymoo", "matplotlib",
    "pareto_monoped.jump.evaluate",
)  # fmt: skip


def test_they_import_no_simulator_and_nothing_of_a_server(tmp_path):
    """Imports are most of what both commands take."""
    copied_database(tmp_path / "s.db")
    code = [STATUS, f"print([m for m in {(*OTHERS, 'pandas', 'moocore')} if m in sys.modules])\n"]
    code += [FRONT, f"print([m for m in {OTHERS} if m in sys.modules])\n"]
    assert alone("".join(code), tmp_path / "s.db") == "[]\n[]\n"


@pytest.mark.parametrize("code", [pytest.param(STATUS, marks=pytest.mark.long), STATUS + FRONT])
def test_a_large_checkpoint_costs_them_nothing(tmp_path, code):
    """They do not read it, so the peak of their memory is as with a small one."""
    peaks = []
    for name, megabytes in (("small.db", 0), ("large.db", 50)):
        copied_database(tmp_path / name)
        change(tmp_path / name, f"UPDATE monoped_checkpoint SET state = hex(zeroblob({megabytes} * 500000))")
        peaks.append(int(alone(f"{code}{PEAK_KB}", tmp_path / name)))
    assert (tmp_path / "large.db").stat().st_size > 50e6
    assert peaks[1] - peaks[0] < 10_000  # of the 49,000 kB that reading it would take at least


@pytest.mark.parametrize("count", [0, 1, 4, 5, 6, 9, 10, 13, 14])
@pytest.mark.parametrize(
    "statement",
    ["", "DELETE FROM t WHERE k = {0} - 2", "UPDATE t SET k = k + 1 WHERE k = {0} - 1", "INSERT INTO t VALUES (-1)"],
)
def test_numbers_are_compared_stretch_by_stretch_as_one_by_one(monkeypatch, count, statement):
    monkeypatch.setattr(file_module, "_STRETCH", 5)
    with closing(sqlite3.connect(":memory:", factory=FileConnection)) as connection:
        connection.execute("CREATE TABLE t (k INTEGER PRIMARY KEY)")
        connection.executemany("INSERT INTO t VALUES (?)", [(k,) for k in range(count)])
        connection.execute(statement.format(count))
        found = [k for (k,) in connection.execute("SELECT k FROM t ORDER BY k")]
        assert connection.counted("t", "k") == (len(found) if found == list(range(len(found))) else None)
