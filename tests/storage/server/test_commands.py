"""Every command that reads or continues a study takes the address of one on a server, and so does Python."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

import pareto_monoped as pm
from pareto_monoped.cli import _run as cli
from pareto_monoped.storage.place import place_of

pytest.importorskip("psycopg", reason="the extra postgres is not installed")

ROOT = Path(__file__).parents[3]
TOML = """
name = "s"
evaluations = 20
audit = false
strength = false
[algorithm]
name = "nsga2"
population = 10
"""


def test_commands(cluster, tmp_path, address, capsys):
    """One study goes through all commands; a process with a password in its address never shows it."""
    cluster.sql("DROP ROLE IF EXISTS keeper", "CREATE ROLE keeper LOGIN SUPERUSER PASSWORD 'S3cret'")
    address = address.replace("//owner@", "//keeper:S3cret@")
    shown = str(place_of(address))
    (tmp_path / "s.toml").write_text(TOML)

    def done(*words):
        code, told = cli([str(word) for word in words]), capsys.readouterr()
        assert code == 0, told.err
        assert "S3cret" not in told.out + told.err
        return told.out + told.err

    assert f"{shown}: 20 evaluations (20 new" in done("run", tmp_path / "s.toml", "--db", address)
    assert f"{shown}: 30 evaluations (10 new" in done("resume", address, "--evaluations", 30)
    status = json.loads(done("status", address, "--json").partition("\nnote")[0])
    assert (status["database"], status["evaluations"], status["state"]) == (shown, 30, "finished")
    assert len(done("front", address).splitlines()) > 3
    trial = done("pick", address, "--knee", "--json").partition('"trial": ')[2].partition(",")[0]
    done("trials", address, "--csv", tmp_path / "t.csv")
    assert len((tmp_path / "t.csv").read_text().splitlines()) == 31
    assert "sound, 30 trials" in done("verify", address, "--simulate", 3)
    done("robust", address, "--trial", trial, "--samples", 256)
    done("sensitivity", address, "--trial", trial, "--samples", 32)
    done("report", address, "-o", tmp_path / "r.html")
    page = (tmp_path / "r.html").read_text()
    assert shown.replace("&", "\\u0026") in page or shown in page
    assert "S3cret" not in page
    assert "dropped 0 trials" in done("repair", address)


@pytest.mark.long
def test_an_export_of_a_trial(tmp_path, address):
    (tmp_path / "s.toml").write_text(TOML)
    pm.run(tmp_path / "s.toml", address)
    stored = pm.load_study(address)
    trial = int(stored.front().trial.iloc[0])
    assert cli(["export", address, "--trial", str(trial), "-o", str(tmp_path / "out"), "--formats", "mjcf"]) == 0
    assert json.loads((tmp_path / "out" / "design.json").read_text())["made_by"].startswith("pareto-monoped")


def test_python(tmp_path, address, place):
    study = pm.Study.from_toml(_file(tmp_path))
    stored = pm.run(study, address)
    assert str(stored.path) == str(place)
    assert len(pm.resume(address, evaluations=30).trials) == 30
    assert len(pm.resume(stored.path, evaluations=40).trials) == 40
    assert pm.load_study(address).front().equals(pm.load_study(stored.path).front())


def _file(folder):
    (folder / "s.toml").write_text(TOML)
    return folder / "s.toml"


def test_pareto_wants_a_file(tmp_path, address, capsys):
    assert cli(["pareto", str(_file(tmp_path)), "--db", address.replace("//owner@", "//owner:S3cret@")]) == 2
    told = capsys.readouterr()
    assert "is on a server, which this command does not take; give the name of a file" in told.err
    assert "S3cret" not in told.out + told.err


def test_a_server_that_is_away_is_one_line():
    words = ["status", "postgresql://ann:S3cret@127.0.0.1:1/team?schema=s"]
    line = [sys.executable, "-m", "pareto_monoped", *words]
    done = subprocess.run(line, capture_output=True, text=True, check=False, cwd=ROOT)
    assert done.returncode == 1
    assert done.stderr.startswith("error: study database 'postgresql://ann@127.0.0.1:1/team?schema=s': ")
    assert len(done.stderr.splitlines()) == 1
    assert "S3cret" not in done.stderr
