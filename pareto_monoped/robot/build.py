"""Design -> Robot: the one place where actuators, links and base become bodies with masses and inertias.

Both the simulation and the CAD read the robot from here: ``build_robot`` gives one robot with all its parts, and
``robot_arrays`` weighs a whole population with the same part functions, a row a design.

A continuous gear ratio gets the gearbox of its interval of 0.1 (stage 1), and the robot has that gearbox's real ratio.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.design import Design
from pareto_monoped.errors import DesignError
from pareto_monoped.geometry.parts import MassProperties, Part, total
from pareto_monoped.leg.dimensions import DEFAULT, LegDimensions, with_chain_for
from pareto_monoped.leg.links import base_parts, foot_part, journal_parts, shank_parts, thigh_parts
from pareto_monoped.robot.frames import BODIES, OVER, UPRIGHT, Floats, in_body

_THREAD_SPARE_MM = 0.5  # between a screw's end and the end of its thread; our own choice


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
        return in_body(total(part.mass_properties() for part in self.parts), self.turn, self.z_mm)


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
    journal = journal_parts(knee_length_m, leg, back_clearance_mm=back_clearance_mm(knee))
    units = (
        Unit(name="base_frame", body="base", parts=base_parts(knee_length_m, leg), turn=UPRIGHT, z_mm=0.0),
        Unit(name="hip_actuator", body="base", parts=hip.parts, turn=UPRIGHT, z_mm=leg.hip_mount_mm),
        Unit(name="thigh", body="thigh", parts=thigh_parts(design.thigh_length_m, leg), turn=UPRIGHT, z_mm=0.0),
        Unit(name="knee_actuator", body="thigh", parts=knee.parts_bolted_at_back, turn=OVER, z_mm=leg.knee_mount_mm),
        Unit(name="journal", body="thigh", parts=journal, turn=UPRIGHT, z_mm=0.0),
        Unit(name="shank", body="shank", parts=shank_parts(shank_length_m, leg), turn=UPRIGHT, z_mm=0.0),
        Unit(name="foot", body="shank", parts=(foot_part(shank_length_m, leg),), turn=UPRIGHT, z_mm=0.0),
    )
    return Robot(design=design, hip=hip, knee=knee, units=units)


def back_clearance_mm(actuator: Actuator) -> float:
    """How much of an actuator's back the screws of its own pattern pass through before their threads begin."""
    return actuator.mount.back_depth_mm if actuator.family == "ESSPG" else 0.0
