"""The knee: dowels and bearings of its axle, and shaft and coupling of its drive.

The chain pulls the drive in the middle plane. The needle bearing in the hip coupling carries it in front, the
actuator's main bearing behind, both as pivots. The dowels take the torque from the output flange through coupling and
shaft flange to the sprocket, so that the stub of the shaft in the needles is bent, but not twisted.
"""

from functools import lru_cache
from typing import Any

import numpy as np

from pareto_monoped.actuator.bearings import rated_bearing
from pareto_monoped.actuator.service.loads import main_bearing_depth_mm
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import Group, Role
from pareto_monoped.geometry.shapes import Circle, Pattern
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.hip import hip_joints
from pareto_monoped.leg.knee import AXLE_DOWEL, DOWEL_DEPTH, axle_dowels
from pareto_monoped.leg.sprocket import middle_mm
from pareto_monoped.leg.stops import knee_stop, knee_strikers
from pareto_monoped.materials import ALLOYS
from pareto_monoped.strength.connections import MISES
from pareto_monoped.strength.drive import layout_of, screw_preload_n, yield_mpa
from pareto_monoped.strength.joint import ActuatorJoint, LegJoint, Structure

AXLE, PLATE = ALLOYS["aw_7075_t6"], ALLOYS["aw_6082_t6"]
_BEARINGS = 2


def dowels_n_m(
    count: float, circle_mm: float, diameter_mm: float, layers: tuple[tuple[float, float], ...], pin_mpa: float
) -> float:
    """Return the torque at which a circle of dowels yields a hole or itself; layers are depths and yield stresses."""
    holes = min(diameter_mm * depth * stress for depth, stress in layers)
    shear = 0.75 * 0.25 * np.pi * diameter_mm**2 * MISES * pin_mpa  # 4 / 3 of the mean in the middle
    return float(1e-3 * count * circle_mm * min(holes, shear))


def bearing_safety(static_n: Any, lever_mm: Any, cross: Any, *loads: Any) -> Any:
    """Return the safety s0 = 2 C0 / P of the knee's two bearings (ISO 76).

    The chain pulls the shank along the thigh by F_c, and the stop pushes it by F_s = T / lever at an angle to that. The
    bearings balance both and what the shank needs, the force K at the knee, in whatever direction:
    P <= K + |F_c + F_s|.

    ``cross``: cosine of the angle between both forces; ``loads``: pull of the chain, torque of the stop, force at the
    knee.
    """
    return _BEARINGS * static_n / bearings_n(lever_mm, cross, *loads)


def bearings_n(lever_mm: Any, cross: Any, pull: Any, torque: Any, knee: Any) -> Any:
    """Return the load of both bearings of the knee together; arguments as of ``bearing_safety``."""
    push = 1e3 * torque / lever_mm
    together = np.sqrt(np.square(pull) + np.square(push) + 2.0 * cross * pull * push)
    return knee + together


def bearing_life(dynamic_n: Any, turns: Any, lever_mm: Any, cross: Any, *loads: Any) -> Any:
    """Return L10 of the knee's bearings (ISO 281) over the turns of the duty, if each turn had the peak load."""
    return 1e6 * (_BEARINGS * dynamic_n / bearings_n(lever_mm, cross, *loads)) ** 3 / turns


def _dowels(s: Structure) -> float:
    """Return the chain's pull at which the axle's dowels yield; both plates take the axle's torque."""
    holes, plate_mm = axle_dowels(), s.leg.shank_plate_mm
    layers = ((plate_mm, PLATE.yield_mpa), (DOWEL_DEPTH, AXLE.yield_mpa))
    one = dowels_n_m(
        float(holes.count), float(holes.pitch_radius_mm), AXLE_DOWEL.diameter_mm, layers, AXLE_DOWEL.alloy.yield_mpa
    )
    return 2.0 * one / (1e-3 * s.leg.chain.pitch_radius_mm)


def stop_direction(s: Structure) -> float:
    """Return the cosine between the chain's pull on the shank, towards the hip, and the push of the stop."""
    stop = knee_stop(s.leg)
    extension, _ = knee_strikers(s.leg)
    # The shank turns clockwise, seen along -z; the bumper pushes against the striker's face.
    return -float(np.sin(extension.normal_rad - stop.lower_rad))


def _bearings(s: Structure) -> tuple[float, ...]:
    static = float(rated_bearing(2.0 * s.leg.bearing_bore_radius_mm).static_rating_n)
    return static, knee_stop(s.leg).lever_mm, stop_direction(s)


def _life(s: Structure) -> tuple[float, ...]:
    """Return what ``bearing_life`` needs; in each jump the knee swings through its range and back."""
    stop = knee_stop(s.leg)
    turns = s.settings.parts.duty.jumps * 2.0 * (stop.upper_rad - stop.lower_rad) / (2.0 * np.pi)
    dynamic = float(rated_bearing(2.0 * s.leg.bearing_bore_radius_mm).dynamic_rating_n)
    return dynamic, turns, stop.lever_mm, stop_direction(s)


_CURE = "release the knee's torque before its stop, a lower knee_ratio, or a motor of less torque"
JOINTS = (
    LegJoint(name="knee_axle_dowels", group="joints",
        formula="2 n r min(d t R_e, 3 pi d^2 tau_e / 16) / (F_chain r_sprocket)",
        source="pins in holes and in shear: Roloff/Matek, Maschinenelemente, chapter 9", required=1.5,
        required_source="our own choice: dowels and plates do not share a load quite evenly; friction is not counted",
        loads=("peak_chain_tension_n",), capacity=_dowels,
        parts=("knee_axle", "knee_axle_dowel_near", "knee_axle_dowel_far"), cure=_CURE),
    LegJoint(name="knee_bearing_static", group="joints",
        formula="2 C0 / (F_knee + |F_chain + T_stop / lever|), as vectors", source="ISO 76", required=1.0,
        required_source="makers' catalogues: 1 for normal demands; the bearing swings and does not run",
        loads=("peak_chain_tension_n", "peak_stop_torque_knee_n_m", "peak_knee_force_n"), capacity=_bearings,
        factor=bearing_safety, parts=("knee_bearing",), cure=_CURE),
    LegJoint(name="knee_bearing_life", group="joints",
        formula="1e6 (2 C / P)^3 / (jumps 2 range / 2 pi), P as of knee_bearing_static",
        source="ISO 281, L10; swings as parts of turns", required=1.0,
        required_source="a life of the duty's jumps; the peak is taken for all of the swing",
        loads=("peak_chain_tension_n", "peak_stop_torque_knee_n_m", "peak_knee_force_n"), capacity=_life,
        factor=bearing_life, parts=("knee_bearing",), cure=_CURE),
)  # fmt: skip


def tube_modulus_mm3(outer_mm: float, inner_mm: float) -> float:
    """Return the section modulus of a tube against bending; twice as much against torsion."""
    return float(0.25 * np.pi * (outer_mm**4 - inner_mm**4) / outer_mm)


def bending_and_torsion(limit_mpa: Any, bent_per_n: Any, twisted_per_n_m: Any, pull_n: Any, torque_n_m: Any) -> Any:
    """Return yield over von Mises stress; stresses are in MPa per N of pull and per N m of torque."""
    return limit_mpa / np.sqrt(np.square(bent_per_n * pull_n) + 3.0 * np.square(twisted_per_n_m * torque_n_m))


@lru_cache(maxsize=16)
def _parts(d: LegDimensions) -> tuple[Part, ...]:
    """Return what turns with the knee's output; all gearboxes of a map share it."""
    return tuple(part for part in hip_joints(d) if part.group is Group.KNEE_DRIVE)


def _drive(s: Structure, role: Role) -> Part:
    (found,) = (part for part in _parts(s.leg) if part.role is role)
    return found


def _moment_mm(s: Structure, height_mm: float) -> float:
    """Return the bending moment of the drive at a height z, per newton of the chain's pull, which acts at z = 0."""
    front, behind = -middle_mm(), s.leg.knee_mount_mm + float(main_bearing_depth_mm(layout_of(s)))
    if height_mm < 0.0:
        return behind / (front + behind) * (front + height_mm)
    return front / (front + behind) * (behind - height_mm)


def shaft_n(s: Structure) -> float:
    """Return the chain's pull at which the stub of the shaft yields where it leaves the sprocket, in its relief."""
    shaft = _drive(s, Role.SHAFT)
    stub, relief, *_ = sorted(shaft.prisms, key=lambda prism: float(prism.z0_mm))
    (bore,) = stub.holes
    assert isinstance(relief.outline, Circle)
    assert isinstance(bore, Circle)
    modulus = tube_modulus_mm3(float(relief.outline.radius_mm), float(bore.radius_mm))
    return yield_mpa(shaft) * modulus / _moment_mm(s, float(relief.z1_mm))


def _rim_inside_holes(coupling: Part) -> tuple[float, float]:
    """Return outer and inner radius of the ring of a coupling that none of its holes cuts."""
    (prism,) = coupling.prisms
    around = min(float(h.pitch_radius_mm) - float(h.radius_mm) for h in prism.holes if isinstance(h, Pattern))
    bore = max(float(h.radius_mm) for h in prism.holes if isinstance(h, Circle))
    return around, bore


def coupling(s: Structure) -> tuple[float, float, float]:
    """Return yield stress, bending stress per pull and shear stress per torque of the drive coupling.

    Only the ring inside all holes counts. It is bent most where it meets the shaft's flange.
    """
    part = _drive(s, Role.COUPLING)
    modulus = tube_modulus_mm3(*_rim_inside_holes(part))
    bent = _moment_mm(s, float(part.prisms[0].z0_mm)) / modulus
    return yield_mpa(part), bent, 1e3 / (2.0 * modulus)


def opening_n(s: Structure) -> float:
    """Return the chain's pull at which the drive's joint begins to gape at its edge: M / W reaches the pressure n F_V /
    A.

    The joint is the ring of the coupling's face. Its holes weaken area and modulus alike and are left out.
    """
    part, screw = _drive(s, Role.COUPLING), _drive(s, Role.SCREW)
    (prism,) = part.prisms
    assert isinstance(prism.outline, Circle)
    outer, (_, inner) = float(prism.outline.radius_mm), _rim_inside_holes(part)
    preload = screw_preload_n(screw, s.settings.materials)
    pressure = float(screw.count) * preload / (np.pi * (outer**2 - inner**2))
    return float(pressure * tube_modulus_mm3(outer, inner) / _moment_mm(s, float(prism.z0_mm)))


_CHAIN_SUPPORT_CURE = "release the knee's torque before its stop, or a lower knee_ratio"
CHAIN_SUPPORT_JOINTS = (
    ActuatorJoint(name="knee_drive_shaft", group="joints", side="knee",
        formula="W Rp0.2 / (F_chain a (b + c) / (a + b))",
        source="beam on two supports: Roark's Formulas for Stress and Strain, chapter 8; the torque passes by dowels",
        required=1.5, required_source="our own choice against yield: the shaft is hard and notched at its neck",
        loads=("peak_chain_tension_n",), capacity=shaft_n, parts=("drive_shaft",), cure=_CHAIN_SUPPORT_CURE),
    ActuatorJoint(name="knee_drive_coupling", group="joints", side="knee",
        formula="Rp0.2 / sqrt((M / W)^2 + 3 (T / 2 W)^2), of the ring inside its holes",
        source="bending and torsion of a tube, von Mises", required=1.2,
        required_source="our own choice against yield: half of the ring, with the holes, is not counted",
        loads=("peak_chain_tension_n", "peak_gear_torque_knee_n_m"), capacity=coupling, factor=bending_and_torsion,
        parts=("drive_coupling",), cure=_CHAIN_SUPPORT_CURE),
    ActuatorJoint(name="knee_drive_opening", group="joints", side="knee", formula="n F_V W / A / M",
        source="VDI 2230-1, R3: no gap at the edge of the joint, with the least preload", required=1.0,
        required_source="VDI 2230-1: the least preload is the one that is left after scatter and embedding",
        loads=("peak_chain_tension_n",), capacity=opening_n, parts=("drive_screw", "drive_coupling", "drive_sprocket"),
        cure=_CHAIN_SUPPORT_CURE),
)  # fmt: skip
