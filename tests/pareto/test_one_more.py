"""What a step in the first objective costs, against brute force."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives
from pareto_monoped.pareto.trade_offs import one_more
from tests.pareto.fronts import THREE, fronts, losses


@pytest.mark.parametrize("objectives", [HEIGHT_AND_ENERGY, THREE], ids=["two", "three"])
@given(data=st.data())
def test_it_is_the_cheapest_design_a_step_higher(objectives, data):
    front = data.draw(fronts(objectives))
    loss = losses(front, objectives)
    records = front.to_dict(orient="records")
    for record in records:
        step = one_more(front, record["trial"], objectives)
        assert step.step == 0.01
        # All heights of these fronts are 7 cm apart, so that a centimetre more is any greater height.
        higher = [i for i, other in enumerate(records) if other["height_m"] > record["height_m"] + 1e-6]
        if not higher:
            assert step.trial is None
            assert "cannot be had" in step.text()
            continue
        found = next(i for i, other in enumerate(records) if other["trial"] == step.trial)
        assert found in higher
        assert sum(loss[found][1:]) == pytest.approx(min(sum(loss[i][1:]) for i in higher), abs=1e-12)
        expected = [records[found][name] - record[name] for name in objectives.names[1:]]
        assert step.costs == pytest.approx(expected)


def test_between_few_designs_the_step_alone_is_paid():
    front = pd.DataFrame({"trial": [1, 2], "height_m": [0.8, 0.85], "energy_j": [10.0, 13.5]})
    step = one_more(front, 1, HEIGHT_AND_ENERGY, between=True)
    assert step.costs == pytest.approx((3.5 / 5.0,))
    assert "costs 0.7 J of energy (on the straight line to trial 2: 0.850 m on 13.50 J)" in step.text()
    assert one_more(front, 1, HEIGHT_AND_ENERGY).costs == pytest.approx((3.5,))


def test_a_design_exactly_a_step_away_counts():
    front = pd.DataFrame({"trial": [1, 2, 3], "height_m": [0.8, 0.8 + 0.01, 0.9], "energy_j": [10.0, 10.5, 20.0]})
    assert one_more(front, 1, HEIGHT_AND_ENERGY).text() == (
        "one more centimetre of height costs 0.5 J of energy (trial 2: 0.810 m on 10.50 J)"
    )


def test_neighbours_nearer_than_a_step_do_not_decide():
    """Between designs 1 um apart the slope of the front is 100 kJ/m; one more centimetre costs 0.3 J."""
    front = pd.DataFrame({"trial": [1, 2, 3], "height_m": [0.8, 0.800001, 0.81], "energy_j": [10.0, 10.1, 10.3]})
    assert one_more(front, 1, HEIGHT_AND_ENERGY).costs == pytest.approx((0.3,))


@pytest.mark.parametrize(
    ("first", "values", "words"),
    [
        ("mass_kg", [4.0, 3.6, 3.0], "0.1 kg less mass takes 0.1 m of height (trial 2"),
        ("energy_j", [60.0, 58.0, 20.0], "1 J less energy takes 0.1 m of height (trial 2"),
        ("efficiency", [0.3, 0.4, 0.7], "1 % more efficiency takes 0.1 m of height (trial 2"),
    ],
)
def test_other_objectives_have_a_step_that_crosses_the_front_in_ten_or_more(first, values, words):
    front = pd.DataFrame({"trial": [1, 2, 3], first: values, "height_m": [1.0, 0.9, 0.5]})
    step = one_more(front, 1, Objectives(names=(first, "height_m")))
    assert step.text().startswith(words)
    assert 0.0 < step.step <= 0.1 * np.ptp(values)


def test_what_gets_better_is_saved():
    front = pd.DataFrame(
        {"trial": [1, 2], "height_m": [0.8, 0.9], "electrical_energy_j": [10.0, 12.0], "mass_kg": [4.0, 3.5]}
    )
    assert "costs 2 J of energy from the battery and saves 0.5 kg of mass" in one_more(front, 1, THREE).text()


def test_a_front_of_one_design_has_no_step():
    front = pd.DataFrame({"trial": [1], "mass_kg": [4.0], "height_m": [0.8]})
    assert one_more(front, 1, Objectives(names=("mass_kg", "height_m"))).trial is None
