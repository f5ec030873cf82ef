"""The measures of a jump and of its audit: name, unit, meaning, direction, and how each is shown.

This is the only list of measures: each is one annotated field of ``JumpMeasures``, ``AuditMeasures`` or
``ScreenMeasures``. Results have these fields, the database has one column per measure, and the report takes what it
lists, and how, from here.

``MEASURES`` has a ``Measure`` record for each measure of a jump, in their order and by name.

Example:
    >>> from pareto_monoped import MEASURES
    >>> energy = MEASURES["energy_j"]
    >>> energy.unit, energy.direction, energy.text(15.36)
    ('J', 'minimise', '15.36 J')
"""

import difflib
import re
from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from functools import partial
from typing import Annotated, Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import BASE_START_HEIGHT_M, Floats, Records

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
    #: Order among the measures that the page compares designs by, or shows of an audit; None: not among them
    place: int | None = field(default=None, repr=False)
    #: Whether the page shows and asks for it beside the objectives of every study
    leading: bool = field(default=False, repr=False)
    full: str = field(default="", repr=False)  #: what the page calls it, where other energies stand beside it
    axis: str = field(default="", repr=False)  #: what it is called beside an axis of the page's front
    #: What m g (H - start height) is called as a share of this energy; empty if it is no energy of a jump
    work_share: str = field(default="", repr=False)

    @property
    def words(self) -> str:
        """The label without the formula that it may end in."""
        return self.label.removesuffix(f", {self.meaning}")

    def text(self, value: float) -> str:
        """Return ``value`` in the stored unit, as it is shown, such as "12.3 mm"."""
        return f"{value * self.scale:.{self.decimals}f} {self.shown_unit}".removesuffix(" 1")


def _row(
    unit: str,
    decimals: int,
    label: str,
    meaning: str,
    *,
    direction: Direction | None = None,
    shown: tuple[str, float] | None = None,
    short: str = "",
    **more: Any,
) -> Measure:
    """Describe a measure, shown in its stored unit unless ``shown`` gives another unit and the factor to it."""
    shown_unit, scale = shown or (unit, 1.0)
    return Measure(
        name="",
        unit=unit,
        meaning=meaning,
        direction=direction,
        label=label,
        shown_unit=shown_unit,
        decimals=decimals,
        scale=scale,
        short=short or label,
        **more,
    )


_less, _more = partial(_row, direction="minimise"), partial(_row, direction="maximise")


def _safety(of: str, label: str, short: str, place: int | None = None) -> Measure:
    """Describe the measure of a group of the strength check."""
    meaning = f"least safety factor over the required one of {of}; holds from 1 up"
    return _more("1", 2, label, meaning, reference=0.0, short=short, place=place)


def _described(results: type) -> tuple[Measure, ...]:
    """Collect the measures that annotate the fields of a class of results."""
    described = ((one.name, about) for one in fields(results) for about in get_args(one.type)[1:])
    return tuple(replace(about, name=name) for name, about in described if isinstance(about, Measure))


_PERCENT = ("%", 100.0)
_MM = ("mm", 1000.0)
_EFFICIENCY = f"m g (H - {BASE_START_HEIGHT_M:g} m) / E"


@dataclass(frozen=True, slots=True, kw_only=True)
class JumpMeasures:
    """What n jumps measure, each of shape (n,): one field per measure, in the order of the database columns.

    A measure is NaN where the jump failed, except for mass, cost and counts of parts of a robot that could be built.
    ``status`` is one of ``jump.evaluate.STATUSES``; ``reason`` says why it is not ``ok``, and is empty where it is.
    """

    # fmt: off
    status: NDArray[np.str_]
    reason: tuple[str, ...]
    height_m: Annotated[Floats, _more("m", 3, "height", "highest position of the base above the floor", reference=0.55,
        place=10, axis="jump height of the base")]
    energy_j: Annotated[Floats, _less("J", 2, "energy",
        "sum of max(torque * speed, 0) dt over both motors up to the apex (paper, section III-B)", reference=100.0,
        place=20, leading=True, axis="mechanical energy from start to apex", full="mechanical energy",
        work_share="mechanical efficiency")]
    energy_hip_j: Annotated[Floats, _less("J", 2, "energy of the hip", "the hip motor's part of energy_j",
        reference=100.0, short="E hip")]
    energy_knee_j: Annotated[Floats, _less("J", 2, "energy of the knee", "the knee motor's part of energy_j",
        reference=100.0, short="E knee")]
    absorbed_j: Annotated[Floats, _less("J", 2, "work absorbed by the motors", "work that the joints do on the motors",
        reference=20.0, short="absorbed")]
    drive_loss_j: Annotated[Floats, _less("J", 2, "lost in gears and chain", "energy lost in gearboxes and chain",
        reference=10.0, short="losses")]
    joule_heat_j: Annotated[Floats, _less("J", 2, "heat in the windings",
        "heat in both windings: sum of R (torque / (ratio k_t))^2 dt; not part of energy_j", reference=200.0,
        short="heat")]
    foot_clearance_m: Annotated[Floats, _more("m", 0, "foot clearance at the apex",
        "gap between foot and floor at the apex", shown=_MM, reference=0.0, short="clear.")]
    lift_off_s: Annotated[Floats, _row("s", 3, "lift-off", "time of the last contact with the floor, from the start")]
    apex_s: Annotated[Floats, _row("s", 3, "apex", "time of the apex, from the start")]
    mass_kg: Annotated[Floats, _less("kg", 3, "mass", "mass of the whole robot", reference=10.0, place=40,
        leading=True)]
    peak_torque_hip_n_m: Annotated[Floats, _less("N m", 1, "peak torque, hip",
        "largest torque at the hip before losses", reference=50.0, short="T hip")]
    peak_torque_knee_n_m: Annotated[Floats, _less("N m", 1, "peak torque, knee",
        "largest torque at the knee before losses", reference=100.0, short="T knee")]
    peak_speed_hip_rad_per_s: Annotated[Floats, _less("rad/s", 1, "peak speed, hip", "largest speed of the hip joint",
        reference=50.0, short="w hip")]
    peak_speed_knee_rad_per_s: Annotated[Floats, _less("rad/s", 1, "peak speed, knee",
        "largest speed of the knee joint", reference=100.0, short="w knee")]
    peak_power_hip_w: Annotated[Floats, _less("W", 0, "peak power, hip", "largest power at the hip before losses",
        reference=500.0, short="P hip")]
    peak_power_knee_w: Annotated[Floats, _less("W", 0, "peak power, knee", "largest power at the knee before losses",
        reference=2000.0, short="P knee")]
    saturation_hip: Annotated[Floats, _less("1", 1, "time at the torque limit, hip",
        "share of the controlled time that the hip spends at a torque limit", shown=_PERCENT, reference=1.0,
        short="sat. hip")]
    saturation_knee: Annotated[Floats, _less("1", 1, "time at the torque limit, knee",
        "share of the controlled time that the knee spends at a torque limit", shown=_PERCENT, reference=1.0,
        short="sat. knee")]
    efficiency: Annotated[Floats, _more("1", 1, "efficiency, " + _EFFICIENCY, _EFFICIENCY, shown=_PERCENT,
        reference=0.0, short="effic.", full="mechanical efficiency, " + _EFFICIENCY)]
    electrical_energy_j: Annotated[Floats, _less("J", 2, "energy from the battery",
        "energy taken from the battery: sum over both motors of max(power + heat in the winding, 0) dt, and standby",
        reference=200.0, short="battery", place=30, leading=True, work_share="efficiency from the battery")]
    sustained_jumps_per_minute: Annotated[Floats, _more("1/min", 1, "jumps per minute sustained",
        "jumps per minute whose winding heat the hotter motor can shed: its continuous loss over its heat of one jump",
        reference=0.0, short="jumps", place=60)]
    peak_gear_torque_hip_n_m: Annotated[Floats, _less("N m", 1, "peak gear torque, hip",
        "largest torque that the hip's gearbox transmits, at its output", reference=200.0, short="gear hip", place=70)]
    peak_gear_torque_knee_n_m: Annotated[Floats, _less("N m", 1, "peak gear torque, knee",
        "largest torque that the knee's gearbox transmits, at its output", reference=500.0, short="gear knee",
        place=80)]
    peak_chain_tension_n: Annotated[Floats, _less("N", 0, "peak chain tension", "largest pull in the chain",
        reference=20000.0, short="chain", place=90)]
    peak_stop_torque_n_m: Annotated[Floats, _less("N m", 1, "peak torque of an end stop",
        "largest torque of an end stop", reference=500.0, short="stop")]
    stop_energy_j: Annotated[Floats, _less("J", 2, "energy into the end stops", "energy that the end stops take",
        reference=100.0, short="stop")]
    peak_foot_force_n: Annotated[Floats, _less("N", 0, "peak foot force", "largest force of the floor on the foot",
        reference=500.0, short="foot", place=130)]
    drift_m: Annotated[Floats, _less("m", 0, "sideways drift",
        "sideways distance of the base from its start at the apex", shown=_MM, reference=0.5, short="drift")]
    peak_stop_torque_hip_n_m: Annotated[Floats, _less("N m", 1, "peak torque of an end stop, hip",
        "largest torque of the hip's end stops", reference=500.0, short="stop hip", place=100)]
    peak_stop_torque_knee_n_m: Annotated[Floats, _less("N m", 1, "peak torque of an end stop, knee",
        "largest torque of the knee's end stops", reference=500.0, short="stop knee", place=110)]
    stop_compression_hip: Annotated[Floats, _less("1", 0, "bumper compressed, hip",
        "largest compression of the hip's bumpers, as a share of their travel", shown=_PERCENT, reference=2.0,
        short="comp. hip")]
    stop_compression_knee: Annotated[Floats, _less("1", 0, "bumper compressed, knee",
        "largest compression of the knee's bumpers, as a share of their travel", shown=_PERCENT, reference=2.0,
        short="comp. knee", place=120)]
    peak_knee_force_n: Annotated[Floats, _less("N", 0, "peak force at the knee",
        "largest force between thigh and shank: bearings, chain and end stop together", reference=5000.0,
        short="F knee", place=140)]
    gear_safety: Annotated[Floats, _safety("gears under the jump's largest torque", "strength of the gears", "gears ok",
        place=150)]
    chain_safety: Annotated[Floats, _safety("the chain and its turnbuckles", "strength of the chain", "chain ok",
        place=160)]
    stop_safety: Annotated[Floats, _safety("bumpers, seats and strikers of the end stops", "strength of the end stops",
        "stops ok", place=170)]
    joint_safety: Annotated[Floats, _safety("screws, pins, fits and shafts", "strength of the joints", "joints ok",
        place=180)]
    link_safety: Annotated[Floats, _safety("plates, cores and rods", "strength of the links", "links ok", place=190)]
    gear_strike_safety: Annotated[Floats, _safety(
        "gears that the largest torque strikes in every jump of their duty (it informs: nothing requires it by itself)",
        "gears struck in every jump", "strikes")]
    # D. W. Haldane, M. M. Plecnik, J. K. Yim, R. S. Fearing, "Robotic vertical jumping agility via series-elastic power
    # modulation", Science Robotics 1(1), 2016. Here the push starts with the jump.
    agility_m_per_s: Annotated[Floats, _more("m/s", 2, "vertical jumping agility",
        "vertical jumping agility: height gained over the time from the start of the push to the apex", reference=0.0,
        short="agility", place=50)]
    cost_eur: Annotated[Floats, _less("EUR", 0, "cost",
        "rough cost of all parts of one robot: stock, set-ups and hours of those made, list prices of those bought",
        reference=20000.0, place=45)]
    made_parts: Annotated[Floats, _less("1", 0, "parts made", "pieces of the robot that are made", reference=200.0,
        short="made")]
    bought_parts: Annotated[Floats, _less("1", 0, "parts bought", "pieces of the robot that are bought, such as screws",
        reference=500.0, short="bought")]
    rise_m: Annotated[Floats, _more("m", 3, "rise of the centre of mass",
        "rise of the centre of mass from lift-off to its apex, which is what published jumpers compare", reference=0.0,
        short="rise", place=22, leading=True)]
    above_standing_m: Annotated[Floats, _more("m", 3, "height above standing",
        "height less that of the base when the robot stands on a leg as straight as its knee's stop allows",
        reference=0.0, short="above st.", place=24, leading=True)]
    # fmt: on


MEASURES: Records[Measure] = Records(_described(JumpMeasures))
"""Every measure of a jump, in the order of the fields of ``jump.evaluate.Evaluations`` and of the database columns."""
MEASURE_NAMES: tuple[str, ...] = tuple(measure.name for measure in MEASURES)
ENERGIES: tuple[str, ...] = tuple(measure.name for measure in MEASURES if measure.work_share)
"""What a jump costs: the energies that are never less than ``jump.gravity.least_energy_j``."""

_PERTURBED = "links moved by 1e-6"


@dataclass(frozen=True, slots=True, kw_only=True)
class AuditMeasures:
    """What the audits of n designs measure, each of shape (n,).

    ``status``, ``height_m`` and ``energy_j`` are those of the jump. A measure is NaN for a design without a jump, and
    where a brief audit leaves it out; it is infinite where a jump is lost by a finer step, a perturbation or a shorter
    control period. ``reason`` says why the jump is not well-conditioned, and is empty where it is.
    """

    # fmt: off
    status: NDArray[np.str_]
    height_m: Floats
    energy_j: Floats
    energy_balance_error: Annotated[Floats, _less("1", 2, "energy balance open by",
        "what the energy balance leaves open, as a share of the joint work", shown=_PERCENT, place=10)]
    mujoco_height_m: Annotated[Floats, _row("m", 4, "height by MuJoCo", "height of the same jump by MuJoCo", place=12)]
    mujoco_energy_j: Annotated[Floats, _row("J", 3, "energy by MuJoCo", "energy of the same jump by MuJoCo", place=14)]
    half_step_height_m: Annotated[Floats, _less("m", 2, "height, step halved", "change of height with half the step",
        shown=_MM, place=40)]
    half_step_energy: Annotated[Floats, _less("1", 2, "energy, step halved",
        "relative change of energy with half the step", shown=_PERCENT, place=50)]
    quarter_step_height_m: Annotated[Floats, _less("m", 2, "height, step quartered",
        "change of height with a quarter of the step", shown=_MM)]
    quarter_step_energy: Annotated[Floats, _less("1", 2, "energy, step quartered",
        "relative change of energy with a quarter of the step", shown=_PERCENT)]
    spread_height_m: Annotated[Floats, _less("m", 2, "height, " + _PERTURBED + " (90th percentile)",
        "90th percentile of the change of height over perturbed designs", shown=_MM, place=20)]
    spread_energy: Annotated[Floats, _less("1", 2, "energy, " + _PERTURBED + " (90th percentile)",
        "90th percentile of the relative change of energy over perturbed designs", shown=_PERCENT, place=30)]
    worst_height_m: Annotated[Floats, _less("m", 2, "height, " + _PERTURBED + " (worst)",
        "largest change of height over perturbed designs", shown=_MM)]
    worst_energy: Annotated[Floats, _less("1", 2, "energy, " + _PERTURBED + " (worst)",
        "largest relative change of energy over perturbed designs", shown=_PERCENT)]
    control_period_height_m: Annotated[Floats, _less("m", 2, "height, control period quartered",
        "change of height with a quarter of the control period", shown=_MM, place=60)]
    control_period_energy: Annotated[Floats, _less("1", 2, "energy, control period quartered",
        "relative change of energy with a quarter of the control period", shown=_PERCENT, place=70)]
    reason: tuple[str, ...] = ()
    # fmt: on


AUDIT_MEASURES: tuple[Measure, ...] = _described(AuditMeasures)  #: In the order of the fields of ``jump.audit.Audits``.

_COARSE = f"step doubled and {_PERTURBED}"


@dataclass(frozen=True, slots=True, kw_only=True)
class ScreenMeasures:
    """What coarse jumps say of n designs, each of shape (n,).

    The changes are infinite where the coarse jump failed, and NaN where there was none.
    """

    # fmt: off
    double_step_height_m: Annotated[Floats, _less("m", 2, "height, " + _COARSE,
        "change of height with twice the step, of a perturbed design", shown=_MM, place=80)]
    double_step_energy: Annotated[Floats, _less("1", 2, "energy, " + _COARSE,
        "relative change of energy with twice the step, of a perturbed design", shown=_PERCENT, place=90)]
    # fmt: on


SCREEN_MEASURES: tuple[Measure, ...] = _described(ScreenMeasures)
"""In the order of the fields of ``jump.screen.Screened``."""

STATISTICS: dict[str, str] = {"mean": "mean", "p05": "5th percentile", "p95": "95th percentile"}
"""What can be asked of a measure under uncertainty: key behind the measure's name, as in "height_m.p05", and words."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Shares:
    # fmt: off
    failed_share: Annotated[float, _less("1", 1, "jumps that fail",
        "share of the jumps under uncertainty that do not reach an apex", shown=_PERCENT, reference=1.0, short="fail")]
    overloaded_share: Annotated[float, _less("1", 1, "jumps that overload a part",
        "share of the jumps under uncertainty that exceed what some joint or part carries with its required safety",
        shown=_PERCENT, reference=1.0, short="overload")]
    # fmt: on


SHARE_MEASURES: tuple[Measure, ...] = _described(_Shares)  #: Of many jumps of one design under uncertainty.


def _statistic_of(base: Measure, key: str) -> Measure:
    words = STATISTICS[key]
    return replace(
        base,
        name=f"{base.name}.{key}",
        meaning=f"{words} under uncertainty of: {base.meaning}",
        label=f"{base.words} ({words})",
        short=f"{base.short} {key}",
        place=None,
        leading=False,
        full="",
        axis="",
        work_share="",
    )


ROBUST_MEASURES: tuple[Measure, ...] = (
    *SHARE_MEASURES,
    *(_statistic_of(base, key) for base in MEASURES for key in STATISTICS),
)  #: Every measure of a design under uncertainty; a study stores those that it asks for.
ROBUST_NAMES: tuple[str, ...] = tuple(measure.name for measure in ROBUST_MEASURES)
GOAL_NAMES: tuple[str, ...] = (*MEASURE_NAMES, *ROBUST_NAMES)  #: What a study can ask for.

OWN = "own_"  #: What the name of a measure that is a function of the user's own begins with.
_OWN = re.compile(rf"{OWN}[A-Za-z_][A-Za-z0-9_]{{0,99}}")
OWN_REFERENCE = 1000.0  #: Corner of the hypervolume, far off, for an own objective whose study names none.

_BY_NAME = {measure.name: measure for measure in (*MEASURES, *AUDIT_MEASURES, *SCREEN_MEASURES, *ROBUST_MEASURES)}


def measure(name: str) -> Measure:
    """Return the measure called ``name`` of a jump, an audit, or a design under uncertainty, or raise ``KeyError``."""
    return _own_measure(name) if is_own(name) else _BY_NAME[name]


def is_own(name: object) -> bool:
    """Return whether a measure is a function of the user's own, such as "own_landing_speed" for ``landing_speed``."""
    return isinstance(name, str) and _OWN.fullmatch(name) is not None


def is_goal(name: object) -> bool:
    """Return whether a study can ask for a measure of that name."""
    return isinstance(name, str) and (name in GOAL_NAMES or is_own(name))


def _own_measure(name: str) -> Measure:
    """Return the measure that an own function is. Less is better; its unit is known only to the function."""
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
    """Return whether a measure is of many jumps under uncertainty."""
    return name in _ROBUST


def nominal(name: str) -> str:
    """Return the measure of a single jump that a name is about: "height_m" for itself and for "height_m.p05"."""
    return name.partition(".")[0]


_ROBUST = frozenset(ROBUST_NAMES)

_MOST_NEAR = 3  #: Names that are told of those nearest to one that is unknown; our own choice: a line holds them.


def near_measures(name: object, known: Sequence[str]) -> str:
    """Return the cure for an unknown name: the most similar known one, or the nearest few and where all are."""
    if near := difflib.get_close_matches(str(name), known, n=1):
        return f"did you mean {near[0]!r}?"
    plain = [one for one in known if not is_robust(one)]
    few = difflib.get_close_matches(str(name), plain, n=_MOST_NEAR, cutoff=0.0)
    return f"the nearest are {', '.join(few)}; docs/reference/measures.md and the columns of 'trials DB' have all"
