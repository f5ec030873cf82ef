"""What a run stores in one transaction."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.jump.evaluate import Evaluations
from pareto_monoped.study.scoring import Judgement


@dataclass(frozen=True, slots=True, kw_only=True)
class Generation:
    """A simulated generation, or the part of it that one session simulated.

    Attributes:
        number: of the generation.
        first_trial: number of the first of these trials.
        designs: shape (n, number of variables).
        evaluations, judgement: of these designs.
        height_weight: weight of the first objective in a weighted search; None for other searches.
        state: the algorithm's state once it knows the scores of the whole generation; None while some are missing.
        hypervolume: of all trials up to here.
        seconds: running time up to here, over all sessions.
        started, ended: when these designs were simulated.
        motors: coordinate that chooses a motor -> name of each design's; empty where the study has no such choice.
    """

    number: int
    first_trial: int
    designs: NDArray[np.float64]
    evaluations: Evaluations
    judgement: Judgement
    height_weight: float | None
    state: Mapping[str, Any] | None
    hypervolume: float
    seconds: float
    started: datetime
    ended: datetime
    motors: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
