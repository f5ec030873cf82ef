"""Two fronts by the two energies, from stored trials whose numbers are known."""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.analysis import choices as module
from pareto_monoped.analysis.choices import HEIGHT_AND_BATTERY, choices, counterpart, saved, two_fronts
from pareto_monoped.definition.study import open_up
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives
from pareto_monoped.storage.reader import read_study
from tests.study.support import made_database as database
from tests.study.support import made_evaluations, made_generation, made_study

BATTERY = ["height_m", "electrical_energy_j"]


def stored(path, energies_j, battery_j, **more):
    """A study whose three trials jump 0.7, 0.8 and 0.9 m on these energies."""
    study = made_study(**more)
    evaluations = made_evaluations([0.7, 0.8, 0.9], energies_j)
    evaluations = replace(evaluations, electrical_energy_j=np.array(battery_j))
    database(path, [made_generation(study, 0, 0, evaluations, state={})], study)
    return read_study(path)


@pytest.fixture
def fronts(tmp_path, monkeypatch):
    """By mechanical energy every trial is on the front; by that at the battery the first two cost 20 and 30 J."""
    from pareto_monoped.actuator.search import map_for
    from pareto_monoped.storage.reader import StudyData

    # The contents of a made study name no motor.
    monkeypatch.setattr(StudyData, "actuator_maps", {"VT8020": map_for("VT8020")})
    mechanical = stored(tmp_path / "a.db", [10.0, 15.0, 22.0], [25.0, 36.0, 55.0])
    battery = stored(tmp_path / "b.db", [12.0, 17.0, 24.0], [20.0, 30.0, np.nan], objectives=BATTERY, evaluations=80)
    return mechanical, battery


def test_each_front_offers_its_cheapest_design(fronts):
    low, middle, high = choices(*fronts, heights_m=(0.65, 0.75, 0.85))
    assert (low.mechanical.energy_j, low.mechanical.electrical_energy_j) == (10.0, 25.0)
    assert (low.battery.energy_j, low.battery.electrical_energy_j) == (12.0, 20.0)
    assert low.cost == pytest.approx(0.25)
    assert middle.cost == pytest.approx(0.2)
    # The third trial failed: it has no energy at the battery, so that this front ends at 0.8 m.
    assert (high.mechanical.trial, high.battery, high.cost) == (2, None, None)


def test_ratios_are_those_of_the_gearboxes(fronts):
    mechanical, battery = fronts
    (pair,) = choices(mechanical, battery, heights_m=(0.65,))
    searched = mechanical.trials.loc[0, "knee_ratio"]
    assert pair.mechanical.knee_ratio == mechanical.case_kit.knee.lookup(searched).ratio
    assert abs(pair.mechanical.knee_ratio - searched) < 0.1


def test_two_fronts_are_found_in_either_order(fronts):
    mechanical, battery = fronts
    assert two_fronts([mechanical, battery]) == two_fronts([battery, mechanical]) == (mechanical, battery)


def test_studies_that_differ_in_more_than_the_energy_are_no_pair(fronts, tmp_path):
    mechanical, battery = fronts
    other = stored(tmp_path / "c.db", [1.0] * 3, [2.0] * 3, objectives=BATTERY, constraints={"mass_kg": {"max": 9.0}})
    contents = battery.meta.contents | {"motor": {"peak_torque_n_m": 9.0}}
    for second in (other, mechanical, replace(battery, meta=replace(battery.meta, contents=contents))):
        assert two_fronts([mechanical, second]) is None
    assert two_fronts([mechanical]) is None
    assert two_fronts([mechanical, battery, battery]) is None


def test_an_opened_study_is_left_aside(fronts, monkeypatch):
    """By the pair, and by what is dear: it has more variables free than the designs that are judged."""
    mechanical, battery = fronts
    third = replace(mechanical, study=open_up(mechanical.study))
    assert two_fronts([mechanical, battery, third]) == (mechanical, battery)
    assert two_fronts([mechanical, third]) is None
    seen = []
    monkeypatch.setattr(module, "is_dear", lambda rows, studies: seen.append(studies) or np.zeros(len(rows), bool))
    for data in (mechanical, third):
        module.default_pick(data, [mechanical, battery, third])
    assert [len(studies) for studies in seen] == [2, 3]


def test_what_opening_saves_is_between_the_cheapest_designs_of_both_fronts(fronts):
    """Of the second study the third trial failed, so that its front ends at 0.8 m."""
    rows = saved(*fronts, heights_m=(0.65, 0.75, 0.85))
    assert [(height, before.trial, after and after.trial) for height, before, after in rows] == [
        (0.65, 0, 0),
        (0.75, 1, 1),
        (0.85, 2, None),
    ]


def test_the_counterpart_has_the_other_energy():
    assert counterpart(HEIGHT_AND_ENERGY) == HEIGHT_AND_BATTERY
    assert counterpart(HEIGHT_AND_BATTERY) == HEIGHT_AND_ENERGY
    assert counterpart(Objectives(names=("height_m", "mass_kg"))) is None
