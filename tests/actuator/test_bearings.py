import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from pareto_monoped.actuator.bearings import (
    catalogue,
    iso_281_rating_n,
    main_bearing,
    rated_bearings,
    read_bearings,
    small_bearing,
)
from pareto_monoped.errors import InputError


def test_catalogue_is_sorted_and_plausible():
    table = catalogue()
    assert (np.diff(table[:, 0]) > 0).all()
    ring_mm3 = np.pi / 4 * (table[:, 1] ** 2 - table[:, 0] ** 2) * table[:, 2]
    filling = table[:, 3] / (ring_mm3 * 7.8e-6)
    assert ((filling > 0.45) & (filling < 0.95)).all()


@pytest.mark.parametrize(
    ("bore", "chosen"),
    [(40.0, 40.0), (40.0000000001, 40.0), (40.01, 45.0), (37.0, 40.0), (26.0, 30.0), (31.0, 35.0), (10.5, 12.0)],
)
def test_main_bearing_is_the_lightest_that_fits(bore, chosen):
    """The heavy 28 and 32 mm types (96 and 122 g) are passed over for lighter, larger ones."""
    assert main_bearing(bore).inner_diameter_mm == chosen
    fitting = [row for row in catalogue() if row[0] >= bore - 1e-9]
    assert main_bearing(bore).mass_kg == min(row[3] for row in fitting)


def test_beyond_the_catalogue_there_is_none():
    found = main_bearing(np.array([40.0, 161.0]))
    assert np.isnan(found.mass_kg).tolist() == [False, True]


def test_the_regression_has_its_minimum_near_40_mm():
    """What the paper's own fit does, and why its smallest gearboxes are not the lightest."""
    bores = catalogue()[1:, 0]
    masses = main_bearing(bores, "regression").mass_kg
    kept = main_bearing(bores).inner_diameter_mm
    assert 30.0 <= kept[np.argmin(masses)] <= 45.0
    plain = np.polynomial.Polynomial.fit(catalogue()[1:, 0], catalogue()[1:, 3], 2)
    assert masses == pytest.approx(plain(kept), rel=1e-9)


def test_small_bearings_are_in_the_catalogue():
    assert small_bearing(10.0).outer_diameter_mm == 19.0
    assert small_bearing(6.0).outer_diameter_mm == 15.0


GROOVE, YOUNGS_MPA, POISSON = 0.52, 207e3, 0.3


def hertz_pressure_mpa(force_n, ball_mm, gamma, side):
    """Largest pressure between a ball and a ring by the exact elliptic integrals; side +1: inner ring, -1: outer."""
    along = 2.0 / ball_mm + side * 2.0 * gamma / (1.0 - side * gamma) / ball_mm
    across = 2.0 / ball_mm - 1.0 / (GROOVE * ball_mm)
    total, difference = along + across, (along - across) / (along + across)

    def mismatch(k):
        first, second = ellipk(1.0 - k**-2), ellipe(1.0 - k**-2)
        return ((k**2 + 1.0) * second - 2.0 * first) / ((k**2 - 1.0) * second) - difference

    k = brentq(mismatch, 1.0001, 300.0)
    second = ellipe(1.0 - k**-2)
    long_axis, short_axis = (2.0 * k**2 * second / np.pi) ** (1 / 3), (2.0 * second / (np.pi * k)) ** (1 / 3)
    scale = (3.0 * force_n / total * (1.0 - POISSON**2) / YOUNGS_MPA) ** (1 / 3)
    return 1.5 * force_n / (np.pi * long_axis * short_axis * scale**2)


@pytest.mark.parametrize("bearing", rated_bearings(), ids=lambda bearing: bearing.designation)
def test_static_rating_presses_the_worst_ball_with_4200_mpa(bearing):
    """ISO 76: C0 is the radial load under which the most loaded ball, with 5 / Z of it, is pressed with 4200 MPa."""
    force_n = 5.0 * bearing.static_rating_n / bearing.balls
    gamma = bearing.ball_diameter_mm / bearing.pitch_diameter_mm
    pressure = max(hertz_pressure_mpa(force_n, bearing.ball_diameter_mm, gamma, side) for side in (1, -1))
    assert pressure == pytest.approx(4200.0, rel=0.005)  # the third root of 1.5 percent in C0


# f_c of ISO 281, table 2, single-row deep groove bearings, over Dw / Dpw.
FC = {0.05: 46.7, 0.06: 49.1, 0.08: 52.8, 0.10: 55.5, 0.12: 57.5, 0.14: 58.8, 0.16: 59.6, 0.20: 59.9}


@pytest.mark.parametrize(("gamma", "factor"), FC.items())
def test_the_dynamic_rating_has_the_factor_of_the_standard_s_table(gamma, factor):
    assert iso_281_rating_n(12, 8.0, 8.0 / gamma) == pytest.approx(1.3 * factor * 12 ** (2 / 3) * 8.0**1.8, rel=0.01)


@pytest.mark.parametrize("bearing", rated_bearings(), ids=lambda bearing: bearing.designation)
def test_dynamic_ratings_are_those_of_their_balls(bearing):
    gamma = bearing.ball_diameter_mm / bearing.pitch_diameter_mm
    factor = np.interp(gamma, list(FC), list(FC.values()))
    rating = 1.3 * factor * bearing.balls ** (2 / 3) * bearing.ball_diameter_mm**1.8
    if gamma <= 0.2:
        assert bearing.dynamic_rating_n == pytest.approx(rating, rel=0.02)
    # Balls of one row keep a cage between them.
    assert 0.5 < bearing.balls * bearing.ball_diameter_mm / (np.pi * bearing.pitch_diameter_mm) < 0.6


def test_ratings_are_those_of_the_maker_s_table():
    """Three rows of NSK's catalogue, read independently: 6808, 6811, 60/28."""
    found = {bearing.designation: (bearing.dynamic_rating_n, bearing.static_rating_n) for bearing in rated_bearings()}
    assert found["6808"] == (6350.0, 5550.0)
    assert found["6811"] == (8800.0, 8500.0)
    assert found["60/28"] == (12500.0, 7400.0)


HEAD = (
    "inner_diameter_mm,outer_diameter_mm,width_mm,mass_kg,designation,dynamic_rating_n,static_rating_n,balls,"
    "ball_diameter_mm\n"
)
GOOD = "40,52,7,0.031,6808,6350,5550,21,3.969\n"


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ("40,52,7,0.031,6808,63500,5550,21,3.969\n", ("bearing 6808: dynamic_rating_n = 63500.0", "6314", "ISO 281")),
        ("40,52,7,0.031,6808,6350,555,21,3.969\n", ("bearing 6808: static_rating_n = 555.0", "ISO 76")),
        ("40,52,7,0.031,6808,6350,5550,60,3.969\n", ("bearing 6808: balls = 60", "5 to 36")),
        ("40,52,7,0.031,6808,6350,5550,21,6.5\n", ("bearing 6808: ball_diameter_mm = 6.5", "between 0 and 6")),
        (GOOD + GOOD, ("bearing 6808: inner_diameter_mm = 40.0", "more than the 40")),
    ],
)
def test_a_row_that_contradicts_itself_is_refused_in_one_line(row, words):
    assert len(read_bearings(HEAD + GOOD)) == 1
    with pytest.raises(InputError) as caught:
        read_bearings(HEAD + row)
    assert "\n" not in str(caught.value)
    for word in words:
        assert word in str(caught.value)
