"""The front against the definition of dominance, written out as a double loop."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from pareto_monoped.pareto.front import front_mask
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives

# Few distinct values, so that ties are common.
_values = st.sampled_from([0.0, 0.5, 1.0, 1.5, np.nan, np.inf, -1.0])


def _by_definition(height_m, energy_j, feasible):
    n = len(height_m)
    ok = [feasible[i] and np.isfinite(height_m[i]) and np.isfinite(energy_j[i]) for i in range(n)]
    mask = []
    for i in range(n):
        beaten = False
        for j in range(n):
            if not ok[j] or j == i:
                continue
            at_least = height_m[j] >= height_m[i] and energy_j[j] <= energy_j[i]
            better = height_m[j] > height_m[i] or energy_j[j] < energy_j[i]
            beaten = beaten or (at_least and (better or j < i))
        mask.append(ok[i] and not beaten)
    return mask


@given(st.integers(0, 12).flatmap(lambda n: st.tuples(*(arrays(float, n, elements=_values),) * 2, arrays(bool, n))))
def test_is_the_definition_of_dominance(columns):
    height_m, energy_j, feasible = columns
    values = np.column_stack((height_m, energy_j))
    assert front_mask(values, HEIGHT_AND_ENERGY, feasible).tolist() == _by_definition(height_m, energy_j, feasible)


THREE = Objectives(names=("height_m", "electrical_energy_j", "mass_kg"))


@given(st.integers(0, 14).flatmap(lambda n: st.tuples(arrays(float, (n, 3), elements=_values), arrays(bool, n))))
def test_of_three_objectives_it_is_the_definition_too(columns):
    values, feasible = columns
    ok = feasible & np.isfinite(values).all(axis=1)
    less = [[-height, energy, mass] for height, energy, mass in values.tolist()]

    def dominates(j, i):
        at_least = all(a <= b for a, b in zip(less[j], less[i], strict=True))
        return ok[j] and j != i and at_least and (less[j] != less[i] or j < i)

    n = len(values)
    expected = [bool(ok[i]) and not any(dominates(j, i) for j in range(n)) for i in range(n)]
    assert front_mask(values, THREE, feasible).tolist() == expected


def test_the_directions_decide():
    values = np.array([[1.0, 2.0], [2.0, 1.0], [2.0, 2.0], [1.0, 1.0]])
    cheap_and_light = Objectives(names=("electrical_energy_j", "mass_kg"))
    assert front_mask(values, cheap_and_light).tolist() == [False, False, False, True]
    assert front_mask(values, HEIGHT_AND_ENERGY).tolist() == [False, True, False, False]
    both_more = Objectives(names=("height_m", "efficiency"))
    assert front_mask(values, both_more).tolist() == [False, False, True, False]


def test_leaves_its_inputs_alone():
    values, feasible = np.array([[1.0, 3.0], [2.0, 4.0]]), np.array([True, True])
    front_mask(values, HEIGHT_AND_ENERGY, feasible)
    assert values.tolist() == [[1.0, 3.0], [2.0, 4.0]]
    assert feasible.tolist() == [True, True]


def test_an_infeasible_design_dominates_nothing():
    mask = front_mask(np.array([[2.0, 1.0], [1.0, 1.0]]), HEIGHT_AND_ENERGY, np.array([False, True]))
    assert mask.tolist() == [False, True]
