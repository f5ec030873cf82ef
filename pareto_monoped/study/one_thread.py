"""Linear algebra on one thread."""

from functools import lru_cache
from typing import Any


def one_thread() -> Any:
    """A context in which numpy's and scipy's linear algebra uses one thread.

    Sums of several threads depend on their number, so a search would take another course on a machine with other cores.
    Matrices of a few hundred rows are also faster on one thread, many times so on a busy machine: OpenBLAS's threads
    wait for each other in busy loops.
    """
    return _controller().limit(limits=1, user_api="blas")


@lru_cache(maxsize=1)
def _controller() -> Any:
    import numpy  # noqa: F401  both libraries must be loaded before their threads can be found
    import scipy.linalg  # noqa: F401
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
