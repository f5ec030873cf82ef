"""What carries a torque by shape or by bonding: dowels, splines, shafts, bonded cylinders."""

import numpy as np

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
    """Transverse force of one dowel at which the mean pressure in its hole, F / (d l), reaches the proof stress.

    Roloff/Matek, eq. 9.17 (pins in holes). The hole does not yet widen: EN 1999-1-1, 8.5.14, allows 1.5 times this.
    """
    return diameter_mm * engaged_mm * yield_mpa


def shear_force_n(diameter_mm: float, yield_mpa: float) -> float:
    """Transverse force of one dowel at which its middle yields in shear, at 4/3 of the mean stress."""
    return float(0.25 * np.pi * diameter_mm**2 * 0.75 * MISES * yield_mpa)


def spline_torque_n_m(teeth: float, base_mm: float, tip_mm: float, length_mm: float, yield_mpa: float) -> float:
    """Torque at which the flanks of a spline yield the hub: p = T / (k z h l r_m) (Roloff/Matek, eq. 12.10).

    Args:
        teeth: number of them.
        base_mm: inner radius of the flanks that meet.
        tip_mm: outer radius of these flanks.
        length_mm: of the hub.
        yield_mpa: of the softer part.
    """
    height, middle = tip_mm - base_mm, 0.5 * (tip_mm + base_mm)
    return 1e-3 * SPLINE_SHARE * teeth * height * length_mm * middle * yield_mpa


def torsion_torque_n_m(radius_mm: float, yield_mpa: float) -> float:
    """Torque at which a solid shaft yields at its surface: tau = 2 T / (pi r^3)."""
    return float(1e-3 * 0.5 * np.pi * radius_mm**3 * MISES * yield_mpa)


def bond_torque_n_m(radius_mm: float, length_mm: float) -> float:
    """Torque of a cylinder bonded into a bore: tau 2 pi r^2 l."""
    return float(1e-3 * BOND_MPA * 2.0 * np.pi * radius_mm**2 * length_mm)


def pin_bending_force_n(diameter_mm: float, span_mm: float, yield_mpa: float) -> float:
    """Even load over the span at which a pin on two supports yields in its middle: M = F L / 8, W = pi d^3 / 32."""
    return float(yield_mpa * np.pi * diameter_mm**3 / 32.0 * 8.0 / span_mm)
