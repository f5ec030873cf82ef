"""Torsional stiffness and backlash of one actuator, both at its output, with the motor and the housing held."""

from dataclasses import dataclass

import numpy as np

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.layout import Layout
from pareto_monoped.actuator.needles import needle_rows
from pareto_monoped.actuator.rating.load import mesh_stiffness, pair_stiffness
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.gears import PRESSURE_ANGLE_RAD
from pareto_monoped.geometry.making import thickness_tolerance_mm
from pareto_monoped.geometry.parts import Prism
from pareto_monoped.geometry.roles import Group, Role
from pareto_monoped.geometry.shapes import Circle
from pareto_monoped.materials import ElasticMaterial

_PALMGREN, _NEEDLE_SHARE = 3.84e-5, 4.08
"""Of steel rollers on steel, in mm and N; highest load of a roller over the mean one, without clearance (as below)."""
_ARCMIN = 60.0 * 180.0 / np.pi


@dataclass(frozen=True, slots=True, kw_only=True)
class Stiffness:
    """How far the output turns per torque, by part, in rad / (N m)."""

    mesh: float  #: teeth of sun, planets and ring
    pins: float  #: bending of the planets' pins
    needles: float  #: contact of the planets' needles; 0 with bushes
    shaft: float  #: torsion of the sun's shaft up to the coupling
    carrier: float  #: torsion of the carrier up to the output face

    @property
    def stiffness_n_m_per_rad(self) -> float:
        """Of all in series."""
        return 1.0 / (self.mesh + self.pins + self.needles + self.shaft + self.carrier)


def stiffness(actuator: Actuator, at: Layout, settings: ActuatorSettings) -> Stiffness:
    """Return the torsional stiffness at the output at the peak torque, rotor and housing held.

    It is an upper bound: rims of gears, spline, the ring's bond, housing, bolted joints and rotor are taken as rigid.
    """
    return Stiffness(
        mesh=mesh_compliance(actuator),
        pins=pin_compliance(actuator.gears, at, settings),
        needles=needle_compliance(actuator, settings),
        shaft=_shaft_compliance(actuator, at, settings.materials.gear_steel) / actuator.ratio**2,
        carrier=_carrier_compliance(actuator, at, settings.materials.aluminium),
    )


def mesh_compliance(actuator: Actuator) -> float:
    """Return the compliance of the teeth in rad / (N m).

    A planet is a lever: its tooth force F on the sun and on the ring moves its centre by the mean of what both meshes
    give way. From the elastic energy of n planets with F = T / (2 n r cos alpha) in either mesh of stiffness k,
    compliance = (1 / k_sun + 1 / k_ring) / (4 n r^2 cos^2 alpha). The stiffness of a mesh is that of ISO 6336-1.
    """
    gears = actuator.gears
    radius_m, planets = 1e-3 * float(gears.carrier_radius_mm), float(gears.planets)
    tangential_n = actuator.peak_torque_n_m / (2.0 * planets * radius_m)
    load = tangential_n / actuator.face_width_mm
    outer = pair_stiffness(gears.sun(), gears.planet())
    inner = pair_stiffness(gears.planet(), gears.ring())
    sun = mesh_stiffness(outer, actuator.contact_ratio_sun, load)
    ring = mesh_stiffness(inner, actuator.contact_ratio_ring, load)
    softness = sum(1e-6 / (stiff * actuator.face_width_mm) for stiff in (sun, ring))  # m/N
    return float(softness / (4.0 * planets * (radius_m * np.cos(gears.working_angle_rad)) ** 2))


def pin_compliance(gears: GearSet, at: Layout, settings: ActuatorSettings) -> float:
    """Return the compliance of the pins in rad / (N m).

    A pin is a beam of length L between both carriers, which do not let its ends turn, under a uniform load F. Between
    carriers that stand still its mean deflection is F L^3 / (720 E I). Half the load goes to the second carrier and
    makes it sway by F / (2 K), where K = 12 E I / L^3 of the pin and the stiffness of one web hold it. Half of the sway
    is added.
    """
    length_mm = float(at.z_shoulder - at.z_secondary_front)
    second_moment_mm4 = np.pi * settings.parts.carrier.pin_diameter_mm**4 / 64.0
    bending = settings.materials.steel.youngs_modulus_mpa * second_moment_mm4
    web = float(at.webs.section.stiffness_n_per_mm(length_mm, settings.materials.aluminium))
    sway = 0.25 / (12.0 * bending / length_mm**3 + web)
    softness = 1e-3 * (length_mm**3 / (720.0 * bending) + sway)  # m/N
    return float(softness / (float(gears.planets) * (1e-3 * float(gears.carrier_radius_mm)) ** 2))


def needle_compliance(actuator: Actuator, settings: ActuatorSettings) -> float:
    """Return the compliance of the needles at the peak torque in rad / (N m), the secant of their curve; 0 with bushes.

    The most loaded of Z needles carries Q = 4.08 F / Z of a planet's force F where they have no clearance. It comes
    nearer to either raceway by 3.84e-5 Q^0.9 / l^0.8 in N and mm (Palmgren; Harris, Rolling Bearing Analysis).
    """
    if settings.planet_bearing == "bushes":
        return 0.0
    gears = actuator.gears
    rows = needle_rows(actuator.face_width_mm, settings)
    radius_m, planets = 1e-3 * float(gears.carrier_radius_mm), float(gears.planets)
    force_n = actuator.peak_torque_n_m / (planets * radius_m)
    length_mm = float(rows.length_mm) - 2.0 * settings.parts.needles.end_mm
    highest_n = _NEEDLE_SHARE * force_n / (rows.needles * float(rows.rows))
    moved_mm = 2.0 * _PALMGREN * highest_n**0.9 / length_mm**0.8
    angle_per_torque: float = 1e-3 * moved_mm / (radius_m * actuator.peak_torque_n_m)
    return angle_per_torque


def _shaft_compliance(actuator: Actuator, at: Layout, steel: ElasticMaterial) -> float:
    """Return the compliance of the sun's shaft from the coupling to the middle of the teeth, counted as plain shaft."""
    coupling = [prism for part in actuator.parts if part.role is Role.COUPLING for prism in part.prisms]
    front = max(float(prism.z1_mm) for prism in coupling)
    turning = [part for part in actuator.parts if part.group is Group.ROTOR and part.role is Role.GEAR]
    between = [
        (prism, prism.outline)
        for part in turning
        for prism in part.prisms
        if front - 1e-9 <= prism.z0_mm and prism.z1_mm <= at.z_gear_back + 1e-9
    ]
    radius = max(float(outline.radius_mm) for _, outline in between if isinstance(outline, Circle))
    teeth = 0.5 * float(at.z_gear_front - at.z_gear_back) / (0.5 * np.pi * radius**4)
    return 1e3 * (sum(_tube_softness(prism) for prism, _ in between) + teeth) / steel.shear_modulus_mpa


def _carrier_compliance(actuator: Actuator, at: Layout, aluminium: ElasticMaterial) -> float:
    """Return the compliance of the carrier from the clamped ends of the pins to the output face."""
    carriers = [part for part in actuator.parts if part.role is Role.CARRIER]
    front = max(carriers, key=lambda part: max(float(prism.z1_mm) for prism in part.prisms))
    softness = sum(_tube_softness(prism) for prism in front.prisms if prism.z0_mm >= at.z_shoulder - 1e-9)
    return 1e3 * softness / aluminium.shear_modulus_mpa


def _tube_softness(prism: Prism) -> float:
    """Return length over polar second moment of a turned slab, in 1/mm3, without its bolt and pin holes."""
    assert isinstance(prism.outline, Circle)
    bores = [float(hole.radius_mm) for hole in prism.holes if isinstance(hole, Circle)]
    inner = max(bores, default=0.0)
    polar = 0.5 * np.pi * (float(prism.outline.radius_mm) ** 4 - inner**4)
    return float((prism.z1_mm - prism.z0_mm) / polar)


def backlash_arcmin(gears: GearSet, thinning_mm: float) -> float:
    """Return the play of the output between both stops, motor held.

    Each tooth is thinned by ``thinning_mm`` on its pitch circle, so that either mesh has twice this as circumferential
    backlash there. Along the line of action this is less by cos(alpha), and moves the planet's centre, by the mean of
    both meshes, by 1 / cos(alpha_w) of it. Play of bushes and bearings comes on top.
    """
    play_mm = 2.0 * thinning_mm * (np.cos(PRESSURE_ANGLE_RAD) / np.cos(gears.working_angle_rad))
    return float(_ARCMIN * play_mm / gears.carrier_radius_mm)


def greatest_backlash_arcmin(gears: GearSet, thinning_mm: float, series: int) -> float:
    """Return the backlash with every tooth as thin as its tolerance in ``series`` (DIN 3967) allows."""
    sun, planet, ring = (
        float(thickness_tolerance_mm(gears.module_mm * teeth, series))
        for teeth in (gears.sun_teeth, gears.planet_teeth, gears.ring_teeth)
    )
    return backlash_arcmin(gears, thinning_mm + 0.25 * (sun + 2.0 * planet + ring))
