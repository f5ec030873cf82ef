"""Strength in a study: constraints that leave only designs that hold, or a word in every output that nobody asked."""

import json

import pytest
from click.testing import CliRunner

from pareto_monoped.cli import cli
from pareto_monoped.definition.study import NO_STRENGTH, load_study, study_from_dict
from pareto_monoped.errors import StudyError
from pareto_monoped.report.summary import notes
from pareto_monoped.storage.reader import read_study
from pareto_monoped.strength.factors import TABLE, strength_factors
from pareto_monoped.strength.groups import GROUP_MEASURES, REQUIRED_MEASURES
from pareto_monoped.strength.joint import loads_of
from pareto_monoped.study.run import resume, run
from tests.study.support import assert_refused, made_database, made_study
from tests.study.support import study_of as made

SAFETIES = REQUIRED_MEASURES
STUDY = """
name = "strong"
evaluations = 120
audit = false
strength = {strength}
{more}
"""
# Some of these jumps the parts hold, and some they do not.
EASY = """
[variables]
thigh_length_m = 0.35
knee_ratio = {lower = 6.0, upper = 8.4}
stiffness_n_per_m = {lower = 5.0, upper = 200.0}
knee_release_rad = {lower = 0.3, upper = 1.0}
"""
OTHERS = ("weighted_cmaes", "nsga2", "sms_emoa", "optuna_nsga2", "random")
ALGORITHMS = ("surrogate", *(pytest.param(name, marks=pytest.mark.long) for name in OTHERS))
"""Which search asks makes no difference to the strength of what it asks for."""


def written(tmp_path, strength="true", more=""):
    path = tmp_path / "strong.toml"
    path.write_text(STUDY.format(strength=strength, more=more))
    return path


def test_strength_constrains_every_group_and_is_stored():
    study = made(strength=True)
    assert [study.constraints.value(f"min_{name}") for name in SAFETIES] == [1.0] * len(SAFETIES)
    assert study.as_dict()["strength"] is True
    assert study_from_dict(json.loads(json.dumps(study.as_dict())), source="db") == study


def test_a_study_that_does_not_ask_is_stored_as_ever():
    assert made().as_dict() == made(strength=False).as_dict()
    assert "strength" not in made().as_dict()
    assert not any(f"min_{name}" in made().as_dict()["constraints"] for name in SAFETIES)


def test_more_may_be_asked_and_less_may_not():
    assert made(strength=True, constraints={"gear_safety": {"min": 1.5}}).constraints.value("min_gear_safety") == 1.5
    assert_refused(
        {"strength": True, "constraints": {"chain_safety": {"min": 0.5}}},
        ["constraints.chain_safety.min = 0.5", "at least 1", "strength = false"],
    )
    assert made(constraints={"chain_safety": {"min": 0.5}}).constraints.value("min_chain_safety") == 0.5


def test_strikes_inform_and_are_asked_for_by_name_alone():
    assert "gear_strike_safety" in GROUP_MEASURES.values()
    assert made(strength=True).constraints.value("min_gear_strike_safety") is None
    asked = made(strength=True, constraints={"gear_strike_safety": {"min": 0.8}})
    assert asked.constraints.value("min_gear_strike_safety") == 0.8
    assert asked.constraints.value("min_gear_safety") == 1.0


def test_a_study_keeps_strikes_within_the_limit_that_it_names(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    study = load_study(written(tmp_path, more=f"{EASY}\n[constraints]\ngear_strike_safety = {{ min = 1.2 }}"))
    run(study, tmp_path / "struck.db")
    trials = read_study(tmp_path / "struck.db").trials
    ok = trials[trials["status"] == "ok"]
    low = ok["gear_strike_safety"] < 1.2
    assert low.any()
    assert not low.all()
    assert (ok.loc[low, "state"] == "infeasible").all()
    assert ok.loc[low, "reason"].str.contains("gear_strike_safety|_safety = ").all()


def test_the_option_overrides_the_file(tmp_path):
    path = written(tmp_path)
    assert load_study(path).strength
    assert not load_study(path, strength=False).strength


def test_the_paper_simulation_does_not_ask(tmp_path):
    path = tmp_path / "paper.toml"
    path.write_text('name = "p"\nevaluations = 1\ncalibration = "paper"\n')
    assert not load_study(path).strength


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_a_front_under_strength_holds(tmp_path, monkeypatch, algorithm):
    monkeypatch.chdir(tmp_path)
    study = load_study(written(tmp_path, more=f'algorithm.name = "{algorithm}"\n{EASY}'))
    run(study, tmp_path / "strong.db")
    data = read_study(tmp_path / "strong.db")
    front = data.front()
    assert len(front)
    assert (front[list(SAFETIES)] >= 1.0).all(axis=None)
    weak = data.trials[(data.trials[list(SAFETIES)] < 1.0).any(axis=1)]
    # The weighted search starts among designs that hold and stays there.
    assert len(weak) or algorithm == "weighted_cmaes"
    assert (weak["state"] == "infeasible").all()
    assert weak["reason"].str.contains("_safety = ").all()
    # What is stored follows from the stored loads.
    factors = strength_factors(data.trials[list(data.study.variables)].to_numpy(), data.case_kit, loads_of(data.trials))
    for group, name in GROUP_MEASURES.items():
        members = [k for k, joint in enumerate(TABLE) if joint.group == group]
        least = [min((row[k] / TABLE[k].required for k in members), default=1000.0) for row in factors]
        ok = (data.trials["status"] == "ok").to_numpy()
        assert data.trials[name][ok].to_numpy() == pytest.approx([v for v, o in zip(least, ok, strict=True) if o])


def test_a_study_under_strength_goes_on_as_it_would_have(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    study = load_study(written(tmp_path, more=EASY))
    run(study, tmp_path / "parts.db", evaluations=50)
    assert resume(tmp_path / "parts.db", evaluations=80).new_evaluations == 30
    run(study, tmp_path / "whole.db", evaluations=80)
    assert read_study(tmp_path / "parts.db").trials.equals(read_study(tmp_path / "whole.db").trials)


def test_every_output_says_that_nobody_asked(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path, db = written(tmp_path, more=EASY), tmp_path / "strong.db"
    runner = CliRunner()
    ran = runner.invoke(cli, ["run", str(path), "--no-strength", "--evaluations", "60"])
    assert ran.exit_code == 0, ran.output
    assert NO_STRENGTH in ran.stderr
    for command in (["front", db], ["pick", db, "--knee"], ["pick", db, "--knee", "--json"], ["status", db]):
        said = runner.invoke(cli, [str(word) for word in command])
        assert said.exit_code == 0, said.output
        assert NO_STRENGTH in said.output, command
    assert json.loads(runner.invoke(cli, ["status", str(db), "--json"]).stdout)["strength"] is False
    again = runner.invoke(cli, ["run", str(path)])
    assert isinstance(again.exception, StudyError)
    assert "study.strength: (none) -> true" in str(again.exception)


class _Again:
    drift_m = 0.0


def test_reports_say_it_too(tmp_path):
    for strength in (True, False):
        db = tmp_path / f"{strength}.db"
        made_database(db, study=made_study(strength=strength))
        said = any("strength" in line.lower() for line in notes(read_study(db), _Again()))
        assert said is not strength
