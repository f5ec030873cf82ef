"""Scans of the surrogate-assisted search, against designs written out by hand."""

import numpy as np
import pytest

from pareto_monoped.search.algorithm import Gear, MotorChoice, MotorKind, Space
from pareto_monoped.search.variation import scans, spread
from tests.search.gears import ALIKE


def gears(*ratios):
    return tuple(Gear(ratio=ratio, mass_kg=0.4 + 0.01 * ratio, **ALIKE) for ratio in ratios)


SPACE = Space(
    names=("thigh_length_m", "shank_length_m", "knee_ratio", "hip_ratio", "damping_n_s_per_m"),
    lower=np.array([0.3, 0.3, 0.0, 0.0, 0.7]),
    upper=np.array([0.5, 0.45, 3.0, 2.0, 2.9]),
    gears={"knee_ratio": gears(4.0, 5.0, 6.0, 7.0), "hip_ratio": gears(4.4, 5.5, 8.7)},
)
MOTORS = tuple(
    MotorKind(
        name=name,
        peak_torque_n_m=torque,
        no_load_speed_rad_per_s=40.0,
        gears={"knee_ratio": gears(*ratios), "hip_ratio": gears(*ratios)},
    )
    for name, torque, ratios in (("A", 10.0, (4.0, 5.0, 6.0)), ("B", 20.0, (4.5, 5.5, 6.5, 7.5, 8.5)))
)
BY_MOTOR = Space(
    names=("knee_ratio", "hip_ratio", "motor"),
    lower=np.zeros(3),
    upper=np.ones(3),
    choices=(MotorChoice(name="motor", motors=MOTORS),),
)


def test_a_scan_moves_one_variable_to_both_its_bounds_and_between():
    designs = spread(SPACE, 50, np.random.default_rng(1))
    found = scans(SPACE, designs, np.random.default_rng(2)).reshape(50, 5, 3, 5)
    for design, moved in zip(designs, found, strict=True):
        for column in range(5):
            others = [k for k in range(5) if k != column]
            assert (moved[column][:, others] == design[others]).all()
    numbers = found[:, [0, 1, 4], :, [0, 1, 4]]
    bounds = np.column_stack((SPACE.lower, SPACE.upper))[[0, 1, 4]]
    # To the last bit: 0.7 + 1.0 * (2.9 - 0.7) is not 2.9.
    assert (numbers[:, :, :2] == bounds[:, None]).all()
    between = numbers[:, :, 2]
    assert (between > bounds[:, :1]).all()
    assert (between < bounds[:, 1:]).all()
    shares = (between - bounds[:, :1]) / np.diff(bounds)
    assert shares.mean() == pytest.approx(0.5, abs=0.1)
    for column, count in ((2, 4), (3, 3)):
        counted = np.bincount(found[:, column, :, column].ravel().astype(int), minlength=count)
        assert len(counted) == count
        assert counted.min() > 150 / count / 2


def test_a_scan_tries_gearboxes_of_the_motor_and_other_motors():
    designs = spread(BY_MOTOR, 60, np.random.default_rng(3))
    found = scans(BY_MOTOR, designs, np.random.default_rng(4))
    assert (BY_MOTOR.snap(found) == found).all()
    rows = found.reshape(60, 3, 3, 3)
    assert set(rows[:, 2, :, 2].ravel()) == {0.0, 1.0}
    last = designs[:, 2] == 1.0
    assert set(rows[last, 0, :, 0].ravel()) == {0.0, 0.25, 0.5, 0.75, 1.0}
    assert set(rows[~last, 0, :, 0].ravel()) == {0.0, 0.5, 1.0}
    # None more often than others: a list has no bounds.
    assert (rows[last, 0, :, 0] == 0.0).mean() < 0.3
    assert (rows[:, 0, :, 1:] == designs[:, None, 1:]).all()
