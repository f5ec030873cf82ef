import math

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.errors import SelectionError
from pareto_monoped.pareto.pick import Knee, MaxEnergy, MinHeight, Trial, Weights, pick


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
        (Weights(height=1.0, energy=0.0), 13),
        (Weights(height=0.0, energy=1.0), 10),
        (Weights(height=1.0, energy=1.0), 12),
        (Weights(height=1.0, energy=2.0), 11),
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
        (MinHeight(height_m=1.3), ["min-height = 1.3 m", "1.2000 m"]),
        (MaxEnergy(energy_j=4.0), ["max-energy = 4 J", "5.0000 J"]),
        (Trial(number=3), ["trial = 3", "10, 11, 12, 13"]),
        (Weights(height=-1.0, energy=1.0), ["-1,1"]),
        (Weights(height=0.0, energy=0.0), ["0,0"]),
        (Weights(height=float("nan"), energy=1.0), ["nan"]),
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
