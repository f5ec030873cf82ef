from types import SimpleNamespace

import pytest

from pareto_monoped.cli.robustness import _cells
from pareto_monoped.measures import measure


@pytest.mark.parametrize(("name", "times"), [("efficiency", 100.0), ("height_m", 1.0)])
def test_values_of_the_table_are_in_the_unit_that_its_head_shows(name, times):
    entry = measure(name)
    assert ("%" in entry.shown_unit) == (times == 100.0)
    result = SimpleNamespace(measures={name: SimpleNamespace(mean=0.5, p05=0.25, p95=0.75)})
    assert [float(cell) for cell in _cells(result, entry).split()] == [0.5 * times, 0.25 * times, 0.75 * times]
