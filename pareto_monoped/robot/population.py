"""Many robots at once: what the simulation needs to know about a population of designs, as arrays."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import reduce
from operator import add
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field

from pareto_monoped.actuator.ratiomap import JointMaps, Maps, joint_maps
from pareto_monoped.config import Strict
from pareto_monoped.design import NAMES, complete
from pareto_monoped.geometry.parts import MassProperties
from pareto_monoped.geometry.shapes import Floats
from pareto_monoped.leg.chain import strand_compliance_m_per_n
from pareto_monoped.leg.dimensions import LegDimensions, leg_dimensions
from pareto_monoped.leg.stand import stand_mass_kg
from pareto_monoped.leg.stops import JointStop, hip_stop, knee_stop
from pareto_monoped.robot.tables import (
    actuator_costs,
    actuator_table,
    actuator_units,
    drive_turning,
    link_costs,
    weighed,
)
from pareto_monoped.robot.units import BODIES, JOINTS, UNITS, ActuatorSized


@dataclass(frozen=True, slots=True, kw_only=True)
class MassOptions(Strict):
    """Masses that a calibration may set in place of those of the parts; None keeps those of the parts."""

    #: Mass of the base frame, without the hip actuator
    base_structure_mass_kg: Annotated[float, Field(ge=0.0, allow_inf_nan=False)] | None = None
    foot_mass_kg: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] | None = None
    foot_radius_m: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] | None = None
    #: Factor on mass and inertia of both links, without the foot
    link_mass_scale: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] = 1.0
    #: Of one motor about its axis, with all that turns at its speed
    rotor_inertia_kg_m2: Annotated[float, Field(ge=0.0, allow_inf_nan=False)] | None = None


PARTS_ONLY = MassOptions()
"""Every mass from the parts: what is exported to CAD."""


@dataclass(frozen=True, slots=True, kw_only=True)
class JointStops:
    """The end stops of both joints."""

    hip: JointStop
    knee: JointStop


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotArrays:
    """What the simulation needs to know about n robots; axis 1 has the order of ``BODIES`` or of ``JOINTS``.

    Body frames: ``base`` at the hip axis, ``thigh`` at the hip axis, ``shank`` at the knee axis; x forward, y to the
    left (the joint axes), z up; at zero joint angles both links hang straight down along -z.
    """

    thigh_length_m: Floats  #: hip axis to knee axis, shape (n,)
    shank_length_m: Floats  #: knee axis to foot centre, shape (n,)
    body_mass_kg: Floats  #: shape (n, 3)
    body_com_m: Floats  #: centres of mass in the body frames, shape (n, 3, 3)
    body_inertia_kg_m2: Floats  #: about the centres of mass, axes of the body frames, shape (n, 3, 3, 3)
    foot_radius_m: Floats  #: shape (n,)
    start_height_m: Floats  #: of the base above the floor at rest, shape (n,)
    ratio: Floats  #: real ratios of the gearboxes (not the searched ones), shape (n, 2)
    #: Reflected inertia of all that turns with the motor, at the joint, shape (n, 2)
    armature_kg_m2: Floats
    #: Of what turns at the motor's speed, about the motor's axis, shape (n, 2)
    rotor_inertia_kg_m2: Floats
    #: knee_reflected_kg_m2, knee_coupling_kg_m2: C and B of everything that turns against the thigh: the knee actuator,
    #: its drive sprocket and the chain, see ``rotation``, shape (n,)
    knee_reflected_kg_m2: Floats
    knee_coupling_kg_m2: Floats
    #: What the knee motor's rotor has beyond its share of the thigh's inertia, shape (n,)
    rotor_excess_kg_m2: Floats
    sprocket_radius_m: Floats  #: pitch radius of the chain's sprockets, shape (n,)
    #: Between each motor's rotor and its joint, at the joint: gearbox with the sun's shaft, at the knee also the strand
    #: of the chain that pulls; shape (n, 2)
    drive_stiffness_n_m_per_rad: Floats
    peak_torque_n_m: Floats  #: at the joint, before losses, shape (n, 2)
    #: The peak torque of the data sheet, which a motor of another torque constant also has; friction goes with it
    rated_torque_n_m: Floats
    continuous_torque_n_m: Floats  #: at the joint, before losses, shape (n, 2)
    no_load_speed_rad_per_s: Floats  #: at the joint, shape (n, 2)
    efficiency: Floats  #: of the gear meshes, shape (n, 2)
    efficiency_total: Floats  #: of the whole gearbox, shape (n, 2)
    #: torque_constant_n_m_per_a, winding_resistance_ohm: of the motor itself, as its equivalent DC machine, whose
    #: resistance is line to line; shape (n, 2)
    torque_constant_n_m_per_a: Floats
    winding_resistance_ohm: Floats
    #: cost_eur, made_parts, bought_parts: rough cost of all parts and how many are made and bought, shape (n,)
    cost_eur: Floats
    made_parts: Floats
    bought_parts: Floats
    #: Of what holds the base on the test stand (``leg.stand``), which is no part of the robot and in none of its masses
    stand_mass_kg: Floats
    reason: tuple[str, ...]  #: why the robot cannot be built, empty if it can, n strings
    stops: JointStops  #: the end stops, which all robots with the same actuator maps share

    def __len__(self) -> int:
        return len(self.thigh_length_m)


def robot_arrays(designs: ArrayLike, maps: Maps, options: MassOptions = PARTS_ONLY) -> RobotArrays:
    """Weigh many robots at once, from the same table of units as ``build_robot``.

    Links of 0.25 to 0.55 m are interpolated, which gives the same to 12 digits and is many times as fast.

    ``designs``: shape (n, number of variables), in the order of ``design.NAMES``; finite, with links longer than 0 m.

    Returns:
        One row per design. A row with a ``reason`` has no gearbox of its ratio and holds the numbers of another one.

    Raises:
        DesignError: a map has no actuator.
    """
    values, both = np.atleast_2d(complete(designs)), joint_maps(maps)
    leg = leg_dimensions(both)
    intervals = {joint: both.of(joint).interval_index(values[:, NAMES.index(f"{joint}_ratio")]) for joint in JOINTS}
    reason = [""] * len(values)
    for i in np.flatnonzero(np.minimum(intervals["hip"], intervals["knee"]) < 0).tolist():
        reason[i] = _missing(both, intervals, values, i)
    tables = {joint: actuator_table(both.of(joint)) for joint in JOINTS}
    rows = {joint: tables[joint].row[np.maximum(intervals[joint], 0)] for joint in JOINTS}

    def of_actuators(name: str) -> Floats:
        return np.stack([getattr(tables[joint], name)[rows[joint]] for joint in JOINTS], axis=1)

    def of_motors(name: str) -> Floats:
        return np.tile([float(getattr(both.of(joint).motor, name)) for joint in JOINTS], (len(values), 1))

    bodies = _body_masses(_unit_masses(both, leg, values, rows), options)
    turning = _turning(of_actuators, leg, values[:, NAMES.index("thigh_length_m")], options)
    cost_eur, made, bought = _costs(both, leg, values, rows)
    foot_radius_m = leg.foot_radius_mm * 1e-3 if options.foot_radius_m is None else options.foot_radius_m
    return RobotArrays(
        thigh_length_m=values[:, NAMES.index("thigh_length_m")].copy(),
        shank_length_m=values[:, NAMES.index("shank_length_m")].copy(),
        body_mass_kg=np.stack([body.mass_kg for body in bodies], axis=1),
        body_com_m=np.stack([body.com_m for body in bodies], axis=1),
        body_inertia_kg_m2=np.stack([body.inertia_kg_m2 for body in bodies], axis=1),
        foot_radius_m=np.full(len(values), foot_radius_m),
        start_height_m=values[:, NAMES.index("start_height_m")].copy(),
        ratio=of_actuators("ratio"),
        **turning,
        peak_torque_n_m=of_actuators("peak_torque_n_m"),
        rated_torque_n_m=of_actuators("peak_torque_n_m"),
        continuous_torque_n_m=of_actuators("continuous_torque_n_m"),
        no_load_speed_rad_per_s=of_actuators("no_load_speed_rad_per_s"),
        efficiency=of_actuators("efficiency"),
        efficiency_total=of_actuators("efficiency_total"),
        torque_constant_n_m_per_a=of_motors("torque_constant_n_m_per_a"),
        winding_resistance_ohm=of_motors("terminal_resistance_ohm"),
        cost_eur=cost_eur,
        made_parts=made,
        bought_parts=bought,
        stand_mass_kg=np.full(len(values), stand_mass_kg(leg)),
        reason=tuple(reason),
        stops=JointStops(hip=hip_stop(leg), knee=knee_stop(leg)),
    )


def _turning(
    of_actuators: Callable[[str], Floats], leg: LegDimensions, thigh_m: Floats, options: MassOptions
) -> dict[str, Floats]:
    """Return what turns in each robot: fields of ``RobotArrays`` up to ``drive_stiffness_n_m_per_rad``.

    ``of_actuators``: name of a column of ``ActuatorTable`` -> its values for the actuators of all joints, shape (n, 2);
    ``options``: may set the rotors' inertia, which then stands for everything that turns in an actuator.
    """
    knee, ratio = JOINTS.index("knee"), of_actuators("ratio")
    armature, rotor = of_actuators("armature_kg_m2"), of_actuators("rotor_inertia_kg_m2")
    coupling, excess = of_actuators("coupling_kg_m2")[:, knee], of_actuators("rotor_excess_kg_m2")[:, knee]
    if options.rotor_inertia_kg_m2 is not None:
        armature = options.rotor_inertia_kg_m2 * np.square(ratio)
        rotor = np.full(ratio.shape, options.rotor_inertia_kg_m2)
        coupling, excess = rotor[:, knee] * ratio[:, knee], np.zeros(len(ratio))
    drive, radius_m = drive_turning(leg), 1e-3 * leg.chain.pitch_radius_mm
    compliance = of_actuators("compliance_rad_per_n_m")
    compliance[:, knee] += strand_compliance_m_per_n(1e3 * thigh_m, leg) / radius_m**2

    return {
        "armature_kg_m2": armature,
        "rotor_inertia_kg_m2": rotor,
        "knee_reflected_kg_m2": armature[:, knee] + drive.reflected_kg_m2[0] + drive.reflected_kg_m2[1] * thigh_m,
        "knee_coupling_kg_m2": coupling + drive.coupling_kg_m2[0] + drive.coupling_kg_m2[1] * thigh_m,
        "rotor_excess_kg_m2": excess,
        "sprocket_radius_m": np.full(len(ratio), radius_m),
        "drive_stiffness_n_m_per_rad": 1.0 / compliance,
    }


def _unit_masses(
    maps: JointMaps, leg: LegDimensions, values: Floats, rows: Mapping[str, NDArray[np.intp]]
) -> dict[str, MassProperties]:
    """Return every unit's mass properties in its body frame; ``rows`` are each joint's rows of actuators."""
    masses: dict[str, MassProperties] = {}
    for unit in UNITS:
        if isinstance(unit, ActuatorSized):
            units = actuator_units(unit.joint, maps.of(unit.joint), leg)
            masses[unit.name] = units[unit.name].rows(rows[unit.joint])
        elif unit.name not in masses:  # all units of one length come from one table
            masses |= weighed(unit.length, leg, values[:, NAMES.index(unit.length)])
    return masses


def _costs(maps: JointMaps, leg: LegDimensions, values: Floats, rows: Mapping[str, NDArray[np.intp]]) -> Floats:
    """Return cost, made and bought parts of every robot, shape (3, n), of the units of ``_unit_masses``."""
    lengths = dict.fromkeys(unit.length for unit in UNITS if not isinstance(unit, ActuatorSized))
    of_joints = [actuator_costs(joint, maps.of(joint), leg)[:, rows[joint]] for joint in JOINTS]
    costs = reduce(add, [*of_joints, *(link_costs(name, leg, values[:, NAMES.index(name)]) for name in lengths)])
    if maps.hip is maps.knee:  # equal gearboxes have the same parts, whose set-ups are paid once
        costs[0] -= np.where(rows["hip"] == rows["knee"], of_joints[JOINTS.index("hip")][3], 0.0)
    return np.asarray(costs[:3])


def _body_masses(units: dict[str, MassProperties], options: MassOptions) -> list[MassProperties]:
    """Add up the units of each body in the order of ``BODIES``, after the options replaced what they name."""
    masses = dict(units)
    for name, mass_kg in (("base_frame", options.base_structure_mass_kg), ("foot", options.foot_mass_kg)):
        if mass_kg is not None:
            masses[name] = masses[name].scaled(mass_kg / masses[name].mass_kg)
    for name in ("thigh", "shank"):
        masses[name] = masses[name].scaled(options.link_mass_scale)
    ordered = sorted(UNITS, key=lambda unit: unit.weighed_last)
    return [reduce(add, (masses[unit.name] for unit in ordered if unit.body == body)) for body in BODIES]


def _missing(maps: JointMaps, intervals: Mapping[str, NDArray[np.intp]], values: Floats, i: int) -> str:
    """Return why robot i has no gearbox, empty if it has both."""
    for joint in JOINTS:
        if intervals[joint][i] < 0:
            ratio = float(values[i, NAMES.index(f"{joint}_ratio")])
            return f"{joint}_ratio = {ratio:g}: {maps.of(joint).why_not(ratio)}"
    return ""
