"""What each column is called on the page, and in which unit: variables, then all measures, then those of an audit."""

from collections.abc import Sequence

from pareto_monoped.measures import MEASURES, Measure, measure
from pareto_monoped.report.schema import Quantity


def _quantity(name: str, label: str, unit: str, decimals: int, scale: float = 1.0) -> Quantity:
    return Quantity(name=name, label=label, unit=unit, decimals=decimals, scale=scale)


_LABELS = {"energy_j": "mechanical energy", "efficiency": f"mechanical {measure('efficiency').label}"}
"""Labels that say which energy is meant, beside the one from the battery."""


def label_of(name: str) -> str:
    """What the page calls a measure."""
    return _LABELS.get(name, measure(name).label)


def _of(m: Measure) -> Quantity:
    return _quantity(m.name, label_of(m.name), m.shown_unit, m.decimals, m.scale)


_VARIABLES = (
    _quantity("thigh_length_m", "thigh length", "mm", 1, 1000.0),
    _quantity("shank_length_m", "shank length", "mm", 1, 1000.0),
    _quantity("knee_ratio", "knee ratio", ": 1", 2),
    _quantity("hip_ratio", "hip ratio", ": 1", 2),
    _quantity("stiffness_n_per_m", "stiffness", "N/m", 1),
    _quantity("damping_n_s_per_m", "damping", "N s/m", 2),
    _quantity("torsional_stiffness_n_m_per_rad", "torsional stiffness", "N m/rad", 2),
    _quantity("knee_release_rad", "knee release", "rad", 3),
    _quantity("rest_length_m", "rest length", "m", 2),
    _quantity("start_height_m", "start height", "mm", 0, 1000.0),
)

_OBJECTIVES = ("height_m", "energy_j")
_FIRST = ("mass_kg", "efficiency")  # of the other measures: what readers look for before the rest

AUDIT = (
    "energy_balance_error",
    "spread_height_m",
    "spread_energy",
    "half_step_height_m",
    "half_step_energy",
    "control_period_height_m",
    "control_period_energy",
    "double_step_height_m",
    "double_step_energy",
    "double_step_balance_error",
)
"""Measures that the page shows of an audit, as far as it has them."""

EVERY_TRIAL: tuple[str, ...] = ("mass_kg", "foot_clearance_m", "joule_heat_j")
"""Measures that the page has of every trial as plain numbers beside the objectives; the others are packed."""


def quantities_of(robust: Sequence[str]) -> tuple[Quantity, ...]:
    """``QUANTITIES``, and some measures under uncertainty and own functions by name."""
    return (*QUANTITIES, *(_of(measure(name)) for name in robust))


QUANTITIES: tuple[Quantity, ...] = (
    *(_of(measure(name)) for name in _OBJECTIVES),
    *_VARIABLES,
    *(_of(measure(name)) for name in _FIRST),
    *(_of(m) for m in MEASURES if m.name not in (*_OBJECTIVES, *_FIRST)),
    *(_of(measure(name)) for name in AUDIT),
)
