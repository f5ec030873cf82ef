"""Which change makes numba compile a C function again instead of loading it from disk."""

import ctypes
import gc
import importlib.util
import sys

from numba import types

from pareto_monoped.compute.compiled import c_function

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
