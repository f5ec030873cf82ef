"""Ranges of everything that is uncertain in a built robot, from TOML."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import ConfigDict, Field

from pareto_monoped.config import checked, read_shipped, read_toml
from pareto_monoped.errors import InputError

_STRICT = ConfigDict(extra="forbid")
SHIPPED, WHAT = "uncertainty.toml", "uncertainty file"
"""The shipped file, and what such a file is called in messages."""
_LEAST_SHARE, _MOST_LENGTH_M = -0.9, 0.01
"""Beyond these nothing is left of a part, or its mass no longer fits its length. Our own choice."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Range:
    """A quantity that is uniform between two ends.

    Attributes:
        lower, upper: the ends; equal ends switch the uncertainty off.
        source: where they come from.
    """

    __pydantic_config__ = _STRICT

    lower: Annotated[float, Field(allow_inf_nan=False)]
    upper: Annotated[float, Field(allow_inf_nan=False)]
    source: Annotated[str, Field(min_length=1)]

    def __post_init__(self) -> None:
        """Refuse a range of which the ends are swapped."""
        if self.lower > self.upper:
            raise ValueError(f"lower {self.lower:g} must not exceed upper {self.upper:g}; swap them")


@dataclass(frozen=True, slots=True, kw_only=True)
class Uncertainty:
    """All ranges; ``data/uncertainty.toml`` says what each is about. Those without unit are shares."""

    __pydantic_config__ = _STRICT

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9_.-]+$")]
    masses: Range
    peak_torque: Range
    friction: Range
    damping: Range
    stop_stiffness: Range
    foot_stiffness: Range
    link_length_m: Range
    gains: Range
    delay_s: Range
    battery_voltage: Range

    def __post_init__(self) -> None:
        """Refuse what no robot can have."""
        for name, range_ in self.ranges.items():
            least, most = _LEAST_SHARE, float("inf")
            if name == "link_length_m":
                least, most = -_MOST_LENGTH_M, _MOST_LENGTH_M
            elif name == "delay_s":
                least = 0.0
            if range_.lower < least or range_.upper > most:
                allowed = f"at least {least:g}" + (f" and at most {most:g}" if most < float("inf") else "")
                raise ValueError(
                    f"{name}: lower {range_.lower:g} and upper {range_.upper:g} must be {allowed}; correct them"
                )

    @property
    def ranges(self) -> dict[str, Range]:
        """The ranges by name, in the order of the file."""
        return {name: getattr(self, name) for name in self.__dataclass_fields__ if name != "name"}

    def as_dict(self) -> dict[str, Any]:
        """As in a file; ``uncertainty_of`` reads it back."""
        return asdict(self)


def uncertainty_of(values: Mapping[str, Any], *, source: str, error: type[InputError] = InputError) -> Uncertainty:
    """Ranges from plain values.

    Raises:
        InputError: (or ``error``) a missing or wrong value, or an unknown key.
    """
    return checked(Uncertainty, values, source=source, error=error)


def load_uncertainty(path: Path | None = None) -> Uncertainty:
    """The shipped ranges, or those of a file: what it leaves out is as shipped.

    Raises:
        InputError: no readable file, an unknown key, or a wrong value.
    """
    shipped = read_shipped(SHIPPED, what=WHAT)
    if path is None:
        return uncertainty_of(shipped, source=WHAT)
    own = read_toml(path, what=WHAT)
    if "name" not in own:
        raise InputError(f"{WHAT} {str(path)!r}: name is missing; add it, so that results can name these ranges")
    return uncertainty_of(shipped | own, source=f"{WHAT} {str(path)!r}")
