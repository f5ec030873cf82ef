"""The knee's drive between its two supports: its shaft and coupling under the chain's pull and the gearbox's torque.

The chain pulls in the middle plane. The needle bearing in the hip coupling carries it in front, the actuator's main
bearing behind, both as pivots. The dowels take the torque from the output flange through coupling and shaft flange to
the sprocket, so that the stub of the shaft in the needles is bent, but not twisted.
"""

from functools import lru_cache
from typing import Any

import numpy as np

from pareto_monoped.actuator.service.output import main_bearing_depth_mm
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import Group, Role
from pareto_monoped.geometry.shapes import Circle, Pattern
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.drive_support import middle_mm
from pareto_monoped.leg.hip import hip_joints
from pareto_monoped.strength.bolted import least_preload_n
from pareto_monoped.strength.drive import fastening, layout_of, shank_and_thread_mm, yield_mpa
from pareto_monoped.strength.joint import ActuatorJoint, Structure


def tube_modulus_mm3(outer_mm: float, inner_mm: float) -> float:
    """Section modulus of a tube against bending; twice as much against torsion."""
    return float(0.25 * np.pi * (outer_mm**4 - inner_mm**4) / outer_mm)


def bending_and_torsion(limit_mpa: Any, bent_per_n: Any, twisted_per_n_m: Any, pull_n: Any, torque_n_m: Any) -> Any:
    """Yield stress over the von Mises stress; stresses per newton of pull and per newton metre of torque, MPa."""
    return limit_mpa / np.sqrt(np.square(bent_per_n * pull_n) + 3.0 * np.square(twisted_per_n_m * torque_n_m))


@lru_cache(maxsize=16)
def _parts(d: LegDimensions) -> tuple[Part, ...]:
    """What turns with the knee's output; all gearboxes of a map share it."""
    return tuple(part for part in hip_joints(d) if part.group is Group.KNEE_DRIVE)


def _drive(s: Structure, role: Role) -> Part:
    (found,) = (part for part in _parts(s.leg) if part.role is role)
    return found


def _moment_mm(s: Structure, height_mm: float) -> float:
    """Bending moment of the drive at a height z, per newton of the chain's pull, which acts at z = 0."""
    front, behind = -middle_mm(), s.leg.knee_mount_mm + float(main_bearing_depth_mm(layout_of(s)))
    if height_mm < 0.0:
        return behind / (front + behind) * (front + height_mm)
    return front / (front + behind) * (behind - height_mm)


def shaft_n(s: Structure) -> float:
    """Chain's pull at which the stub of the shaft yields where it leaves the sprocket."""
    shaft = _drive(s, Role.SHAFT)
    stub = min(shaft.prisms, key=lambda prism: float(prism.z0_mm))
    (bore,) = stub.holes
    assert isinstance(stub.outline, Circle)
    assert isinstance(bore, Circle)
    modulus = tube_modulus_mm3(float(stub.outline.radius_mm), float(bore.radius_mm))
    return yield_mpa(shaft) * modulus / _moment_mm(s, float(stub.z1_mm))


def _rim_inside_holes(coupling: Part) -> tuple[float, float]:
    """Outer and inner radius of the ring of a coupling that none of its screws, dowels and lightening holes cuts."""
    (prism,) = coupling.prisms
    around = min(float(h.pitch_radius_mm) - float(h.radius_mm) for h in prism.holes if isinstance(h, Pattern))
    bore = max(float(h.radius_mm) for h in prism.holes if isinstance(h, Circle))
    return around, bore


def coupling(s: Structure) -> tuple[float, float, float]:
    """Of the drive coupling: yield stress, bending stress per pull, shear stress per torque.

    Only the ring inside all holes counts. It is bent most where it meets the shaft's flange.
    """
    part = _drive(s, Role.COUPLING)
    modulus = tube_modulus_mm3(*_rim_inside_holes(part))
    bent = _moment_mm(s, float(part.prisms[0].z0_mm)) / modulus
    return yield_mpa(part), bent, 1e3 / (2.0 * modulus)


def opening_n(s: Structure) -> float:
    """Chain's pull at which the drive's joint begins to gape at its edge: M / W reaches the pressure n F_V / A.

    The joint is the ring of the coupling's face. Its holes weaken area and modulus alike and are left out.
    """
    part, screw = _drive(s, Role.COUPLING), _drive(s, Role.SCREW)
    (prism,) = part.prisms
    assert isinstance(prism.outline, Circle)
    outer, (_, inner) = float(prism.outline.radius_mm), _rim_inside_holes(part)
    materials = s.settings.materials
    preload = least_preload_n(
        fastening(screw),
        shank_and_thread_mm(screw)[0],
        steel_mpa=materials.steel.youngs_modulus_mpa,
        clamped_mpa=materials.aluminium.youngs_modulus_mpa,
    )
    pressure = float(screw.count) * preload / (np.pi * (outer**2 - inner**2))
    return float(pressure * tube_modulus_mm3(outer, inner) / _moment_mm(s, float(prism.z0_mm)))


_CURE = "release the knee's torque before its stop, or a lower knee_ratio"

JOINTS = (
    ActuatorJoint(
        name="knee_drive_shaft",
        group="joints",
        side="knee",
        formula="W Rp0.2 / (F_chain a (b + c) / (a + b))",
        source="beam on two supports: Roark's Formulas for Stress and Strain, chapter 8; the torque passes by dowels",
        required=1.5,
        required_source="our own choice against yield: the shaft is hard and notched at its neck",
        loads=("peak_chain_tension_n",),
        capacity=shaft_n,
        parts=("drive_shaft",),
        cure=_CURE,
    ),
    ActuatorJoint(
        name="knee_drive_coupling",
        group="joints",
        side="knee",
        formula="Rp0.2 / sqrt((M / W)^2 + 3 (T / 2 W)^2), of the ring inside its holes",
        source="bending and torsion of a tube, von Mises",
        required=1.2,
        required_source="our own choice against yield: half of the ring, with the holes, is not counted",
        loads=("peak_chain_tension_n", "peak_gear_torque_knee_n_m"),
        capacity=coupling,
        factor=bending_and_torsion,
        parts=("drive_coupling",),
        cure=_CURE,
    ),
    ActuatorJoint(
        name="knee_drive_opening",
        group="joints",
        side="knee",
        formula="n F_V W / A / M",
        source="VDI 2230-1, R3: no gap at the edge of the joint, with the least preload",
        required=1.0,
        required_source="VDI 2230-1: the least preload is the one that is left after scatter and embedding",
        loads=("peak_chain_tension_n",),
        capacity=opening_n,
        parts=("drive_screw", "drive_coupling", "drive_sprocket"),
        cure=_CURE,
    ),
)
