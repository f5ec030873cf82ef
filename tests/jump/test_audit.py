import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.jump.audit import CONTINUOUS, LIMITS, audit, perturbed
from pareto_monoped.jump.calibration import load_calibration
from tests.jump.robots import random_designs

MAP = map_for("VT8020")


def _share_within(designs, name, perturbations):
    found = audit(designs, MAP, load_calibration(name), perturbations=perturbations, workers=2)
    return found, {
        "spread_height_m": np.nanpercentile(found.spread_height_m, 90, method="higher"),
        "spread_energy": np.nanpercentile(found.spread_energy, 90, method="higher"),
        "half_step_height_m": np.nanpercentile(found.half_step_height_m, 90, method="higher"),
        "half_step_energy": np.nanpercentile(found.half_step_energy, 90, method="higher"),
    }


@pytest.mark.parametrize("count", [25, pytest.param(200, marks=pytest.mark.long)])
def test_reference_is_well_conditioned_over_the_whole_space(count):
    found, at_90 = _share_within(random_designs(count, seed=0), "reference", 4)
    assert at_90["spread_height_m"] <= LIMITS.spread_height_m
    assert at_90["spread_energy"] <= LIMITS.spread_energy
    assert at_90["half_step_height_m"] <= LIMITS.step_height_m
    assert at_90["half_step_energy"] <= LIMITS.step_energy
    assert np.nanpercentile(found.energy_balance_error, 90, method="higher") <= LIMITS.balance
    assert found.well_conditioned.mean() >= 0.9


def test_paper_is_not_and_the_audit_says_so():
    found, at_90 = _share_within(random_designs(10, seed=0), "paper", 4)
    assert at_90["half_step_energy"] > LIMITS.step_energy
    bad = np.flatnonzero(~found.well_conditioned)
    assert len(bad) > 5
    assert all(found.reason[i] for i in bad)


def test_columns_have_a_row_a_design():
    designs = np.array([PAPER_CASES["C"].design.as_array(), np.full(7, np.nan)])
    found = audit(designs, MAP, load_calibration(), perturbations=2)
    assert found.well_conditioned.tolist() == [True, False]
    assert found.reason[1] == "no jump: bad_input"
    columns = found.as_columns()
    assert all(len(values) == 2 for values in columns.values())
    assert np.isnan(columns["spread_height_m"][1])


def test_same_seed_same_audit():
    design = PAPER_CASES["C"].design.as_array()
    first, second = (audit(design, MAP, load_calibration(), perturbations=3).as_columns() for _ in range(2))
    for name, values in first.items():
        np.testing.assert_array_equal(values, second[name])


def test_perturbations_are_small_and_leave_the_gearbox_alone():
    design = PAPER_CASES["nominal"].design.as_array()
    copies = perturbed(design, 50, np.random.default_rng(0))
    change = np.abs(copies / design - 1.0)
    assert copies.shape == (50, 7)
    assert 0.0 < change[:, CONTINUOUS].max() <= 1e-6
    np.testing.assert_array_equal(copies[:, 2:4], np.tile(design[2:4], (50, 1)))
