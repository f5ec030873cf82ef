"""What samples say of a design: mean, spread and percentiles of its measures, and how often it fails or overloads."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from pareto_monoped.config import Strict
from pareto_monoped.jump.evaluate import Evaluations
from pareto_monoped.measures import MEASURE_NAMES

LOW_PERCENT, HIGH_PERCENT = 5.0, 95.0
"""The percentiles that are kept: one design in twenty is worse. EN 1990 takes the same fractile for strengths."""
Number = Annotated[float, Field(allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread(Strict):
    """A measure over the samples that jumped, in its stored unit."""

    mean: Number  #: of the samples
    deviation: Number  #: their standard deviation
    #: p05, p95: the 5th and the 95th percentile
    p05: Number
    p95: Number


@dataclass(frozen=True, slots=True, kw_only=True)
class Robustness(Strict):
    """One design under uncertainty."""

    samples: Annotated[int, Field(ge=1)]  #: number of jumps
    failed: Share  #: share of them that do not reach an apex
    #: Share of them that jump and exceed the load that some joint or part carries with its required safety factor
    overloaded: Share
    measures: dict[str, Spread]  #: the measures by name; those without a value in every successful jump are left out

    def as_dict(self) -> dict[str, Any]:
        """Return JSON values."""
        return asdict(self)


def robustness(evaluations: Evaluations, rows: slice, least: Mapping[str, float]) -> Robustness:
    """Return the robustness of one design from its ``rows`` of jumps and the ``least`` value of each strength."""
    ok = evaluations.ok[rows]
    spreads = {name: spread(getattr(evaluations, name)[rows][ok]) for name in MEASURE_NAMES}
    return Robustness(
        samples=len(ok),
        failed=float(1.0 - ok.mean()),
        overloaded=float((overloads(evaluations, rows, least) & ok).mean()),
        measures={name: found for name, found in spreads.items() if found is not None},
    )


def overloads(evaluations: Evaluations, rows: slice, least: Mapping[str, float]) -> NDArray[np.bool_]:
    """Return which of these jumps exceed what some joint or part carries, shape (len of ``rows``,)."""
    found = np.zeros(len(evaluations.ok[rows]), dtype=bool)
    for name, value in least.items():
        with np.errstate(invalid="ignore"):
            found |= getattr(evaluations, name)[rows] < value
    return found


def spread(values: NDArray[np.float64]) -> Spread | None:
    """Return the spread of the values of all jumps that succeed, (n,); None without any, or where one lacks a value."""
    if len(values) == 0 or not np.isfinite(values).all():
        return None
    low, high = np.percentile(values, (LOW_PERCENT, HIGH_PERCENT))
    return Spread(mean=float(values.mean()), deviation=float(values.std()), p05=float(low), p95=float(high))
