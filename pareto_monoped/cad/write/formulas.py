"""Numbers that remember how they were computed.

A ``Traced`` is a float, so that the code that gives parts their dimensions takes it for one. Arithmetic, NumPy's
functions and comparisons on it return further ones, each with its operation and operands; equal operations give the
same object. What has no rule here falls back to plain numbers, which stand in formulas as constants.
"""

import math
import operator
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

_made: dict[tuple[Any, ...], "Traced"] = {}
_guards: dict[tuple[Any, ...], tuple["Condition", bool]] = {}
_CALLS: Mapping[str, Callable[..., float]] = {
    "sin": math.sin, "cos": math.cos, "tan": math.tan, "arcsin": math.asin, "arccos": math.acos, "arctan": math.atan,
    "arctan2": math.atan2, "sqrt": math.sqrt, "hypot": math.hypot, "ceil": math.ceil, "floor": math.floor,
    "round": round, "abs": abs, "max": max, "min": min, "mod": operator.mod, "pow": operator.pow,
}  # fmt: skip
_COMPARED: Mapping[str, Callable[[Any, Any], bool]] = {
    "<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge, "==": operator.eq, "!=": operator.ne,
}  # fmt: skip
OPPOSITE: Mapping[str, str] = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "=="}


def forget() -> None:
    """Begin a new trace: forget all numbers and conditions."""
    _made.clear()
    _guards.clear()


def conditions() -> list[tuple["Condition", bool]]:
    """Return all comparisons on which the code branched so far, each with its outcome."""
    return list(_guards.values())


def bare(value: Any) -> Any:
    """Return a value without its memory."""
    if isinstance(value, list | tuple):
        return type(value)(map(bare, value))
    return float(value) if isinstance(value, Traced) else value.holds if isinstance(value, Condition) else value


class _Scalar:
    """What ``Traced`` and ``Condition`` have in common: NumPy hands its functions over to them."""

    __slots__ = ()
    ndim, size = 0, 1
    shape: tuple[int, ...] = ()

    def __getitem__(self, index: tuple[()]) -> "_Scalar":
        return self

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **_: Any) -> Any:
        rule = _UFUNCS.get(ufunc.__name__)
        if rule is None or any(isinstance(one, np.ndarray) and one.ndim for one in inputs):
            return getattr(ufunc, method)(*map(bare, inputs))
        return rule(*(one.item() if isinstance(one, np.ndarray | np.generic) else one for one in inputs))

    def __array_function__(self, function: Any, _: Any, inputs: tuple[Any, ...], keywords: dict[str, Any]) -> Any:
        rule = _FUNCTIONS.get(function.__name__)
        return rule(*inputs, **keywords) if rule is not None else function(*map(bare, inputs), **keywords)


class Condition(_Scalar):
    """A comparison of traced numbers, or several; its truth is noted when the code branches on it."""

    __slots__ = ("args", "holds", "op")

    def __init__(self, op: str, holds: bool, *args: Any) -> None:
        self.op, self.holds, self.args = op, bool(holds), args

    def __bool__(self) -> bool:
        _guards.setdefault(_key(self), (self, self.holds))
        return self.holds

    def __and__(self, other: Any) -> Any:
        if isinstance(other, Condition):
            return Condition("and", self.holds and other.holds, self, other)
        return self if other else False

    def __or__(self, other: Any) -> Any:
        if isinstance(other, Condition):
            return Condition("or", self.holds or other.holds, self, other)
        return True if other else self

    def __invert__(self) -> "Condition":
        return Condition("not", not self.holds, self)

    __rand__, __ror__ = __and__, __or__


class Traced(_Scalar, float):
    """A number with its operation and operands; a driver has the operation ``driver`` and its name.

    Sums with a constant are ``plus``, products with one ``scale``. Operators are set below.
    """

    __slots__ = ("args", "op")
    op: str
    args: tuple[Any, ...]

    def __round__(self, digits: Any = None) -> Any:
        return call("round", self) if not digits else round(float(self), digits)

    __hash__ = float.__hash__

    def astype(self, kind: Any) -> Any:
        """Return a plain number of another type."""
        return np.asarray(float(self)).astype(kind)[()]


def driver(name: str, value: float) -> Traced:
    """Return a number that is given."""
    return _node("driver", value, name)


def call(name: str, *args: Any) -> Any:
    """Return a function of numbers, traced if one of them is."""
    value = _CALLS[name](*map(float, args))
    if not any(isinstance(arg, Traced) for arg in args):
        return float(value)
    return args[0] if name in ("max", "min") and args[0] is args[1] else _node(name, value, *args)


def _key(value: Any) -> Any:
    """Return what is equal for equal numbers and conditions."""
    if isinstance(value, Condition):
        return (value.op, *map(_key, value.args))
    return id(value) if isinstance(value, Traced) else ("=", value if isinstance(value, str) else float(value))


def _node(op: str, value: float, *args: Any) -> Traced:
    key = (op, *map(_key, args))
    if key not in _made:
        made = float.__new__(Traced, value)
        made.op = op
        made.args = tuple(arg if isinstance(arg, Traced | Condition | str) else float(arg) for arg in args)
        _made[key] = made
    return _made[key]


def _scaled(value: Any) -> tuple[float, Any]:
    """Return a number as a constant times another."""
    return value.args if isinstance(value, Traced) and value.op == "scale" else (1.0, value)


def _clean(value: float) -> float:
    """Return a constant without the rounding of what it was computed from."""
    near = round(value, 12)
    return near if abs(near - value) < 1e-15 else value


def _add(one: Any, other: Any) -> Any:
    if not isinstance(other, Traced):
        one, other = other, one
    value = float(one) + float(other)
    if not isinstance(one, Traced):
        if one == 0.0:
            return other
        if other.op == "plus":
            return _add(other.args[0], _clean(other.args[1] + float(one)))
        return _node("plus", value, other, float(one))
    factor, rest = _scaled(other)
    return _node("sub", value, one, _mul(-factor, rest)) if factor < 0.0 else _node("add", value, one, other)


def _sub(one: Any, other: Any) -> Any:
    if not isinstance(other, Traced):
        return _add(one, -float(other))
    factor, rest = _scaled(other)
    if one is other:
        return 0.0
    if isinstance(one, Traced) and factor < 0.0:
        return _add(one, _mul(-factor, rest))
    if not isinstance(one, Traced) and one == 0.0:
        return _mul(-1.0, other)
    return _node("sub", float(one) - float(other), one, other)


def _mul(one: Any, other: Any) -> Any:
    if not isinstance(other, Traced):
        one, other = other, one
    value = float(one) * float(other)
    if isinstance(one, Traced):
        if one is other:
            return _node("pow", value, one, 2.0)
        (a, x), (b, y) = _scaled(one), _scaled(other)
        return _node("mul", value, one, other) if a * b == 1.0 else _mul(a * b, _mul(x, y))
    factor, rest = _scaled(other)
    factor = _clean(factor * float(one))
    if factor in (0.0, 1.0):
        return rest if factor else 0.0
    return (
        _sub(rest.args[1], rest.args[0]) if factor == -1.0 and rest.op == "sub" else _node("scale", value, factor, rest)
    )


def _div(one: Any, other: Any) -> Any:
    if not isinstance(other, Traced):
        return _mul(_clean(1.0 / float(other)), one)
    return 1.0 if one is other else _node("div", float(one) / float(other), one, other)


def _where(condition: Any, one: Any, other: Any) -> Any:
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return np.where(bare(condition), bare(one), bare(other))
    if not isinstance(condition, Condition):
        chosen = one if condition else other
        return chosen if isinstance(chosen, _Scalar) else np.asarray(chosen)[()]
    same = one is other or (not isinstance(one, Traced) and not isinstance(other, Traced) and one == other)
    return one if same else _node("where", one if condition.holds else other, condition, one, other)


def _calling(name: str) -> Callable[..., Any]:
    return lambda *args: call(name, *args)


def _comparing(op: str) -> Callable[[Any, Any], Any]:
    def compared(one: Any, other: Any) -> Any:
        if not isinstance(one, int | float) or not isinstance(other, int | float | np.number):
            return NotImplemented
        return Condition(op, _COMPARED[op](float(one), float(other)), one, other)

    return compared


def _operator(rule: Callable[..., Any], *, swapped: bool = False) -> Callable[..., Any]:
    def operated(one: Any, other: Any) -> Any:
        if isinstance(other, np.ndarray):
            return NotImplemented
        return rule(other, one) if swapped else rule(one, other)

    return operated


_ARITHMETIC = {
    "add": _add, "sub": _sub, "mul": _mul, "truediv": _div, "mod": _calling("mod"), "pow": _calling("pow"),
    "floordiv": lambda one, other: call("floor", _div(one, other)),
}  # fmt: skip
for _name, _rule in _ARITHMETIC.items():
    setattr(Traced, f"__{_name}__", _operator(_rule))
    setattr(Traced, f"__r{_name}__", _operator(_rule, swapped=True))
for _op, _name in (("<", "lt"), ("<=", "le"), (">", "gt"), (">=", "ge"), ("==", "eq"), ("!=", "ne")):
    setattr(Traced, f"__{_name}__", _comparing(_op))
for _name, _single in (("neg", lambda x: _mul(-1.0, x)), ("pos", lambda x: x), ("abs", _calling("abs"))):
    setattr(Traced, f"__{_name}__", _single)

_UFUNCS: Mapping[str, Callable[..., Any]] = {
    "add": _add, "subtract": _sub, "multiply": _mul, "divide": _div, "negative": operator.neg,
    "square": lambda x: x * x, "power": _calling("pow"), "maximum": _calling("max"), "minimum": _calling("min"),
    "absolute": _calling("abs"), "remainder": _calling("mod"), "rint": _calling("round"),
    "radians": lambda x: _mul(math.pi / 180.0, x), "degrees": lambda x: _mul(180.0 / math.pi, x),
    "bitwise_and": lambda a, b: b & bool(a) if isinstance(b, Condition) else a & b,
    "bitwise_or": lambda a, b: b | bool(a) if isinstance(b, Condition) else a | b,
    "less": _comparing("<"), "less_equal": _comparing("<="), "greater": _comparing(">"),
    "greater_equal": _comparing(">="), "equal": _comparing("=="), "not_equal": _comparing("!="),
    **{name: _calling(name) for name in ("sin", "cos", "tan", "arcsin", "arccos", "arctan", "arctan2", "sqrt", "hypot",
                                         "ceil", "floor")},
}  # fmt: skip
_FUNCTIONS: Mapping[str, Callable[..., Any]] = {
    "where": _where,
    "clip": lambda x, low, high: call("max", low, call("min", x, high)),
    "round": _calling("round"),
    "ndim": lambda _: 0,
    "shape": lambda _: (),
    "any": lambda x: x if isinstance(x, Condition) else x != 0.0,
    "all": lambda x: x if isinstance(x, Condition) else x != 0.0,
    "array_equal": operator.eq,
}
