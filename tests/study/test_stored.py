"""Studies that version 0.1.0 stored open, read the same and go on as they would have; see data/README.md."""

import json
import shutil
from dataclasses import asdict, replace
from importlib.metadata import version
from pathlib import Path

import pytest

from pareto_monoped.design import DEFAULTS
from pareto_monoped.pareto.pick import Knee, MaxEnergy, MinHeight, pick
from pareto_monoped.study import provenance
from pareto_monoped.study.columns import LATER
from pareto_monoped.study.definition import load_study
from pareto_monoped.study.reader import read_study
from pareto_monoped.study.run import resume, run
from pareto_monoped.study.simulator import continued_simulator, stored_simulator
from pareto_monoped.study.status import status

DATA = Path(__file__).parent / "data"
NAMES = ("plain", "own_files")

named = pytest.mark.parametrize("name", NAMES)


def expected(name):
    return json.loads((DATA / f"{name}.json").read_text())


@pytest.fixture
def stored(name, tmp_path, monkeypatch):
    """A copy of a stored study, to be gone on with as if this were the version that began it."""
    path = tmp_path / f"{name}.db"
    shutil.copy(DATA / path.name, path)
    data = read_study(path)
    versions = dict(data.meta.versions)
    monkeypatch.setattr(provenance, "__version__", versions.pop("pareto-monoped"))
    if other := {package: version(package) for package, v in versions.items() if version(package) != v}:
        pytest.skip(f"a study goes on only with the libraries that began it: here are {other}")
    probe = stored_simulator(data, workers=1).probe()
    if probe != data.meta.probe:
        assert probe == [pytest.approx(pair, rel=1e-6) for pair in data.meta.probe]
        pytest.skip("a study goes on only where it began: this machine computes other last digits")
    # MuJoCo writes its log into the current folder.
    monkeypatch.chdir(tmp_path)
    return path


def motor_file(path, motor):
    """Write every value of a motor as a user's file."""

    def toml(value):
        if isinstance(value, dict):
            return "{ " + ", ".join(f"{key} = {toml(one)}" for key, one in value.items() if one is not None) + " }"
        return json.dumps(value)

    path.write_text("".join(f"{key} = {toml(one)}\n" for key, one in asdict(motor).items() if one is not None))
    return str(path)


@named
def test_status_reads_the_same(name):
    facts = status(DATA / f"{name}.db")
    del facts["database"]
    assert json.loads(json.dumps(facts)) == expected(name)["status"]


@named
def test_the_front_reads_the_same(name):
    data = read_study(DATA / f"{name}.db")
    front, wanted = data.front(), expected(name)["front"]
    # What came later: optional variables at their defaults, measures without a value.
    later = front.drop(columns=wanted["columns"])
    assert tuple(later.columns) == tuple(column.name for column in LATER if column.name not in wanted["columns"])
    assert all((later[column] == DEFAULTS[column]).all() for column in later if column in DEFAULTS)
    assert all(later[column].isna().all() for column in later if column not in DEFAULTS)
    front = front.drop(columns=later.columns)
    assert front.columns.tolist() == wanted["columns"]
    assert [str(dtype) for dtype in front.dtypes] == wanted["dtypes"]
    rows = [[None if value != value else value for value in row] for row in front.astype(object).to_numpy().tolist()]
    assert rows == wanted["rows"]
    everything = data.front(include_ill_conditioned=True)["trial"].tolist()
    assert everything == expected(name)["front_with_ill_conditioned"]


@named
def test_picks_are_the_same(name):
    front = read_study(DATA / f"{name}.db").front()
    selectors = {"knee": Knee(), "0.8 m": MinHeight(height_m=0.8), "40 J": MaxEnergy(energy_j=40.0)}
    assert {key: pick(front, selector).why for key, selector in selectors.items()} == expected(name)["picks"]


@named
def test_the_hash_is_what_this_code_computes(name):
    """From the study file with the unchanged user's files, and again from what the database holds."""
    data = read_study(DATA / f"{name}.db")
    study = load_study(DATA / f"{name}.toml")
    for simulator in (continued_simulator(data, study, workers=1), stored_simulator(data, workers=1)):
        decisive = provenance.decisive(study, simulator.contents, data.meta.versions)
        assert provenance.digest(decisive) == data.meta.hash


@named
def test_resumed_it_ends_like_an_uninterrupted_run(name, stored, tmp_path):
    budget = {"plain": 110, "own_files": 50}[name]
    before = read_study(stored)
    # Of the motor's file or name, this version would estimate another rotor.
    motor = motor_file(tmp_path / "motor.toml", before.motor)
    run(replace(load_study(DATA / f"{name}.toml"), motor=motor), tmp_path / "whole.db", evaluations=budget)
    whole = read_study(tmp_path / "whole.db")
    assert resume(stored, evaluations=budget).new_evaluations == budget - len(before.trials)
    resumed = read_study(stored)
    # Trials of version 0.1.0 lack the measures that came later; those made now have all.
    old = expected(name)["front"]["columns"]
    assert resumed.trials[old].equals(whole.trials[old])
    assert resumed.trials[len(before.trials) :].equals(whole.trials[len(before.trials) :])
    assert resumed.trials[: len(before.trials)].equals(before.trials)
    assert resumed.checkpoint == whole.checkpoint
    assert resumed.meta.hash == whole.meta.hash == before.meta.hash
    assert resumed.front()[old].equals(whole.front()[old])
    # The audits of the earlier end stay as they were.
    audits = resumed.audits.set_index("trial")
    assert audits.loc[before.audits["trial"]].equals(before.audits.set_index("trial"))


@named
def test_run_with_its_study_file_goes_on_too(name, stored):
    done = len(read_study(stored).trials)
    assert run(load_study(DATA / f"{name}.toml"), stored, evaluations=done + 4).new_evaluations == 4
