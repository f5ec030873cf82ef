"""What each column is called on the page, and in which unit: variables, then all measures, then those of an audit."""

from collections.abc import Sequence

from pareto_monoped.design import VARIABLES, Variable
from pareto_monoped.measures import AUDIT_MEASURES, MEASURES, SCREEN_MEASURES, Measure, is_robust, measure
from pareto_monoped.report.schema import Quantity


def label_of(name: str) -> str:
    """What the page calls a measure."""
    entry = measure(name)
    return entry.full or entry.label


def _of(m: Measure) -> Quantity:
    return Quantity(
        name=m.name,
        label=label_of(m.name),
        unit=m.shown_unit,
        decimals=m.decimals,
        scale=m.scale,
        axis=m.axis,
        group="under uncertainty" if is_robust(m.name) else "other measures",
    )


def _of_variable(v: Variable) -> Quantity:
    return Quantity(
        name=v.name, label=v.label, unit=v.shown_unit, decimals=v.decimals, scale=v.scale, group="variables"
    )


_VARIABLES = tuple(map(_of_variable, VARIABLES))


def _placed(table: Sequence[Measure]) -> tuple[str, ...]:
    placed = [(one.place, one.name) for one in table if one.place is not None]
    return tuple(name for _, name in sorted(placed, key=lambda entry: entry[0]))


COMPARED = _placed(MEASURES)
"""Measures by which the page compares designs side by side, beside the objectives."""
LEADING = tuple(name for name in COMPARED if measure(name).leading)
"""Measures that the page shows first, and asks for, beside the objectives."""
AUDIT = _placed((*AUDIT_MEASURES, *SCREEN_MEASURES))
"""Measures that the page shows of an audit, as far as it has them."""

_OBJECTIVES = ("height_m", "energy_j")
_FIRST = ("mass_kg", "efficiency")  # of the other measures: what readers look for before the rest

EVERY_TRIAL: tuple[str, ...] = ("mass_kg", "foot_clearance_m", "joule_heat_j")
"""Measures that the page has of every trial as plain numbers beside the objectives; the others are packed."""


def quantities_of(robust: Sequence[str], variables: Sequence[Variable] = ()) -> tuple[Quantity, ...]:
    """``QUANTITIES``, measures under uncertainty and own functions by name, and the knots among some variables."""
    knots = (_of_variable(variable) for variable in variables if variable not in VARIABLES)
    return (*QUANTITIES, *knots, *(_of(measure(name)) for name in robust))


QUANTITIES: tuple[Quantity, ...] = (
    *(_of(measure(name)) for name in _OBJECTIVES),
    *_VARIABLES,
    *(_of(measure(name)) for name in _FIRST),
    *(_of(m) for m in MEASURES if m.name not in (*_OBJECTIVES, *_FIRST)),
    *(_of(measure(name)) for name in AUDIT),
)
