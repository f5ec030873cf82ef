"""What a part is for, and how it is joined to another: typed, so that no behaviour hangs on a part's name."""

from dataclasses import dataclass
from enum import StrEnum


class Role(StrEnum):
    """What a part does in the machine."""

    PLATE = "plate"
    CORE = "core"
    HOUSING = "housing"
    CARRIER = "carrier"
    GEAR = "gear"
    SPROCKET = "sprocket"
    CHAIN = "chain"
    TURNBUCKLE = "turnbuckle"
    SHAFT = "shaft"
    BUSH = "bush"
    BEARING = "bearing"
    SPACER = "spacer"
    RETAINING_RING = "retaining ring"
    PIN = "pin"
    SCREW = "screw"
    NUT = "nut"
    ROD = "rod"
    BUMPER = "bumper"
    FOOT = "foot"
    MOTOR_STATOR = "motor stator"
    MOTOR_ROTOR = "motor rotor"
    ELECTRONICS = "electronics"


class JointKind(StrEnum):
    """How a part is held where its shape alone does not hold it."""

    PRESSED = "pressed"
    BONDED = "bonded"
    THREADED = "threaded"
    MOULDED = "moulded"
    ENGAGED = "engaged"  # a chain on the teeth of its sprocket
    RUNNING = "running"  # a rotor in bearings that its supplier built in


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint:
    """A joint that no shape shows.

    Attributes:
        kind: what holds.
        partner: name of the part of the same unit that holds.
        text: the joint in words, for the parts list.
    """

    kind: JointKind
    partner: str
    text: str
