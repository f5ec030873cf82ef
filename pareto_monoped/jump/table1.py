"""The paper's Table I beside the same designs simulated here."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.jump.audit import perturbed
from pareto_monoped.jump.calibration import Calibration, load_calibration
from pareto_monoped.jump.evaluate import Evaluator

PERTURBATIONS = 100  #: Copies per case, the design itself among them.


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """Height and energy of a jump."""

    height_m: float
    energy_j: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread(Result):
    """Medians over the perturbed copies of a design that jump, with percentiles; all are NaN if no copy jumps.

    Rounding may decide a single jump of the literal model, so only their distribution means anything.
    """

    #: height_p05_m, height_p95_m, energy_p05_j, energy_p95_j: percentiles
    height_p05_m: float
    height_p95_m: float
    energy_p05_j: float
    energy_p95_j: float
    jumped_share: float  #: share of the copies that jump


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One case of Table I: as published, and simulated under the calibrations ``paper`` and ``reference``."""

    case: str
    published: Result
    paper: Spread
    reference: Result

    def as_dict(self) -> dict[str, Any]:
        """Return the row as nested dicts of plain values."""
        return asdict(self)


def table1(paper_map: ActuatorMap, reference_map: ActuatorMap, *, workers: int = 1, seed: int = 0) -> tuple[Row, ...]:
    """Return the four cases of Table I, with the gearboxes of the paper's motor for ``paper`` and ``reference``."""
    spreads = paper_spreads(paper_map, load_calibration("paper"), workers=workers, seed=seed)
    designs = np.array([case.design.as_array() for case in PAPER_CASES.values()])
    reference = Evaluator(reference_map, load_calibration("reference"), workers)(designs)
    return tuple(
        Row(
            case=case.name,
            published=Result(height_m=case.height_m, energy_j=case.energy_j),
            paper=spreads[k],
            reference=Result(height_m=float(reference.height_m[k]), energy_j=float(reference.energy_j[k])),
        )
        for k, case in enumerate(PAPER_CASES.values())
    )


def paper_spreads(
    actuator_map: ActuatorMap,
    calibration: Calibration,
    *,
    perturbations: int = PERTURBATIONS,
    workers: int = 1,
    seed: int = 0,
) -> tuple[Spread, ...]:
    """Return medians and percentiles of the four cases, of which each has copies changed by up to 1e-6 and itself."""
    designs = np.array([case.design.as_array() for case in PAPER_CASES.values()])
    copies = perturbed(designs, perturbations, np.random.default_rng(seed))
    copies[::perturbations] = designs
    evaluations = Evaluator(actuator_map, calibration, workers)(copies)
    height = evaluations.height_m.reshape(len(designs), perturbations)
    energy = evaluations.energy_j.reshape(len(designs), perturbations)
    result = []
    for k in range(len(designs)):
        jumped = np.isfinite(height[k])
        percentiles = np.full((3, 2), np.nan)
        if jumped.any():
            percentiles = np.percentile(np.stack([height[k][jumped], energy[k][jumped]], axis=1), [5, 50, 95], axis=0)
        (low_h, low_e), (mid_h, mid_e), (high_h, high_e) = percentiles.tolist()
        result.append(
            Spread(
                height_m=mid_h,
                energy_j=mid_e,
                height_p05_m=low_h,
                height_p95_m=high_h,
                energy_p05_j=low_e,
                energy_p95_j=high_e,
                jumped_share=float(jumped.mean()),
            )
        )
    return tuple(result)
