"""Tightening of metric screws after VDI 2230-1 in its short form: preload, tightening torque, thread locking."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np

from pareto_monoped.errors import DesignError
from pareto_monoped.geometry.features import COARSE_PITCHES_MM
from pareto_monoped.geometry.roles import Purchase

YIELD_MPA: dict[str, float] = {"8.8": 640.0, "10.9": 940.0, "12.9": 1100.0}
"""0.2 % proof stress by property class (ISO 898-1, up to M16)."""
FRICTION = 0.12
"""Of thread and head: the middle of class B of VDI 2230-1, table A5, in which screws wet with a thread locker lie."""
_UTILISATION = {"cap": 0.9, "hexagon": 0.9, "countersunk": 0.75}
"""Share of the proof stress used (VDI 2230-1: 0.9). Countersunk heads carry 80 percent of a screw (ISO 10642) and their
key is smaller."""
_BEARING_SHARE = {"cap": 0.94, "countersunk": 0.94, "hexagon": 0.83}
"""Outer diameter of a head's bearing face over that of the head: M3 5.07 of 5.5 mm, M8 12.33 of 13 (ISO 4762). Over the
width across flats of a hexagon: M3 4.57 of 5.5 mm, M4 5.88 of 7 (ISO 4017)."""
_COUNTERSINK_RAD = 0.25 * np.pi
"""Half the angle of a countersunk head."""
LOCKER = "medium-strength thread locker"
LOCK = Purchase(
    kind="adhesive",
    designation="thread locker Loctite 243",
    remark="10 ml",
    standard="ISO 10964",
    alternatives=("WEICONLOCK AN 302-43",),
    unit="pack",
)
"""On every screw: jumps shake, and most grips are shorter than the three diameters that lock by themselves."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ThreadSize:
    """A metric coarse thread of a screw (ISO 724)."""

    diameter_mm: float  #: nominal
    pitch_mm: float

    @property
    def flank_diameter_mm(self) -> float:
        """d2."""
        diameter_mm: float = self.diameter_mm - 0.75 * np.tan(np.pi / 3.0) * 0.5 * self.pitch_mm
        return diameter_mm

    @property
    def core_diameter_mm(self) -> float:
        """d3."""
        diameter_mm: float = self.diameter_mm - 17.0 / 24.0 * np.sqrt(3.0) * self.pitch_mm
        return diameter_mm

    @property
    def stress_diameter_mm(self) -> float:
        """Of the circle with the stress area: mean of d2 and d3."""
        return 0.5 * (self.flank_diameter_mm + self.core_diameter_mm)

    @property
    def stress_area_mm2(self) -> float:
        """A_s (ISO 898-1)."""
        return 0.25 * np.pi * self.stress_diameter_mm**2

    @property
    def core_area_mm2(self) -> float:
        """A_d3."""
        return 0.25 * np.pi * self.core_diameter_mm**2


@lru_cache(maxsize=64)
def thread_size(diameter_mm: float) -> ThreadSize:
    """Return the coarse thread of a diameter, interpolated between standard ones for a user's motor."""
    sizes = sorted(COARSE_PITCHES_MM)
    if not sizes[0] <= diameter_mm <= sizes[-1]:
        raise DesignError(
            f"screw of {diameter_mm:g} mm: must be M{sizes[0]:g} to M{sizes[-1]:g}; choose another diameter"
        )
    pitch = np.interp(diameter_mm, sizes, [COARSE_PITCHES_MM[size] for size in sizes])
    return ThreadSize(diameter_mm=diameter_mm, pitch_mm=float(pitch))


@dataclass(frozen=True, slots=True, kw_only=True)
class Fastening:
    """How a screw is tightened and locked."""

    thread: ThreadSize  #: its size
    property_class: str  #: after ISO 898-1
    head: Literal["cap", "countersunk", "hexagon"]  #: shape of the head
    head_mm: float  #: outer diameter of the head, or width across flats of a hexagon
    hole_mm: float  #: diameter of the clearance hole
    lock: str = LOCKER  #: what keeps it from turning loose
    #: What the nut or the clamped parts allow, where that is less than the screw can give
    most_preload_n: float = np.inf

    @property
    def preload_n(self) -> float:
        """Assembly preload F_M at the share of the proof stress used (eq. R8/1), or what nut and parts allow."""
        thread = self.thread
        slope = thread.pitch_mm / (np.pi * thread.flank_diameter_mm) + 1.155 * FRICTION
        torsion = 1.5 * thread.flank_diameter_mm / thread.stress_diameter_mm * slope
        stress = _UTILISATION[self.head] * YIELD_MPA[self.property_class] / np.sqrt(1.0 + 3.0 * torsion**2)
        return min(float(stress * thread.stress_area_mm2), self.most_preload_n)

    @property
    def bearing_mm(self) -> float:
        """Outer diameter of the head's bearing face."""
        return _BEARING_SHARE[self.head] * self.head_mm

    @property
    def torque_n_m(self) -> float:
        """Tightening torque M_A for this preload (eq. R13/1); a cone's friction acts on its slanted face."""
        thread = self.thread
        under_head = 0.25 * (self.bearing_mm + self.hole_mm) * FRICTION
        if self.head == "countersunk":
            under_head /= np.sin(_COUNTERSINK_RAD)
        in_thread = 0.16 * thread.pitch_mm + 0.58 * thread.flank_diameter_mm * FRICTION
        return float(1e-3 * self.preload_n * (in_thread + under_head))
