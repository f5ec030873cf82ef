"""What carries the end stops: bumpers, seats and strikers with their bolts, the thigh's heel, the base's rods.

A stop of torque T pushes with F = T / lever. Every capacity but the bumpers' is the torque of a stop at which something
yields, in elastic theory (straight beams: Roark's Formulas for Stress and Strain, chapter 8).
"""

from collections.abc import Callable
from functools import partial

import numpy as np

from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.screws import M3, M4
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.sandwich import sleeve_hole
from pareto_monoped.leg.stop_parts import FOOT_DEPTH, HALF_FOOT, HALF_HEAD, HEAD, TOE, WING, base_stop_parts
from pareto_monoped.leg.stops import JointStop, hip_seats, hip_stop, knee_stop
from pareto_monoped.leg.thigh_outline import HEEL_WIDTH, heel_arm_mm
from pareto_monoped.materials import ALLOYS, MATERIALS
from pareto_monoped.strength.drive import screw_preload_n
from pareto_monoped.strength.joint import SIDES, LegJoint, Side, Structure

Capacity = Callable[[Structure], float]
ALLOY = ALLOYS["aw_6082_t6"]
"""Of plates, seats, strikers and rods."""
_PLATES = 2
RUBBER_FRICTION = 0.8
"""Of dry rubber on metal (handbooks: 0.5 to 0.8)."""


def trapezium_mm(broad_mm: float, narrow_mm: float, straight_mm: float, depth_mm: float) -> float:
    """Return the mean width of a section that is ``broad_mm`` wide to a depth and then tapers to ``narrow_mm``."""
    return (broad_mm * straight_mm + 0.5 * (broad_mm + narrow_mm) * (depth_mm - straight_mm)) / depth_mm


def beam_n(span_mm: float, width_mm: float, depth_mm: float, yield_mpa: float) -> float:
    """Return the even load at which a beam on two supports yields: M = F l / 8, Z = b h^2 / 6."""
    return 8.0 / span_mm * width_mm * depth_mm**2 / 6.0 * yield_mpa


def cantilever_n(arm_mm: float, thick_mm: float, high_mm: float, yield_mpa: float) -> float:
    """Return the force at its end at which a plate yields that stands out by an arm: M = F a, Z = t h^2 / 6."""
    return thick_mm * high_mm**2 / 6.0 / arm_mm * yield_mpa


def rod_n(radius_mm: float, bore_mm: float, from_support_mm: float, yield_mpa: float) -> float:
    """Return the force across a tube at which it yields near a support: M = F a, more than F a b / (a + b)."""
    modulus = 0.25 * np.pi * (radius_mm**4 - bore_mm**4) / radius_mm
    return float(modulus * yield_mpa / from_support_mm)


def lifted_n(screw: Part) -> float:
    """Return the force of a bumper at which its striker, sliding along the joint's axis, lifts the seat off the cheek.

    The rods carry the stop's force. Along them, nothing but the screw holds the seat, against the friction of rubber.
    """
    return screw_preload_n(screw, MATERIALS) / RUBBER_FRICTION


def rod_share(force_at: tuple[float, float], normal_rad: float, rods: tuple[tuple[float, float], ...]) -> float:
    """Return the load of the heavier of two rods: half of the force, and its couple F e over their distance."""
    (x0, y0), (x1, y1) = rods
    dx, dy = force_at[0] - 0.5 * (x0 + x1), force_at[1] - 0.5 * (y0 + y1)
    arm = abs(dx * np.sin(normal_rad) - dy * np.cos(normal_rad))
    return float(0.5 + arm / np.hypot(x1 - x0, y1 - y0))


def _stop(side: Side, d: LegDimensions) -> JointStop:
    return hip_stop(d) if side == "hip" else knee_stop(d)


def _torque_n_m(stop: JointStop, force_n: float) -> float:
    return 1e-3 * stop.lever_mm * force_n


def on_edges(side: Side, s: Structure) -> float:
    """Return the limit of the seat or striker that stands on the edges of the thigh's plates."""
    stop = _stop(side, s.leg)
    return _torque_n_m(stop, _PLATES * s.leg.plate_mm * (2.0 * stop.half_face_mm) * ALLOY.yield_mpa)


def foot(side: Side, s: Structure) -> float:
    """Return the limit of the foot of that seat or striker between the plates, beside the bolt's hole."""
    stop = _stop(side, s.leg)
    width = trapezium_mm(2.0 * stop.half_face_mm, 2.0 * HALF_FOOT, WING, FOOT_DEPTH) - 2.0 * sleeve_hole(M3)
    return _torque_n_m(stop, beam_n(s.leg.gap_mm, width, FOOT_DEPTH, ALLOY.yield_mpa))


def heel(s: Structure) -> float:
    """Return the limit of the heel of the thigh's plates."""
    thick = _PLATES * s.leg.plate_mm
    return _torque_n_m(knee_stop(s.leg), cantilever_n(heel_arm_mm(s.leg), thick, HEEL_WIDTH, ALLOY.yield_mpa))


def striker(s: Structure) -> float:
    """Return the limit of the head of the knee's striker, beside its bolt's hole, between the shank's plates."""
    stop = knee_stop(s.leg)
    width = trapezium_mm(2.0 * stop.half_face_mm, 2.0 * HALF_HEAD, TOE, HEAD) - 2.0 * sleeve_hole(M4)
    return _torque_n_m(stop, beam_n(s.leg.shank_gap_mm, width, HEAD, ALLOY.yield_mpa))


def striker_bolt(s: Structure) -> float:
    """Return the limit of the bolt of that head in the shank's plates."""
    plates = _PLATES * s.leg.shank_plate_mm
    return _torque_n_m(knee_stop(s.leg), 2.0 * sleeve_hole(M4) * plates * ALLOY.yield_mpa)


def rods(s: Structure) -> float:
    """Return the limit of the base's rods, which carry the hip's seats next to the near cheek."""
    d, stop = s.leg, hip_stop(s.leg)
    seat, _ = hip_seats(d)
    at = (float(seat.x_mm), float(seat.y_mm))
    share = rod_share(at, seat.normal_rad, (d.lower_rod_mm, d.upper_rod_mm))
    one = rod_n(d.rod_radius_mm, M4.core, -(d.hip_mount_mm + d.cheek_mm), ALLOY.yield_mpa)
    return _torque_n_m(stop, one / share)


def seat_screw(s: Structure) -> float:
    """Return the limit of the screw that holds one of the hip's seats on the near cheek."""
    (screw,) = (part for part in base_stop_parts(s.leg) if part.role is Role.SCREW)
    return _torque_n_m(hip_stop(s.leg), lifted_n(screw))


_PARTS = {"hip": ("hip_striker_front", "hip_striker_rear"), "knee": ("knee_seat_extension", "knee_seat_flexion")}


def _row(name: str, side: Side, formula: str, capacity: Capacity, parts: tuple[str, ...]) -> LegJoint:
    return LegJoint(
        name=name,
        group="stops",
        formula=formula,
        source="elastic beams and mean pressures, see strength.stop_seats",
        required=1.2,
        required_source="our own choice against yield: 1.1 of EN 1999-1-1 for the metal, 10 percent for the impact's "
        "scatter",
        loads=(f"peak_stop_torque_{side}_n_m",),
        capacity=capacity,
        parts=parts,
        cure=f"release the {side}'s torque before its stop, or jump lower",
    )


JOINTS = (
    *(
        row
        for side in SIDES
        for row in (
            _row(
                f"{side}_stop_edges",
                side,
                "lever A R_e / T",
                partial(on_edges, side),
                (*_PARTS[side], "thigh_plate_inner", "thigh_plate_outer"),
            ),
            _row(f"{side}_stop_foot", side, "lever 8 Z R_e / gap / T", partial(foot, side), _PARTS[side]),
        )
    ),
    _row("knee_heel", "knee", "lever Z R_e / arm / T", heel, ("thigh_plate_inner", "thigh_plate_outer")),
    _row("knee_striker", "knee", "lever 8 Z R_e / gap / T", striker, ("knee_striker",)),
    _row("knee_striker_bolt", "knee", "lever d 2 t R_e / T", striker_bolt, ("knee_striker_bolt",)),
    _row("hip_stop_screws", "hip", "lever F_V / mu_rubber / T", seat_screw, ("hip_seat_screw",)),
    _row("hip_stop_rods", "hip", "lever Z R_e / (a (1/2 + e / s)) / T", rods, ("base_rod",)),
)
STOP_JOINTS = tuple(
    LegJoint(name=f"{side}_bumper", group="stops", formula="travel / compression",
        source="leg.stops.MOST_COMPRESSION: half the diameter, up to which Lindley's law was measured", required=1.0,
        required_source="the travel is itself a limit of the design: the metal is clear of itself up to it",
        loads=(f"stop_compression_{side}",), capacity=lambda s: 1.0,
        parts=(f"{side}_bumper_{one}", f"{side}_bumper_{other}"),
        cure=f"release the {side}'s torque before its stop, or jump lower")
    for side, (one, other) in zip(SIDES, (("front", "rear"), ("extension", "flexion")), strict=True)
)  # fmt: skip
