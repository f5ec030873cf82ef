"""The parts of a robot once more, from numbers that remember how they were computed.

The code that gives parts their dimensions runs a second time: on lengths, gears, motors and settings that are drivers,
and with the constants of its modules as drivers, too. What it returns are the same parts, each number of which knows
its formula. Names and meanings of drivers are those of the fields and constants, with the words that stand beside them.
"""

import ast
import builtins
import importlib
import inspect
import math
import re
from collections.abc import Iterator, Mapping, Set
from contextlib import contextmanager
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import lru_cache
from importlib import resources
from types import MappingProxyType, ModuleType, SimpleNamespace
from typing import Any

import numpy as np

from pareto_monoped.cad.write import formulas
from pareto_monoped.cad.write.formulas import Condition, Traced, bare, call
from pareto_monoped.geometry.gears import PRESSURE_ANGLE_RAD, ExternalGear, InternalGear

_MODULES = {
    "geometry.shapes": "", "geometry.features": "making", "geometry.tightening": "", "geometry.gears": "rack",
    "geometry.making": "making", "geometry.parts": "", "geometry.screws": "screw", "geometry.dowels": "dowel",
    "actuator.bearings": "bearing", "actuator.gearset": "gears", "actuator.webs": "web", "actuator.needles": "needle",
    "actuator.motor": "motor", "actuator.layout": "actuator", "actuator.features": "actuator",
    "actuator.planet_bearings": "planet_bearing", "actuator.front": "carrier", "actuator.external_housing": "housing",
    "actuator.external": "coupling", "actuator.internal": "housing", "actuator.actuator": "",
    "leg.actuator_fit": "leg", "leg.dimensions": "leg", "leg.sandwich": "sandwich", "leg.stops": "stop",
    "leg.stop_parts": "stop", "leg.sprocket": "sprocket", "leg.journal": "journal", "leg.thigh_outline": "thigh",
    "leg.hip": "hip_coupling", "leg.chain": "chain", "leg.knee": "knee", "leg.thigh": "thigh", "leg.shank": "shank",
    "leg.electronics": "electronics", "leg.base": "base", "robot.units": "",
}  # fmt: skip
"""Modules that compute dimensions, in the order of their imports, and what their constants' names begin with."""
_SHAPERS = ("belt", "rounded", "rectangle", "polygon", "hull", "hexagon", "rounded_hull", "sprocket_outline")
"""Functions that make outlines: the program has them, too, and calls them by name."""
_LOOKED_UP = {"small_bearing": "bearing_{0:g}", "main_bearing": "main_bearing", "retaining_ring": "{0}_ring",
              "needle_rows": "needle"}  # fmt: skip
"""Functions that look records up in catalogues, and the names of what they find: these are drivers."""
_DRAWN = ("rated_teeth", "spline_teeth", "made")
"""Functions that compute what drawings say of teeth, which is no geometry."""
_DIMENSIONS = ("_mm", "teeth", "count", "modules", "planets", "shift", "share")
_PURE_NUMBERS = re.compile(r"_(SHARE|DEPTHS|MODULES|N_M|MPA|COUNT)$")
_CONSTANT = re.compile(r"_?[A-Z][A-Z0-9_]*")
_TOOTHED = (ExternalGear, InternalGear)
_ROUNDING = 1e-12


@dataclass(frozen=True, slots=True)
class Called:
    """An outline that a function of the program makes."""

    function: str
    arguments: tuple[Any, ...]  #: numbers, pairs and records of them
    keywords: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Driver:
    """A number that a user may change."""

    name: str
    value: float  #: in its unit
    unit: str  #: ``mm``, ``deg``, or empty for numbers and counts
    meaning: str
    detail: bool = False  #: whether it is a constant of one part's layout


class Trace:
    """All drivers of a robot, and names of what follows from them."""

    def __init__(self, reserved: Set[str] = frozenset()) -> None:
        self.reserved = reserved  #: names that the program has for something else
        self.drivers: dict[str, Driver] = {}
        self.names: dict[int, str] = {}  #: of traced numbers, by their identity; those of drivers are their own
        self.meanings: dict[str, str] = {}
        self.rules: list[Any] = []  #: conditions that a catalogue or the assembly of gears asks for
        self.ends: dict[str, Any] = {}  #: of the joints' ranges, such as ``hip_lower``
        self.scope = ""  #: what names of catalogue records begin with

    def driver(self, name: str, value: float, unit: str = "mm", meaning: str = "", *, detail: bool = False) -> Any:
        """Return a driver as a number as the code has it: angles in radians."""
        name = f"{name}_size" if name in self.reserved else name
        given = math.degrees(value) if unit == "deg" else float(value)
        given = round(given, 9) if abs(given - round(given, 9)) < 1e-12 else given
        known = self.drivers.setdefault(name, Driver(name, given, unit, meaning, detail))
        if known.value != given:
            return self.driver(f"{name}_other", value, unit, meaning, detail=detail)
        traced = formulas.driver(name, given)
        return traced * (math.pi / 180.0) if unit == "deg" else traced

    def record(self, record: Any, prefix: str, meanings: Mapping[str, str] = MappingProxyType({})) -> Any:
        """Return a record of which every dimension is a driver; ``meanings`` are by prefix and field."""
        changes, words = {}, words_of(type(record))  # type: ignore[arg-type]  # a cache asks for what has a hash
        for name in (field.name for field in fields(record)):
            value, full = getattr(record, name), f"{prefix}{name}"
            if type(value).__name__ == "Screw":
                changes[name] = space("geometry.screws")[value.name.replace(".", "")]
            elif is_dataclass(value):
                changes[name] = self.record(value, f"{full}_")
            elif isinstance(value, int | float) and not isinstance(value, bool) and name.endswith(_DIMENSIONS):
                unit = "mm" if name.endswith("_mm") else ""
                changes[name] = self.driver(short(full), value, unit, words.get(name) or meanings.get(full, ""))
        return replace(record, **changes)

    def name(self, record: Any, prefix: str) -> None:
        """Name what stands in the fields and properties of a record and follows from drivers."""
        kind: Any = type(record)
        properties = [name for name in dir(kind) if isinstance(getattr(kind, name), property)]
        for name in (*(field.name for field in fields(record)), *properties):
            if name.startswith("_"):
                continue
            try:
                value = getattr(record, name)
            except (AttributeError, TypeError, ValueError):
                continue
            self.call(value, short(f"{prefix}{name}"), words_of(kind).get(name, ""))

    def call(self, value: Any, name: str, meaning: str = "") -> None:
        """Give a number a name, if it follows from drivers, has none, and no other has this one."""
        if isinstance(value, tuple) and len(value) < 4:
            for axis, one in zip("xyz", value, strict=False):
                self.call(one, f"{name}_{axis}")
        name = f"{name}_size" if name in self.reserved else name
        taken = name in self.meanings or name in self.drivers
        if isinstance(value, Traced) and not taken and not _is_given(value) and id(value) not in self.names:
            self.names[id(value)], self.meanings[name] = name, meaning


def _is_given(value: Traced) -> bool:
    """Return whether a number is a driver, or a multiple of one."""
    return value.op == "driver" or (value.op == "scale" and value.args[1].op == "driver")


def short(name: str) -> str:
    """Return a name without its unit."""
    return re.sub(r"_(mm|rad)$", "", name).strip("_").replace("__", "_")


def space(module: str) -> dict[str, Any]:
    """Return the names of a module of the package."""
    return vars(importlib.import_module(f"pareto_monoped.{module}"))


@lru_cache(maxsize=64)
def words_of(kind: Any) -> Mapping[str, str]:
    """Return what stands beside the fields of a class: comments after ``#:`` on their lines or above them."""
    try:
        lines = inspect.getsource(kind).splitlines()
    except (OSError, TypeError):
        return {}
    found, above = {}, ""
    for line in lines:
        text = line.strip()
        if text.startswith("#:"):
            above = f"{above} {text[2:].strip()}".strip()
        elif match := re.match(r"(\w+): [^#]*(?:#: (.*))?$", text):
            found[match[1]] = (match[2] or above).strip()
            above = ""
        else:
            above = ""
    return found


@lru_cache(maxsize=1)
def table_words() -> Mapping[str, str]:
    """Return what stands beside the values of ``actuator_parts.toml``, by their tables and keys."""
    found, table, above = {}, "", ""
    for line in (resources.files("pareto_monoped") / "data" / "actuator_parts.toml").read_text("utf-8").splitlines():
        text, _, comment = line.partition("#")
        comment = re.sub(r"\[\w\] ?", "", comment).strip()
        if text.startswith("["):
            table = text.strip("[] ")
        elif " = " in text:
            found[f"{table}_{text.split(' = ')[0]}"] = comment or above
        above = f"{above} {comment}".strip() if not text.strip() else ""
    return found


@contextmanager
def tracing(trace: Trace) -> Iterator[None]:
    """Run the code of the parts on drivers: its modules' constants are drivers, its caches are passed by.

    The modules are as before when the context ends. No other thread may compute parts meanwhile.
    """
    formulas.forget()
    modules = {name: importlib.import_module(f"pareto_monoped.{name}") for name in _MODULES}
    before = {name: dict(vars(module)) for name, module in modules.items()}
    try:
        for name, module in modules.items():
            _replace(module, name, modules, trace)
        for kind in _TOOTHED:
            _defaults(kind)["pressure_angle_rad"] = vars(modules["geometry.gears"])["PRESSURE_ANGLE_RAD"]
        yield
    finally:
        for kind in _TOOTHED:
            _defaults(kind)["pressure_angle_rad"] = PRESSURE_ANGLE_RAD
        for name, module in modules.items():
            vars(module).update(before[name])
            for added in vars(module).keys() - before[name].keys():
                del vars(module)[added]


def _defaults(kind: Any) -> dict[str, Any]:
    """Return the default values of a record's fields."""
    return kind.__init__.__kwdefaults__  # type: ignore[no-any-return]  # a dictionary


def _replace(module: ModuleType, own: str, modules: Mapping[str, ModuleType], trace: Trace) -> None:
    """Replace a module's constants by drivers, and what would lose their formulas."""
    names, (tree, comments), traced = vars(module), _parsed(module), set()
    for node in tree.body:
        if isinstance(node, ast.ImportFrom):
            origin = modules.get((node.module or "").removeprefix("pareto_monoped."))
            for alias in node.names if origin is not None else ():
                names[alias.asname or alias.name] = vars(origin)[alias.name]
                traced.add(alias.asname or alias.name)
    for name, value in list(names.items()):
        if getattr(value, "__module__", None) == module.__name__ and inspect.isroutine(value):
            names[name] = _function(name, value, trace)
    for place, node in enumerate(tree.body):
        targets, value = _assigned(node)
        words = comments.get(getattr(node, "lineno", 0)) or _docstring(tree.body, place)
        uses = {part.id for part in ast.walk(value) if isinstance(part, ast.Name)} & traced if value is not None else ()
        for index, target in enumerate(targets):
            if _CONSTANT.fullmatch(target):
                source = value.elts[index] if isinstance(value, ast.Tuple) and len(targets) > 1 else value
                before = names[target]
                names[target] = _constant(target, before, source, bool(uses), names, own, words, trace)
                if names[target] is not before:
                    traced.add(target)
    names |= {"float": _kept, "max": _most, "min": _least}
    names |= {name: stand_in for name, stand_in in (("np", _NUMPY), ("math", _MATH)) if name in names}


def _function(name: str, value: Any, trace: Trace) -> Any:
    """Return what stands for a function of a module."""
    if name in _SHAPERS:
        return lambda *arguments, **keywords: Called(name, arguments, keywords)
    if name in _DRAWN:
        return lambda *_, **__: ()
    if name in _LOOKED_UP:
        return _looking_up(name, value, trace)
    # Tables are read once; other caches would keep traced numbers, or return what is not.
    return value.__wrapped__ if hasattr(value, "cache_clear") and inspect.signature(value).parameters else value


def _constant(
    target: str, value: Any, source: Any, follows: bool, names: dict[str, Any], own: str, words: str, trace: Trace
) -> Any:
    """Return a constant of a module as a driver, a record of drivers, or a formula of other constants."""
    name, text = short(f"{_MODULES[own]}_{target.lower()}"), ast.unparse(source)
    if follows and isinstance(source, ast.Name):
        return names[source.id]
    if follows and isinstance(value, float):
        computed = eval(compile(ast.Expression(source), own, "eval"), names | {"np": _NUMPY})  # noqa: S307
        if isinstance(computed, Traced) and abs(float(computed) - value) < _ROUNDING:
            trace.call(computed, name, words)
            return computed
    unit = "deg" if "radians" in text or "np.pi" in text else "mm"
    if type(value) is int and own.startswith("leg."):
        return trace.driver(name, value, "", words, detail=True)
    if isinstance(value, float):
        if (own == "geometry.gears" and unit == "mm") or _PURE_NUMBERS.search(target):
            unit = ""
        return trace.driver(name, value, unit, words, detail=True)
    if type(value) is tuple and len(value) < 4 and all(isinstance(one, float) for one in value):
        return tuple(trace.driver(f"{name}_{k}", one, unit, words, detail=True) for k, one in enumerate(value, 1))
    if type(value).__name__ == "Screw":
        said = words_of(type(value))  # type: ignore[arg-type]  # likewise
        return replace(value, **{f.name: trace.driver(f"{target.lower()}_{f.name}", getattr(value, f.name), "mm",
                                 f"radius, {said[f.name]}", detail=True) for f in fields(value)})  # fmt: skip
    return trace.record(value, f"{name}_") if type(value).__name__ in ("Dowel", "Bumper", "RollerBearing") else value


def _assigned(node: ast.stmt) -> tuple[list[str], Any]:
    if isinstance(node, ast.Assign):
        target = node.targets[0]
        names = target.elts if isinstance(target, ast.Tuple) else [target]
        return [name.id for name in names if isinstance(name, ast.Name)], node.value
    if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
        return [node.target.id], node.value
    return [], None


@lru_cache(maxsize=64)
def _parsed(module: ModuleType) -> tuple[ast.Module, Mapping[int, str]]:
    """Return a module's syntax tree, and the comments at the ends of its lines."""
    text = inspect.getsource(module)
    return ast.parse(text), {k: line.partition("  # ")[2] for k, line in enumerate(text.splitlines(), 1)}


def _docstring(body: list[ast.stmt], place: int) -> str:
    after = body[place + 1] if place + 1 < len(body) else None
    if isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant) and isinstance(after.value.value, str):
        return " ".join(after.value.value.split())
    return ""


def _looking_up(name: str, function: Any, trace: Trace) -> Any:
    """Return a function that makes drivers of what a catalogue has, and notes what the catalogue was asked for."""

    def found(*arguments: Any) -> Any:
        plain = [bare(one) for one in arguments]
        said = [one.replace(" ", "_").lower() if isinstance(one, str) else one for one in plain]
        scope = (trace.scope if name != "small_bearing" else "") + _LOOKED_UP[name].format(*said)
        record = function(*plain)
        lengths = [f.name for f in fields(record) if f.name.endswith("_mm")]
        record = replace(record, **{length: trace.driver(short(f"{scope}_{length}"), getattr(record, length), "mm",
                                    "of the catalogue") for length in lengths})  # fmt: skip
        if name == "main_bearing":
            trace.rules.append(arguments[0] <= record.inner_diameter_mm)
        elif name == "retaining_ring":
            trace.rules.append(record.size_mm == arguments[1])
        return record

    return found


def _kept(value: Any = 0.0) -> Any:
    return value if isinstance(value, Traced) else builtins.float(value)


def _most(*values: Any, **keywords: Any) -> Any:
    return call("max", *values) if len(values) == 2 and not keywords else builtins.max(*values, **keywords)


def _least(*values: Any, **keywords: Any) -> Any:
    return call("min", *values) if len(values) == 2 and not keywords else builtins.min(*values, **keywords)


class _Numpy:
    """NumPy, which would turn traced numbers into plain ones where it makes arrays."""

    def __getattr__(self, name: str) -> Any:
        return getattr(np, name)

    def asarray(self, value: Any, dtype: Any = None) -> Any:
        """Return a traced number as it is."""
        return value if isinstance(value, Traced | Condition) else np.asarray(value, dtype=dtype)


_NUMPY = _Numpy()
_MATH = SimpleNamespace(**vars(math))
_MATH.copysign = lambda one, other: one * (math.copysign(1.0, one) * math.copysign(1.0, other))
