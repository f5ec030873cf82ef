"""What a user hears of a result: few lines, warnings first, and budgets of weighted searches."""

import pytest

from pareto_monoped.errors import StudyError
from pareto_monoped.study.definition import load_study
from pareto_monoped.study.reader import read_study
from pareto_monoped.study.run import run

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


def test_a_shared_budget_reaches_the_last_weight_and_a_cut_one_says_where_it_ended(tmp_path):
    study = load_study(written(tmp_path, 60, [0.2, 0.5, 0.8]))
    cut = run(study, tmp_path / "w.db", evaluations=24)
    assert any(
        line.startswith("the budget of 24 ended at weight 2 of 3; all weights need up to 48: continue with")
        for line in cut.remarks
    )
    whole = run(study, tmp_path / "w.db")
    assert not any("weight" in line for line in whole.remarks)
    assert read_study(tmp_path / "w.db").trials["height_weight"].tolist() == [0.2] * 16 + [0.5] * 16 + [0.8] * 16
