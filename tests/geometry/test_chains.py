"""Sums of limits against brute force over all corners, and shares against closed forms."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.geometry.chains import Chain, Link, deviations


def link(name, sign, nominal, lower, upper, which=0):
    return Link(part="part", name=name, sign=sign, nominal_mm=nominal, lower_mm=lower, upper_mm=upper, which=which)


LINKS = st.builds(
    lambda sign, nominal, lower, wide: (sign, nominal, lower, lower + wide),
    st.sampled_from((1.0, -1.0, 0.8, -0.3)),
    st.floats(0.0, 20.0),
    st.floats(-0.3, 0.3),
    st.floats(0.0, 0.5),
)


@given(st.lists(LINKS, min_size=1, max_size=6))
def test_the_worst_case_is_the_worst_of_all_corners(rows):
    chain = Chain(name="gap", links=tuple(link(str(k), *row) for k, row in enumerate(rows)), cure="widen it")
    corners = [
        sum(sign * (nominal + off) for (sign, nominal, _, _), off in zip(rows, offs, strict=True))
        for offs in product(*(row[2:] for row in rows))
    ]
    assert chain.worst_mm == pytest.approx((min(corners), max(corners)), abs=1e-9)
    low, high = chain.spread_mm
    assert low <= 0.5 * (min(corners) + max(corners)) + 1e-9 <= high + 2e-9


def test_a_chain_that_ends_at_its_least_gap_does_not_jam():
    chain = Chain(name="gap", links=(link("a", 1.0, 1.0, -0.1, 0.0),), least_mm=0.9, cure="widen it")
    assert not chain.jams
    assert replace(chain, least_mm=0.9 + 1e-6).jams


def test_what_jams_is_told_with_its_lengths_and_its_cure():
    links = (link("web", 1.0, 14.5, 0.0, 0.05), link("face", -1.0, 14.5, -0.05, 0.02))
    chain = Chain(name="float of the planets", links=links, least_mm=0.05, cure="raise washer_play_mm")
    assert chain.jams
    assert chain.text == (
        "float of the planets = -0.020 mm at worst: must be at least 0.05 mm; raise washer_play_mm "
        "(part web 14.5 +0.05 / 0; part face 14.5 +0.02 / -0.05)"
    )
    assert deviations(-0.1, 0.1) == "±0.1"


def test_three_standard_deviations_of_even_limits_are_those_of_samples():
    """The spread is that of a million sums, or the worst case where that is narrower."""
    links = [link(str(k), (-1.0) ** k, 2.0, -0.01 * k, 0.02) for k in range(1, 9)]
    low, high = Chain(name="gap", links=tuple(links), cure="").spread_mm
    places = np.random.default_rng(0).random((1_000_000, 8))
    offs = [one.lower_mm + (one.upper_mm - one.lower_mm) * places[:, k] for k, one in enumerate(links)]
    sums = sum(one.sign * (one.nominal_mm + off) for one, off in zip(links, offs, strict=True))
    assert (low, high) == pytest.approx((sums.mean() - 3 * sums.std(), sums.mean() + 3 * sums.std()), abs=5e-4)
    alone = Chain(name="gap", links=(links[0],), cure="")
    assert alone.spread_mm == alone.worst_mm
