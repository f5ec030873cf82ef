"""What a part is for, what it moves with, how it is joined, what is ordered for it: typed, so that no behaviour depends
on a part's name, and no list on the words of a note.
"""

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
    STUCK = "stuck"  # loose needles with grease in their bore
    ENGAGED = "engaged"  # a chain on the teeth of its sprocket
    RUNNING = "running"  # a rotor in bearings that its supplier built in


SOLID_UNITS = frozenset({"piece", "mm"})
"""Units of purchases that a bought part is made of; others are used up."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Purchase:
    """What is ordered for one instance of a part."""

    kind: str  #: such as ``screw`` or ``grease``
    designation: str  #: as it is ordered, with all that tells it from its like
    standard: str = ""  #: that it follows; '' without one
    alternatives: tuple[str, ...] = ()  #: the same from other makers, or by the name of an earlier standard
    count: float = 1.0  #: for one instance, in ``unit``; 0 where it comes with another part's
    unit: str = "piece"  #: or ``g``, ``ml``, ``mm``; of a ``pack`` one is enough for a robot
    remark: str = ""  #: what is done with it before it is put in

    @property
    def text(self) -> str:
        """Such as ``2 x nut ISO 4032 - M4 - 8``."""
        several = f"{self.count:g} x " if self.unit == "piece" and self.count > 1.0 else ""
        return f"{several}{self.designation}{self.remark and f', {self.remark}'}"


# Other makers' names after their own tables of equivalents.
RETAINER = Purchase(
    kind="adhesive",
    designation="retaining compound Loctite 638",
    remark="10 ml",
    standard="ISO 10123",
    unit="pack",
    alternatives=("WEICONLOCK AN 306-38",),
)  #: Of cylinders that carry a torque: at least 25 MPa on steel.
BEARING_RETAINER = Purchase(
    kind="adhesive",
    designation="retaining compound Loctite 641",
    remark="10 ml",
    standard="ISO 10123",
    unit="pack",
    alternatives=("WEICONLOCK AN 306-41",),
)  #: Of bearings, which can be pressed out again.
EPOXY = Purchase(
    kind="adhesive",
    designation="epoxy adhesive Loctite EA 9466",
    remark="50 ml",
    unit="pack",
    alternatives=("UHU Plus Endfest",),
)  #: Of sensors and magnets, and of printed cores on plates.
GREASE = Purchase(
    kind="grease",
    designation="bearing grease SKF LGLT 2",
    standard="DIN 51825 - KP2G-50",
    unit="g",
    alternatives=("Klueber Isoflex Topas NB 52",),
)  #: Of gears and needles: stays in a case with vents, and churns little at 10,000 rpm.
GREASE_G_PER_MM3 = 0.9e-3
RUBBER_GLUE = Purchase(
    kind="adhesive",
    designation="rubber adhesive Loctite 406 with primer Loctite SF 770",
    unit="pack",
)  #: Of FKM on aluminium, which does not take an adhesive without a primer.


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint:
    """A joint that the shapes of the parts do not show."""

    kind: JointKind  #: what holds
    how: str  #: the joint in words, without the partner, such as ``pressed onto``
    partner: str  #: name of the part of the same unit that holds
    adhesive: Purchase | None = None  #: where it is bonded
    first: bool = False  #: whether a bond is made before both come to any other part; what is pressed always is

    @property
    def text(self) -> str:
        """The joint in words, for the parts list."""
        return f"{self.how} {self.partner}{f' with {self.adhesive.designation}' if self.adhesive else ''}"
