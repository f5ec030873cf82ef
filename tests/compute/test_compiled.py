"""Which change makes numba compile a C function again instead of loading it from disk."""

import ctypes
import gc
import importlib.util
import sys

from numba import types
from numba.core.caching import NullCache

from pareto_monoped.compute.compiled import c_function
from pareto_monoped.jump import controller, planar, torques

MODULE = """
from numba import carray

def made(number):
    def act(address):
        carray(address, (1,))[0] = number
    return act
"""


def test_what_a_c_function_closes_over_tells_it_from_the_one_on_disk(tmp_path, monkeypatch):
    path = tmp_path / "callbacks.py"
    path.write_text(MODULE)
    spec = importlib.util.spec_from_file_location("callbacks", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    # numba finds what it kept of a module by the module's name.
    monkeypatch.setitem(sys.modules, "callbacks", module)
    signature = types.void(types.CPointer(types.int64))
    for number in (1, 2, 1):
        found = ctypes.c_int64()
        c_function(signature, module.made(number))(ctypes.byref(found))
        gc.collect()
        assert found.value == number
    assert len(list(tmp_path.rglob("*.nbc"))) == 2


def test_what_is_kept_of_the_controller_calls_nothing_of_other_files():
    """A clone that was updated went on with the old torques: of a kept caller, numba sees its own file alone."""
    kept = set()
    for module in (controller, planar, torques):
        for name, value in vars(module).items():
            if hasattr(value, "py_func") and not isinstance(value._cache, NullCache):
                kept.add(name)
                used = [vars(module).get(one) for one in value.py_func.__code__.co_names]
                assert {one.__module__ for one in used if hasattr(one, "py_func")} <= {module.__name__}
    assert kept == {"basis", "between", "rebound"}
