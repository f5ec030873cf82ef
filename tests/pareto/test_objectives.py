import numpy as np
import pytest

from pareto_monoped.measures import MEASURES
from pareto_monoped.pareto.front import best_at_height
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives

THREE = Objectives(names=("mass_kg", "height_m", "efficiency"))


def test_less_is_better_after_the_sign():
    values = np.array([[4.0, 1.0, 0.5]])
    assert THREE.minimised(values).tolist() == [[4.0, -1.0, -0.5]]
    assert values.tolist() == [[4.0, 1.0, 0.5]]
    assert THREE.directions == {"mass_kg": "minimise", "height_m": "maximise", "efficiency": "maximise"}


def test_in_words_each_has_its_unit():
    assert HEIGHT_AND_ENERGY.text([0.8, 15.36]) == "0.800 m on 15.36 J"
    assert THREE.text([4.0, 1.0, 0.512]) == "mass 4.000 kg, height 1.000 m, efficiency 51.2 %"
    hip_and_knee = Objectives(names=("peak_torque_hip_n_m", "peak_torque_knee_n_m"))
    assert hip_and_knee.text([9.0, 30.0]) == "peak torque, hip 9.0 N m; peak torque, knee 30.0 N m"
    assert (THREE.volume_unit, HEIGHT_AND_ENERGY.volume_unit) == ("kg m", "m J")


def test_every_measure_with_a_direction_may_be_an_objective():
    """It has a corner for the hypervolume; one that is maximised counts from there upward."""
    for entry in MEASURES:
        assert (entry.reference is None) == (entry.direction is None), entry.name


def test_the_best_at_a_height_is_that_of_the_first_other_objective():
    values = np.array([[4.2, 0.9, 0.4], [3.9, 0.8, 0.5], [3.5, 0.79, 0.6]])
    best = best_at_height(values, THREE)
    assert (best.measure.name, best.value, best.text()) == ("mass_kg", 3.9, "3.900 kg at 0.8 m")
    assert best_at_height(values, THREE, 1.0).text() == "1 m not reached"
    assert best_at_height(values[:, :2], Objectives(names=("mass_kg", "energy_j"))) is None
    more = best_at_height(values[:, [1, 2]], Objectives(names=("height_m", "efficiency")))
    assert more.value == pytest.approx(0.5)
