"""Studies under either set of gearbox rules: which map they search with, and what is stored of it."""

import pytest

from pareto_monoped.actuator.motors import load_motor
from pareto_monoped.actuator.search import map_of
from pareto_monoped.definition import provenance
from pareto_monoped.definition.study import load_study
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.errors import StudyError
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import resume, run
from pareto_monoped.study.simulator import load_simulator
from tests.study.support import made_study

STUDY = """
name = "rated"
evaluations = 40
audit = false
rules = "{rules}"
algorithm = {{ name = "nsga2", population = 20 }}
"""


@pytest.fixture
def file(tmp_path, monkeypatch):
    # MuJoCo writes its log into the current folder.
    monkeypatch.chdir(tmp_path)

    def written(rules):
        path = tmp_path / f"{rules}.toml"
        path.write_text(STUDY.format(rules=rules))
        return path

    return written


def test_a_study_searches_with_the_gearboxes_of_its_rules_and_goes_on_with_them(file, tmp_path):
    db = tmp_path / "rated.db"
    study = load_study(file("iso6336"))
    run(study, db, evaluations=20)
    data = read_study(db)
    rated = map_of(load_motor("VT8020"), "iso6336")
    assert data.study == study
    assert data.case_kit.hip is rated
    assert load_simulator(study, workers=1).evaluator.actuator_map.hip is rated
    assert resume(db, evaluations=40).new_evaluations == 20
    run(study, tmp_path / "whole.db")
    assert read_study(db).trials.equals(read_study(tmp_path / "whole.db").trials)


def test_other_rules_are_another_study(file, tmp_path):
    db = tmp_path / "rated.db"
    run(load_study(file("iso6336")), db, evaluations=20)
    with pytest.raises(StudyError, match=r'study.rules: "iso6336" -> \(none\)'):
        run(load_study(file("paper")), db, evaluations=40)


def test_rules_are_part_of_the_hash_and_the_results():
    paper, rated = made_study(), made_study(rules="iso6336")
    first, second = (load_simulator(study, workers=1) for study in (paper, rated))
    assert first.contents == second.contents
    hashes = {
        provenance.digest(provenance.decisive(study, first.contents, provenance.versions(study)))
        for study in (paper, rated)
    }
    assert len(hashes) == 2
    assert first.probe() != second.probe()


def test_a_gap_in_the_map_does_not_fail_a_trial():
    """Case A asks for 7.9:1, which has no gearbox under ``iso6336``: the nearest stands in."""
    result = load_simulator(made_study(rules="iso6336"), workers=1).evaluator(PAPER_CASES["A"].design.as_array())
    assert result.ok.all()
