"""The chain: its breaking load against the largest pull of a jump, and the wear of its joints over the duty.

Pins and bushes wear by pressure times sliding path (Archard, J. Appl. Phys. 24, 1953). A chain that runs at the
power that its standard rates may grow by 3 percent in 15,000 hours. A joint here slides far less: once onto its
sprocket and once off it per jump, so that it bears the pressure in proportion more.
"""

import numpy as np

from pareto_monoped.leg.chain_drives import ChainDrive
from pareto_monoped.strength.joint import LegJoint, Structure

_PRESSURE_MPA, _SPEED_M_PER_S, _HOURS = 31.0, 0.1, 15000.0
"""Pressure allowed at a chain speed, and for how long. Our own choice, 17 percent below the 37 MPa that the power rated
by ASME B29.1 puts on the joints of a half-inch chain at this speed (number 40; 0.004 N^1.08 n^0.9 P^(3 - 0.07 P) hp, as
in Shigley's Mechanical Engineering Design, eq. 17-32, for 15,000 hours, chains of 100 links). That rating is limited by
the fatigue of plates, so that wear allows at least as much. The paper's designs stay 26 times below our choice."""
_TEETH, _LINKS = 19, 100
"""Of both sprockets and of the chain to which that refers; ISO 10823 rates sprockets of 19 teeth."""
_BENDS_PER_LOOP, _BENDS_PER_JUMP = 4, 2
"""How often a joint bends: onto and off both sprockets; onto one and off it."""


def sliding_m(drive: ChainDrive, bends: float, teeth: int) -> float:
    """Path of a pin in its bush for a number of bends by one tooth of a sprocket."""
    return float(bends * 2.0 * np.pi / teeth * 0.5e-3 * drive.pin_diameter_mm)


def wear_n(drive: ChainDrive, jumps: float) -> float:
    """Pull under which the chain grows by 3 percent in so many jumps: p A s / s_duty."""
    loops = _SPEED_M_PER_S * 3600.0 * _HOURS / (1e-3 * drive.pitch_mm * _LINKS)
    rated_m = sliding_m(drive, _BENDS_PER_LOOP * loops, _TEETH)
    duty_m = sliding_m(drive, _BENDS_PER_JUMP * jumps, drive.teeth)
    return _PRESSURE_MPA * drive.bearing_area_mm2 * rated_m / duty_m


def _wear(s: Structure) -> float:
    return wear_n(s.leg.chain, s.settings.parts.duty.jumps)


_CURE = "release the knee's torque before its stop, a lower knee_ratio, or a motor of less torque"

JOINTS = (
    LegJoint(
        name="chain_breaking",
        group="chain",
        formula="breaking load / pull",
        source="ISO 606, least tensile strength",
        required=5.0,
        required_source="makers' catalogues and DIN 8150: static safety of 5 to 7 under shocks, for chains up to 3 m/s",
        loads=("peak_chain_tension_n",),
        capacity=lambda s: s.leg.chain.breaking_n,
        parts=("chain_hip", "chain_knee"),
        cure=_CURE,
    ),
    LegJoint(
        name="chain_wear",
        group="chain",
        formula="p A s / (s_duty F), with s the sliding path of a pin",
        source="Archard, J. Appl. Phys. 24 (1953); allowed pressure: 17 percent below that of ASME B29.1",
        required=1.0,
        required_source="the peak is taken for all of the path; 3 percent are within the travel of the turnbuckles",
        loads=("peak_chain_tension_n",),
        capacity=_wear,
        parts=("chain_hip", "chain_knee"),
        cure=_CURE,
    ),
)
