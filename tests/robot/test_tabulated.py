"""Tables of mass properties are the functions they were made of."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.geometry.parts import MassProperties
from pareto_monoped.robot.tables import tabulate

LOW_M, HIGH_M = 0.25, 0.55


def rods(lengths_m):
    """A slender rod of 2 kg/m hanging along -z, and a point of 0.3 kg at (1 / length, 0, length): closed forms."""
    n = len(lengths_m)
    rod_first, rod_second = np.zeros((n, 3)), np.zeros((n, 3, 3))
    rod_first[:, 2] = -(lengths_m**2)
    rod_second[:, 2, 2] = 2.0 * lengths_m**3 / 3.0
    place = np.stack([1.0 / lengths_m, np.zeros(n), lengths_m], axis=1)
    return (
        MassProperties(mass_kg=2.0 * lengths_m, first_kg_m=rod_first, second_kg_m2=rod_second),
        MassProperties(
            mass_kg=np.full(n, 0.3), first_kg_m=0.3 * place, second_kg_m2=0.3 * place[:, :, None] * place[:, None, :]
        ),
    )


@pytest.fixture(scope="module")
def table():
    return tabulate(rods, LOW_M, HIGH_M)


@given(lengths=st.lists(st.floats(LOW_M, HIGH_M), min_size=1, max_size=50))
def test_a_table_is_the_function(table, lengths):
    lengths_m = np.array(lengths)
    assert np.all(table.covers(lengths_m))
    for found, exact in zip(table(lengths_m), rods(lengths_m), strict=True):
        np.testing.assert_allclose(found.mass_kg, exact.mass_kg, rtol=1e-12)
        np.testing.assert_allclose(found.first_kg_m, exact.first_kg_m, rtol=0, atol=1e-12)
        np.testing.assert_allclose(found.second_kg_m2, exact.second_kg_m2, rtol=0, atol=1e-11)


@pytest.mark.parametrize("rows", [[3], [3, 1], list(range(29, -1, -1)), [3] * 100])
def test_a_row_is_the_same_to_the_last_bit_in_any_company(table, rows):
    lengths_m = np.random.default_rng(1).uniform(LOW_M, HIGH_M, 30)
    for everyone, some in zip(table(lengths_m), table(lengths_m[rows]), strict=True):
        for name in ("mass_kg", "first_kg_m", "second_kg_m2"):
            assert np.array_equal(getattr(everyone, name)[rows], getattr(some, name)), name


def test_a_count_that_depends_on_the_length_is_refused():
    def with_rungs(lengths_m):
        (rod, _) = rods(lengths_m)
        return (rod.scaled(np.floor(lengths_m / 0.03)),)

    with pytest.raises(ValueError, match="not smooth in the length"):
        tabulate(with_rungs, LOW_M, HIGH_M)


def test_a_length_beyond_the_ends_is_not_covered(table):
    assert table.covers(np.array([0.2499, 0.25, 0.55, 0.5501])).tolist() == [False, True, True, False]
