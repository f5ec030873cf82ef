"""A front that is followed is the front of all designs."""

import numpy as np
import pytest

from pareto_monoped.pareto.front import GrowingFront, front_mask
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives


def added(objectives, values, sizes):
    """The front that has followed ``values``, added in parts of these sizes over and over."""
    front, done, k = GrowingFront(objectives), 0, 0
    while done < len(values):
        end = min(done + sizes[k % len(sizes)], len(values))
        front.add(np.arange(done, end), values[done:end])
        done, k = end, k + 1
    return front


@pytest.mark.parametrize(
    "names", [("height_m", "energy_j"), ("energy_j", "mass_kg"), ("height_m", "energy_j", "mass_kg")]
)
@pytest.mark.parametrize("kind", ["rough", "converged", "with equal values", "not finite"])
@pytest.mark.parametrize("sizes", [(1,), (7, 40), (1000,), (0, 3)])
def test_it_holds_the_front_of_all(names, kind, sizes):
    generator, objectives = np.random.default_rng(5), Objectives(names=names)
    values = generator.uniform(0.5, 1.0, (600, len(names)))
    if kind == "converged":  # nearly all designs are on the front
        angle = generator.uniform(0.0, np.pi / 2.0, 600)
        columns = np.column_stack((np.cos(angle), np.sin(angle), generator.uniform(0.0, 1.0, 600)))[:, : len(names)]
        values = -objectives.signs * columns
    elif kind == "with equal values":
        values = np.round(values, 1)
    elif kind == "not finite":
        values[generator.integers(0, 600, 200), generator.integers(0, len(names), 200)] = np.nan
    mask = front_mask(values, objectives)
    front = added(objectives, values, sizes)
    assert len(front) == mask.sum() > 0
    assert front.numbers.tolist() == np.flatnonzero(mask).tolist()
    ordered = values[mask] if len(names) > 2 else values[mask][np.argsort(objectives.minimised(values[mask])[:, 0])]
    assert np.array_equal(front.values, ordered)


def test_an_empty_front_has_values_of_every_objective():
    front = GrowingFront(HEIGHT_AND_ENERGY)
    front.add(np.zeros(0, dtype=np.int64), np.zeros((0, 2)))
    assert front.values.shape == (0, 2)
    assert len(front) == 0
