"""What single connections carry: screws (VDI 2230-1 in its short form), dowels, splines, shafts, bonds and press
fits.

The assembly preload and the torque of screws stand in ``geometry.tightening``. Press fits are those of DIN 7190-1 in
the elastic range.
"""

from dataclasses import dataclass

import numpy as np

from pareto_monoped.geometry.tightening import Fastening, ThreadSize
from pareto_monoped.materials import ElasticMaterial

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
    """Return the stretch per load of a screw threaded all along, and of the thread it stands in (eq. R3/1 to R3/7)."""
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
    """Return what is left of the assembly preload: F_M / alpha_A - F_Z, with F_Z = f_Z / (delta_S + delta_P)."""
    screw = screw_compliance_mm_per_n(fastening.thread, grip_mm, steel_mpa=steel_mpa, threaded_into_mpa=clamped_mpa)
    plates = plate_compliance_mm_per_n(fastening.bearing_mm, fastening.hole_mm, grip_mm, clamped_mpa)
    return fastening.preload_n / SCATTER - EMBEDDING_MM / (screw + plates)


def slip_force_n(count: float, preload_n: float) -> float:
    """Return the transverse force at which a joint of several screws slips: n mu F_V."""
    return count * FRICTION * preload_n


def thread_force_n(thread: ThreadSize, engaged_mm: float, shear_mpa: float) -> float:
    """Return the axial force at which an aluminium thread begins to shear (VDI 2230-1, eq. R11/1; area after ISO 898-1,
    annex).

    The female thread shears on the screw's outer diameter: pi d (P / 2 + (d - D2) tan 30 deg) per pitch.
    """
    d, pitch = thread.diameter_mm, thread.pitch_mm
    width = 0.5 * pitch + (d - thread.flank_diameter_mm) * np.tan(np.pi / 6.0)
    return float(_FEMALE_SHEAR * shear_mpa * np.pi * d * width * engaged_mm / pitch)


def head_force_n(fastening: Fastening, yield_mpa: float) -> float:
    """Return the axial force at which a head's bearing face reaches the pressure that a part carries (eq. R10/1)."""
    return float(0.25 * np.pi * (fastening.bearing_mm**2 - fastening.hole_mm**2) * _PRESSURE * yield_mpa)


MISES = 1.0 / np.sqrt(3.0)
"""Yield stress in shear over that in tension (von Mises)."""
SPLINE_SHARE = 0.75
"""Share of a spline's flanks that carry (DIN 5466; Roloff/Matek, 12.3: k = 0.75 for involute flanks)."""
SHAPE_SAFETY = 1.5
"""Least safety of dowels, splines and shafts against yielding; our own choice: reamed together, they share the load,
but not quite evenly."""
BOND_MPA = 5.0
"""Shear strength of a retaining compound to count on: a fifth of the 25 MPa that makers give for steel (ISO 10123), for
aluminium, a gap of 0.1 mm, 80 degrees Celsius and repeated load (each 0.5 to 0.8, makers' design guides)."""
BOND_SAFETY = 2.0
"""Least safety of a bonded joint; our own choice, on top of ``BOND_MPA``: a bond cannot be inspected."""


def bearing_force_n(diameter_mm: float, engaged_mm: float, yield_mpa: float) -> float:
    """Return the transverse force of one dowel at which the mean pressure in its hole, F / (d l), reaches the proof
    stress.

    Roloff/Matek, eq. 9.17 (pins in holes). The hole does not yet widen: EN 1999-1-1, 8.5.14, allows 1.5 times this.
    """
    return diameter_mm * engaged_mm * yield_mpa


def shear_force_n(diameter_mm: float, yield_mpa: float) -> float:
    """Return the transverse force of one dowel at which its middle yields in shear, at 4/3 of the mean stress."""
    return float(0.25 * np.pi * diameter_mm**2 * 0.75 * MISES * yield_mpa)


def spline_torque_n_m(teeth: float, base_mm: float, tip_mm: float, length_mm: float, yield_mpa: float) -> float:
    """Return the torque at which a spline's flanks yield the hub: p = T / (k z h l r_m) (Roloff/Matek, eq. 12.10)."""
    height, middle = tip_mm - base_mm, 0.5 * (tip_mm + base_mm)
    return 1e-3 * SPLINE_SHARE * teeth * height * length_mm * middle * yield_mpa


def torsion_torque_n_m(radius_mm: float, yield_mpa: float) -> float:
    """Return the torque at which a solid shaft yields at its surface: tau = 2 T / (pi r^3)."""
    return float(1e-3 * 0.5 * np.pi * radius_mm**3 * MISES * yield_mpa)


def bond_torque_n_m(radius_mm: float, length_mm: float) -> float:
    """Return the torque of a cylinder bonded into a bore: tau 2 pi r^2 l."""
    return float(1e-3 * BOND_MPA * 2.0 * np.pi * radius_mm**2 * length_mm)


def pin_bending_force_n(diameter_mm: float, span_mm: float, yield_mpa: float) -> float:
    """Return the even load at which a pin on two supports yields: M = F L / 8, W = pi d^3 / 32."""
    return float(yield_mpa * np.pi * diameter_mm**3 / 32.0 * 8.0 / span_mm)


SMOOTHING = 0.8
"""Share of the roughness Rz of both faces by which they flatten (DIN 7190-1: U = 0.8 (Rz_A + Rz_I))."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PressFit:
    """A solid pin in a hub."""

    diameter_mm: float  #: of the joint
    hub_mm: float  #: outer diameter of the hub
    hub: ElasticMaterial
    pin: ElasticMaterial

    @property
    def thinness(self) -> float:
        """Q_A: diameter of the joint over that of the hub."""
        return self.diameter_mm / self.hub_mm

    def pressure_mpa(self, interference_mm: float, roughness_mm: float = 0.0) -> float:
        """Return p = (xi - smoothing) / K' of Lame's thick rings, 0 with play; ``roughness_mm`` is both Rz."""
        q2 = self.thinness**2
        outer = ((1.0 + q2) / (1.0 - q2) + self.hub.poisson_ratio) / self.hub.youngs_modulus_mpa
        inner = (1.0 - self.pin.poisson_ratio) / self.pin.youngs_modulus_mpa
        effective = interference_mm - SMOOTHING * roughness_mm
        return max(effective, 0.0) / self.diameter_mm / (outer + inner)

    def elastic_limit_mpa(self, yield_mpa: float) -> float:
        """Return the pressure at which the hub begins to yield at the joint (DIN 7190-1, shear energy criterion).

        There, sigma_t = p (1 + Q^2) / (1 - Q^2) and sigma_r = -p, so that sigma_v = p sqrt(3 + Q^4) / (1 - Q^2).
        """
        q2 = self.thinness**2
        pressure_mpa: float = yield_mpa * (1.0 - q2) / (3.0 + q2**2) ** 0.5
        return pressure_mpa
