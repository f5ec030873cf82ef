"""Press fits in the elastic range (DIN 7190-1): pressure from interference, yielding of the hub, torque."""

from dataclasses import dataclass

from pareto_monoped.materials import ElasticMaterial

SMOOTHING = 0.8
"""Share of the roughness Rz of both faces by which they flatten (DIN 7190-1: U = 0.8 (Rz_A + Rz_I))."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PressFit:
    """A solid pin in a hub.

    Attributes:
        diameter_mm: of the joint.
        hub_mm: outer diameter of the hub.
        hub, pin: what they are made of.
    """

    diameter_mm: float
    hub_mm: float
    hub: ElasticMaterial
    pin: ElasticMaterial

    @property
    def thinness(self) -> float:
        """Q_A: diameter of the joint over that of the hub."""
        return self.diameter_mm / self.hub_mm

    def pressure_mpa(self, interference_mm: float, roughness_mm: float = 0.0) -> float:
        """Pressure in the joint: p = (xi - smoothing) / K' of Lame's thick rings, 0 where there is play.

        Args:
            interference_mm: of the diameters, before joining.
            roughness_mm: sum of Rz of both faces.
        """
        q2 = self.thinness**2
        outer = ((1.0 + q2) / (1.0 - q2) + self.hub.poisson_ratio) / self.hub.youngs_modulus_mpa
        inner = (1.0 - self.pin.poisson_ratio) / self.pin.youngs_modulus_mpa
        effective = interference_mm - SMOOTHING * roughness_mm
        return max(effective, 0.0) / self.diameter_mm / (outer + inner)

    def elastic_limit_mpa(self, yield_mpa: float) -> float:
        """Pressure at which the hub begins to yield at the joint (DIN 7190-1, shear energy criterion).

        There, sigma_t = p (1 + Q^2) / (1 - Q^2) and sigma_r = -p, so that sigma_v = p sqrt(3 + Q^4) / (1 - Q^2).
        """
        q2 = self.thinness**2
        pressure_mpa: float = yield_mpa * (1.0 - q2) / (3.0 + q2**2) ** 0.5
        return pressure_mpa
