"""Conventions of winding resistance and torque constant, and what converts other conventions to them.

Here a motor is its equivalent DC machine: one current i in one winding of resistance R, with

    torque = k_t i,    voltage = R i + k_t w,    k_t = 60 / (2 pi Kv),    heat of all phases together = R i^2.

R is the **line-to-line** resistance, between any two of the three terminals. A star winding has R = 2 R_ph, a delta
winding of branches R_b has R = 2/3 R_b and the equivalent star R_ph = R_b / 3. k_t belongs to the **DC-equivalent**
current i. Kv is speed over the peak of the voltage that the turning rotor induces between two terminals.

- Block commutation of a trapezoidal motor: i flows through two phases in series and the third carries none. The heat is
  2 R_ph i^2 = R i^2; the power is i times the flat top of the line-to-line voltage, so k_t = 60 / (2 pi Kv).
- Sinusoidal currents of the amplitude i_p in phase with the induced voltage, whose phase amplitude is k_t w / sqrt(3):
  the power is 3/2 (k_t w / sqrt(3)) i_p, so torque = sqrt(3)/2 k_t i_p and i = sqrt(3)/2 i_p. The heat is
  3/2 R_ph i_p^2 = 3/2 (R / 2) (4/3) i^2 = R i^2.

Both kinds of drive thus make the heat R (torque / k_t)^2, and no factor depends on the drive
(``tests/actuator/test_windings.py`` adds it up over an electrical period). Blocks of current in a motor of sinusoidal
voltage give 3/pi = 0.955 of this torque on average.

Sources: U. H. Lee et al., How to Model Brushless Electric Motors for the Design of Lightweight Robotic Systems,
arXiv:2310.00080 (2023), for the conventions and the confusion between them. T-Motor's AK80-6, data sheet as quoted by
DFKI's double pendulum: 100 rpm/V, 0.091 N m/A, 170 mohm phase to phase and 0.2206 N m/sqrt(W), which is
k_t / sqrt(R) in this convention. The U8 has the same motor constant, 0.0955 / sqrt(0.186) = 0.221, so its 186 mohm
are line to line as well.

How long a motor's winding stands a current: two heat capacities, winding and housing, and two resistances.

With the temperatures T_w and T_h above the ambient one, and P_0 the heat of the winding at 25 C:

    C_w dT_w/dt = P_0 (235 + T_w + T_a) / (235 + 25) - (T_w - T_h) / R_wh
    C_h dT_h/dt = (T_w - T_h) / R_wh - T_h / R_ha

Copper's resistance grows by the rule of IEC 60034-1, with 235 C. The model is that of J.-P. Lin and G. C. Thomas for
the Open-Source Leg, and of U. H. Lee et al., arXiv:2310.00080. Iron losses are left out.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import Field

from pareto_monoped.config import Positive, Strict

ResistanceKind = Literal["line_to_line", "phase"]
"""Between two terminals, or of one phase of the star (for a delta: of the star that replaces it, a third of a branch).
"""
PHASES_IN_SERIES = 2.0
"""Phases of a star between two terminals."""
PER_PHASE_AMPLITUDE = math.sqrt(3.0) / 2.0
"""Torque per ampere of a sinusoidal phase current's amplitude, over k_t."""
PER_PHASE_RMS = math.sqrt(2.0) * PER_PHASE_AMPLITUDE
"""Torque per ampere of its RMS value, over k_t."""


def torque_constant_n_m_per_a(kv_rpm_per_v: float) -> float:
    """Return k_t of the speed constant: 60 / (2 pi Kv)."""
    return 60.0 / (2.0 * math.pi * kv_rpm_per_v)


def line_to_line_ohm(resistance_ohm: float, kind: ResistanceKind) -> float:
    """Return the line-to-line resistance from a published one."""
    return PHASES_IN_SERIES * resistance_ohm if kind == "phase" else resistance_ohm


Temperature = Annotated[float, Field(ge=-60.0, le=400.0, allow_inf_nan=False)]
COPPER_DEGC = 235.0
"""Copper's resistance is proportional to this plus its temperature (IEC 60034-1)."""
REFERENCE_DEGC = 25.0
"""At which resistances are published; data sheets that do not say so were measured in a room."""
_REL_TOLERANCE = 1e-12


@dataclass(frozen=True, slots=True, kw_only=True)
class ThermalData(Strict):
    """Measured thermal properties of a motor. No default stands for a measurement."""

    winding_heat_capacity_j_per_k: Positive
    housing_heat_capacity_j_per_k: Positive
    winding_to_housing_k_per_w: Positive  #: resistance between them
    #: Resistance from the housing to still air; None: that with which the continuous current holds the winding at its
    #: limit
    housing_to_ambient_k_per_w: Positive | None = None
    winding_limit_degc: Temperature  #: highest temperature of the winding
    ambient_degc: Temperature = REFERENCE_DEGC  #: of the air, and of everything at the start

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
        """Return the resistance that holds the winding at its limit under the continuous current's heat at 25 C."""
        return self.rise_k / (continuous_heat_w * resistance_growth(self.winding_limit_degc))

    def lasting_heat_w(self, *, continuous_heat_w: float) -> float:
        """Return the heat at 25 C with which the winding stays at its limit, by default the continuous current's."""
        if self.housing_to_ambient_k_per_w is None:
            return continuous_heat_w
        whole = self.winding_to_housing_k_per_w + self.housing_to_ambient_k_per_w
        return self.rise_k / (whole * resistance_growth(self.winding_limit_degc))

    def time_to_limit_s(self, heat_w: float, *, continuous_heat_w: float) -> float:
        """Return how long a cold winding takes to its limit; infinite if it never gets there.

        ``continuous_heat_w``: the same for the continuous current; used without ``housing_to_ambient_k_per_w``.

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
    """Return the copper's resistance over that at 25 C."""
    return (COPPER_DEGC + temperature_degc) / (COPPER_DEGC + REFERENCE_DEGC)


def _when(rise: Callable[[float], float], wanted: float) -> float:
    """Return when a growing function of time reaches a value, by bisection."""
    low, high = 0.0, 1.0
    while rise(high) < wanted:
        low, high = high, 2.0 * high
    while high - low > _REL_TOLERANCE * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if rise(middle) < wanted else (low, middle)
    return high
