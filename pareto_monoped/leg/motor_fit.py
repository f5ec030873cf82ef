"""Whether a leg can be built around the actuators of a motor."""

from pareto_monoped.actuator.joint_maps import JointMaps, Maps, joint_maps
from pareto_monoped.actuator.motors import motor_source
from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import RuleSet
from pareto_monoped.errors import MotorError, complaint
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.leg.thigh_outline import hip_short_mm


def require_leg(maps: Maps, *sources: str) -> None:
    """Refuse motors that are too narrow for the thigh: they have gearboxes, and no robot.

    Args:
        maps: the gearboxes of both joints; there is at least one of each. The wider actuator decides.
        sources: what the motor is called, the first words of the message, or those of hip and knee; default the name.

    Raises:
        MotorError: the ears of the hip's stop would stand beside the thigh's round end, which the motor's housing sets.
    """
    leg, both = leg_dimensions(maps), joint_maps(maps)
    short = hip_short_mm(leg)
    if short <= 0.0:
        return
    hip_wider = leg.hip.rim_radius_mm > leg.knee.rim_radius_mm
    actuator_map = both.hip if hip_wider else both.knee
    motor = actuator_map.motor
    source = sources[0 if hip_wider else -1] if sources else f"motor {motor.name}"
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
    raise MotorError(f"{source}: {said}")


def maps_for(hip: str, knee: str, rules: RuleSet) -> JointMaps:
    """The gearboxes of a robot with these motors, each the name of a shipped one or a TOML file.

    Raises:
        MotorError: an unknown or impossible motor, or one that no gearbox or no leg fits.
    """
    maps = JointMaps(hip=map_for(hip, rules), knee=map_for(knee, rules))
    require_leg(maps, motor_source(hip), motor_source(knee))
    return maps
