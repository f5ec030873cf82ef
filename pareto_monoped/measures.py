"""The measures of a jump and of its audit: name, unit, meaning, direction, and how each is shown.

This is the only table of measures. ``jump.evaluate.Evaluations`` and ``jump.audit.Audits`` have one field per measure,
the database has one column per measure, and the report takes its labels from here.

``MEASURES`` is a tuple of ``Measure`` records, one for each measure of a jump.

Example:
    >>> from pareto_monoped import MEASURES
    >>> energy = next(one for one in MEASURES if one.name == "energy_j")
    >>> energy.unit, energy.direction, energy.text(15.36)
    ('J', 'minimise', '15.36 J')
"""

import difflib
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from pareto_monoped.design import BASE_START_HEIGHT_M

Direction = Literal["maximise", "minimise"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Measure:
    """One measure."""

    name: str  #: of the field, the database column and the JSON key; ends in the unit unless the value is a share
    unit: str  #: of the stored value, SI; "1" for a share
    meaning: str  #: what is measured, for documentation
    direction: Direction | None  #: which way is better; None where neither is
    label: str  #: what the measure is called in reports
    shown_unit: str  #: unit in reports
    decimals: int  #: decimals in reports, in the shown unit
    scale: float = 1.0  #: factor from the stored unit to the shown one
    #: Corner of the hypervolume when the measure is an objective; None where neither way is better. For the
    #: smaller-is-better ones it is more than any design with the VT8020 reaches within the paper's bounds (the greatest
    #: of 4,000 random ones, rounded up generously), for the others 0; for the height it is 0.55 m, a jump of 5 cm.
    reference: float | None = None
    short: str = ""  #: what the measure is called where there is little room

    @property
    def words(self) -> str:
        """The label without the formula that it may end in."""
        return self.label.removesuffix(f", {self.meaning}")

    def text(self, value: float) -> str:
        """``value`` in the stored unit, as it is shown, such as "12.3 mm"."""
        return f"{value * self.scale:.{self.decimals}f} {self.shown_unit}".removesuffix(" 1")


def _measure(
    name: str,
    unit: str,
    direction: Direction | None,
    meaning: str,
    label: str,
    decimals: int,
    shown: tuple[str, float] | None = None,
    *,
    reference: float | None = None,
    short: str = "",
) -> Measure:
    """A measure shown in the unit it is stored in, unless ``shown`` gives another unit and the factor to it.

    Without ``short``, the label is short enough.
    """
    shown_unit, scale = shown or (unit, 1.0)
    return Measure(
        name=name,
        unit=unit,
        meaning=meaning,
        direction=direction,
        label=label,
        shown_unit=shown_unit,
        decimals=decimals,
        scale=scale,
        reference=reference,
        short=short or label,
    )


def _safety(name: str, of: str, label: str, short: str) -> Measure:
    """The measure of a group of the strength check."""
    meaning = f"least safety factor over the required one of {of}; holds from 1 up"
    return _measure(name, "1", "maximise", meaning, label, 2, reference=0.0, short=short)


_PERCENT = ("%", 100.0)
_MM = ("mm", 1000.0)
_EFFICIENCY = f"m g (H - {BASE_START_HEIGHT_M:g} m) / E"

MEASURES: tuple[Measure, ...] = (
    _measure("height_m", "m", "maximise", "highest position of the base above the floor", "height", 3, reference=0.55),
    _measure(
        "energy_j",
        "J",
        "minimise",
        "sum of max(torque * speed, 0) dt over both motors up to the apex (paper, section III-B)",
        "energy",
        2,
        reference=100.0,
    ),
    _measure(
        "energy_hip_j",
        "J",
        "minimise",
        "the hip motor's part of energy_j",
        "energy of the hip",
        2,
        reference=100.0,
        short="E hip",
    ),
    _measure(
        "energy_knee_j",
        "J",
        "minimise",
        "the knee motor's part of energy_j",
        "energy of the knee",
        2,
        reference=100.0,
        short="E knee",
    ),
    _measure(
        "absorbed_j",
        "J",
        "minimise",
        "work that the joints do on the motors",
        "work absorbed by the motors",
        2,
        reference=20.0,
        short="absorbed",
    ),
    _measure(
        "drive_loss_j",
        "J",
        "minimise",
        "energy lost in gearboxes and chain",
        "lost in gears and chain",
        2,
        reference=10.0,
        short="losses",
    ),
    _measure(
        "joule_heat_j",
        "J",
        "minimise",
        "heat in both windings: sum of R (torque / (ratio k_t))^2 dt; not part of energy_j",
        "heat in the windings",
        2,
        reference=200.0,
        short="heat",
    ),
    _measure(
        "foot_clearance_m",
        "m",
        "maximise",
        "gap between foot and floor at the apex",
        "foot clearance at the apex",
        0,
        _MM,
        reference=0.0,
        short="clear.",
    ),
    _measure("lift_off_s", "s", None, "time of the last contact with the floor, from the start", "lift-off", 3),
    _measure("apex_s", "s", None, "time of the apex, from the start", "apex", 3),
    _measure("mass_kg", "kg", "minimise", "mass of the whole robot", "mass", 3, reference=10.0),
    _measure(
        "peak_torque_hip_n_m",
        "N m",
        "minimise",
        "largest torque at the hip before losses",
        "peak torque, hip",
        1,
        reference=50.0,
        short="T hip",
    ),
    _measure(
        "peak_torque_knee_n_m",
        "N m",
        "minimise",
        "largest torque at the knee before losses",
        "peak torque, knee",
        1,
        reference=100.0,
        short="T knee",
    ),
    _measure(
        "peak_speed_hip_rad_per_s",
        "rad/s",
        "minimise",
        "largest speed of the hip joint",
        "peak speed, hip",
        1,
        reference=50.0,
        short="w hip",
    ),
    _measure(
        "peak_speed_knee_rad_per_s",
        "rad/s",
        "minimise",
        "largest speed of the knee joint",
        "peak speed, knee",
        1,
        reference=100.0,
        short="w knee",
    ),
    _measure(
        "peak_power_hip_w",
        "W",
        "minimise",
        "largest power at the hip before losses",
        "peak power, hip",
        0,
        reference=500.0,
        short="P hip",
    ),
    _measure(
        "peak_power_knee_w",
        "W",
        "minimise",
        "largest power at the knee before losses",
        "peak power, knee",
        0,
        reference=2000.0,
        short="P knee",
    ),
    _measure(
        "saturation_hip",
        "1",
        "minimise",
        "share of the controlled time that the hip spends at a torque limit",
        "time at the torque limit, hip",
        1,
        _PERCENT,
        reference=1.0,
        short="sat. hip",
    ),
    _measure(
        "saturation_knee",
        "1",
        "minimise",
        "share of the controlled time that the knee spends at a torque limit",
        "time at the torque limit, knee",
        1,
        _PERCENT,
        reference=1.0,
        short="sat. knee",
    ),
    _measure(
        "efficiency",
        "1",
        "maximise",
        _EFFICIENCY,
        f"efficiency, {_EFFICIENCY}",
        1,
        _PERCENT,
        reference=0.0,
        short="effic.",
    ),
    _measure(
        "electrical_energy_j",
        "J",
        "minimise",
        "energy taken from the battery: sum over both motors of max(power + heat in the winding, 0) dt, and standby",
        "energy from the battery",
        2,
        reference=200.0,
        short="battery",
    ),
    _measure(
        "sustained_jumps_per_minute",
        "1/min",
        "maximise",
        "jumps per minute whose winding heat the hotter motor can shed: its continuous loss over its heat of one jump",
        "jumps per minute sustained",
        1,
        reference=0.0,
        short="jumps",
    ),
    _measure(
        "peak_gear_torque_hip_n_m",
        "N m",
        "minimise",
        "largest torque that the hip's gearbox transmits, at its output",
        "peak gear torque, hip",
        1,
        reference=200.0,
        short="gear hip",
    ),
    _measure(
        "peak_gear_torque_knee_n_m",
        "N m",
        "minimise",
        "largest torque that the knee's gearbox transmits, at its output",
        "peak gear torque, knee",
        1,
        reference=500.0,
        short="gear knee",
    ),
    _measure(
        "peak_chain_tension_n",
        "N",
        "minimise",
        "largest pull in the chain",
        "peak chain tension",
        0,
        reference=20000.0,
        short="chain",
    ),
    _measure(
        "peak_stop_torque_n_m",
        "N m",
        "minimise",
        "largest torque of an end stop",
        "peak torque of an end stop",
        1,
        reference=500.0,
        short="stop",
    ),
    _measure(
        "stop_energy_j",
        "J",
        "minimise",
        "energy that the end stops take",
        "energy into the end stops",
        2,
        reference=100.0,
        short="stop",
    ),
    _measure(
        "peak_foot_force_n",
        "N",
        "minimise",
        "largest force of the floor on the foot",
        "peak foot force",
        0,
        reference=500.0,
        short="foot",
    ),
    _measure(
        "drift_m",
        "m",
        "minimise",
        "sideways distance of the base from its start at the apex",
        "sideways drift",
        0,
        _MM,
        reference=0.5,
        short="drift",
    ),
    _measure(
        "peak_stop_torque_hip_n_m",
        "N m",
        "minimise",
        "largest torque of the hip's end stops",
        "peak torque of an end stop, hip",
        1,
        reference=500.0,
        short="stop hip",
    ),
    _measure(
        "peak_stop_torque_knee_n_m",
        "N m",
        "minimise",
        "largest torque of the knee's end stops",
        "peak torque of an end stop, knee",
        1,
        reference=500.0,
        short="stop knee",
    ),
    _measure(
        "stop_compression_hip",
        "1",
        "minimise",
        "largest compression of the hip's bumpers, as a share of their travel",
        "bumper compressed, hip",
        0,
        _PERCENT,
        reference=2.0,
        short="comp. hip",
    ),
    _measure(
        "stop_compression_knee",
        "1",
        "minimise",
        "largest compression of the knee's bumpers, as a share of their travel",
        "bumper compressed, knee",
        0,
        _PERCENT,
        reference=2.0,
        short="comp. knee",
    ),
    _measure(
        "peak_knee_force_n",
        "N",
        "minimise",
        "largest force between thigh and shank: bearings, chain and end stop together",
        "peak force at the knee",
        0,
        reference=5000.0,
        short="F knee",
    ),
    _safety("gear_safety", "gears under the jump's largest torque", "strength of the gears", "gears ok"),
    _safety("chain_safety", "the chain and its turnbuckles", "strength of the chain", "chain ok"),
    _safety("stop_safety", "bumpers, seats and strikers of the end stops", "strength of the end stops", "stops ok"),
    _safety("joint_safety", "screws, pins, fits and shafts", "strength of the joints", "joints ok"),
    _safety("link_safety", "plates, cores and rods", "strength of the links", "links ok"),
    _safety(
        "gear_strike_safety",
        "gears that the largest torque strikes in every jump of their duty (it informs: nothing requires it by itself)",
        "gears struck in every jump",
        "strikes",
    ),
    # D. W. Haldane, M. M. Plecnik, J. K. Yim, R. S. Fearing, "Robotic vertical jumping agility via series-elastic power
    # modulation", Science Robotics 1(1), 2016. Here the push starts with the jump.
    _measure(
        "agility_m_per_s",
        "m/s",
        "maximise",
        "vertical jumping agility: height gained over the time from the start of the push to the apex",
        "vertical jumping agility",
        2,
        reference=0.0,
        short="agility",
    ),
)
"""Every measure of a jump, with its name, unit, meaning and which way is better.

They stand in the order of the fields of ``jump.evaluate.Evaluations`` and of the database columns.
"""
MEASURE_NAMES: tuple[str, ...] = tuple(measure.name for measure in MEASURES)

_PERTURBED = "links moved by 1e-6"

AUDIT_MEASURES: tuple[Measure, ...] = (
    _measure(
        "energy_balance_error",
        "1",
        "minimise",
        "what the energy balance leaves open, as a share of the joint work",
        "energy balance open by",
        2,
        _PERCENT,
    ),
    _measure(
        "half_step_height_m", "m", "minimise", "change of height with half the step", "height, step halved", 2, _MM
    ),
    _measure(
        "half_step_energy",
        "1",
        "minimise",
        "relative change of energy with half the step",
        "energy, step halved",
        2,
        _PERCENT,
    ),
    _measure(
        "quarter_step_height_m",
        "m",
        "minimise",
        "change of height with a quarter of the step",
        "height, step quartered",
        2,
        _MM,
    ),
    _measure(
        "quarter_step_energy",
        "1",
        "minimise",
        "relative change of energy with a quarter of the step",
        "energy, step quartered",
        2,
        _PERCENT,
    ),
    _measure(
        "spread_height_m",
        "m",
        "minimise",
        "90th percentile of the change of height over perturbed designs",
        f"height, {_PERTURBED} (90th percentile)",
        2,
        _MM,
    ),
    _measure(
        "spread_energy",
        "1",
        "minimise",
        "90th percentile of the relative change of energy over perturbed designs",
        f"energy, {_PERTURBED} (90th percentile)",
        2,
        _PERCENT,
    ),
    _measure(
        "worst_height_m",
        "m",
        "minimise",
        "largest change of height over perturbed designs",
        f"height, {_PERTURBED} (worst)",
        2,
        _MM,
    ),
    _measure(
        "worst_energy",
        "1",
        "minimise",
        "largest relative change of energy over perturbed designs",
        f"energy, {_PERTURBED} (worst)",
        2,
        _PERCENT,
    ),
    _measure(
        "control_period_height_m",
        "m",
        "minimise",
        "change of height with a quarter of the control period",
        "height, control period quartered",
        2,
        _MM,
    ),
    _measure(
        "control_period_energy",
        "1",
        "minimise",
        "relative change of energy with a quarter of the control period",
        "energy, control period quartered",
        2,
        _PERCENT,
    ),
)
"""Every measure of an audit, in the order of the fields of ``jump.audit.Audits``."""

_COARSE = f"step doubled and {_PERTURBED}"

SCREEN_MEASURES: tuple[Measure, ...] = (
    _measure(
        "double_step_height_m",
        "m",
        "minimise",
        "change of height with twice the step, of a perturbed design",
        f"height, {_COARSE}",
        2,
        _MM,
    ),
    _measure(
        "double_step_energy",
        "1",
        "minimise",
        "relative change of energy with twice the step, of a perturbed design",
        f"energy, {_COARSE}",
        2,
        _PERCENT,
    ),
    _measure(
        "double_step_balance_error",
        "1",
        "minimise",
        "what the energy balance of that jump leaves open, as a share of the joint work",
        "energy balance open by, step doubled",
        2,
        _PERCENT,
    ),
)
"""Every measure of the screen before an audit, in the order of the fields of ``jump.screen.Screened``."""

STATISTICS: dict[str, str] = {"mean": "mean", "p05": "5th percentile", "p95": "95th percentile"}
"""What can be asked of a measure under uncertainty: key behind the measure's name, as in "height_m.p05", and words."""

SHARE_MEASURES: tuple[Measure, ...] = (
    _measure(
        "failed_share",
        "1",
        "minimise",
        "share of the jumps under uncertainty that do not reach an apex",
        "jumps that fail",
        1,
        _PERCENT,
        reference=1.0,
        short="fail",
    ),
    _measure(
        "overloaded_share",
        "1",
        "minimise",
        "share of the jumps under uncertainty that exceed what some joint or part carries with its required safety",
        "jumps that overload a part",
        1,
        _PERCENT,
        reference=1.0,
        short="overload",
    ),
)
"""Measures of many jumps of one design, each with other values of what is uncertain."""


def _statistic_of(base: Measure, key: str) -> Measure:
    words = STATISTICS[key]
    return replace(
        base,
        name=f"{base.name}.{key}",
        meaning=f"{words} under uncertainty of: {base.meaning}",
        label=f"{base.words} ({words})",
        short=f"{base.short} {key}",
    )


ROBUST_MEASURES: tuple[Measure, ...] = (
    *SHARE_MEASURES,
    *(_statistic_of(base, key) for base in MEASURES for key in STATISTICS),
)
"""Every measure of a design under uncertainty; a study stores those that it asks for."""
ROBUST_NAMES: tuple[str, ...] = tuple(measure.name for measure in ROBUST_MEASURES)
GOAL_NAMES: tuple[str, ...] = (*MEASURE_NAMES, *ROBUST_NAMES)
"""What a study can ask for."""

OWN = "own_"
"""What the name of a measure that is a function of the user's own begins with."""
_OWN = re.compile(rf"{OWN}[A-Za-z_][A-Za-z0-9_]{{0,99}}")
OWN_REFERENCE = 1000.0
"""Corner of the hypervolume for an own objective whose study names none. Our own choice: nothing is known of the
function, and values beyond the corner add no volume, so it is far off."""

_BY_NAME = {measure.name: measure for measure in (*MEASURES, *AUDIT_MEASURES, *SCREEN_MEASURES, *ROBUST_MEASURES)}


def measure(name: str) -> Measure:
    """The measure called ``name``, of a jump, of a design under uncertainty, or of an audit.

    Raises:
        KeyError: there is none.
    """
    return _own_measure(name) if is_own(name) else _BY_NAME[name]


def is_own(name: object) -> bool:
    """Whether a measure is a function of the user's own, such as "own_landing_speed" for ``landing_speed``."""
    return isinstance(name, str) and _OWN.fullmatch(name) is not None


def is_goal(name: object) -> bool:
    """Whether a study can ask for a measure of that name."""
    return isinstance(name, str) and (name in GOAL_NAMES or is_own(name))


def _own_measure(name: str) -> Measure:
    """The measure that an own function is. Less is better; its unit is known only to the function."""
    function = name.removeprefix(OWN)
    words = function.replace("_", " ").strip()
    return Measure(
        name=name,
        unit="1",
        meaning=f"own function {function} of the measures",
        direction="minimise",
        label=words,
        shown_unit="1",
        decimals=4,
        reference=OWN_REFERENCE,
        short=words,
    )


def is_robust(name: str) -> bool:
    """Whether a measure is of many jumps under uncertainty."""
    return name in _ROBUST


def nominal(name: str) -> str:
    """The measure of a single jump that a name is about: "height_m" for itself and for "height_m.p05"."""
    return name.partition(".")[0]


_ROBUST = frozenset(ROBUST_NAMES)

_MOST_NEAR = 3
"""Names that are told of those nearest to one that is unknown; our own choice: a line holds them."""


def near_measures(name: object, known: Sequence[str]) -> str:
    """The cure for an unknown name: the most similar one, or the nearest few and where all are.

    Args:
        name: as it was given.
        known: names that may be given.
    """
    if near := difflib.get_close_matches(str(name), known, n=1):
        return f"did you mean {near[0]!r}?"
    plain = [one for one in known if not is_robust(one)]
    few = difflib.get_close_matches(str(name), plain, n=_MOST_NEAR, cutoff=0.0)
    return f"the nearest are {', '.join(few)}; docs/reference/measures.md and the columns of 'trials DB' have all"
