"""``trials``: what other programs read is what the study stores."""

import csv
import io
import json

import pandas as pd
import pytest

from pareto_monoped import errors
from pareto_monoped.cli import _run as cli
from pareto_monoped.storage.reader import read_study
from tests.study.support import made_database


@pytest.fixture
def db(tmp_path):
    made_database(tmp_path / "s.db")
    return tmp_path / "s.db"


def test_the_table_on_stdout_has_every_trial_and_column(db, capsys):
    assert cli(["trials", str(db)]) == 0
    stored = read_study(db).trials
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert list(rows[0]) == list(stored.columns)
    assert [int(row["trial"]) for row in rows] == stored["trial"].tolist()
    heights = [float(row["height_m"]) if row["height_m"] else None for row in rows]
    assert heights == [value if value == value else None for value in stored["height_m"]]


def test_files_of_both_kinds_hold_the_same(db, tmp_path, capsys):
    pytest.importorskip("pyarrow", reason="pyarrow is not installed")
    files = ["--csv", str(tmp_path / "t.csv"), "--parquet", str(tmp_path / "t.parquet")]
    assert cli(["trials", str(db), *files]) == 0
    said = capsys.readouterr()
    assert said.out == ""
    stored = read_study(db).trials
    assert f"t.parquet ({len(stored)} trials)" in said.err
    read = pd.read_parquet(tmp_path / "t.parquet")
    assert list(read.columns) == list(stored.columns)
    for name in stored.select_dtypes("number"):
        pd.testing.assert_series_equal(read[name], stored[name], check_exact=True)
    by_text = pd.read_csv(tmp_path / "t.csv")
    pd.testing.assert_series_equal(by_text["height_m"], stored["height_m"], check_exact=True)


def test_only_trials_of_a_state(db, capsys):
    assert cli(["trials", str(db), "--state", "feasible"]) == 0
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert {row["state"] for row in rows} == {"feasible"}
    assert len(rows) == (read_study(db).trials["state"] == "feasible").sum()


def test_a_study_is_never_overwritten_and_a_table_only_by_a_table(db, tmp_path, capsys):
    before = db.read_bytes()
    (tmp_path / "notes.csv").write_text("my notes\n")
    for target in (db, tmp_path / "notes.csv"):
        assert cli(["trials", str(db), "--csv", str(target)]) == 2
    assert db.read_bytes() == before
    assert (tmp_path / "notes.csv").read_text() == "my notes\n"
    capsys.readouterr()


def test_parquet_without_its_library_says_what_to_install(db, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(errors, "find_spec", lambda name: None)
    assert cli(["trials", str(db), "--parquet", str(tmp_path / "t.parquet")]) == 2
    said = capsys.readouterr().err
    assert "pip install 'pareto-monoped[parquet]'" in said
    assert len(said.splitlines()) == 1
    assert not (tmp_path / "t.parquet").exists()


def test_a_run_tells_other_programs_how_far_it_is(tmp_path, capsys):
    (tmp_path / "s.toml").write_text('name = "s"\nevaluations = 60\n[algorithm]\nname = "random"\npopulation = 20\n')
    assert cli(["run", str(tmp_path / "s.toml"), "--json"]) == 0
    said = capsys.readouterr()
    *generations, end = [json.loads(line) for line in said.out.splitlines()]
    assert [one["evaluations"] for one in generations] == [20, 40, 60]
    assert {one["event"] for one in generations} == {"generation"}
    assert (end["event"], end["evaluations"], end["stop_reason"]) == ("end", 60, "budget")
    assert end["hypervolume"] == pytest.approx(generations[-1]["hypervolume"], rel=0.2)
    assert cli(["resume", str(tmp_path / "s.db"), "--evaluations", "80", "--json"]) == 0
    assert json.loads(capsys.readouterr().out.splitlines()[-1])["new_evaluations"] == 20
