"""Design -> Robot: one robot with all its parts, as the CAD exports it.

The simulation reads the same parts through ``population.robot_arrays``. A continuous gear ratio gets the gearbox of its
interval of 0.1 (stage 1), so the robot has the real ratio of that gearbox.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.ratiomap import Maps, joint_maps
from pareto_monoped.design import Design
from pareto_monoped.geometry.parts import MassProperties, Part, total
from pareto_monoped.geometry.shapes import Floats
from pareto_monoped.leg.dimensions import LegDimensions, leg_dimensions
from pareto_monoped.robot.cost import Cost, robot_cost
from pareto_monoped.robot.units import BODIES, UNITS, ActuatorSized, LinkSized, in_body


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Unit:
    """A group of parts of one robot that a body carries as a whole, made from a row of ``units.UNITS``."""

    name: str  #: as in the table of units
    body: str  #: the body that carries it, one of ``BODIES``
    parts: tuple[Part, ...]  #: in the unit's own frame
    turn: Floats  #: rotation from the unit's frame to the body's part frame (x forward, y up, z along the joint axis)
    z_mm: float  #: where the unit's origin lies on the body's proximal joint axis, in the body's part frame

    def __repr__(self) -> str:
        """One line: the body that carries it and the number of parts."""
        return f"Unit({self.name!r}, on {self.body!r}, {len(self.parts)} parts)"

    def mass_properties(self) -> MassProperties:
        """Return all parts together, in the body frame."""
        return in_body(total(part.mass_properties() for part in self.parts), self.turn, self.z_mm)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Robot:
    """One robot with every part that has a mass."""

    design: Design  #: what was asked for; the gearboxes' real ratios are ``hip.ratio`` and ``knee.ratio``
    hip: Actuator
    knee: Actuator
    leg: LegDimensions  #: dimensions of links and base
    units: tuple[Unit, ...]  #: from the base down to the foot

    def __repr__(self) -> str:
        """One line: motors, real ratios, link lengths and mass."""
        design = self.design
        return (
            f"Robot(hip {self.hip.motor.name!r} {self.hip.ratio:.4f}:1, knee {self.knee.motor.name!r} "
            f"{self.knee.ratio:.4f}:1, thigh {design.thigh_length_m:.4g} m, shank {design.shank_length_m:.4g} m, "
            f"{self.mass_kg:.3f} kg)"
        )

    def body_mass_properties(self) -> Mapping[str, MassProperties]:
        """Return each body's parts together, in its body frame (see ``RobotArrays``)."""
        return {body: total(u.mass_properties() for u in self.units if u.body == body) for body in BODIES}

    @property
    def mass_kg(self) -> float:
        """Mass of the whole robot."""
        return float(sum(unit.mass_properties().mass_kg for unit in self.units))

    @property
    def cost(self) -> Cost:
        """What all parts cost, roughly, and how many are made and bought."""
        return robot_cost(unit.parts for unit in self.units)


def build_robot(design: Design, maps: Maps) -> Robot:
    """Make the robot of a design, part by part.

    Raises:
        DesignError: no gearbox of the joint's motor has the gear ratio.
    """
    both = joint_maps(maps)
    hip, knee = both.hip.lookup(design.hip_ratio), both.knee.lookup(design.knee_ratio)
    leg = leg_dimensions(both)
    units = tuple(
        Unit(
            name=kind.name,
            body=kind.body,
            parts=_parts(kind, design, {"hip": hip, "knee": knee}, leg),
            turn=kind.turn,
            z_mm=kind.z_mm(leg),
        )
        for kind in UNITS
    )
    return Robot(design=design, hip=hip, knee=knee, leg=leg, units=units)


def _parts(
    kind: ActuatorSized | LinkSized, design: Design, actuators: Mapping[str, Actuator], leg: LegDimensions
) -> tuple[Part, ...]:
    if isinstance(kind, ActuatorSized):
        return kind.parts(actuators[kind.joint], leg)
    return kind.parts(getattr(design, kind.length), leg)
