"""Pages of a database file that are copied over others, exchanged, or left from earlier: SQLite notices none of it."""

import sqlite3
from contextlib import closing

import numpy as np
import pytest

from pareto_monoped.errors import DatabaseError
from pareto_monoped.storage import file as file_module
from pareto_monoped.storage.front_reader import read_front
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.status import status
from pareto_monoped.storage.store import Store
from tests.study.support import made_database, made_evaluations, made_generation, made_study

PAGE = 4096
READERS = (read_study, read_front, status)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A study of 60 trials, its file when it had 50, and the pages of its trials in order."""
    path, study, generator = tmp_path_factory.mktemp("pages") / "s.db", made_study(), np.random.default_rng(3)
    made_database(path, [], study)
    for number in range(6):
        earlier = path.read_bytes()
        with Store(path, study) as store:
            drawn = made_evaluations(generator.uniform(0.5, 1.0, 10), generator.uniform(1.0, 9.0, 10), seed=number)
            store.add(made_generation(study, number, 10 * number, drawn, state={}))
    with closing(sqlite3.connect(path)) as connection:
        sql = "SELECT pageno FROM dbstat WHERE name = 'monoped_trials' AND pagetype = 'leaf' ORDER BY path"
        pages = [page for (page,) in connection.execute(sql)]
    assert len(pages) > 5
    return path.read_bytes(), earlier, pages


@pytest.fixture(params=[10_000, 7], autouse=True)
def stretch(request, monkeypatch):
    """So many numbers are compared at once."""
    monkeypatch.setattr(file_module, "_STRETCH", request.param)


def pages_of(content):
    return [content[k : k + PAGE] for k in range(0, len(content), PAGE)]


@pytest.mark.parametrize(("source", "target"), [(1, 4), (4, 1), (0, -2), (-2, 0)])
def test_a_page_copied_over_another_is_found_by_every_reader(made, tmp_path, source, target):
    content, _, leaves = made
    pages = pages_of(content)
    pages[leaves[target] - 1] = pages[leaves[source] - 1]
    (tmp_path / "s.db").write_bytes(b"".join(pages))
    for reader in READERS:
        with pytest.raises(DatabaseError, match=r"stands in place|are missing"):
            reader(tmp_path / "s.db")


def test_exchanged_pages_are_found_by_every_reader(made, tmp_path):
    content, _, leaves = made
    pages, (one, other) = pages_of(content), (leaves[1] - 1, leaves[3] - 1)
    pages[one], pages[other] = pages[other], pages[one]
    (tmp_path / "s.db").write_bytes(b"".join(pages))
    for reader in READERS:
        with pytest.raises(DatabaseError, match="stands in place"):
            reader(tmp_path / "s.db")


def test_a_page_left_from_earlier_is_found_by_every_reader(made, tmp_path):
    """Each page that has changed with the last generation, in turn."""
    content, earlier, _ = made
    pages, before = pages_of(content), pages_of(earlier)
    changed = [k for k in range(len(before)) if pages[k] != before[k]]
    assert len(changed) > 5
    whole = (tmp_path / "s.db").write_bytes(content) and [read_study(tmp_path / "s.db"), status(tmp_path / "s.db")]
    for k in changed:
        (tmp_path / "s.db").write_bytes(b"".join([*pages[:k], before[k], *pages[k + 1 :]]))
        try:
            again = [read_study(tmp_path / "s.db"), status(tmp_path / "s.db")]
        except DatabaseError:
            continue
        # It was a page of Optuna's tables or of no table.
        assert again[0].trials.equals(whole[0].trials)
        assert again[1] == whole[1]


def test_rows_of_another_table_among_optunas_trials_are_not_told_as_foreign_trials(made, tmp_path):
    """``status`` counted the values of trials as trials of an Optuna user."""
    pages, path = pages_of(made[0]), tmp_path / "s.db"
    path.write_bytes(made[0])
    with closing(sqlite3.connect(path)) as connection:
        sql = "SELECT pageno, ncell FROM dbstat WHERE name = ? AND pagetype = 'leaf' ORDER BY ncell"
        trials, values = (connection.execute(sql, (name,)).fetchall() for name in ("trials", "trial_values"))
        (index,) = connection.execute("SELECT pageno FROM dbstat WHERE name = 'ix_trials_study_id'").fetchone()
    assert values[-1][1] > trials[0][1]
    whole = status(path)
    pages[trials[0][0] - 1] = pages[values[-1][0] - 1]
    path.write_bytes(b"".join(pages))
    assert status(path) == whole
    assert read_front(path).foreign == 0
    pages[index - 1] = pages[values[-1][0] - 1].replace(b"\r", b"\n", 1)  # the index has more rows, too
    path.write_bytes(b"".join(pages))
    for reader in (read_front, status):
        with pytest.raises(DatabaseError, match="rows among Optuna's trials are no trials"):
            reader(path)
