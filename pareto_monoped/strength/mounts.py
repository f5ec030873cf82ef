"""Joints between the actuators and the links: dowels and screws of output flanges and housings, threads, fits.

Dowels carry the torque and the force across the joint; the friction of the screws comes on top and is not counted.
Torque T and force F load a dowel with T / (n r) and F / n; the sum of both is the load of the worst placed one.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from pareto_monoped.geometry.dowels import Dowel
from pareto_monoped.geometry.making import interference_mm
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import Group, Role
from pareto_monoped.geometry.shapes import Numbers
from pareto_monoped.leg.base import base_parts
from pareto_monoped.leg.hip import hip_joints
from pareto_monoped.materials import ALLOYS, MATERIALS
from pareto_monoped.strength.connections import SHAPE_SAFETY, PressFit
from pareto_monoped.strength.drive import dowel_force_n, yield_mpa
from pareto_monoped.strength.joint import LegJoint, Side, Structure
from pareto_monoped.strength.threads import tightened

_CARRIER, _HOUSING, _PLATE = "aw_7075_t6", "aw_6082_t6", "aw_6082_t6"
"""Alloys of the output flange, of the actuator's housing and of the thigh's plates."""
_ANY_LENGTH_M = 0.05
"""Of the knee actuator behind a base whose near cheek is asked for."""


def dowels_under(torque_n_m: Any, force_n: Any, acting_n_m: Any, acting_n: Any) -> Any:
    """Return the safety factor of dowels that carry so much torque alone, or so much force alone, under both."""
    return 1.0 / (acting_n_m / torque_n_m + acting_n / force_n)


def _circle(parts: tuple[Part, ...], role: Role, pitch_radius_mm: Numbers, group: Group) -> Part:
    """Return the circle of dowels or screws with a radius."""
    (found,) = (
        part
        for part in parts
        if part.role is role and part.group is group and np.isclose(float(part.pitch_radius_mm), pitch_radius_mm)
    )
    return found


def _ends(pin: Part) -> tuple[float, float]:
    return min(float(p.z0_mm) for p in pin.prisms), max(float(p.z1_mm) for p in pin.prisms)


def _torque_and_force(pin: Part, *layers: tuple[float, float]) -> tuple[float, float]:
    force = dowel_force_n(pin, *layers)
    return 1e-3 * force * float(pin.pitch_radius_mm), force


def hip_output(s: Structure) -> tuple[float, float]:
    """Return torque and force that the dowels between hip's output, its coupling and the thigh's plate carry."""
    d = s.leg
    pin = _circle(hip_joints(d), Role.PIN, d.hip.output_dowel.pitch_radius_mm, Group.FIXED)
    low, high = _ends(pin)
    flange, plate = d.hip_mount_mm - low, high + d.thigh_face_mm
    return _torque_and_force(pin, (flange, ALLOYS[_CARRIER].yield_mpa), (plate, ALLOYS[_PLATE].yield_mpa))


def knee_output(s: Structure) -> tuple[float, float]:
    """Return torque and force that the dowels between knee's output, its coupling and the drive sprocket carry."""
    d, parts = s.leg, hip_joints(s.leg)
    pin = _circle(parts, Role.PIN, d.drive_dowel.pitch_radius_mm, Group.KNEE_DRIVE)
    sprocket = next(part for part in parts if part.role is Role.SPROCKET)
    low, high = _ends(pin)
    layers = (
        (high - d.knee_mount_mm, ALLOYS[_CARRIER].yield_mpa),
        (max(float(p.z1_mm) for p in sprocket.prisms) - low, yield_mpa(sprocket)),
    )
    return _torque_and_force(pin, *layers)


def knee_mount(s: Structure) -> tuple[float, float]:
    """Return the torque and force that the dowels between the knee actuator's housing and the outer plate carry."""
    d = s.leg
    pin = _circle(hip_joints(d), Role.PIN, d.knee.mount_dowel.pitch_radius_mm, Group.FIXED)
    _, high = _ends(pin)
    layers = ((high - d.knee_mount_mm, ALLOYS[_HOUSING].yield_mpa), (d.plate_mm, ALLOYS[_PLATE].yield_mpa))
    return _torque_and_force(pin, *layers)


def hip_mount(s: Structure) -> tuple[float, float]:
    """Return the torque and force that the dowels between the hip actuator's housing and the base's cheek carry."""
    d = s.leg
    pin = _circle(base_parts(_ANY_LENGTH_M, d), Role.PIN, d.hip.mount_dowel.pitch_radius_mm, Group.FIXED)
    low, high = _ends(pin)
    stress = ALLOYS[_HOUSING].yield_mpa, ALLOYS[_PLATE].yield_mpa
    return _torque_and_force(pin, (d.hip_mount_mm - low, stress[0]), (high - d.hip_mount_mm, stress[1]))


def screws_tightened(s: Structure) -> float:
    """Return the least of ``tightened`` over all screws between the actuators and the links."""
    d, thigh, base = s.leg, hip_joints(s.leg), base_parts(_ANY_LENGTH_M, s.leg)
    sprocket = yield_mpa(next(part for part in thigh if part.role is Role.SPROCKET))
    carrier, housing, plate = (ALLOYS[name].yield_mpa for name in (_CARRIER, _HOUSING, _PLATE))
    return min(
        tightened(_circle(thigh, Role.SCREW, d.hip.output_pitch_radius_mm, Group.FIXED), carrier, plate),
        tightened(_circle(thigh, Role.SCREW, d.knee.output_pitch_radius_mm, Group.KNEE_DRIVE), carrier, sprocket),
        tightened(_circle(thigh, Role.SCREW, d.knee.mount_pitch_radius_mm, Group.FIXED), housing, plate),
        tightened(_circle(base, Role.SCREW, d.hip.mount_pitch_radius_mm, Group.FIXED), housing, plate),
    )


def dowels_pressed(s: Structure) -> float:
    """Return the elastic limit of the metal around a dowel over the pressure of its tightest fit, the least of all
    dowels.

    The metal around it is as thick as the thinnest wall beside the hole: 2.5 mm in flange and coupling, 0.7 mm in the
    housing's rim. The small dowels of the coupling stand in 1.6 mm or more.
    """
    d = s.leg
    rows = (
        # The hip coupling is weaker than the flange.
        *((fit.output_dowel_mm, 2.5, ALLOYS[_PLATE].yield_mpa) for fit in (d.hip, d.knee)),
        *((fit.mount_dowel_mm, 0.7, ALLOYS[_HOUSING].yield_mpa) for fit in (d.hip, d.knee)),
        (2.5, 1.6, ALLOYS[_CARRIER].yield_mpa),
    )
    return min(_pressed(Dowel(diameter_mm=size), wall, limit) for size, wall, limit in rows)


def _pressed(dowel: Dowel, wall_mm: float, stress_mpa: float) -> float:
    size = dowel.diameter_mm
    fit = PressFit(diameter_mm=size, hub_mm=size + 2.0 * wall_mm, hub=MATERIALS.aluminium, pin=MATERIALS.steel)
    _, most = interference_mm(size, dowel.hole_fit.zone, dowel.fit.zone)
    return fit.elastic_limit_mpa(stress_mpa) / fit.pressure_mpa(most)


def _dowel_row(
    name: str, side: Side, force: str, capacity: Callable[[Structure], tuple[float, float]], parts: tuple[str, ...]
) -> LegJoint:
    """Return a circle of dowels between an actuator and a link, under its gearbox's torque and a force across it."""
    return LegJoint(
        name=name,
        group="joints",
        formula="1 / (T / (n d l Rp0.2 r) + F / (n d l Rp0.2))",
        source="Roloff/Matek, 9.2: pressure in the holes of pins; both loads summed",
        required=SHAPE_SAFETY,
        required_source="our own choice: dowels that share a load do not quite share it evenly",
        loads=(f"peak_gear_torque_{side}_n_m", force),
        capacity=capacity,
        factor=dowels_under,
        parts=parts,
        cure=f"release the {side}'s torque before its stop, or a lower {side}_ratio",
    )


_CHAIN, _FOOT = "peak_chain_tension_n", "peak_foot_force_n"
JOINTS = (
    _dowel_row("hip_output_dowels", "hip", _FOOT, hip_output,
        ("hip_coupling_dowel", "hip_coupling", "thigh_plate_inner")),
    _dowel_row("knee_output_dowels", "knee", _CHAIN, knee_output, ("drive_dowel", "drive_coupling", "drive_sprocket")),
    _dowel_row("knee_mount_dowels", "knee", _CHAIN, knee_mount, ("knee_mount_dowel", "thigh_plate_outer")),
    _dowel_row("hip_mount_dowels", "hip", _FOOT, hip_mount, ("hip_mount_dowel", "base_near_cheek")),
    LegJoint(name="actuator_screws_tightened", group="joints",
        formula="least of thread and seat over the assembly preload F_M",
        source="VDI 2230-1, R10 and R11, against yield", required=1.0,
        required_source="the preload is the largest force: a clamped joint adds little to it", loads=(),
        capacity=screws_tightened, factor=lambda least: least,
        parts=("hip_coupling_screw", "drive_screw", "knee_mount_screw", "hip_mount_screw"),
        cure="a lower property class, or deeper threads"),
    LegJoint(name="dowels_pressed", group="joints", formula="elastic limit / pressure of the tightest H7/m6",
        source="DIN 7190-1; limits of ISO 286-2", required=1.0,
        required_source="the fit may just stay elastic: it is seldom at its tightest", loads=(),
        capacity=dowels_pressed, factor=lambda least: least,
        parts=("hip_coupling_dowel", "drive_dowel", "knee_mount_dowel", "coupling_dowel", "ring_housing_dowel"),
        cure="a looser fit"),
)  # fmt: skip
