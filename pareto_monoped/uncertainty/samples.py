"""Samples of what is uncertain, the same scrambled Sobol points for every design, and designs' measures under them."""

from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pareto_monoped.compute.chunks import AT_ONCE, in_turn
from pareto_monoped.design import complete
from pareto_monoped.errors import InputError, complaint
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.controller_record import MOST_DELAY
from pareto_monoped.jump.evaluate import Evaluations, Evaluator
from pareto_monoped.jump.variations import Variations
from pareto_monoped.measures import is_robust
from pareto_monoped.robot.units import BODIES, JOINTS
from pareto_monoped.uncertainty.settings import DEFAULT_SEED, LATER_RANGES, STAND_RANGES, Sampling, Uncertainty
from pareto_monoped.uncertainty.statistics import overloads, spread

Floats = NDArray[np.float64]
Name = Literal[
    "masses",
    "peak_torque",
    "friction",
    "damping",
    "stop_stiffness",
    "foot_stiffness",
    "link_length_m",
    "gains",
    "delay_s",
    "battery_voltage",
    "gear_loss",
    "chain_loss",
    "winding_resistance",
    "rotor_inertia",
    "rebound",
    "stand_mass",
    "rail_friction",
]

DIMENSIONS: tuple[tuple[Name, int], ...] = (
    ("masses", len(BODIES)),
    ("peak_torque", len(JOINTS)),
    ("friction", 1),
    ("damping", 1),
    ("stop_stiffness", 1),
    ("foot_stiffness", 1),
    ("link_length_m", 2),
    ("gains", 3),
    ("delay_s", 1),
    ("battery_voltage", 1),
    *((name, 1) for name in LATER_RANGES),
)
"""Ranges and how many independent numbers each has, in the order of the points' coordinates."""
STAND_DIMENSIONS: tuple[tuple[Name, int], ...] = tuple((name, 1) for name in STAND_RANGES)
"""Those that follow where there is a stand."""
DEFAULT_SAMPLES = 256
"""Samples per design. 256 points estimate a 5th percentile to within 1.4 percent of
the probability at random, and Sobol points do better on smooth measures."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Samples:
    """Values of everything that is uncertain, in ``count`` samples."""

    points: Floats  #: in the unit cube, shape (count, sum of ``dimensions``)
    values: dict[Name, Floats]  #: each range's values, shape (count, k)

    def __len__(self) -> int:
        return len(self.points)


def dimensions(uncertainty: Uncertainty) -> list[tuple[Name, int]]:
    """Return the ranges and how many independent numbers each has."""
    return [(name, k) for name, k in (*DIMENSIONS, *STAND_DIMENSIONS) if name in uncertainty.ranges]


def sobol_samples(uncertainty: Uncertainty, count: int = DEFAULT_SAMPLES, seed: int = DEFAULT_SEED) -> Samples:
    """Draw scrambled Sobol points (Owen 1998, by SciPy) on all ranges; ``count`` is a power of two.

    The same seed gives the same samples whatever the ranges are, and for every design; with a stand there are others.
    """
    from scipy.stats import qmc

    if count < 1 or count & (count - 1):
        raise InputError(complaint("samples", count, "a power of two, such as 256 or 512", "correct it"))
    generator = qmc.Sobol(d=sum(k for _, k in dimensions(uncertainty)), scramble=True, rng=np.random.default_rng(seed))
    points = np.asarray(generator.random_base2(count.bit_length() - 1), dtype=np.float64)
    return samples_at(uncertainty, points)


def samples_at(uncertainty: Uncertainty, points: Floats) -> Samples:
    """Return the samples at points of the unit cube, shape (count, sum of ``dimensions``)."""
    values: dict[Name, Floats] = {}
    first = 0
    for name, k in dimensions(uncertainty):
        ends = uncertainty.ranges[name]
        values[name] = ends.lower + (ends.upper - ends.lower) * points[:, first : first + k]
        first += k
    return Samples(points=points, values=values)


def variations(samples: Samples, designs: int, calibration: Calibration) -> Variations:
    """Return all samples' variations, shape (designs * samples, ...), design by design; refuse too long a delay."""
    period = calibration.simulation.period_s
    longest = float(samples.values["delay_s"].max()) + calibration.simulation.delay_s
    if round(longest / period) > MOST_DELAY:
        allowed = f"at most {MOST_DELAY} control periods of {period:g} s with that of the calibration"
        raise InputError(complaint("delay_s", longest, allowed, "shorten it"))

    total = designs * len(samples)

    def factors(name: Name) -> Floats:
        return np.tile(1.0 + samples.values[name], (designs, 1))

    def factor(name: Name) -> Floats:
        return factors(name)[:, 0]

    return Variations(
        masses=factors("masses"),
        peak_torques=factors("peak_torque"),
        no_load_speeds=factor("battery_voltage"),
        friction=factor("friction"),
        damping=factor("damping"),
        stop_stiffness=factor("stop_stiffness"),
        foot_stiffness=factor("foot_stiffness"),
        link_lengths_m=np.tile(samples.values["link_length_m"], (designs, 1)),
        gains=factors("gains"),
        delays_s=np.tile(samples.values["delay_s"], (designs, 1))[:, 0],
        **{name: factor(name) if name in samples.values else np.ones(total) for name in (*LATER_RANGES, *STAND_RANGES)},
    )


_JUMPS = 8192
"""Jumps that are simulated at once: 3 MB of measures, and still many chunks of the batch evaluator."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RobustEvaluations(Evaluations):
    """Results of n designs: of each one jump as designed, and what many jumps as built say of it."""

    #: Measures under uncertainty by name, each of shape (n,); NaN where no jump has a value
    robust: Mapping[str, Floats]

    def of(self, name: str) -> Floats:
        """Return the measure of that name, shape (n,)."""
        values: Floats = self.robust[name] if is_robust(name) else getattr(self, name)
        return values

    def as_columns(self) -> dict[str, NDArray[np.generic]]:
        """Return column name -> values of shape (n,), ``status`` and ``reason`` first, those under uncertainty last."""
        columns = Evaluations.as_columns(self)
        del columns["robust"]
        return columns | dict(self.robust)


@dataclass(frozen=True, kw_only=True)  # without slots: a cached property needs a place to keep its value
class RobustEvaluator:
    """Evaluates designs as designed and as built in all samples, each independently of the others to the last bit."""

    evaluator: Evaluator  #: simulates
    sampling: Sampling  #: ranges, samples and seed
    names: Sequence[str]  #: the measures under uncertainty that are wanted
    least: Mapping[str, float]  #: measures of strength and what each must at least be

    @cached_property
    def drawn(self) -> Samples:
        """The samples of every design."""
        ranges = self.sampling.ranges.where(stand=self.evaluator.calibration.stand is not None)
        return sobol_samples(ranges, self.sampling.samples, self.sampling.seed)

    def __call__(self, designs: ArrayLike, motors: ArrayLike | None = None) -> RobustEvaluations:
        """Jump with each design, and as built with those that jump as designed.

        ``motors`` says which of the evaluator's ``actuator_maps`` each design is built with, shape (n,); the first if
        None.
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
        """Simulate all samples of some designs, design by design."""
        count = len(self.drawn)
        return self.evaluator(
            np.repeat(designs, count, axis=0),
            np.repeat(kits, count),
            variations=variations(self.drawn, len(designs), self.evaluator.calibration),
        )

    def _measures(self, jumps: Evaluations, rows: slice) -> dict[str, float]:
        """Return one design's wanted measures, and always the shares of jumps that fail and overload a part."""
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
