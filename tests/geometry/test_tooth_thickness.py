"""The table of tolerances, for one gear and for many at once."""

import numpy as np
import pytest

from pareto_monoped.geometry.making import GENERAL_SERIES, RATED_SERIES, thickness_tolerance_mm


@pytest.mark.parametrize(
    ("series", "expected"),
    [
        (GENERAL_SERIES, [0.012, 0.012, 0.020, 0.020, 0.025, 0.025, 0.030, 0.030]),
        (RATED_SERIES, [0.008, 0.008, 0.012, 0.012, 0.016, 0.016, 0.020, 0.020]),
    ],
)
def test_tolerance_is_that_of_the_size_and_the_last_one_beyond(series, expected):
    sizes = np.array([5.0, 10.0, 10.1, 50.0, 50.1, 125.0, 125.1, 300.0])
    assert thickness_tolerance_mm(sizes, series).tolist() == expected
    assert [float(thickness_tolerance_mm(size, series)) for size in sizes] == expected
