"""A planetary stage, or thousands of them at once, rated at any face width.

Everything that does not depend on the face width is computed once: what each mesh and each flank and root may carry per
face width. What they have to carry then takes a few dozen operations per width, which makes the search fast.
"""

from dataclasses import dataclass, fields, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.rating import load
from pareto_monoped.actuator.rating.capacity import highest_share
from pareto_monoped.actuator.rating.geometry import ToothForm
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.actuator.webs import WebSection
from pareto_monoped.geometry.shapes import Numbers
from pareto_monoped.materials import GearGrade


class Safeties(NamedTuple):
    """S_H and S_F, under the duty and under one overload."""

    flank: Numbers
    root: Numbers
    overload_flank: Numbers
    overload_root: Numbers


@dataclass(frozen=True, slots=True, kw_only=True)
class Member:
    """One gear in one mesh, with everything that its rating needs besides the load."""

    gear: str  #: ``sun``, ``planet`` or ``ring``
    steel: GearGrade  #: its grade
    contact_factors: Numbers  #: Z_H Z_E Z_epsilon, and Z_B or Z_D
    single_contact: Numbers  #: Z_B or Z_D alone
    form: ToothForm  #: of its tooth
    rim_factor: Numbers  #: Y_B
    flank_cycles: Numbers  #: equivalent load cycles at ``capacity.highest_share``
    root_cycles: Numbers  #: likewise
    flank_life: Numbers  #: Z_NT at these
    root_life: Numbers  #: Y_NT at these
    bending_factor: Numbers  #: Y_M
    work_hardening: float  #: Z_W
    flank_limit_mpa: Numbers  #: sigma_HG
    root_limit_mpa: Numbers  #: sigma_FG
    overload_flank_limit_mpa: float  #: sigma_HG against static failure
    overload_root_limit_mpa: Numbers  #: sigma_FG, likewise
    carries: Safeties  #: load per face width at a safety of 1, each with its own load factors


class MeshLoad(NamedTuple):
    """What a mesh carries at a face width: F_m / b, with load sharing, K_A and K_V in it, and the load factors.

    The last two are what they come from: c_gamma,alpha, and F_beta,y after running in.
    """

    mean_n_per_mm: Numbers
    dynamic: Numbers
    face_flank: Numbers
    face_root: Numbers
    transverse_flank: Numbers
    transverse_root: Numbers
    stiffness: Numbers
    misalignment_um: Numbers

    @property
    def flank_n_per_mm(self) -> Numbers:
        """With all factors, for the flanks."""
        return self.mean_n_per_mm * self.face_flank * self.transverse_flank

    @property
    def root_n_per_mm(self) -> Numbers:
        """With all factors, for the roots."""
        return self.mean_n_per_mm * self.face_root * self.transverse_root


@dataclass(frozen=True, slots=True, kw_only=True)
class Mesh:
    """Sun with planet, or planet with ring; the pinion is the smaller gear."""

    internal: bool  #: whether the wheel is the ring
    pinion: Member
    wheel: Member
    pinion_teeth: Numbers  #: z1
    wheel_teeth: Numbers  #: z2
    diameter_mm: Numbers  #: d1
    contact_ratio: Numbers  #: epsilon_alpha
    working_angle_rad: Numbers  #: alpha_wt
    force_n: Numbers  #: tangential force at the motor's peak torque, shared evenly by the planets
    sharing: Numbers  #: K_gamma
    speed_m_per_s: Numbers  #: of the pitch point against the carrier, at the motor's no-load speed
    pair_stiffness: Numbers  #: c'
    pitch_deviation_um: Numbers  #: f_pb less running in

    @property
    def ratio(self) -> Numbers:
        """Gear ratio u."""
        return self.wheel_teeth / self.pinion_teeth

    @property
    def least_carried(self) -> Safeties:
        """Load per face width at a safety of 1 of the weaker gear."""
        return Safeties(*map(np.minimum, self.pinion.carries, self.wheel.carries))


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """Both meshes of one gear set, or of arrays of them, with the limits of the face width."""

    gears: GearSet  #: the gear sets
    sun_mesh: Mesh
    ring_mesh: Mesh
    settings: ActuatorSettings  #: of stage 1
    webs: WebSection  #: cross-sections of the carrier's webs
    width_low_mm: Numbers  #: least face width allowed
    width_high_mm: Numbers  #: largest face width allowed
    carried: tuple[Safeties, Safeties]  #: ``Mesh.least_carried`` of both meshes

    def rows(self, chosen: NDArray[np.bool_] | NDArray[np.intp]) -> "Stage":
        """Return some of the gear sets, by a mask or indices; enough for ``safeties``.

        The gears in the meshes (``Mesh.pinion`` and ``wheel``) stay those of all sets: what they carry is in
        ``carried``.
        """
        shape = np.shape(self.width_low_mm)
        found: Stage = _rows(self, chosen, shape) if shape else self
        return found

    def loads(self, width_mm: Numbers) -> tuple[MeshLoad, MeshLoad]:
        """Return the loads of sun mesh and ring mesh under the duty, at the peak torque and a face width."""
        return self._loads(width_mm, self.settings.parts.rating.application_factor, moving=True)

    def overloads(self, width_mm: Numbers) -> tuple[MeshLoad, MeshLoad]:
        """Return the loads of both meshes under the overload: a single event, so that K_A and K_V do not apply."""
        return self.single_loads(width_mm, self.overload_share)

    @property
    def overload_share(self) -> float:
        """The overload over the peak torque; no less than the highest level of the duty."""
        parts = self.settings.parts
        return max(parts.rating.overload_factor, highest_share(parts.duty))

    def single_loads(self, width_mm: Numbers, share: Numbers) -> tuple[MeshLoad, MeshLoad]:
        """Return the loads of both meshes under ``share`` times the peak torque in gears that stand still, K_A 1."""
        return self._loads(width_mm, share, moving=False)

    def _loads(
        self, width_mm: Numbers, factor: Numbers, *, moving: bool | NDArray[np.bool_]
    ) -> tuple[MeshLoad, MeshLoad]:
        """Return the loads at ``factor`` times the peak torque. The planet's tilt on its pin misaligns both meshes."""
        data, materials = self.settings.parts.rating, self.settings.materials
        meshes = (self.sun_mesh, self.ring_mesh)
        applied = [factor * mesh.sharing * mesh.force_n / width_mm for mesh in meshes]
        grade = data.accuracy_class
        dynamic: list[Numbers] = [
            np.where(moving, load.dynamic_factor(w, mesh.speed_m_per_s, mesh.pinion_teeth, mesh.ratio, grade), 1.0)[()]
            for mesh, w in zip(meshes, applied, strict=True)
        ]
        mean = [w * k for w, k in zip(applied, dynamic, strict=True)]
        stiff = [
            load.mesh_stiffness(mesh.pair_stiffness, mesh.contact_ratio, w)
            for mesh, w in zip(meshes, applied, strict=True)
        ]
        gap = self.settings.planet_clearance_mm
        tilt = load.pin_tilt_um(
            0.5 * (mean[0] + mean[1]) * width_mm,
            width_mm,
            gap,
            self.settings.parts.carrier.pin_diameter_mm,
            self.webs.stiffness_n_per_mm(width_mm + 2.0 * gap, materials.aluminium),
            load.FACE_STIFFNESS_SHARE * (stiff[0] + stiff[1]),
            materials.steel,
        )
        twist = load.sun_twist_um(
            mean[0], width_mm, self.sun_mesh.diameter_mm, self.gears.planets, materials.gear_steel
        )
        return (
            self._load(self.sun_mesh, width_mm, dynamic[0], mean[0], stiff[0], tilt + twist),
            self._load(self.ring_mesh, width_mm, dynamic[1], mean[1], stiff[1], tilt),
        )

    def _load(
        self, mesh: Mesh, width_mm: Numbers, dynamic: Numbers, mean: Numbers, stiffness: Numbers, elastic_um: Numbers
    ) -> MeshLoad:
        """Return the factors of one mesh from its mean load per face width and its elastic misalignment."""
        grade, module = self.settings.parts.rating.accuracy_class, self.gears.module_mm
        made = np.hypot(
            load.helix_deviation_um(mesh.diameter_mm, width_mm, grade),
            load.helix_deviation_um(mesh.wheel_teeth * module, width_mm, grade),
        )
        worn = 0.5 * (load.face_running_in(mesh.pinion.steel) + load.face_running_in(mesh.wheel.steel))
        left_um = (1.0 - worn) * (elastic_um + made)
        crowning_um = self.settings.parts.rating.planet_crowning_um
        face = load.face_load_factor(left_um, load.FACE_STIFFNESS_SHARE * stiffness, mean, crowning_um)
        flank, root = load.transverse_load_factors(mean * face, stiffness, mesh.pitch_deviation_um, mesh.contact_ratio)
        root_face = load.root_face_load_factor(face, width_mm, module)
        return MeshLoad(mean, dynamic, face, root_face, flank, root, stiffness, left_um)

    def safeties(self, width_mm: Numbers) -> Safeties:
        """Return the least safety factors of all flanks and roots at a face width.

        ``loads`` and ``overloads`` in one pass: the search asks for them so often that the number of calls counts.
        """
        each = (2, *(1,) * np.ndim(width_mm))
        factor = np.reshape([self.settings.parts.rating.application_factor, self.overload_share], each)
        both = []
        loads = self._loads(width_mm, factor, moving=np.reshape([True, False], each))
        for carried, found in zip(self.carried, loads, strict=True):
            flank, root = np.asarray(found.flank_n_per_mm), np.asarray(found.root_n_per_mm)
            both.append(safeties_of(carried, Safeties(flank[0], root[0], flank[1], root[1])))
        return Safeties(*map(np.minimum, *both))

    def static_safeties(self, width_mm: Numbers, share: Numbers) -> tuple[Numbers, Numbers]:
        """Return the least static S_H and S_F under a single event of ``share`` times the peak torque."""
        both = [
            safeties_of(carried, acting(over, over))
            for carried, over in zip(self.carried, self.single_loads(width_mm, share), strict=True)
        ]
        least = Safeties(*map(np.minimum, *both))
        return least.overload_flank, least.overload_root


def _rows(record: Any, chosen: NDArray[np.bool_] | NDArray[np.intp], shape: tuple[int, ...]) -> Any:
    """Return a record of records with some rows of all arrays of a shape, without the members of meshes."""
    if isinstance(record, np.ndarray):
        return record[chosen] if record.shape == shape else record
    if isinstance(record, GearSet):
        return record.where(chosen)
    if isinstance(record, Safeties):
        return Safeties(*(_rows(value, chosen, shape) for value in record))
    if isinstance(record, tuple):
        return tuple(_rows(value, chosen, shape) for value in record)
    if isinstance(record, Stage | Mesh | WebSection):
        values = {each.name: _rows(getattr(record, each.name), chosen, shape) for each in fields(record)}
        return replace(record, **values)
    return record


def acting(duty: MeshLoad, over: MeshLoad) -> Safeties:
    """Return the loads that safety factors are against, in their order."""
    return Safeties(duty.flank_n_per_mm, duty.root_n_per_mm, over.flank_n_per_mm, over.root_n_per_mm)


def safeties_of(carries: Safeties, acting: Safeties) -> Safeties:
    """Return the safety factors: contact stress grows with the root of the load, bending stress with the load."""
    return Safeties(
        np.sqrt(carries.flank / acting.flank),
        carries.root / acting.root,
        np.sqrt(carries.overload_flank / acting.overload_flank),
        carries.overload_root / acting.overload_root,
    )


def finish_factor(settings: ActuatorSettings, *, internal: bool) -> float:
    """Return Z_L Z_v Z_R of a mesh, which the rougher of its gears decides."""
    data = settings.parts.rating
    return data.ring_finish_factor if internal else data.flank_finish_factor


def required(settings: ActuatorSettings) -> Safeties:
    """Return the least safety factors that the settings allow."""
    data = settings.parts.rating
    return Safeties(data.flank_safety, data.root_safety, data.overload_flank_safety, data.overload_root_safety)
