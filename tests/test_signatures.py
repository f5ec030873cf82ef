"""Constants of modules and defaults of functions are as they were: most are reached by no test that looks at results.

Such as the values that a search tries, of which only the best is seen. After a change that is wanted, make the file
again: ``PARETO_MONOPED_SIGN=1 python -m pytest tests/test_signatures.py``.
"""

import ast
import inspect
from importlib import import_module
from pathlib import Path
from pkgutil import walk_packages

import numpy as np
import pytest

import pareto_monoped
from tests.records import compare, of_text

ROOMS = ("analysis", "api", "campaign", "cli", "definition", "jump", "pareto", "report", "search", "storage", "study")
"""Rooms whose numbers are few and their own. Those of gears, parts and drawings are signed by what they make."""
TYPES = ("typing", "types")  #: Modules of types, which other versions of Python and numpy write otherwise.


def assigned(module):
    """Names of what a module assigns at its top level."""
    for node in ast.parse(inspect.getsource(module)).body:
        for target in node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]:
            yield from (one.id for one in ast.walk(target) if isinstance(one, ast.Name)) if target else ()


def functions(module):
    """Functions and methods that a module defines."""
    for one in vars(module).values():
        one = getattr(one, "py_func", getattr(one, "__wrapped__", one))
        if getattr(one, "__module__", None) == module.__name__:
            yield from (
                (each for each in vars(one).values() if inspect.isfunction(each)) if inspect.isclass(one) else [one]
            )


def values(module):
    """Constants of a module and defaults of its functions, as text."""
    found = {name: getattr(module, name, None) for name in assigned(module)}
    for function in functions(module):
        if inspect.isfunction(function):
            found |= {f"{function.__qualname__}.{k}": one for k, one in enumerate(function.__defaults__ or ())}
            found |= {f"{function.__qualname__}.{k}": one for k, one in (function.__kwdefaults__ or {}).items()}
    # Lists are what a process gathers: they hold what tests before this one have done.
    left_out = type | list
    plain = {
        name: one for name, one in found.items() if type(one).__module__ not in TYPES and not isinstance(one, left_out)
    }
    with np.printoptions(threshold=10_000):
        texts = {name: repr(sorted(one) if isinstance(one, set | frozenset) else one) for name, one in plain.items()}
    return {name: text for name, text in texts.items() if " at 0x" not in text and "Path(" not in text}


@pytest.mark.parametrize("room", ROOMS)
def test_constants_and_defaults_are_what_they_were(room):
    package = import_module(f"pareto_monoped.{room}")
    modules = [package, *(import_module(one.name) for one in walk_packages(package.__path__, f"{package.__name__}."))]
    names = {module.__name__.removeprefix(f"{pareto_monoped.__name__}."): values(module) for module in modules}
    found = {name: of_text("\n".join(f"{key}: {text}" for key, text in each.items())) for name, each in names.items()}
    compare(found, Path(__file__).parent / "signatures" / f"{room}.json")
