"""Roots after ISO 6336-3: bending stress, and the load per face width that a root may carry."""

import numpy as np

from pareto_monoped.actuator.rating.geometry import ToothForm
from pareto_monoped.geometry.shapes import Numbers
from pareto_monoped.materials import GearGrade

SPECIMEN_FACTOR = 2.0
"""Y_ST, stress correction of the standard test gear (ISO 6336-3, clause 5.3)."""
SIZE_FACTOR = 1.0
"""Y_X: 1 up to a module of 5 mm (ISO 6336-3, clause 14)."""
_COMPRESSION = 1.2
"""Compression of the root behind a loaded tooth over the tension in front of it (ISO 6336-3, annex B)."""
_SENSITIVITY = 0.3
"""M of steels that are nitrided or not surface-hardened (ISO 6336-3, annex B)."""
_TEST_NOTCH = 2.5
"""q_sT, notch parameter of the standard test gear."""


def bending_stress_mpa(load_n_per_mm: Numbers, module_mm: Numbers, form: ToothForm, rim_factor: Numbers) -> Numbers:
    """sigma_F = F_t K / (b m) Y_F Y_S Y_B (ISO 6336-3, clause 5.2, method B).

    Y_beta is 1 for spur gears. So is Y_DT, at contact ratios above 2 too: ISO 6336-3, clause 9, takes less only for
    teeth of class 4 or better beyond 2.05. ``load_n_per_mm`` has all load factors in it.
    """
    return load_n_per_mm / module_mm * form.form_factor * form.stress_correction * rim_factor


def root_load_n_per_mm(permissible_mpa: Numbers, module_mm: Numbers, form: ToothForm, rim_factor: Numbers) -> Numbers:
    """Load per face width at which ``bending_stress_mpa`` is ``permissible_mpa``."""
    return permissible_mpa * module_mm / (form.form_factor * form.stress_correction * rim_factor)


def notch_sensitivity_factor(steel: GearGrade, notch: Numbers) -> Numbers:
    """Y_delta rel T at the reference number of load cycles, method B (ISO 6336-3, clause 12.3)."""
    gradient, test_gradient = 0.2 * (1.0 + 2.0 * notch), 0.2 * (1.0 + 2.0 * _TEST_NOTCH)
    layer = steel.slip_layer_mm
    factor: Numbers = (1.0 + np.sqrt(layer * gradient)) / (1.0 + np.sqrt(layer * test_gradient))
    return factor


def static_notch_factor(steel: GearGrade, form: ToothForm) -> Numbers:
    """Y_delta rel T for static stress (ISO 6336-3, clause 12.3.2)."""
    if steel.treatment == "case_hardened":
        return 0.44 * form.stress_correction + 0.12
    if steel.treatment == "nitrided":
        return 0.20 * form.stress_correction + 0.60
    support = 0.82 * (300.0 / steel.yield_mpa) ** 0.25
    factor: Numbers = (1.0 + support * (form.stress_correction - 1.0)) / (1.0 + support)
    return factor


def roughness_factor(steel: GearGrade, roughness_um: float) -> float:
    """Y_R rel T for Rz from 1 to 40 micrometres, method B (ISO 6336-3, clause 13.3)."""
    if steel.treatment == "nitrided":
        return float(4.299 - 3.259 * (roughness_um + 1.0) ** 0.0058)
    return float(1.674 - 0.529 * (roughness_um + 1.0) ** 0.1)


def mean_stress_factor(steel: GearGrade, form: ToothForm, ratio: Numbers) -> Numbers:
    """Y_M = 1 / (1 - R (1 - M) / (1 + M)), with R = -1.2 times ``ratio`` (ISO 6336-3, annex B; cited from memory).

    A load on one flank compresses the root of the other 1.2 times as much as it stretches its own. The standard gives
    this for idlers whose flanks carry different loads. The same stresses act where a torque changes its direction.

    Args:
        steel: of the tooth.
        form: of its root.
        ratio: load on the less loaded flank over that on the other.
    """
    sensitivity = 0.8 - 0.15 * form.stress_correction if steel.treatment == "case_hardened" else _SENSITIVITY
    return 1.0 / (1.0 + _COMPRESSION * ratio * (1.0 - sensitivity) / (1.0 + sensitivity))


def root_limit_mpa(
    steel: GearGrade, form: ToothForm, life_factor: Numbers, *, roughness_um: float, bending_factor: Numbers
) -> Numbers:
    """sigma_FG = sigma_F,lim Y_ST Y_NT Y_delta rel T Y_R rel T Y_X Y_M, the stress at a safety of 1.

    Args:
        steel: of the tooth.
        form: of its root.
        life_factor: Y_NT.
        roughness_um: Rz of the fillet.
        bending_factor: Y_M: 1 for teeth bent one way, less for those bent both ways.
    """
    surface = notch_sensitivity_factor(steel, form.notch) * roughness_factor(steel, roughness_um)
    return steel.root_limit_mpa * SPECIMEN_FACTOR * life_factor * surface * SIZE_FACTOR * bending_factor


def static_root_limit_mpa(steel: GearGrade, form: ToothForm, life_factor: float) -> Numbers:
    """The same for a few load cycles: roughness, size and reversal do not matter then."""
    return steel.root_limit_mpa * SPECIMEN_FACTOR * life_factor * static_notch_factor(steel, form)
