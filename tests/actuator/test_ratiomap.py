"""Looking up ratios: half-open intervals, floating point, and ratios that no gearbox has."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.actuator.judge import interval_tenths
from pareto_monoped.actuator.ratiomap import either
from pareto_monoped.actuator.search import map_for
from pareto_monoped.errors import DesignError


def test_a_ratio_gets_its_intervals_gearbox_with_its_real_ratio(vt_map):
    assert vt_map.lookup(7.9).ratio == pytest.approx(174 / 22)
    assert vt_map.lookup(7.95) is vt_map.lookup(7.9)
    assert vt_map.lookup(8.0).ratio == 8.0
    assert vt_map.lookup(6.0).ratio == 6.0
    assert vt_map.lookup(8.7).ratio == pytest.approx(8.7)


@pytest.mark.parametrize("tenths", range(40, 88))
def test_every_lower_end_belongs_to_its_own_interval(vt_map, tenths):
    """Also where 10 x the float is a hair below the whole number."""
    for ratio in (tenths / 10, tenths * 0.1, 4.0 + (tenths - 40) * 0.1):
        assert vt_map.interval_index([ratio]).tolist() == [tenths - 40]


def test_every_interval_with_a_gearbox_gives_it_the_first_and_the_last_as_well(vt_map):
    for k, entry in enumerate(vt_map.entries):
        if entry.actuator is not None:
            assert vt_map.lookup(4.05 + 0.1 * k) is entry.actuator
    assert vt_map.entries[0].actuator is not None


@pytest.mark.parametrize("tenths", range(41, 88))
def test_the_interval_below_ends_5e_10_before_its_upper_end(vt_map, tenths):
    """The documented rounding at an interval's edges: closer than that, a ratio counts to the next interval."""
    edge = tenths / 10
    ratios = [edge - 1e-3, edge - 1e-6, edge - 6e-10, edge - 4e-10, edge, edge + 4e-10, edge + 1e-3]
    below, above = tenths - 41, tenths - 40
    assert vt_map.interval_index(ratios).tolist() == [below] * 3 + [above] * 4


def test_the_ends_of_the_map_are_rounded_in_the_same_way(vt_map):
    assert vt_map.interval_index([4.0 - 4e-10, 4.0 - 6e-10]).tolist() == [0, -1]
    assert vt_map.interval_index([8.8 - 6e-10, 8.8 - 4e-10]).tolist() == [47, -1]
    with pytest.raises(DesignError, match=r"no gearbox in \[9\.3, 9\.4\)"):
        vt_map.lookup(9.3 - 4e-10)
    with pytest.raises(DesignError, match=r"no gearbox in \[9\.2, 9\.3\)"):
        vt_map.lookup(9.3 - 6e-10)


@given(ratio=st.floats(4.0, 8.7999))
def test_the_real_ratio_lies_in_the_interval_asked_for(ratio):
    found = map_for("VT8020", "paper")
    index = int(found.interval_index([ratio])[0])
    entry = found.entries[index]
    real = entry.actuator.ratio
    assert entry.ratio_low <= real + 1e-12
    assert real < entry.ratio_low + 0.1
    assert abs(real - ratio) < 0.1 + 1e-9


@given(sun=st.integers(12, 200), planet=st.integers(12, 500))
def test_intervals_of_tooth_sets_are_exact(sun, planet):
    ring = sun + 2 * planet
    low = int(interval_tenths(np.array([sun]), np.array([ring]))[0])
    assert Fraction(low, 10) <= Fraction(sun + ring, sun) < Fraction(low + 1, 10)


def test_outside_is_minus_one(vt_map):
    values = [3.999, 8.8, 9.3, 14.99, 15.0, 1e9, -4.0, 0.0, np.nan, np.inf, -np.inf]
    assert vt_map.interval_index(values).tolist() == [-1] * len(values)


@pytest.mark.parametrize("ratio", [3.9, 15.0, float("nan"), -1.0, float("inf")])
def test_outside_the_map_is_said_in_one_line(vt_map, ratio):
    with pytest.raises(
        DesignError, match=r"gear ratio = .*outside the map of VT8020.*4 up to.*15.*choose \[4.0, 8.8\)"
    ):
        vt_map.lookup(ratio)


def test_no_gearbox_names_the_constraint_and_the_cure(vt_map):
    with pytest.raises(DesignError, match=r"9\.3.*no gearbox in \[9\.3, 9\.4\).*ESSPG: sun_rim.*choose \[4\.0, 8\.8\)"):
        vt_map.lookup(9.3)


def test_curves_of_the_figure(vt_map):
    both = vt_map.masses_kg()
    assert both.shape == vt_map.ratios_low.shape == (110,)
    inside, outside = vt_map.masses_kg("ISSPG"), vt_map.masses_kg("ESSPG")
    assert np.array_equal(both, np.fmin(inside, outside), equal_nan=True)
    for entry, mass in zip(vt_map.entries, both, strict=True):
        assert (entry.actuator is None) == bool(np.isnan(mass))


def test_the_map_is_made_once():
    assert map_for("VT8020") is map_for("VT8020")


@pytest.mark.parametrize(("choices", "text"), [(["a"], "a"), (["a", "b"], "a or b"), (["a", "b", "c"], "a, b or c")])
def test_choices_are_listed_as_in_a_sentence(choices, text):
    assert either(choices) == text
