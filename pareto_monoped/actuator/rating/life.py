"""Load cycles of the duty, Miner's rule, and the S-N curves of ISO 6336-2 and ISO 6336-3."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.rating_data import DutyData
from pareto_monoped.geometry.shapes import Numbers
from pareto_monoped.materials import Treatment

_ENDLESS_CYCLES, _ENDLESS_FACTOR = 1e10, 0.85
"""Where both standards end the long-life line, and the life factor there for ordinary care."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LifeCurve:
    """An S-N curve: a static plateau, a straight line in logarithms to 1 at the reference, and a flat one beyond.

    Attributes:
        static_cycles: end of the plateau.
        static_factor: life factor on the plateau, Z_NT or Y_NT.
        reference_cycles: load cycles of the allowable stress numbers.
    """

    static_cycles: float
    static_factor: float
    reference_cycles: float

    @property
    def exponent(self) -> float:
        """Logarithmic slope of stress: factor = (reference / cycles) ** exponent."""
        return float(np.log(self.static_factor) / np.log(self.reference_cycles / self.static_cycles))

    def factor(self, cycles: Numbers) -> Numbers:
        """The life factor at a number of load cycles."""
        late = np.log(1.0 / _ENDLESS_FACTOR) / np.log(_ENDLESS_CYCLES / self.reference_cycles)
        ratio = self.reference_cycles / np.clip(cycles, self.static_cycles, _ENDLESS_CYCLES)
        return np.power(ratio, np.where(ratio >= 1.0, self.exponent, late))[()]


FLANK_CURVES: Mapping[Treatment, LifeCurve] = {
    "case_hardened": LifeCurve(static_cycles=1e5, static_factor=1.6, reference_cycles=5e7),
    "nitrided": LifeCurve(static_cycles=1e5, static_factor=1.3, reference_cycles=2e6),
    "through_hardened": LifeCurve(static_cycles=1e5, static_factor=1.6, reference_cycles=5e7),
}
"""Z_NT without pitting allowed: ISO 6336-2, table 2."""

ROOT_CURVES: Mapping[Treatment, LifeCurve] = {
    "case_hardened": LifeCurve(static_cycles=1e3, static_factor=2.5, reference_cycles=3e6),
    "nitrided": LifeCurve(static_cycles=1e3, static_factor=1.6, reference_cycles=3e6),
    "through_hardened": LifeCurve(static_cycles=1e4, static_factor=2.5, reference_cycles=3e6),
}
"""Y_NT: ISO 6336-3, table 1."""


def highest_share(duty: DutyData) -> float:
    """The torque share that equivalent cycles belong to: that of the peak torque, or of the highest level above it."""
    return max(1.0, *duty.torque_shares)


def reversal_ratio(duty: DutyData) -> float:
    """The highest torque of the less loaded direction over that of the other, from 0 to 1."""
    highest = [
        max((share for share, _ in levels), default=0.0) for levels in (duty.forward_levels, duty.reversed_levels)
    ]
    return min(highest) / max(highest)


def equivalent_cycles(
    passes_per_rad: Numbers, duty: DutyData, stress_exponent: float, *, flank: bool, both_ways: bool = False
) -> Numbers:
    """Load cycles at ``highest_share`` that do the damage of the whole spectrum (Miner; ISO 6336-6, annex A).

    A level of share s of the highest torque and n cycles counts as n s^p cycles at that torque. p is the slope of the
    S-N curve in terms of torque, whose square root the contact stress grows with. The line goes on to any number of
    cycles, so that small loads count too (elementary form of the rule). Within the sloping part this equals the
    standard's equivalent torque.

    Joints swing to and fro over the same few teeth. A tooth in the middle of the swing is loaded a whole number of
    times in each swing, so that passes are rounded up.

    Levels of reversed torque load the back flanks of sun and ring. Front and back have a spectrum each, of which the
    worse counts. Planets mesh with the ring on the flanks that the sun leaves free: all levels load both.

    Args:
        passes_per_rad: load cycles of a tooth per rad of the output.
        duty: the spectrum.
        stress_exponent: of the life curve.
        flank: whether contact stress is meant, or else bending stress.
        both_ways: whether all levels load either side, as in a planet.
    """
    slope, highest = (0.5 if flank else 1.0) / stress_exponent, highest_share(duty)

    def cycles(levels: tuple[tuple[float, float], ...]) -> Numbers:
        found = np.zeros(np.shape(passes_per_rad))[()]
        for share, angle in levels:
            found = found + np.ceil(np.round(passes_per_rad * angle, 9)) * (share / highest) ** slope
        return found

    front, back = cycles(duty.forward_levels), cycles(duty.reversed_levels)
    return duty.jumps * (front + back if both_ways else np.maximum(front, back))


def passes_per_rad(gears: GearSet) -> tuple[Numbers, Numbers, Numbers]:
    """Load cycles of a tooth's flank per rad of the output: of sun, planet and ring.

    Against the carrier, the sun turns i - 1 times per turn of the output and meets every planet in each turn. A planet
    meets the sun once in each of its own turns, and the ring with its other flanks.
    """
    turns = (gears.ratio - 1.0) / (2.0 * np.pi)
    return (
        gears.planets * turns,
        turns * gears.sun_teeth / gears.planet_teeth,
        gears.planets * turns * gears.sun_teeth / gears.ring_teeth,
    )
