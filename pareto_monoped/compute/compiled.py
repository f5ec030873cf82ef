"""Functions compiled by numba, cached on disk where numba may write. Importing this module imports numba."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
import numba.extending
from llvmlite import ir

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(function: Function) -> Function:
    """Compile to machine code that releases Python's lock and in which a division by zero gives infinity."""
    return cast(Function, _kept(numba.njit, function, nogil=True))


def inner(function: Function) -> Function:
    """Compile for callers that are compiled themselves, and keep nothing on disk.

    Of a kept function, numba sees no change in the other files that it calls: callers that are new would get old code.
    """
    return cast(Function, numba.njit(error_model="numpy", nogil=True)(function))


def inlined(function: Function) -> Function:
    """Compile like ``inner``, but always into the code of each caller, which made jumps a fifth faster."""
    return cast(Function, numba.njit(error_model="numpy", nogil=True, forceinline=True)(function))


def c_function(signature: Any, function: Callable[..., object]) -> Any:
    """Compile a callback for C, which must not return or raise anything; ``signature`` is numba's.

    The code cached on disk is used until the file of ``function`` or a value that it closes over changes. Numba does
    not notice a change of a function or constant in another file.
    """
    return _kept(lambda **options: numba.cfunc(signature, **options), function).ctypes


@numba.extending.intrinsic  # type: ignore[untyped-decorator]  # numba has no types
def call_address(_: Any, address: Any, first: Any, second: Any, third: Any) -> Any:
    """Call the C function at an address with three pointers to float64; it returns nothing."""
    pointer = numba.types.CPointer(numba.types.float64)

    def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        double = ir.DoubleType().as_pointer()
        function = ir.FunctionType(ir.VoidType(), [double] * 3).as_pointer()
        pointers = [builder.bitcast(value, double) for value in values[1:]]
        builder.call(builder.inttoptr(values[0], function), pointers)
        return context.get_dummy_value()

    return numba.types.void(address, pointer, pointer, pointer), code


def _kept(compiler: Callable[..., Any], function: Callable[..., object], **options: Any) -> Any:
    try:
        return compiler(cache=True, error_model="numpy", **options)(function)
    except RuntimeError:  # numba finds no folder where it may write its cache
        return compiler(error_model="numpy", **options)(function)
