"""Thin doors to what commands compute: the same numbers as the command line prints."""

import json
from concurrent.futures import ThreadPoolExecutor

import pandas as pd
import pytest

import pareto_monoped as pm
from pareto_monoped.cli import _run as cli
from pareto_monoped.errors import DatabaseError, InputError, SelectionError
from pareto_monoped.storage.extra_rows import read_limits


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    path = tmp_path_factory.mktemp("r") / "s.db"
    return pm.run(pm.Study.define(name="s", evaluations=120, seed=3, audit=False), path)


def printed(capsys, *words):
    assert cli([*map(str, words), "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_status_and_hypervolume_are_those_of_the_command(stored, capsys):
    said = printed(capsys, "status", stored.path)
    assert pm.status(stored) == pm.status(stored.path) == said
    assert stored.hypervolume == pytest.approx(said["hypervolume"], rel=1e-12)


def test_verify_finds_what_the_command_finds(stored, capsys):
    found = pm.verify(stored, simulate=1)
    assert cli(["verify", str(stored.path)]) == 0
    assert found.content_hash in capsys.readouterr().out
    assert pm.verify(stored, expect=found.content_hash[:16]).trials == 120
    with pytest.raises(DatabaseError):
        pm.verify(stored, expect="0" * 16)
    with pytest.raises(InputError, match="expect = 'no': must be 16 to 64"):
        pm.verify(stored, expect="no")


@pytest.mark.usefixtures("few_samples")
def test_robust_takes_an_executor_and_a_robust_pick_is_that_of_the_command(stored, capsys):
    with pytest.raises(SelectionError, match="holds no robustness"):
        stored.pick("knee", robust=True)
    trials = stored.front()["trial"].tolist()[:2]
    with ThreadPoolExecutor(1) as executor:
        by_executor = pm.robust(stored, trials[:1], executor=executor)
    together = pm.robust(stored, trials)
    pd.testing.assert_frame_equal(by_executor, together[:1], check_exact=True)
    said = printed(capsys, "pick", stored.path, "--knee", "--robust")
    picked = stored.pick("knee", robust=True)
    assert (picked.trial, picked.why) == (said["trial"], said["why"])
    assert picked.row["height_m"] == said["height_m"] < stored.trials.height_m[picked.trial]


@pytest.mark.long
def test_sensitivity_is_that_of_the_command(stored, capsys):
    knee = stored.pick("knee")
    found = pm.sensitivity(stored, knee, samples=32)
    said = printed(capsys, "sensitivity", stored.path, "--trial", knee.trial, "--samples", 32)
    for about in ("variables", "assumptions"):
        rows = found[found["about"] == about]
        assert rows["name"].tolist() == [one["factor"]["name"] for one in said[about]["factors"]]
        shares = [one["measures"]["height_m"]["total"] for one in said[about]["factors"]]
        assert rows["height_m.total"].tolist() == shares


@pytest.mark.usefixtures("few_samples")
def test_limit_searches_with_the_seed_that_is_asked_for(stored):
    knee = stored.pick("knee")
    pm.limit(stored, knee, jumps=4, seed=2)
    assert read_limits(stored.path)[knee.trial].settings["seed"] == 2
    with pytest.raises(InputError, match="seed = -1"):
        pm.limit(stored, knee, jumps=4, seed=-1)


def test_table_1_is_that_of_the_command(capsys):
    rows = pm.table1()
    for (_, row), said in zip(rows.iterrows(), printed(capsys, "table1"), strict=True):
        assert row["case"] == said["case"]
        for key in ("published.height_m", "paper.energy_p95_j", "reference.energy_j"):
            whose, name = key.split(".")
            assert row[key] == said[whose][name]


@pytest.mark.long
def test_a_campaign_is_that_of_the_command(tmp_path, capsys):
    file = tmp_path / "grid.toml"
    file.write_text(
        'name = "grid"\n[study]\nevaluations = 20\nalgorithm = "random"\naudit = false\n[axes]\nseeds = [1]\n'
    )
    waiting = pm.run_campaign(file, status=True)
    assert waiting["evaluations"].tolist() == [0]
    done = pm.run_campaign(file, csv=tmp_path / "grid.csv", report=tmp_path / "grid.html")
    assert done["state"].tolist() == ["finished"]
    assert (tmp_path / "grid.html").is_file()
    assert pd.read_csv(tmp_path / "grid.csv")["study"].tolist() == done["study"].tolist()
    assert printed(capsys, "campaign", file, "--status")["studies"][0]["hypervolume"] == done["hypervolume"][0]
