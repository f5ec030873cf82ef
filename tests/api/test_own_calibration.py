"""A calibration that a script makes: checked as one from a file, and its values stored with the study."""

from dataclasses import dataclass, fields, replace

import pandas as pd
import pytest

import pareto_monoped as pm
from pareto_monoped.cli import _run as cli

REFERENCE = pm.load_calibration("reference")
DESIGN = pm.PAPER_CASES["C"].design
STUDY = pm.Study.define(name="s", evaluations=40, algorithm="random", audit=False)


def softer(**changes):
    floor = replace(REFERENCE.contact, stiffness_n_per_m=2e4)
    return replace(REFERENCE, **{"name": "soft_floor", "contact": floor} | changes)


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    return pm.run(STUDY, tmp_path_factory.mktemp("own") / "soft.db", calibration=softer())


def test_a_study_stores_the_values_of_an_own_calibration(stored):
    assert stored.data.calibration == softer()
    assert stored.study.calibration == "own:soft_floor"
    assert stored.data.meta.calibration == softer().label
    trial = stored.trials[stored.trials["status"] == "ok"].iloc[0]
    design = stored.design(int(trial["trial"]))
    assert pm.simulate(design, calibration=softer())["height_m"][0] == trial["height_m"]
    assert pm.simulate(design)["height_m"][0] != trial["height_m"]


def test_it_goes_on_from_the_database_alone_and_from_the_same_call(stored, tmp_path):
    copies = [tmp_path / f"{k}.db" for k in range(3)]
    for copy in copies:
        copy.write_bytes(stored.path.read_bytes())
    first = pm.resume(copies[0], evaluations=60).trials
    assert cli(["resume", str(copies[1]), "--evaluations", "60"]) == 0
    pm.run(STUDY, copies[2], calibration=softer(), evaluations=60)
    for copy in copies[1:]:
        pd.testing.assert_frame_equal(pm.load_study(copy).trials, first, check_exact=True)


def test_without_it_or_with_another_the_study_does_not_go_on(stored):
    for calibration in (None, softer(version=9)):
        with pytest.raises(pm.ParetoMonopedError, match="began with other settings"):
            pm.run(STUDY, stored.path, calibration=calibration, evaluations=60)


def test_a_study_that_names_it_cannot_begin_without_it(stored, tmp_path):
    with pytest.raises(pm.ParetoMonopedError, match="only your program has it; start the study from Python"):
        pm.run(stored.study, tmp_path / "new.db")


def test_a_shipped_calibration_may_be_given_as_an_object_or_by_name(tmp_path):
    one = pm.run(STUDY, tmp_path / "one.db", calibration=pm.load_calibration("ideal"))
    other = pm.run(STUDY, tmp_path / "other.db", calibration="ideal")
    assert one.study.calibration == "ideal"
    assert one.data.meta.hash == other.data.meta.hash != pm.run(STUDY, tmp_path / "third.db").data.meta.hash


def test_the_calibration_of_the_paper_brings_its_gearbox_rules(tmp_path):
    stored = pm.run(STUDY, tmp_path / "s.db", calibration="paper")
    assert (stored.study.calibration, stored.study.rules) == ("paper", "paper")


def test_an_earlier_version_of_a_shipped_one_may_be_given_as_an_object(tmp_path):
    stored = pm.run(STUDY, tmp_path / "s.db", calibration=pm.load_calibration("reference-1"))
    assert stored.study.calibration == "reference-1"


def test_a_shipped_name_with_other_values_is_refused(tmp_path):
    with pytest.raises(pm.ParetoMonopedError, match="is a shipped calibration with other values"):
        pm.run(STUDY, tmp_path / "s.db", calibration=softer(name="reference"))


@dataclass(frozen=True, slots=True, kw_only=True)
class Lucky(pm.Calibration):
    @property
    def label(self):
        return "lucky"


def test_a_class_of_its_own_is_refused(tmp_path):
    lucky = Lucky(**{field.name: getattr(REFERENCE, field.name) for field in fields(REFERENCE)})
    for call in (
        lambda: pm.simulate(DESIGN, calibration=lucky),
        lambda: pm.run(STUDY, tmp_path / "s.db", calibration=lucky),
    ):
        with pytest.raises(pm.ParetoMonopedError, match=r"is a Lucky, must be a Calibration itself") as caught:
            call()
        assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []


WRONG = {
    "negative": {"simulation": replace(REFERENCE.simulation, time_limit_s=-1.0)},
    "a word": {"joints": replace(REFERENCE.joints, friction_n_m="little")},
    "no record": {"drive": 5},
    "a set": {"description": {"soft"}},
    "no name": {"name": "soft floor!"},
}


@pytest.mark.parametrize("changes", WRONG.values(), ids=WRONG.keys())
def test_values_that_no_calibration_can_have_are_refused(changes):
    with pytest.raises(pm.ParetoMonopedError) as caught:
        pm.simulate(DESIGN, calibration=replace(REFERENCE, **changes))
    assert "\n" not in str(caught.value)


def test_goals_of_a_call_leave_the_other_settings_as_they_are(tmp_path):
    """What a stored study leaves out at its default is not what a study file leaves out."""
    study = pm.Study.define(name="s", evaluations=20, rules="paper", strength=False, gear_list=False, audit=False)
    stored = pm.run(study, tmp_path / "s.db", constraints={"mass_kg": {"max": 6.0}})
    assert (stored.study.rules, stored.study.strength, stored.study.gear_list) == ("paper", False, False)
    assert stored.study.constraints.value("max_mass_kg") == 6.0


def test_a_renamed_own_calibration_is_called_another_setting(stored):
    """It was said that only the user's program has it, in the user's program."""
    with pytest.raises(pm.ParetoMonopedError, match="began with other settings"):
        pm.run(STUDY, stored.path, calibration=softer(name="renamed"), evaluations=60)
