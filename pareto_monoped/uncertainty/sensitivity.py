"""Which factors move the measures of a design most: Sobol' indices, the change from end to end, and their records."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from pareto_monoped.config import Strict
from pareto_monoped.errors import InputError, complaint
from pareto_monoped.uncertainty.samples import Floats, Name, dimensions
from pareto_monoped.uncertainty.settings import Uncertainty

Simulate = Callable[[Floats], tuple[NDArray[np.bool_], Floats]]
"""Points in the unit cube, shape (m, d), to which of them jumped, shape (m,), and s measures, shape (m, s)."""

DEFAULT_BLOCKS = 256
"""Base samples; each takes d + 2 jumps. The 95 percent interval of a total index of 0.5 is then about +-0.1."""
FEWEST_BLOCKS = 32
"""Fewest base samples that are left after failures. Our own choice: below, intervals are as wide as the indices."""
WIDE = 0.1
"""Half an interval from which on a share is given as the interval alone. Our own choice: with 256 base samples, which
are the default, shares are known to 0.1."""
_RESAMPLES, _INTERVAL = 200, (2.5, 97.5)
"""Bootstrap resamples for the intervals, and their percentiles: 200 are enough for standard errors (Efron 1993)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Indices:
    """Influence of d factors on s measures."""

    blocks: int  #: base samples that the indices rest on
    jumps: int  #: simulated in all
    failed: float  #: share of these jumps that failed
    first: Floats  #: first-order indices, shape (s, d): the share of a measure's variance that a factor explains alone
    total: Floats  #: total indices, shape (s, d): the share that would go with it, with all of its interactions
    error: Floats  #: half the width of the 95 percent interval of ``total``, shape (s, d)
    #: Change of each measure from the lower to the upper end of a factor, by its mean slope, shape (s, d)
    effect: Floats


def indices(simulate: Simulate, factors: int, blocks: int = DEFAULT_BLOCKS, seed: int = 1) -> Indices:
    """Compute Sobol' indices of independent factors that are uniform on the unit interval.

    The sampling plan and its Sobol' points are those of Saltelli et al. 2010 (Variance based sensitivity analysis of
    model output); SciPy has the estimators. A base sample with a jump that fails is left out whole, and of the others
    the first ones whose number is a power of two are used.

    Raises:
        InputError: ``blocks`` is no power of two, or too few are left.
    """
    from scipy.stats import qmc, sobol_indices

    if blocks < FEWEST_BLOCKS or blocks & (blocks - 1):
        allowed = f"a power of two of at least {FEWEST_BLOCKS}"
        raise InputError(complaint("samples", blocks, allowed, "correct it"))
    generator = qmc.Sobol(d=2 * factors, scramble=True, rng=np.random.default_rng(seed))
    both = np.asarray(generator.random_base2(blocks.bit_length() - 1), dtype=np.float64)
    first, second = both[:, :factors], both[:, factors:]
    mixed = np.tile(first, (factors, 1, 1))
    for k in range(factors):
        mixed[k, :, k] = second[:, k]
    points = np.concatenate((first, second, mixed.reshape(-1, factors)))
    ok, values = simulate(points)
    whole = np.flatnonzero(ok.reshape(factors + 2, blocks).all(axis=0))
    kept = whole[: 1 << (len(whole).bit_length() - 1)] if len(whole) else whole
    if len(kept) < FEWEST_BLOCKS:
        raise InputError(
            f"sensitivity: {100.0 * (1.0 - ok.mean()):.0f} percent of the jumps fail, so that only {len(whole)} of "
            f"{blocks} base samples are whole, at least {FEWEST_BLOCKS} are needed; narrow the ranges, or give more "
            "samples"
        )
    # Shape (d + 2, s, n), as SciPy has it.
    table = values.reshape(factors + 2, blocks, -1)[:, kept].transpose(0, 2, 1)
    generator_of_rows = np.random.default_rng(seed)
    drawn = generator_of_rows.integers(0, len(kept), (_RESAMPLES, len(kept)))

    def of(rows: NDArray[np.intp]) -> tuple[Floats, Floats]:
        part = table[:, :, rows]
        found = sobol_indices(func={"f_A": part[0], "f_B": part[1], "f_AB": part[2:]}, n=len(rows))
        shape = (table.shape[1], factors)
        return np.reshape(found.first_order, shape), np.reshape(found.total_order, shape)

    alone, total = of(np.arange(len(kept)))
    low, high = np.percentile([of(rows)[1] for rows in drawn], _INTERVAL, axis=0)
    return Indices(
        blocks=len(kept),
        jumps=len(points),
        failed=float(1.0 - ok.mean()),
        first=alone,
        total=total,
        error=0.5 * (high - low),
        effect=_effects(table, (second - first)[kept]),
    )


def _effects(table: Floats, steps: Floats) -> Floats:
    """Return mean slopes of the measures over the unit interval of each factor, by least squares: shape (s, d).

    Each step moves one factor alone, so that a factor which moves nothing has a change of exactly zero. ``table`` has
    the measures at the first points, the second, and those with one factor of the second, shape (d + 2, s, n);
    ``steps`` has the shape (n, d).
    """
    changes = table[2:] - table[0]
    return np.asarray(np.einsum("dsn,nd->sd", changes, steps) / np.square(steps).sum(axis=0))


@dataclass(frozen=True, slots=True, kw_only=True)
class Factor(Strict):
    """One factor."""

    name: str  #: unique among the factors of a sensitivity
    label: str  #: in words
    #: lower, upper: its ends, in its stored unit; for a share as a share of the nominal value
    lower: float
    upper: float
    unit: str  #: "1" for a share or a ratio, else of the stored value
    tolerance: bool = False  #: whether it is a tolerance of what is made, rather than of drive, control or use

    @property
    def text(self) -> str:
        """Its range as it is shown, such as "-5 to 5 %" or "0 to 3 ms"."""
        unit, scale = _SHOWN.get(self.unit, (self.unit, 1.0))
        ends = self.lower * scale, self.upper * scale
        places = 3 - int(np.floor(np.log10(max(map(abs, ends)))))  # both as fine as four digits of the larger one
        low, high = (f"{round(end, places):.4g}" for end in ends)
        return f"{low} to {high} {unit}".rstrip()


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
    "gear_loss": ("loss in gears",),
    "chain_loss": ("loss in the chain",),
    "winding_resistance": ("winding resistance",),
    "rotor_inertia": ("rotor inertia",),
    "rebound": ("stop rebound",),
    "stand_mass": ("mass of the stand",),
    "rail_friction": ("rail friction",),
}
_MADE: frozenset[Name] = frozenset(
    (
        *("masses", "friction", "damping", "stop_stiffness", "foot_stiffness", "link_length_m", "stand_mass"),
        *("gear_loss", "chain_loss", "rebound"),
    )
)
"""Ranges that come from making parts: printing, moulding, machining, greasing. The others are of motors and electronics
that are bought, and of use."""


def factors_of(ranges: Uncertainty) -> tuple[Factor, ...]:
    """Return the factors of all ranges, in the order of ``samples.dimensions``."""
    found = []
    for name, count in dimensions(ranges):
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
    """Return the values of a factor at points of the unit interval, shape (n,)."""
    return factor.lower + (factor.upper - factor.lower) * points


About = Literal["variables", "assumptions"]
"""Kinds of factors: the design's variables, or what is uncertain in a robot that is built."""
Number = Annotated[float, Field(allow_inf_nan=False)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Influence(Strict):
    """One factor on one measure."""

    change: Number  #: of the measure in its stored unit, from the lower to the upper end of the factor
    first: Number  #: first-order Sobol' index
    total: Number  #: total index: the share of the measure's variance that would go with the factor
    #: Half the width of the 95 percent interval of ``total``
    error: Annotated[float, Field(ge=0.0, allow_inf_nan=False)]

    @property
    def share_text(self) -> str:
        """Return the share in percent, such as "31+-8"; its interval, such as "75..100", where that is wide."""
        low, high = (100.0 * min(max(self.total + side * self.error, 0.0), 1.0) for side in (-1.0, 1.0))
        if self.error > WIDE or self.total > 1.0:
            return f"{low:.0f}..{high:.0f}"
        return f"{100.0 * self.total:.0f}+-{100.0 * self.error:.0f}"


@dataclass(frozen=True, slots=True, kw_only=True)
class FactorInfluence(Strict):
    """One factor, and its influence on each measure."""

    factor: Factor
    measures: dict[str, Influence]


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensitivity(Strict):
    """The sensitivity of one design."""

    about: About  #: which kind of factors
    blocks: Annotated[int, Field(ge=1)]  #: base samples that the indices rest on
    jumps: Annotated[int, Field(ge=1)]  #: simulated in all
    failed: Annotated[float, Field(ge=0.0, le=1.0)]  #: share of them that did not reach an apex
    factors: tuple[FactorInfluence, ...]  #: those that vary

    def ranked(self, name: str) -> list[FactorInfluence]:
        """Return the factors by their total index of a measure, the greatest first."""
        return sorted(self.factors, key=lambda one: -one.measures[name].total)

    def as_dict(self) -> dict[str, Any]:
        """Return JSON values."""
        return asdict(self) | {"factors": [asdict(one) for one in self.factors]}


def sensitivity_of(about: About, factors: Sequence[Factor], found: Indices, names: Sequence[str]) -> Sensitivity:
    """Return the record of what was found of d factors and s measures, called ``names``."""

    def influence(row: int, column: int) -> Influence:
        parts = (found.effect, found.first, found.total, found.error)
        change, first, total, error = (float(part[row, column]) for part in parts)
        return Influence(change=change, first=first, total=total, error=error)

    return Sensitivity(
        about=about,
        blocks=found.blocks,
        jumps=found.jumps,
        failed=found.failed,
        factors=tuple(
            FactorInfluence(factor=factor, measures={name: influence(row, k) for row, name in enumerate(names)})
            for k, factor in enumerate(factors)
        ),
    )
