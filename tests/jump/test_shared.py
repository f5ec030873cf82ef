"""Jumps that an executor shares out are those of one process, to the last bit and wherever they are cut."""

import json
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pareto_monoped.actuator.motors import load_motor, motor_names, stored_motor
from pareto_monoped.actuator.ratiomap import JointMaps
from pareto_monoped.actuator.search import build_map, map_for
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.compute.chunks import Pace
from pareto_monoped.design import LOWER, NAMES, UPPER, complete
from pareto_monoped.errors import InputError
from pareto_monoped.jump.audit import audit, finer, judge
from pareto_monoped.jump.calibration import calibration_names, load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.screen import screened
from pareto_monoped.jump.shared import SharedEvaluator, built, evaluator_of, setup_text
from pareto_monoped.uncertainty.samples import sobol_samples, variations
from pareto_monoped.uncertainty.settings import load_uncertainty

REFERENCE = load_calibration("reference")
DESIGNS = complete(np.random.default_rng(7).uniform(LOWER, UPPER, size=(6, len(LOWER))))
SAMPLES = 4


@pytest.fixture(scope="module")
def pool():
    with ThreadPoolExecutor(2) as pool:
        yield pool


@pytest.fixture(scope="module")
def maps():
    """Two kits of motors."""
    first, second = map_for("VT8020"), map_for("U8")
    return JointMaps(hip=first, knee=first), JointMaps(hip=second, knee=first)


@pytest.fixture(scope="module")
def alone(maps):
    """Designs with nonsense among them, each in some samples: their arguments and what one evaluator makes of them."""
    designs = DESIGNS.copy()
    designs[3, 0] = np.nan
    values, motors = np.repeat(designs, SAMPLES, axis=0), np.repeat([0, 1, 0, 1, 1, 0], SAMPLES)
    varied = variations(sobol_samples(load_uncertainty(), SAMPLES), len(designs), REFERENCE)
    found = Evaluator(maps[0], REFERENCE, 2, others=maps[1:])(values, motors, variations=varied)
    assert set(found.status) >= {"ok", "bad_input"}
    return values, motors, varied, found


def assert_equal(one, other):
    for field in fields(one):
        here, there = getattr(one, field.name), getattr(other, field.name)
        if isinstance(here, np.ndarray):
            np.testing.assert_array_equal(here, there, err_msg=field.name)
        else:
            assert here == there, field.name


class Cut(Pace):
    def __init__(self, places):
        super().__init__()
        self.places = places

    def cuts(self, start, stop):
        return [start, *(place for place in self.places if start < place < stop), stop]


@settings(max_examples=4)
@given(places=st.sets(st.integers(1, len(DESIGNS) * SAMPLES - 1), max_size=9))
def test_wherever_they_are_cut_jumps_are_the_same(maps, alone, pool, places):
    values, motors, varied, found = alone
    shared = SharedEvaluator(maps[0], REFERENCE, others=maps[1:], executor=pool, pace=Cut(sorted(places)))
    assert_equal(shared(values, motors, variations=varied), found)


def test_no_designs_need_no_executor(maps, pool):
    assert len(SharedEvaluator(maps[0], REFERENCE, executor=pool)(np.zeros((0, 7)))) == 0


@pytest.mark.parametrize("brief", [pytest.param(True, marks=pytest.mark.long), False])
def test_an_audit_is_the_same(maps, pool, brief):
    here = audit(DESIGNS[:3], maps[0], REFERENCE, workers=2, perturbations=2, brief=brief)
    assert_equal(here, audit(DESIGNS[:3], maps[0], REFERENCE, executor=pool, perturbations=2, brief=brief))


def test_designs_that_do_not_jump_are_left_out_of_what_is_judged(maps, pool):
    """The first design stays on the floor; the others keep their own judgement."""
    designs = DESIGNS[:3].copy()
    designs[0, [NAMES.index("stiffness_n_per_m"), NAMES.index("damping_n_s_per_m")]] = 0.0, 1e4
    known = Evaluator(maps[0], REFERENCE, 2)(designs)
    assert known.ok.tolist() == [False, True, True]
    here = judge(designs, maps[0], REFERENCE, known)
    assert_equal(here, judge(designs, maps[0], REFERENCE, known, executor=pool))
    np.testing.assert_allclose(here.mujoco_height_m[1:], known.height_m[1:], atol=1e-6)


def test_a_screen_is_the_same(maps, pool):
    known = Evaluator(maps[0], REFERENCE, 2)(DESIGNS)
    assert_equal(
        screened(DESIGNS, maps[0], REFERENCE, known), screened(DESIGNS, maps[0], REFERENCE, known, executor=pool)
    )


@pytest.mark.parametrize("name", calibration_names())
def test_a_calibration_arrives_as_it_was_sent(maps, name):
    for calibration in (load_calibration(name), finer(load_calibration(name), 4)):
        kits, there = built(setup_text(maps, calibration))
        assert there == calibration
        assert kits[0].hip is kits[0].knee is kits[1].knee
        assert [kit.label for kit in kits] == [kit.label for kit in maps]


@pytest.mark.parametrize("name", motor_names())
def test_a_motor_arrives_as_it_was_sent(name):
    made = replace(map_for("U8"), motor=load_motor(name))
    ((sent, rules),) = json.loads(setup_text([made], REFERENCE))["motors"]
    assert stored_motor(sent, source="test") == load_motor(name)
    assert rules == made.settings.rules


def test_a_map_with_settings_of_its_own_is_refused(pool):
    own = build_map(load_motor("U8"), ActuatorSettings(rules="paper", planets_max=3))
    with pytest.raises(InputError, match=r"actuator map of U8: was built with settings of its own.*without an exec"):
        evaluator_of(own, REFERENCE, executor=pool)
