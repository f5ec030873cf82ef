"""Sobol samples: balanced, within their ranges, the same for every design and every time."""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.errors import InputError
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.uncertainty.samples import DIMENSIONS, sobol_samples, variations
from pareto_monoped.uncertainty.settings import Range, load_uncertainty

UNCERTAINTY = load_uncertainty()
CALIBRATION = load_calibration("reference")


def test_every_range_is_filled_evenly():
    """Of 2^k Sobol points each of 2^k equal intervals of every axis holds exactly one."""
    samples = sobol_samples(UNCERTAINTY, 64, seed=3)
    for name, k in DIMENSIONS:
        ends, values = UNCERTAINTY.ranges[name], samples.values[name]
        assert values.shape == (64, k)
        cells = np.floor(64 * (values - ends.lower) / (ends.upper - ends.lower) + 1e-9).astype(int)
        for column in cells.T:
            assert sorted(column) == list(range(64))


def test_the_coordinates_of_all_ranges_are_independent():
    samples = sobol_samples(UNCERTAINTY, 256)
    for columns in (samples.points, np.hstack([samples.values[name] for name, _ in DIMENSIONS])):
        correlation = np.corrcoef(columns.T)
        assert np.abs(correlation - np.eye(len(correlation))).max() < 0.2


def test_the_seed_decides_and_ranges_do_not_move_the_points():
    one, again, other = (sobol_samples(UNCERTAINTY, 16, seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(one.points, again.points)
    assert (one.points != other.points).all()
    wider = replace(UNCERTAINTY, masses=Range(lower=-0.1, upper=0.1, source="x"))
    np.testing.assert_array_equal(sobol_samples(wider, 16).values["gains"], one.values["gains"])
    np.testing.assert_allclose(sobol_samples(wider, 16).values["masses"], 2.0 * one.values["masses"])


@pytest.mark.parametrize("count", [0, -4, 100, 257])
def test_a_count_that_is_no_power_of_two_is_refused(count):
    with pytest.raises(InputError, match="power of two"):
        sobol_samples(UNCERTAINTY, count)


def test_all_designs_have_the_same_variations():
    samples = sobol_samples(UNCERTAINTY, 8)
    found = variations(samples, 3, CALIBRATION)
    assert len(found) == 24
    for field in found.__dataclass_fields__:
        values = getattr(found, field)
        np.testing.assert_array_equal(values[:8], values[8:16])
        np.testing.assert_array_equal(values[:8], values[16:])
    np.testing.assert_allclose(found.masses[:8], 1.0 + samples.values["masses"])
    np.testing.assert_allclose(found.no_load_speeds[:8], 1.0 + samples.values["battery_voltage"][:, 0])
    np.testing.assert_array_equal(found.delays_s[:8], samples.values["delay_s"][:, 0])


def test_a_delay_beyond_what_the_controller_keeps_is_refused():
    late = replace(UNCERTAINTY, delay_s=Range(lower=0.02, upper=0.02, source="x"))
    with pytest.raises(InputError, match=r"delay_s = 0.02: must be at most 8 control periods"):
        variations(sobol_samples(late, 4), 1, CALIBRATION)


@pytest.mark.parametrize(("periods", "kept"), [(8, True), (9, False)])
def test_a_delay_of_as_many_periods_as_the_controller_keeps_is_the_longest(periods, kept):
    """One more found an empty place among the commands kept, and was no delay at all."""
    simulation = CALIBRATION.simulation
    delay_s = periods * simulation.period_s - simulation.delay_s
    late = sobol_samples(replace(UNCERTAINTY, delay_s=Range(lower=delay_s, upper=delay_s, source="x")), 4)
    if kept:
        assert variations(late, 1, CALIBRATION).delays_s == pytest.approx(delay_s)
    else:
        with pytest.raises(InputError, match="must be at most 8 control periods"):
            variations(late, 1, CALIBRATION)
