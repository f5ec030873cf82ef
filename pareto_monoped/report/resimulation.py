"""What the report simulates again: the jumps along the front, and the paper's designs with the study's motor."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import CONTROL, NAMES, PAPER_CASES, columns
from pareto_monoped.measures import MEASURE_NAMES
from pareto_monoped.report.rounding import number
from pareto_monoped.report.schema import Case, Jump
from pareto_monoped.study.reader import StudyData

if TYPE_CHECKING:
    from pareto_monoped.actuator.joint_maps import Maps
    from pareto_monoped.jump.calibration import Calibration

FRAMES = 56
"""Moments of a jump that the page keeps."""
MOST_JUMPS = 60
"""Jumps that the page keeps of a front; if it has more designs, these are spread evenly over it."""

COUNTS: Mapping[str, float] = {
    "time_s": 1e-4,
    "base_x_m": 1e-4,
    "base_z_m": 1e-4,
    "foot_z_m": 1e-4,
    "hip_rad": 1e-4,
    "knee_rad": 1e-4,
    "hip_rad_per_s": 1e-2,
    "knee_rad_per_s": 1e-2,
    "hip_motor_torque_n_m": 1e-2,
    "knee_motor_torque_n_m": 1e-2,
    "contact_z_n": 1e-1,
}
"""Columns of a jump's trace that the page keeps as whole numbers, and the value of one count."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Resimulation:
    """What one study needs beyond its database.

    Attributes:
        jumps: of designs on the front, by trial number.
        cases: the paper's designs, with ``StudyData.case_kit``.
        drift_m: largest difference between a stored height and the height simulated now.
    """

    jumps: Mapping[int, Jump]
    cases: Sequence[Case]
    drift_m: float


def resimulate(data: StudyData, *, most_jumps: int = MOST_JUMPS) -> Resimulation:
    """Simulate what the page shows of a study beyond its database."""
    from pareto_monoped.pareto.pick import Knee, pick

    front = data.front()
    chosen = set(_spread(len(front), most_jumps))
    if len(front):
        knee = pick(front, Knee(), data.study.objectives).trial
        chosen.add(int(np.flatnonzero(front["trial"] == knee)[0]))
    rows = front.iloc[sorted(chosen)]
    jumps: dict[int, Jump] = {}
    for kit, places in data.kit_rows(rows):
        members = rows.iloc[places]
        made = jumps_of(members[list(NAMES)].to_numpy(dtype=np.float64), kit, data.calibration)
        jumps |= zip(members["trial"].astype(int).tolist(), made, strict=True)
    heights = zip(rows["trial"].astype(int), rows["height_m"], strict=True)
    return Resimulation(
        jumps={trial: jumps[trial] for trial in rows["trial"].astype(int)},
        cases=paper_cases(data.case_kit, data.calibration),
        drift_m=max((abs(jumps[trial].height_m - height) for trial, height in heights), default=0.0),
    )


def _spread(n: int, most: int) -> list[int]:
    """At most ``most`` positions spread evenly over ``n``, both ends among them."""
    return sorted(set(np.linspace(0, n - 1, min(n, most)).round().astype(int).tolist())) if n else []


def jumps_of(designs: NDArray[np.float64], maps: "Maps", calibration: "Calibration") -> list[Jump]:
    """Jumps of designs that can stand, shape (n, number of variables), each in a few frames."""
    from pareto_monoped.jump.rows import take
    from pareto_monoped.jump.single import trace_of
    from pareto_monoped.robot.population import robot_arrays

    if len(designs) == 0:
        return []
    robots, control = robot_arrays(designs, maps, calibration.mass), columns(designs, CONTROL)
    return [
        in_few_frames(trace_of(take(robots, np.array([i])), control[i : i + 1], calibration))
        for i in range(len(designs))
    ]


def in_few_frames(trace: Mapping[str, NDArray[np.float64]], frames: int = FRAMES) -> Jump:
    """A trace at ``frames`` moments, two thirds of them before lift-off, when most of the motion takes place.

    Args:
        trace: columns of ``jump.single.TRACE_COLUMNS``, shape (steps,).
        frames: how many.
    """
    time = trace["time_s"]
    touching = np.flatnonzero(trace["contact_z_n"] > 0.0)
    last = int(touching[-1]) if len(touching) else 0
    stance = 2 * frames // 3
    wanted = np.concatenate((np.linspace(0, last, stance), np.linspace(last, len(time) - 1, frames - stance + 1)[1:]))
    rows = np.unique(wanted.round().astype(int))
    counts = {
        name: np.round(np.nan_to_num(trace[name][rows]) / size).astype(int).tolist() for name, size in COUNTS.items()
    }
    return Jump(height_m=float(trace["base_z_m"].max()), lift_off_s=float(time[last]), columns=counts, scale=COUNTS)


def paper_cases(maps: "Maps", calibration: "Calibration") -> list[Case]:
    """The paper's designs, simulated."""
    from pareto_monoped.jump.evaluate import Evaluator

    designs = np.array([case.design.as_array() for case in PAPER_CASES.values()])
    result = Evaluator(maps, calibration)(designs)
    jumps = iter(jumps_of(designs[result.ok], maps, calibration))
    return [
        Case(
            name=name,
            status=str(result.status[i]),
            reason=result.reason[i],
            height_m=number(result.height_m[i]),
            energy_j=number(result.energy_j[i]),
            mass_kg=number(result.mass_kg[i]),
            measures={name: number(getattr(result, name)[i]) for name in MEASURE_NAMES},
            jump=next(jumps) if result.ok[i] else None,
        )
        for i, name in enumerate(PAPER_CASES)
    ]
