"""docs/limit.md and its script: the stored robots jump as they did, and the page shows their energies."""

import re

import numpy as np
import pytest

from pareto_monoped.design import complete, control_of
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import evaluate_robots
from tests.docs.scripts import ROOT, imported, rows

PAGE = (ROOT / "docs" / "limit.md").read_text(encoding="utf-8")


def test_the_stored_robots_jump_as_they_did():
    """Under ``reference-3``, with the gearboxes of their time, to the last digits."""
    with imported("limit_reference_3") as script:
        designs, stored = complete(np.array(script.STORED["designs"])), script.STORED
        jumps = evaluate_robots(script.stored_robots(designs), control_of(designs), load_calibration("reference-3"))
    for name in ("height_m", "energy_j", "electrical_energy_j"):
        np.testing.assert_allclose(jumps.of(name), stored[name], rtol=1e-9)
    shown = re.findall(r"<!-- made by: python benchmarks/limit_reference_3.py.* -->\n((?:\|.*\n)+)", PAGE)
    for k, row in enumerate(rows(shown[0])[1:]):
        assert row[0] == stored["names"][k]
        assert float(row[1]) == pytest.approx(stored["height_m"][k], abs=6e-4)
        assert float(row[2]) == pytest.approx(stored[stored["energies"][k]][k], abs=6e-3)


def test_both_ways_agree_on_five_designs():
    (shown,) = re.findall(r"<!-- made by: python benchmarks/limit_collocation.py -->\n((?:\|.*\n)+)", PAGE)
    numbers = rows(shown)[1:]
    assert len(numbers) == 5
    for row in numbers:
        search, *collocation = map(float, row[3:6])
        assert search / min(collocation) == pytest.approx(1.0, abs=0.02)


def test_the_tracking_law_holds_on_robots_as_built():
    """At least 95 percent of them reach 95 percent of the height, with two motors; torques over time reach fewer."""
    (shown,) = re.findall(r"<!-- made by: python benchmarks/limit_as_built.py -->\n((?:\|.*\n)+)", PAGE)
    numbers = rows(shown)[1:]
    assert len(numbers) >= 5
    assert len({row[0].split(",")[0] for row in numbers}) == 2
    for row in numbers:
        _, over_time, tracking = map(float, row[7].split(" / "))
        assert tracking >= 95.0 > over_time
        assert float(row[8].split(" / ")[2]) >= 95.0
        weak_over_time, weak = map(float, row[4].split(" / "))
        assert abs(weak) < 0.5 * abs(weak_over_time)
