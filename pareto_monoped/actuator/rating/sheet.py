"""The full rating of one gear set: every stress, limit, factor and safety, as on a gear calculation sheet."""

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

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
from pareto_monoped.actuator.rating.stage import Member, Mesh, MeshLoad, Safeties, Stage, acting, safeties_of
from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from pareto_monoped.geometry.shapes import Numbers


@dataclass(frozen=True, slots=True, kw_only=True)
class GearRating:
    """One gear in one mesh; stresses at the motor's peak torque with all load factors."""

    gear: str  #: ``sun``, ``planet`` or ``ring``
    steel: str  #: name of its grade
    #: treatment, quality, hardness_hv: of that grade
    treatment: str
    quality: str
    hardness_hv: float
    #: tip_diameter_mm, root_diameter_mm: d_a, d_f
    tip_diameter_mm: float
    root_diameter_mm: float
    tip_thickness_mm: float  #: s_a of the drawn teeth
    #: contact_number_mpa, bending_number_mpa: sigma_H,lim and sigma_F,lim
    contact_number_mpa: float
    bending_number_mpa: float
    #: contact_stress_mpa, contact_limit_mpa, flank_safety: sigma_H, sigma_HG, S_H
    contact_stress_mpa: float
    contact_limit_mpa: float
    flank_safety: float
    #: bending_stress_mpa, bending_limit_mpa, root_safety: sigma_F, sigma_FG, S_F
    bending_stress_mpa: float
    bending_limit_mpa: float
    root_safety: float
    #: overload_flank_safety, overload_root_safety: against static failure under the overload
    overload_flank_safety: float
    overload_root_safety: float
    single_contact_factor: float  #: Z_B or Z_D
    #: finish_factor, work_hardening_factor: Z_L Z_v Z_R and Z_W
    finish_factor: float
    work_hardening_factor: float
    #: notch_sensitivity_factor, roughness_factor, mean_stress_factor: Y_delta rel T, Y_R rel T, Y_M
    notch_sensitivity_factor: float
    roughness_factor: float
    mean_stress_factor: float
    #: form_factor, stress_correction, rim_factor: Y_F, Y_S, Y_B
    form_factor: float
    stress_correction: float
    rim_factor: float
    #: flank_cycles, root_cycles: load cycles that do the damage of the whole duty, at the peak torque or at the highest
    #: level of the duty, if that is higher
    flank_cycles: float
    root_cycles: float
    #: flank_life_factor, root_life_factor: Z_NT, Y_NT
    flank_life_factor: float
    root_life_factor: float
    #: static_flank_life_factor, static_root_life_factor: Z_NT and Y_NT of a few load cycles
    static_flank_life_factor: float
    static_root_life_factor: float
    static_notch_factor: float  #: Y_delta rel T for static stress


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshRating:
    """Sun with planet, or planet with ring.

    Attributes:
        overload_face_load_factor, ...: the same four under the overload, without K_A and K_V.
    """

    tangential_force_n: float  #: F_t at the motor's peak torque, if the planets shared it evenly
    pitch_speed_m_per_s: float  #: against the carrier, at the motor's no-load speed
    contact_ratio: float  #: epsilon_alpha
    #: gear_ratio, pinion_diameter_mm: u, d1
    gear_ratio: float
    pinion_diameter_mm: float
    #: zone_factor, elasticity_factor, contact_ratio_factor: Z_H, Z_E in sqrt(MPa), Z_epsilon
    zone_factor: float
    elasticity_factor: float
    contact_ratio_factor: float
    #: mesh_stiffness_n_per_mm_um, misalignment_um, pitch_deviation_um: c_gamma,alpha; F_beta,y; f_pb less y_alpha
    mesh_stiffness_n_per_mm_um: float
    misalignment_um: float
    pitch_deviation_um: float
    #: application_factor, sharing_factor, dynamic_factor: K_A, K_gamma, K_V
    application_factor: float
    sharing_factor: float
    dynamic_factor: float
    #: face_load_factor, root_face_load_factor: K_Hbeta, K_Fbeta
    face_load_factor: float
    root_face_load_factor: float
    #: transverse_load_factor, root_transverse_load_factor: K_Halpha, K_Falpha
    transverse_load_factor: float
    root_transverse_load_factor: float
    overload_face_load_factor: float
    overload_root_face_load_factor: float
    overload_transverse_load_factor: float
    overload_root_transverse_load_factor: float
    #: pinion, wheel: the gears
    pinion: GearRating
    wheel: GearRating


@dataclass(frozen=True, slots=True, kw_only=True)
class Rating:
    """Rating of a gear set at its face width."""

    face_width_mm: float  #: b
    planet_gap_mm: float  #: between the tips of neighbouring planets
    highest_share: float  #: largest torque of the duty over the motor's peak torque, at least 1, to which limits refer
    overload_share: float  #: torque of the overload over the motor's peak torque
    #: sun_mesh, ring_mesh: the meshes
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
        """The least S_H and S_F of ``sun``, ``planet`` or ``ring``."""
        found = [one for one in self.gears if one.gear == gear]
        return min(one.flank_safety for one in found), min(one.root_safety for one in found)

    def as_dict(self) -> dict[str, Any]:
        """Everything as plain values."""
        return asdict(self)


def rate(stage: Stage, width_mm: float) -> Rating:
    """The rating of a stage of plain numbers at a face width."""
    (found,) = ratings(stage, width_mm)
    return found


def ratings(stage: Stage, width_mm: Numbers) -> tuple[Rating, ...]:
    """The ratings of all gear sets of a stage, each at its face width."""
    sun, ring = zip(stage.loads(width_mm), stage.overloads(width_mm), strict=True)

    def one(place: int) -> Rating:
        def number(value: Numbers) -> float:
            return float(value[place] if isinstance(value, np.ndarray) and value.ndim else value)

        return Rating(
            face_width_mm=number(width_mm),
            planet_gap_mm=number(_planet_gap_mm(stage.gears)),
            highest_share=highest_share(stage.settings.parts.duty),
            overload_share=stage.overload_share,
            sun_mesh=_mesh(stage, stage.sun_mesh, *sun, number),
            ring_mesh=_mesh(stage, stage.ring_mesh, *ring, number),
        )

    return tuple(map(one, range(np.size(width_mm))))


def _planet_gap_mm(gears: GearSet) -> Numbers:
    """Between the tips of neighbouring planets."""
    return 2.0 * (gears.carrier_radius_mm * np.sin(np.pi / gears.planets) - gears.planet().tip_radius_mm)


def _drawn(stage: Stage, gear: str) -> ExternalGear | InternalGear:
    """A gear with the backlash that it is drawn with."""
    thinning = stage.settings.tooth_thinning_mm(stage.gears.module_mm)
    if gear == "ring":
        return stage.gears.ring(thinning)
    return stage.gears.sun(thinning) if gear == "sun" else stage.gears.planet(thinning)


def _mesh(stage: Stage, mesh: Mesh, at: MeshLoad, over: MeshLoad, number: Callable[[Numbers], float]) -> MeshRating:
    loads = acting(at, over)
    return MeshRating(
        tangential_force_n=number(mesh.force_n),
        pitch_speed_m_per_s=number(mesh.speed_m_per_s),
        contact_ratio=number(mesh.contact_ratio),
        gear_ratio=number(mesh.ratio),
        pinion_diameter_mm=number(mesh.diameter_mm),
        zone_factor=number(zone_factor(mesh.working_angle_rad)),
        elasticity_factor=elasticity_factor(stage.settings.materials.gear_steel),
        contact_ratio_factor=number(contact_ratio_factor(mesh.contact_ratio)),
        mesh_stiffness_n_per_mm_um=number(at.stiffness),
        misalignment_um=number(at.misalignment_um),
        pitch_deviation_um=number(mesh.pitch_deviation_um),
        application_factor=stage.settings.parts.rating.application_factor,
        sharing_factor=number(mesh.sharing),
        dynamic_factor=number(at.dynamic),
        face_load_factor=number(at.face_flank),
        root_face_load_factor=number(at.face_root),
        transverse_load_factor=number(at.transverse_flank),
        root_transverse_load_factor=number(at.transverse_root),
        overload_face_load_factor=number(over.face_flank),
        overload_root_face_load_factor=number(over.face_root),
        overload_transverse_load_factor=number(over.transverse_flank),
        overload_root_transverse_load_factor=number(over.transverse_root),
        pinion=_gear(stage, mesh, mesh.pinion, loads, number),
        wheel=_gear(stage, mesh, mesh.wheel, loads, number),
    )


def _gear(stage: Stage, mesh: Mesh, member: Member, loads: Safeties, number: Callable[[Numbers], float]) -> GearRating:
    safeties = safeties_of(member.carries, loads)
    contact = contact_stress_mpa(
        loads.flank, mesh.diameter_mm, mesh.ratio, member.contact_factors, internal=mesh.internal
    )
    bending = bending_stress_mpa(loads.root, stage.gears.module_mm, member.form, member.rim_factor)
    drawn, data = _drawn(stage, member.gear), stage.settings.parts.rating
    return GearRating(
        gear=member.gear,
        steel=member.steel.name,
        treatment=member.steel.treatment,
        quality=member.steel.quality,
        hardness_hv=member.steel.hardness_hv,
        tip_diameter_mm=number(2.0 * drawn.tip_radius_mm),
        root_diameter_mm=number(2.0 * drawn.root_radius_mm),
        tip_thickness_mm=number(drawn.tip_thickness_mm),
        contact_number_mpa=member.steel.flank_limit_mpa,
        bending_number_mpa=member.steel.root_limit_mpa,
        contact_stress_mpa=number(contact),
        contact_limit_mpa=number(member.flank_limit_mpa),
        flank_safety=number(safeties.flank),
        bending_stress_mpa=number(bending),
        bending_limit_mpa=number(member.root_limit_mpa),
        root_safety=number(safeties.root),
        overload_flank_safety=number(safeties.overload_flank),
        overload_root_safety=number(safeties.overload_root),
        single_contact_factor=number(member.single_contact),
        finish_factor=data.flank_finish_factor,
        work_hardening_factor=member.work_hardening,
        notch_sensitivity_factor=number(notch_sensitivity_factor(member.steel, member.form.notch)),
        roughness_factor=roughness_factor(member.steel, data.root_roughness_um),
        mean_stress_factor=number(member.bending_factor),
        form_factor=number(member.form.form_factor),
        stress_correction=number(member.form.stress_correction),
        rim_factor=number(member.rim_factor),
        flank_cycles=number(member.flank_cycles),
        root_cycles=number(member.root_cycles),
        flank_life_factor=number(member.flank_life),
        root_life_factor=number(member.root_life),
        static_flank_life_factor=FLANK_CURVES[member.steel.treatment].static_factor,
        static_root_life_factor=ROOT_CURVES[member.steel.treatment].static_factor,
        static_notch_factor=number(static_notch_factor(member.steel, member.form)),
    )
