"""Threads and seats of all screws: whether what a screw is driven into, and what its head stands on, bears its preload.

The thread that a screw engages is looked up in the features of the parts: the tapped hole of its size in its place.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from pareto_monoped.geometry.features import Hole
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import SCREWS, Role
from pareto_monoped.geometry.screws import HEXAGON_FLATS_MM
from pareto_monoped.geometry.shapes import Circle, Pattern
from pareto_monoped.leg.base import base_parts
from pareto_monoped.leg.journal import journal_parts
from pareto_monoped.leg.shank import shank_parts
from pareto_monoped.leg.thigh import thigh_parts
from pareto_monoped.materials import ALLOYS
from pareto_monoped.strength.connections import MISES, head_force_n, thread_force_n
from pareto_monoped.strength.drive import MOTOR_FACE_MPA, fastening, shank_and_thread_mm
from pareto_monoped.strength.joint import SIDES, ActuatorJoint, LegJoint, Structure

_NEAR_MM = 1e-6
_ANY_LENGTH_M, _ANY_ACTUATOR_M = 0.4, 0.05  # of links and of the knee actuator whose screws are asked for


def tightened(screw: Part, thread_mpa: float, seat_mpa: float) -> float:
    """Return the force that thread and seat of a screw carry, whichever is less, over the preload that it is tightened
    to.

    A countersunk head is not looked at: its cone lies on more metal than a cap's face.

    ``thread_mpa``: yield stress of what it is driven into; ``seat_mpa``: yield stress of what its head stands on.
    """
    found = fastening(screw)
    _, engaged = shank_and_thread_mm(screw)
    forces = [thread_force_n(found.thread, engaged, MISES * thread_mpa)]
    if found.head != "countersunk":
        forces.append(head_force_n(found, seat_mpa))
    return min(forces) / found.preload_n


def _axes_mm(part: Part, centres_mm: Iterable[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return the axes of every instance of something at these centres of a part, in the unit's frame."""
    found = []
    count, radius = int(part.count), float(part.pitch_radius_mm)
    for x, y, _ in part.places_mm:
        for k in range(count if radius else 1):
            angle = float(part.phase_rad) + 2.0 * np.pi * k / count if radius else 0.0
            cos, sin = np.cos(angle), np.sin(angle)
            found += [
                (float(x) + cos * (radius + a) - sin * b, float(y) + sin * (radius + a) + cos * b)
                for a, b in centres_mm
            ]
    return found


def _centres_mm(shape: Circle | Pattern) -> list[tuple[float, float]]:
    return shape.centres_mm() if isinstance(shape, Pattern) else [(float(shape.x_mm), float(shape.y_mm))]


def _tapped(part: Part, diameter_mm: float) -> list[tuple[float, float]]:
    centres = [
        centre
        for feature in part.features
        if isinstance(feature, Hole) and feature.thread is not None and feature.thread.diameter_mm == diameter_mm
        for shape in feature.shapes
        for centre in _centres_mm(shape)
    ]
    return _axes_mm(part, centres)


def _spans(part: Part) -> list[tuple[float, float]]:
    """Return the heights between which each layer of a part lies, at every place."""
    return [
        (float(z) + float(prism.z0_mm), float(z) + float(prism.z1_mm))
        for _, _, z in part.places_mm
        for prism in part.prisms
    ]


def threaded_mpa(screw: Part, parts: Sequence[Part]) -> float | None:
    """Return the yield stress of the weakest part with a tapped hole for a screw on its axis and height, or None."""
    axis = _axes_mm(screw, [(0.0, 0.0)])[0]
    size = fastening(screw).thread.diameter_mm
    thread = min(screw.prisms, key=lambda p: float(p.outline.radius_mm) if isinstance(p.outline, Circle) else np.inf)
    middle = 0.5 * (float(thread.z0_mm) + float(thread.z1_mm)) + float(screw.places_mm[0][2])
    limits = [
        part.grade.yield_mpa
        for part in parts
        if part.grade is not None
        and any(low <= middle <= high for low, high in _spans(part))
        and any(np.hypot(x - axis[0], y - axis[1]) < _NEAR_MM for x, y in _tapped(part, size))
    ]
    return min(limits, default=None)


def least_tightened(parts: Sequence[Part], seat_mpa: float) -> float:
    """Return the least of ``tightened`` over the screws that are driven into one of these parts; infinite without."""
    found = [
        tightened(screw, limit, seat_mpa)
        for screw in parts
        if screw.role in SCREWS and (limit := threaded_mpa(screw, parts)) is not None
    ]
    return min(found, default=float(np.inf))


_SEAT_MPA = ALLOYS["aw_6082_t6"].yield_mpa
"""Yield stress under heads: of the weakest alloy that any of them stands on."""


def leg_threads(s: Structure) -> float:
    """Return the least share of thigh, shank and base: screws of cups, standoffs, seats and rods, heads and nuts."""
    units = (thigh_parts(_ANY_LENGTH_M, s.leg), shank_parts(_ANY_LENGTH_M, s.leg), base_parts(_ANY_ACTUATOR_M, s.leg))
    through = (part for unit in units for part in unit if part.role is Role.BOLT)
    bolts = [fastening(part) for part in through if fastening(part).head == "cap"]
    # A nut bears like a hexagon head of its size.
    nuts = [replace(bolt, head="hexagon", head_mm=HEXAGON_FLATS_MM[bolt.thread.diameter_mm]) for bolt in bolts]
    under = [head_force_n(seat, _SEAT_MPA) / seat.preload_n for seat in (*bolts, *nuts)]
    return min(*(least_tightened(unit, _SEAT_MPA) for unit in units), *under)


def journal_threads(s: Structure) -> float:
    """Return the share of the journal's screws in the back of the knee actuator."""
    # As in ``robot.units``: through the backplate of an ESSPG into its motor.
    clearance_mm = s.actuator.mount.back_depth_mm if s.actuator.family == "ESSPG" else 0.0
    parts = journal_parts(1e-3 * s.actuator.length_mm, s.leg, back_clearance_mm=clearance_mm)
    (screw,) = (part for part in parts if part.role in SCREWS)
    return tightened(screw, MOTOR_FACE_MPA, _SEAT_MPA)


def actuator_threads(s: Structure) -> float:
    """Return the least share of an actuator's own screws, the motor's threads among them."""
    parts = s.actuator.parts
    screws = [part for part in parts if part.role in SCREWS]
    return min(tightened(screw, threaded_mpa(screw, parts) or MOTOR_FACE_MPA, _SEAT_MPA) for screw in screws)


_FORMULA = "least of thread and seat over the assembly preload F_M"
_SOURCE = "VDI 2230-1, R10 and R11, against yield"
_REASON = "the preload is the largest force: a clamped joint adds little to it"
_CURE = "a lower property class, or deeper threads"
_OWN = ("backplate_screw", "casing_screw", "ring_housing_screw", "coupling_screw", "stator_screw", "planet_pin_screw")


def _least(least: Any) -> Any:
    return least


JOINTS: tuple[ActuatorJoint | LegJoint, ...] = (
    LegJoint(name="leg_threads", group="joints", formula=_FORMULA, source=_SOURCE, required=1.0,
        required_source=_REASON, loads=(), capacity=leg_threads, factor=_least,
        cure=_CURE, parts=("knee_cup_screw_near", "knee_cup_screw_far", "thigh_standoff_screw", "hip_seat_screw",
            "base_rod", "knee_bolt")),
    *(
        ActuatorJoint(name=name, group="joints", side=side, formula=_FORMULA, source=_SOURCE, required=1.0,
            required_source=_REASON, loads=(), capacity=capacity, factor=_least, parts=parts, cure=_CURE)
        for name, side, capacity, parts in (
            ("hip_actuator_threads", SIDES[0], actuator_threads, _OWN),
            ("knee_actuator_threads", SIDES[1], actuator_threads, _OWN),
            ("knee_journal_threads", SIDES[1], journal_threads, ("journal_screw",)),
        )
    ),
)  # fmt: skip
