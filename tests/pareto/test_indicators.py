"""Indicators against areas and distances worked out by hand."""

import itertools
import math

import moocore
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.measures import measure
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives, hypervolume, reference_point

REFERENCE = reference_point(HEIGHT_AND_ENERGY, {"height_m": 0.5, "energy_j": 10.0})


def test_hypervolume_of_one_point_is_a_rectangle():
    assert hypervolume(np.array([[0.8, 4.0]]), REFERENCE) == pytest.approx(0.3 * 6.0, rel=1e-14)


def test_hypervolume_of_two_points_is_a_staircase():
    points = np.array([[0.8, 4.0], [1.0, 7.0]])
    assert hypervolume(points, REFERENCE) == pytest.approx(0.3 * 6.0 + 0.2 * 3.0, rel=1e-14)


@pytest.mark.parametrize("point", [[0.5, 4.0], [0.4, 4.0], [0.8, 10.0], [0.8, 11.0]])
def test_points_that_do_not_dominate_the_reference_add_nothing(point):
    assert hypervolume(np.array([point]), REFERENCE) == 0.0
    assert hypervolume(np.array([[0.8, 4.0], point]), REFERENCE) == pytest.approx(1.8, rel=1e-14)


def test_no_points_have_no_hypervolume():
    assert hypervolume(np.zeros((0, 2)), REFERENCE) == 0.0


points = st.lists(st.tuples(st.floats(0.51, 2.0), st.floats(0.1, 9.9)), min_size=1, max_size=8)


@given(points, st.floats(0.51, 2.0), st.floats(0.1, 9.9))
def test_one_more_point_never_shrinks_the_hypervolume(given_points, height_m, energy_j):
    before = np.array(given_points)
    after = np.vstack((before, [height_m, energy_j]))
    assert hypervolume(after, REFERENCE) >= hypervolume(before, REFERENCE) - 1e-12


THREE = Objectives(names=("height_m", "electrical_energy_j", "mass_kg"))
CORNER = reference_point(THREE, {"height_m": 0.5, "electrical_energy_j": 10.0, "mass_kg": 5.0})


def volume_by_cells(designs, corner):
    """The dominated volume, cell by cell of the grid through all coordinates: each cell is in or out."""
    less = [(-height, energy, mass) for height, energy, mass in designs]
    end = (-corner[0], corner[1], corner[2])
    axes = [sorted({point[k] for point in less if point[k] < end[k]} | {end[k]}) for k in range(3)]
    total = 0.0
    for cell in itertools.product(*(range(len(axis) - 1) for axis in axes)):
        low = [axes[k][cell[k]] for k in range(3)]
        if any(all(point[k] <= low[k] for k in range(3)) for point in less):
            total += math.prod(axes[k][cell[k] + 1] - axes[k][cell[k]] for k in range(3))
    return total


triples = st.lists(st.tuples(st.floats(0.3, 2.0), st.floats(0.1, 12.0), st.floats(1.0, 6.0)), max_size=7)


@given(triples)
def test_hypervolume_of_three_objectives_is_the_sum_of_its_cells(designs):
    values = np.array(designs).reshape(-1, 3)
    assert hypervolume(values, CORNER) == pytest.approx(volume_by_cells(designs, CORNER.values), rel=1e-9, abs=1e-12)


def test_hypervolume_of_one_design_is_a_box():
    assert hypervolume(np.array([[0.8, 4.0, 3.0]]), CORNER) == pytest.approx(0.3 * 6.0 * 2.0, rel=1e-14)


def test_a_corner_takes_what_is_not_given_from_the_table_of_measures():
    corner = reference_point(THREE, {"mass_kg": 4.0})
    assert corner.as_dict() == {
        "height_m": measure("height_m").reference,
        "electrical_energy_j": measure("electrical_energy_j").reference,
        "mass_kg": 4.0,
    }
    assert reference_point(HEIGHT_AND_ENERGY).text() == "0.55 m, 100 J"


def test_two_objectives_are_summed_as_moocore_sums_them():
    """Equal to the last bit, so that stored hypervolumes and what follows from them stay as they are."""
    generator = np.random.default_rng(7)
    for number in range(300):
        count = int(generator.integers(1, 300))
        points = np.column_stack((generator.uniform(0.5, 2.0, count), generator.uniform(0.0, 10.0, count)))
        if number % 2:  # most of them on a front
            points[:, 1] = 2.0 * points[:, 0] ** 2 + generator.normal(0.0, 1e-3, count)
        if number % 3 == 0:  # many equal
            points = points.round(1)
        inside = points[(points[:, 0] > 0.5) & (points[:, 1] < 10.0)] * [-1.0, 1.0]
        expected = moocore.hypervolume(inside, ref=[-0.5, 10.0]) if len(inside) else 0.0
        assert hypervolume(points, REFERENCE) == expected
