"""Load factors of ISO 6336-1 for one spur gear mesh: K_V, K_Hbeta, K_Fbeta, K_Halpha, K_Falpha.

Loads per face width are in N/mm, deviations in micrometres, stiffnesses in N/(mm um).
"""

import numpy as np

from pareto_monoped.actuator.rating.geometry import TOOTH_DEPTH, contact_ratio_factor, root_contact_ratio_factor
from pareto_monoped.geometry.gears import DEDENDUM, ExternalGear, InternalGear
from pareto_monoped.geometry.shapes import Floats, Numbers
from pareto_monoped.materials import ElasticMaterial, GearGrade

_K1 = {3: 2.1, 4: 3.9, 5: 7.5, 6: 14.9, 7: 26.8, 8: 39.1, 9: 52.8, 10: 76.6}
"""K_1 of method C by accuracy class, spur gears (ISO 6336-1, table 7)."""
_K2 = 0.0193
"""K_2 of method C, spur gears (the same table)."""
_PACE_MAX = 2.9
"""v z1 / 100 u / sqrt(1 + u^2) at which the product with K_3 stops growing; faster gears keep the K_3 from there.

Method C is not meant for more; what is done beyond is our own choice and errs to the safe side.
"""
LIGHT_LOAD_N_PER_MM = 100.0
"""Load per face width below which method C takes this value, and teeth count as softer (ISO 6336-1, clauses 6.5, 9)."""
_ACTUAL_STIFFNESS = 0.8
"""C_M: measured over theoretical stiffness of a tooth pair (ISO 6336-1, clause 9.3.2.2)."""
_RACK_STIFFNESS = 1.0 + 0.5 * (1.2 - DEDENDUM)
"""C_B for this dedendum and 20 degrees (ISO 6336-1, clause 9.3.2.4); C_R is 1, as for solid discs."""
FACE_STIFFNESS_SHARE = 0.85
"""c_gamma,beta over c_gamma,alpha (ISO 6336-1, clause 9.3.1)."""
_REACH_STEPS = 12
"""Of Newton's method for the face in contact, an even number: to rounding from a twentieth of the face on."""
_TORSION_TO_MISALIGNMENT = 1.33
"""Misalignment that stands for an elastic deflection f_sh, without modified helix (ISO 6336-1, clause 7.5.2)."""


def dynamic_factor(
    load_n_per_mm: Numbers, speed_m_per_s: Numbers, pinion_teeth: Numbers, ratio: Numbers, accuracy_class: int
) -> Numbers:
    """Return K_V by method C (ISO 6336-1, clause 6.5.3) for a load K_A F_t / b."""
    pace = 0.01 * speed_m_per_s * pinion_teeth * ratio / np.sqrt(1.0 + np.square(ratio))
    slope = np.where(pace <= 0.2, 2.0, 2.071 - 0.357 * np.minimum(pace, _PACE_MAX))
    return 1.0 + (_K1[accuracy_class] / np.maximum(load_n_per_mm, LIGHT_LOAD_N_PER_MM) + _K2) * pace * slope


def pair_stiffness(pinion: ExternalGear, wheel: ExternalGear | InternalGear) -> Numbers:
    """Return c' of one tooth pair by method B (ISO 6336-1, clause 9.3.2); a ring counts as a rack without shift."""
    compliance = 0.04723 + 0.15551 / pinion.teeth
    x = pinion.shift
    compliance = compliance - 0.00635 * x - 0.11654 * x / pinion.teeth + 0.00529 * np.square(x)
    if isinstance(wheel, ExternalGear):
        x = wheel.shift
        compliance = compliance + 0.25791 / wheel.teeth
        compliance = compliance - 0.00193 * x - 0.24188 * x / wheel.teeth + 0.00182 * np.square(x)
    return _ACTUAL_STIFFNESS * _RACK_STIFFNESS / compliance


def mesh_stiffness(pair: Numbers, contact_ratio: Numbers, load_n_per_mm: Numbers) -> Numbers:
    """Return c_gamma,alpha of a mesh (ISO 6336-1, clause 9.3), softer under a light load K_A F_t / b."""
    light = np.power(np.minimum(load_n_per_mm / LIGHT_LOAD_N_PER_MM, 1.0), 0.25)
    return pair * light * (0.75 * contact_ratio + 0.25)


def pitch_deviation_um(diameter_mm: Numbers, module_mm: Numbers, accuracy_class: int) -> Numbers:
    """Return the tolerance f_pT of a single pitch (ISO 1328-1:2013, clause 5)."""
    deviation_um: Numbers = (0.001 * diameter_mm + 0.4 * module_mm + 5.0) * np.sqrt(2.0) ** (accuracy_class - 5)
    return deviation_um


def helix_deviation_um(diameter_mm: Numbers, width_mm: Numbers, accuracy_class: int) -> Numbers:
    """Return the tolerance f_HbetaT of the helix slope (ISO 1328-1:2013, clause 5)."""
    deviation_um: Numbers = (0.05 * np.sqrt(diameter_mm) + 0.35 * np.sqrt(width_mm) + 4.0) * np.sqrt(2.0) ** (
        accuracy_class - 5
    )
    return deviation_um


def runout_um(diameter_mm: Numbers, module_mm: Numbers, accuracy_class: int) -> Numbers:
    """Return the tolerance F_rT of the radial runout, 0.9 F_pT (ISO 1328-1:2013, clause 5 and annex E)."""
    pitch = 0.002 * diameter_mm + 0.55 * np.sqrt(diameter_mm) + 0.7 * module_mm + 12.0
    deviation_um: Numbers = 0.9 * pitch * np.sqrt(2.0) ** (accuracy_class - 5)
    return deviation_um


def face_running_in(steel: GearGrade) -> float:
    """Return y_beta over F_beta,x: how much of a misalignment wears away (ISO 6336-1, clause 7.4.2)."""
    return 0.15 if steel.treatment != "through_hardened" else min(320.0 / steel.flank_limit_mpa, 1.0)


def pitch_running_in(steel: GearGrade) -> float:
    """Return y_alpha over f_pb (ISO 6336-1, clause 8.3.5)."""
    return 0.075 if steel.treatment != "through_hardened" else min(160.0 / steel.flank_limit_mpa, 1.0)


def sun_twist_um(
    load_n_per_mm: Numbers, width_mm: Numbers, diameter_mm: Numbers, planets: Numbers, material: ElasticMaterial
) -> Numbers:
    """Return the misalignment by the twist of a sun whose torque enters at one end.

    n_p meshes load a solid cylinder evenly along its face: the pitch circle at the far end lags by
    4 n_p F_m b / (pi G d^2). With one mesh this is the torsional part, 0.0161 um, of the 0.023 um in the f_sh of
    ISO 6336-1, clause 7.5.3; the bending part vanishes, because the planets' forces balance.
    """
    lag_mm = 4.0 * planets * load_n_per_mm / (np.pi * material.shear_modulus_mpa) * np.square(width_mm / diameter_mm)
    return 1e3 * _TORSION_TO_MISALIGNMENT * lag_mm


def pin_tilt_um(
    force_n: Numbers,
    width_mm: Numbers,
    gap_mm: float,
    pin_diameter_mm: float,
    web_n_per_mm: Numbers,
    face_stiffness: Numbers,
    material: ElasticMaterial,
) -> Numbers:
    """Return the misalignment by the tilt of a planet on its pin.

    A pin is a beam of length L between both carriers, which do not let its ends turn. Twice the mesh force F in its
    middle makes the second carrier sway by F / K, where K = 12 E I / L^3 of the pin and the stiffness of one web hold
    it. The middle of the pin turns by 1.5 / L of the sway. Both meshes hold against that with c b^3 / 12 each. The pin
    gives way to their moment by L / (16 E I) of itself and by (1.5 / L)^2 / K with the carrier.

    ``force_n``: F_m of one mesh; ``web_n_per_mm``: stiffness of one web per pin, see ``webs``; 0 without webs;
    ``face_stiffness``: c_gamma,beta of both meshes together.
    """
    length = width_mm + 2.0 * gap_mm
    bending = material.youngs_modulus_mpa * np.pi * pin_diameter_mm**4 / 64.0
    holds = 12.0 * bending / length**3 + web_n_per_mm
    lever = 1.5 / length
    meshes = 1e3 * face_stiffness * width_mm**3 / 12.0
    slope = force_n * lever / holds
    return 1e3 * width_mm * slope / (1.0 + meshes * (length / (16.0 * bending) + lever**2 / holds))


def face_load_factor(
    misalignment_um: Numbers, face_stiffness: Numbers, load_n_per_mm: Numbers, crowning_um: float = 0.0
) -> Numbers:
    """Return K_Hbeta (ISO 6336-1, clause 7.3.2) from F_beta,y after running in and F_m / b with K_A, K_V, K_gamma.

    The clause's factor is the greatest of the loads that springs side by side carry along a face that is askew. With
    crowned teeth, whose ends stand back by ``crowning_um``, the same springs have the gap F xi - 4 C xi^2 at xi = -1/2
    to 1/2 of the face. They touch within s of where the gap is least, F / (8 C), and carry
    4 C c (s^2 - (xi - F / (8 C))^2) each; s follows from the mean load, by Newton's method.
    """
    if crowning_um <= 0.0:
        excess = 0.5 * misalignment_um * face_stiffness / load_n_per_mm
        return np.where(excess <= 1.0, 1.0 + excess, 2.0 * np.sqrt(np.maximum(excess, 1.0)))[()]
    middle, mean = np.broadcast_arrays(
        misalignment_um / (8.0 * crowning_um), load_n_per_mm / face_stiffness / (4.0 * crowning_um)
    )
    above, below = 0.5 - middle, 0.5 + middle
    above_cubed, below_cubed = above**3, below**3
    squared = np.array(mean + (above_cubed + below_cubed) / 3.0)
    partly = squared < np.square(below)
    known = (np.asarray(values)[partly] for values in (mean, above, below, above_cubed, below_cubed))
    squared[partly] = np.square(_reach(*known))
    return np.asarray((squared - np.square(np.maximum(-above, 0.0))) / mean)[()]


def _reach(mean: Floats, above: Floats, below: Floats, above_cubed: Floats, below_cubed: Floats) -> Floats:
    """Return s of ``face_load_factor`` where only a part of the face is in contact.

    Powers take most of the time, so each is worked out once. A mesh is done when two steps lead back to the value
    before them: the number of steps is even, so all of them lead there, too.
    """
    found, left = np.empty(len(mean)), np.arange(len(mean))
    reach, cubed = below, below_cubed
    for _ in range(_REACH_STEPS // 2):
        before = reach
        for _ in range(2):
            both = np.minimum(reach, above) + np.minimum(reach, below)
            cubes = np.minimum(cubed, above_cubed) + np.minimum(cubed, below_cubed)
            carried = np.square(reach) * both - cubes / 3.0
            reach = np.maximum(reach - (carried - mean) / (2.0 * reach * both), 1e-6)
            cubed = reach**3
        found[left] = reach
        moving = reach != before
        if 2 * moving.sum() < len(left):
            left = left[moving]
            mean, above, below, above_cubed, below_cubed, reach, cubed = (
                values[moving] for values in (mean, above, below, above_cubed, below_cubed, reach, cubed)
            )
        if not len(left):
            break
    return found


def root_face_load_factor(face_factor: Numbers, width_mm: Numbers, module_mm: Numbers) -> Numbers:
    """Return K_Fbeta = K_Hbeta^N_F, h the tooth depth (ISO 6336-1, clause 7.6)."""
    slender = np.maximum(width_mm / (TOOTH_DEPTH * module_mm), 1e-9)
    return np.power(face_factor, 1.0 / (1.0 + 1.0 / slender + 1.0 / np.square(slender)))


def transverse_load_factors(
    load_n_per_mm: Numbers, stiffness: Numbers, deviation_um: Numbers, contact_ratio: Numbers
) -> tuple[Numbers, Numbers]:
    """Return K_Halpha and K_Falpha by method B, within their bounds (ISO 6336-1:2006, equations 73 to 76 in clause
    8.3).

    Where two or three pairs share the load instead of one or two, at contact ratios above 2, pitch deviations weigh
    sqrt(2 (epsilon - 1) / epsilon) instead of epsilon / 2 times as much; both are 1 at 2. The equations are those that
    three open implementations of the standard have alike; its text was not at hand.

    ``load_n_per_mm``: F_tH / b, with K_A, K_V, K_Hbeta and the load sharing; ``deviation_um``: f_pb - y_alpha.
    """
    uneven = 0.4 * stiffness * deviation_um / load_n_per_mm
    several = 0.9 + uneven * np.sqrt(2.0 * np.maximum(contact_ratio - 1.0, 0.0) / contact_ratio)
    free = np.where(contact_ratio <= 2.0, 0.5 * contact_ratio * (0.9 + uneven), several)[()]
    flank = np.clip(free, 1.0, 1.0 / np.square(contact_ratio_factor(contact_ratio)))
    return flank, np.clip(free, 1.0, 1.0 / root_contact_ratio_factor(contact_ratio))
