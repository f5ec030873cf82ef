"""The table [uncertainty] of a study file, and measures under uncertainty as objectives and limits."""

import json

import pytest

from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.errors import StudyError
from pareto_monoped.uncertainty.settings import SEARCH_SAMPLES, Sampling, load_uncertainty, sampling_of
from tests.study.support import assert_refused, study_of

SCALES = {"lower": -0.02, "upper": 0.03, "source": "scales"}
BOTH = ["height_m.p05", "electrical_energy_j.p95"]


def test_what_a_table_leaves_out_is_as_shipped():
    shipped = load_uncertainty()
    assert sampling_of({}, source="test") == Sampling(ranges=shipped, samples=SEARCH_SAMPLES, seed=1)
    own = sampling_of({"masses": SCALES, "samples": 32, "seed": 7}, source="test")
    assert (own.samples, own.seed, own.ranges.name) == (32, 7, "own")
    assert (own.ranges.masses.lower, own.ranges.masses.upper, own.ranges.masses.source) == (-0.02, 0.03, "scales")
    others = {name: value for name, value in own.ranges.ranges.items() if name != "masses"}
    assert others == {name: value for name, value in shipped.ranges.items() if name != "masses"}


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"samples": 48}, ["uncertainty.samples = 48", "a power of two from 16 to 4096"]),
        ({"samples": 8}, ["uncertainty.samples = 8"]),
        ({"samples": True}, ["uncertainty.samples"]),
        ({"seed": -1}, ["uncertainty.seed = -1", "from 0 up"]),
        ({"seed": 1.5}, ["uncertainty.seed"]),
        ({"mass": SCALES}, ["table [uncertainty]", "'masses'"]),
        ({"masses": SCALES | {"lower": 0.1}}, ["masses", "swap them"]),
        ({"masses": {"lower": -0.1, "upper": 0.1}}, ["masses.source", "missing"]),
        ({"delay_s": SCALES}, ["delay_s", "at least 0"]),
    ],
)
def test_a_wrong_table_is_refused(table, words):
    with pytest.raises(StudyError) as caught:
        sampling_of(table, source="study file 's.toml'")
    assert "\n" not in str(caught.value)
    for word in ["study file 's.toml'", *words]:
        assert word in str(caught.value)
    assert_refused({"uncertainty": table}, words)


def test_a_study_stores_its_ranges_whole_and_reads_them_back():
    study = study_of(objectives=BOTH, uncertainty={"masses": SCALES, "samples": 32})
    stored = json.loads(json.dumps(study.as_dict()))
    assert stored["objectives"] == BOTH
    assert stored["uncertainty"]["masses"] == SCALES
    assert (stored["uncertainty"]["samples"], stored["uncertainty"]["seed"]) == (32, 1)
    assert set(stored["uncertainty"]) == {*load_uncertainty().as_dict(), "samples", "seed"}
    assert study_from_dict(stored, source="test") == study
    # Without a table, the shipped ranges of this version are stored: a later version may know better.
    assert study_of(objectives=BOTH).as_dict()["uncertainty"]["gains"] == load_uncertainty().as_dict()["gains"]


def test_a_study_without_uncertainty_stores_nothing_of_it():
    assert "uncertainty" not in study_of().as_dict()
    assert study_of().robust_names == ()
    # Ranges alone are for the command ``robust``; no trial depends on them.
    assert study_of(uncertainty={"masses": SCALES}).robust_names == ()


def test_what_a_study_asks_for_decides_what_its_trials_have():
    shares = ("failed_share", "overloaded_share")
    assert study_of(objectives=BOTH).robust_names == (*shares, *BOTH)
    limited = study_of(constraints={"mass_kg.p95": {"max": 5.0}})
    assert limited.robust_names == (*shares, "mass_kg.p95")
    assert study_of(constraints={"overloaded_share": {"max": 0.1}}).robust_names == shares


def test_at_most_five_percent_of_the_jumps_fail_unless_the_file_says_otherwise():
    assert study_of(objectives=BOTH).constraints.value("max_failed_share") == 0.05
    asked = study_of(objectives=BOTH, constraints={"failed_share": {"max": 0.2}})
    assert asked.constraints.value("max_failed_share") == 0.2
    assert study_of().constraints.value("max_failed_share") is None


def test_a_dot_in_a_toml_key_and_in_quotes_are_the_same():
    quoted = {"height_m.p05": {"min": 0.7}, "height_m": {"min": 0.6}}
    dotted = {"height_m": {"p05": {"min": 0.7}, "min": 0.6}}
    first, second = (
        study_of(objectives=BOTH, constraints=table, reference_point=corner)
        for table, corner in ((quoted, {"height_m.p05": 0.5}), (dotted, {"height_m": {"p05": 0.5}}))
    )
    assert first == second
    assert first.constraints.value("min_height_m.p05") == 0.7
    assert first.reference_point.as_dict() == {"height_m.p05": 0.5, "electrical_energy_j.p95": 200.0}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"objectives": ["hight_m.p05", "energy_j"]}, ["'hight_m.p05'", "did you mean 'height_m.p05'?"]),
        ({"objectives": ["apex_s.p05", "energy_j"]}, ["'apex_s.p05'", "no direction"]),
        ({"constraints": {"height_m": {"p50": {"min": 0.7}}}}, ["constraints.height_m"]),
    ],
)
def test_an_unknown_statistic_is_refused(change, words):
    assert_refused(change, words)
