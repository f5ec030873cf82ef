"""The least face width of gear sets: by all safety factors of a stage, or by Lewis with Barth's velocity factor."""

from collections.abc import Collection
from dataclasses import dataclass
from functools import reduce
from itertools import cycle

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.layout import Family
from pareto_monoped.actuator.motor import Motor
from pareto_monoped.actuator.rating.build import build_stage
from pareto_monoped.actuator.rating.stage import Safeties, Stage, required
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.shapes import Floats, Numbers

_SCAN = 12
"""Face widths that are tried first, evenly spread between the limits."""
_FLOOR_STEPS = 2
"""How often the floor of ``WidthBounds`` is raised: once leaves twice as many sets to rate, thrice saves no time."""
_HALVED = (False, False, False, False, False, True)
"""Whether a search halves the interval left instead of guessing: now and then, so that it ends soon in any case."""
_LOAD_EXPONENTS = Safeties(2.0, 1.0, 2.0, 1.0)
"""The load that a flank carries falls with the square of its safety factor, that of a root with the factor itself."""
STRENGTH_RULES = {
    "flank_strength": ("flank",),
    "root_strength": ("root",),
    "overload_strength": ("overload_flank", "overload_root"),
}
"""Rule -> which safety factors it is about."""
LOAD_RULES = frozenset((*STRENGTH_RULES, "output_bearing", "planet_bearing"))
"""Rules that a weaker motor would keep: gear sets that break no other fit, and are too weak."""


def strength_margins(safeties: Safeties, stage: Stage) -> dict[str, Numbers]:
    """Return the least safety factor over the required one, less 1, for each rule of strength."""
    least = required(stage.settings)
    return {
        rule: reduce(np.minimum, (getattr(safeties, name) / getattr(least, name) for name in names)) - 1.0
        for rule, names in STRENGTH_RULES.items()
    }


@dataclass(frozen=True, slots=True, kw_only=True)
class WidthBounds:
    """What a few evaluations say of the least width of each set.

    All load factors grow with the width, because the load per width falls while deviations and deflections do not. A
    set of width b whose safety factor is short by a share therefore needs at least so much more width: that share for
    a root, its square for a flank. Between the limits of the face width, safety grows with width until the
    misalignment, which grows too, eats the gain.
    """

    #: A width that ``least_width_mm`` does not go below; where ``hopeless``, the one that it returns
    floor_mm: Floats
    #: Sets for which the largest width is enough; so is every width between the least one and that
    enough: NDArray[np.bool_]
    #: Sets for which it is not enough, although safety still grows there, so that no width is
    hopeless: NDArray[np.bool_]

    def where(self, mask: NDArray[np.bool_]) -> "WidthBounds":
        """Return the bounds of some of the sets."""
        return WidthBounds(floor_mm=self.floor_mm[mask], enough=self.enough[mask], hopeless=self.hopeless[mask])


def width_bounds(stage: Stage, off: Collection[str] = ()) -> WidthBounds:
    """Return the bounds of arrays of gear sets; arguments as of ``least_width_mm``."""
    low, high = _limits(stage)
    most = _margin_and_need(stage, high, off)[0]
    enough = most >= 0.0
    # Otherwise a width between the limits may be enough, and if none is, any may be the best.
    floor, hopeless, before = low.copy(), ~enough, _tried(low, high)[-2]
    rows = np.flatnonzero(~enough)
    hopeless[rows] = _margin_and_need(stage.rows(rows), before[rows], off)[0] < most[rows]
    floor[hopeless] = high[hopeless]
    rows, part = np.flatnonzero(enough), stage.rows(enough)
    for _ in range(_FLOOR_STEPS):
        needed = np.ceil(np.round(_margin_and_need(part, floor[rows], off)[1], 6))
        floor[rows] = np.clip(needed, floor[rows], high[rows])
    return WidthBounds(floor_mm=_in_mm(floor, stage), enough=enough, hopeless=hopeless)


def least_width_mm(stage: Stage, off: Collection[str] = (), bounds: WidthBounds | None = None) -> Floats:
    """Return the least multiple of the step at which all safety factors are kept.

    Where the largest width is not enough, but safety no longer grows there, a few widths are tried first, to find the
    part where it grows. Guesses from what is needed then close in on the first width that is enough.

    ``off``: names of rules that need not be kept.

    Returns:
        The shape of the gear sets. Where no width is enough, the best of those tried.
    """
    shape = np.shape(stage.width_low_mm)
    low, high = _limits(stage)
    bounds = bounds or width_bounds(stage, off)
    floor = np.round(bounds.floor_mm / stage.settings.parts.rating.face_step_mm)
    good, bad, best = np.where(bounds.enough, high, np.nan), floor - 1.0, floor
    between = np.flatnonzero(~bounds.enough & ~bounds.hopeless)
    if len(between):
        found = _scanned(stage.rows(between), low[between], high[between], off)
        good[between], bad[between], best[between] = found
    # Invariant: enough at good, not enough at bad (or below the limit). Sets without any good width stay out.
    left = np.flatnonzero(good - bad > 1.0)
    part, tried = stage.rows(left), bad[left] + 1.0
    before = needed_before = np.full(len(left), np.nan)
    for halve in cycle(_HALVED):
        if not len(left):
            break
        margin, needed = _margin_and_need(part, tried, off)
        fits = margin >= 0.0
        good[left], bad[left] = np.where(fits, tried, good[left]), np.where(fits, bad[left], tried)
        # Where what is needed meets the width, if it goes on growing as it did.
        growth = np.where(tried != before, (needed - needed_before) / (tried - before), 0.0)
        growth = np.where(growth < 1.0, growth, 0.0)
        guess = tried + (needed - tried) / (1.0 - growth)
        before, needed_before = tried, needed
        wide = good[left] - bad[left] > 1.0
        left, part = left[wide], part if wide.all() else part.rows(wide)
        guess, before, needed_before = guess[wide], before[wide], needed_before[wide]
        if halve:
            guess = 0.5 * (good[left] + bad[left])
        tried = np.clip(np.ceil(guess), bad[left] + 1.0, good[left] - 1.0)
    return _in_mm(np.where(np.isfinite(good), good, best), stage).reshape(shape)


def _margin_and_need(stage: Stage, steps: Floats, off: Collection[str]) -> tuple[Floats, Floats]:
    """Return the least margin of strength at widths in steps, and what the worst flank or root needs at least.

    That is the width times the load over the one carried with the safety required.
    """
    found, least = stage.safeties(steps * stage.settings.parts.rating.face_step_mm), required(stage.settings)
    margins = [value for rule, value in strength_margins(found, stage).items() if rule not in off]
    shares = [
        (getattr(least, name) / getattr(found, name)) ** getattr(_LOAD_EXPONENTS, name)
        for rule, names in STRENGTH_RULES.items()
        if rule not in off
        for name in names
    ]
    margin = np.asarray(reduce(np.minimum, margins)) if margins else np.full(steps.shape, np.inf)
    return margin, steps * reduce(np.maximum, shares, np.zeros(steps.shape))


def _limits(stage: Stage) -> tuple[Floats, Floats]:
    """Return the least and largest width allowed, in steps; whole numbers."""
    step = stage.settings.parts.rating.face_step_mm
    low = np.atleast_1d(np.ceil(np.round(stage.width_low_mm / step, 6)))
    return low, np.maximum(low, np.atleast_1d(np.floor(np.round(stage.width_high_mm / step, 6))))


def _in_mm(steps: Floats, stage: Stage) -> Floats:
    step = stage.settings.parts.rating.face_step_mm
    # Divided by a whole number where there is one: 123 steps of 0.1 mm are then 12.3 mm to the last bit.
    return steps / round(1.0 / step) if round(1.0 / step) * step == 1.0 else steps * step


def _tried(low: Floats, high: Floats) -> list[Floats]:
    """Return the widths tried first, from the least to the largest, in steps."""
    return [np.round(low + share * (high - low)) for share in np.linspace(0.0, 1.0, _SCAN)]


def _scanned(stage: Stage, low: Floats, high: Floats, off: Collection[str]) -> tuple[Floats, Floats, Floats]:
    """Return the widths tried first, from ``low`` to ``high``; a set is left alone once a width is enough.

    Returns:
        The first that is enough, NaN where none is; the last before it, or ``low`` less 1; the best one where none is.
    """
    good, bad, best, most = np.full(low.shape, np.nan), low - 1.0, low.copy(), np.full(low.shape, -np.inf)
    left, part = np.arange(len(low)), stage
    for widths in _tried(low, high):
        tried = widths[left]
        found = _margin_and_need(part, tried, off)[0]
        enough = found >= 0.0
        good[left[enough]] = tried[enough]
        if enough.any():
            left, part = left[~enough], part.rows(~enough)
            tried, found = tried[~enough], found[~enough]
        if not len(left):
            break
        bad[left] = tried
        better = found > most[left]
        best[left[better]], most[left[better]] = tried[better], found[better]
    return good, bad, best


# Lewis form factor Y of 20 degree full-depth teeth over the number of teeth: Shigley, table 14-2.
_LEWIS = np.array(
    [
        (12, 0.245), (13, 0.261), (14, 0.277), (15, 0.290), (16, 0.296), (17, 0.303), (18, 0.309), (19, 0.314),
        (20, 0.322), (21, 0.328), (22, 0.331), (24, 0.337), (26, 0.346), (28, 0.353), (30, 0.359), (34, 0.371),
        (38, 0.384), (43, 0.397), (50, 0.409), (60, 0.422), (75, 0.435), (100, 0.447), (150, 0.460), (300, 0.472),
    ]
)  # fmt: skip
LEAST_WIDTH_MODULES = 6.0
"""Face width is at least this many modules (Niemann/Winter: 6 to 10 for narrow gears), where strength asks for less."""


def lewis_form_factor(teeth: Numbers) -> Floats:
    """Return Y, interpolated linearly; constant beyond the table's ends."""
    return np.asarray(np.interp(teeth, _LEWIS[:, 0], _LEWIS[:, 1]))


def velocity_factor(speed_m_per_s: Numbers) -> Numbers:
    """Return the Barth's factor for milled or hobbed teeth, (6.1 + v) / 6.1 (Shigley, eq. 14-6b)."""
    return (6.1 + speed_m_per_s) / 6.1


def lewis_width_mm(gears: GearSet, motor: Motor, settings: ActuatorSettings) -> Numbers:
    """Return the least face width at which the sun's teeth carry the motor's peak torque.

    Every mesh of the sun carries an equal share of the torque. The sun's teeth are the weakest: all ratios are 4 or
    more, so no planet has fewer teeth. The speed is that of the pitch point against the carrier, which decides how hard
    teeth strike each other. It is taken at the motor's no-load speed, an upper bound.
    """
    radius_m = 0.5e-3 * gears.module_mm * gears.sun_teeth
    force_n = settings.parts.gears.service_factor * motor.peak_torque_n_m / (radius_m * gears.planets)
    speed = motor.no_load_speed_rad_per_s * (1.0 - 1.0 / gears.ratio) * radius_m
    stress_mpa = settings.materials.gear_steel.allowable_stress_mpa / settings.parts.gears.factor_of_safety
    weakest = np.minimum(gears.sun_teeth, gears.planet_teeth)
    strong = velocity_factor(speed) * force_n / (stress_mpa * gears.module_mm * lewis_form_factor(weakest))
    return np.maximum(strong, LEAST_WIDTH_MODULES * gears.module_mm)


def face_width_mm(gears: GearSet, motor: Motor, family: Family, settings: ActuatorSettings) -> Numbers:
    """Return the least face width that carries the motor's torque; the best one if none does (``iso6336``)."""
    if settings.rules == "paper":
        return lewis_width_mm(gears, motor, settings)
    return np.asarray(least_width_mm(build_stage(gears, motor, family, settings), settings.constraints_off))[()]
