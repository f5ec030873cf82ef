"""Needle rollers: number, choice of rows, ratings against the standards' tables."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.actuator.needles import (
    dynamic_rating_n,
    needle_count,
    needle_rows,
    read_roller_bearings,
    roller_bearing,
    static_rating_n,
)
from pareto_monoped.actuator.planet_bearings import _ring_kind, _stacked
from pareto_monoped.actuator.search import map_for
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.errors import InputError

SETTINGS = ActuatorSettings(rules="iso6336")


def test_as_many_needles_as_fit_side_by_side():
    assert needle_count(6.0, 1.5) == 15
    # 15 needles leave less than one needle's width free, 16 would not close the circle.
    assert 15 * 2.0 * np.arcsin(1.5 / 7.5) < 2.0 * np.pi < 16 * 2.0 * np.arcsin(1.5 / 7.5)


def test_f_c_is_that_of_the_standard_s_table():
    """ISO 281, table 7: 88.7 at most, 84 at 0.1 within the formula's 2 percent."""

    def f_c(gamma):
        return dynamic_rating_n(1, gamma, 1.0, 1.0) / (1.1 * gamma ** (29.0 / 27.0))

    assert max(f_c(g) for g in np.linspace(0.05, 0.4, 200)) == pytest.approx(88.7, rel=2e-3)
    assert f_c(0.1) == pytest.approx(84.0, rel=0.02)


@given(st.floats(6.0, 40.0), st.floats(6.0, 40.0))
def test_a_wider_planet_never_has_weaker_needles(one, other):
    low, high = sorted((one, other))
    narrow, wide = needle_rows(low, SETTINGS), needle_rows(high, SETTINGS)
    assert wide.total_mm >= narrow.total_mm
    assert narrow.total_mm <= low
    both = needle_rows(np.array([low, high]), SETTINGS)
    assert both.dynamic_rating_n.tolist() == [narrow.dynamic_rating_n, wide.dynamic_rating_n]


def test_rows_at_the_edges_of_the_catalogue():
    assert np.isnan(needle_rows(5.7, SETTINGS).total_mm)
    assert (needle_rows(5.8, SETTINGS).rows, needle_rows(5.8, SETTINGS).length_mm) == (1, 5.8)
    assert (needle_rows(15.6, SETTINGS).rows, needle_rows(15.6, SETTINGS).length_mm) == (2, 7.8)
    assert needle_rows(100.0, SETTINGS).total_mm == pytest.approx(27.6)


def test_two_rows_carry_less_than_twice_one_but_twice_when_at_rest():
    assert dynamic_rating_n(15, 1.5, 10.0, 7.5) == pytest.approx(2.0 ** (7 / 9) * dynamic_rating_n(15, 1.5, 5.0, 7.5))
    assert static_rating_n(15, 1.5, 10.0, 7.5) == pytest.approx(2.0 * static_rating_n(15, 1.5, 5.0, 7.5))


def test_the_catalogue_s_bearing_and_what_is_refused():
    bearing = roller_bearing("HK1210")
    assert (bearing.inner_diameter_mm, bearing.outer_diameter_mm, bearing.width_mm) == (12.0, 16.0, 10.0)
    with pytest.raises(InputError, match=r"HK9999.*one of HK1210"):
        roller_bearing("HK9999")
    head = "designation,inner_diameter_mm,outer_diameter_mm,width_mm,mass_kg,dynamic_rating_n,static_rating_n\n"
    for row, words in (
        ("A,16,12,10,0.004,5000,6000", "inner_diameter_mm = 16.0"),
        ("A,12,16,10,0.004,0,6000", "dynamic_rating_n = 0.0"),
    ):
        with pytest.raises(InputError, match=words):
            read_roller_bearings(head + row)


def test_bushes_are_an_option(vt8020):
    from pareto_monoped.actuator.search import build_map
    from pareto_monoped.geometry.roles import Role

    rating = replace(SETTINGS.parts.rating, planet_bearing="bushes")
    few = replace(SETTINGS, parts=replace(SETTINGS.parts, rating=rating), modules_mm=(0.5, 0.6))
    found = build_map(vt8020, few)
    parts = found.lookup(6.0).parts
    assert any(part.role is Role.BUSH for part in parts)
    assert not any(part.name == "planet_needles" for part in parts)


def test_two_rows_stand_at_the_ends_of_the_bore_with_the_spacer_between_them():
    """By hand: rows of 8 mm in a planet from z = 1 to 21 mm leave 4 mm between, in arrays two halves."""
    at = SimpleNamespace(face_width_mm=20.0, z_gear_back=1.0, z_gear_front=21.0)
    needles, spacers, spacer = _stacked(at, SimpleNamespace(rows=2, total_mm=16.0))
    assert ([z for _, _, z in needles], [z for _, _, z in spacers], spacer) == ([1.0, 13.0], [9.0], 4.0)
    needles, spacers, half = _stacked(at, SimpleNamespace(rows=np.array([2]), total_mm=np.array([16.0])))
    assert ([*np.ravel([z for _, _, z in needles])], [*np.ravel([z for _, _, z in spacers])], half) == (
        [1.0, 13.0],
        [9.0, 11.0],
        2.0,
    )


def test_washers_are_ordered_by_the_kind_of_ring_that_has_their_thickness():
    """DIN 988 has hard support rings (S) and soft shims (PS), which the needles would wear; ours are 1.2 mm thick."""
    assert (_ring_kind(1.2), _ring_kind(1.0)) == ("support ring DIN 988 - S", "shim ring DIN 988 - PS")
    (washer,) = (part for part in map_for("VT8020").lookup(6.0).parts if part.name == "planet_washer")
    assert [one.designation for one in washer.purchases] == ["support ring DIN 988 - S 6 x 12 x 1.2"]
