"""Designs scored by medians over perturbed copies: against each copy alone, and what a study does with them."""

import numpy as np
import pytest

import pareto_monoped as pm
from pareto_monoped.actuator.search import map_for
from pareto_monoped.definition.study import load_study, study_from_dict
from pareto_monoped.design import LOWER, PAPER_CASES, UPPER, complete
from pareto_monoped.errors import StudyError
from pareto_monoped.jump.audit import MedianEvaluator, _like_most
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.measures import MEASURE_NAMES

EVALUATOR = Evaluator(map_for("VT8020", "paper"), load_calibration("paper"))
DESIGNS = np.vstack(
    (
        [case.design.as_array() for case in PAPER_CASES.values()],
        [PAPER_CASES["C"].design.replace(stiffness_n_per_m=5.0, damping_n_s_per_m=100.0).as_array()],  # stays down
        complete(np.random.default_rng(4).uniform(LOWER, UPPER, (8, len(LOWER)))),
    )
)


class Recording(Evaluator):
    """Remembers the copies that it lets jump."""

    def __call__(self, designs, motors=None, **more):
        self.asked = np.array(designs)
        return super().__call__(designs, motors, **more)


def test_each_measure_is_the_middle_one_of_its_copies_alone():
    """Sorted by hand, copy by copy; nothing of the batch is used twice."""
    recording = Recording(EVALUATOR.actuator_map, EVALUATOR.calibration)
    found = MedianEvaluator(evaluator=recording, copies=3)(DESIGNS)
    assert recording.asked.shape[0] == 3 * len(DESIGNS)
    for i, design in enumerate(DESIGNS):
        copies = recording.asked[3 * i : 3 * i + 3]
        np.testing.assert_array_equal(copies[0, : len(design)], design)
        assert 0.0 < np.abs(copies[1:, :7] / design[:7] - 1.0).max() <= 1e-6
        alone = [EVALUATOR(copy) for copy in copies]
        jumped = [one for one in alone if one.ok[0]]
        assert found.ok[i] == (len(jumped) >= 2)
        if len(jumped) == 3:
            for name in MEASURE_NAMES:
                middle = sorted(one.of(name)[0] for one in jumped)[1]
                np.testing.assert_equal(found.of(name)[i], middle, err_msg=name)
    assert found.ok.sum() >= 8
    assert (np.unique(found.status) != "ok").any()


def test_no_design_depends_on_the_others():
    together, alone = (MedianEvaluator(evaluator=EVALUATOR, copies=5), MedianEvaluator(evaluator=EVALUATOR, copies=5))
    every = together(DESIGNS)
    for i in (0, 5, 11):
        one = alone(DESIGNS[i])
        assert (one.status[0], one.reason[0]) == (every.status[i], every.reason[i])
        for name in MEASURE_NAMES:
            np.testing.assert_array_equal(one.of(name), every.of(name)[i : i + 1])


def test_a_design_of_which_half_the_copies_fail_does_not_jump():
    """As if two of four copies sank; the reason is that of the first of them."""

    class Sinking(Evaluator):
        def __call__(self, designs, motors=None, **more):
            good = super().__call__(designs, motors, **more)
            bad = super().__call__(np.full_like(designs, np.nan), motors, **more)
            sinks = np.arange(len(designs)) % 4 >= 2
            columns = {name: np.where(sinks, bad.of(name), good.of(name)) for name in MEASURE_NAMES}
            reason = tuple(b if k else g for k, g, b in zip(sinks, good.reason, bad.reason, strict=True))
            return type(good)(status=np.where(sinks, bad.status, good.status), reason=reason, **columns)

    sinking = Sinking(EVALUATOR.actuator_map, EVALUATOR.calibration)
    half = MedianEvaluator(evaluator=sinking, copies=4)(DESIGNS[:2])
    assert half.status.tolist() == ["bad_input"] * 2
    assert all(half.reason)
    assert np.isnan(half.height_m).all()
    most = MedianEvaluator(evaluator=sinking, copies=3)(DESIGNS[:1])
    assert most.ok.all()
    assert most.reason == ("",)


@pytest.mark.parametrize(
    ("ends", "place"),
    [
        (["timeout", "sank", "sank", "ok"], 1),
        (["sank", "timeout", "sank", "ok"], 0),
        (["diverged", "timeout", "sank", "timeout"], 1),
    ],
)
def test_a_design_ends_as_most_of_its_copies_do_of_which_the_first_says_why(ends, place):
    assert _like_most(np.array(ends)) == place


def test_a_study_under_paper_has_a_front_and_no_audit(tmp_path):
    """Its audit once took every design off the front of Case A."""
    study = pm.Study.define(name="p", case="A", calibration="paper", evaluations=30, seed=3)
    assert (study.copies, study.audit, study.rules, study.strength) == (11, False, "paper", False)
    stored = pm.run(study, tmp_path / "p.db")
    assert len(stored.front()) > 1
    assert pm.verify(stored, simulate=5).simulated == 5
    row = stored.pick("knee")
    assert row.row["height_m"] != pm.simulate(row.design, calibration="paper")["height_m"][0]
    again = pm.resume(tmp_path / "p.db", evaluations=40)
    whole = pm.run(pm.Study.define(name="p", case="A", calibration="paper", evaluations=40, seed=3), tmp_path / "w.db")
    assert again.trials.equals(whole.trials)


def test_a_study_of_another_calibration_counts_by_copies_once_it_is_run_under_paper(tmp_path):
    stored = pm.run(pm.Study.define(name="s", evaluations=20), tmp_path / "s.db", calibration="paper")
    assert (stored.study.copies, stored.study.audit) == (11, False)


def test_a_study_stored_before_there_were_copies_keeps_its_hash(tmp_path):
    old = {"name": "p", "evaluations": 5, "calibration": "paper"}
    assert study_from_dict(old, source="test").copies == 1
    assert "copies" not in study_from_dict(old, source="test").as_dict()
    path = tmp_path / "p.toml"
    path.write_text('name = "p"\nevaluations = 5\ncalibration = "paper"\n')
    assert load_study(path).as_dict()["copies"] == 11


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"objectives": ["height_m.p05", "energy_j"]}, "copies = 11: must be 1 under uncertainty"),
        ({"constraints": {"height_m.p05": {"min": 0.6}}}, "copies = 11: must be 1 under uncertainty"),
        ({"copies": 0}, "copies"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(changes, words):
    with pytest.raises(StudyError, match=words) as refused:
        pm.Study.define(name="p", evaluations=5, calibration="paper", **changes)
    assert "\n" not in str(refused.value)
