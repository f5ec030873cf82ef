"""What a part is for, what it moves with, how it is joined: typed, so that no behaviour depends on a part's name."""

from dataclasses import dataclass
from enum import StrEnum


class Role(StrEnum):
    """What a part does in the machine."""

    PLATE = "plate"
    CORE = "core"
    BRACKET = "bracket"
    HOUSING = "housing"
    CARRIER = "carrier"
    GEAR = "gear"
    SPROCKET = "sprocket"
    CHAIN = "chain"
    TURNBUCKLE = "turnbuckle"
    SHAFT = "shaft"
    COUPLING = "coupling"
    BUSH = "bush"
    BEARING = "bearing"
    SPACER = "spacer"
    RETAINING_RING = "retaining ring"
    PIN = "pin"
    SCREW = "screw"
    STATOR_SCREW = "stator screw"  # screws whose place the journal's screws take, see ``Actuator.parts_bolted_at_back``
    BOLT = "bolt"  # a screw together with its nut
    ROD = "rod"
    FOOT = "foot"
    BUMPER = "bumper"  # of an end stop, soft
    STRIKER = "striker"  # what meets a bumper
    ELECTRONICS = "electronics"  # drivers, sensors and their magnets
    MOTOR_STATOR = "motor stator"
    MOTOR_ROTOR = "motor rotor"


SCREWS = frozenset({Role.SCREW, Role.STATOR_SCREW})
FASTENERS = SCREWS | {Role.BOLT}


class Group(StrEnum):
    """What a part moves with inside its unit."""

    FIXED = "fixed"  # the links' own parts
    HOUSING = "housing"
    OUTPUT = "output"
    ROTOR = "rotor"
    PLANET = "planet"
    KNEE_DRIVE = "knee_drive"  # turns with the knee actuator's output


class Visibility(StrEnum):
    """Where a part is drawn."""

    OUTSIDE = "outside"  # everywhere
    DETAIL = "detail"  # in pictures, but not in the coarse meshes of the robot models
    INSIDE = "inside"  # in neither: other parts cover it


class JointKind(StrEnum):
    """What holds a part that its shape alone does not hold."""

    PRESSED = "pressed"
    BONDED = "bonded"
    THREADED = "threaded"
    MOULDED = "moulded"
    ENGAGED = "engaged"  # a chain on the teeth of its sprocket
    RUNNING = "running"  # a rotor in bearings that its supplier built in


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint:
    """A joint that the shapes of the parts do not show."""

    kind: JointKind  #: what holds
    how: str  #: the joint in words, without the partner, such as ``pressed onto``
    partner: str  #: name of the part of the same unit that holds

    @property
    def text(self) -> str:
        """The joint in words, for the parts list."""
        return f"{self.how} {self.partner}"
