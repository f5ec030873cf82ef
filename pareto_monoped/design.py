"""The seven design variables, their bounds, and the paper's four designs.

Order and symbols are the paper's (section III-B): Y = [l1, l2, g_k, g_h, K, C, T].
"""

from collections.abc import Mapping
from dataclasses import astuple, dataclass, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pareto_monoped.errors import DesignError, complaint


@dataclass(frozen=True, slots=True, kw_only=True)
class Variable:
    """One design variable: its name everywhere, the paper's symbol, unit and bounds (section III-B), and what it is."""

    name: str
    symbol: str
    unit: str
    lower: float
    upper: float
    meaning: str


VARIABLES: tuple[Variable, ...] = (
    Variable(
        name="thigh_length_m", symbol="l1", unit="m", lower=0.3, upper=0.5, meaning="thigh, hip axis to knee axis"
    ),
    Variable(
        name="shank_length_m", symbol="l2", unit="m", lower=0.3, upper=0.5, meaning="shank, knee axis to foot centre"
    ),
    Variable(
        name="knee_ratio", symbol="g_k", unit="1", lower=4.0, upper=8.7, meaning="gear ratio of the knee actuator"
    ),
    Variable(name="hip_ratio", symbol="g_h", unit="1", lower=4.0, upper=8.7, meaning="gear ratio of the hip actuator"),
    Variable(name="stiffness_n_per_m", symbol="K", unit="N/m", lower=5.0, upper=200.0, meaning="virtual spring"),
    Variable(name="damping_n_s_per_m", symbol="C", unit="N s/m", lower=0.0, upper=10.0, meaning="virtual damper"),
    Variable(
        name="torsional_stiffness_n_m_per_rad",
        symbol="T",
        unit="N m/rad",
        lower=0.0,
        upper=50.0,
        meaning="virtual torsional spring",
    ),
)
NAMES: tuple[str, ...] = tuple(variable.name for variable in VARIABLES)
LOWER: NDArray[np.float64] = np.array([variable.lower for variable in VARIABLES])
UPPER: NDArray[np.float64] = np.array([variable.upper for variable in VARIABLES])
LOWER.flags.writeable = False
UPPER.flags.writeable = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Design:
    """One design: a value for each of the seven variables, in the paper's order."""

    thigh_length_m: float
    shank_length_m: float
    knee_ratio: float
    hip_ratio: float
    stiffness_n_per_m: float
    damping_n_s_per_m: float
    torsional_stiffness_n_m_per_rad: float

    def as_array(self) -> NDArray[np.float64]:
        """The seven values, shape (7,), in the order of ``NAMES``."""
        return np.array(astuple(self), dtype=np.float64)

    def as_dict(self) -> dict[str, float]:
        """The seven values by name."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    @classmethod
    def from_array(cls, values: ArrayLike) -> "Design":
        """A design from seven values in the order of ``NAMES``.

        Raises:
            DesignError: not exactly seven finite numbers.
        """
        array = np.asarray(values, dtype=np.float64)
        if array.shape != (len(NAMES),):
            raise DesignError(
                complaint("shape of a design", array.shape, "(7,)", f"give {', '.join(NAMES)} in this order")
            )
        design = cls(**dict(zip(NAMES, array.tolist(), strict=True)))
        for name, value in design.as_dict().items():
            if not np.isfinite(value):
                raise DesignError(complaint(name, value, "a finite number", "give a number"))
        return design

    def replace(self, changes: Mapping[str, float]) -> "Design":
        """A copy with some variables set.

        Raises:
            DesignError: an unknown name or a value that is not finite.
        """
        for name in changes:
            if name not in NAMES:
                raise DesignError(complaint("design variable", name, f"one of {', '.join(NAMES)}", "correct the name"))
        merged = self.as_dict() | dict(changes)
        return Design.from_array([merged[name] for name in NAMES])


@dataclass(frozen=True, slots=True, kw_only=True)
class PaperCase:
    """One row of the paper's Table I: the design with the height and energy the authors report."""

    name: str
    design: Design
    height_m: float
    energy_j: float
    free: tuple[str, ...]
    """Which variables the paper's optimisation was free to change (section IV-B)."""


def _case(name: str, values: tuple[float, ...], height_m: float, energy_j: float, free: tuple[str, ...]) -> PaperCase:
    return PaperCase(name=name, design=Design.from_array(values), height_m=height_m, energy_j=energy_j, free=free)


_LENGTHS = NAMES[0:2]
_RATIOS = NAMES[2:4]
_CONTROL = NAMES[4:7]

# Table I of the paper; the table prints g_h before g_k, here they stand in the order of NAMES.
PAPER_CASES: Mapping[str, PaperCase] = {
    "nominal": _case("nominal", (0.400, 0.400, 6.0, 6.0, 50.0, 2.5, 10.0), 0.887, 31.44, ()),
    "A": _case("A", (0.400, 0.400, 7.9, 4.0, 13.7, 6.5, 46.5), 0.743, 15.51, _RATIOS + _CONTROL),
    "B": _case("B", (0.499, 0.346, 6.0, 6.0, 8.9, 1.0, 6.9), 0.771, 17.02, _LENGTHS + _CONTROL),
    "C": _case("C", (0.490, 0.360, 6.0, 4.0, 7.9, 2.2, 8.4), 0.800, 15.36, _LENGTHS + _RATIOS + _CONTROL),
}
BASE_START_HEIGHT_M = 0.5
"""Height of the base above the floor at rest (paper, section IV-B)."""
GRAVITY_M_PER_S2 = 9.81
"""Standard value used by MuJoCo's default option and the paper's m g."""
