"""Calibrations: named, versioned records of everything that a jump depends on besides the robot.

Shipped in ``data/calibrations`` are ``reference``, well-posed and the default; ``paper``, the paper's simulation with
readings, fitted to its Table I; ``ideal``, which is ``reference`` without losses and with rigid drives; ``printed``,
which is ``reference`` with printed gears; and ``stand``, which is ``reference`` on the rails of the test stand.
Versions before stand in ``earlier``.
"""

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from pareto_monoped.config import NotNegative, Positive, Strict, checked, read_toml
from pareto_monoped.errors import CalibrationError, InputError, unknown_name
from pareto_monoped.jump.calibration_defaults import DEFAULT, STAND
from pareto_monoped.jump.controller_record import MOST_DELAY
from pareto_monoped.jump.laws import PAPER_LAW, AnyLaw, Law, VirtualLeg
from pareto_monoped.robot.population import MassOptions

Share = Annotated[float, Field(gt=0.0, le=1.0)]
Impedance = Annotated[float, Field(ge=0.0001, le=0.9999)]

_SHIPPED = resources.files("pareto_monoped") / "data" / "calibrations"
# Hundreds of times the steps of the shipped calibrations; the limit only keeps a typing error from running for days.
_MOST_STEPS = 1e6


@dataclass(frozen=True, slots=True, kw_only=True)
class EndStop(Strict):
    """The rubber bumpers at both ends of one joint's range, which harden as in ``SpringContact``.

    A bumper of the parts, fully compressed, leaves the joint within the range that the CAD keeps free (``leg.stops``).
    """

    #: lower_rad, upper_rad: angles at which the joint meets the bumpers
    lower_rad: float
    upper_rad: float
    width_rad: Positive  #: compression at which stiffness and damping reach their full values
    #: stiffness_n_m_per_rad, damping_n_m_s_per_rad: at that compression and beyond
    stiffness_n_m_per_rad: Positive
    damping_n_m_s_per_rad: NotNegative
    impedance: Impedance  #: MuJoCo's impedance d at that compression

    def __post_init__(self) -> None:
        """Reject an empty range."""
        if not self.lower_rad < self.upper_rad:
            raise ValueError(f"lower_rad {self.lower_rad} must be below upper_rad {self.upper_rad}; correct one")


@dataclass(frozen=True, slots=True, kw_only=True)
class Joints(Strict):
    """Losses and ends of both joints."""

    #: damping_n_m_s_per_rad, friction_n_m: viscous and Coulomb friction of each joint
    damping_n_m_s_per_rad: NotNegative
    friction_n_m: NotNegative
    #: Viscous friction at each motor's shaft; acts on the joint times the ratio squared
    motor_damping_n_m_s_per_rad: NotNegative = 0.0
    #: friction_share, motor_damping_share_s_per_rad: Coulomb friction of each joint per peak torque there, and viscous
    #: friction at each motor's shaft per peak torque there; both add to those above
    friction_share: NotNegative = 0.0
    motor_damping_share_s_per_rad: NotNegative = 0.0
    #: How the parts that turn with the knee actuator are booked: as ``armature`` of the joint alone, or with their
    #: ``absolute`` speeds, which the thigh's rotation is part of
    rotors: Literal["armature", "absolute"] = "armature"
    #: Where the end stops come from: ``given`` here as ``hip_stop`` and ``knee_stop``, or ``parts`` of the leg
    #: (``leg.stops``)
    stops: Literal["given", "parts"] = "given"
    #: How bumpers of parts push back: by a ``constraint`` of MuJoCo that is fitted to the part, or with the part's slow
    #: force times 1 + chi speed, where chi follows from the elastomer's rebound (``hunt_crossley``)
    stop_law: Literal["constraint", "hunt_crossley"] = "constraint"
    #: hip_stop, knee_stop: end stops; None for a joint that turns freely
    hip_stop: EndStop | None = None
    knee_stop: EndStop | None = None

    def __post_init__(self) -> None:
        """Refuse end stops beside those of the parts."""
        if self.stops == "parts" and (self.hip_stop or self.knee_stop):
            raise ValueError("stops = 'parts' goes without hip_stop and knee_stop; leave one of them out")
        if self.stop_law == "hunt_crossley" and self.stops != "parts":
            raise ValueError("stop_law = 'hunt_crossley' is that of bumpers; it needs stops = 'parts'; change one")


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive(Strict):
    """What lies between motor and joint."""

    mesh_losses: bool  #: whether the gearbox has losses
    chain_efficiency: Share = 1.0  #: of the chain that drives the knee
    #: Joint speed over which the load-dependent losses change sign; smooths the change
    loss_speed_rad_per_s: Positive = 0.5
    #: Whether the torque limit falls along the voltage-speed line to zero at the no-load speed
    voltage_limit: bool = True
    peak_torque_scale: Positive = 1.0  #: factor on the motors' peak torque
    #: Further factor on the knee's peak torque; its speed and inertia stay as they are
    knee_torque_scale: Positive = 1.0
    #: Of the electrical power that flows back, what the battery takes
    regeneration_share: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0
    standby_power_w: NotNegative = 0.0  #: of the electronics, as long as the jump lasts
    #: Which losses: those of the ``mesh`` alone, or the ``total`` of meshes, planets' bushes and bearings
    efficiency: Literal["mesh", "total"] = "mesh"
    #: Factor on what the gearboxes lose under load: 1 for machined gears, 1.3 to 4 for printed ones (docs/bench.md)
    gear_loss: Annotated[float, Field(ge=0.0, le=5.0)] = 1.0
    #: What the battery feeds: ``each_motor`` by itself, so that what one motor gives back is lost (all but
    #: ``regeneration_share``), or a ``bus`` on which the other motor takes it
    battery: Literal["each_motor", "bus"] = "each_motor"
    winding_rise_k: NotNegative = 0.0  #: of the windings' temperature above that of their data sheets, 20 degC
    #: Whether motors turn against their joints, through gearbox, shaft and chain; otherwise all of these are rigid
    elastic: bool = False
    #: drive_damping_ratio, backlash_rad: of an elastic drive: damping, as a share of the critical one of the motor on
    #: its spring with the joint held, and play at the joint between both directions
    drive_damping_ratio: NotNegative = 0.0
    backlash_rad: NotNegative = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringContact(Strict):
    """The contact of a rubber foot with the floor: a spring-damper that hardens with compression.

    MuJoCo's impedance rises linearly with the compression r, up to d = ``impedance`` at w = ``width_m``. With u = r / w
    the normal force of a slow compression is k w u^3 (1 - d) / (1 - d u) up to w. Force and damping set in smoothly, as
    in the model of Hunt and Crossley (1975), which makes the jump well-posed. While the foot touches, the constraint
    adds a virtual mass d u / (1 - d u) / A, where A is the inverse mass of the foot's body.
    """

    kind: Literal["spring"]
    #: stiffness_n_per_m, damping_n_s_per_m: normal to the floor, at a compression of ``width_m`` and beyond
    stiffness_n_per_m: Positive
    damping_n_s_per_m: Positive
    width_m: Positive  #: compression at which stiffness and damping reach their full values
    impedance: Impedance  #: MuJoCo's impedance d at that compression
    friction: Positive  #: Coulomb coefficient
    slip_ratio: Positive = 1.0  #: tangential over normal damping (MuJoCo's ``impratio``)


@dataclass(frozen=True, slots=True, kw_only=True)
class MujocoContact(Strict):
    """The contact of the foot, given by MuJoCo's own parameters (its documentation, "Solver parameters")."""

    kind: Literal["mujoco"]
    time_constant_s: Positive
    damping_ratio: Positive
    impedance_min: Impedance
    impedance_max: Impedance
    impedance_width_m: Positive
    friction: Positive


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactGate(Strict):
    """Torque whenever the foot touches the floor, decided at every step, as the paper words it."""

    rule: Literal["contact"]
    #: True takes the contact of the state before the last step, which is what MuJoCo's contact list holds after a step;
    #: False takes the contact of the current state
    lags: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class FadeGate(Strict):
    """Torque that fades to zero as the foot rises to a clearance c: times 1 - s(c / length_m), s(u) = 3 u^2 - 2 u^3."""

    rule: Literal["fade"]
    length_m: Positive  #: clearance at which no torque is left
    latch: bool = True  #: whether the controller stays off after the foot has risen that far


@dataclass(frozen=True, slots=True, kw_only=True)
class Flight(Strict):
    """Springs and dampers that the motors imitate to pull the leg to its start pose in flight, within peak torque."""

    stiffness_n_m_per_rad: Positive
    damping_n_m_s_per_rad: NotNegative


@dataclass(frozen=True, slots=True, kw_only=True)
class Controller(Strict):
    """The law of the motors, and what the paper's final text leaves open about the virtual leg (section II-B)."""

    #: L0, rest length of the virtual spring; 10 m in a passage missing from the final text
    rest_length_m: Positive = 10.0
    gravity_feed_forward: NotNegative = 1.0  #: factor on the term m g of F_z; 1 in the paper
    weight: Literal["robot", "base"] = "robot"  #: whose mass m is, that of the whole ``robot`` or of its ``base``
    flight: Flight | None = None  #: what the motors do while the foot is off the floor; None: nothing
    law: AnyLaw = PAPER_LAW  #: what the motors are told while it is on the floor


@dataclass(frozen=True, slots=True, kw_only=True)
class Simulation(Strict):
    """Integration of the equations of motion."""

    integrator: Literal["Euler", "RK4", "implicitfast", "implicit"]  #: MuJoCo's integrator
    timestep_s: Positive  #: step of the integrator
    #: What makes the steps: ``mujoco``, or the planar leg written out, ``compiled``, which gives the same but for
    #: rounding; films, exports and the jumps that judge a front are MuJoCo's in any case
    engine: Literal["mujoco", "compiled"] = "mujoco"
    time_limit_s: Positive = 3.0  #: a jump that is not over by then has failed
    base_slides: bool = True  #: whether the base may move in x; otherwise a vertical guide holds it
    #: Period of the controller, a whole number of steps, in which the motors' torques are held; None: each step is a
    #: period
    control_period_s: Positive | None = None
    delay_s: NotNegative = 0.0  #: from measuring to acting, a whole number of control periods, at most 8
    #: Speed used for the work of a step. ``mean`` of both ends is what MuJoCo's step turns into kinetic energy;
    #: ``start`` is how the paper's sum is written.
    work_speed: Literal["mean", "start"] = "mean"
    #: Which positions the controller reads: those of MuJoCo's ``state``, or those half a step earlier. A semi-implicit
    #: step moves the positions with the new speeds, so that they belong to a time half a step later than the speeds.
    #: ``half_step_back`` reads positions and speeds of one time.
    positions_read: Literal["state", "half_step_back"] = "state"

    def __post_init__(self) -> None:
        """Refuse periods of no whole number of steps, delays of no whole number of periods, and reading RK4 back."""
        if self.integrator == "RK4" and self.positions_read != "state":
            raise ValueError(
                f"positions_read {self.positions_read!r} is for semi-implicit integrators; RK4 needs 'state'; "
                "change one of them"
            )
        if not _whole(self.period_s / self.timestep_s) or self.period_steps < 1:
            raise ValueError(
                f"control_period_s {self.period_s:g} must be a whole multiple of timestep_s {self.timestep_s:g}; "
                "change one"
            )
        if not _whole(self.delay_s / self.period_s) or self.delay_s > MOST_DELAY * self.period_s * (1.0 + 1e-9):
            raise ValueError(
                f"delay_s {self.delay_s:g} must be 0 to {MOST_DELAY} whole control periods of {self.period_s:g} s; "
                "correct it"
            )

    @property
    def period_s(self) -> float:
        """Period of the controller."""
        return self.timestep_s if self.control_period_s is None else self.control_period_s

    @property
    def period_steps(self) -> int:
        """Steps of the integrator in one control period."""
        return round(self.period_s / self.timestep_s)


@dataclass(frozen=True, slots=True, kw_only=True)
class Stand(Strict):
    """The test stand, whose arms and carriages the base lifts as well: their mass is that of ``leg.stand``."""

    rail_friction_n: NotNegative  #: Coulomb friction of each carriage on its rail


def _whole(number: float) -> bool:
    """Return whether a number is whole but for rounding."""
    return math.isfinite(number) and abs(number - round(number)) < 1e-6


@dataclass(frozen=True, slots=True, kw_only=True)
class Calibration(Strict):
    """Everything that a jump depends on besides the robot; every result names its calibration.

    Example:
        >>> from dataclasses import replace
        >>> from pareto_monoped import load_calibration
        >>> known = load_calibration("reference")
        >>> slippery = replace(known, name="slippery", contact=replace(known.contact, friction=0.5))
        >>> slippery.label
        'slippery-4'
    """

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9_.-]+$")]
    version: Annotated[int, Field(ge=1)]
    description: str
    mass: MassOptions
    joints: Joints
    drive: Drive
    contact: Annotated[SpringContact | MujocoContact, Field(discriminator="kind")]
    gate: Annotated[ContactGate | FadeGate, Field(discriminator="rule")]
    controller: Controller
    simulation: Simulation
    stand: Stand | None = None  #: None: nothing hangs on the base, and what guides it has no friction

    def __post_init__(self) -> None:
        """Refuse torques in flight with a gate that ends them, and a stand on which the base slides away."""
        if self.stand is not None and self.simulation.base_slides:
            raise ValueError("simulation.base_slides must be false with a table stand, whose rails hold it; correct it")
        if self.simulation.engine == "compiled" and (lacks := self.lacks_for_compiled()):
            raise ValueError(f"simulation.engine 'compiled' needs {lacks}; choose that, or the engine 'mujoco'")
        if self.controller.flight is not None and not isinstance(self.gate, ContactGate):
            raise ValueError(f"gate.rule {self.gate.rule!r} must be 'contact' if controller.flight is set; drop one")

    def lacks_for_compiled(self) -> str:
        """Return what the engine ``compiled`` would need, empty if nothing."""
        stops = self.joints.hip_stop or self.joints.knee_stop or self.joints.stops == "parts"
        if self.simulation.integrator != "Euler":
            return "simulation.integrator 'Euler'"
        if not isinstance(self.contact, SpringContact):
            return "contact.kind 'spring'"
        return "joints.stop_law 'hunt_crossley'" if stops and self.joints.stop_law == "constraint" else ""

    def by(self, engine: Literal["mujoco", "compiled"]) -> "Calibration":
        """Return the same calibration with an engine."""
        if self.simulation.engine == engine:
            return self
        return replace(self, simulation=replace(self.simulation, engine=engine))

    def under(self, law: Law) -> "Calibration":
        """Return the same calibration with a law of the motors."""
        return replace(self, controller=replace(self.controller, law=law))  # type: ignore[arg-type]  # or one of a script

    @property
    def label(self) -> str:
        """Name and version, as quoted in results."""
        return f"{self.name}-{self.version}"


_LATER = {
    "joints": ("rotors", "stops", "friction_share", "motor_damping_share_s_per_rad", "stop_law"),
    "drive": (
        *("knee_torque_scale", "regeneration_share", "standby_power_w", "efficiency", "battery", "winding_rise_k"),
        *("elastic", "drive_damping_ratio", "backlash_rad", "gear_loss"),
    ),
    "controller": ("weight", "flight", "law"),
    "simulation": ("control_period_s", "delay_s", "positions_read", "engine"),
}  #: Fields that calibrations did not always have, by table.


def calibration_values(calibration: Calibration) -> dict[str, Any]:
    """Return every value of a calibration as JSON has it, for ``calibration_of``.

    Fields in ``_LATER``, and ``stand``, are left out at their defaults, so that studies stored before keep their hash.
    """
    values: dict[str, Any] = json.loads(json.dumps(asdict(calibration)))
    for table, names in _LATER.items():
        defaults = {field.name: _plain(field.default) for field in fields(getattr(calibration, table))}
        values[table] = {
            name: value for name, value in values[table].items() if name not in names or value != defaults[name]
        }
    if calibration.stand is None:
        del values["stand"]
    return values


def _plain(default: Any) -> Any:
    """Return a default as JSON has it."""
    return asdict(default) if isinstance(default, VirtualLeg) else default


def on_stand(calibration: Calibration) -> Calibration:
    """Return a calibration with the base on the shipped stand, if it is on none, and all else as it is."""
    if calibration.stand is not None:
        return calibration
    guided = replace(calibration.simulation, base_slides=False)
    return replace(calibration, simulation=guided, stand=load_calibration(STAND).stand)


def calibration_names() -> tuple[str, ...]:
    """Return names of the calibrations shipped with the package, the default first."""
    names = sorted(entry.name.removesuffix(".toml") for entry in _SHIPPED.iterdir() if entry.name.endswith(".toml"))
    return (DEFAULT, *(name for name in names if name != DEFAULT))


def earlier_calibrations() -> tuple[str, ...]:
    """Return labels of the earlier versions that are shipped for comparison, such as ``reference-1``."""
    return tuple(sorted(entry.name.removesuffix(".toml") for entry in (_SHIPPED / "earlier").iterdir()))


@cache
def _present_labels() -> Mapping[str, str]:
    """Return the label of each shipped calibration's present version, such as ``reference-4`` -> its name."""
    return {load_calibration(name).label: name for name in calibration_names()}


def _is_path(name_or_path: str) -> bool:
    return "/" in name_or_path or name_or_path.endswith(".toml")


def require_calibration_name(name_or_path: str, *, key: str = "calibration") -> None:
    """Refuse what is neither the name or label of a shipped calibration nor a file, which is not opened.

    Raises:
        CalibrationError: an unknown name; the message begins with ``key``.
    """
    if _is_path(name_or_path) or name_or_path in calibration_names() or name_or_path in earlier_calibrations():
        return
    if name_or_path not in _present_labels():
        known = (*calibration_names(), *sorted((*earlier_calibrations(), *_present_labels())))
        raise CalibrationError(unknown_name(key, name_or_path, known, ", or a TOML file"))


def load_calibration(name_or_path: str = DEFAULT) -> Calibration:
    """Return a calibration by its name, or from a user's TOML file (anything with a slash or ending in ``.toml``).

    A name means the present version; a label (``reference-1``) means that version, the present one or an earlier one.

    Raises:
        CalibrationError: unknown name, unreadable file, or a field missing, unknown or out of range.
    """
    require_calibration_name(name_or_path)
    if _is_path(name_or_path):
        path = Path(name_or_path)
    elif name := name_or_path if name_or_path in calibration_names() else _present_labels().get(name_or_path):
        path = Path(str(_SHIPPED / f"{name}.toml"))
    else:
        path = Path(str(_SHIPPED / "earlier" / f"{name_or_path}.toml"))
    values: dict[str, Any] = read_toml(path, what="calibration file", error=CalibrationError)
    return calibration_of(values, source=f"calibration file {path.name!r}")


def calibration_of(
    values: Mapping[str, Any], *, source: str, error: type[InputError] = CalibrationError
) -> Calibration:
    """Return a calibration from plain values, nested as in its file; ``source`` begins error messages.

    Raises:
        CalibrationError: (or ``error``) a field is missing, unknown or out of range.
    """
    calibration = checked(Calibration, values, source=source, error=error)
    step, least = calibration.simulation.timestep_s, calibration.simulation.time_limit_s / _MOST_STEPS
    if step < least:
        raise error(
            f"{source}: simulation.timestep_s = {step:g}: must be at least {least:g}, a millionth of time_limit_s; "
            "lengthen the step"
        )
    return calibration
