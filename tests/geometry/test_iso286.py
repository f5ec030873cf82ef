"""Limits of ISO 286: printed limits of common fits, the standard's own formula for tolerances, and refusals."""

import re
from itertools import pairwise

import numpy as np
import pytest

from pareto_monoped.errors import DesignError
from pareto_monoped.geometry.making import interference_mm, limits

# Limits in micrometres as they are printed in tables of common fits (Roloff/Matek, tables 2-2 and 2-3; ISO 286-2).
PRINTED = {
    (6.0, "m6"): (4, 12),
    (6.0, "H7"): (0, 12),
    (8.0, "g6"): (-14, -5),
    (10.0, "N7"): (-19, -4),
    (15.0, "J7"): (-8, 10),
    (14.0, "R6"): (-31, -20),
    (30.0, "R6"): (-37, -24),
    (20.0, "h6"): (-13, 0),
    (25.0, "k6"): (2, 15),
    (32.0, "J7"): (-11, 14),
    (40.0, "p6"): (26, 42),
    (50.0, "F7"): (25, 50),
    (52.0, "J7"): (-12, 18),
    (60.0, "n6"): (20, 39),
    (100.0, "f6"): (-58, -36),
    (2.5, "m6"): (2, 8),
    (2.5, "G7"): (2, 12),
}


@pytest.mark.parametrize(("size", "printed"), PRINTED.items())
def test_limits_are_those_of_printed_tables(size, printed):
    found = limits(*size)
    assert (1e3 * found.lower_mm, 1e3 * found.upper_mm) == pytest.approx(printed)


@pytest.mark.parametrize(("zone", "units"), [("h6", 10.0), ("H7", 16.0)])
def test_tolerances_follow_the_standard_s_formula(zone, units):
    """ISO 286-1: 10 and 16 times i = 0.45 D^(1/3) + 0.001 D, with D the geometric mean of the range."""
    bounds = [3.0, 6.0, 10.0, 18.0, 30.0, 50.0, 80.0, 120.0]
    for low, high in pairwise(bounds):
        mean = np.sqrt(low * high)
        formula_um = units * (0.45 * mean ** (1.0 / 3.0) + 0.001 * mean)
        found = limits(high, zone)
        assert 1e3 * (found.upper_mm - found.lower_mm) == pytest.approx(formula_um, abs=1.0)  # rounded


def test_wide_tolerances_are_ten_times_those_of_five_grades_below():
    """From IT6 on (ISO 286-1, table 1). IT8 is 25 i, rounded."""

    def width_um(zone):
        return 1e3 * (limits(high, zone).upper_mm - limits(high, zone).lower_mm)

    for low, high in pairwise([1.0, 3.0, 6.0, 10.0, 18.0, 30.0, 50.0, 80.0, 120.0]):
        mean = np.sqrt(low * high)
        assert width_um("h13") == pytest.approx(10.0 * round(25.0 * (0.45 * mean ** (1.0 / 3.0) + 0.001 * mean)))
        assert width_um("h12") == pytest.approx(10.0 * width_um("H7"))


def test_a_size_at_the_end_of_a_range_belongs_to_it():
    assert limits(6.0, "m6") != limits(6.01, "m6")


def test_interference_is_shaft_less_hole():
    assert interference_mm(6.0, "H7", "m6") == pytest.approx((-0.008, 0.012))
    assert interference_mm(52.0, "J7", "h6") == pytest.approx((-0.018 - 0.019, 0.012))


@pytest.mark.parametrize(
    ("size", "message"),
    [
        ((6.0, "H8"), "tolerance class = 'H8': must be one of F7, G7, H7, J7, N7, f6"),
        ((0.0, "H7"), "diameter 0 mm of H7: must be above 0 and at most 120 mm"),
        ((130.0, "H7"), "diameter 130 mm of H7: must be above 0 and at most 120 mm"),
    ],
)
def test_what_is_not_in_the_tables_is_refused(size, message):
    with pytest.raises(DesignError, match="^" + re.escape(message)):
        limits(*size)
