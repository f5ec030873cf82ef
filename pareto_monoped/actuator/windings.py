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
"""

import math
from typing import Literal

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
    """k_t of the speed constant: 60 / (2 pi Kv)."""
    return 60.0 / (2.0 * math.pi * kv_rpm_per_v)


def line_to_line_ohm(resistance_ohm: float, kind: ResistanceKind) -> float:
    """The line-to-line resistance from a published one."""
    return PHASES_IN_SERIES * resistance_ohm if kind == "phase" else resistance_ohm
