"""Formulas of traced numbers, and the shapes that they make, as text: in Python, and in the form of SolidWorks.

SolidWorks has ``IIf`` of Visual Basic and no greatest or least of two numbers (its help, "Operators and Constants"):
operands that stand twice for this get a name of their own, unless they are short.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

from pareto_monoped.cad.write.drivers import Called, Trace
from pareto_monoped.cad.write.formulas import Condition, Traced
from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.shapes import Circle, Line, Path, Pattern, Spread

_RADIANS = math.pi / 180.0
_LEVEL: Mapping[str, float] = {
    "add": 1,
    "sub": 1,
    "plus": 1,
    "scale": 2,
    "mul": 2,
    "div": 2,
    "mod": 2,
    "pow": 4,
    "where": 0,
}
_PYTHON = {"arcsin": "asin", "arccos": "acos", "arctan": "atan", "arctan2": "atan2"}
_SOLIDWORKS = {"arctan": "atn", "sqrt": "sqr"}
_LEAST_OPERATIONS = 3  # of what gets a name of its own in a part's function, if it stands there twice
_LONG = 40  # characters
_EQUATIONS = {
    "max": "IIf({0} > {1}, {0}, {1})", "min": "IIf({0} < {1}, {0}, {1})", "where": "IIf({0}, {1}, {2})",
    "hypot": "sqr({0}^2 + {1}^2)", "ceil": "-int(-{0})", "floor": "int({0})", "round": "int({0} + 0.5)",
    "mod": "{0} - {1} * int({0} / {1})", "arctan2": "2 * atn({0} / (sqr({0}^2 + {1}^2) + {1}))",
}  # fmt: skip


def number(value: float, *, equation: bool = False) -> str:
    """Return a constant in as few digits as it needs; in Python, angles as parts of pi."""
    text = f"{value:.12g}"
    if not equation and value != 0.0:
        for below in (1, 2, 3, 4, 6, 12):
            above = value * below / math.pi
            if abs(above - round(above)) < 1e-12 and round(above) != 0:
                times = {1: "", -1: "-"}.get(round(above), f"{round(above)} * ")
                return f"{times}pi" + (f" / {below}" if below > 1 else "")
    return "0" if text == "-0" else text


@dataclass(frozen=True, slots=True)
class Formula:
    """A number that follows from drivers."""

    name: str
    value: float
    text: str  #: in Python
    meaning: str


class Writer:
    """Formulas as text; it notes which drivers and names they use."""

    def __init__(self, trace: Trace) -> None:
        self.trace = trace
        self.formulas: dict[str, Formula] = {}
        self.used: set[str] = set()
        self.kept: frozenset[str] | None = None  #: drivers that stay ones; None: all, others become numbers
        self.own: dict[int, str] = {}  #: names within the function that is being written
        self.lines: list[str] = []  #: of the equations file
        self._within: Traced | None = None  #: the number whose formula is being written
        self._pieces: dict[int, str] = {}  #: names of what stands more than once in an equation

    def text(self, value: Any, level: float = 0, *, equation: bool = False) -> str:
        """Return a number as a formula, in brackets if it binds less than ``level``."""
        if isinstance(value, Condition):
            return self._condition(value, equation=equation)
        if not isinstance(value, Traced) or self._is_sold(value):
            text = number(float(value), equation=equation)
            return f"({text})" if text.startswith("-") and level > 1 else text
        name = self._name(value)
        if name is not None:
            return f'"{name}"' if equation else name
        if value.op == "scale" and value.args[0] == _RADIANS and value.args[1].op == "driver" and not equation:
            return f"radians({self.text(value.args[1])})"
        text = self._operation(value, equation)
        own = 5.0 if equation and value.op == "where" else _LEVEL.get(value.op, 5.0)
        if value.op == "scale" and text.startswith("-"):
            own = 1.5
        return f"({text})" if own < level else text

    def _is_sold(self, value: Traced) -> bool:
        """Return whether a number is a driver on which bought parts alone depend."""
        return value.op == "driver" and self.kept is not None and value.args[0] not in self.kept

    def _name(self, value: Traced) -> str | None:
        if value.op == "driver":
            self.used.add(value.args[0])
            return str(value.args[0])
        if value is self._within:
            return None
        if id(value) in self.own:
            return self.own[id(value)]
        name = self.trace.names.get(id(value))
        if name is not None and name not in self.formulas:
            before, self.own = (self.own, self._within), {}
            for k, piece in enumerate(repeated(self, value), 1):
                if piece is not value:
                    self.trace.names[id(piece)] = f"{name}_{k}"
            self._within = value
            self.formulas[name] = Formula(name, float(value), self.text(value), self.trace.meanings.get(name, ""))
            self.lines.append(f'"{name}" = {self.text(value, equation=True)}')
            self.own, self._within = before
            # A formula stands after those that were written meanwhile.
            self.formulas[name] = self.formulas.pop(name)
        return name

    def _piece_of(self, value: Any) -> str:
        """Return an operand of an equation in which it stands more than once: by a name of its own, if it is long."""
        text = self.text(value, 3, equation=True)
        if len(text) < _LONG or not isinstance(value, Traced):
            return text
        if id(value) not in self._pieces:
            self._pieces[id(value)] = f"piece_{len(self._pieces) + 1}"
            self.lines.append(f'"{self._pieces[id(value)]}" = {self.text(value, equation=True)}')
        return f'"{self._pieces[id(value)]}"'

    def _operation(self, value: Traced, equation: bool) -> str:
        def text(arg: Any, level: float = 0) -> str:
            return self.text(arg, level, equation=equation)

        op, args = value.op, value.args
        if op == "plus":
            return f"{text(args[0], 1)} {'+' if args[1] >= 0 else '-'} {number(abs(args[1]))}"
        if op == "add":
            return f"{text(args[0], 1)} + {text(args[1], 1)}"
        if op == "sub":
            return f"{text(args[0], 1)} - {text(args[1], 1.7)}"
        if op == "scale":
            return self._scaled(args[0], args[1], equation)
        if op == "mul":
            return f"{text(args[0], 2)} * {text(args[1], 2)}"
        if op == "div":
            return f"{text(args[0], 2)} / {text(args[1], 3)}"
        if op == "pow":
            return f"{text(args[0], 5)}{'^' if equation else '**'}{text(args[1], 5)}"
        if not equation and op == "mod":
            return f"{text(args[0], 2)} % {text(args[1], 3)}"
        if not equation and op == "where":
            return f"{text(args[1], 1)} if {text(args[0])} else {text(args[2], 1)}"
        if equation and op in _EQUATIONS:
            return _EQUATIONS[op].format(*map(self._piece_of, args))
        name = (_SOLIDWORKS if equation else _PYTHON).get(op, op)
        return f"{name}({', '.join(text(arg) for arg in args)})"

    def _scaled(self, factor: float, rest: Traced, equation: bool) -> str:
        sign, factor = "-" if factor < 0 else "", abs(factor)
        text = self.text(rest, 2, equation=equation)
        if factor == 1.0:
            return f"{sign}{text}"
        below = 1.0 / factor
        if factor < 1.0 and abs(below - round(below, 6)) < 1e-9:
            return f"{sign}{text} / {number(round(below, 6))}"
        return f"{sign}{number(factor, equation=equation)} * {text}"

    def _condition(self, one: Condition, *, equation: bool) -> str:
        if one.op == "not":
            return f"not ({self.text(one.args[0], equation=equation)})"
        if one.op in ("and", "or"):
            left, right = (self.text(arg, equation=equation) for arg in one.args)
            if equation:  # truths are 1 and 0 there
                return f"(IIf({left}, 1, 0) {'*' if one.op == 'and' else '+'} IIf({right}, 1, 0)) > 0"
            return f"({left}) {one.op} ({right})"
        left, right = (self.text(arg, 1, equation=equation) for arg in one.args)
        return f"{left} {'=' if equation and one.op == '==' else one.op} {right}"


def numbers_in(value: Any) -> Iterator[Traced]:
    """Yield the traced numbers in a record."""
    if isinstance(value, Traced):
        yield value
    elif isinstance(value, tuple | list):
        for one in value:
            yield from numbers_in(one)
    elif isinstance(value, Mapping):
        for one in value.values():
            yield from numbers_in(one)
    elif is_dataclass(value):
        for each in fields(value):
            if not each.name.startswith("_"):
                yield from numbers_in(getattr(value, each.name))


def repeated(writer: Writer, value: Any) -> list[Traced]:
    """Return long formulas that stand more than once in a part's steps, each after what it contains."""
    seen: dict[int, int] = {}
    order: list[Traced] = []

    def visit(one: Any) -> int:
        if isinstance(one, Condition):
            return 1 + sum(visit(arg) for arg in one.args)
        if not isinstance(one, Traced) or one.op == "driver" or (one is not value and id(one) in writer.trace.names):
            return 0
        seen[id(one)] = seen.get(id(one), 0) + 1
        if seen[id(one)] > 1:
            return sizes[id(one)]
        sizes[id(one)] = 1 + sum(visit(arg) for arg in one.args)
        order.append(one)
        return sizes[id(one)]

    sizes: dict[int, int] = {}
    for number in numbers_in(value):
        visit(number)
    return [one for one in order if seen[id(one)] > 1 and sizes[id(one)] >= _LEAST_OPERATIONS]


def _shape(writer: Writer, shape: Any) -> str:
    """Return a call of the program's that makes a shape."""
    text = writer.text
    if isinstance(shape, Called):
        return _called(writer, shape)
    if isinstance(shape, Circle):
        return call_of("circle", text(shape.radius_mm), *_off(writer, (shape.x_mm, shape.y_mm)))
    if isinstance(shape, Pattern):
        own = (text(n) for n in (shape.radius_mm, shape.pitch_radius_mm, shape.count))
        return call_of("pattern", *own, *_off(writer, (shape.phase_rad, shape.x_mm, shape.y_mm)))
    if isinstance(shape, ExternalGear | InternalGear):
        names = ("teeth", "module_mm", "shift", "backlash_mm", "tip_shortening", "phase_rad")
        own = (text(getattr(shape, name)) for name in names)
        return call_of("gear" if isinstance(shape, ExternalGear) else "ring_gear", *own)
    if isinstance(shape, Spread):
        return call_of("spread", _shape(writer, shape.path), text(shape.count), text(shape.phase_rad))
    if isinstance(shape, Path):
        pieces = ((each, [text(getattr(each, one.name)) for one in fields(each)]) for each in shape.pieces)
        return call_of("path", *(call_of("line" if isinstance(each, Line) else "arc", *own) for each, own in pieces))
    raise TypeError(f"no formula for a shape of kind {type(shape).__name__}")


def _off(writer: Writer, numbers: Sequence[Any]) -> list[str]:
    """Return trailing arguments, without zeros at their end."""
    kept = list(numbers)
    while kept and not isinstance(kept[-1], Traced) and float(kept[-1]) == 0.0:
        kept.pop()
    return [writer.text(one) for one in kept]


def _called(writer: Writer, shape: Called) -> str:
    """Return a call of a function that makes an outline in the package, too."""
    if shape.function == "belt":
        pulleys = [(one.x_mm, one.y_mm, one.signed_mm) for one in shape.arguments[0]]
        return call_of("belt", argument(writer, pulleys))
    if shape.function == "sprocket_outline":
        chain = shape.arguments[0]
        return call_of("sprocket", *(writer.text(one) for one in (chain.teeth, chain.pitch_mm, chain.roller_mm)))
    named = (f"{name.removesuffix('_mm')}={argument(writer, one)}" for name, one in shape.keywords.items())
    return call_of(shape.function, *(argument(writer, one) for one in shape.arguments), *named)


def argument(writer: Writer, value: Any) -> str:
    """Return a number, or a pair or list of them."""
    if isinstance(value, tuple):
        return call_of("", *(argument(writer, one) for one in value))
    return f"[{', '.join(argument(writer, one) for one in value)}]" if isinstance(value, list) else writer.text(value)


def _slab(writer: Writer, prism: Prism) -> str:
    holes = (_shape(writer, hole) for hole in prism.holes)
    return call_of("slab", _shape(writer, prism.outline), writer.text(prism.z0_mm), writer.text(prism.z1_mm), *holes)


def steps(writer: Writer, part: Part) -> Iterator[str]:
    """Yield what a part consists of, as calls."""
    for prism in part.prisms:
        yield _slab(writer, prism)
    for ball in part.balls:
        pocket = [] if ball.pocket is None else [_slab(writer, ball.pocket)]
        yield call_of("ball", *(writer.text(one) for one in (ball.radius_mm, ball.y_mm, ball.top_mm)), *pocket)
    for bevel in part.bevels:
        edge, radius = float(bevel.edge_mm), float(bevel.at.radius_mm)
        if edge != radius:
            kind = "mouth" if bevel.hole else "head" if edge > radius else "chamfer"
            own = (writer.text(one) for one in (bevel.edge_mm, bevel.face_mm, bevel.end_mm))
            yield call_of(kind, _shape(writer, bevel.at), *own)


def call_of(name: str, *arguments: str) -> str:
    """Return a call in Python."""
    return f"{name}({', '.join(arguments)})"
