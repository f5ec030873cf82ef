"""Screw joints after VDI 2230-1 in its short form: least preload, slip, threads, pressure under heads.

The assembly preload and the torque stand with the screws, in ``geometry.tightening``.
"""

import numpy as np

from pareto_monoped.geometry.tightening import Fastening, ThreadSize

SCATTER = 1.6
"""alpha_A of a torque wrench whose friction is estimated (VDI 2230-1, table A8: 1.4 to 1.6)."""
EMBEDDING_MM = 0.010
"""f_Z under shear at Rz 10 to 40: 3 um in the thread, 4.5 um under the head, 2.5 um in the interface (table 5)."""
FRICTION = 0.15
"""Of dry, clean joints of aluminium or steel; VDI 2230-1, table A6, has 0.1 to 0.2 for aluminium."""
SLIP_SAFETY = 1.2
"""Least safety against slip under static load (VDI 2230-1, R12: 1.2; 1.8 under alternating load)."""
_CONE = 0.6
"""tan phi of the cone of compressed material (VDI 2230-1, eq. 44: 0.5 to 0.6 for usual tapped joints)."""
_HEAD_SHARE, _THREAD_SHARE, _MATE_SHARE = 0.4, 0.5, 0.33
"""Lengths of head, engaged core and engaged female thread that stretch, in diameters (VDI 2230-1, 5.1.1, tapped)."""
_FEMALE_SHEAR = 0.897
"""C3: strength of a female thread that is bent open by a stronger screw (VDI 2230-1, 5.5.5, after Alexander)."""
_PRESSURE = 1.5
"""Pressure under a head over the proof stress; our own choice, as the metal around holds it (EN 1999-1-1, 8.5.5)."""


def screw_compliance_mm_per_n(
    thread: ThreadSize, grip_mm: float, *, steel_mpa: float, threaded_into_mpa: float
) -> float:
    """Stretch of a screw with thread all along and of the thread that it stands in, per load (eq. R3/1 to R3/7).

    Args:
        thread: of the screw.
        grip_mm: clamped length l_K.
        steel_mpa: Young's modulus of the screw.
        threaded_into_mpa: Young's modulus of what it is driven into.
    """
    d = thread.diameter_mm
    nominal_mm2 = 0.25 * np.pi * d**2
    head = _HEAD_SHARE * d / (steel_mpa * nominal_mm2)
    core = (grip_mm + _THREAD_SHARE * d) / (steel_mpa * thread.core_area_mm2)
    mate = _MATE_SHARE * d / (threaded_into_mpa * nominal_mm2)
    return float(head + core + mate)


def plate_compliance_mm_per_n(bearing_mm: float, hole_mm: float, grip_mm: float, modulus_mpa: float) -> float:
    """Give of the clamped plates of a tapped joint: a cone that opens from the head's bearing face (eq. 41, w = 2)."""
    end = bearing_mm + 2.0 * grip_mm * _CONE
    ratio = (bearing_mm + hole_mm) * (end - hole_mm) / ((bearing_mm - hole_mm) * (end + hole_mm))
    return float(np.log(ratio) / (modulus_mpa * np.pi * hole_mm * _CONE))


def least_preload_n(fastening: Fastening, grip_mm: float, *, steel_mpa: float, clamped_mpa: float) -> float:
    """What is left of the assembly preload: F_M / alpha_A - F_Z, with F_Z = f_Z / (delta_S + delta_P)."""
    screw = screw_compliance_mm_per_n(fastening.thread, grip_mm, steel_mpa=steel_mpa, threaded_into_mpa=clamped_mpa)
    plates = plate_compliance_mm_per_n(fastening.bearing_mm, fastening.hole_mm, grip_mm, clamped_mpa)
    return fastening.preload_n / SCATTER - EMBEDDING_MM / (screw + plates)


def slip_force_n(count: float, preload_n: float) -> float:
    """Transverse force at which a joint of several screws slips: n mu F_V."""
    return count * FRICTION * preload_n


def thread_force_n(thread: ThreadSize, engaged_mm: float, shear_mpa: float) -> float:
    """Axial force at which an aluminium thread begins to shear (VDI 2230-1, eq. R11/1; area after ISO 898-1, annex).

    The female thread shears on the screw's outer diameter: pi d (P / 2 + (d - D2) tan 30 deg) per pitch.
    """
    d, pitch = thread.diameter_mm, thread.pitch_mm
    width = 0.5 * pitch + (d - thread.flank_diameter_mm) * np.tan(np.pi / 6.0)
    return float(_FEMALE_SHEAR * shear_mpa * np.pi * d * width * engaged_mm / pitch)


def head_force_n(fastening: Fastening, yield_mpa: float) -> float:
    """Axial force at which the head's bearing face reaches the pressure that the clamped part carries (eq. R10/1)."""
    return float(0.25 * np.pi * (fastening.bearing_mm**2 - fastening.hole_mm**2) * _PRESSURE * yield_mpa)
