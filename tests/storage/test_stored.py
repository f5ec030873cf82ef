"""Studies that version 0.1.0 stored open and read the same; they go on only with that version. See data/README.md."""

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from pareto_monoped import __version__
from pareto_monoped.definition import provenance
from pareto_monoped.definition.study import load_study
from pareto_monoped.design import DEFAULTS
from pareto_monoped.errors import StudyError
from pareto_monoped.pareto.growth import left_to_gain
from pareto_monoped.pareto.pick import pick
from pareto_monoped.pareto.selectors import Knee, MaxEnergy, MinHeight
from pareto_monoped.storage.columns import LATER
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.status import status
from pareto_monoped.study.run import resume, run
from pareto_monoped.study.simulator import continued_simulator, stored_simulator
from tests.study.support import made_study

DATA = Path(__file__).parent / "data"
NAMES = ("plain", "own_files")

named = pytest.mark.parametrize("name", NAMES)


def expected(name):
    return json.loads((DATA / f"{name}.json").read_text())


@named
def test_status_reads_the_same(name):
    facts = status(DATA / f"{name}.db")
    del facts["database"]
    wanted = expected(name)["status"]
    del facts["content_hash"]  # which has a test of its own
    added = ("hypervolume_unit", "objectives", "best_at_0_8_m", "strength", "foreign", "sealed", "left_to_gain")
    later = {key: facts.pop(key) for key in added}
    assert json.loads(json.dumps(facts)) == wanted
    assert later == {
        "hypervolume_unit": "m J",
        "objectives": {"height_m": "maximise", "energy_j": "minimise"},
        "best_at_0_8_m": {"energy_j": wanted["least_energy_at_0_8_m_j"]},
        "strength": False,
        "foreign": 0,
        "sealed": False,
        "left_to_gain": later["left_to_gain"],  # whose test is below
    }


@pytest.mark.long
def test_what_is_left_to_gain_needs_no_more_than_the_history_around_its_middle(tmp_path):
    """Of two algorithms and at each length: what all of the history says, read row by row."""
    for algorithm, population in (("random", 7), ("nsga2", 10)):
        study = made_study(evaluations=10, audit=False, algorithm={"name": algorithm, "population": population})
        db = tmp_path / f"{algorithm}.db"
        run(study, db)
        for evaluations in (20, 33, 60):
            resume(db, evaluations=evaluations)
            history = read_study(db).history
            whole = left_to_gain(history["evaluations"], history["hypervolume"])
            assert status(db)["left_to_gain"] == whole
        assert whole > 0.0


@named
def test_the_front_reads_the_same(name):
    data = read_study(DATA / f"{name}.db")
    front, wanted = data.front(), expected(name)["front"]
    # What came later: optional variables at their defaults, the motor, measures without a value, and the agility, which
    # follows from measures that these studies have.
    later = front.drop(columns=wanted["columns"])
    known = {*wanted["columns"], "hip_motor", "knee_motor"}  # which stand only where a study names them
    assert tuple(later.columns) == tuple(column.name for column in LATER if column.name not in known)
    assert all((later[column] == DEFAULTS[column]).all() for column in later if column in DEFAULTS)
    assert set(later["motor"]) == {data.motors[0].name}
    derived = "agility_m_per_s"
    assert all(later[column].isna().all() for column in later if column not in (*DEFAULTS, "motor", derived))
    assert (later[derived] == (front["height_m"] - 0.5) / front["apex_s"]).all()
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
    # In its time, a file that names no rules meant those of the paper, and no study asked for strength or
    # searched a list of gearboxes.
    study = replace(load_study(DATA / f"{name}.toml", strength=False), rules="paper", gear_list=False)
    for simulator in (continued_simulator(data, study, workers=1), stored_simulator(data, workers=1)):
        decisive = provenance.decisive(study, simulator.contents, data.meta.versions)
        assert provenance.digest(decisive) == data.meta.hash


@named
def test_it_goes_on_only_with_the_version_that_began_it(name, tmp_path):
    """The machine has changed since: trials of two machines in one front would be wrong."""
    path = tmp_path / f"{name}.db"
    shutil.copy(DATA / path.name, path)
    stored = path.read_bytes()
    line = rf'began with other settings \(versions.pareto-monoped: "0.1.0" -> "{re.escape(__version__)}"\);.*start anew'
    with pytest.raises(StudyError, match=line):
        resume(path, evaluations=200)
    assert path.read_bytes() == stored
