"""Pick one design from the front and say why."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pandas import DataFrame

from pareto_monoped.errors import SelectionError


@dataclass(frozen=True, slots=True, kw_only=True)
class MinHeight:
    """The design of least energy that jumps at least ``height_m``."""

    height_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class MaxEnergy:
    """The design with the highest jump on at most ``energy_j``."""

    energy_j: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Knee:
    """The knee of the front: the design farthest from the chord between its two ends."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Weights:
    """The design with the best weighted sum of height and energy, each scaled to the extent of the front."""

    height: float
    energy: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """The trial with this number."""

    number: int


Selector = MinHeight | MaxEnergy | Knee | Weights | Trial


@dataclass(frozen=True, slots=True, kw_only=True)
class Pick:
    """A picked trial and the reason in one sentence."""

    trial: int
    why: str


def pick(front: DataFrame, selector: Selector) -> Pick:
    """Pick the design of ``front`` that ``selector`` asks for.

    Args:
        front: one row per design, in any order, with the columns ``trial, height_m, energy_j``.
        selector: which design.

    Raises:
        SelectionError: the front is empty, or none of its designs fits.
    """
    if len(front) == 0:
        raise SelectionError(
            "front: has 0 designs, at least 1 is needed to pick from; run the study longer or relax its constraints"
        )
    rows = front.sort_values("height_m", kind="stable")
    trials = rows["trial"].to_numpy()
    height_m = rows["height_m"].to_numpy(dtype=np.float64)
    energy_j = rows["energy_j"].to_numpy(dtype=np.float64)
    match selector:
        case MinHeight(height_m=wanted):
            row, why = _min_height(height_m, energy_j, wanted)
        case MaxEnergy(energy_j=allowed):
            row, why = _max_energy(height_m, energy_j, allowed)
        case Knee():
            row, why = _knee(height_m, energy_j)
        case Weights():
            row, why = _weights(height_m, energy_j, selector)
        case Trial(number=number):
            found = np.flatnonzero(trials == number)
            if len(found) == 0:
                raise SelectionError(
                    f"trial = {number}: must be on the front, which has trials {_listed(trials)}; pick one of them"
                )
            row, why = int(found[0]), "asked for by its number"
    return Pick(
        trial=int(trials[row]),
        why=f"trial {int(trials[row])} ({height_m[row]:.3f} m on {energy_j[row]:.2f} J): {why}",
    )


def _min_height(height_m: NDArray[np.float64], energy_j: NDArray[np.float64], wanted: float) -> tuple[int, str]:
    high_enough = np.flatnonzero(height_m >= wanted)
    if len(high_enough) == 0:
        raise SelectionError(
            f"min-height = {wanted:g} m: must be at most {height_m.max():.4f} m, the front's highest jump; "
            "ask for less, or run the study longer"
        )
    row = int(high_enough[np.argmin(energy_j[high_enough])])
    return row, f"the least energy of the {len(high_enough)} designs on the front that reach {wanted:g} m"


def _max_energy(height_m: NDArray[np.float64], energy_j: NDArray[np.float64], allowed: float) -> tuple[int, str]:
    cheap_enough = np.flatnonzero(energy_j <= allowed)
    if len(cheap_enough) == 0:
        raise SelectionError(
            f"max-energy = {allowed:g} J: must be at least {energy_j.min():.4f} J, the front's cheapest jump; "
            "allow more, or run the study longer"
        )
    row = int(cheap_enough[np.argmax(height_m[cheap_enough])])
    return row, f"the highest jump of the {len(cheap_enough)} designs on the front that need at most {allowed:g} J"


def _knee(height_m: NDArray[np.float64], energy_j: NDArray[np.float64]) -> tuple[int, str]:
    """Das 1999 (On characterizing the "knee" of the Pareto curve): the greatest distance from the chord.

    With both objectives scaled to the extent of the front, the chord runs from (0, 0) to (1, 1). The distance of a
    point from it, positive towards more height and less energy, is (height - energy) / sqrt 2.
    """
    distance = (_scaled(height_m) - _scaled(energy_j)) / np.sqrt(2.0)
    row = int(np.argmax(distance))
    if len(height_m) < 3:
        return row, f"the front has only {len(height_m)} design(s), so its knee is an end of it"
    return row, (
        f"the knee, farthest ({distance[row]:.3f} of the scaled front) from the chord between the front's ends "
        f"{height_m[0]:.3f} m at {energy_j[0]:.2f} J and {height_m[-1]:.3f} m at {energy_j[-1]:.2f} J"
    )


def _weights(height_m: NDArray[np.float64], energy_j: NDArray[np.float64], weights: Weights) -> tuple[int, str]:
    pair = (weights.height, weights.energy)
    if not (np.isfinite(pair).all() and min(pair) >= 0.0 and sum(pair) > 0.0):
        raise SelectionError(
            f"weights = {weights.height:g},{weights.energy:g}: must be two finite numbers of at least 0, not both 0; "
            "give for example 1,1"
        )
    value = weights.height * _scaled(height_m) - weights.energy * _scaled(energy_j)
    row = int(np.argmax(value))
    return row, (
        f"the best weighted sum, {weights.height:g} x height - {weights.energy:g} x energy = {value[row]:.3f}, "
        "both scaled to the front's extent"
    )


def _scaled(values: NDArray[np.float64]) -> NDArray[np.float64]:
    extent = float(values.max() - values.min())
    return (values - values.min()) / extent if extent > 0.0 else np.zeros_like(values)


def _listed(trials: NDArray[np.int64], most: int = 8) -> str:
    shown = ", ".join(str(int(trial)) for trial in sorted(trials)[:most])
    return shown if len(trials) <= most else f"{shown}, ... ({len(trials)} in all)"
