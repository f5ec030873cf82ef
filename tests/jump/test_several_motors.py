"""Designs with several motors in one batch: each jumps to the last bit as in a batch of its own motor alone."""

from functools import reduce

import numpy as np
import pytest

from pareto_monoped.actuator.motors import load_motor
from pareto_monoped.actuator.search import map_of
from pareto_monoped.design import LOWER, UPPER
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.variations import joined, take
from pareto_monoped.measures import MEASURE_NAMES
from pareto_monoped.robot.population import robot_arrays
from pareto_monoped.strength.groups import GROUP_MEASURES

NAMES = ("VT8020", "MN8014", "U8")


@pytest.fixture(scope="module")
def maps():
    return [map_of(load_motor(name), "iso6336") for name in NAMES]


def drawn(count, seed=1):
    generator = np.random.default_rng(seed)
    designs = generator.uniform(LOWER, UPPER, (count, len(LOWER)))
    designs[::17, 0] = np.nan  # bad input, wherever it stands
    return designs, generator.integers(0, len(NAMES), count)


@pytest.mark.parametrize(("calibration", "workers"), [("reference", 2), ("ideal", 1)])
def test_a_mixed_batch_equals_each_motor_s_own(maps, calibration, workers):
    calibration = load_calibration(calibration)
    designs, motors = drawn(40)
    mixed = Evaluator(maps[0], calibration, workers, others=maps[1:])(designs, motors)
    for k, actuator_map in enumerate(maps):
        rows = motors == k
        alone = Evaluator(actuator_map, calibration)(designs[rows])
        assert (mixed.status[rows] == alone.status).all()
        assert [reason for reason, own in zip(mixed.reason, rows, strict=True) if own] == list(alone.reason)
        for name in MEASURE_NAMES:
            assert getattr(mixed, name)[rows].tobytes() == getattr(alone, name).tobytes(), name
        # Strength was computed, and with this motor's gearboxes.
        jumped = alone.status == "ok"
        assert jumped.sum() > 3
        for measure in GROUP_MEASURES.values():
            assert np.isfinite(getattr(alone, measure)[jumped]).all()


def test_the_order_of_a_mixed_batch_does_not_matter(maps):
    calibration = load_calibration("reference")
    designs, motors = drawn(30, seed=2)
    evaluator = Evaluator(maps[0], calibration, others=maps[1:])
    order = np.random.default_rng(3).permutation(len(designs))
    straight, shuffled = evaluator(designs, motors), evaluator(designs[order], motors[order])
    for name in MEASURE_NAMES:
        assert getattr(straight, name)[order].tobytes() == getattr(shuffled, name).tobytes()


def test_without_motors_all_have_the_first(maps):
    calibration = load_calibration("reference")
    designs = drawn(20)[0]
    several, one = (Evaluator(maps[2], calibration, others=others)(designs) for others in (maps[:2], ()))
    assert several.height_m.tobytes() == one.height_m.tobytes()


def test_joined_rows_come_apart_as_they_were(maps):
    designs = drawn(40)[0][1:17]
    robots = [robot_arrays(designs, maps[k]) for k in (1, 2)]
    assert reduce(lambda a, b: a == b, (population.stops for population in robots))
    together = joined(robots)
    assert len(together) == 32
    for k, robot in enumerate(robots):
        back = take(together, np.arange(16 * k, 16 * k + 16))
        assert back.body_inertia_kg_m2.tobytes() == robot.body_inertia_kg_m2.tobytes()
        assert back.reason == robot.reason
    assert joined(robots[:1]) is robots[0]
