"""What a sensitivity says: of each factor, how far it moves each measure, and its share of the measure's variance."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field

from pareto_monoped.uncertainty.factors import Factor
from pareto_monoped.uncertainty.sensitivity import Indices

About = Literal["variables", "assumptions"]
"""Kinds of factors: the design's variables, or what is uncertain in a robot that is built."""
Number = Annotated[float, Field(allow_inf_nan=False)]
_STRICT = ConfigDict(extra="forbid")


@dataclass(frozen=True, slots=True, kw_only=True)
class Influence:
    """One factor on one measure.

    Attributes:
        change: of the measure in its stored unit, from the lower to the upper end of the factor.
        first: first-order Sobol' index.
        total: total index: the share of the measure's variance that would go with the factor.
        error: half the width of the 95 percent interval of ``total``.
    """

    __pydantic_config__ = _STRICT

    change: Number
    first: Number
    total: Number
    error: Annotated[float, Field(ge=0.0, allow_inf_nan=False)]


@dataclass(frozen=True, slots=True, kw_only=True)
class FactorInfluence:
    """One factor, and its influence on each measure."""

    __pydantic_config__ = _STRICT

    factor: Factor
    measures: dict[str, Influence]


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensitivity:
    """The sensitivity of one design.

    Attributes:
        about: which kind of factors.
        blocks: base samples that the indices rest on.
        jumps: simulated in all.
        failed: share of them that did not reach an apex.
        factors: those that vary.
    """

    __pydantic_config__ = _STRICT

    about: About
    blocks: Annotated[int, Field(ge=1)]
    jumps: Annotated[int, Field(ge=1)]
    failed: Annotated[float, Field(ge=0.0, le=1.0)]
    factors: tuple[FactorInfluence, ...]

    def ranked(self, name: str) -> list[FactorInfluence]:
        """The factors by their total index of a measure, the greatest first."""
        return sorted(self.factors, key=lambda one: -one.measures[name].total)

    def as_dict(self) -> dict[str, Any]:
        """As JSON values."""
        return asdict(self) | {"factors": [asdict(one) for one in self.factors]}


def sensitivity_of(about: About, factors: Sequence[Factor], found: Indices, names: Sequence[str]) -> Sensitivity:
    """The record of what was found of d factors and s measures, called ``names``."""

    def influences(column: int) -> Iterator[tuple[str, Influence]]:
        for row, name in enumerate(names):
            yield (
                name,
                Influence(
                    change=float(found.effect[row, column]),
                    first=float(found.first[row, column]),
                    total=float(found.total[row, column]),
                    error=float(found.error[row, column]),
                ),
            )

    return Sensitivity(
        about=about,
        blocks=found.blocks,
        jumps=found.jumps,
        failed=found.failed,
        factors=tuple(FactorInfluence(factor=factor, measures=dict(influences(k))) for k, factor in enumerate(factors)),
    )
