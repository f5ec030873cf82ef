"""The chain: its breaking load, the wear of its joints, and studs, threads, bars and forks of its turnbuckles.

Pins and bushes wear by pressure times sliding path (Archard, J. Appl. Phys. 24, 1953). A chain that runs at the power
that its standard rates may grow by 3 percent in 15,000 hours. A joint here slides far less: once onto its sprocket and
once off it per jump, so that it bears the pressure in proportion more.

The pull swells from slack once per jump, in the strand that stops the knee's rotor. A turnbuckle's stud, which its
locknut holds against its bar, then has the amplitude of half the pull.
"""

from functools import partial

import numpy as np

from pareto_monoped.geometry.tightening import thread_size
from pareto_monoped.leg.chain import (
    BAR_FLAT,
    BAR_WIDTH,
    CHEEK,
    FORK_BOTTOM,
    FORK_ROOT,
    HALF_FORK,
    LEAST_ENGAGED,
    THREAD,
)
from pareto_monoped.leg.dimensions import ChainDrive
from pareto_monoped.materials import ALLOYS
from pareto_monoped.strength.connections import MISES
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
    """Return the path of a pin in its bush for a number of bends by one tooth of a sprocket."""
    return float(bends * 2.0 * np.pi / teeth * 0.5e-3 * drive.pin_diameter_mm)


def wear_n(drive: ChainDrive, jumps: float) -> float:
    """Return the pull under which the chain grows by 3 percent in so many jumps: p A s / s_duty."""
    loops = _SPEED_M_PER_S * 3600.0 * _HOURS / (1e-3 * drive.pitch_mm * _LINKS)
    rated_m = sliding_m(drive, _BENDS_PER_LOOP * loops, _TEETH)
    duty_m = sliding_m(drive, _BENDS_PER_JUMP * jumps, drive.teeth)
    return _PRESSURE_MPA * drive.bearing_area_mm2 * rated_m / duty_m


BAR, FORK = ALLOYS["aw_7075_t6"], ALLOYS["c45_qt"]
_LIMIT_CYCLES = 2e6  # N_D of VDI 2230-1
_LEAST_CYCLES = 1e4  # below, VDI 2230-1 gives no fatigue strength


def stud_fatigue_n(diameter_mm: float, cycles: float) -> float:
    """Return the swelling pull that a rolled thread bears so often: 0.85 (150 / d + 45) MPa (VDI 2230-1, 5.5.3)."""
    amplitude_mpa = 0.85 * (150.0 / diameter_mm + 45.0)
    amplitude_mpa *= (_LIMIT_CYCLES / min(max(cycles, _LEAST_CYCLES), _LIMIT_CYCLES)) ** (1.0 / 3.0)
    force_n: float = 2.0 * amplitude_mpa * thread_size(diameter_mm).stress_area_mm2
    return force_n


def strip_n(diameter_mm: float, engaged_mm: float, yield_mpa: float) -> float:
    """Return the pull at which a tapped thread yields in shear on the screw's outer diameter (ISO 898-1, annex)."""
    thread = thread_size(diameter_mm)
    width = 0.5 * thread.pitch_mm + (diameter_mm - thread.flank_diameter_mm) * np.tan(np.pi / 6.0)
    area = np.pi * diameter_mm * width * engaged_mm / thread.pitch_mm
    return float(area * MISES * yield_mpa)


def bar_n(width_mm: float, flat_mm: float, diameter_mm: float, yield_mpa: float) -> float:
    """Return the pull at which a square bar yields in its flat middle or beside its thread."""
    beside = width_mm**2 - 0.25 * np.pi * diameter_mm**2
    return float(min(width_mm * flat_mm, beside) * yield_mpa)


def fork_n(half_mm: float, cheek_mm: float, pin_mm: float, slot_mm: float, root_mm: float, yield_mpa: float) -> float:
    """Return the pull at which a fork yields: its cheeks beside the pin, under the pin, the pin itself, or its root.

    The root is a beam with the pull in its middle, clamped by the cheeks: its moment is F l / 8 over the distance l of
    their middles.

    ``half_mm``: half width of cheeks and root.
    """
    beside = 2.0 * cheek_mm * (2.0 * half_mm - pin_mm) * yield_mpa
    under = 2.0 * cheek_mm * pin_mm * yield_mpa
    pin = 2.0 * 0.25 * np.pi * pin_mm**2 * MISES * yield_mpa
    root = 8.0 / (slot_mm + cheek_mm) * 2.0 * half_mm * root_mm**2 / 6.0 * yield_mpa
    return float(min(beside, under, pin, root))


def _fork(s: Structure) -> float:
    chain = s.leg.chain
    root = FORK_ROOT - FORK_BOTTOM
    return fork_n(HALF_FORK, CHEEK, chain.pin_diameter_mm, chain.inner_link_mm, root, FORK.yield_mpa)


_SIZE = 2.0 * THREAD.shank
_row = partial(
    LegJoint,
    group="chain",
    loads=("peak_chain_tension_n",),
    cure="release the knee's torque before its stop, a lower knee_ratio, or a motor of less torque",
)
_CHAIN, _ENDS = ("chain_hip", "chain_knee"), ("turnbuckle_end_hip", "turnbuckle_end_knee")
_YIELD = "our own choice against yield, for a pull that is measured"
JOINTS = (
    _row(name="chain_breaking", required=5.0, parts=_CHAIN, capacity=lambda s: s.leg.chain.breaking_n,
        formula="breaking load / pull", source="ISO 606, least tensile strength",
        required_source="makers' catalogues and DIN 8150: static safety of 5 to 7 under shocks, for chains up to "
        "3 m/s"),
    _row(name="chain_wear", required=1.0, parts=_CHAIN,
        capacity=lambda s: wear_n(s.leg.chain, s.settings.parts.duty.jumps),
        formula="p A s / (s_duty F), with s the sliding path of a pin",
        source="Archard, J. Appl. Phys. 24 (1953); allowed pressure: 17 percent below that of ASME B29.1",
        required_source="the peak is taken for all of the path; 3 percent are within the travel of the turnbuckles"),
    _row(name="turnbuckle_stud", required=1.5, parts=_ENDS,
        capacity=lambda s: thread_size(_SIZE).stress_area_mm2 * FORK.yield_mpa,
        formula="A_s R_e / F", source="stress area of ISO 898-1", required_source=_YIELD),
    _row(name="turnbuckle_fatigue", required=1.2, parts=_ENDS,
        capacity=lambda s: stud_fatigue_n(_SIZE, s.settings.parts.duty.jumps),
        formula="2 sigma_A A_s / F for the jumps of the duty",
        source="VDI 2230-1, 5.5.3, thread rolled before heat treatment",
        required_source="VDI 2230-1, 5.5.3: fatigue strength with 1 percent of failures; 1.2 is our own choice"),
    _row(name="turnbuckle_thread", required=1.5, parts=("turnbuckle_bar",),
        capacity=lambda s: strip_n(_SIZE, LEAST_ENGAGED, BAR.yield_mpa),
        formula="A_thread R_e / sqrt(3) / F at the long end of the travel",
        source="shear area of ISO 898-1, annex", required_source=_YIELD),
    _row(name="turnbuckle_bar", required=1.5, parts=("turnbuckle_bar",),
        capacity=lambda s: bar_n(BAR_WIDTH, BAR_FLAT, _SIZE, BAR.yield_mpa),
        formula="A R_e / F", source="tension, in the flat and beside the thread", required_source=_YIELD),
    _row(name="turnbuckle_fork", required=1.2, parts=_ENDS, capacity=_fork,
        formula="least of tension, bearing, shear of the pin and bending of the root, over F",
        source="straight beams: Roark's Formulas for Stress and Strain, chapter 8", required_source=_YIELD),
)  # fmt: skip
