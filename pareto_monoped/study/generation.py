"""What a run stores at a time."""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.jump.evaluate import Evaluations
from pareto_monoped.study.scoring import Judgement


@dataclass(frozen=True, slots=True, kw_only=True)
class Generation:
    """What one transaction stores.

    Attributes:
        number: of the generation.
        first_trial: number of its first trial here.
        designs: shape (n, 7).
        evaluations, judgement: of these designs.
        height_weight: of a weighted search.
        state: the algorithm's state after it has been told the whole generation; None while part of it is missing.
        hypervolume: of all trials so far.
        seconds: running time so far, over all sessions.
        started, ended: when the generation was simulated.
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
