import sqlite3

import numpy as np
import pytest

from pareto_monoped.design import in_use
from pareto_monoped.errors import DatabaseError
from pareto_monoped.study.reader import read_front, read_study
from pareto_monoped.study.status import status
from pareto_monoped.study.store import Store
from tests.study.support import UNSEALED, change, made_database, made_evaluations, made_generation, made_study


def test_the_front_is_sorted_and_holds_feasible_trials_only(tmp_path):
    made_database(tmp_path / "s.db")
    front = read_study(tmp_path / "s.db").front()
    assert front["trial"].tolist() == [4, 0, 3]
    assert front["height_m"].tolist() == [0.7, 0.8, 1.1]


def test_ill_conditioned_trials_leave_the_front_and_others_come_up(tmp_path):
    path = tmp_path / "s.db"
    study, _ = made_database(path)
    with Store(path, study) as store:
        store.set_audits([(0, True, {"spread_height_m": 1e-5}), (3, False, {"spread_height_m": float("inf")})])
    data = read_study(path)
    # Trial 5, 0.9 m on 40 J, was dominated by trial 3, 1.1 m on 30 J.
    assert data.front()["trial"].tolist() == [4, 0, 5]
    assert data.front(include_ill_conditioned=True)["trial"].tolist() == [4, 0, 3]
    assert data.audits["spread_height_m"].tolist() == [1e-5, float("inf")]


def test_history_and_meta(tmp_path):
    made_database(tmp_path / "s.db")
    data = read_study(tmp_path / "s.db")
    assert data.history["evaluations"].tolist() == [4, 6]
    assert data.history["hypervolume"].tolist() == [0.0, 1.0]
    assert data.wall_time_s == 1.5
    assert data.meta.finished is False
    assert data.reference_point.as_dict() == {"height_m": 0.55, "energy_j": 100.0}


def test_a_study_without_trials(tmp_path):
    made_database(tmp_path / "s.db", [])
    data = read_study(tmp_path / "s.db")
    assert len(data.trials) == len(data.history) == len(data.audits) == len(data.front()) == 0
    assert {"trial", "state", "hip_ratio", "height_m", "violation"} <= set(data.trials.columns)


@pytest.mark.parametrize(
    "statement",
    [
        "UPDATE monoped_meta SET value = '{' WHERE key = 'study'",
        "DELETE FROM monoped_meta WHERE key = 'study'",
        "UPDATE monoped_meta SET value = '[1]' WHERE key = 'study'",
        "DELETE FROM monoped_checkpoint",
        "UPDATE monoped_checkpoint SET state = 'x'",
        "UPDATE monoped_trials SET height_m = 'high'",
        "UPDATE monoped_trials SET energy_j = x'80049500'",
        "ALTER TABLE monoped_trials DROP COLUMN energy_j",
        "INSERT INTO monoped_audits VALUES (1, 1, 'x')",
        "UPDATE monoped_history SET seconds = 'long'",
    ],
)
def test_damaged_contents_are_said_to_be_damaged(tmp_path, statement):
    path = tmp_path / "s.db"
    made_database(path)
    connection = sqlite3.connect(path)
    connection.execute(statement)
    connection.commit()
    connection.close()
    with pytest.raises(DatabaseError, match="damaged"):
        read_study(path)


def test_settings_that_a_stranger_bent_are_refused_like_a_bad_file(tmp_path):
    path = tmp_path / "s.db"
    made_database(path)
    connection = sqlite3.connect(path)
    connection.execute("UPDATE monoped_meta SET value = json_set(value, '$.seed', -1) WHERE key = 'study'")
    connection.commit()
    connection.close()
    with pytest.raises(Exception, match="seed = -1") as caught:
        read_study(path)
    assert caught.value.exit_code == 2


@pytest.fixture
def large(tmp_path):
    """600 trials with an optional variable free, some front designs ill-conditioned, then 300 more."""
    path, study, generator = (
        tmp_path / "s.db",
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
    with pytest.raises(DatabaseError, match=f"trial {front[1]} does not match its hash"):
        read_front(large)
    change(large, f"DELETE FROM monoped_trials WHERE trial = {front[1]}")
    for reader in (read_front, status):
        with pytest.raises(DatabaseError, match="trials of its kept front are missing"):
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
    with pytest.raises(DatabaseError, match=words):
        read_front(large)
