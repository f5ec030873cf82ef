"""How long a motor's winding stands a current: two heat capacities, winding and housing, and two resistances.

With the temperatures T_w and T_h above the ambient one, and P_0 the heat of the winding at 25 C:

    C_w dT_w/dt = P_0 (235 + T_w + T_a) / (235 + 25) - (T_w - T_h) / R_wh
    C_h dT_h/dt = (T_w - T_h) / R_wh - T_h / R_ha

Copper's resistance grows by the rule of IEC 60034-1, with 235 C. The model is that of J.-P. Lin and G. C. Thomas for
the Open-Source Leg, and of U. H. Lee et al., arXiv:2310.00080. Iron losses are left out.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

from pydantic import ConfigDict, Field

Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
Temperature = Annotated[float, Field(ge=-60.0, le=400.0, allow_inf_nan=False)]

COPPER_DEGC = 235.0
"""Copper's resistance is proportional to this plus its temperature (IEC 60034-1)."""

REFERENCE_DEGC = 25.0
"""At which resistances are published; data sheets that do not say so were measured in a room."""

_REL_TOLERANCE = 1e-12


@dataclass(frozen=True, slots=True, kw_only=True)
class ThermalData:
    """Measured thermal properties of a motor. No default stands for a measurement.

    Attributes:
        winding_heat_capacity_j_per_k, housing_heat_capacity_j_per_k: of the two masses.
        winding_to_housing_k_per_w: resistance between them.
        housing_to_ambient_k_per_w: resistance from the housing to still air; None: that with which the continuous
            current holds the winding at its limit.
        winding_limit_degc: highest temperature of the winding.
        ambient_degc: of the air, and of everything at the start.
    """

    __pydantic_config__ = ConfigDict(extra="forbid")

    winding_heat_capacity_j_per_k: Positive
    housing_heat_capacity_j_per_k: Positive
    winding_to_housing_k_per_w: Positive
    housing_to_ambient_k_per_w: Positive | None = None
    winding_limit_degc: Temperature
    ambient_degc: Temperature = REFERENCE_DEGC

    def __post_init__(self) -> None:
        if self.winding_limit_degc <= self.ambient_degc:
            raise ValueError(
                f"winding_limit_degc = {self.winding_limit_degc}: must exceed ambient_degc = {self.ambient_degc}; "
                "correct one of them"
            )

    @property
    def rise_k(self) -> float:
        """From the ambient temperature to the winding's limit."""
        return self.winding_limit_degc - self.ambient_degc

    def total_k_per_w(self, continuous_heat_w: float) -> float:
        """Thermal resistance with which the winding stays at its limit for ever.

        Args:
            continuous_heat_w: heat of the winding at 25 C that the continuous current makes.
        """
        return self.rise_k / (continuous_heat_w * resistance_growth(self.winding_limit_degc))

    def lasting_heat_w(self, *, continuous_heat_w: float) -> float:
        """Heat of the winding at 25 C with which it stays at its limit for ever.

        Args:
            continuous_heat_w: that of the continuous current, which it is without ``housing_to_ambient_k_per_w``.
        """
        if self.housing_to_ambient_k_per_w is None:
            return continuous_heat_w
        whole = self.winding_to_housing_k_per_w + self.housing_to_ambient_k_per_w
        return self.rise_k / (whole * resistance_growth(self.winding_limit_degc))

    def time_to_limit_s(self, heat_w: float, *, continuous_heat_w: float) -> float:
        """How long a cold winding takes to its limit; infinite if it never gets there.

        Args:
            heat_w: heat of the winding at 25 C.
            continuous_heat_w: the same for the continuous current; used without ``housing_to_ambient_k_per_w``.

        Raises:
            ValueError: ``winding_to_housing_k_per_w`` alone is more than the continuous current allows, and nothing is
                known of the housing.
        """
        outside = self.housing_to_ambient_k_per_w
        if outside is None:
            outside = self.total_k_per_w(continuous_heat_w) - self.winding_to_housing_k_per_w
            if outside <= 0.0:
                raise ValueError(
                    f"winding_to_housing_k_per_w = {self.winding_to_housing_k_per_w}: must be less than "
                    f"{self.total_k_per_w(continuous_heat_w):.3g} K/W, all that the continuous current allows; correct "
                    "it or give housing_to_ambient_k_per_w"
                )
        slope = heat_w / (COPPER_DEGC + REFERENCE_DEGC)
        inside, across = 1.0 / self.winding_to_housing_k_per_w, 1.0 / outside
        # The matrix of the equations above, [[a, b], [c, d]], has two real eigenvalues because b c > 0.
        a = (slope - inside) / self.winding_heat_capacity_j_per_k
        b = inside / self.winding_heat_capacity_j_per_k
        c = inside / self.housing_heat_capacity_j_per_k
        d = -(inside + across) / self.housing_heat_capacity_j_per_k
        root = math.hypot(a - d, 2.0 * math.sqrt(b * c))
        fast, slow = 0.5 * (a + d - root), 0.5 * (a + d + root)
        start = heat_w * resistance_growth(self.ambient_degc) / self.winding_heat_capacity_j_per_k
        # The winding's rise is the sum of these two, each of which grows with time.
        terms = ((start * (slow - a) / root, fast), (start * (a - fast) / root, slow))

        def rise(time_s: float) -> float:
            return sum(share * (math.expm1(rate * time_s) / rate if rate else time_s) for share, rate in terms)

        if slow < 0.0 and sum(-share / rate for share, rate in terms) <= self.rise_k:
            return math.inf
        return _when(rise, self.rise_k)


def resistance_growth(temperature_degc: float) -> float:
    """Copper's resistance over that at 25 C."""
    return (COPPER_DEGC + temperature_degc) / (COPPER_DEGC + REFERENCE_DEGC)


def _when(rise: Callable[[float], float], wanted: float) -> float:
    """When a growing function of time reaches a value, by bisection."""
    low, high = 0.0, 1.0
    while rise(high) < wanted:
        low, high = high, 2.0 * high
    while high - low > _REL_TOLERANCE * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if rise(middle) < wanted else (low, middle)
    return high
