"""Functions compiled by numba, kept on disk where there is a place to write to.

Importing this module imports numba, so it is imported where numbers are crunched.
"""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(function: Function) -> Function:
    """Compile for the processor's own code; other threads run on meanwhile, and a division by zero gives infinity."""
    return cast(Function, _kept(numba.njit, function, nogil=True))


def c_function(signature: Any, function: Callable[..., object]) -> Any:
    """Compile a callback for C.

    What is kept on disk is thrown away when the file that holds ``function`` changes, or a value that it closes over;
    a change in another file, of a function that it calls or of a number that it reads, goes unseen.

    Args:
        signature: numba's, of result and arguments.
        function: returns nothing and raises nothing.
    """
    return _kept(lambda **options: numba.cfunc(signature, **options), function).ctypes


def _kept(compiler: Callable[..., Any], function: Callable[..., object], **options: Any) -> Any:
    try:
        return compiler(cache=True, error_model="numpy", **options)(function)
    except RuntimeError:  # numba has no folder that it may write its cache to
        return compiler(error_model="numpy", **options)(function)
