import numpy as np
import pytest

from pareto_monoped.report.packing import column, number


def test_column_keeps_five_digits_and_leaves_out_what_is_no_number():
    values = [123.456789, -0.00123456, 98765.4, 0.0, float("nan"), float("inf")]
    assert column(values) == [123.46, -0.0012346, 98765.0, 0.0, None, None]


@pytest.mark.parametrize("value", np.random.default_rng(0).lognormal(0.0, 4.0, 12))
def test_column_is_off_by_at_most_half_a_digit(value):
    assert column([value])[0] == pytest.approx(value, rel=0.5e-4)


def test_a_number_has_four_decimals_or_is_none():
    assert [number(value) for value in (1.23456, -0.00004, float("nan"), float("inf"))] == [1.2346, 0.0, None, None]
