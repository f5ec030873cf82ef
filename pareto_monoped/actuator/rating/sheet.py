"""The full rating of one gear set: every stress, limit, factor and safety, as on a gear calculation sheet."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.rating.capacity import (
    FLANK_CURVES,
    ROOT_CURVES,
    bending_stress_mpa,
    contact_stress_mpa,
    elasticity_factor,
    highest_share,
    notch_sensitivity_factor,
    roughness_factor,
    static_notch_factor,
)
from pareto_monoped.actuator.rating.geometry import contact_ratio_factor, zone_factor
from pareto_monoped.actuator.rating.stage import (
    Member,
    Mesh,
    MeshLoad,
    Safeties,
    Stage,
    acting,
    finish_factor,
    safeties_of,
)
from pareto_monoped.geometry.gears import ExternalGear, InternalGear, half_angle
from pareto_monoped.geometry.shapes import Numbers


@dataclass(frozen=True, slots=True, kw_only=True)
class GearRating:
    """One gear in one mesh; stresses at the motor's peak torque with all load factors."""

    gear: str  #: ``sun``, ``planet`` or ``ring``
    steel: str  #: name of its grade
    treatment: str  #: of that grade
    quality: str  #: likewise
    hardness_hv: float  #: likewise
    tip_diameter_mm: float  #: d_a
    form_diameter_mm: float  #: d_Ff, where the involute begins, or ends in a ring
    root_diameter_mm: float  #: d_f
    tip_thickness_mm: float  #: s_a of the drawn teeth
    contact_number_mpa: float  #: sigma_H,lim
    bending_number_mpa: float  #: sigma_F,lim
    contact_stress_mpa: float  #: sigma_H
    contact_limit_mpa: float  #: sigma_HG
    flank_safety: float  #: S_H
    bending_stress_mpa: float  #: sigma_F
    bending_limit_mpa: float  #: sigma_FG
    root_safety: float  #: S_F
    overload_flank_safety: float  #: against static failure under the overload
    overload_root_safety: float  #: likewise
    single_contact_factor: float  #: Z_B or Z_D
    finish_factor: float  #: Z_L Z_v Z_R
    work_hardening_factor: float  #: Z_W
    notch_sensitivity_factor: float  #: Y_delta rel T
    roughness_factor: float  #: Y_R rel T
    mean_stress_factor: float  #: Y_M
    form_factor: float  #: Y_F
    stress_correction: float  #: Y_S
    rim_factor: float  #: Y_B
    #: flank_cycles, root_cycles: load cycles that do the damage of the whole duty, at the peak torque or at the highest
    #: level of the duty, if that is higher
    flank_cycles: float
    root_cycles: float
    flank_life_factor: float  #: Z_NT
    root_life_factor: float  #: Y_NT
    static_flank_life_factor: float  #: Z_NT of a few load cycles
    static_root_life_factor: float  #: Y_NT, likewise
    static_notch_factor: float  #: Y_delta rel T for static stress


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshRating:
    """Sun with planet, or planet with ring; factors named ``overload_`` are without K_A and K_V."""

    tangential_force_n: float  #: F_t at the motor's peak torque, if the planets shared it evenly
    pitch_speed_m_per_s: float  #: against the carrier, at the motor's no-load speed
    contact_ratio: float  #: epsilon_alpha
    gear_ratio: float  #: u
    pinion_diameter_mm: float  #: d1
    zone_factor: float  #: Z_H
    elasticity_factor: float  #: Z_E in sqrt(MPa)
    contact_ratio_factor: float  #: Z_epsilon
    mesh_stiffness_n_per_mm_um: float  #: c_gamma,alpha
    misalignment_um: float  #: F_beta,y
    pitch_deviation_um: float  #: f_pb less y_alpha
    application_factor: float  #: K_A
    sharing_factor: float  #: K_gamma
    dynamic_factor: float  #: K_V
    face_load_factor: float  #: K_Hbeta
    root_face_load_factor: float  #: K_Fbeta
    transverse_load_factor: float  #: K_Halpha
    root_transverse_load_factor: float  #: K_Falpha
    overload_face_load_factor: float
    overload_root_face_load_factor: float
    overload_transverse_load_factor: float
    overload_root_transverse_load_factor: float
    pinion: GearRating
    wheel: GearRating


@dataclass(frozen=True, slots=True, kw_only=True)
class Rating:
    """Rating of a gear set at its face width."""

    face_width_mm: float  #: b
    planet_gap_mm: float  #: between the tips of neighbouring planets
    highest_share: float  #: largest torque of the duty over the motor's peak torque, at least 1, to which limits refer
    overload_share: float  #: torque of the overload over the motor's peak torque
    sun_mesh: MeshRating
    ring_mesh: MeshRating

    @property
    def gears(self) -> Iterator[GearRating]:
        """Sun, planet against the sun, planet against the ring, ring."""
        for mesh in (self.sun_mesh, self.ring_mesh):
            yield mesh.pinion
            yield mesh.wheel

    @property
    def flank_safety(self) -> float:
        """The least S_H of all flanks."""
        return min(gear.flank_safety for gear in self.gears)

    @property
    def root_safety(self) -> float:
        """The least S_F of all roots."""
        return min(gear.root_safety for gear in self.gears)

    def of(self, gear: str) -> tuple[float, float]:
        """Return the least S_H and S_F of ``sun``, ``planet`` or ``ring``."""
        found = [one for one in self.gears if one.gear == gear]
        return min(one.flank_safety for one in found), min(one.root_safety for one in found)

    def as_dict(self) -> dict[str, Any]:
        """Return everything as plain values."""
        return asdict(self)


def rate(stage: Stage, width_mm: float) -> Rating:
    """Return the rating of a stage of plain numbers at a face width."""
    (found,) = ratings(stage, width_mm)
    return found


def ratings(stage: Stage, width_mm: Numbers) -> tuple[Rating, ...]:
    """Return the ratings of all gear sets of a stage, each at its face width."""
    gears = stage.gears
    # Between the tips of neighbouring planets.
    gap_mm = 2.0 * (gears.carrier_radius_mm * np.sin(np.pi / gears.planets) - gears.planet().tip_radius_mm)
    whole = {
        "face_width_mm": width_mm,
        "planet_gap_mm": gap_mm,
        "highest_share": highest_share(stage.settings.parts.duty),
        "overload_share": stage.overload_share,
    }
    loads = zip(stage.loads(width_mm), stage.overloads(width_mm), strict=True)
    meshes = [_mesh(stage, mesh, *each) for mesh, each in zip((stage.sun_mesh, stage.ring_mesh), loads, strict=True)]

    def one(place: int) -> Rating:
        def at(values: dict[str, Any]) -> dict[str, Any]:
            arrays = {
                name: value[place] for name, value in values.items() if isinstance(value, np.ndarray) and value.ndim
            }
            found = {**values, **arrays}
            return {name: value if isinstance(value, str) else float(value) for name, value in found.items()}

        sun, ring = (
            MeshRating(**at(mesh), pinion=GearRating(**at(pinion)), wheel=GearRating(**at(wheel)))
            for mesh, pinion, wheel in meshes
        )
        return Rating(**at(whole), sun_mesh=sun, ring_mesh=ring)

    return tuple(map(one, range(np.size(width_mm))))


def _mesh(stage: Stage, mesh: Mesh, at: MeshLoad, over: MeshLoad) -> tuple[dict[str, Any], ...]:
    """Return what a ``MeshRating`` has, and what those of its pinion and wheel have; arrays for many sets."""
    found = {
        "tangential_force_n": mesh.force_n,
        "pitch_speed_m_per_s": mesh.speed_m_per_s,
        "contact_ratio": mesh.contact_ratio,
        "gear_ratio": mesh.ratio,
        "pinion_diameter_mm": mesh.diameter_mm,
        "zone_factor": zone_factor(mesh.working_angle_rad),
        "elasticity_factor": elasticity_factor(stage.settings.materials.gear_steel),
        "contact_ratio_factor": contact_ratio_factor(mesh.contact_ratio),
        "mesh_stiffness_n_per_mm_um": at.stiffness,
        "misalignment_um": at.misalignment_um,
        "pitch_deviation_um": mesh.pitch_deviation_um,
        "application_factor": stage.settings.parts.rating.application_factor,
        "sharing_factor": mesh.sharing,
        "dynamic_factor": at.dynamic,
        "face_load_factor": at.face_flank,
        "root_face_load_factor": at.face_root,
        "transverse_load_factor": at.transverse_flank,
        "root_transverse_load_factor": at.transverse_root,
        "overload_face_load_factor": over.face_flank,
        "overload_root_face_load_factor": over.face_root,
        "overload_transverse_load_factor": over.transverse_flank,
        "overload_root_transverse_load_factor": over.transverse_root,
    }
    return found, *(_gear(stage, mesh, member, acting(at, over)) for member in (mesh.pinion, mesh.wheel))


def _gear(stage: Stage, mesh: Mesh, member: Member, loads: Safeties) -> dict[str, Any]:
    safeties = safeties_of(member.carries, loads)
    contact = contact_stress_mpa(
        loads.flank, mesh.diameter_mm, mesh.ratio, member.contact_factors, internal=mesh.internal
    )
    bending = bending_stress_mpa(loads.root, stage.gears.module_mm, member.form, member.rim_factor)
    drawn, data = getattr(stage.gears, member.gear)(), stage.settings.parts.rating
    return {
        "gear": member.gear,
        "steel": member.steel.name,
        "treatment": member.steel.treatment,
        "quality": member.steel.quality,
        "hardness_hv": member.steel.hardness_hv,
        "tip_diameter_mm": 2.0 * drawn.tip_radius_mm,
        "form_diameter_mm": 2.0 * drawn.form_radius_mm,
        "root_diameter_mm": 2.0 * drawn.root_radius_mm,
        "tip_thickness_mm": drawn.tip_thickness_mm,
        "contact_number_mpa": member.steel.flank_limit_mpa,
        "bending_number_mpa": member.steel.root_limit_mpa,
        "contact_stress_mpa": contact,
        "contact_limit_mpa": member.flank_limit_mpa,
        "flank_safety": safeties.flank,
        "bending_stress_mpa": bending,
        "bending_limit_mpa": member.root_limit_mpa,
        "root_safety": safeties.root,
        "overload_flank_safety": safeties.overload_flank,
        "overload_root_safety": safeties.overload_root,
        "single_contact_factor": member.single_contact,
        "finish_factor": finish_factor(stage.settings, internal=mesh.internal),
        "work_hardening_factor": member.work_hardening,
        "notch_sensitivity_factor": notch_sensitivity_factor(member.steel, member.form.notch),
        "roughness_factor": roughness_factor(member.steel, data.root_roughness_um),
        "mean_stress_factor": member.bending_factor,
        "form_factor": member.form.form_factor,
        "stress_correction": member.form.stress_correction,
        "rim_factor": member.rim_factor,
        "flank_cycles": member.flank_cycles,
        "root_cycles": member.root_cycles,
        "flank_life_factor": member.flank_life,
        "root_life_factor": member.root_life,
        "static_flank_life_factor": FLANK_CURVES[member.steel.treatment].static_factor,
        "static_root_life_factor": ROOT_CURVES[member.steel.treatment].static_factor,
        "static_notch_factor": static_notch_factor(member.steel, member.form),
    }


_POSITIONS, _POINTS = 600, 3000
"""Of a mate over two of its pitches, and of a root with its flank; both together miss 0.2 um at most."""
_TOUCH_MM = 5e-4
"""Less is a touch: a corner slides along its mate's flank anyway."""


def tip_depths_mm(gears: GearSet) -> dict[tuple[str, str], float]:
    """Return how deep the tips of a gear reach into the metal at the roots of its mate: (tip, root) -> depth.

    Of one set, as drawn, with the driving flanks in contact; along the normal to the root.
    """
    sun, planet, ring = gears.sun(), gears.planet(), gears.ring()
    pairs: dict[tuple[str, str], tuple[ExternalGear | InternalGear, ExternalGear | InternalGear]] = {
        ("sun", "planet"): (sun, planet),
        ("planet", "sun"): (planet, sun),
        ("ring", "planet"): (ring, planet),
        ("planet", "ring"): (planet, ring),
    }
    return {names: _tip_depth_mm(*pair, float(gears.carrier_radius_mm)) for names, pair in pairs.items()}


def _tip_depth_mm(tip: ExternalGear | InternalGear, root: ExternalGear | InternalGear, distance_mm: float) -> float:
    """Follow a corner of a tooth that rolls through a space, whose middle is the x axis of a mate that stands still."""
    inner = isinstance(tip, InternalGear) or isinstance(root, InternalGear)
    module, teeth, mates = float(root.module_mm), float(root.teeth), float(tip.teeth)
    half = float(half_angle(tip, tip.tip_radius_mm))
    if isinstance(tip, InternalGear):
        half = np.pi / mates - half
    turn = 4.0 * np.pi / teeth * np.linspace(-1.0, 1.0, _POSITIONS)
    taken = float(root.backlash_mm + tip.backlash_mm) / (module * mates)
    pointing = (
        half + taken + turn * (1.0 - teeth / mates) if inner else np.pi - half - taken + turn * (1.0 + teeth / mates)
    )
    centre = -distance_mm if isinstance(tip, InternalGear) else distance_mm
    corner = centre * np.exp(1j * turn) + float(tip.tip_radius_mm) * np.exp(1j * pointing)
    edge = _edge(root)
    order = np.argsort(np.abs(edge))
    beside = np.interp(np.abs(corner), np.abs(edge)[order], np.angle(edge)[order], left=0.0, right=0.0)
    low, high = sorted((float(root.tip_radius_mm), float(root.root_radius_mm)))
    within = (np.abs(corner) < high) if isinstance(root, ExternalGear) else (np.abs(corner) > low)
    inside = corner[within & (np.angle(corner) > beside) & (np.angle(corner) < np.pi / teeth)]
    depth_mm = float(max((np.abs(edge - point).min() for point in inside), default=0.0))
    return depth_mm if depth_mm > _TOUCH_MM else 0.0


def _edge(gear: ExternalGear | InternalGear) -> NDArray[np.complex128]:
    """Return points along one side of a space, root and flank, as complex numbers; its middle is the real axis."""
    form = float(gear.form_radius_mm)
    radii = np.linspace(form, float(gear.tip_radius_mm), _POINTS)
    if isinstance(gear, ExternalGear):
        curve = gear.root_curve_mm(_POINTS)
        return np.concatenate(
            [curve[:, 0] + 1j * curve[:, 1], radii * np.exp(1j * (np.pi / gear.teeth - half_angle(gear, radii)))]
        )
    centre = float(gear.root_radius_mm - gear.fillet_mm) * np.exp(1j * float(gear.fillet_angle_rad))
    first = np.angle(form * np.exp(1j * float(half_angle(gear, form))) - centre)
    arc = centre + float(gear.fillet_mm) * np.exp(1j * np.linspace(float(gear.fillet_angle_rad), first, _POINTS))
    return np.concatenate([arc, radii * np.exp(1j * half_angle(gear, radii))])
