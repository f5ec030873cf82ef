"""The front against the definition of dominance, written out as a double loop."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from pareto_monoped.pareto.front import front_mask

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
    assert front_mask(height_m, energy_j, feasible).tolist() == _by_definition(height_m, energy_j, feasible)


def test_leaves_its_inputs_alone():
    height_m, energy_j, feasible = np.array([1.0, 2.0]), np.array([3.0, 4.0]), np.array([True, True])
    front_mask(height_m, energy_j, feasible)
    assert height_m.tolist() == [1.0, 2.0]
    assert energy_j.tolist() == [3.0, 4.0]
    assert feasible.tolist() == [True, True]


def test_an_infeasible_design_dominates_nothing():
    mask = front_mask(np.array([2.0, 1.0]), np.array([1.0, 1.0]), np.array([False, True]))
    assert mask.tolist() == [False, True]
