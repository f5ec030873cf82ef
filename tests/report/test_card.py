from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from pareto_monoped.design import NAMES, VARIABLES
from pareto_monoped.jump.gravity import least_energy_j, least_of_all_j
from pareto_monoped.report import card as card_module
from pareto_monoped.report.card import FLOOR_HEIGHTS_M, MapPlace, Places, _floor_j, best_of_weights, study_card
from pareto_monoped.robot.population import robot_arrays
from pareto_monoped.storage.reader import read_study

PLACES = Places(maps={"VT8020": MapPlace(number=0, first_gearbox=0)}, kits={"VT8020": 0})


@pytest.fixture(scope="module")
def weighted_data(weighted):
    return read_study(weighted)


def by_hand(data, rows) -> object:
    """The weighted study with hand-made trials: weight, height, energy, state."""
    trials = data.trials.iloc[: len(rows)].copy()
    for i, name in enumerate(("height_weight", "height_m", "energy_j")):
        trials[name] = [row[i] for row in rows]
    trials["state"] = pd.array([row[3] for row in rows], dtype="str")
    return replace(data, trials=trials)


def test_a_weighted_run_gives_its_feasible_trial_of_least_cost(weighted_data):
    """The cost is w S exp(-H) + (1 - w) E."""
    scale_j = weighted_data.study.algorithm.height_scale_j
    # Energies that make trial 1 dearer than trial 0 by less than its height is worth at the larger weight only.
    worth_j = scale_j * (np.exp(-0.6) - np.exp(-1.0))
    rows = [
        (weight, height, energy, state)
        for weight in (0.2, 0.6)
        for height, energy, state in (
            (0.6, 10.0, "feasible"),
            (1.0, 10.0 + worth_j, "feasible"),
            (2.0, 1.0, "infeasible"),
        )
    ]
    data = by_hand(weighted_data, rows)
    numbers = data.trials["trial"].tolist()
    assert best_of_weights(data) == [(0.2, numbers[0]), (0.6, numbers[4])]


def test_other_searches_have_no_weighted_runs(data):
    assert best_of_weights(data) == []


def test_the_card_counts_states_and_reasons_of_failure(source):
    trials = source.data.trials.copy()
    trials["state"] = pd.array(["failed"] * 3 + ["infeasible"] * 2 + ["feasible"] * (len(trials) - 5), dtype="str")
    trials.loc[:2, "status"] = ["no_take_off", "no_gearbox", "no_take_off"]
    card = study_card(
        replace(source, data=replace(source.data, trials=trials)), "label", len(trials), PLACES, VARIABLES
    )
    assert card.counts == {"feasible": len(trials) - 5, "infeasible": 2, "failed": 3, "total": len(trials)}
    assert card.reasons == {"no_take_off": 2, "no_gearbox": 1}
    assert card.trials.state[:6] == "xxxiif"


def test_no_trial_lies_below_the_floor_and_the_floor_is_that_of_some_design(data, payload):
    (card,) = payload.studies
    heights, trials = np.array(FLOOR_HEIGHTS_M), data.trials[data.trials["height_m"].notna()]
    assert (trials["energy_j"] > np.interp(trials["height_m"], heights, card.floor_j)).all()
    robots = robot_arrays(trials[list(NAMES)].to_numpy(dtype=float), data.case_kit, data.calibration.mass)
    for height in (0.56, 0.9, 1.2):
        each = least_energy_j(robots, data.calibration, np.full(len(trials), height))
        assert card.floor_j[FLOOR_HEIGHTS_M.index(height)] == pytest.approx(each.min(), abs=1.1e-4)


def test_a_floor_of_more_trials_than_are_searched_at_once_is_that_of_all(data, payload, monkeypatch):
    monkeypatch.setattr(card_module, "_AT_ONCE", 60)
    many = replace(data, trials=data.trials.sort_values("mass_kg", ignore_index=True))
    assert len(many.trials) > 3 * 60
    assert _floor_j(many) == payload.studies[0].floor_j


def test_lines_between_the_heights_of_a_floor_stay_near_it(data):
    trials = data.trials[data.trials["height_m"].notna()]
    robots = robot_arrays(trials[list(NAMES)].to_numpy(dtype=float), data.case_kit, data.calibration.mass)
    heights = np.concatenate([np.arange(0.3625, 2.0, 0.0025), np.arange(2.0, 9.0, 0.02)])
    floor = least_of_all_j(robots, data.calibration, np.array(FLOOR_HEIGHTS_M))
    above = np.interp(heights, FLOOR_HEIGHTS_M, floor) - least_of_all_j(robots, data.calibration, heights)
    leaves = FLOOR_HEIGHTS_M[np.flatnonzero(floor == 0.0)[-1]]
    assert above.max() < 0.1
    assert above[(heights < leaves) | (heights > leaves + 0.01)].max() < 0.01


def test_a_study_in_which_nothing_jumped_has_no_floor(source):
    trials = source.data.trials.assign(height_m=np.nan, state="failed")
    data = replace(source.data, trials=trials)
    assert study_card(replace(source, data=data), "label", len(trials), PLACES, VARIABLES).floor_j == []


def test_bounds_foot_and_gearboxes_are_the_studys(payload, data):
    (card,) = payload.studies
    assert card.bounds["thigh_length_m"] == [0.3, 0.5]
    foot_kg, radius_m = card.foot_mass_kg, card.foot_radius_m
    given = data.calibration.mass
    assert radius_m == (0.033 if given.foot_radius_m is None else given.foot_radius_m)
    assert 0.02 < foot_kg < 0.3
    for i, case in enumerate(payload.published):
        for joint in ("hip", "knee"):
            gears = data.case_kit.of(joint).lookup(case["design"][f"{joint}_ratio"]).gears
            gearbox = payload.gearboxes[card.case_gearboxes[joint][i]]
            assert (gearbox.sun_teeth, gearbox.planet_teeth) == (gears.sun_teeth, gears.planet_teeth)


def test_a_calibrations_own_foot_is_on_the_card(source):
    mass = replace(source.data.calibration.mass, foot_mass_kg=0.123, foot_radius_m=0.021)
    data = replace(source.data)
    data.__dict__["calibration"] = replace(source.data.calibration, mass=mass)
    card = study_card(replace(source, data=data), "label", 10, PLACES, VARIABLES)
    assert (card.foot_mass_kg, card.foot_radius_m) == (0.123, 0.021)
