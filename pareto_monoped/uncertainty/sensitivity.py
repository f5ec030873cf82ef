"""Which of many factors moves the measures of a design most: Sobol' indices, and the change from end to end."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.errors import InputError, complaint

Floats = NDArray[np.float64]
Simulate = Callable[[Floats], tuple[NDArray[np.bool_], Floats]]
"""Points in the unit cube, shape (m, d), to which of them jumped, shape (m,), and s measures, shape (m, s)."""

DEFAULT_BLOCKS = 256
"""Base samples; each takes d + 2 jumps. The 95 percent interval of a total index of 0.5 is then about +-0.1."""
FEWEST_BLOCKS = 32
"""Fewest base samples that are left after failures. Our own choice: below, intervals are as wide as the indices."""
_RESAMPLES, _INTERVAL = 200, (2.5, 97.5)
"""Bootstrap resamples for the intervals, and their percentiles: 200 are enough for standard errors (Efron 1993)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Indices:
    """Influence of d factors on s measures.

    Attributes:
        blocks: base samples that the indices rest on.
        jumps: simulated in all.
        failed: share of these jumps that failed.
        first: first-order indices, shape (s, d): the share of a measure's variance that a factor explains alone.
        total: total indices, shape (s, d): the share that would go with it, with all of its interactions.
        error: half the width of the 95 percent interval of ``total``, shape (s, d).
        effect: change of each measure from the lower to the upper end of a factor, by its mean slope, shape (s, d).
    """

    blocks: int
    jumps: int
    failed: float
    first: Floats
    total: Floats
    error: Floats
    effect: Floats


def indices(simulate: Simulate, factors: int, blocks: int = DEFAULT_BLOCKS, seed: int = 1) -> Indices:
    """Sobol' indices of independent factors that are uniform on the unit interval.

    The sampling plan and its Sobol' points are those of Saltelli et al. 2010 (Variance based sensitivity analysis of
    model output); SciPy has the estimators. A base sample with a jump that fails is left out whole, and of the others
    the first ones whose number is a power of two are used.

    Args:
        simulate: the model, vectorised.
        factors: number d of factors.
        blocks: base samples, a power of two.
        seed: of the points and of the resampling.

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
    """Mean slopes of the measures over the unit interval of each factor, by least squares over single steps.

    Each step moves one factor alone, so that a factor which moves nothing has a change of exactly zero.

    Args:
        table: measures at the first points, the second, and those with one factor of the second, shape (d + 2, s, n).
        steps: of each factor, shape (n, d).

    Returns:
        Shape (s, d).
    """
    changes = table[2:] - table[0]
    return np.asarray(np.einsum("dsn,nd->sd", changes, steps) / np.square(steps).sum(axis=0))
