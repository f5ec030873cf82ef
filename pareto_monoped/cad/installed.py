"""Whether the libraries of the extra ``cad`` are there: searching, choosing and reporting do without them."""

from importlib.util import find_spec

from pareto_monoped.errors import InputError

LIBRARIES = {"OCP": "cadquery-ocp-novtk", "manifold3d": "manifold3d", "shapely": "shapely"}
"""Module -> the package that has it, as in the extra ``cad`` of ``pyproject.toml``."""


def require_cad() -> None:
    """Refuse to begin what needs CAD without its libraries.

    Raises:
        InputError: one is missing.
    """
    missing = [package for module, package in LIBRARIES.items() if find_spec(module) is None]
    if missing:
        raise InputError(
            f"CAD: {', '.join(missing)} not installed, which exports need; install the extra: "
            "pip install 'pareto-monoped[cad]'"
        )
