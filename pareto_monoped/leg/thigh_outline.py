"""The outline of the thigh's plates, with ears and a heel for the end stops, and whether a leg fits a motor at all."""

import math

import numpy as np

from pareto_monoped.actuator.motors import motor_source
from pareto_monoped.actuator.ratiomap import JointMaps, Maps, joint_maps
from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import RuleSet
from pareto_monoped.errors import DesignError, MotorError, complaint
from pareto_monoped.geometry.shapes import Numbers, Path
from pareto_monoped.leg.dimensions import LegDimensions, leg_dimensions
from pareto_monoped.leg.sandwich import Pulley, belt, mirrored
from pareto_monoped.leg.stop_parts import WING, thigh_stop_faces
from pareto_monoped.leg.stops import Face, hip_stop, knee_stop

# Our own layout, mm.
_CORNER = 2.0  # radius of the ears' corners
_FILLET = 8.0  # between an ear and the bar
_FILLET_GAP = 0.5  # from where a fillet would touch the round end
_EAR_FOOT = 14.0  # from an ear's end along the bar to the middle of its fillet
_SPARE = 1.0  # of an edge beyond the seat or striker that stands on it
_FRONT_FILLET = 31.0  # of the middle of the fillet before the knee above its axis, next to the round end
HEEL_WIDTH = 22.0  # of the heel's tip; what it carries is computed in ``strength.stops``
_HEEL_FILLET = 5.0  # radius, between heel and knee


def thigh_outline(top_radius_mm: float, length_mm: Numbers, d: LegDimensions) -> Path:
    """Return the outline of one plate."""
    hip_front, _, extension, flexion = thigh_stop_faces(length_mm, d)
    at_hip, at_knee = hip_stop(d).half_face_mm, knee_stop(d).half_face_mm
    hip = Pulley(x_mm=0.0, y_mm=0.0, radius_mm=top_radius_mm)
    knee = Pulley(x_mm=0.0, y_mm=-length_mm, radius_mm=d.knee_radius_mm)
    # From the bar up to the hip on the front, in the order of the belt; behind it is the same.
    ear = (
        _fillet(hip_front.y_mm - at_hip - _EAR_FOOT, d),
        _corner(hip_front, -at_hip),
        _hip_fillet(hip_front, top_radius_mm),
    )
    return belt(
        (
            hip,
            *mirrored(ear),
            _fillet(flexion.y_mm + at_knee + _EAR_FOOT, d).mirrored,
            _corner(flexion, -at_knee),
            _corner(flexion, at_knee),
            knee,
            *_heel(extension, d),
            _fillet(_FRONT_FILLET - length_mm, d),
            *ear,
        )
    )


def _fillet(y_mm: Numbers, d: LegDimensions) -> Pulley:
    return Pulley(x_mm=d.thigh_half_width_mm + _FILLET, y_mm=y_mm, radius_mm=_FILLET, inside=False)


def _corner(face: Face, end_mm: float, width_mm: float = 0.0) -> Pulley:
    """Return a corner of an edge under a seat or striker that ends at ``end_mm``, ``width_mm`` behind the edge."""
    spare = math.copysign(_SPARE - _CORNER, end_mm)
    x, y = face.point(end_mm + spare, WING + _CORNER + width_mm)
    return Pulley(x_mm=x, y_mm=y, radius_mm=_CORNER)


def outer_hip_radius_mm(d: LegDimensions) -> float:
    """Return the radius of the outer plate at the hip: a narrower knee actuator's still reaches the stop's ears."""
    least = _least_hip_radius_mm(thigh_stop_faces(0.0, d)[0])
    return max(d.knee.rim_radius_mm, min(d.rim_radius_mm, least))


def hip_short_mm(d: LegDimensions) -> float:
    """Return by how much the outer plate's round end is too small for the ears of the hip's stop; 0 or less if not."""
    return _least_hip_radius_mm(thigh_stop_faces(0.0, d)[0]) - outer_hip_radius_mm(d)


def _least_hip_radius_mm(face: Face) -> float:
    """Return the radius of the round end that an ear's edge touches."""
    return float(face.x_mm) - WING


def _hip_fillet(face: Face, top_radius_mm: float) -> Pulley:
    """Return the fillet between an ear's edge and the round end at the hip, which it almost touches.

    Raises:
        DesignError: the ear stands beside the round end; ``require_leg`` refuses such motors.
    """
    least = _least_hip_radius_mm(face)
    x = least + _FILLET
    if top_radius_mm < least:
        raise DesignError(
            complaint(
                "the thigh's radius in mm at the hip",
                round(top_radius_mm, 2),
                f"at least {least:.4g}, so that the ears of the hip's stop are joined to it",
                "choose a wider motor",
            )
        )
    return Pulley(
        x_mm=x,
        y_mm=-_FILLET_GAP - float(np.sqrt((top_radius_mm + _FILLET) ** 2 - x**2)),
        radius_mm=_FILLET,
        inside=False,
    )


def heel_arm_mm(d: LegDimensions) -> float:
    """Return the distance of the bumper's force from the heel's root, where the fillet in front of the edge begins."""
    stop = knee_stop(d)
    high = stop.bumper.diameter_mm + WING - _HEEL_FILLET
    return stop.lever_mm - float(np.sqrt((d.knee_radius_mm + _HEEL_FILLET + _FILLET_GAP) ** 2 - high**2))


def _heel(face: Face, d: LegDimensions) -> tuple[Pulley, ...]:
    """Return the heel with the seat for extension, from behind to its front, which runs straight up past the knee."""
    stop = knee_stop(d)
    x, y = face.point(-heel_arm_mm(d), WING - _HEEL_FILLET)
    root = Pulley(x_mm=x, y_mm=y, radius_mm=_HEEL_FILLET, inside=False)
    end = stop.half_face_mm
    return root, _corner(face, end), _corner(face, end, HEEL_WIDTH - 2.0 * _CORNER)


def require_leg(maps: Maps, *sources: str) -> None:
    """Refuse motors that are too narrow for the thigh: they have gearboxes, and no robot.

    ``sources``: what the motor is called, the first words of the message, or those of hip and knee; default the name.

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
    """Return the gearboxes of a robot with these motors, each the name of a shipped one or a TOML file.

    Raises:
        MotorError: an unknown or impossible motor, or one that no gearbox or no leg fits.
    """
    maps = JointMaps(hip=map_for(hip, rules), knee=map_for(knee, rules))
    require_leg(maps, motor_source(hip), motor_source(knee))
    return maps
