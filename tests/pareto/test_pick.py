import math

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.errors import SelectionError
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives
from pareto_monoped.pareto.pick import pick
from pareto_monoped.pareto.selectors import Knee, MaxEnergy, MinHeight, Trial, Weights, Within


def _front(heights, energies, trials=None):
    trials = list(range(10, 10 + len(heights))) if trials is None else trials
    return pd.DataFrame({"trial": trials, "height_m": heights, "energy_j": energies})


FRONT = _front([0.6, 0.8, 1.0, 1.2], [5.0, 8.0, 20.0, 45.0])


@pytest.mark.parametrize(
    ("selector", "trial"),
    [
        (MinHeight(height_m=0.0), 10),
        (MinHeight(height_m=0.8), 11),
        (MinHeight(height_m=0.8001), 12),
        (MinHeight(height_m=1.2), 13),
        (MaxEnergy(energy_j=5.0), 10),
        (MaxEnergy(energy_j=19.9), 11),
        (MaxEnergy(energy_j=1e9), 13),
        (Trial(number=12), 12),
        # Scaled heights 0, 1/3, 2/3, 1 and energies 0, 0.075, 0.375, 1: the differences peak at 0.2917, row 2.
        (Knee(), 12),
        (Weights(values=(1.0, 0.0)), 13),
        (Weights(values=(0.0, 1.0)), 10),
        (Weights(values=(1.0, 1.0)), 12),
        (Weights(values=(1.0, 2.0)), 11),
    ],
)
def test_picks_the_design_asked_for(selector, trial):
    assert pick(FRONT, selector).trial == trial
    shuffled = FRONT.sample(frac=1.0, random_state=np.random.default_rng(3))
    assert pick(shuffled, selector).trial == trial


def test_says_why():
    why = pick(FRONT, MinHeight(height_m=0.7)).why
    assert why == "trial 11 (0.800 m on 8.00 J): the least energy of the 3 designs on the front that reach 0.7 m"


@pytest.mark.parametrize(
    ("selector", "words"),
    [
        (MinHeight(height_m=1.3), ["min-height = 1.3 m", "met with min-height = 1.2 m"]),
        (MaxEnergy(energy_j=4.0), ["max-energy = 4 J", "met with max-energy = 5 J"]),
        (Trial(number=3), ["trial = 3", "10, 11, 12, 13"]),
        (Weights(values=(-1.0, 1.0)), ["-1,1"]),
        (Weights(values=(0.0, 0.0)), ["0,0"]),
        (Weights(values=(float("nan"), 1.0)), ["nan"]),
    ],
)
def test_what_no_design_answers_is_refused_with_what_would_do(selector, words):
    with pytest.raises(SelectionError) as caught:
        pick(FRONT, selector)
    for word in words:
        assert word in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("selector", [Knee(), MinHeight(height_m=0.0), Trial(number=1)])
def test_nothing_can_be_picked_off_an_empty_front(selector):
    with pytest.raises(SelectionError, match="0 designs"):
        pick(_front([], []), selector)


def test_a_front_of_one_design_has_that_as_its_knee():
    assert pick(_front([0.7], [3.0]), Knee()).trial == 10


def test_the_knee_says_how_far_it_is_from_the_chord():
    # Row 2 of FRONT: scaled height 2/3, scaled energy 0.375; the chord is the diagonal of the unit square.
    distance = (2.0 / 3.0 - 0.375) / math.sqrt(2.0)
    assert f"farthest ({distance:.3f} of the scaled front) from the chord" in pick(FRONT, Knee()).why


def test_the_knee_of_a_right_angle_is_its_corner():
    assert pick(_front([0.5, 0.99, 1.0], [1.0, 1.1, 9.0]), Knee()).trial == 11


@given(st.floats(0.1, 10.0), st.floats(0.1, 100.0), st.floats(-1.0, 1.0))
def test_the_knee_does_not_depend_on_units(height_scale, energy_scale, shift):
    scaled = _front(FRONT["height_m"] * height_scale + shift, FRONT["energy_j"] * energy_scale)
    assert pick(scaled, Knee()).trial == pick(FRONT, Knee()).trial


THREE = Objectives(names=("height_m", "electrical_energy_j", "mass_kg"))
OF_THREE = pd.DataFrame(
    {
        "trial": [1, 2, 3, 4, 5],
        "height_m": [0.6, 0.9, 1.1, 1.0, 1.2],
        "electrical_energy_j": [10.0, 15.0, 40.0, 25.0, 60.0],
        "mass_kg": [4.5, 4.1, 3.8, 3.6, 4.0],
        "drift_m": [0.1, 0.2, 0.3, 0.05, 0.4],
    }
)


@pytest.mark.parametrize(
    ("selector", "trial", "words"),
    [
        (
            MinHeight(height_m=0.95),
            4,
            "the least energy from the battery of the 3 designs",
        ),
        (MaxEnergy(energy_j=30.0), 4, "the highest jump of the 3 designs"),
        (Within(measure="mass_kg", value=3.9), 3, "have at most 3.9 kg of mass"),
        (Within(measure="drift_m", value=0.15), 4, "have at most 0.15 m of sideways drift"),
        (Within(measure="height_m", value=1.15), 5, "reach 1.15 m"),
        (Weights(values=(0.0, 0.0, 1.0)), 4, "1 x mass = 0.000"),
        (Weights(values=(1.0, 0.0, 0.0)), 5, "1 x height"),
    ],
)
def test_picks_under_three_objectives(selector, trial, words):
    picked = pick(OF_THREE.sample(frac=1.0, random_state=1), selector, THREE)
    assert picked.trial == trial
    assert words in picked.why


def test_the_knee_of_three_objectives_is_farthest_from_the_plane_through_the_ends():
    values = OF_THREE[list(THREE.names)].to_numpy()
    best, worst = values.min(axis=0), values.max(axis=0)
    best[0], worst[0] = worst[0], best[0]
    scaled = [[(v - w) / (b - w) for v, b, w in zip(row, best, worst, strict=True)] for row in values]
    distances = [(sum(row) - 1.0) / 3.0**0.5 for row in scaled]
    picked = pick(OF_THREE, Knee(), THREE)
    assert picked.trial == OF_THREE["trial"][int(np.argmax(distances))]
    assert f"farthest ({max(distances):.3f} of the scaled front) from the plane" in picked.why


def test_the_knee_of_two_minimised_objectives_is_its_corner():
    front = pd.DataFrame({"trial": [1, 2, 3], "electrical_energy_j": [1.0, 1.2, 9.0], "mass_kg": [9.0, 1.1, 1.0]})
    assert pick(front, Knee(), Objectives(names=("electrical_energy_j", "mass_kg"))).trial == 2


@pytest.mark.parametrize(
    ("selector", "objectives", "words"),
    [
        (MaxEnergy(energy_j=9.0), Objectives(names=("height_m", "mass_kg")), ["max-energy", "height_m, mass_kg"]),
        (Weights(values=(1.0, 1.0)), THREE, ["three finite numbers", "1,1,1"]),
        (Weights(values=(1.0, 1.0, 1.0)), HEIGHT_AND_ENERGY, ["two finite numbers"]),
        (Within(measure="mass_kg", value=3.0), THREE, ["mass_kg = 3 kg", "mass_kg = 3.6 kg (0.6 kg more)"]),
        (
            Within(measure="efficiency", value=0.9),
            THREE,
            ["efficiency = 0.9: no stored design meets it", "efficiency = 0.4 (0.5 less), or run the study longer"],
        ),
        (
            Within(measure="stop_energy_j", value=3.0),
            THREE,
            ["stop_energy_j = 3 J: no design has a value"],
        ),
    ],
)
def test_a_selector_that_does_not_suit_the_objectives_is_refused(selector, objectives, words):
    front = OF_THREE.assign(energy_j=OF_THREE["electrical_energy_j"], efficiency=0.4, stop_energy_j=np.nan)
    with pytest.raises(SelectionError) as caught:
        pick(front, selector, objectives)
    for word in words:
        assert word in str(caught.value)
    assert "\n" not in str(caught.value)
