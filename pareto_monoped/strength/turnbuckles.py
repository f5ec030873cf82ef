"""The turnbuckles of the chain: studs, threads, bars and forks under the chain's pull.

The pull swells from slack once a jump, in the strand that stops the knee's rotor. A stud, which its locknut holds
against its bar, then has the amplitude of half the pull.
"""

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
from pareto_monoped.materials import ALLOYS
from pareto_monoped.strength.joint import LegJoint, Structure

BAR, FORK = ALLOYS["aw_7075_t6"], ALLOYS["c45_qt"]
_SHEAR = 1.0 / np.sqrt(3.0)  # yield in shear over that in tension (von Mises)
_LIMIT_CYCLES = 2e6  # N_D of VDI 2230-1
_LEAST_CYCLES = 1e4  # below, VDI 2230-1 gives no fatigue strength


def stud_yield_n(diameter_mm: float, yield_mpa: float) -> float:
    """Pull at which a thread's stress area yields."""
    return thread_size(diameter_mm).stress_area_mm2 * yield_mpa


def stud_fatigue_n(diameter_mm: float, cycles: float) -> float:
    """Swelling pull that a thread rolled before heat treatment bears so often (VDI 2230-1, 5.5.3).

    The amplitude is 0.85 (150 / d + 45) MPa for two million cycles, and more by the cube root for fewer.
    """
    amplitude_mpa = 0.85 * (150.0 / diameter_mm + 45.0)
    amplitude_mpa *= (_LIMIT_CYCLES / min(max(cycles, _LEAST_CYCLES), _LIMIT_CYCLES)) ** (1.0 / 3.0)
    force_n: float = 2.0 * amplitude_mpa * thread_size(diameter_mm).stress_area_mm2
    return force_n


def strip_n(diameter_mm: float, engaged_mm: float, yield_mpa: float) -> float:
    """Pull at which a tapped thread yields in shear on the screw's outer diameter (area after ISO 898-1, annex)."""
    thread = thread_size(diameter_mm)
    width = 0.5 * thread.pitch_mm + (diameter_mm - thread.flank_diameter_mm) * np.tan(np.pi / 6.0)
    area = np.pi * diameter_mm * width * engaged_mm / thread.pitch_mm
    return float(area * _SHEAR * yield_mpa)


def bar_n(width_mm: float, flat_mm: float, diameter_mm: float, yield_mpa: float) -> float:
    """Pull at which a square bar yields in its flat middle or beside its thread."""
    beside = width_mm**2 - 0.25 * np.pi * diameter_mm**2
    return float(min(width_mm * flat_mm, beside) * yield_mpa)


def fork_n(half_mm: float, cheek_mm: float, pin_mm: float, slot_mm: float, root_mm: float, yield_mpa: float) -> float:
    """Pull at which a fork yields: its cheeks beside the pin, under the pin, the pin itself, or its root.

    The root is a beam with the pull in its middle, clamped by the cheeks: its moment is F l / 8 over the distance l of
    their middles.

    Args:
        half_mm: half width of cheeks and root.
        cheek_mm: thickness of a cheek.
        pin_mm: diameter of the pin.
        slot_mm: width between the cheeks.
        root_mm: thickness of the root.
        yield_mpa: of fork and pin.
    """
    beside = 2.0 * cheek_mm * (2.0 * half_mm - pin_mm) * yield_mpa
    under = 2.0 * cheek_mm * pin_mm * yield_mpa
    pin = 2.0 * 0.25 * np.pi * pin_mm**2 * _SHEAR * yield_mpa
    root = 8.0 / (slot_mm + cheek_mm) * 2.0 * half_mm * root_mm**2 / 6.0 * yield_mpa
    return float(min(beside, under, pin, root))


def _fork(s: Structure) -> float:
    chain = s.leg.chain
    root = FORK_ROOT - FORK_BOTTOM
    return fork_n(HALF_FORK, CHEEK, chain.pin_diameter_mm, chain.inner_link_mm, root, FORK.yield_mpa)


_SIZE = 2.0 * THREAD.shank
_ENDS = ("turnbuckle_end_hip", "turnbuckle_end_knee")
_YIELD = "our own choice against yield, for a pull that is measured"

JOINTS = tuple(
    LegJoint(
        name=name,
        group="chain",
        formula=formula,
        source=source,
        required=required,
        required_source=reason,
        loads=("peak_chain_tension_n",),
        capacity=capacity,
        parts=parts,
        cure="release the knee's torque before its stop, a lower knee_ratio, or a motor of less torque",
    )
    for name, formula, source, required, reason, capacity, parts in (
        (
            "turnbuckle_stud",
            "A_s R_e / F",
            "stress area of ISO 898-1",
            1.5,
            _YIELD,
            lambda s: stud_yield_n(_SIZE, FORK.yield_mpa),
            _ENDS,
        ),
        (
            "turnbuckle_fatigue",
            "2 sigma_A A_s / F for the jumps of the duty",
            "VDI 2230-1, 5.5.3, thread rolled before heat treatment",
            1.2,
            "VDI 2230-1, 5.5.3: fatigue strength with 1 percent of failures; 1.2 is our own choice",
            lambda s: stud_fatigue_n(_SIZE, s.settings.parts.duty.jumps),
            _ENDS,
        ),
        (
            "turnbuckle_thread",
            "A_thread R_e / sqrt(3) / F at the long end of the travel",
            "shear area of ISO 898-1, annex",
            1.5,
            _YIELD,
            lambda s: strip_n(_SIZE, LEAST_ENGAGED, BAR.yield_mpa),
            ("turnbuckle_bar",),
        ),
        (
            "turnbuckle_bar",
            "A R_e / F",
            "tension, in the flat and beside the thread",
            1.5,
            _YIELD,
            lambda s: bar_n(BAR_WIDTH, BAR_FLAT, _SIZE, BAR.yield_mpa),
            ("turnbuckle_bar",),
        ),
        (
            "turnbuckle_fork",
            "least of tension, bearing, shear of the pin and bending of the root, over F",
            "straight beams: Roark's Formulas for Stress and Strain, chapter 8",
            1.2,
            _YIELD,
            _fork,
            _ENDS,
        ),
    )
)
