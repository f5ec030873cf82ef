"""What the rules say of thousands of gear sets at once, and what those that matter weigh.

Most gear sets are ruled out by teeth and room alone. What costs more is worked out for the others only: first the
layout and the rules that need it, then the mass, and last the rating.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.actuator import actuator_mass_kg
from pareto_monoped.actuator.candidates import interval_tenths
from pareto_monoped.actuator.face import face_width_mm, rated_width_mm
from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.layout import Family, Layout, layout
from pareto_monoped.actuator.motors import Motor
from pareto_monoped.actuator.rating.width import LOAD_RULES, STRENGTH_RULES
from pareto_monoped.actuator.ratiomap import RATIO_HIGH
from pareto_monoped.actuator.rules import CONSTRAINTS, CandidateSets, active_rules, violations
from pareto_monoped.actuator.settings import ActuatorSettings, ConstraintName
from pareto_monoped.geometry.shapes import Numbers

_FIRST = 8
"""How many sets of every interval are rated first, the lightest at the least face width."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Judged:
    """What the rules say of every gear set of a family; arrays of shape (n,).

    Attributes:
        gears: the gear sets.
        tenths: lower end of each set's interval.
        width_mm, mass_kg: face width and mass; infinite mass for sets that cannot be built, or need not be weighed.
        names, broken: rules, and which of them each set breaks, shape (names, n).
        considered: sets that are solutions or are kept out by a single rule, as far as these may be lighter than the
            two lightest of their interval.
    """

    gears: GearSet
    tenths: NDArray[np.int64]
    width_mm: NDArray[np.float64]
    mass_kg: NDArray[np.float64]
    names: tuple[ConstraintName, ...]
    broken: NDArray[np.bool_]
    considered: NDArray[np.bool_]

    @property
    def nearness(self) -> NDArray[np.float64]:
        """How far each set is from a solution: rules broken, or 0.5 where a weaker motor would keep all.

        A set that fits and is too weak is nearest: steel and safety can be chosen, whole numbers cannot.
        """
        weak, count = np.isin(self.names, list(LOAD_RULES)), self.broken.sum(axis=0)
        return np.where(self.broken[~weak].any(axis=0), count, np.minimum(count, 0.5))


@dataclass(frozen=True, slots=True, kw_only=True)
class Judge:
    """Applies the rules to arrays of gear sets of one motor and family."""

    motor: Motor
    family: Family
    settings: ActuatorSettings

    def judge(self, gears: GearSet) -> Judged:
        """All sets under the rules of the settings."""
        if self.settings.rules == "paper":
            screen = _Screen(self, gears, np.asarray(face_width_mm(gears, self.motor, self.family, self.settings)))
            return self._by_lewis(screen)
        data = self.settings.parts.rating
        width = np.maximum(data.face_width_min_mm, data.face_modules_min * gears.module_mm)
        return self._by_rating(_Screen(self, gears, width))

    def _by_lewis(self, screen: "_Screen") -> Judged:
        near = screen.broken.sum(axis=0) <= 1
        mass = np.full(len(near), np.inf)
        mass[near] = self.mass_kg(screen.gears.where(near), screen.width_mm[near])
        return screen.judged(mass, near)

    def _by_rating(self, screen: "_Screen") -> Judged:
        """All sets under the rules ``iso6336``.

        To rate a gear set costs more than all other rules together. Sets that break more than one of the others at the
        least face width are neither solutions nor kept out by a single rule, and are not rated. Nor are sets that are
        too heavy at the least face width already: first, the lightest of every interval there are rated, then all that
        may still be lighter than the second of them. Sets that break one rule come last, where a lighter set has been
        kept out or no other set is near.
        """
        gears, width, tenths, broken = screen.gears, screen.width_mm, screen.tenths, screen.broken
        count = broken.sum(axis=0)
        mass, rated = np.full(len(width), np.inf), np.zeros(len(width), dtype=bool)

        def rate(todo: NDArray[np.intp]) -> None:
            chosen = gears.where(todo)
            width[todo], strength = rated_width_mm(chosen, self.motor, self.family, self.settings)
            at = self.layout(chosen, width[todo])
            broken[:, todo] = violations(self.sets(chosen, width[todo], at, strength))[1]
            mass[todo] = self._mass_kg(at)
            rated[todo] = True

        def bound(place: int) -> NDArray[np.float64]:
            return _lightest(tenths, np.where(rated & ~broken.any(axis=0), mass, np.inf), place)

        # No set is lighter with a wider face.
        fitting, kept_out = np.flatnonzero(count == 0), np.flatnonzero(count == 1)
        least = self.mass_kg(gears.where(fitting), width[fitting])
        rate(fitting[_rank(tenths[fitting], least) < _FIRST])
        rate(fitting[~rated[fitting] & (least <= bound(1)[tenths[fitting]])])
        # What a rule keeps out matters where it is the lightest, and where nothing else comes near.
        lightest = bound(0)[tenths[kept_out]]
        rivals = kept_out[np.isfinite(lightest)]
        least = self.mass_kg(gears.where(rivals), width[rivals])
        alone = kept_out[np.isinf(lightest) & ~np.isin(tenths[kept_out], tenths[fitting])]
        rate(np.sort(np.concatenate([rivals[least <= bound(0)[tenths[rivals]]], alone])))
        return screen.judged(mass, rated)

    def layout(self, gears: GearSet, width_mm: NDArray[np.float64]) -> Layout:
        """What lies around gear sets of these widths."""
        return layout(self.motor, self.family, gears, width_mm, self.settings)

    def mass_kg(self, gears: GearSet, width_mm: NDArray[np.float64]) -> NDArray[np.float64]:
        """Mass of the actuators; infinite where the catalogue has no main bearing."""
        return self._mass_kg(self.layout(gears, width_mm))

    def _mass_kg(self, at: Layout) -> NDArray[np.float64]:
        mass = np.asarray(actuator_mass_kg(at, self.motor, self.family, self.settings))
        return np.where(np.isnan(mass), np.inf, mass)

    def sets(
        self,
        gears: GearSet,
        width_mm: NDArray[np.float64],
        at: Layout | None,
        strength: Mapping[str, Numbers] | None = None,
    ) -> CandidateSets:
        """Gear sets as the rules look at them."""
        return CandidateSets(
            gears=gears,
            face_width_mm=width_mm,
            at=at,
            motor=self.motor,
            family=self.family,
            settings=self.settings,
            strength=strength,
        )


class _Screen:
    """The rules other than those of strength, applied to every gear set as far as it matters.

    A set that breaks two rules of teeth and room is no solution and is not kept out by a single rule: ``broken`` then
    leaves out the rules that need a layout, until ``judged`` asks which sets are nearest.
    """

    def __init__(self, judge: Judge, gears: GearSet, width_mm: NDArray[np.float64]) -> None:
        self.judge, self.gears, self.width_mm = judge, gears, width_mm
        self.tenths = interval_tenths(np.asarray(gears.sun_teeth, np.int64), np.asarray(gears.ring_teeth, np.int64))
        self.names = active_rules(judge.settings)
        self.late = np.array([CONSTRAINTS[name].laid_out for name in self.names])
        self.broken = np.zeros((len(self.names), len(width_mm)), dtype=bool)
        unrated = None
        if judge.settings.rules == "iso6336":
            unrated = dict.fromkeys((*STRENGTH_RULES, "planet_bearing"), np.zeros(len(width_mm)))
        early = tuple(name for name, late in zip(self.names, self.late, strict=True) if not late)
        self.broken[~self.late] = violations(judge.sets(gears, width_mm, None, unrated), early)[1]
        self.known = self.broken.sum(axis=0) <= 1
        self._lay_out(np.flatnonzero(self.known))

    def _lay_out(self, rows: NDArray[np.intp]) -> None:
        """Apply the rules that need a layout to some of the sets."""
        gears, width = self.gears.where(rows), self.width_mm[rows]
        late = tuple(name for name, late in zip(self.names, self.late, strict=True) if late)
        broken = violations(self.judge.sets(gears, width, self.judge.layout(gears, width)), late)[1]
        self.broken[np.ix_(np.flatnonzero(self.late), rows)] = broken

    def judged(self, mass_kg: NDArray[np.float64], considered: NDArray[np.bool_]) -> Judged:
        """The verdict, complete wherever an interval has no solution and its nearest sets name the rules."""
        found = Judged(
            gears=self.gears,
            tenths=self.tenths,
            width_mm=self.width_mm,
            mass_kg=mass_kg,
            names=self.names,
            broken=self.broken,
            considered=considered,
        )
        solved = considered & ~self.broken.any(axis=0) & np.isfinite(mass_kg)
        left = ~self.known & ~np.isin(self.tenths, self.tenths[solved])
        nearest = np.full(10 * RATIO_HIGH, np.inf)
        np.minimum.at(nearest, self.tenths[self.known], found.nearness[self.known])
        self._lay_out(np.flatnonzero(left & (self.broken.sum(axis=0) <= nearest[self.tenths])))
        return found


def _rank(groups: NDArray[np.int64], values: NDArray[np.float64]) -> NDArray[np.intp]:
    """Place of each value among those of its group, from 0."""
    order = np.lexsort((values, groups))
    first = np.searchsorted(groups[order], groups[order])
    rank = np.empty(len(order), dtype=np.intp)
    rank[order] = np.arange(len(order)) - first
    return rank


def _lightest(tenths: NDArray[np.int64], mass_kg: NDArray[np.float64], place: int) -> NDArray[np.float64]:
    """For each interval, by its tenths, the lightest mass, or the next by ``place``; infinite where there is none."""
    found = np.full(10 * RATIO_HIGH, np.inf)
    known = np.flatnonzero(np.isfinite(mass_kg))
    chosen = known[_rank(tenths[known], mass_kg[known]) == place]
    found[tenths[chosen]] = mass_kg[chosen]
    return found
