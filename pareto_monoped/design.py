"""The design variables, their bounds, and the designs of the paper's Table I.

Order and symbols are those of the paper (section III-B): Y = [l1, l2, g_k, g_h, K, C, T].
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pareto_monoped.errors import DesignError, complaint


@dataclass(frozen=True, slots=True, kw_only=True)
class Variable:
    """One design variable.

    Attributes:
        name: its name in files, flags, databases and code.
        symbol: the paper's symbol.
        unit: of its values and bounds.
        lower, upper: the paper's bounds (section III-B).
        meaning: what it is, in a few words.
    """

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
"""The names of all variables; the order of the columns of every array of designs."""
LENGTHS = ("thigh_length_m", "shank_length_m")
RATIOS = ("knee_ratio", "hip_ratio")
CONTROL = ("stiffness_n_per_m", "damping_n_s_per_m", "torsional_stiffness_n_m_per_rad")
"""K, C and T of the virtual controller."""
LOWER: NDArray[np.float64] = np.array([variable.lower for variable in VARIABLES])
UPPER: NDArray[np.float64] = np.array([variable.upper for variable in VARIABLES])
LOWER.flags.writeable = False
UPPER.flags.writeable = False


def columns(designs: ArrayLike, names: Sequence[str]) -> NDArray[np.float64]:
    """The values of some variables.

    Args:
        designs: shape (..., number of variables), in the order of ``NAMES``.
        names: which variables, such as ``CONTROL``.

    Returns:
        A C-ordered copy, shape (..., len(names)), in the order of ``names``.
    """
    return np.take(np.asarray(designs, dtype=np.float64), [NAMES.index(name) for name in names], axis=-1)


@dataclass(frozen=True, slots=True, kw_only=True)
class Design:
    """One design: a value for each variable, in the order of ``NAMES``."""

    thigh_length_m: float
    shank_length_m: float
    knee_ratio: float
    hip_ratio: float
    stiffness_n_per_m: float
    damping_n_s_per_m: float
    torsional_stiffness_n_m_per_rad: float

    def as_array(self) -> NDArray[np.float64]:
        """The values in the order of ``NAMES``, shape (number of variables,)."""
        return np.array([getattr(self, name) for name in NAMES], dtype=np.float64)

    def as_dict(self) -> dict[str, float]:
        """The values by name."""
        return {name: getattr(self, name) for name in NAMES}

    @classmethod
    def from_array(cls, values: ArrayLike) -> "Design":
        """A design from its values in the order of ``NAMES``.

        Raises:
            DesignError: a wrong number of values, or a value that is not finite.
        """
        array = np.asarray(values, dtype=np.float64)
        shape = (len(NAMES),)
        if array.shape != shape:
            raise DesignError(
                complaint("shape of a design", array.shape, str(shape), f"give {', '.join(NAMES)} in this order")
            )
        design = cls(**dict(zip(NAMES, array.tolist(), strict=True)))
        for name, value in design.as_dict().items():
            if not np.isfinite(value):
                raise DesignError(complaint(name, value, "a finite number", "give a number"))
        return design

    def replace(self, changes: Mapping[str, float]) -> "Design":
        """A copy with some variables changed.

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
    """One row of the paper's Table I.

    Attributes:
        name: of the row, as the paper has it.
        design: its variables.
        height_m, energy_j: what the authors report for it.
        free: the variables that the paper's optimisation could change (section IV-B).
    """

    name: str
    design: Design
    height_m: float
    energy_j: float
    free: tuple[str, ...]


def _case(name: str, values: tuple[float, ...], height_m: float, energy_j: float, free: tuple[str, ...]) -> PaperCase:
    return PaperCase(name=name, design=Design.from_array(values), height_m=height_m, energy_j=energy_j, free=free)


# Table I of the paper. The paper prints g_h before g_k; here the values stand in the order of NAMES.
PAPER_CASES: Mapping[str, PaperCase] = {
    "nominal": _case("nominal", (0.400, 0.400, 6.0, 6.0, 50.0, 2.5, 10.0), 0.887, 31.44, ()),
    "A": _case("A", (0.400, 0.400, 7.9, 4.0, 13.7, 6.5, 46.5), 0.743, 15.51, RATIOS + CONTROL),
    "B": _case("B", (0.499, 0.346, 6.0, 6.0, 8.9, 1.0, 6.9), 0.771, 17.02, LENGTHS + CONTROL),
    "C": _case("C", (0.490, 0.360, 6.0, 4.0, 7.9, 2.2, 8.4), 0.800, 15.36, LENGTHS + RATIOS + CONTROL),
}
PAPER_MOTOR = "VT8020"
"""The motor of all rows of Table I; the default wherever a motor may be named."""
HEADLINE_HEIGHT_M = PAPER_CASES["C"].height_m
"""Height at which the least energy of a front is quoted, 0.8 m: that of the paper's best design, Case C."""
BASE_START_HEIGHT_M = 0.5
"""Height of the base above the floor at rest (paper, section IV-B)."""
GRAVITY_M_PER_S2 = 9.81
"""The default of MuJoCo, also used for the paper's m g."""
