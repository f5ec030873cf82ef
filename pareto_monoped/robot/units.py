"""The table of units, what a robot is made of, and the bodies, joints and frames in which they are described.

``build`` makes the parts of one robot from this table, ``tables`` weighs the same parts for whole populations.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.geometry.parts import MassProperties, Part
from pareto_monoped.geometry.shapes import Floats, Numbers
from pareto_monoped.leg.base import base_parts
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.journal import journal_parts
from pareto_monoped.leg.shank import foot_part, shank_parts
from pareto_monoped.leg.thigh import thigh_parts

BODIES = ("base", "thigh", "shank")
JOINTS = ("hip", "knee")
PART_TO_BODY: Floats = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""From part frames (z along the joint axis, y up along the link) to body frames (y along the joint axis, z up)."""
UPRIGHT: Floats = np.eye(3)
"""Turn of a unit that stands in its body's part frame as it is drawn."""
OVER: Floats = np.diag([1.0, -1.0, -1.0])
"""Half a turn about x: the output of the knee actuator points to -z, at the thigh."""
for _matrix in (PART_TO_BODY, UPRIGHT, OVER):
    _matrix.flags.writeable = False


def in_body(properties: MassProperties, turn: Floats, z_mm: float) -> MassProperties:
    """Move mass properties from a unit's frame to the body frame."""
    move = PART_TO_BODY @ np.array([0.0, 0.0, 1e-3 * z_mm])
    return properties.placed(PART_TO_BODY @ turn, move)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UnitKind:
    """A row of the table: which body carries the unit, and where."""

    name: str  #: unique
    body: str  #: the body that carries it, one of ``BODIES``
    turn: Floats = field(default_factory=lambda: UPRIGHT)  #: rotation from the unit's frame to the body's part frame
    #: Where the unit's origin lies on the body's proximal joint axis, in the body's part frame; default: in the middle
    z_mm: Callable[[LegDimensions], float] = lambda leg: 0.0
    #: Added to the mass of its body after all other units. The last bit of a sum depends on its order, and so do the
    #: results of stored studies.
    weighed_last: bool = False

    def in_body(self, properties: MassProperties, leg: LegDimensions) -> MassProperties:
        """Move mass properties from the unit's frame to the body frame."""
        return in_body(properties, self.turn, self.z_mm(leg))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ActuatorSized(UnitKind):
    """A unit whose parts depend on an actuator."""

    joint: str  #: the joint that this actuator drives, one of ``JOINTS``
    #: The parts of the unit, in its own frame, for that actuator
    parts: Callable[[Actuator, LegDimensions], tuple[Part, ...]]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LinkSized(UnitKind):
    """A unit whose parts depend on a link length."""

    length: str  #: the length, a name of ``design.NAMES``
    #: The parts of the unit, in its own frame, for that length in metres (a float or shape (n,))
    parts: Callable[[Numbers, LegDimensions], tuple[Part, ...]]


def _journal(knee: Actuator, leg: LegDimensions) -> tuple[Part, ...]:
    # Screws into the motor of an ESSPG pass through its backplate first; an ISSPG has the threads in the backplate.
    clearance_mm = knee.mount.back_depth_mm if knee.family == "ESSPG" else 0.0
    return journal_parts(1e-3 * knee.length_mm, leg, back_clearance_mm=clearance_mm)


UNITS: tuple[ActuatorSized | LinkSized, ...] = (
    ActuatorSized(
        name="base_frame", body="base", joint="knee", parts=lambda knee, d: base_parts(1e-3 * knee.length_mm, d)
    ),
    ActuatorSized(
        name="hip_actuator",
        body="base",
        z_mm=lambda leg: leg.hip_mount_mm,
        weighed_last=True,
        joint="hip",
        parts=lambda hip, _: hip.parts,
    ),
    LinkSized(name="thigh", body="thigh", length="thigh_length_m", parts=thigh_parts),
    ActuatorSized(
        name="knee_actuator",
        body="thigh",
        turn=OVER,
        z_mm=lambda leg: leg.knee_mount_mm,
        weighed_last=True,
        joint="knee",
        parts=lambda knee, _: knee.parts_bolted_at_back,
    ),
    ActuatorSized(name="journal", body="thigh", joint="knee", parts=_journal),
    LinkSized(name="shank", body="shank", length="shank_length_m", parts=shank_parts),
    LinkSized(name="foot", body="shank", length="shank_length_m", parts=lambda length, leg: (foot_part(length, leg),)),
)
"""All units, from the base down to the foot: the order in which a robot lists them."""
