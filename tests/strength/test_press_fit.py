"""Press fits against Lame's equations solved for a hub and a pin."""

import numpy as np
import pytest

from pareto_monoped.materials import MATERIALS
from pareto_monoped.strength.connections import PressFit


def lame(fit, interference_mm):
    """Pressure and the hub's hoop stress at the joint, from u = A r + B / r in hub and pin (plane stress).

    Unknown: A and B of the hub, A of the pin (its B is zero). The hub's rim is free, the radial stresses are equal at
    the joint, and both displacements there differ by half the interference.
    """
    r, rim = 0.5 * fit.diameter_mm, 0.5 * fit.hub_mm

    def radial(material, radius):
        e, nu = material.youngs_modulus_mpa, material.poisson_ratio
        return e / (1.0 - nu), -e / (1.0 + nu) / radius**2  # coefficients of A and B

    (ha, hb), (ra, rb), (pa, _) = radial(fit.hub, r), radial(fit.hub, rim), radial(fit.pin, r)
    matrix = [[ra, rb, 0.0], [ha, hb, -pa], [r, 1.0 / r, -r]]
    a, b, c = np.linalg.solve(matrix, [0.0, 0.0, 0.5 * interference_mm])
    e, nu = fit.hub.youngs_modulus_mpa, fit.hub.poisson_ratio
    return -pa * c, e / (1.0 - nu) * a + e / (1.0 + nu) * b / r**2


FITS = [
    PressFit(diameter_mm=4.0, hub_mm=9.0, hub=MATERIALS.aluminium, pin=MATERIALS.steel),
    PressFit(diameter_mm=3.0, hub_mm=4.4, hub=MATERIALS.aluminium, pin=MATERIALS.steel),
    PressFit(diameter_mm=20.0, hub_mm=60.0, hub=MATERIALS.steel, pin=MATERIALS.steel),
]


@pytest.mark.parametrize("fit", FITS)
def test_pressure_is_lame_s(fit):
    pressure, _ = lame(fit, 0.012)
    assert fit.pressure_mpa(0.012) == pytest.approx(pressure)
    # Roughness of 5 um in sum takes 4 um.
    assert fit.pressure_mpa(0.016, roughness_mm=0.005) == pytest.approx(pressure)
    assert fit.pressure_mpa(-0.003) == 0.0


@pytest.mark.parametrize("fit", FITS)
def test_the_hub_yields_at_the_joint_by_von_mises(fit):
    pressure, hoop = lame(fit, 0.012)
    equivalent = np.sqrt(pressure**2 + pressure * hoop + hoop**2)
    assert fit.elastic_limit_mpa(250.0) == pytest.approx(250.0 * pressure / equivalent)


def test_steel_on_steel_by_the_textbook_s_short_formula():
    """Same steel, solid shaft: p = xi E (1 - Q^2) / 2 (Decker; Roloff/Matek, 12.3)."""
    fit = FITS[2]
    given = 0.02 / 20.0 * MATERIALS.steel.youngs_modulus_mpa * (1.0 - (20.0 / 60.0) ** 2) / 2.0
    assert fit.pressure_mpa(0.02) == pytest.approx(given)
