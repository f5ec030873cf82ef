"""What only some commands need: the extras of ``pyproject.toml``, and one message for all that are not installed."""

from importlib.util import find_spec

from pareto_monoped.errors import InputError

EXTRAS = {
    "cad": {"OCP": "cadquery-ocp-novtk", "manifold3d": "manifold3d", "shapely": "shapely"},
    "cluster": {"distributed": "distributed"},
    "dashboard": {"optuna_dashboard": "optuna-dashboard"},
    "parquet": {"pyarrow": "pyarrow"},
    "postgres": {"psycopg": "psycopg[binary]"},
    "video": {"imageio_ffmpeg": "imageio-ffmpeg"},
}
"""Extra -> its modules, each with the package that has it. An extra whose programs are not called from here is not
among them."""


def require_extra(extra: str, what: str, *, instead: str = "") -> None:
    """Refuse to begin what needs an extra that is not installed.

    Args:
        extra: one of ``EXTRAS``.
        what: what needs it, such as an option.
        instead: what does without it, if there is something.

    Raises:
        InputError: one of its packages is missing.
    """
    missing = [package for module, package in EXTRAS[extra].items() if find_spec(module) is None]
    if missing:
        verb = "is" if len(missing) == 1 else "are"
        way = f", or {instead}" if instead else ""
        raise InputError(
            f"{what}: needs {' and '.join(missing)}, which {verb} not installed; install the extra: "
            f"pip install 'pareto-monoped[{extra}]'{way}"
        )
