"""The control period and the integrator's step are two things; a delay shifts what the drivers do."""

from dataclasses import asdict, replace
from itertools import pairwise

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.errors import CalibrationError
from pareto_monoped.jump import calibration, controller
from pareto_monoped.jump.calibration import calibration_of, load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.single import simulate

REFERENCE = load_calibration("reference")
CASES = np.array([case.design.as_array() for case in PAPER_CASES.values()])


def timed(**changes):
    return replace(REFERENCE, simulation=replace(REFERENCE.simulation, **changes))


def jump(calibration):
    return Evaluator(map_for("VT8020"), calibration)(CASES)


def test_a_period_of_one_step_is_no_period_of_its_own():
    plain, named = jump(REFERENCE), jump(timed(control_period_s=1e-3))
    for name, values in plain.as_columns().items():
        np.testing.assert_array_equal(values, named.as_columns()[name], err_msg=name)


def test_a_finer_step_keeps_the_held_torques():
    """With the period held, halving the step converges linearly, to another jump than a finer period does."""
    held = [jump(timed(timestep_s=1e-3 / n, control_period_s=1e-3)).energy_j for n in (1, 2, 4, 8)]
    faster = jump(timed(timestep_s=1e-3 / 8)).energy_j
    changes = [np.abs(b / a - 1.0).max() for a, b in pairwise(held)]
    assert changes[0] < 0.006
    for coarse, fine in pairwise(changes):
        assert 0.4 < fine / coarse < 0.6
    assert np.all(np.abs(faster / held[-1] - 1.0) > 4.0 * changes[-1])


def test_motor_torque_changes_only_with_the_period():
    calibration = timed(timestep_s=2.5e-4, control_period_s=1e-3)
    trace = simulate(PAPER_CASES["C"].design, map_for("VT8020"), calibration, trace=True).trace
    torque = trace["knee_motor_torque_n_m"]
    changed = np.flatnonzero(np.diff(torque) != 0.0) + 1
    assert len(changed) > 50
    assert np.all(changed % 4 == 0)


@pytest.mark.parametrize("periods", [1, 3, 8])
def test_a_delay_shifts_the_first_torque(periods):
    calibration = timed(delay_s=periods * 1e-3)
    trace = simulate(PAPER_CASES["C"].design, map_for("VT8020"), calibration, trace=True).trace
    torque = trace["knee_motor_torque_n_m"]
    assert np.all(torque[:periods] == 0.0)
    assert torque[periods] != 0.0


def test_the_driver_works_off_commands_under_way_after_lift_off():
    """A late command acts in the air: the torque ends as many periods later as the delay is long."""
    for periods in (0, 3):
        trace = simulate(PAPER_CASES["C"].design, map_for("VT8020"), timed(delay_s=periods * 1e-3), trace=True).trace
        off = int(np.flatnonzero(trace["foot_clearance_m"] >= REFERENCE.gate.length_m)[0])
        last = int(np.flatnonzero(trace["knee_motor_torque_n_m"])[-1])
        assert last == off - 1 + periods


def test_each_millisecond_of_delay_costs_no_more_than_it_may():
    heights = np.array([jump(timed(delay_s=k * 1e-3)).height_m for k in range(4)])
    assert np.all(np.isfinite(heights))
    assert np.abs(np.diff(heights, axis=0)).max() < 0.05


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"control_period_s": 1.5e-3}, "whole multiple"),
        ({"control_period_s": 5e-4}, "whole multiple"),
        ({"delay_s": 1.5e-3}, "whole control periods"),
        ({"delay_s": 9e-3}, "0 to 8"),
    ],
)
def test_periods_that_do_not_fit_are_refused(changes, complaint):
    values = asdict(REFERENCE)
    values["simulation"] |= changes
    with pytest.raises(CalibrationError, match=complaint):
        calibration_of(values, source="test")


def test_a_calibration_allows_as_much_delay_as_the_controller_keeps_commands():
    """The limit stands in both files: importing the controller imports numba, and reading a calibration must not."""
    assert calibration.MOST_DELAY == controller.MOST_DELAY
