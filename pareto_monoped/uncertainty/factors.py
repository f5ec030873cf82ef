"""The single numbers that vary under uncertainty, one per factor of a sensitivity: name, words, ends and unit."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import ConfigDict

from pareto_monoped.uncertainty.ranges import Uncertainty
from pareto_monoped.uncertainty.samples import DIMENSIONS, Name


@dataclass(frozen=True, slots=True, kw_only=True)
class Factor:
    """One factor.

    Attributes:
        name: unique among the factors of a sensitivity.
        label: in words.
        lower, upper: its ends, in its stored unit; for a share as a share of the nominal value.
        unit: "1" for a share or a ratio, else of the stored value.
        tolerance: whether it is a tolerance of what is made, rather than of drive, control or use.
    """

    __pydantic_config__ = ConfigDict(extra="forbid")

    name: str
    label: str
    lower: float
    upper: float
    unit: str
    tolerance: bool = False

    @property
    def text(self) -> str:
        """Its range as it is shown, such as "-5 to 5 %" or "0 to 3 ms"."""
        unit, scale = _SHOWN.get(self.unit, (self.unit, 1.0))
        return f"{self.lower * scale:.4g} to {self.upper * scale:.4g} {unit}".rstrip()


_SHOWN = {"share": ("%", 100.0), "m": ("mm", 1000.0), "s": ("ms", 1000.0), "1": ("", 1.0)}
_UNITS: dict[Name, str] = {"link_length_m": "m", "delay_s": "s"}
_LABELS: dict[Name, tuple[str, ...]] = {
    "masses": ("mass of the base", "mass of the thigh", "mass of the shank"),
    "peak_torque": ("peak torque, hip", "peak torque, knee"),
    "friction": ("joint friction",),
    "damping": ("joint damping",),
    "stop_stiffness": ("stop stiffness",),
    "foot_stiffness": ("foot stiffness",),
    "link_length_m": ("length of the thigh", "length of the shank"),
    "gains": ("gain K", "gain C", "gain T"),
    "delay_s": ("delay",),
    "battery_voltage": ("battery voltage",),
}
_MADE: frozenset[Name] = frozenset(
    ("masses", "friction", "damping", "stop_stiffness", "foot_stiffness", "link_length_m")
)
"""Ranges that come from making parts: printing, moulding, machining, greasing. The others are of motors and electronics
that are bought, and of use."""


def factors_of(ranges: Uncertainty) -> tuple[Factor, ...]:
    """The factors of all ranges, in the order of ``samples.DIMENSIONS``."""
    found = []
    for name, count in DIMENSIONS:
        ends = ranges.ranges[name]
        for k, label in enumerate(_LABELS[name]):
            found.append(
                Factor(
                    name=name if count == 1 else f"{name}.{k}",
                    label=label,
                    lower=ends.lower,
                    upper=ends.upper,
                    unit=_UNITS.get(name, "share"),
                    tolerance=name in _MADE,
                )
            )
    return tuple(found)


def between(factor: Factor, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """The values of a factor at points of the unit interval, shape (n,)."""
    return factor.lower + (factor.upper - factor.lower) * points
