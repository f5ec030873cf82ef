"""Flanks after ISO 6336-2: contact stress, and the load per face width that a flank may carry."""

import numpy as np

from pareto_monoped.actuator.rating.geometry import zone_factor
from pareto_monoped.geometry.shapes import Numbers
from pareto_monoped.materials import ElasticMaterial, GearGrade

SIZE_FACTOR = 1.0
"""Z_X: 1 for the module range used (ISO 6336-2, clause 15)."""


def elasticity_factor(material: ElasticMaterial) -> float:
    """Z_E in sqrt(MPa) of two gears of one material: 189.8 for steel (ISO 6336-2, clause 7)."""
    compliance = 2.0 * (1.0 - material.poisson_ratio**2) / material.youngs_modulus_mpa
    return float(np.sqrt(1.0 / (np.pi * compliance)))


def work_hardening_factor(steel: GearGrade, mate: GearGrade) -> float:
    """Z_W: a through-hardened flank gains by running against a hard and smooth one (ISO 6336-2, clause 14).

    The standard's Brinell hardness is taken as that of Vickers, which is some 5 percent more. Z_W is then about 0.01
    less than the standard's, on the safe side.
    """
    if steel.treatment != "through_hardened" or mate.treatment == "through_hardened":
        return 1.0
    return 1.2 - (min(max(steel.hardness_hv, 130.0), 470.0) - 130.0) / 1700.0


def contact_stress_mpa(
    load_n_per_mm: Numbers, diameter_mm: Numbers, ratio: Numbers, factors: Numbers, *, internal: bool
) -> Numbers:
    """sigma_H = factors sqrt(F_t K / (b d1) (u +- 1) / u) (ISO 6336-2, clause 5.2).

    Args:
        load_n_per_mm: tangential load per face width, with all load factors.
        diameter_mm: d1, reference diameter of the pinion.
        ratio: u, teeth of the wheel over those of the pinion.
        factors: Z_H Z_E Z_epsilon, and Z_B or Z_D.
        internal: whether the wheel is a ring.
    """
    return factors * np.sqrt(load_n_per_mm / diameter_mm * _curvature(ratio, internal=internal))


def flank_load_n_per_mm(
    permissible_mpa: Numbers, diameter_mm: Numbers, ratio: Numbers, factors: Numbers, *, internal: bool
) -> Numbers:
    """Load per face width at which ``contact_stress_mpa`` is ``permissible_mpa``."""
    return np.square(permissible_mpa / factors) * diameter_mm / _curvature(ratio, internal=internal)


def _curvature(ratio: Numbers, *, internal: bool) -> Numbers:
    return (ratio - 1.0) / ratio if internal else (ratio + 1.0) / ratio


def flank_factors(material: ElasticMaterial, contact_factor: Numbers, working_angle_rad: Numbers) -> Numbers:
    """Z_H Z_E Z_epsilon; Z_beta is 1 for spur gears."""
    return zone_factor(working_angle_rad) * elasticity_factor(material) * contact_factor


def flank_limit_mpa(steel: GearGrade, mate: GearGrade, life_factor: Numbers, finish_factor: float) -> Numbers:
    """sigma_HG = sigma_H,lim Z_NT Z_L Z_v Z_R Z_W Z_X, the stress at a safety of 1 (ISO 6336-2, clause 5.4).

    Args:
        steel: of the flank.
        mate: of the flank that it runs against.
        life_factor: Z_NT.
        finish_factor: Z_L Z_v Z_R; 1 for the static limit.
    """
    return steel.flank_limit_mpa * life_factor * finish_factor * work_hardening_factor(steel, mate) * SIZE_FACTOR
