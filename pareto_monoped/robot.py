"""Design -> Robot: the one place where actuators, links and base become bodies with masses and inertias.

Both the simulation and the CAD read the robot from here: ``build_robot`` gives one robot with all its parts, and
``robot_arrays`` weighs a whole population with the same part functions, a row a design.

A continuous gear ratio gets the gearbox of its interval of 0.1 (stage 1), and the robot has that gearbox's real ratio.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import ConfigDict, Field

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.design import NAMES, Design
from pareto_monoped.errors import DesignError
from pareto_monoped.geometry.parts import MassProperties, Part, total
from pareto_monoped.geometry.shapes import Numbers
from pareto_monoped.geometry.tabulated import Tabulated, tabulate
from pareto_monoped.leg.dimensions import DEFAULT, LegDimensions, with_chain_for
from pareto_monoped.leg.links import base_parts, foot_part, journal_parts, shank_parts, thigh_parts

Floats = NDArray[np.float64]

BODIES = ("base", "thigh", "shank")
JOINTS = ("hip", "knee")

PART_TO_BODY: Floats = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""Part frames have the joint axis along z and y up along the link; body frames have it along y and z up."""
PART_TO_BODY.flags.writeable = False
_UPRIGHT = np.eye(3)
_THREAD_SPARE_MM = 0.5  # between a screw's end and the end of its thread; our own choice
_TABULATED_M = (0.25, 0.55)  # the paper's lengths, 0.3 to 0.5 m, and some more
_OVER = np.diag([1.0, -1.0, -1.0])  # half a turn about x: the knee actuator looks at the thigh from outside


@dataclass(frozen=True, slots=True, kw_only=True)
class MassOptions:
    """What a calibration may set in place of the part-by-part masses; None keeps the parts.

    Attributes:
        base_structure_mass_kg: mass of the base frame, without the hip actuator.
        foot_mass_kg, foot_radius_m: of the foot.
        link_mass_scale: factor on mass and inertia of both links, without the foot.
        rotor_inertia_kg_m2: of one motor about its axis, with all that turns at its speed.
    """

    __pydantic_config__ = ConfigDict(extra="forbid")

    base_structure_mass_kg: Annotated[float, Field(ge=0.0, allow_inf_nan=False)] | None = None
    foot_mass_kg: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] | None = None
    foot_radius_m: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] | None = None
    link_mass_scale: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] = 1.0
    rotor_inertia_kg_m2: Annotated[float, Field(ge=0.0, allow_inf_nan=False)] | None = None


PARTS_ONLY = MassOptions()
"""Every mass from the parts: what is exported to CAD."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Unit:
    """A group of parts that is put into a body as a whole.

    Attributes:
        name: ``base_frame``, ``hip_actuator``, ``thigh``, ``knee_actuator``, ``journal`` (which carries the
            knee actuator's free end), ``shank`` or ``foot``.
        body: the body that carries it, one of ``BODIES``.
        parts: in the unit's own frame.
        turn: rotation from the unit's frame to the body's part frame (x forward, y up, z along the joint axis).
        z_mm: where the unit's origin lies on the body's proximal joint axis, in the body's part frame.
    """

    name: str
    body: str
    parts: tuple[Part, ...]
    turn: Floats
    z_mm: float

    def mass_properties(self) -> MassProperties:
        """All parts together, in the body frame."""
        return _in_body(total(part.mass_properties() for part in self.parts), self.turn, self.z_mm)


@dataclass(frozen=True, slots=True, kw_only=True)
class Robot:
    """One robot with every part that has a mass.

    Attributes:
        design: what was asked for; the gearboxes' real ratios are ``hip.ratio`` and ``knee.ratio``.
        hip, knee: the actuators.
        units: from the base down to the foot.
    """

    design: Design
    hip: Actuator
    knee: Actuator
    units: tuple[Unit, ...]

    def body_mass_properties(self) -> Mapping[str, MassProperties]:
        """Each body's parts together, in its body frame (see ``RobotArrays``)."""
        return {body: total(u.mass_properties() for u in self.units if u.body == body) for body in BODIES}

    @property
    def mass_kg(self) -> float:
        """Mass of the whole robot."""
        return float(sum(unit.mass_properties().mass_kg for unit in self.units))


@lru_cache(maxsize=16)
def leg_dimensions(actuator_map: ActuatorMap) -> LegDimensions:
    """The leg that fits a motor: its plates are drilled for its actuators, its chain carries their largest torque.

    A map's actuators have one output; where its two families have different mounts, the leg has the first one's.
    """
    actuators = [entry.actuator for entry in actuator_map.entries if entry.actuator is not None]
    if not actuators:
        return DEFAULT
    mount, output = actuators[0].mount, actuators[0].output
    bare = LegDimensions(
        mount_pitch_radius_mm=0.5 * mount.bolts.pitch_circle_mm,
        mount_holes=mount.bolts.count,
        housing_radius_mm=mount.housing_radius_mm,
        mount_thread_mm=mount.thread_depth_mm - _THREAD_SPARE_MM,
        output_pitch_radius_mm=0.5 * output.bolts.pitch_circle_mm,
        output_holes=output.bolts.count,
        coupler_radius_mm=output.flange_radius_mm,
        coupler_thread_mm=output.thread_depth_mm - _THREAD_SPARE_MM,
        back_pitch_radius_mm=0.5 * mount.back_bolts.pitch_circle_mm,
        back_holes=mount.back_bolts.count,
        back_screw_mm=mount.back_bolts.diameter_mm,
    )
    return with_chain_for(bare, max(actuator.peak_torque_n_m for actuator in actuators))


def build_robot(design: Design, actuator_map: ActuatorMap) -> Robot:
    """The robot of a design, part by part.

    Raises:
        DesignError: a link without length, or a gear ratio that no gearbox of this motor has.
    """
    for name in ("thigh_length_m", "shank_length_m"):
        value = getattr(design, name)
        if not value > 0.0:
            raise DesignError(f"{name} = {value}: must be above 0 m; give a length such as 0.4")
    hip, knee = actuator_map.lookup(design.hip_ratio), actuator_map.lookup(design.knee_ratio)
    shank_length_m = design.shank_length_m
    leg = leg_dimensions(actuator_map)
    knee_length_m = 1e-3 * knee.length_mm
    journal = journal_parts(knee_length_m, leg, back_clearance_mm=_back_clearance_mm(knee))
    units = (
        Unit(name="base_frame", body="base", parts=base_parts(knee_length_m, leg), turn=_UPRIGHT, z_mm=0.0),
        Unit(name="hip_actuator", body="base", parts=hip.parts, turn=_UPRIGHT, z_mm=leg.hip_mount_mm),
        Unit(name="thigh", body="thigh", parts=thigh_parts(design.thigh_length_m, leg), turn=_UPRIGHT, z_mm=0.0),
        Unit(name="knee_actuator", body="thigh", parts=knee.parts_bolted_at_back, turn=_OVER, z_mm=leg.knee_mount_mm),
        Unit(name="journal", body="thigh", parts=journal, turn=_UPRIGHT, z_mm=0.0),
        Unit(name="shank", body="shank", parts=shank_parts(shank_length_m, leg), turn=_UPRIGHT, z_mm=0.0),
        Unit(name="foot", body="shank", parts=(foot_part(shank_length_m, leg),), turn=_UPRIGHT, z_mm=0.0),
    )
    return Robot(design=design, hip=hip, knee=knee, units=units)


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotArrays:
    """What the simulation needs of n robots; the last axes are in the order of ``BODIES`` and ``JOINTS``.

    Body frames: ``base`` at the hip axis, ``thigh`` at the hip axis, ``shank`` at the knee axis; x forward, y to the
    left (the joint axes), z up; at zero joint angles both links hang straight down along -z.

    Attributes:
        thigh_length_m, shank_length_m: hip axis to knee axis, knee axis to foot centre, shape (n,).
        body_mass_kg: shape (n, 3).
        body_com_m: centres of mass in the body frames, shape (n, 3, 3).
        body_inertia_kg_m2: about the centres of mass, axes of the body frames, shape (n, 3, 3, 3).
        foot_radius_m: shape (n,).
        ratio: real ratios of the gearboxes (not the searched ones), shape (n, 2).
        armature_kg_m2: reflected inertia of all that turns with the motor, at the joint, shape (n, 2).
        peak_torque_n_m, continuous_torque_n_m: at the joint, before losses, shape (n, 2).
        no_load_speed_rad_per_s: at the joint, shape (n, 2).
        efficiency: of the gear mesh, shape (n, 2).
        torque_constant_n_m_per_a, winding_resistance_ohm: of the motor itself, shape (n, 2).
        reason: why the robot cannot be built, empty if it can, n strings.
    """

    thigh_length_m: NDArray[np.float64]
    shank_length_m: NDArray[np.float64]
    body_mass_kg: NDArray[np.float64]
    body_com_m: NDArray[np.float64]
    body_inertia_kg_m2: NDArray[np.float64]
    foot_radius_m: NDArray[np.float64]
    ratio: NDArray[np.float64]
    armature_kg_m2: NDArray[np.float64]
    peak_torque_n_m: NDArray[np.float64]
    continuous_torque_n_m: NDArray[np.float64]
    no_load_speed_rad_per_s: NDArray[np.float64]
    efficiency: NDArray[np.float64]
    torque_constant_n_m_per_a: NDArray[np.float64]
    winding_resistance_ohm: NDArray[np.float64]
    reason: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.thigh_length_m)


def robot_arrays(designs: ArrayLike, actuator_map: ActuatorMap, options: MassOptions = PARTS_ONLY) -> RobotArrays:
    """Weigh many robots at once, by the same part functions as ``build_robot``.

    Links between 0.25 and 0.55 m come from tables of these functions, equal to 12 digits and many times as fast.

    Args:
        designs: shape (n, 7), in the order of ``design.NAMES``; finite, with links longer than zero.
        actuator_map: the gearboxes.
        options: what stands in for part-by-part masses.

    Returns:
        A row a design. Rows with a ``reason`` (no gearbox of that ratio) hold the numbers of some other gearbox.
    """
    values = np.atleast_2d(np.asarray(designs, dtype=np.float64))
    thigh_m, shank_m = values[:, 0], values[:, 1]
    table, leg = _actuator_table(actuator_map), leg_dimensions(actuator_map)
    intervals = {joint: actuator_map.interval_index(values[:, NAMES.index(f"{joint}_ratio")]) for joint in JOINTS}
    reason = tuple(_missing(actuator_map, intervals, values, i) for i in range(len(values)))
    hip, knee = (table.row[np.maximum(intervals[joint], 0)] for joint in JOINTS)

    frame = table.frame.rows(knee)
    if options.base_structure_mass_kg is not None:
        frame = frame.scaled(options.base_structure_mass_kg / frame.mass_kg)
    (thigh,), (shank, foot) = _weighed("thigh", leg, thigh_m), _weighed("shank", leg, shank_m)
    if options.foot_mass_kg is not None:
        foot = foot.scaled(options.foot_mass_kg / foot.mass_kg)
    bodies = (
        frame + table.at_hip.rows(hip),
        thigh.scaled(options.link_mass_scale) + table.journal.rows(knee) + table.at_knee.rows(knee),
        shank.scaled(options.link_mass_scale) + foot,
    )
    rows = np.stack([hip, knee], axis=1)
    armature = table.armature_kg_m2[rows]
    if options.rotor_inertia_kg_m2 is not None:
        armature = options.rotor_inertia_kg_m2 * np.square(table.ratio[rows])
    foot_radius_m = leg.foot_radius_mm * 1e-3 if options.foot_radius_m is None else options.foot_radius_m
    motor = actuator_map.motor
    return RobotArrays(
        thigh_length_m=thigh_m.copy(),
        shank_length_m=shank_m.copy(),
        body_mass_kg=np.stack([body.mass_kg for body in bodies], axis=1),
        body_com_m=np.stack([body.com_m for body in bodies], axis=1),
        body_inertia_kg_m2=np.stack([body.inertia_kg_m2 for body in bodies], axis=1),
        foot_radius_m=np.full(len(values), foot_radius_m),
        ratio=table.ratio[rows],
        armature_kg_m2=armature,
        peak_torque_n_m=table.peak_torque_n_m[rows],
        continuous_torque_n_m=table.continuous_torque_n_m[rows],
        no_load_speed_rad_per_s=table.no_load_speed_rad_per_s[rows],
        efficiency=table.efficiency[rows],
        torque_constant_n_m_per_a=np.full(rows.shape, motor.torque_constant_n_m_per_a),
        winding_resistance_ohm=np.full(rows.shape, motor.winding_resistance_ohm),
        reason=reason,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _ActuatorTable:
    """The map's k actuators as arrays, and the parts of the base whose size follows from the knee actuator's length.

    ``row`` leads from an interval of the map to its actuator's row; ``at_hip`` and ``at_knee`` are the actuators in the
    frames of the bodies that carry them.
    """

    row: NDArray[np.intp]
    at_hip: MassProperties
    at_knee: MassProperties
    frame: MassProperties
    journal: MassProperties
    ratio: Floats
    armature_kg_m2: Floats
    peak_torque_n_m: Floats
    continuous_torque_n_m: Floats
    no_load_speed_rad_per_s: Floats
    efficiency: Floats


@lru_cache(maxsize=16)
def _actuator_table(actuator_map: ActuatorMap) -> _ActuatorTable:
    actuators = [entry.actuator for entry in actuator_map.entries if entry.actuator is not None]
    leg = leg_dimensions(actuator_map)
    row = np.cumsum([entry.actuator is not None for entry in actuator_map.entries]) - 1
    length_m = np.array([1e-3 * a.length_mm for a in actuators])
    clearance_mm = np.array([_back_clearance_mm(a) for a in actuators])
    return _ActuatorTable(
        row=np.maximum(row, 0),
        at_hip=_in_body(_stacked(a.parts for a in actuators), _UPRIGHT, leg.hip_mount_mm),
        at_knee=_in_body(_stacked(a.parts_bolted_at_back for a in actuators), _OVER, leg.knee_mount_mm),
        frame=_upright(base_parts(length_m, leg)),
        journal=_upright(journal_parts(length_m, leg, back_clearance_mm=clearance_mm)),
        ratio=np.array([a.ratio for a in actuators]),
        armature_kg_m2=np.array([a.reflected_inertia_kg_m2 for a in actuators]),
        peak_torque_n_m=np.array([a.peak_torque_n_m for a in actuators]),
        continuous_torque_n_m=np.array([a.continuous_torque_n_m for a in actuators]),
        no_load_speed_rad_per_s=np.array([a.no_load_speed_rad_per_s for a in actuators]),
        efficiency=np.array([a.efficiency for a in actuators]),
    )


def _stacked(units: Iterable[tuple[Part, ...]]) -> MassProperties:
    """Mass properties of several units, a row a unit."""
    masses = [total(part.mass_properties() for part in parts) for parts in units]
    return MassProperties(
        mass_kg=np.array([m.mass_kg for m in masses]),
        first_kg_m=np.array([m.first_kg_m for m in masses]),
        second_kg_m2=np.array([m.second_kg_m2 for m in masses]),
    )


def _thigh(lengths_m: Floats, leg: LegDimensions) -> tuple[MassProperties, ...]:
    return (_upright(thigh_parts(lengths_m, leg)),)


def _shank(lengths_m: Floats, leg: LegDimensions) -> tuple[MassProperties, ...]:
    return _upright(shank_parts(lengths_m, leg)), _upright((foot_part(lengths_m, leg),))


_LINKS = {"thigh": _thigh, "shank": _shank}


@lru_cache(maxsize=32)
def _link_table(link: str, leg: LegDimensions) -> Tabulated:
    return tabulate(lambda lengths_m: _LINKS[link](lengths_m, leg), *_TABULATED_M)


def _weighed(link: str, leg: LegDimensions, lengths_m: Floats) -> tuple[MassProperties, ...]:
    """The units of a link that depend on its length: from the table, beyond its ends part by part."""
    table = _link_table(link, leg)
    beyond = ~table.covers(lengths_m)
    units = table(np.clip(lengths_m, table.low_m, table.high_m))
    if beyond.any():
        for unit, exact in zip(units, _LINKS[link](lengths_m[beyond], leg), strict=True):
            unit.mass_kg[beyond] = exact.mass_kg
            unit.first_kg_m[beyond] = exact.first_kg_m
            unit.second_kg_m2[beyond] = exact.second_kg_m2
    return units


def _back_clearance_mm(actuator: Actuator) -> float:
    """How much of an actuator's back the screws of its own pattern pass through before their threads begin."""
    return actuator.mount.back_depth_mm if actuator.family == "ESSPG" else 0.0


def _missing(actuator_map: ActuatorMap, intervals: Mapping[str, NDArray[np.intp]], values: Floats, i: int) -> str:
    """Why robot i has no gearbox, empty if it has both."""
    for joint in JOINTS:
        if intervals[joint][i] < 0:
            ratio = float(values[i, NAMES.index(f"{joint}_ratio")])
            return f"{joint}_ratio = {ratio:g}: {actuator_map.why_not(ratio)}"
    return ""


def _upright(parts: tuple[Part, ...]) -> MassProperties:
    """Parts that stand in a body's part frame, in the body frame."""
    return _in_body(total(part.mass_properties() for part in parts), _UPRIGHT, 0.0)


def _in_body(properties: MassProperties, turn: Floats, z_mm: Numbers) -> MassProperties:
    """From a unit's frame to the body frame."""
    move = PART_TO_BODY @ np.array([0.0, 0.0, 1e-3 * float(z_mm)])
    return properties.placed(PART_TO_BODY @ turn, move)
