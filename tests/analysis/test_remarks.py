"""What a user hears of a result: few lines, warnings first, and budgets of weighted searches."""

import re
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

import pareto_monoped as pm
from pareto_monoped.analysis.remarks import remarks, warnings
from pareto_monoped.definition.study import load_study, study_from_dict
from pareto_monoped.errors import StudyError
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import resume, run

STUDIES = Path(__file__).parents[2] / "studies"
WEIGHTED = 'name = "w"\nevaluations = {}\naudit = false\n[algorithm]\nname = "weighted_cmaes"\nheight_weights = {}\n'


def written(folder, evaluations, weights, more=""):
    path = folder / "w.toml"
    path.write_text(WEIGHTED.format(evaluations, weights) + more)
    return path


@pytest.mark.parametrize(("evaluations", "iterations"), [(2400, 30), (2479, 30), (80, 1), (16_000, 200), (99_999, 200)])
def test_weights_share_a_budget(tmp_path, evaluations, iterations):
    study = load_study(written(tmp_path, evaluations, [k / 11 for k in range(1, 11)]))
    assert study.algorithm.iterations == iterations
    assert study.as_dict()["algorithm"]["iterations"] == iterations


def test_a_budget_that_ends_before_the_last_weight_is_refused_with_the_number(tmp_path):
    path = written(tmp_path, 2400, [0.2, 0.5, 0.8], "iterations = 200\n")
    with pytest.raises(
        StudyError,
        match=r"evaluations = 2400: 3 weights of 8 designs times 200 iterations need 4800; raise it, set "
        r"algorithm.iterations = 100, or leave",
    ):
        load_study(path)
    assert load_study(path, evaluations=4800).algorithm.iterations == 200
    with pytest.raises(StudyError, match=r"evaluations = 20: 3 weights .* need 24; raise it$"):
        load_study(written(tmp_path, 20, [0.2, 0.5, 0.8]))


@pytest.mark.long
def test_a_shared_budget_reaches_the_last_weight_and_a_cut_one_says_where_it_ended(tmp_path):
    study = load_study(written(tmp_path, 60, [0.2, 0.5, 0.8]))
    cut = run(study, tmp_path / "w.db", evaluations=24)
    assert any(
        line.startswith("the budget of 24 ended at weight 2 of 3; all weights need up to 48: continue with")
        for line in remarks(cut.data)
    )
    whole = run(study, tmp_path / "w.db")
    assert not any("weight" in line for line in remarks(whole.data))
    assert read_study(tmp_path / "w.db").trials["height_weight"].tolist() == [0.2] * 16 + [0.5] * 16 + [0.8] * 16


def iterations_in(path):
    return read_study(path).study.algorithm.iterations


def test_a_larger_budget_given_to_a_new_database_is_shared_out_and_spent(tmp_path):
    """The search ended at the budget of its file, without a word."""
    file, db = written(tmp_path, 48, [0.2, 0.5, 0.8]), tmp_path / "w.db"
    larger = run(load_study(file), db, evaluations=96)
    assert (larger.evaluations, larger.stop_reason, iterations_in(db)) == (96, "budget", 4)
    assert not any("iterations" in line for line in remarks(larger.data))
    # The file goes on with its own database, whatever budget it says.
    assert run(load_study(file), db).evaluations == 96
    assert run(load_study(written(tmp_path, 72, [0.2, 0.5, 0.8])), db).new_evaluations == 0


def test_a_larger_budget_given_to_a_stored_database_says_that_its_iterations_are_fixed(tmp_path):
    """``resume`` added nothing, and the file was refused for a key that it does not have."""
    db = tmp_path / "w.db"
    first = run(load_study(written(tmp_path, 48, [0.2, 0.5, 0.8])), db)
    assert not any("iterations" in line for line in remarks(first.data))
    told = (
        "of 96 evaluations, 48 were made: each weight's iterations were fixed at 2 when the database was made; for 4, "
        "run into a new one (--db), with iterations left out of the study file"
    )
    for more in (
        resume(db, evaluations=96),
        resume(db, evaluations=96),
        run(load_study(written(tmp_path, 96, [0.2, 0.5, 0.8])), db),
    ):
        assert (more.evaluations, remarks(more.data)[0]) == (48, told)
    with pytest.raises(StudyError, match=r"study\.algorithm\.iterations: 2 -> 3\)"):
        run(load_study(written(tmp_path, 96, [0.2, 0.5, 0.8], "iterations = 3\n")), db)


def test_goals_given_from_python_keep_that_iterations_are_shares(tmp_path):
    file = written(tmp_path, 48, [0.2, 0.5, 0.8])
    stored = pm.run(file, tmp_path / "w.db", constraints={"mass_kg": {"max": 9.0}}, evaluations=96)
    assert len(stored.trials) == 96


@pytest.mark.parametrize("more", ["", "iterations = 2\n"])
def test_iterations_are_never_stored_but_as_a_number(tmp_path, more):
    """The hash of a study must not know where its iterations come from."""
    study = load_study(written(tmp_path, 48, [0.2, 0.5, 0.8], more))
    assert study.shared_iterations == (not more)
    assert study.as_dict() == load_study(written(tmp_path, 48, [0.2, 0.5, 0.8])).as_dict()
    assert study == study_from_dict(study.as_dict(), source="test")


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    path = tmp_path_factory.mktemp("random") / "s.db"
    settings = {"name": "s", "evaluations": 8, "audit": False, "algorithm": {"name": "random"}}
    run(study_from_dict(settings, source="test"), path)
    return read_study(path)


@pytest.mark.parametrize(
    ("heights_m", "energies_j", "told"),
    [
        ([0.6, 1.0, 1.2], [20.0, 99.9, 99.99], ""),
        ([0.6, 1.0, 1.2], [20.0, 100.0, 168.0], "2 of the front's 3 .* set energy_j = 200 in "),
        ([0.3, 1.0, 1.2], [20.0, 50.0, 60.0], "1 of the front's 3 .* set height_m = 0.2 in "),
        ([0.5, 1.0, 1.2], [20.0, 50.0, 200.0], "2 of the front's 3 .* set height_m = 0.4 and energy_j = 300 in "),
    ],
)
def test_designs_beyond_the_reference_point_are_counted_with_the_values_to_set(stored, heights_m, energies_j, told):
    """They added nothing to the hypervolume, and nobody was told."""
    front = pd.DataFrame({"height_m": heights_m, "energy_j": energies_j})
    lines = warnings(stored, front)
    assert len(lines) == bool(told)
    assert re.match(told, "".join(lines))
    if not told:
        return
    cure = re.search(r"set (.*) in", lines[0])[1].split(" and ")
    corner = {name: float(value) for name, value in (pair.split(" = ") for pair in cure)}
    further = study_from_dict(stored.study.as_dict() | {"reference_point": corner}, source="test")
    assert warnings(replace(stored, study=further), front) == []


def test_an_objective_whose_corner_cannot_be_further_is_not_told(stored):
    """No share can be less than 0, where its corner is."""
    objectives = {"objectives": ["height_m", "efficiency"], "reference_point": {}}
    study = study_from_dict(stored.study.as_dict() | objectives, source="test")
    front = pd.DataFrame({"height_m": [0.6, 0.8], "efficiency": [0.0, 0.5]})
    assert warnings(replace(stored, study=study), front) == []


def test_the_study_of_any_motor_has_the_corner_of_its_most_powerful_motors():
    """Its highest jumps were beyond the default of 100 J."""
    corners = {name: load_study(STUDIES / f"{name}.toml").reference_point for name in ("any_motor", "motor_u12")}
    assert corners["any_motor"] == corners["motor_u12"]


@pytest.mark.parametrize(("start_height_m", "told"), [(None, True), (0.5, False)])
def test_a_run_says_when_a_fifth_of_its_jumps_failed(tmp_path, start_height_m, told):
    """Legs of 0.3 to 0.5 m stand at 0.5 m, but few at 0.3 or 0.7 m."""
    wide = {"start_height_m": {"lower": 0.3, "upper": 0.7}}
    variables = wide if told else {"start_height_m": start_height_m}
    values = {"name": "x", "evaluations": 40, "audit": False, "algorithm": {"name": "random"}, "variables": variables}
    data = run(study_from_dict(values, source="test"), tmp_path / "x.db").data
    failed = int((data.trials["state"] == "failed").sum())
    assert (failed >= 8) is told
    said = [line for line in remarks(data) if "jumps failed" in line]
    start = f"{failed} of 40 jumps failed ({100 * failed / 40:.0f} percent), most often because: "
    assert [line[: len(start)] for line in said] == ([start] if told else [])
