"""Ranges of everything that is uncertain in a built robot, and the samples that a study searches with, from TOML."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from pareto_monoped.config import Strict, checked, read_shipped, read_toml
from pareto_monoped.errors import InputError, StudyError, complaint

SHIPPED, WHAT = "uncertainty.toml", "uncertainty file"
"""The shipped file, and what such a file is called in messages."""
STAND_RANGES: tuple[Literal["stand_mass", "rail_friction"], ...] = ("stand_mass", "rail_friction")
"""Which only a calibration with a stand has."""
LATER_RANGES: tuple[Literal["gear_loss", "chain_loss", "winding_resistance", "rotor_inertia", "rebound"], ...] = (
    *("gear_loss", "chain_loss", "winding_resistance", "rotor_inertia", "rebound"),
)
"""Which earlier studies lack; they vary none of these."""
_LEAST_SHARE, _MOST_LENGTH_M = -0.9, 0.01
"""Beyond these nothing is left of a part, or its mass no longer fits its length. Our own choice."""
_MOST_LOSS, _MOST_REBOUND = 9.0, 9.0
"""Ten times a loss of 3 percent leaves little to jump with, and ten times the rebound is that of natural rubber."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Range(Strict):
    """A quantity that is uniform between two ends."""

    #: lower, upper: the ends; equal ends switch the uncertainty off
    lower: Annotated[float, Field(allow_inf_nan=False)]
    upper: Annotated[float, Field(allow_inf_nan=False)]
    source: Annotated[str, Field(min_length=1)]  #: where they come from

    def __post_init__(self) -> None:
        """Refuse a range of which the ends are swapped."""
        if self.lower > self.upper:
            raise ValueError(f"lower {self.lower:g} must not exceed upper {self.upper:g}; swap them")


@dataclass(frozen=True, slots=True, kw_only=True)
class Uncertainty(Strict):
    """All ranges; ``data/uncertainty.toml`` says what each is about. Those without unit are shares."""

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
    #: gear_loss, chain_loss, winding_resistance, rotor_inertia, rebound: None in a study stored before there were any
    gear_loss: Range | None = None
    chain_loss: Range | None = None
    winding_resistance: Range | None = None
    rotor_inertia: Range | None = None
    rebound: Range | None = None
    #: stand_mass, rail_friction: None where they are as shipped, and where there is no stand
    stand_mass: Range | None = None
    rail_friction: Range | None = None

    def __post_init__(self) -> None:
        """Refuse what no robot can have."""
        for name, range_ in self.ranges.items():
            least, most = _LEAST_SHARE, float("inf")
            if name in ("gear_loss", "chain_loss"):
                least, most = -1.0, _MOST_LOSS
            elif name == "rebound":
                most = _MOST_REBOUND
            elif name == "link_length_m":
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
        ranges = {name: getattr(self, name) for name in self.__dataclass_fields__ if name != "name"}
        return {name: found for name, found in ranges.items() if found is not None}

    def as_dict(self) -> dict[str, Any]:
        """Return the ranges as in a file; ``uncertainty_of`` reads them back."""
        return {"name": self.name, **{name: asdict(found) for name, found in self.ranges.items()}}

    def where(self, *, stand: bool) -> "Uncertainty":
        """Return the ranges of a calibration with or without a stand, as shipped where these name none for it."""
        if not stand:
            return replace(self, stand_mass=None, rail_friction=None)
        shipped = _shipped(stand=True)
        return uncertainty_of({name: shipped[name] for name in STAND_RANGES} | self.as_dict(), source=WHAT)


def uncertainty_of(values: Mapping[str, Any], *, source: str, error: type[InputError] = InputError) -> Uncertainty:
    """Return ranges from plain values; raise ``error`` for a missing or wrong value, or an unknown key."""
    return checked(Uncertainty, values, source=source, error=error)


def _shipped(*, stand: bool) -> dict[str, Any]:
    values = read_shipped(SHIPPED, what=WHAT)
    return {name: value for name, value in values.items() if stand or name not in STAND_RANGES}


def load_uncertainty(path: Path | None = None) -> Uncertainty:
    """Read the shipped ranges, or those of a file: what it leaves out is as shipped. For a stand see ``where``."""
    shipped = _shipped(stand=False)
    if path is None:
        return uncertainty_of(shipped, source=WHAT)
    own = read_toml(path, what=WHAT)
    if "name" not in own:
        raise InputError(f"{WHAT} {str(path)!r}: name is missing; add it, so that results can name these ranges")
    return uncertainty_of(shipped | own, source=f"{WHAT} {str(path)!r}")


DEFAULT_SEED = 1
"""Seed of the samples: the same for all designs and studies, so that their numbers can be compared."""
SEARCH_SAMPLES = 64
"""Samples of a design during a search. Our own choice: a 5th percentile then rests on the worst three or four, and
2,000 designs take about as long as 130,000 without uncertainty. ``robust`` judges the front by more."""
FEWEST, MOST = 16, 4096
"""Samples that a study may ask for: of fewer than 16 no 5th percentile can be told from the least value."""
OWN = "own"
"""Name of ranges that a study file changes without a name."""
MOST_FAILED = 0.05
"""Greatest share of failed jumps of a design that counts as robust. Our own choice, as that of the percentiles."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sampling:
    """The ranges of a study, and the samples that it searches with."""

    ranges: Uncertainty  #: what is uncertain, and by how much
    samples: int = SEARCH_SAMPLES  #: jumps per design, besides the one without variation; a power of two
    seed: int = DEFAULT_SEED  #: of the samples, which all designs and all seeds of the search have in common

    def as_dict(self) -> dict[str, Any]:
        """Return the values of a study file, with all ranges; ``sampling_of`` reads them back."""
        return {**self.ranges.as_dict(), "samples": self.samples, "seed": self.seed}


def sampling_of(table: Mapping[str, Any], *, source: str, stand: bool = False) -> Sampling:
    """Return the table ``[uncertainty]`` of a study; what it leaves out is as shipped, on a ``stand`` or elsewhere."""
    given = dict(table)
    samples, seed = given.pop("samples", SEARCH_SAMPLES), given.pop("seed", DEFAULT_SEED)
    whole = isinstance(samples, int) and not isinstance(samples, bool)
    if not whole or not FEWEST <= samples <= MOST or samples & (samples - 1):
        allowed = f"a power of two from {FEWEST} to {MOST}"
        raise StudyError(f"{source}: {complaint('uncertainty.samples', samples, allowed, 'correct it')}")
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < 2**63:
        allowed = "a whole number from 0 up"
        raise StudyError(f"{source}: {complaint('uncertainty.seed', seed, allowed, 'correct it')}")
    if given:
        given.setdefault("name", OWN)
    values, place = _shipped(stand=stand) | given, f"{source}, table [uncertainty]"
    ranges = uncertainty_of(values, source=place, error=StudyError)
    return Sampling(ranges=ranges, samples=samples, seed=seed)
