"""The result of stage 1: for every interval of ratios the lightest actuator, or the rules that forbid one.

Hip and knee may have different motors, and then have two maps.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.layout import Family
from pareto_monoped.actuator.motor import Motor
from pareto_monoped.actuator.rating.width import LOAD_RULES
from pareto_monoped.actuator.rules import CONSTRAINTS
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.design import ConstraintName
from pareto_monoped.errors import DesignError, MotorError
from pareto_monoped.geometry.shapes import Floats

RATIO_LOW = 4
RATIO_HIGH = 15
RATIO_STEP = 0.1
"""The map covers the half-open intervals [4.0, 4.1) to [14.9, 15.0) (paper, section III-A)."""
STAND_IN_WITHIN = 1.5
"""How far a gearbox may be from a ratio that has none and stand in for it, under the rules ``iso6336``.

Our own choice: it covers the paper's 7.9:1. Farther away, a robot has little to do with the one that was asked for.
"""
_EDGE_DECIMALS = 8
"""To which decimal ten times a ratio is rounded, so that 0.1 x 87, a hair below 8.7, is 8.7."""
_FAR = 1000.0
"""A ratio beyond any map."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """A gear set in a family, weighed."""

    family: Family
    gears: GearSet
    face_width_mm: float
    mass_kg: float


@dataclass(frozen=True, slots=True, kw_only=True)
class FamilyResult:
    """What the search found for one family in one interval."""

    best: Candidate | None  #: the lightest set, or None
    runner_up: Candidate | None  #: the next
    #: Names of constraints (``rules.CONSTRAINTS``). If there is a best set: each of them alone keeps out a lighter one.
    #: If there is none: the constraints that the nearest sets break; empty if no integer tooth set has such a ratio.
    in_the_way: tuple[ConstraintName, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class MapEntry:
    """One half-open interval [ratio_low, ratio_high)."""

    ratio_low: float  #: lower end
    actuator: Actuator | None  #: the lightest of both families, or None
    runner_up: Candidate | None  #: the second lightest of both families, or None
    families: Mapping[Family, FamilyResult]  #: what was found for each family that the motor has

    def __repr__(self) -> str:
        """One line: the interval and its gearbox."""
        found = "no gearbox" if self.actuator is None else repr(self.actuator)
        return f"MapEntry([{self.ratio_low:.1f}, {self.ratio_high:.1f}), {found})"

    @property
    def ratio_high(self) -> float:
        """Upper end, which belongs to the next interval."""
        return self.ratio_low + RATIO_STEP

    @property
    def binding(self) -> tuple[ConstraintName, ...]:
        """The constraints that alone keep out a lighter set of the chosen family."""
        return () if self.actuator is None else self.families[self.actuator.family].in_the_way

    @property
    def forbidden_by(self) -> Mapping[Family, tuple[ConstraintName, ...]]:
        """For each family without a gearbox here, the constraints in the way."""
        return {name: found.in_the_way for name, found in self.families.items() if found.best is None}

    def why_not(self) -> str:
        """Return one sentence on why there is no gearbox."""
        reasons = [
            f"{family}: {' or '.join(names) if names else 'no integer tooth set'}"
            for family, names in self.forbidden_by.items()
        ]
        return f"no gearbox in [{self.ratio_low:.1f}, {self.ratio_high:.1f}), forbidden by " + "; ".join(reasons)


# Compared by identity: there is one map per motor and settings, and results derived from it are cached under it.
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ActuatorMap:
    """Ratio -> lightest actuator, for one motor.

    Stage 2 searches over a continuous ratio. It gets the gearbox of the interval in which the ratio lies and simulates
    the real ratio of that gearbox, which differs from the searched one by less than 0.1. Under the rules ``iso6336``,
    an interval without a gearbox is served by the nearest one within ``STAND_IN_WITHIN``; ``stand_in`` says so.
    """

    motor: Motor
    settings: ActuatorSettings
    entries: tuple[MapEntry, ...]
    kept: bool = False  #: whether tables of its actuators are kept on disk, see ``files.kept``

    @property
    def key(self) -> str | None:
        """Everything that decides the map, in a text; None for a map of which nothing is kept on disk."""
        return repr((self.motor, self.settings)) if self.kept else None

    def __repr__(self) -> str:
        """One line: the motor, the rules, and how many ratios have a gearbox, of which mass."""
        masses = [entry.actuator.mass_kg for entry in self.entries if entry.actuator is not None]
        range_kg = f", {min(masses):.3f} to {max(masses):.3f} kg" if masses else ""
        counted = f"{len(masses)} of {len(self.entries)} intervals have a gearbox"
        return f"ActuatorMap({self.motor.name!r}, rules {self.settings.rules!r}, {counted}{range_kg})"

    def require_gearbox(self, source: str) -> None:
        """Refuse a motor that has no gearbox at any ratio: nothing can be built or simulated with it.

        Raises:
            MotorError: there is none; the message names the rules in the way and the motor's size, or its torque where
                gear sets fit and are too weak.
        """
        if any(entry.actuator is not None for entry in self.entries):
            return
        for entry in self.entries:
            for weak in entry.forbidden_by.values():
                if weak and set(weak) <= set(LOAD_RULES):
                    raise MotorError(
                        f"{source}: no gearbox is strong enough at any ratio from {RATIO_LOW} to {RATIO_HIGH}, in the "
                        f"way is peak_torque_n_m = {self.motor.peak_torque_n_m:.4g} ({', '.join(weak)}); "
                        f"choose a motor of less torque, or {either(cures(entry))}"
                    )
        motor, reasons = self.motor, []
        bodies: tuple[tuple[Family, str], ...] = (("ISSPG", "frameless"), ("ESSPG", "framed"))
        for family, body in bodies:
            names = sorted({name for entry in self.entries for name in entry.forbidden_by.get(family, ())})
            if names:
                reasons.append(
                    f"{body}.outer_diameter_mm = {getattr(motor, body).outer_diameter_mm:g} ({', '.join(names)})"
                )
        raise MotorError(
            f"{source}: no gearbox fits at any ratio from {RATIO_LOW} to {RATIO_HIGH}, in the way is "
            f"{' and '.join(reasons) or 'the torque'}; choose a larger motor or correct the file"
        )

    def interval_index(self, ratios: ArrayLike) -> NDArray[np.intp]:
        """Return indices into ``entries`` of the gearboxes for ratios, shape (n,) -> (n,); -1 where there is none."""
        index = _index(np.asarray(ratios, dtype=np.float64))
        inside = (index >= 0) & (index < len(self.entries))
        return np.where(inside, _serving(self)[np.where(inside, index, 0)], -1)

    def stand_in(self, ratio: float) -> str:
        """Return one line on the gearbox that stands in at a ratio whose interval has none, otherwise ''."""
        index = int(self.interval_index([ratio])[0])
        if index < 0 or index == int(_index(np.asarray(ratio, dtype=np.float64))):
            return ""
        actuator = self.entries[index].actuator
        assert actuator is not None
        return (
            f"gear ratio {ratio:g}: {self.why_not(ratio)}; the nearest gearbox stands in, {actuator.family} "
            f"{actuator.gears}, {actuator.ratio:.4f}:1"
        )

    def entry(self, ratio: float) -> MapEntry:
        """Return the interval that the ratio lies in, or the one that stands in for it; it has an actuator.

        Raises:
            DesignError: the ratio lies outside the map, or no gearbox exists there; the message names the constraint.
        """
        index = int(self.interval_index([ratio])[0])
        if index < 0:
            raise DesignError(f"gear ratio = {float(ratio)!r}: {self.why_not(ratio)}; choose {self._existing()}")
        return self.entries[index]

    def lookup(self, ratio: float) -> Actuator:
        """Return the actuator of ``entry``; raises as it does."""
        actuator = self.entry(ratio).actuator
        assert actuator is not None
        return actuator

    def masses_kg(self, family: Family | None = None) -> Floats:
        """Return the least mass in every interval, of one family or both, shape (intervals,); NaN without gearbox."""
        masses = np.full(len(self.entries), np.nan)
        for index, entry in enumerate(self.entries):
            bests = [found.best for name, found in entry.families.items() if family in (None, name)]
            masses[index] = min((best.mass_kg for best in bests if best is not None), default=np.nan)
        return masses

    @property
    def ratios_low(self) -> Floats:
        """Lower ends of the intervals, shape (intervals,)."""
        return np.array([entry.ratio_low for entry in self.entries])

    def why_not(self, ratio: float) -> str:
        """Return why there is no gearbox for a ratio."""
        if not RATIO_LOW <= ratio < RATIO_HIGH:
            return (
                f"outside the map of {self.motor.name}, which covers {RATIO_LOW} up to but not including {RATIO_HIGH}"
            )
        entry = self.entries[min(int(_index(np.asarray(ratio))), len(self.entries) - 1)]
        reason = f"{self.motor.name} has {entry.why_not()}"
        return reason if self.settings.rules == "paper" else f"{reason}; would help: {either(cures(entry))}"

    def _existing(self) -> str:
        lows = [round(10 * entry.ratio_low) for entry in self.entries if entry.actuator is not None]
        if not lows:
            return "another motor"
        runs: list[list[int]] = []
        for low in lows:
            if runs and runs[-1][1] == low:
                runs[-1][1] = low + 1
            else:
                runs.append([low, low + 1])
        return " or ".join(f"[{start / 10:.1f}, {stop / 10:.1f})" for start, stop in runs)


@lru_cache(maxsize=16)
def _serving(actuator_map: ActuatorMap) -> NDArray[np.intp]:
    """Return for each interval the index of the entry whose gearbox serves it, shape (intervals,), or -1."""
    own = np.arange(len(actuator_map.entries))
    present = np.array([entry.actuator is not None for entry in actuator_map.entries])
    serving = np.where(present, own, -1)
    if actuator_map.settings.rules == "paper" or not present.any():
        return serving
    real = np.array([np.inf if entry.actuator is None else entry.actuator.ratio for entry in actuator_map.entries])
    away = np.abs(real - (actuator_map.ratios_low + 0.5 * RATIO_STEP)[:, None])
    nearest = np.argmin(away, axis=1)
    return np.where(present | (away[own, nearest] > STAND_IN_WITHIN), serving, nearest)


def cures(entry: MapEntry) -> tuple[str, ...]:
    """Return what would help the family that the fewest rules forbid, first of all one that lacks strength alone."""

    def effort(names: tuple[ConstraintName, ...]) -> tuple[bool, bool, int]:
        return not names, not set(names) <= set(LOAD_RULES), len(names)

    names = min(entry.forbidden_by.values(), key=effort, default=())
    found = tuple(dict.fromkeys(cure for name in names for cure in CONSTRAINTS[name].cures))
    return found or ("another motor",)


def either(choices: Sequence[str]) -> str:
    """Return ``a, b or c``."""
    return " or ".join(filter(None, (", ".join(choices[:-1]), choices[-1])))


def _index(ratios: Floats) -> NDArray[np.intp]:
    """Return the index of the interval that each ratio lies in; beyond the entries, or negative, outside the map."""
    return _tenths(np.where(np.isfinite(ratios), ratios, -1.0)) - 10 * RATIO_LOW


def _tenths(ratios: Floats) -> NDArray[np.intp]:
    """Return the lower end of each ratio's interval, in tenths.

    A ratio within 5e-10 below an interval's end counts to the next interval. Ratios far outside the map become
    ``_FAR``, because a whole number cannot hold any ratio.
    """
    near = np.clip(ratios, -_FAR, _FAR)
    return np.floor(np.round(10.0 * near, _EDGE_DECIMALS)).astype(np.intp)


@dataclass(frozen=True, slots=True, kw_only=True)
class JointMaps:
    """The gearboxes that hip and knee choose from: one map twice where both have the same motor.

    Compared by the identity of both maps, as ``ActuatorMap`` is.

    Raises:
        DesignError: the maps follow different rules.
    """

    hip: ActuatorMap  #: gearboxes of the hip's motor
    knee: ActuatorMap  #: those of the knee's

    def __post_init__(self) -> None:
        one, other = self.hip.settings.rules, self.knee.settings.rules
        if one != other:
            raise DesignError(
                f"rules of the hip's gearboxes = {one!r}: must be those of the knee's, {other!r}; build both maps with "
                "the same rules"
            )

    def of(self, joint: str) -> ActuatorMap:
        """Return the map of ``hip`` or ``knee``."""
        return {"hip": self.hip, "knee": self.knee}[joint]

    @property
    def rules(self) -> str:
        """Rules of all gearboxes, see ``actuator.settings``."""
        return self.hip.settings.rules

    @property
    def motors(self) -> tuple[Motor, ...]:
        """The motor of both joints, or that of the hip and that of the knee."""
        return (self.hip.motor,) if self.hip is self.knee else (self.hip.motor, self.knee.motor)

    @property
    def label(self) -> str:
        """Name of the motor, or the names of both, such as ``U8 hip, VT8020 knee``."""
        return motor_label(self.hip.motor.name, self.knee.motor.name)


Maps = ActuatorMap | JointMaps
"""The gearboxes of a robot; one map stands for both joints."""


def joint_maps(maps: Maps) -> JointMaps:
    """Return the gearboxes of both joints."""
    return maps if isinstance(maps, JointMaps) else JointMaps(hip=maps, knee=maps)


def motor_label(hip: str, knee: str) -> str:
    """Return the name of the motor of both joints, or the names of both motors with the joints."""
    return hip if hip == knee else f"{hip} hip, {knee} knee"
