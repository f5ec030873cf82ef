"""The file of a two-link leg on a rail that others built: its bodies, drives and pushes, each number with its source.

``replay`` makes the robot of this package from it. Pairs are forward and down, or hip and knee.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from pareto_monoped.config import NotNegative, Positive, Strict, checked, read_toml
from pareto_monoped.errors import InputError, complaint
from pareto_monoped.jump.calibration import Share, SpringContact, load_calibration
from pareto_monoped.jump.controller_record import MOST_DELAY

Number = Annotated[float, Field(allow_inf_nan=False)]
Pair = tuple[Number, Number]
MeanAndSd = tuple[Positive, NotNegative]
KINDS = ("read", "computed", "inferred")
"""How a number of the file is known: it stands in its source, follows from it, or is our own assumption."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Carried(Strict):
    """What slides on the rail with the hip's axis, or is lifted besides."""

    mass_kg: NotNegative
    friction_n: NotNegative = 0.0  #: Coulomb friction of the rail


@dataclass(frozen=True, slots=True, kw_only=True)
class Link(Strict):
    """One link with all that moves with it."""

    length_m: Positive  #: from its upper joint to the next, or to the centre of the foot
    mass_kg: Positive
    com_m: Pair  #: centre of mass from the upper joint, with the link hanging
    inertia_kg_m2: Positive  #: about that centre


@dataclass(frozen=True, slots=True, kw_only=True)
class LegDrive(Strict):
    """Motor and gearbox of one joint; that of the knee rides on the thigh."""

    ratio: Positive
    #: torque_constant_n_m_per_a, winding_resistance_ohm: of the motor as its equivalent DC machine
    torque_constant_n_m_per_a: Positive
    winding_resistance_ohm: Positive
    #: peak_torque_n_m, no_load_speed_rad_per_s: limits at the joint
    peak_torque_n_m: Positive
    no_load_speed_rad_per_s: Positive
    rotor_inertia_kg_m2: NotNegative  #: about the motor's axis
    efficiency: Share = 1.0  #: under load
    stiffness_n_m_per_rad: Positive | None = None  #: between motor and joint; None: rigid


@dataclass(frozen=True, slots=True, kw_only=True)
class Friction(Strict):
    """Friction at each joint and in its drive."""

    friction_n_m: NotNegative
    damping_n_m_s_per_rad: NotNegative
    drive_damping_ratio: NotNegative = 0.03  #: of drives with a stiffness, as in ``calibration.Drive``


@dataclass(frozen=True, slots=True, kw_only=True)
class Foot(Strict):
    """The foot, a ball at the end of the shank."""

    radius_m: Positive


@dataclass(frozen=True, slots=True, kw_only=True)
class Control(Strict):
    """When commands act."""

    period_s: Annotated[float, Field(ge=1e-4, le=0.1)]
    delay_s: NotNegative = 0.0  #: whole periods

    def __post_init__(self) -> None:
        """Refuse delays that the controller does not have."""
        periods = self.delay_s / self.period_s
        if abs(periods - round(periods)) > 1e-6 or round(periods) > MOST_DELAY:
            allowed = f"0 to {MOST_DELAY} whole periods of {self.period_s:g} s"
            raise ValueError(complaint("delay_s", self.delay_s, allowed, "correct it"))


@dataclass(frozen=True, slots=True, kw_only=True)
class Push(Strict):
    """One push from rest: the law of ``torques.push`` until the foot is ``until_m`` below the hip."""

    #: crouch_m, until_m: distance of the foot below the hip at the start, and where the push ends
    crouch_m: Positive
    until_m: Positive
    forward_m: Number = 0.0  #: place of the foot before the hip at the start
    force_n: Pair = (0.0, 0.0)  #: of the foot on the floor
    force_limit_n_m: tuple[Positive, Positive] | None = None  #: of its torques at the joints; None: that of the drives
    #: stiffness_n_per_m, damping_n_s_per_m: adds to the force, towards place and speed of the foot below
    stiffness_n_per_m: Pair = (0.0, 0.0)
    damping_n_s_per_m: Pair = (0.0, 0.0)
    foot_m: Pair = (0.0, 0.0)  #: place of the foot against the hip that the springs pull to
    foot_m_per_s: Pair = (0.0, 0.0)
    jacobian: Literal["pose", "target"] = "pose"  #: whether forces become torques in the leg's pose or that of foot_m
    added_n_m: Pair = (0.0, 0.0)  #: constant torque
    #: joint_stiffness_n_m_per_rad, joint_damping_n_m_s_per_rad: springs and dampers of the joints to pose and speeds of
    #: ``foot_m``
    joint_stiffness_n_m_per_rad: NotNegative = 0.0
    joint_damping_n_m_s_per_rad: NotNegative = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Measured(Strict):
    """What was measured, as mean and standard deviation of the hops."""

    push_s: MeanAndSd
    take_off_m_per_s: MeanAndSd  #: of the centre of mass
    apex_m: MeanAndSd  #: of the hip above the foot's place on the floor, with the leg as in flight


MEASURED = tuple(Measured.__dataclass_fields__)


@dataclass(frozen=True, slots=True, kw_only=True)
class Series(Strict):
    """Hops under one command."""

    name: Annotated[str, Field(min_length=1)]
    push: Push
    measured: Measured | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RailLeg(Strict):
    """A two-link leg on a vertical rail."""

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9_.-]+$")]
    base: Carried
    thigh: Link
    shank: Link
    foot: Foot
    hip_drive: LegDrive
    knee_drive: LegDrive
    joints: Friction
    control: Control
    flight_leg_m: Positive  #: distance of the foot below the hip in flight, in which the apex is measured
    series: Annotated[tuple[Series, ...], Field(min_length=1)]
    #: From the dotted key of a number or a table to how it is known and where it is from, as "read: page 3"
    sources: dict[str, str]
    contact: SpringContact | None = None  #: None: that of the calibration ``reference``

    def __post_init__(self) -> None:
        """Refuse poses out of reach, drives of two kinds, and numbers without a source."""
        least, most = abs(self.thigh.length_m - self.shank.length_m), self.thigh.length_m + self.shank.length_m
        reach = f"above {least:g} and below {most:g}, which the links reach"
        lengths = {"flight_leg_m": self.flight_leg_m}
        for one in self.series:
            push, key = one.push, f"series.{one.name}.push"
            lengths |= {f"{key}.crouch_m": push.crouch_m, f"{key}.until_m": push.until_m}
            if push.jacobian == "target" or push.joint_stiffness_n_m_per_rad or push.joint_damping_n_m_s_per_rad:
                lengths[f"{key}.foot_m"] = (push.foot_m[0] ** 2 + push.foot_m[1] ** 2) ** 0.5
            if push.until_m <= push.crouch_m:
                raise ValueError(complaint(f"{key}.until_m", push.until_m, f"above {push.crouch_m:g}", "correct it"))
        for key, length in lengths.items():
            if not least < length < most:
                raise ValueError(complaint(key, length, reach, "correct it"))
        names = [one.name for one in self.series]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(complaint("series.name", name, "different in each series", "rename one"))
        for key in ("hip_drive", "knee_drive"):
            drive: LegDrive = getattr(self, key)
            if drive.stiffness_n_m_per_rad is not None and drive.rotor_inertia_kg_m2 == 0.0:
                allowed = "above 0 with a stiffness_n_m_per_rad"
                raise ValueError(
                    complaint(f"{key}.rotor_inertia_kg_m2", 0.0, allowed, "correct it, or drop the stiffness")
                )
        if (self.hip_drive.stiffness_n_m_per_rad is None) != (self.knee_drive.stiffness_n_m_per_rad is None):
            raise ValueError("stiffness_n_m_per_rad must be given for both drives or for none; add or drop one")


def _leaves(values: Any, key: str) -> Iterator[str]:
    """Yield the dotted keys of all numbers; a series goes by its name."""
    if isinstance(values, Mapping):
        for name, value in values.items():
            yield from _leaves(value, f"{key}.{name}".lstrip("."))
    elif isinstance(values, list) and values and isinstance(values[0], Mapping):
        for value in values:
            yield from _leaves({k: v for k, v in value.items() if k != "name"}, f"{key}.{value['name']}")
    else:
        yield key


def _check_sources(values: Mapping[str, Any], source: str) -> None:
    """Refuse numbers without a source, sources of no number, and sources that do not say how the number is known."""
    sources = values["sources"]
    leaves = list(_leaves({k: v for k, v in values.items() if k not in ("name", "sources")}, ""))
    for key, text in sources.items():
        kind, _, where = text.partition(":")
        if kind not in KINDS or not where.strip():
            allowed = f"{' or '.join(map(repr, KINDS))}, a colon and where it is from"
            raise InputError(f"{source}: {complaint(f'sources.{key!r}', text, allowed, 'correct it')}")
        if not any(f"{leaf}.".startswith(f"{key}.") for leaf in leaves):
            raise InputError(f"{source}: sources.{key!r}: names nothing in the file; correct or drop it")
    for leaf in leaves:
        if not any(f"{leaf}.".startswith(f"{key}.") for key in sources):
            raise InputError(f"{source}: sources: {leaf!r} has none; add one, for it or for its table")


def load_leg(path: Path) -> RailLeg:
    """Return the leg of a TOML file.

    Raises:
        InputError: the file is unreadable, or a value missing, unknown, out of range or without a source.
    """
    values = read_toml(path, what="leg file")
    source = f"leg file {path.name!r}"
    leg = checked(RailLeg, values, source=source)
    _check_sources(values, source)
    return leg


def contact_of(leg: RailLeg) -> SpringContact:
    """Return the contact of the leg's foot."""
    if leg.contact is not None:
        return leg.contact
    contact = load_calibration("reference").contact
    assert isinstance(contact, SpringContact)
    return contact
