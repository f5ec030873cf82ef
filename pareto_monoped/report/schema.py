"""The records that the page is made from; it shows nothing that is not in its ``Payload``.

Field names are the keys in the page's JSON. A column is a list with one number per row, None where there is no value.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

Number = float | int | None
Column = Sequence[Number]


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """How the page shows a column: its name, label, unit and decimals; ``scale`` converts the value to that unit."""

    name: str
    label: str
    unit: str
    decimals: int
    scale: float = 1.0
    axis: str = ""  # what it is called beside an axis of the front; empty: the label
    group: str = "other measures"  # among the choices of an axis


@dataclass(frozen=True, slots=True, kw_only=True)
class Gearbox:
    """One actuator of a stage 1 map, as the page shows it and draws it to scale."""

    motor: str
    family: str
    ratio: float
    sun_teeth: int
    planet_teeth: int
    ring_teeth: int
    module_mm: float
    planets: int
    face_width_mm: float
    mass_kg: float
    peak_torque_n_m: float
    no_load_speed_rad_per_s: float
    efficiency: float
    motor_diameter_mm: float


@dataclass(frozen=True, slots=True, kw_only=True)
class MapPoint:
    """One interval of a stage 1 map."""

    ratio_low: float  #: lower end
    gearbox: int | None  #: number of the chosen gearbox on the page, None if no gearbox has such a ratio
    reason: str  #: why there is none
    family_mass_kg: Mapping[str, float]  #: mass of each family's lightest actuator


@dataclass(frozen=True, slots=True, kw_only=True)
class LegTable:
    """The leg that fits a motor: masses of its links by length, and the dimensions of its drawing."""

    length_m: Column  #: link lengths
    #: thigh_kg, shank_kg: mass of each link at these lengths, the thigh with its drive, the shank without the foot
    thigh_kg: Column
    shank_kg: Column
    housing_radius_m: float  #: of an actuator's case
    output_radius_m: float  #: of an actuator's output flange
    #: base_top_m, base_top_radius_m: the round upper end of the base's cheek: height above the hip axis, radius
    base_top_m: float
    base_top_radius_m: float
    #: thigh_half_width_m, thigh_hip_radius_m, thigh_knee_radius_m: the thigh's bar and its round ends
    thigh_half_width_m: float
    thigh_hip_radius_m: float
    thigh_knee_radius_m: float
    #: shank_knee_radius_m, shank_foot_radius_m: the shank's round ends
    shank_knee_radius_m: float
    shank_foot_radius_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorMap:
    """The stage 1 map of one motor, the width of its intervals, and the leg that fits the motor."""

    motor: str
    points: Sequence[MapPoint]
    ratio_step: float
    leg: LegTable


@dataclass(frozen=True, slots=True, kw_only=True)
class Kit:
    """The motors of a robot."""

    motor: str  #: name of the motor of both joints, or names of both motors with the joints
    #: hip, knee: indices of their stage 1 maps
    hip: int
    knee: int
    leg: LegTable | None  #: that fits both motors; None where hip and knee have the same, whose map has it


@dataclass(frozen=True, slots=True, kw_only=True)
class Jumps:
    """Jumps in a few frames each, packed as in ``report.packing``."""

    keys: Sequence[int]  #: number of the trial or of the case that each belongs to
    lift_off_s: Sequence[float]  #: time of lift-off of each
    frames: int  #: moments of each jump; a jump of fewer has no change of time after its last
    counts: Mapping[str, float]  #: time and the other columns in the order in which they are packed: value of one count
    data: str  #: changes of all jumps one after the other, column by column, deflated and in base64


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One row of the paper's Table I, simulated with a study's motor and calibration; ``measures`` holds every one."""

    name: str
    status: str
    reason: str
    height_m: Number
    energy_j: Number
    mass_kg: Number
    measures: Mapping[str, Number]


@dataclass(frozen=True, slots=True, kw_only=True)
class OtherDesign:
    """A design that costs about as much as another and differs from it: "shank-long; 0.8 percent more energy"."""

    row: int  #: of ``Trials``
    price: float  #: the greatest loss in any objective, as a share of the other design's value
    text: str  #: how it differs, and its price
    audited: bool  #: whether it has an audit


@dataclass(frozen=True, slots=True, kw_only=True)
class Robust:
    """Designs of a study under uncertainty, those that rarely fail."""

    ranges: str  #: what the ranges are called
    samples: int  #: jumps per design
    fragile: int  #: how many other designs fail too often
    others: int  #: how many were simulated under other ranges, samples or seed, and are left out
    rows: Sequence[int]  #: of ``Trials``, in the order of their numbers
    front: Sequence[int]  #: rows of the robust front, by the first objective
    #: Columns such as "height_m.p05" and "failed_share" of ``rows``, as text (``packing.packed_column``)
    packed: Mapping[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class BestTorque:
    """What the best torque found reaches with the hardware of a study's designs."""

    energy: str  #: which energy
    held: bool  #: whether only jumps count that overload no part, as in studies whose designs must hold
    rows: Sequence[int]  #: of ``Trials``, of the designs that were searched
    gap: Column  #: of each: percent of its energy that is saved at its height
    #: Row, height, energy of jumps that need the least at a design's height or go highest, and that neither another one
    #: nor a design of the study dominates
    front: Sequence[tuple[int, Number, Number]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Influences:
    """What moves a design's measures."""

    jumps: int  #: simulated for it
    #: Label, range in words, and whether it is a manufacturing tolerance, of each factor
    factors: Sequence[tuple[str, str, bool]]
    #: Measure -> per factor its change in the stored unit from end to end of the range, the total Sobol' index, and
    #: half of the index' 95 percent interval
    measures: Mapping[str, Sequence[tuple[Number, Number, Number]]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Picked:
    """A design that the page points out: its name there, its row, why it was picked, and alternatives to it."""

    name: str
    row: int
    why: str
    alternatives: Sequence[OtherDesign] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Trials:
    """Trials of a study, one per row, in the order of their numbers."""

    trial: Sequence[int]  #: numbers
    state: str  #: one letter per row: f feasible, i infeasible, x failed
    columns: Mapping[str, Column]  #: by name; None where there is no value
    packed: Mapping[str, str]  #: more columns by name, as text (``packing.packed_column``)
    total: int  #: trials in the database, which may be more than there are rows


@dataclass(frozen=True, slots=True, kw_only=True)
class Model3D:
    """Triangles of an exported design: corners as multiples of ``step_mm``, colours from 0 to 255, both in base64."""

    step_mm: float
    triangles: int
    positions: str
    colours: str
    simplified: bool
    note: str


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyCard:
    """One study on the page."""

    label: str  #: short and unique among the page's studies
    name: str
    description: str
    database: str
    #: motor, calibration: as shown; several motors with commas between them
    motor: str
    case_motor: str  #: the motors that ``cases`` were simulated with, as shown
    #: Index of each kit of motors on the page -> hip's and knee's motor as the command line takes them
    motor_names: Mapping[str, Sequence[str]]
    calibration: str
    calibration_name: str  #: as the command line takes it
    #: Index of the kit of ``case_motor``. Trials of a study with several kits have that of theirs as the column
    #: ``motor``.
    kit: int
    algorithm: str
    seed: int
    objectives: Sequence[str]  #: of the study, which decide what is on its front
    group: str  #: equal for studies that are runs of one study with several seeds
    wider: Sequence[int]  #: which studies on the page have variables of this one opened
    state: str
    budget: int
    seconds: float
    counts: Mapping[str, int]
    reasons: Mapping[str, int]
    hypervolume: float
    hypervolume_unit: str
    reference: str
    bounds: Mapping[str, Sequence[float]]  #: variable -> [lower, upper], equal for a fixed one
    at_bounds: Sequence[str]  #: which bounds limit the front, and in which part of it; one sentence each
    summary: Sequence[str]
    notes: Sequence[str]  #: what readers have to know before they use the page
    trials: Trials
    #: front, ill_conditioned: rows of ``trials``
    front: Sequence[int]
    ill_conditioned: Sequence[int]
    picks: Sequence[Picked]
    more: Mapping[str, Column]  #: columns of the front alone, in its order: masses of the bodies
    audits: Mapping[str, Mapping[str, Any]]  #: trial number -> measures of its audit
    jumps: Jumps  #: of the designs on the front, by trial number
    case_jumps: Jumps  #: of ``cases``, by place among them
    #: Ends of the joints' ranges as each kit of motors has them: index of the kit -> [least, most] of hip and of knee,
    #: None where a joint has no stop
    stops_rad: Mapping[str, Sequence[Sequence[Number]]]
    models: Mapping[str, Model3D]  #: by trial number
    cases: Sequence[Case]
    #: Numbers of the gearboxes of ``cases``, by joint; -1 where there is none
    case_gearboxes: Mapping[str, Sequence[int]]
    history: Mapping[str, Column]
    weighted: Sequence[Sequence[float]]  #: results of a weighted search: weight of the first objective, and row
    #: Energy below which no design that jumped can reach each of ``Constants.floor_heights_m``; empty without jumps
    floor_j: Sequence[float]
    foot_mass_kg: float
    foot_radius_m: float
    provenance: Sequence[Sequence[str]]
    reproduce: str
    #: Measure -> variable -> its importance over all trials, see ``analysis.sensitivity.importances``
    importances: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    robust: Robust | None = None  #: designs under uncertainty; None where none is stored
    best: BestTorque | None = None  #: None where no limit is stored
    #: Trial number -> "variables" and "assumptions" -> its sensitivity, see ``Influences``
    sensitivity: Mapping[str, Mapping[str, Influences]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """Several studies side by side, under the first one's objectives."""

    reference: str  #: the point that all hypervolumes here are measured from, in words
    hypervolume_unit: str  #: of these hypervolumes
    other: str  #: the objective that is compared at heights
    heights_m: Sequence[float]  #: where; empty for objectives without a height
    #: One per study: label, hypervolume, best value of ``other`` at each of ``heights_m`` (``at_height``, None where
    #: the front does not reach it), and more
    rows: Sequence[Mapping[str, Any]]
    #: Of each group with several seeds, for two objectives: values of the first (``first``), and the best, median and
    #: worst of the second there; the median is empty for two seeds
    surfaces: Sequence[Mapping[str, Any]]
    #: Least, median and greatest hypervolume over evaluations, and what the median is called (``middle``)
    growth: Sequence[Mapping[str, Any]]
    #: For two fronts by the two energies, the designs that both offer at some heights, and what choosing by the
    #: mechanical one costs at the battery
    choices: Sequence[Mapping[str, Any]] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Constants:
    """Physical constants and published numbers that the page's scripts compute with."""

    #: gravity_m_per_s2, base_start_height_m: for work against gravity, m g (H - start height)
    gravity_m_per_s2: float
    base_start_height_m: float
    floor_heights_m: Sequence[float]  #: of ``StudyCard.floor_j``
    #: published_link_kg, published_link_kg_per_m: straight line of link mass over link length
    published_link_kg: float
    published_link_kg_per_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Payload:
    """Everything on the page."""

    version: str
    title: str
    objectives: Sequence[str]  #: the first study's, which are the axes of the front chart
    goals: Sequence[str]  #: the objectives of all studies, without repetition; the page has them of every trial
    directions: Mapping[str, str]  #: "maximise" or "minimise" of each goal
    measure_directions: Mapping[str, str]  #: the same of every measure that has one
    leading: Sequence[str]  #: measures that the page shows first beside the objectives
    compared: Sequence[str]  #: measures that it compares designs by, beside the objectives
    energies: Mapping[str, str]  #: what a jump costs -> what the work against gravity is called as a share of it
    constants: Constants
    variables: Sequence[Mapping[str, Any]]
    quantities: Sequence[Quantity]
    axes: Sequence[str]  #: measures and variables that trials differ in, which can be axes, colours and sizes
    published: Sequence[Mapping[str, Any]]
    literal: Sequence[Mapping[str, Any]]
    gearboxes: Sequence[Gearbox]
    maps: Sequence[MotorMap]
    kits: Sequence[Kit]
    studies: Sequence[StudyCard]
    switches: Sequence[str]  #: of each study, where along its front the joints change the family of their gearbox
    comparison: Comparison | None = field(default=None)
