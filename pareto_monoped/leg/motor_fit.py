"""Whether a leg can be built around the actuators of a motor."""

from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.errors import MotorError, complaint
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.leg.thigh_outline import hip_short_mm


def require_leg(actuator_map: ActuatorMap, source: str | None = None) -> None:
    """Refuse a motor that is too narrow for the thigh: it has gearboxes, and no robot.

    Args:
        actuator_map: the gearboxes of the motor; there is at least one.
        source: what the motor is called, the first words of the message; default its name.

    Raises:
        MotorError: the ears of the hip's stop would stand beside the thigh's round end, which the motor's housing sets.
    """
    short = hip_short_mm(leg_dimensions(actuator_map))
    if short <= 0.0:
        return
    motor = actuator_map.motor
    first = next(entry.actuator for entry in actuator_map.entries if entry.actuator is not None)
    key, body = ("frameless", motor.frameless) if first.family == "ISSPG" else ("framed", motor.framed)
    assert body is not None
    said = complaint(
        f"{key}.outer_diameter_mm",
        body.outer_diameter_mm,
        f"at least {body.outer_diameter_mm + 2.0 * short:.4g} for a leg, so that the ears of the hip's stop are joined "
        "to the thigh",
        "choose a wider motor, or design its gearboxes alone with actuators",
    )
    raise MotorError(f"{source or f'motor {motor.name}'}: {said}")
