"""Sums of limits against brute force over all corners, and shares against closed forms."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.geometry.chains import Chain, Link, assembled_share, deviations, link_keys


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


def test_the_share_of_two_equal_limits_is_the_triangle_s():
    """Hole and pin 0 to 0.1 wider: the pin is larger in half of all cases, and by 0.05 in an eighth."""
    places = np.random.default_rng(0).random((200_000, 2))
    links = (link("hole", 1.0, 10.0, 0.0, 0.1), link("pin", -1.0, 10.0, 0.0, 0.1))
    chain = Chain(name="gap", links=links, cure="")
    assert assembled_share((chain,), places) == pytest.approx(0.5, abs=0.005)
    assert assembled_share((replace(chain, least_mm=-0.05),), places) == pytest.approx(7 / 8, abs=0.005)


def test_a_length_deviates_once_in_all_chains_that_it_is_part_of():
    """One chain fits where the length is long, the other where it is short: never both, or always one."""
    long = Chain(name="long", links=(link("a", 1.0, 0.0, -1.0, 1.0),), cure="")
    short = Chain(name="short", links=(link("a", -1.0, 0.0, -1.0, 1.0),), cure="")
    other = Chain(name="other", links=(link("a", -1.0, 0.0, -1.0, 1.0, which=1),), cure="")
    assert len(link_keys((long, short))) == 1
    places = np.random.default_rng(1).random((20_000, 2))
    assert assembled_share((long, short), places[:, :1]) == 0.0
    assert assembled_share((long, other), places) == pytest.approx(0.25, abs=0.01)
