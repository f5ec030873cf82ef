"""Traced numbers: they are what floats would be, they know how they were made, and their text says it."""

import math
import random

import numpy as np
import pytest

from pareto_monoped.cad.write import formulas
from pareto_monoped.cad.write.drivers import Trace, tracing
from pareto_monoped.cad.write.equations import Writer
from pareto_monoped.cad.write.formulas import Traced, conditions, driver
from pareto_monoped.geometry import tightening
from pareto_monoped.geometry.screws import M3
from pareto_monoped.geometry.tightening import thread_size
from pareto_monoped.leg import thigh

NAMES = {"arcsin": math.asin, "asin": math.asin, "acos": math.acos, "atan": math.atan, "atan2": math.atan2} | {
    name: getattr(math, name) for name in ("sin", "cos", "tan", "sqrt", "hypot", "ceil", "floor", "pi", "radians")
}


@pytest.fixture(autouse=True)
def fresh():
    formulas.forget()


def text(value):
    return Writer(Trace()).text(value)


def grown(rng, given, depth):
    """The same random expression of floats and of traced numbers."""
    if depth == 0:
        if rng.random() < 0.3:
            constant = rng.choice([0.5, 2.0, -1.0, 0.0, 3.0, np.pi / 6.0])
            return constant, constant
        name = rng.choice(list(given))
        return given[name], driver(name, given[name])
    (a, x), (b, y) = grown(rng, given, depth - 1), grown(rng, given, depth - 1)
    kind = rng.randrange(9)
    if kind < 4:
        operator = [lambda p, q: p + q, lambda p, q: p - q, lambda p, q: p * q, lambda p, q: p / (1.0 + q * q)][kind]
        return operator(a, b), operator(x, y)
    if kind < 8:
        function = [np.maximum, np.minimum, np.hypot, lambda p, q: np.where(p > q, p, q - 1.0)[()]][kind - 4]
        return function(a, b), function(x, y)
    return np.sin(a) - np.square(b), np.sin(x) - np.square(y)


@pytest.mark.parametrize("seed", range(60))
def test_random_formulas_have_the_value_of_floats_and_their_text_has_it_too(seed):
    rng = random.Random(seed)
    given = {name: rng.uniform(-3.0, 3.0) for name in ("a", "b", "c")}
    plain, traced = grown(rng, given, 4)
    assert float(traced) == pytest.approx(float(plain), rel=1e-9, abs=1e-9)
    assert eval(text(traced), NAMES | given) == pytest.approx(float(plain), rel=1e-9, abs=1e-9)  # noqa: S307


def test_equal_operations_are_one_number_and_constants_are_drawn_together():
    a, b = driver("a", 3.0), driver("b", 4.0)
    assert (a + b) * 2.0 is (a + b) * 2.0
    assert 0.5 * (2.0 * a) is a
    assert text(a + 1.0 - 3.0 + b) == "a - 2 + b"
    assert text(a - (b - 1.0)) == "a - (b - 1)"
    assert text(-(0.5 * a) * b) == "-a * b / 2"
    assert text(np.radians(30.0) * a) == "pi / 6 * a"
    assert text((2.0 * driver("x", 3.0)) * (2.0 * driver("y", 5.0))) == "4 * x * y"


def test_a_branch_is_noted_with_what_it_depended_on():
    a = driver("a", 3.0)
    assert bool(a < 5.0) is True
    assert a != 2.0
    ((first, holds), (second, _)) = conditions()
    assert (text(first), holds, text(second)) == ("a < 5", True, "a != 2")
    # No branch, but a number that depends on it.
    assert text(np.where(a > 2.0, a, 7.0)) == "a if a > 2 else 7"
    assert len(conditions()) == 2


def test_what_has_no_rule_falls_back_to_plain_numbers():
    a = driver("a", 0.3)
    assert not isinstance(np.arctanh(a), Traced)
    assert np.arctanh(a) == pytest.approx(np.arctanh(0.3))
    assert np.interp(a, [0.0, 1.0], [0.0, 10.0]) == pytest.approx(3.0)
    np.testing.assert_allclose(np.array([1.0, 2.0]) * a, [0.3, 0.6])


def test_the_package_is_as_before_when_a_trace_ends_also_after_an_error():
    before, screw = dict(vars(thigh)), M3
    thread_size.cache_clear()
    with tracing(Trace()):
        assert isinstance(thigh._KNEE_END, Traced)
        assert isinstance(tightening.thread_size(driver("d", 3.0)).diameter_mm, Traced)
    assert type(thread_size(3.0).diameter_mm) is float
    with pytest.raises(KeyError), tracing(Trace()):
        raise KeyError
    assert vars(thigh) == before
    assert thigh.M3 is screw
    assert type(thigh._KNEE_END) is float
