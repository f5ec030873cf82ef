"""What the shell completes besides commands, options and files: names of motors, variables, measures and the like.

A name is looked up when the shell asks for it; nothing that takes longer than a key press is imported for that.
"""

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import click
    from click.shell_completion import CompletionItem

Completion = Callable[["click.Context", "click.Parameter", str], "list[CompletionItem]"]


def _completing(known: Callable[[], Iterable[str]], *, files: bool = False) -> Completion:
    """Complete a name out of those known, in a list with commas the last one; files as well if asked for."""

    def complete(_: "click.Context", __: "click.Parameter", incomplete: str) -> "list[CompletionItem]":
        from click.shell_completion import CompletionItem

        before, comma, begun = incomplete.rpartition(",")
        found = [CompletionItem(f"{before}{comma}{name}") for name in known() if name.startswith(begun)]
        return [*found, CompletionItem(incomplete, type="file")] if files else found

    return complete


def _motors() -> Iterable[str]:
    from pareto_monoped.actuator.motors import motor_names

    return motor_names()


def _calibrations() -> Iterable[str]:
    from pareto_monoped.jump.calibration import calibration_names

    return calibration_names()


def _studies() -> Iterable[str]:
    from pareto_monoped.study.shipped import shipped_studies

    return shipped_studies()


def _constraints() -> Iterable[str]:
    from pareto_monoped.actuator.constraint_names import CONSTRAINT_NAMES

    return CONSTRAINT_NAMES


def _variables() -> Iterable[str]:
    from pareto_monoped.design import NAMES

    return (f"{name}=" for name in NAMES)


def _measures() -> Iterable[str]:
    from pareto_monoped.measures import MEASURES

    return (entry.name for entry in MEASURES if entry.direction is not None)


def _conditions() -> Iterable[str]:
    return (f"{name}=" for name in (*_measures(), *(name.removesuffix("=") for name in _variables())))


def _formats() -> Iterable[str]:
    from pareto_monoped.cad.write.formats import FORMATS

    return FORMATS


def trials(ctx: "click.Context", _: "click.Parameter", incomplete: str) -> "list[CompletionItem]":
    """Numbers of the trials on the front of the study that the line names so far; nothing where none can be read.

    Shells that show help beside a word show the objectives.
    """
    from click.shell_completion import CompletionItem

    from pareto_monoped.errors import ParetoMonopedError
    from pareto_monoped.study.front_trials import front_trials
    from pareto_monoped.study.place import place_of

    # An option without its value ends click's reading of a line, before arguments get their names.
    db = ctx.params.get("db") or next(iter(ctx.args), None)
    try:
        known = {} if db is None else front_trials(place_of(db) if isinstance(db, str) else db)
    except ParetoMonopedError:
        return []
    return [CompletionItem(str(n), help=text) for n, text in known.items() if str(n).startswith(incomplete)]


motors = _completing(_motors, files=True)
calibrations = _completing(_calibrations, files=True)
studies = _completing(_studies)
constraints = _completing(_constraints)
variables = _completing(_variables)
measures = _completing(_measures)
conditions = _completing(_conditions)
formats = _completing(_formats)
