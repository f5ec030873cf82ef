"""Every gear set that the search looks at, what the rules say of it, and the mass of those that matter.

Most gear sets are ruled out by teeth and room alone. What costs more is worked out for the others only: first the
layout and the rules that need it, then the mass, and last the rating.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.actuator import actuator_mass_kg
from pareto_monoped.actuator.gearset import GearSet, joined
from pareto_monoped.actuator.layout import Family, Layout, layout
from pareto_monoped.actuator.motor import Motor
from pareto_monoped.actuator.rating.build import build_stage
from pareto_monoped.actuator.rating.stage import Stage
from pareto_monoped.actuator.rating.width import (
    LOAD_RULES,
    STRENGTH_RULES,
    WidthBounds,
    face_width_mm,
    least_width_mm,
    strength_margins,
    width_bounds,
)
from pareto_monoped.actuator.ratiomap import RATIO_HIGH, RATIO_LOW
from pareto_monoped.actuator.rules import CONSTRAINTS, CandidateSets, active_rules, violations
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.design import ConstraintName
from pareto_monoped.geometry.shapes import Floats, Numbers

_BEYOND_MM = 12.0
"""How far beyond the room candidates are enumerated, so that the rules can say why a gearbox is missing."""
_TEETH_LEAST = 12
"""Fewest teeth enumerated, for the same reason and for searches with ``teeth_min`` off."""


def candidates(room_mm: float, settings: ActuatorSettings) -> GearSet:
    """Return every gear set with Nr = Ns + 2 Np, a ratio in the map's range, and m Nr not far beyond the room."""
    sets = []
    intervals = (10 * RATIO_LOW, 10 * RATIO_HIGH)
    for module in settings.modules_mm:
        ring_most = int((room_mm + _BEYOND_MM) / module)
        least = min(_TEETH_LEAST, settings.teeth_min)
        sun, planet = np.meshgrid(
            np.arange(least, ring_most, dtype=np.int64),
            np.arange(least, ring_most // 2 + 1, dtype=np.int64),
            indexing="ij",
        )
        ring = sun + 2 * planet
        tenths = interval_tenths(sun, ring)
        keep = (ring <= ring_most) & (tenths >= intervals[0]) & (tenths < intervals[1])
        for planets in range(settings.planets_least, settings.planets_max + 1):
            shape = int(keep.sum())
            sets.append((sun[keep], planet[keep], ring[keep], np.full(shape, module), np.full(shape, planets)))
    columns = [np.concatenate(column).astype(np.float64) for column in zip(*sets, strict=True)]
    gears = GearSet(
        sun_teeth=columns[0],
        planet_teeth=columns[1],
        ring_teeth=columns[2],
        module_mm=columns[3],
        planets=columns[4],
        backlash_mm=settings.tooth_thinning_mm(columns[3]),
        tips_fitted=settings.rules == "iso6336",
    )
    return _with_shifts(gears, room_mm, settings)


def _with_shifts(gears: GearSet, room_mm: float, settings: ActuatorSettings) -> GearSet:
    """Return the gear sets with every shift, and with the first one only if they do not mesh or exceed the room."""
    first, *others = settings.shift_choices
    everything = gears.shifted(*first) if any(first) else gears
    if not others:
        return everything
    meshing = (gears.sun_teeth + gears.ring_teeth) % gears.planets == 0.0
    hopeful = gears.where(np.asarray(meshing & (2.0 * gears.ring_pitch_radius_mm <= room_mm)))
    return joined([everything, *(hopeful.shifted(*shifts) for shifts in others)])


def interval_tenths(sun_teeth: NDArray[np.int64], ring_teeth: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the lower end of the half-open interval [g, g + 0.1) of the ratio in tenths; exact, in integers."""
    return 10 * (sun_teeth + ring_teeth) // sun_teeth


_NEAR = 32
"""How many sets of every interval are looked at first, the lightest at the least width that any set has."""
_FIRST = 4
"""How many sets of every interval are rated first, the lightest at a width that they cannot go below."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Judged:
    """What the rules say of every gear set of a family; arrays of shape (n,)."""

    gears: GearSet  #: the gear sets
    tenths: NDArray[np.int64]  #: lower end of each set's interval
    width_mm: Floats  #: face width
    mass_kg: Floats  #: infinite for sets that cannot be built, or need not be weighed
    names: tuple[ConstraintName, ...]  #: of the rules
    broken: NDArray[np.bool_]  #: which of them each set breaks, shape (names, n)
    #: Sets that are solutions or are kept out by a single rule, as far as these may be lighter than the two lightest of
    #: their interval
    considered: NDArray[np.bool_]

    @property
    def nearness(self) -> Floats:
        """How far each set is from a solution: rules broken, or 0.5 where a weaker motor would keep all.

        A set that fits and is too weak is nearest: steel and safety can be chosen, whole numbers cannot.
        """
        weak, count = np.isin(self.names, list(LOAD_RULES)), self.broken.sum(axis=0)
        missing: Floats = np.where(self.broken[~weak].any(axis=0), count, np.minimum(count, 0.5))
        return missing


@dataclass(frozen=True, slots=True, kw_only=True)
class Judge:
    """Applies the rules to arrays of gear sets of one motor and family."""

    motor: Motor
    family: Family
    settings: ActuatorSettings

    def judge(self, gears: GearSet) -> Judged:
        """Judge all sets under the rules of the settings."""
        if self.settings.rules == "paper":
            screen = _Screen(self, gears, np.asarray(face_width_mm(gears, self.motor, self.family, self.settings)))
            near = screen.broken.sum(axis=0) <= 1
            mass = np.full(len(near), np.inf)
            mass[near] = self.mass_kg(screen.gears.where(near), screen.width_mm[near])
            return screen.judged(mass, near)
        data = self.settings.parts.rating
        width = np.maximum(data.face_width_min_mm, data.face_modules_min * gears.module_mm)
        return self._by_rating(_Screen(self, gears, width))

    def _by_rating(self, screen: "_Screen") -> Judged:
        """Judge all sets under the rules ``iso6336``.

        To rate a gear set costs more than all other rules together. Sets that break more than one of the others at the
        least face width are neither solutions nor kept out by a single rule, and are not rated. Nor are sets that are
        too heavy at a width that they cannot go below: no set is lighter with a wider face.
        """
        rating = _Rating(screen)
        count = screen.broken.sum(axis=0)
        fitting = np.flatnonzero(count == 0)
        rating.rate_fitting(fitting)
        rating.rate_kept_out(np.flatnonzero(count == 1), screen.tenths[fitting])
        return screen.judged(rating.mass_kg, rating.rated)

    def layout(self, gears: GearSet, width_mm: Floats) -> Layout:
        """Return what lies around gear sets of these widths."""
        return layout(self.motor, self.family, gears, width_mm, self.settings)

    def mass_kg(self, gears: GearSet, width_mm: Floats) -> Floats:
        """Return the mass of the actuators; infinite where the catalogue has no main bearing."""
        at = self.layout(gears, width_mm)
        mass = np.asarray(actuator_mass_kg(at, self.motor, self.family, self.settings))
        return np.where(np.isnan(mass), np.inf, mass)

    def sets(
        self, gears: GearSet, width_mm: Floats, at: Layout | None, strength: Mapping[str, Numbers] | None = None
    ) -> CandidateSets:
        """Return the gear sets as the rules look at them."""
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

    def __init__(self, judge: Judge, gears: GearSet, width_mm: Floats) -> None:
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

    def judged(self, mass_kg: Floats, considered: NDArray[np.bool_]) -> Judged:
        """Return the verdict, complete wherever an interval has no solution and its nearest sets name the rules."""
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


class _Rating:
    """Face width, strength and mass under ``iso6336`` of those gear sets that may matter."""

    def __init__(self, screen: "_Screen") -> None:
        self.screen, self.judge = screen, screen.judge
        self.mass_kg = np.full(len(screen.width_mm), np.inf)  # infinite for sets that are not rated
        self.rated = np.zeros(len(screen.width_mm), dtype=bool)

    def rate(self, some: "_Bounded") -> None:
        """Find width, broken rules and mass of some sets."""
        rows, stage = some.rows, some.stage
        if not len(rows):
            return
        screen, judge = self.screen, self.judge
        width = least_width_mm(stage, judge.settings.constraints_off, some.bounds)
        strength = strength_margins(stage.safeties(width), stage)
        screen.width_mm[rows] = width
        asked = np.array([CONSTRAINTS[name].of_width for name in screen.names])
        names = tuple(name for name, ask in zip(screen.names, asked, strict=True) if ask)
        broken = violations(judge.sets(stage.gears, width, None, strength), names)[1]
        screen.broken[np.ix_(np.flatnonzero(asked), rows)] = broken
        self.mass_kg[rows] = judge.mass_kg(stage.gears, width)
        self.rated[rows] = True

    def lightest(self, place: int) -> Floats:
        """Return the mass of the rated solution with this place in its interval, by tenths; infinite where none is."""
        solved = self.rated & ~self.screen.broken.any(axis=0)
        tenths, mass = self.screen.tenths, np.where(solved, self.mass_kg, np.inf)
        found = np.full(10 * RATIO_HIGH, np.inf)
        known = np.flatnonzero(np.isfinite(mass))
        chosen = known[rank(tenths[known], mass[known]) == place]
        found[tenths[chosen]] = mass[chosen]
        return found

    def rate_fitting(self, rows: NDArray[np.intp]) -> None:
        """Rate sets that break no other rule, as far as they may be lighter than the second of their interval.

        The lightest of each interval are looked at first. Of these, as of the others, a few are rated first: most are
        then too heavy even at the least width. A set that no width makes strong enough may be lighter too: then its
        strength alone keeps it out.
        """
        tenths, light = self.screen.tenths[rows], self._at_least_width_kg(rows)
        near, second = rank(tenths, light) < _NEAR, np.full(len(rows), np.inf)
        for some in (near, ~near):
            left = np.flatnonzero(some & (light <= second))
            if not len(left):
                continue
            bounded = self._bounded(rows[left])
            least = bounded.least_mass_kg(self.judge)
            hopeful = np.where(bounded.bounds.hopeless, np.inf, least)
            first = (rank(tenths[left], hopeful) < _FIRST) & np.isfinite(hopeful)
            self.rate(bounded.where(first))
            second = self.lightest(1)[tenths]
            self.rate(bounded.where(~first & (least <= second[left])))
            second = self.lightest(1)[tenths]

    def rate_kept_out(self, rows: NDArray[np.intp], fitting_tenths: NDArray[np.int64]) -> None:
        """Rate sets that break one other rule, where that matters.

        It does if they are lighter than the solution of their interval, or if the interval has neither a solution nor a
        set that fits. Next to a solution, a set that no width makes strong enough breaks a second rule and does not
        matter.
        """
        tenths = self.screen.tenths[rows]
        lightest = self.lightest(0)[tenths]
        rivals = np.isfinite(lightest)
        least = np.full(len(rows), np.inf)
        least[rivals] = self._at_least_width_kg(rows[rivals])
        chosen = (least <= lightest) & (rivals | ~np.isin(tenths, fitting_tenths))
        bounded = self._bounded(rows[chosen])
        hopeful = ~(rivals[chosen] & bounded.bounds.hopeless)
        bounded = bounded.where(hopeful)
        self.rate(bounded.where(bounded.least_mass_kg(self.judge) <= lightest[chosen][hopeful]))

    def _at_least_width_kg(self, rows: NDArray[np.intp]) -> Floats:
        """Return the masses of sets that are not rated, at the least face width of their modules."""
        return self.judge.mass_kg(self.screen.gears.where(rows), self.screen.width_mm[rows])

    def _bounded(self, rows: NDArray[np.intp]) -> "_Bounded":
        judge = self.judge
        stage = build_stage(self.screen.gears.where(rows), judge.motor, judge.family, judge.settings)
        return _Bounded(rows=rows, stage=stage, bounds=width_bounds(stage, judge.settings.constraints_off))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Bounded:
    """Some of the gear sets of a screen."""

    rows: NDArray[np.intp]  #: which
    stage: Stage  #: they, to be rated
    bounds: WidthBounds  #: of their widths

    def where(self, mask: NDArray[np.bool_]) -> "_Bounded":
        """Return some of the sets."""
        return _Bounded(rows=self.rows[mask], stage=self.stage.rows(mask), bounds=self.bounds.where(mask))

    def least_mass_kg(self, judge: Judge) -> Floats:
        """Return the masses that the sets do not go below."""
        return judge.mass_kg(self.stage.gears, self.bounds.floor_mm)


def rank(groups: NDArray[np.int64], values: Floats) -> NDArray[np.intp]:
    """Return the place of each value among those of its group, from 0."""
    order = np.lexsort((values, groups))
    first = np.searchsorted(groups[order], groups[order])
    rank = np.empty(len(order), dtype=np.intp)
    rank[order] = np.arange(len(order)) - first
    return rank
