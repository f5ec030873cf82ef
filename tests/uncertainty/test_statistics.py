"""Statistics of samples against the standard library."""

import statistics

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.uncertainty.statistics import robustness
from tests.study.support import made_evaluations


@given(
    st.lists(st.tuples(st.floats(0.5, 2.0), st.booleans()), min_size=2, max_size=40).filter(
        lambda items: sum(ok for _, ok in items) >= 2
    )
)
def test_mean_spread_percentiles_and_shares(items):
    heights, ok = [h for h, _ in items], [o for _, o in items]
    jumps = made_evaluations([0.9, *heights], [5.0] * (len(items) + 1), ["ok", *("ok" if o else "timeout" for o in ok)])
    found = robustness(jumps, slice(1, len(items) + 1), {"gear_safety": 0.0, "link_safety": 0.3})
    kept = sorted(h for h, o in items if o)
    spread = found.measures["height_m"]
    assert spread.mean == pytest.approx(statistics.fmean(kept))
    assert spread.deviation == pytest.approx(statistics.pstdev(kept), abs=1e-12)
    cuts = statistics.quantiles(kept, n=20, method="inclusive")
    assert (spread.p05, spread.p95) == pytest.approx((cuts[0], cuts[-1]))
    assert found.samples == len(items)
    assert found.failed == pytest.approx(ok.count(False) / len(items))
    over = [jumps.gear_safety[i + 1] < 0.0 or jumps.link_safety[i + 1] < 0.3 for i in range(len(items)) if ok[i]]
    assert found.overloaded == pytest.approx(sum(over) / len(items))


def test_a_design_that_never_jumps_has_no_measures():
    found = robustness(made_evaluations([np.nan] * 3, [np.nan] * 3, ["timeout"] * 3), slice(0, 3), {"gear_safety": 1.0})
    assert (found.failed, found.overloaded, found.measures) == (1.0, 0.0, {})
