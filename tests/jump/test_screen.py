"""The screen before an audit: its measures against single jumps, and its verdicts against full audits."""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.jump.audit import LIMITS, Jumps, audit, perturbed
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.screen import CLEAR, Screened, coarser, screened
from tests.jump.robots import random_designs

MAP = map_for("VT8020")
DESIGNS = random_designs(16, seed=8)
MOST = {limit.name: limit.most for limit in LIMITS}


def timed(name="reference", **settings):
    calibration = load_calibration(name)
    return replace(calibration, simulation=replace(calibration.simulation, **settings))


def known(designs, calibration):
    found = Evaluator(MAP, calibration)(designs)
    return Jumps(status=found.status, height_m=found.height_m, energy_j=found.energy_j)


def test_the_coarse_jump_has_twice_the_step_and_the_period_where_it_can():
    """Five steps in a period are no even number."""
    for name, step_s in (("reference", 4e-4), ("reference-3", 2e-3)):
        doubled = coarser(load_calibration(name)).simulation
        assert (doubled.timestep_s, doubled.period_s) == (step_s, 2e-3)
    kept = coarser(timed(timestep_s=5e-4)).simulation
    assert (kept.timestep_s, kept.period_s) == (1e-3, 1e-3)


def test_where_one_coarse_jump_does_not_tell_enough_there_is_none():
    assert coarser(load_calibration("paper")) is None  # its gate switches
    assert coarser(timed(delay_s=1e-3)) is None
    assert coarser(timed(delay_s=2e-3)) is not None
    unknown = screened(DESIGNS, MAP, load_calibration("paper"), known(DESIGNS, load_calibration("paper")))
    assert np.isnan(unknown.double_step_energy).all()
    assert not unknown.clear.any()


def test_its_measures_are_those_of_single_jumps():
    calibration = load_calibration()
    base = known(DESIGNS, calibration)
    found = screened(DESIGNS, MAP, calibration, base, seed=3)
    simulation = replace(calibration.simulation, timestep_s=4e-4, control_period_s=2e-3)
    coarse = replace(calibration, simulation=simulation)
    for i in np.flatnonzero(base.ok)[:6]:
        copy = perturbed(DESIGNS[i], 1, np.random.default_rng(3))
        jump = Evaluator(MAP, coarse)(copy)
        assert found.double_step_height_m[i] == abs(jump.height_m[0] - base.height_m[i]) > 0.0
        assert found.double_step_energy[i] == abs(jump.energy_j[0] / base.energy_j[i] - 1.0) > 0.0


def test_a_screen_does_not_depend_on_the_other_designs_nor_on_the_workers():
    calibration = load_calibration()
    base = known(DESIGNS, calibration)
    whole = screened(DESIGNS, MAP, calibration, base, workers=2).as_columns()
    last = screened(DESIGNS[-5:], MAP, calibration, known(DESIGNS[-5:], calibration)).as_columns()
    for name, values in whole.items():
        np.testing.assert_array_equal(values[-5:], last[name])


@pytest.mark.parametrize(
    ("settings", "count"),
    [
        ({}, 12),
        ({"name": "reference-3", "timestep_s": 4e-3, "control_period_s": 4e-3}, 12),
        pytest.param({}, 300, marks=pytest.mark.long),
    ],
)
def test_a_clear_design_passes_its_full_audit(settings, count):
    """Under the reference nearly all are clear; rigid drives at 4 ms mostly fail their audit, and none is clear."""
    calibration, designs = timed(**settings), random_designs(count, seed=9)
    base = known(designs, calibration)
    clear = screened(designs, MAP, calibration, base, workers=2).clear
    good = audit(designs, MAP, calibration, known=base, workers=2).well_conditioned
    assert not (clear & ~good).any()
    if settings:
        assert good[base.ok].mean() < 0.5
    else:
        assert clear[base.ok].mean() >= 0.9


def test_each_measure_alone_can_ask_for_an_audit():
    limits = [CLEAR[name] * MOST[name] for name in ("half_step_height_m", "half_step_energy")]
    rows = np.tile(limits, (5, 1))
    rows[[1, 2], [0, 1]] *= 1.001
    rows[3], rows[4, 0] = np.nan, np.inf
    height, energy = rows.T
    found = Screened(double_step_height_m=height, double_step_energy=energy)
    assert found.clear.tolist() == [True, False, False, False, False]


def test_a_design_that_does_not_jump_is_not_screened():
    designs = np.vstack((DESIGNS[:1], np.full(DESIGNS.shape[1], np.nan)))
    found = screened(designs, MAP, load_calibration(), known(designs, load_calibration()))
    assert found.clear.tolist() == [True, False]


def test_a_coarse_jump_that_is_lost_has_changed_without_limit():
    """A step of 16 ms loses jumps that one of 8 ms makes."""
    calibration = timed("reference-3", timestep_s=8e-3, control_period_s=8e-3)
    base = known(DESIGNS, calibration)
    found = screened(DESIGNS, MAP, calibration, base)
    copies = np.vstack([perturbed(design, 1, np.random.default_rng(0)) for design in DESIGNS])
    coarse = Evaluator(MAP, coarser(calibration))(copies)
    lost = np.isinf(found.double_step_height_m)
    assert lost.sum() >= 3
    # Evaluations step on for a while after the apex and count what fails there, too.
    assert not coarse.ok[lost].any()
    assert not found.clear[lost].any()
