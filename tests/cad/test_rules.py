"""Exports of robots whose gears are rated: safety factors and stand-ins in the record, the parts list and README."""

import csv
import dataclasses
import json

import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad import batch
from pareto_monoped.cad.jobs import case_job
from pareto_monoped.cad.records import is_made, record_job
from pareto_monoped.errors import InputError

KNEE_RATIO = 6.15
"""An interval in which the VT8020 has no gearbox."""


@pytest.fixture(scope="module")
def rated(unchecked_module, tmp_path_factory):
    """Case A with a knee whose gearbox has another ratio."""
    job = case_job("A", rules="iso6336", folder=tmp_path_factory.mktemp("rated") / "robot", formats=("dxf",))
    job = dataclasses.replace(job, design=job.design.replace({"knee_ratio": KNEE_RATIO}))
    batch.run(job)
    return job


def record(job):
    return json.loads((job.folder / "design.json").read_text())


def test_the_record_has_rules_ratings_and_the_stand_in(rated):
    found, written = map_for("VT8020", "iso6336"), record(rated)
    assert written["rules"] == "iso6336"
    hip, knee = written["actuators"]["hip"], written["actuators"]["knee"]
    assert knee["rating"] == found.lookup(KNEE_RATIO).rating.as_dict()
    assert knee["stand_in"] == found.stand_in(KNEE_RATIO)
    assert "stand_in" not in hip
    assert hip["rating"]["sun_mesh"]["pinion"]["flank_safety"] >= 1.1
    assert knee["stand_in"] in (rated.folder / "README.md").read_text()


def test_the_parts_list_names_grade_and_safety_of_each_gear(rated):
    with (rated.folder / "bom.csv").open(newline="") as stream:
        notes = [row["note"] for row in csv.DictReader(stream) if row["material"] == "gear steel"]
    assert len(notes) == 6
    assert all(("S_H " in note and "S_F " in note and "hardened" in note) or "nitrided" in note for note in notes)


def test_it_is_made_again_from_its_record(rated, tmp_path):
    job = record_job(rated.folder / "design.json", folder=tmp_path / "again")
    assert job.rules == "iso6336"
    assert is_made(dataclasses.replace(job, folder=rated.folder))
    assert not is_made(dataclasses.replace(job, folder=rated.folder, rules="paper"))


def test_a_record_without_rules_is_the_papers(rated, tmp_path):
    values = record(rated) | {"made_by": "pareto-monoped 0.2.0"}
    del values["rules"], values["design_hash"]
    path = tmp_path / "design.json"
    path.write_text(json.dumps(values))
    assert record_job(path, folder=tmp_path).rules == "paper"
    path.write_text(json.dumps(values | {"rules": "agma"}))
    with pytest.raises(InputError, match="rules 'agma' are none of paper, iso6336"):
        record_job(path, folder=tmp_path)
