"""Designs to their measures under uncertainty, for a search: the same samples for every design."""

from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pareto_monoped.compute.chunks import AT_ONCE, in_turn
from pareto_monoped.design import complete
from pareto_monoped.jump.evaluate import Evaluations, Evaluator
from pareto_monoped.measures import is_robust
from pareto_monoped.uncertainty.samples import Samples, sobol_samples, variations
from pareto_monoped.uncertainty.settings import Sampling
from pareto_monoped.uncertainty.statistics import overloads, spread

Floats = NDArray[np.float64]

_JUMPS = 8192
"""Jumps that are simulated at once: 3 MB of measures, and still many chunks of the batch evaluator."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RobustEvaluations(Evaluations):
    """Results of n designs: of each one jump as designed, and what many jumps as built say of it.

    Attributes:
        robust: measures under uncertainty by name, each of shape (n,); NaN where no jump has a value.
    """

    robust: Mapping[str, Floats]

    def of(self, name: str) -> Floats:
        """The measure of that name, shape (n,)."""
        values: Floats = self.robust[name] if is_robust(name) else getattr(self, name)
        return values

    def as_columns(self) -> dict[str, NDArray[np.generic]]:
        """Column name to values of shape (n,), ``status`` and ``reason`` first, those under uncertainty last."""
        columns = Evaluations.as_columns(self)
        del columns["robust"]
        return columns | dict(self.robust)


@dataclass(frozen=True, kw_only=True)  # without slots: a cached property needs a place to keep its value
class RobustEvaluator:
    """Evaluates designs as designed, and as built in all samples.

    To the last bit, the result of a design does not depend on the other designs or on the number of workers.

    Attributes:
        evaluator: simulates.
        sampling: ranges, samples and seed.
        names: the measures under uncertainty that are wanted.
        least: measures of strength and what each must at least be.
    """

    evaluator: Evaluator
    sampling: Sampling
    names: Sequence[str]
    least: Mapping[str, float]

    @cached_property
    def drawn(self) -> Samples:
        """The samples of every design."""
        return sobol_samples(self.sampling.ranges, self.sampling.samples, self.sampling.seed)

    def __call__(self, designs: ArrayLike, motors: ArrayLike | None = None) -> RobustEvaluations:
        """Jump with each design.

        Designs that do not jump as designed are not simulated as built.

        Args:
            designs: shape (n, number of variables), see ``design.complete``.
            motors: which of the evaluator's ``actuator_maps`` each design is built with, shape (n,); the first if None.
        """
        values = np.atleast_2d(complete(designs))
        kits = np.zeros(len(values), dtype=np.intp) if motors is None else np.asarray(motors, dtype=np.intp)
        result = self.evaluator(values, kits)
        robust = {name: np.full(len(values), np.nan) for name in self.names}
        reasons = list(result.reason)
        jumping, step = np.flatnonzero(result.ok), max(_JUMPS // self.sampling.samples, 1)
        chunks = [jumping[first : first + step] for first in range(0, len(jumping), step)]
        at_once = 1 if self.evaluator.executor is None else AT_ONCE
        with closing(in_turn(lambda rows: self._jumps(values[rows], kits[rows]), chunks, at_once)) as simulated:
            for rows, jumps in zip(chunks, simulated, strict=True):
                for k, row in enumerate(rows):
                    found = self._measures(jumps, slice(k * len(self.drawn), (k + 1) * len(self.drawn)))
                    for name in self.names:
                        robust[name][row] = found[name]
                    if not found["failed_share"] < 1.0:
                        reasons[row] = f"none of {len(self.drawn)} jumps under uncertainty reaches an apex"
        given = {name: getattr(result, name) for name in Evaluations.__dataclass_fields__ if name != "reason"}
        return RobustEvaluations(**given, reason=tuple(reasons), robust=robust)

    def _jumps(self, designs: Floats, kits: NDArray[np.intp]) -> Evaluations:
        """All samples of some designs, design by design."""
        count = len(self.drawn)
        return self.evaluator(
            np.repeat(designs, count, axis=0),
            np.repeat(kits, count),
            variations=variations(self.drawn, len(designs), self.evaluator.calibration),
        )

    def _measures(self, jumps: Evaluations, rows: slice) -> dict[str, float]:
        """The wanted measures of one design, and always the shares of its jumps that fail and that overload a part."""
        ok = jumps.ok[rows]
        found = {
            "failed_share": float(1.0 - ok.mean()),
            "overloaded_share": float((overloads(jumps, rows, self.least) & ok).mean()),
        }
        for name in self.names:
            base, _, statistic = name.partition(".")
            if statistic:
                known = spread(getattr(jumps, base)[rows][ok])
                found[name] = np.nan if known is None else getattr(known, statistic)
        return found
