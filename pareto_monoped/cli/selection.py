"""The options that select one design of a front, shared by ``pick`` and ``export``."""

import functools
import inspect
import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import click

from pareto_monoped.cli import options

if TYPE_CHECKING:
    from pareto_monoped.pareto.selectors import Chooser, Condition, MaxEnergy, Selector

_CHOOSERS = "--knee, --tradeoff, --weights, --compromise, --nearest, --least, --most, --trial"
_CONDITION = functools.partial(click.option, multiple=True, metavar="NAME=X", shell_complete=options.conditions)
_CONDITIONS = (
    click.option("--min-height", type=float, metavar="M", help="Condition: a jump of at least M metres."),
    click.option("--max-energy", type=float, metavar="J", help="Condition: at most J joules."),
    _CONDITION("--limit", help="Condition: a measure at X or better."),
    _CONDITION("--min", "at_least", help="Condition: measure or variable of at least X."),
    _CONDITION("--max", "at_most", help="Condition: measure or variable of at most X."),
)


def condition_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options that make the front; ``command`` receives them as the keyword ``conditions``."""

    @functools.wraps(command)
    def wrapper(*arguments: Any, **given: Any) -> Any:
        conditions = _conditions(**{name: given.pop(name) for name in inspect.signature(_conditions).parameters})
        return command(*arguments, conditions=conditions, **given)

    return functools.reduce(lambda wrapped, option: option(wrapped), reversed(_CONDITIONS), wrapper)


def selector_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options that select one design; ``command`` receives them as the keyword ``selector``.

    Conditions combine; more than one way to choose is a usage error. Without any, ``selector`` is None, see
    ``required``.
    """

    @click.option("--knee", is_flag=True, help="The design where the front bends most.")
    @click.option("--tradeoff", is_flag=True, help="The design whose neighbours give up most for what they gain.")
    @click.option("--weights", metavar="WH,WE", help="Best weighted sum of the scaled objectives.")
    @click.option("--compromise", metavar="WH,WE", help="Nearest to the best of every objective, with these weights.")
    @click.option(
        "--nearest",
        metavar="NAME=X,...",
        shell_complete=options.conditions,
        help="Nearest to a wished-for point, such as height_m=1,energy_j=20.",
    )
    @click.option("--least", metavar="NAME", shell_complete=options.names, help="Least of a measure or variable.")
    @click.option("--most", metavar="NAME", shell_complete=options.names, help="Most of a measure or variable.")
    @click.option(
        "--trial",
        type=click.IntRange(min=0),
        metavar="N",
        shell_complete=options.trials,
        help="The trial with this number.",
    )
    @functools.wraps(command)
    def wrapper(*arguments: Any, **given: Any) -> Any:
        selector = _selector(**{name: given.pop(name) for name in inspect.signature(_selector).parameters})
        return command(*arguments, selector=selector, **given)

    return condition_options(wrapper)


def _selector(
    conditions: "tuple[Condition | MaxEnergy, ...]",
    knee: bool,
    tradeoff: bool,
    weights: str | None,
    compromise: str | None,
    nearest: str | None,
    least: str | None,
    most: str | None,
    trial: int | None,
) -> "Selector | None":
    from pareto_monoped.pareto.selectors import Among, Compromise, Extreme, Knee, Nearest, Tradeoff, Trial, Weights

    chosen: list[Chooser] = []
    if knee:
        chosen.append(Knee())
    if tradeoff:
        chosen.append(Tradeoff())
    if weights is not None:
        chosen.append(Weights(values=_weights("--weights", weights)))
    if compromise is not None:
        chosen.append(Compromise(values=_weights("--compromise", compromise)))
    if nearest is not None:
        chosen.append(Nearest(wish=_wish(nearest)))
    for option, name in (("--least", least), ("--most", most)):
        if name is not None:
            chosen.append(Extreme(name=_known(option, name, name), most=option == "--most"))
    if trial is not None:
        chosen.append(Trial(number=trial))
    if len(chosen) > 1:
        raise click.UsageError(
            f"{len(chosen)} selectors given: must be one of {_CHOOSERS}, with any conditions; drop the others"
        )
    if not chosen and not conditions:
        return None
    return Among(conditions=conditions, chooser=chosen[0] if chosen else None)


def required(selector: "Selector | None") -> "Selector":
    """Return the selector; without one, a usage error that names the options."""
    if selector is None:
        raise click.UsageError(
            "no selector given: must be one of --min-height M, --max-energy J, --limit NAME=X, --min NAME=X, "
            "--max NAME=X, --knee, --tradeoff, --weights WH,WE, --compromise WH,WE, --nearest NAME=X,..., "
            "--least NAME, --most NAME, --trial N; add one"
        )
    return selector


def _conditions(
    min_height: float | None,
    max_energy: float | None,
    limit: Sequence[str],
    at_least: Sequence[str],
    at_most: Sequence[str],
) -> "tuple[Condition | MaxEnergy, ...]":
    from pareto_monoped.pareto.pick import at_or_better
    from pareto_monoped.pareto.selectors import Condition, MaxEnergy

    found: list[Condition | MaxEnergy] = []
    if min_height is not None:
        height_m = _finite("--min-height", min_height)
        found.append(Condition(name="height_m", side="min", value=height_m, asked="min-height"))
    if max_energy is not None:
        found.append(MaxEnergy(energy_j=_finite("--max-energy", max_energy)))
    found += [at_or_better(*_pair("--limit", text, _directed())) for text in limit]
    for name, value in (_pair("--min", text) for text in at_least):
        found.append(Condition(name=name, side="min", value=value))
    for name, value in (_pair("--max", text) for text in at_most):
        found.append(Condition(name=name, side="max", value=value))
    return tuple(found)


def _finite(option: str, value: float) -> float:
    if not math.isfinite(value):
        raise click.UsageError(f"{option} = {value}: must be a finite number; correct it")
    return value


def _weights(option: str, text: str) -> tuple[float, ...]:
    try:
        values = tuple(float(part) for part in text.split(","))
    except ValueError:
        values = ()
    if len(values) not in (2, 3):
        raise click.UsageError(
            f"{option} = {text!r}: must be two numbers WH,WE, or three for three objectives; give for example 1,1"
        )
    return values


def _wish(text: str) -> dict[str, float]:
    pairs = [_pair("--nearest", part.strip(), _directed()) for part in text.split(",")]
    if len(dict(pairs)) < len(pairs):
        raise click.UsageError(f"--nearest = {text!r}: must name each measure once; drop one")
    return dict(pairs)


def _known(option: str, name: str, text: str, known: Sequence[str] | None = None) -> str:
    """Return the name of a measure, or of a variable unless only some are ``known``; an unknown one is refused."""
    from pareto_monoped.measures import is_own, near_measures
    from pareto_monoped.pareto.selectors import CONDITION_NAMES

    allowed = CONDITION_NAMES if known is None else known
    if name not in allowed and not is_own(name):
        what = "be the name of a measure or variable" if text == name else "begin with the name of a measure and ="
        raise click.UsageError(f"{option} = {text!r}: must {what}; {near_measures(name, allowed)}")
    return name


def _pair(option: str, text: str, known: Sequence[str] | None = None) -> tuple[str, float]:
    name, _, value = text.partition("=")
    _known(option, name, text, known)
    try:
        return name, _finite(option, float(value))
    except ValueError:
        raise click.UsageError(f"{option} = {text!r}: must end with a number; give for example {name}=1.0") from None


def _directed() -> list[str]:
    from pareto_monoped.measures import GOAL_NAMES, measure

    return [name for name in GOAL_NAMES if measure(name).direction is not None]
