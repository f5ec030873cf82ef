"""Dimension chains: what is left of a gap when every length is at the worst end of its limits, or anywhere within.

A chain goes once around a gap: lengths that widen it count with +1, those that narrow it with -1. Its worst case is the
sum of all limits. For its spread, each length lies evenly anywhere between its limits, independent of the others: more
pessimistic than the normal distributions that handbooks take (our own choice; nothing is known of the workshop).
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True, kw_only=True)
class Link:
    """One length of a chain."""

    part: str  #: whose length it is, or what sets it
    name: str  #: of the length, unique in the part
    sign: float  #: by how much the gap grows with the length: 1 or -1, or a slope
    nominal_mm: float
    lower_mm: float  #: deviations from the nominal length
    upper_mm: float
    which: int = 0  #: tells instances of one part apart, whose deviations differ

    @classmethod
    def about(
        cls, part: str, name: str, within_mm: float, *, nominal_mm: float = 0.0, sign: float = -1.0, which: int = 0
    ) -> "Link":
        """Return a length within ``within_mm`` to either side."""
        limits = {"lower_mm": -within_mm, "upper_mm": within_mm}
        return cls(part=part, name=name, sign=sign, nominal_mm=nominal_mm, which=which, **limits)

    @property
    def text(self) -> str:
        """In words, such as ``carrier web 14.5 +0.05 / 0``."""
        return f"{self.part} {self.name} {self.nominal_mm:g} {deviations(self.lower_mm, self.upper_mm)}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Chain:
    """A gap, what it consists of, and how small it may become."""

    name: str  #: what the gap is, such as ``float of the planets``
    links: tuple[Link, ...]
    least_mm: float = 0.0  #: the parts jam below it
    cure: str  #: what widens the gap

    @property
    def nominal_mm(self) -> float:
        """The gap with every length as drawn."""
        return sum(one.sign * one.nominal_mm for one in self.links)

    @property
    def worst_mm(self) -> tuple[float, float]:
        """The least and the greatest gap."""
        ends = [sorted((one.sign * one.lower_mm, one.sign * one.upper_mm)) for one in self.links]
        return self.nominal_mm + sum(low for low, _ in ends), self.nominal_mm + sum(high for _, high in ends)

    @property
    def spread_mm(self) -> tuple[float, float]:
        """Mean gap less and plus three standard deviations (root sum of squares), at most the worst case."""
        mean = self.nominal_mm + sum(one.sign * 0.5 * (one.lower_mm + one.upper_mm) for one in self.links)
        variance = sum((one.sign * (one.upper_mm - one.lower_mm)) ** 2 / 12.0 for one in self.links)
        low, high = self.worst_mm
        return max(low, mean - 3.0 * variance**0.5), min(high, mean + 3.0 * variance**0.5)

    @property
    def jams(self) -> bool:
        """Whether the worst case is below what is allowed, by more than rounding."""
        return self.worst_mm[0] < self.least_mm - 1e-9

    @property
    def text(self) -> str:
        """What jams, how much is missing, and where it comes from."""
        low, _ = self.worst_mm
        return (
            f"{self.name} = {low:.3f} mm at worst: must be at least {self.least_mm:g} mm; {self.cure} "
            f"({'; '.join(one.text for one in self.links)})"
        )


def deviations(lower_mm: float, upper_mm: float) -> str:
    """Return limits in words, the upper one first, such as ``+0.05 / 0`` or ``±0.1``."""
    if np.isclose(lower_mm, -upper_mm):
        return f"±{upper_mm:g}"
    return " / ".join("0" if abs(limit) < 1e-12 else f"{limit:+g}" for limit in (upper_mm, lower_mm))
