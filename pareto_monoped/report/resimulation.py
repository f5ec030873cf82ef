"""What the report simulates again: the jumps along the front, and the paper's designs with the study's motor."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from pareto_monoped.design import PAPER_CASES, control_of, designs_of
from pareto_monoped.jump.laws import PAPER_LAW
from pareto_monoped.measures import MEASURE_NAMES
from pareto_monoped.report.packing import number
from pareto_monoped.report.schema import Case
from pareto_monoped.storage.reader import StudyData

if TYPE_CHECKING:
    from pareto_monoped.actuator.ratiomap import Maps
    from pareto_monoped.jump.calibration import Calibration
    from pareto_monoped.jump.frames import Recording

MOST_FRAMES, LEAST_FRAMES = 56, 16
"""Moments of a jump that the page keeps: as many as a chart can show, or enough to see the motion."""
JUMPS_BYTES = 2_400_000
"""What all jumps of a page may take, so that a page with a front of 5,000 designs stays within 8 MB. More designs than
``LEAST_FRAMES`` allows (some 12,500) take more."""
_BYTES, _BYTES_PER_FRAME = 110.0, 5.1
"""What one jump takes, as measured on a front of 38 designs with 16 to 56 frames. Designs of larger fronts resemble
each other, and their jumps are deflated together: 25 and 1.9 on a front of 3,333."""


def frames_for(jumps: int) -> int:
    """Return how many moments of each jump a page has: fewer where there are many jumps, so that it stays small."""
    room = JUMPS_BYTES / max(jumps, 1)
    return int(np.clip((room - _BYTES) / _BYTES_PER_FRAME, LEAST_FRAMES, MOST_FRAMES))


@dataclass(frozen=True, slots=True, kw_only=True)
class Resimulation:
    """What one study needs beyond its database."""

    jumps: Mapping[int, "Recording"]  #: of designs on the front, by trial number
    cases: Sequence[Case]  #: the paper's designs, with ``StudyData.case_kit``
    case_jumps: Mapping[int, "Recording"]  #: of those that jump, by place among them
    frames: int  #: of each jump
    drift_m: float  #: largest difference between a stored height and the height simulated now


def resimulate(
    data: StudyData, *, most_jumps: int | None = None, frames: int = MOST_FRAMES, workers: int = 1
) -> Resimulation:
    """Simulate the front's jumps, or at most ``most_jumps`` spread evenly and the knee, and the paper's designs."""
    front = data.front()
    rows = front if most_jumps is None else front.iloc[_chosen(front, data, most_jumps)]
    jumps: dict[int, Recording] = {}
    for kit, places in data.kit_rows(rows):
        members = rows.iloc[places]
        made = jumps_of(designs_of(members), kit, data.calibration, frames, workers)
        jumps |= of_trials(members, made)
    numbers = rows["trial"].astype(int).tolist()
    heights = zip(numbers, rows["height_m"].tolist(), strict=True)
    cases, case_jumps = paper_cases(data.case_kit, data.calibration.under(PAPER_LAW))
    return Resimulation(
        jumps={trial: jumps[trial] for trial in numbers if trial in jumps},
        cases=cases,
        case_jumps=case_jumps,
        frames=frames,
        # A design that no longer jumps is off by all of its height.
        drift_m=max((abs(_height_m(jumps, trial) - height) for trial, height in heights), default=0.0),
    )


def of_trials(trials: pd.DataFrame, made: "Sequence[Recording | None]") -> "dict[int, Recording]":
    """Return the jumps of some trials by their numbers, without those that have none."""
    numbers = trials["trial"].astype(int).tolist()
    return {trial: jump for trial, jump in zip(numbers, made, strict=True) if jump is not None}


def _height_m(jumps: Mapping[int, "Recording"], trial: int) -> float:
    return jumps[trial].height_m if trial in jumps else 0.0


def _chosen(front: pd.DataFrame, data: StudyData, most: int) -> list[int]:
    """Return positions on the front of at most ``most`` designs spread evenly over it, and of the knee."""
    from pareto_monoped.pareto.pick import pick
    from pareto_monoped.pareto.selectors import Knee

    chosen = set(_spread(len(front), most)) if most else set()
    if len(front) and most:
        knee = pick(front, Knee(), data.study.objectives).trial
        chosen.add(int(np.flatnonzero(front["trial"] == knee)[0]))
    return sorted(chosen)


def _spread(n: int, most: int) -> list[int]:
    """Return at most ``most`` positions spread evenly over ``n``, both ends among them."""
    return sorted(set(np.linspace(0, n - 1, min(n, most)).round().astype(int).tolist())) if n else []


def jumps_of(
    designs: NDArray[np.float64], maps: "Maps", calibration: "Calibration", frames: int = MOST_FRAMES, workers: int = 1
) -> "list[Recording | None]":
    """Return jumps of designs that can stand, shape (n, variables), each in a few frames; None without an apex."""
    from pareto_monoped.jump.frames import recordings
    from pareto_monoped.robot.population import robot_arrays

    if len(designs) == 0:
        return []
    robots, control = robot_arrays(designs, maps, calibration.mass), control_of(designs)
    return recordings(robots, control, calibration, frames, workers)


def paper_cases(maps: "Maps", calibration: "Calibration") -> "tuple[list[Case], dict[int, Recording]]":
    """Return the paper's designs, simulated, and the jumps of those that jump, by place among them."""
    from pareto_monoped.jump.evaluate import Evaluator

    designs = np.array([case.design.as_array() for case in PAPER_CASES.values()])
    result = Evaluator(maps, calibration)(designs)
    places = np.flatnonzero(result.ok).tolist()
    made = zip(places, jumps_of(designs[result.ok], maps, calibration), strict=True)
    cases = [
        Case(
            name=name,
            status=str(result.status[i]),
            reason=result.reason[i],
            height_m=number(result.height_m[i]),
            energy_j=number(result.energy_j[i]),
            mass_kg=number(result.mass_kg[i]),
            measures={name: number(getattr(result, name)[i]) for name in MEASURE_NAMES},
        )
        for i, name in enumerate(PAPER_CASES)
    ]
    return cases, {place: jump for place, jump in made if jump is not None}
