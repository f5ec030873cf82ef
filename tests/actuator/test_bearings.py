import numpy as np
import pytest

from pareto_monoped.actuator.bearings import catalogue, main_bearing, small_bearing


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
