from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from pareto_monoped.design import VARIABLES
from pareto_monoped.report.card import MapPlace, Places, best_of_weights, study_card
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
    assert card.floor_mass_kg == trials["mass_kg"].iloc[5:].min()


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
