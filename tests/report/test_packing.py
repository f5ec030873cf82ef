import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.report.packing import packed_column
from tests.report.conftest import unpacked

LIMIT = float(np.finfo(np.float32).max) * (1.0 - 2.0**-16)
TINY = float(np.finfo(np.float32).tiny)


@given(st.lists(st.floats(-LIMIT, LIMIT).filter(lambda x: x == 0.0 or abs(x) > TINY), max_size=20))
def test_values_come_back_in_single_precision(values):
    text = packed_column(values)
    assert len(text) == 4 * -(-4 * len(values) // 3)
    assert unpacked(text) == pytest.approx(values, rel=2.0**-24 * 1.01, abs=0.0)


def test_what_is_not_a_number_is_none():
    found = unpacked(packed_column([1.0, np.nan, np.inf, -np.inf, 1e300, 2.0]))
    assert [np.isnan(value) for value in found] == [False, True, True, True, True, False]


def test_three_values_can_be_read_alone():
    values = [0.1, -2.5, 3e4, 1.0, 2.0]
    text = packed_column(values)
    assert unpacked(text[:16]) + unpacked(text[16:]) == pytest.approx(values, rel=1e-7)
