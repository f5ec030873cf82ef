"""The energy balances of many jumps at once against that of one jump after the other."""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import CONTROL, LOWER, UPPER, columns, complete
from pareto_monoped.jump import balance
from pareto_monoped.jump.balance import balanced, energy_balance
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.robot.population import robot_arrays

MAP = map_for("VT8020")
RANDOM = complete(np.random.default_rng(11).uniform(LOWER, UPPER, (30, len(LOWER))))


def one_by_one(designs, calibration):
    return [
        energy_balance(robot_arrays(design, MAP, calibration.mass), columns(design[None], CONTROL), calibration).error
        for design in designs
    ]


def jumping(calibration):
    return RANDOM[Evaluator(MAP, calibration)(RANDOM).ok]


@pytest.mark.parametrize(
    ("name", "most"),
    [
        *(("reference", 2), ("reference-3", 5), ("paper", 5)),
        *(pytest.param(*one, marks=pytest.mark.long) for one in (("reference", 8), ("reference-3", 30), ("paper", 30))),
    ],
)
def test_every_balance_is_that_of_the_jump_alone(name, most):
    calibration = load_calibration(name)
    designs = jumping(calibration)[:most]  # five times the steps where drives are elastic
    assert len(designs) >= min(most, 20)
    errors = balanced(robot_arrays(designs, MAP, calibration.mass), columns(designs, CONTROL), calibration).error
    np.testing.assert_allclose(errors, one_by_one(designs, calibration), rtol=0.0, atol=1e-12)


@pytest.mark.parametrize(("integrator", "read"), [("implicitfast", "half_step_back"), ("RK4", "state")])
def test_so_it_is_with_other_integrators(integrator, read):
    calibration = load_calibration("reference-3")
    simulation = replace(calibration.simulation, integrator=integrator, positions_read=read)
    calibration = replace(calibration, simulation=simulation)
    designs = jumping(calibration)[:3]
    errors = balanced(robot_arrays(designs, MAP, calibration.mass), columns(designs, CONTROL), calibration).error
    np.testing.assert_allclose(errors, one_by_one(designs, calibration), rtol=0.0, atol=1e-12)


def test_a_balance_does_not_depend_on_the_other_jumps_nor_on_the_workers():
    calibration = load_calibration()
    designs = jumping(calibration)[:8]
    robots, control = robot_arrays(designs, MAP, calibration.mass), columns(designs, CONTROL)
    errors = balanced(robots, control, calibration).error
    np.testing.assert_array_equal(errors, balanced(robots, control, calibration, workers=2).error)
    last = robot_arrays(designs[-3:], MAP, calibration.mass)
    np.testing.assert_array_equal(errors[-3:], balanced(last, control[-3:], calibration).error)


def test_no_bit_depends_on_how_many_steps_are_kept_together(monkeypatch):
    calibration = load_calibration()
    designs = jumping(calibration)[:4]
    robots, control = robot_arrays(designs, MAP, calibration.mass), columns(designs, CONTROL)
    errors = balanced(robots, control, calibration).error
    monkeypatch.setattr(balance, "_AT_ONCE", 7)
    np.testing.assert_array_equal(errors, balanced(robots, control, calibration).error)


def test_a_jump_that_goes_wrong_leaves_the_others_alone():
    """Its torque is no number."""
    calibration = load_calibration()
    designs = jumping(calibration)[:3]
    robots, control = robot_arrays(designs, MAP, calibration.mass), columns(designs, CONTROL)
    alone = balanced(robots, control, calibration)
    control[1] = np.nan
    found = balanced(robots, control, calibration)
    assert found.ok.tolist() == [True, False, True]
    for values, known in ((found.error, alone.error), (found.height_m, alone.height_m)):
        np.testing.assert_array_equal(values[found.ok], known[found.ok])
