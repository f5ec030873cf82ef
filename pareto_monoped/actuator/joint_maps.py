"""The gearboxes of a robot's joints: hip and knee may have different motors."""

from dataclasses import dataclass

from pareto_monoped.actuator.motor import Motor
from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.errors import DesignError


@dataclass(frozen=True, slots=True, kw_only=True)
class JointMaps:
    """The gearboxes that hip and knee choose from: one map twice where both have the same motor.

    Compared by the identity of both maps, as ``ActuatorMap`` is.

    Attributes:
        hip, knee: ratio -> lightest actuator of the joint's motor.

    Raises:
        DesignError: the maps follow different rules.
    """

    hip: ActuatorMap
    knee: ActuatorMap

    def __post_init__(self) -> None:
        one, other = self.hip.settings.rules, self.knee.settings.rules
        if one != other:
            raise DesignError(
                f"rules of the hip's gearboxes = {one!r}: must be those of the knee's, {other!r}; build both maps with "
                "the same rules"
            )

    def of(self, joint: str) -> ActuatorMap:
        """The map of ``hip`` or ``knee``."""
        return {"hip": self.hip, "knee": self.knee}[joint]

    @property
    def rules(self) -> str:
        """Rules of all gearboxes, see ``actuator.settings``."""
        return self.hip.settings.rules

    @property
    def motors(self) -> tuple[Motor, ...]:
        """The motor of both joints, or that of the hip and that of the knee."""
        return (self.hip.motor,) if self.hip is self.knee else (self.hip.motor, self.knee.motor)

    @property
    def label(self) -> str:
        """Name of the motor, or the names of both, such as ``U8 hip, VT8020 knee``."""
        return motor_label(self.hip.motor.name, self.knee.motor.name)


Maps = ActuatorMap | JointMaps
"""The gearboxes of a robot; one map stands for both joints."""


def joint_maps(maps: Maps) -> JointMaps:
    """The gearboxes of both joints."""
    return maps if isinstance(maps, JointMaps) else JointMaps(hip=maps, knee=maps)


def motor_label(hip: str, knee: str) -> str:
    """Name of the motor of both joints, or the names of both motors with the joints."""
    return hip if hip == knee else f"{hip} hip, {knee} knee"
