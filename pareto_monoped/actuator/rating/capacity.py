"""What flanks and roots may carry: stresses and limits (ISO 6336-2, -3), S-N curves, and load cycles of the duty
(-6).
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pareto_monoped.actuator.assumptions import DutyData
from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.rating.geometry import ToothForm, zone_factor
from pareto_monoped.geometry.shapes import Numbers
from pareto_monoped.materials import ElasticMaterial, GearGrade, Treatment

SIZE_FACTOR = 1.0
"""Z_X: 1 for the module range used (ISO 6336-2, clause 15)."""


def elasticity_factor(material: ElasticMaterial) -> float:
    """Return Z_E in sqrt(MPa) of two gears of one material: 189.8 for steel (ISO 6336-2, clause 7)."""
    compliance = 2.0 * (1.0 - material.poisson_ratio**2) / material.youngs_modulus_mpa
    return float(np.sqrt(1.0 / (np.pi * compliance)))


def work_hardening_factor(steel: GearGrade, mate: GearGrade) -> float:
    """Return Z_W: a through-hardened flank gains by running against a hard and smooth one (ISO 6336-2, clause 14).

    The standard's Brinell hardness is taken as that of Vickers, which is some 5 percent more. Z_W is then about 0.01
    less than the standard's, on the safe side.
    """
    if steel.treatment != "through_hardened" or mate.treatment == "through_hardened":
        return 1.0
    return 1.2 - (min(max(steel.hardness_hv, 130.0), 470.0) - 130.0) / 1700.0


def contact_stress_mpa(
    load_n_per_mm: Numbers, diameter_mm: Numbers, ratio: Numbers, factors: Numbers, *, internal: bool
) -> Numbers:
    """Return sigma_H = factors sqrt(F_t K / (b d1) (u +- 1) / u) (ISO 6336-2, clause 5.2).

    ``load_n_per_mm``: tangential load per face width, with all load factors; ``diameter_mm``: d1, reference diameter of
    the pinion; ``ratio``: u, teeth of the wheel over those of the pinion; ``factors``: Z_H Z_E Z_epsilon, and Z_B or
    Z_D.
    """
    return factors * np.sqrt(load_n_per_mm / diameter_mm * _curvature(ratio, internal=internal))


def flank_load_n_per_mm(
    permissible_mpa: Numbers, diameter_mm: Numbers, ratio: Numbers, factors: Numbers, *, internal: bool
) -> Numbers:
    """Return the load per face width at which ``contact_stress_mpa`` is ``permissible_mpa``."""
    return np.square(permissible_mpa / factors) * diameter_mm / _curvature(ratio, internal=internal)


def _curvature(ratio: Numbers, *, internal: bool) -> Numbers:
    return (ratio - 1.0) / ratio if internal else (ratio + 1.0) / ratio


def flank_factors(material: ElasticMaterial, contact_factor: Numbers, working_angle_rad: Numbers) -> Numbers:
    """Return Z_H Z_E Z_epsilon; Z_beta is 1 for spur gears."""
    return zone_factor(working_angle_rad) * elasticity_factor(material) * contact_factor


def flank_limit_mpa(steel: GearGrade, mate: GearGrade, life_factor: Numbers, finish_factor: float) -> Numbers:
    """Return sigma_HG = sigma_H,lim Z_NT Z_L Z_v Z_R Z_W Z_X at a safety of 1 (ISO 6336-2, clause 5.4)."""
    return steel.flank_limit_mpa * life_factor * finish_factor * work_hardening_factor(steel, mate) * SIZE_FACTOR


SPECIMEN_FACTOR = 2.0
"""Y_ST, stress correction of the standard test gear (ISO 6336-3, clause 5.3)."""
ROOT_SIZE_FACTOR = 1.0
"""Y_X: 1 up to a module of 5 mm (ISO 6336-3, clause 14)."""
_COMPRESSION = 1.2
"""Compression of the root behind a loaded tooth over the tension in front of it (ISO 6336-3, annex B)."""
_SENSITIVITY = 0.3
"""M of steels that are nitrided or not surface-hardened (ISO 6336-3, annex B)."""
_TEST_NOTCH = 2.5
"""q_sT, notch parameter of the standard test gear."""


def bending_stress_mpa(load_n_per_mm: Numbers, module_mm: Numbers, form: ToothForm, rim_factor: Numbers) -> Numbers:
    """Return sigma_F = F_t K / (b m) Y_F Y_S Y_B (ISO 6336-3, clause 5.2, method B).

    Y_beta is 1 for spur gears. So is Y_DT, at contact ratios above 2 too: ISO 6336-3, clause 9, takes less only for
    teeth of class 4 or better beyond 2.05. ``load_n_per_mm`` has all load factors in it.
    """
    return load_n_per_mm / module_mm * form.form_factor * form.stress_correction * rim_factor


def root_load_n_per_mm(permissible_mpa: Numbers, module_mm: Numbers, form: ToothForm, rim_factor: Numbers) -> Numbers:
    """Return the load per face width at which ``bending_stress_mpa`` is ``permissible_mpa``."""
    return permissible_mpa * module_mm / (form.form_factor * form.stress_correction * rim_factor)


def notch_sensitivity_factor(steel: GearGrade, notch: Numbers) -> Numbers:
    """Return Y_delta rel T at the reference number of load cycles, method B (ISO 6336-3, clause 12.3)."""
    gradient, test_gradient = 0.2 * (1.0 + 2.0 * notch), 0.2 * (1.0 + 2.0 * _TEST_NOTCH)
    layer = steel.slip_layer_mm
    factor: Numbers = (1.0 + np.sqrt(layer * gradient)) / (1.0 + np.sqrt(layer * test_gradient))
    return factor


def static_notch_factor(steel: GearGrade, form: ToothForm) -> Numbers:
    """Return Y_delta rel T for static stress (ISO 6336-3, clause 12.3.2)."""
    if steel.treatment == "case_hardened":
        return 0.44 * form.stress_correction + 0.12
    if steel.treatment == "nitrided":
        return 0.20 * form.stress_correction + 0.60
    support = 0.82 * (300.0 / steel.yield_mpa) ** 0.25
    factor: Numbers = (1.0 + support * (form.stress_correction - 1.0)) / (1.0 + support)
    return factor


def roughness_factor(steel: GearGrade, roughness_um: float) -> float:
    """Return Y_R rel T for Rz from 1 to 40 micrometres, method B (ISO 6336-3, clause 13.3)."""
    if steel.treatment == "nitrided":
        return float(4.299 - 3.259 * (roughness_um + 1.0) ** 0.0058)
    return float(1.674 - 0.529 * (roughness_um + 1.0) ** 0.1)


def mean_stress_factor(steel: GearGrade, form: ToothForm, ratio: Numbers) -> Numbers:
    """Return Y_M = 1 / (1 - R (1 - M) / (1 + M)), with R = -1.2 times ``ratio`` (ISO 6336-3, annex B; cited from
    memory).

    A load on one flank compresses the root of the other 1.2 times as much as it stretches its own. The standard gives
    this for idlers whose flanks carry different loads. The same stresses act where a torque changes its direction.

    ``ratio``: load on the less loaded flank over that on the other.
    """
    sensitivity = 0.8 - 0.15 * form.stress_correction if steel.treatment == "case_hardened" else _SENSITIVITY
    return 1.0 / (1.0 + _COMPRESSION * ratio * (1.0 - sensitivity) / (1.0 + sensitivity))


def root_limit_mpa(
    steel: GearGrade, form: ToothForm, life_factor: Numbers, *, roughness_um: float, bending_factor: Numbers
) -> Numbers:
    """Return sigma_FG = sigma_F,lim Y_ST Y_NT Y_delta rel T Y_R rel T Y_X Y_M at a safety of 1 (ISO 6336-3)."""
    surface = notch_sensitivity_factor(steel, form.notch) * roughness_factor(steel, roughness_um)
    return steel.root_limit_mpa * SPECIMEN_FACTOR * life_factor * surface * ROOT_SIZE_FACTOR * bending_factor


def static_root_limit_mpa(steel: GearGrade, form: ToothForm, life_factor: float) -> Numbers:
    """Return the limit for a few load cycles, where roughness, size and reversal do not matter."""
    return steel.root_limit_mpa * SPECIMEN_FACTOR * life_factor * static_notch_factor(steel, form)


_ENDLESS_CYCLES, _ENDLESS_FACTOR = 1e10, 0.85
"""Where both standards end the long-life line, and the life factor there for ordinary care."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LifeCurve:
    """An S-N curve: a static plateau, a straight line in logarithms to 1 at the reference, and a flat one beyond."""

    static_cycles: float  #: end of the plateau
    static_factor: float  #: life factor on the plateau, Z_NT or Y_NT
    reference_cycles: float  #: load cycles of the allowable stress numbers

    @property
    def exponent(self) -> float:
        """Logarithmic slope of stress: factor = (reference / cycles) ** exponent."""
        return float(np.log(self.static_factor) / np.log(self.reference_cycles / self.static_cycles))

    def factor(self, cycles: Numbers) -> Numbers:
        """Return the life factor at a number of load cycles."""
        late = np.log(1.0 / _ENDLESS_FACTOR) / np.log(_ENDLESS_CYCLES / self.reference_cycles)
        ratio = self.reference_cycles / np.clip(cycles, self.static_cycles, _ENDLESS_CYCLES)
        return np.power(ratio, np.where(ratio >= 1.0, self.exponent, late))[()]


FLANK_CURVES: Mapping[Treatment, LifeCurve] = {
    "case_hardened": LifeCurve(static_cycles=1e5, static_factor=1.6, reference_cycles=5e7),
    "nitrided": LifeCurve(static_cycles=1e5, static_factor=1.3, reference_cycles=2e6),
    "through_hardened": LifeCurve(static_cycles=1e5, static_factor=1.6, reference_cycles=5e7),
}
"""Z_NT without pitting allowed: ISO 6336-2, table 2."""
ROOT_CURVES: Mapping[Treatment, LifeCurve] = {
    "case_hardened": LifeCurve(static_cycles=1e3, static_factor=2.5, reference_cycles=3e6),
    "nitrided": LifeCurve(static_cycles=1e3, static_factor=1.6, reference_cycles=3e6),
    "through_hardened": LifeCurve(static_cycles=1e4, static_factor=2.5, reference_cycles=3e6),
}
"""Y_NT: ISO 6336-3, table 1."""


def highest_share(duty: DutyData) -> float:
    """Return the torque share that equivalent cycles belong to: 1, or the highest level above it."""
    return max(1.0, *duty.torque_shares)


def reversal_ratio(duty: DutyData) -> float:
    """Return the highest torque of the less loaded direction over that of the other, from 0 to 1."""
    highest = [
        max((share for share, _ in levels), default=0.0) for levels in (duty.forward_levels, duty.reversed_levels)
    ]
    return min(highest) / max(highest)


def equivalent_cycles(
    passes_per_rad: Numbers, duty: DutyData, stress_exponent: float, *, flank: bool, both_ways: bool = False
) -> Numbers:
    """Return the load cycles at ``highest_share`` that do the damage of the whole spectrum (Miner; ISO 6336-6, annex
    A).

    A level of share s of the highest torque and n cycles counts as n s^p cycles at that torque. p is the slope of the
    S-N curve in terms of torque, whose square root the contact stress grows with. The line goes on to any number of
    cycles, so that small loads count too (elementary form of the rule). Within the sloping part this equals the
    standard's equivalent torque.

    Joints swing to and fro over the same few teeth. A tooth in the middle of the swing is loaded a whole number of
    times in each swing, so that passes are rounded up.

    Levels of reversed torque load the back flanks of sun and ring. Front and back have a spectrum each, of which the
    worse counts. Planets mesh with the ring on the flanks that the sun leaves free: all levels load both.

    ``both_ways``: whether all levels load either side, as in a planet.
    """
    slope, highest = (0.5 if flank else 1.0) / stress_exponent, highest_share(duty)

    def cycles(levels: tuple[tuple[float, float], ...]) -> Numbers:
        found = np.zeros(np.shape(passes_per_rad))[()]
        for share, angle in levels:
            found = found + np.ceil(np.round(passes_per_rad * angle, 9)) * (share / highest) ** slope
        return found

    front, back = cycles(duty.forward_levels), cycles(duty.reversed_levels)
    return duty.jumps * (front + back if both_ways else np.maximum(front, back))


def passes_per_rad(gears: GearSet) -> tuple[Numbers, Numbers, Numbers]:
    """Return the load cycles of a tooth's flank per rad of the output: of sun, planet and ring.

    Against the carrier, the sun turns i - 1 times per turn of the output and meets every planet in each turn. A planet
    meets the sun once in each of its own turns, and the ring with its other flanks.
    """
    turns = (gears.ratio - 1.0) / (2.0 * np.pi)
    return (
        gears.planets * turns,
        turns * gears.sun_teeth / gears.planet_teeth,
        gears.planets * turns * gears.sun_teeth / gears.ring_teeth,
    )
