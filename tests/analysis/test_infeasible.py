"""Why a study has no front: limits that every design misses, and limits that only together leave none."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from pareto_monoped.analysis.remarks import remarks, why_no_front
from pareto_monoped.api.studies import load_study
from pareto_monoped.cli import _run as cli
from pareto_monoped.definition.goals import constraints_of
from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.errors import SelectionError
from pareto_monoped.report.summary import notes
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import run


def made(**more):
    settings = {"name": "s", "evaluations": 40, "audit": False, "algorithm": {"name": "random"}, "gear_list": True}
    return study_from_dict(settings | more, source="test")


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    path = tmp_path_factory.mktemp("random") / "s.db"
    run(made(), path)
    return read_study(path)


def test_a_run_without_a_feasible_design_names_the_limit_and_the_closest_value(tmp_path, data):
    study = replace(made(), constraints=constraints_of({"mass_kg": {"max": 2.0}, "drift_m": {"max": 10.0}}))
    summary = run(study, tmp_path / "s.db")
    found = read_study(tmp_path / "s.db").trials
    jumped = found[found["state"] != "failed"]
    assert (found["state"] == "feasible").sum() == 0
    (line,) = remarks(summary.data)
    assert line.startswith(
        f"no design is feasible: {len(jumped)} of {len(jumped)} miss mass_kg <= 2; the least is "
        f"{jumped['mass_kg'].min():.4g} kg"
    )
    assert "drift_m" not in line


def test_limits_that_only_together_leave_no_design_are_all_named_with_the_nearest_trial(data):
    """Only the limit that most designs missed was named, with a value that met it."""
    trials = data.trials.iloc[:10].copy()
    trials["state"], trials["mass_kg"] = "infeasible", np.linspace(3.0, 3.9, 10)
    trials["height_m"] = np.linspace(0.5, 0.59, 10)
    constraints = constraints_of({"mass_kg": {"max": 3.25}, "height_m": {"min": 0.575}, "drift_m": {"max": 10.0}})
    infeasible = replace(data, trials=trials, study=replace(data.study, constraints=constraints))
    assert remarks(infeasible) == [
        "no design is feasible: none of 10 meets all limits at once: 8 miss height_m >= 0.575, 7 miss mass_kg <= 3.25; "
        f"nearest is trial {trials['trial'].iloc[3]} with height_m 0.53 m, mass_kg 3.3 kg"
    ]


def test_a_value_that_misses_its_limit_by_little_is_not_rounded_to_it(data):
    trials = data.trials.iloc[:2].copy()
    trials["state"], trials["mass_kg"] = "infeasible", [3.2500004, 3.9]
    infeasible = replace(data, trials=trials, study=replace(data.study, constraints=HEAVY))
    assert why_no_front(infeasible) == "no design is feasible: 2 of 2 miss mass_kg <= 3.25; the least is 3.2500004 kg"


HEAVY = constraints_of({"mass_kg": {"max": 3.25}})


@pytest.fixture(scope="module")
def torn(data, tmp_path_factory):
    """The same trials under two limits that some meet, but never both."""
    jumped = data.trials[data.trials["state"] != "failed"]
    most_kg = float(jumped["mass_kg"].quantile(0.25))
    light = jumped[jumped["mass_kg"] <= most_kg]
    least_m = float(light["height_m"].max()) + 1e-3
    assert jumped["height_m"].max() > least_m
    limits = constraints_of({"mass_kg": {"max": most_kg}, "height_m": {"min": least_m}})
    path = tmp_path_factory.mktemp("torn") / "s.db"
    return path, run(replace(made(), constraints=limits), path)


def test_every_command_says_why_an_infeasible_study_has_no_front(torn, tmp_path, capsys):
    """``pick`` and ``front`` said nothing of the limits."""
    path, summary = torn
    (why,) = remarks(summary.data)
    stored = read_study(path)
    assert "meets all limits at once" in why
    assert why == why_no_front(stored)
    asked = {
        "pick": ["--knee"],
        "export": ["--knee", "-o", str(tmp_path / "cad")],
        "sensitivity": ["--knee"],
    }
    for command, options in asked.items():
        assert cli([command, str(path), *options]) == 2
        assert f"front: {why}; run the study longer" in " ".join(capsys.readouterr().err.split())
    assert cli(["front", str(path)]) == 0
    assert f"note: {why}" in " ".join(capsys.readouterr().err.split())
    assert f"{why[0].upper()}{why[1:]}." in notes(stored, SimpleNamespace(drift_m=0.0))
    with pytest.raises(SelectionError, match="meets all limits at once"):
        load_study(path).pick(by="knee")


def test_a_search_in_which_nothing_jumps_says_why(data):
    trials = data.trials.iloc[:10].copy()
    trials["state"], trials["reason"] = "failed", ["fell"] * 7 + ["sank"] * 3
    assert remarks(replace(data, trials=trials)) == [
        "no design is feasible: none of 10 jumps, most often because: fell"
    ]
