"""The short answer of a study: the paper's best design beside the designs of the front that compete with it."""

import contextlib
from dataclasses import dataclass

from pareto_monoped.design import PAPER_CASES
from pareto_monoped.errors import SelectionError
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.pareto.pick import pick
from pareto_monoped.pareto.selectors import MinHeight
from pareto_monoped.study.reader import StudyData

CASE = PAPER_CASES["C"]
"""The case of Table I in which all variables are free, as in the study of the main job."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Competitor:
    """One line of the comparison: a design in words, and its jump."""

    label: str
    height_m: float
    energy_j: float


def headline(data: StudyData, knee_trial: int) -> tuple[Competitor, ...]:
    """The paper's design as published and simulated with the study's motor and calibration, then the front's designs.

    Args:
        data: the study.
        knee_trial: number of the trial at the knee of the front.

    Returns:
        Four designs. The front's design that reaches the height of the paper's is left out if there is none.
    """
    several = len(data.study.kits) > 1
    evaluations = Evaluator(data.case_kit, data.calibration)(CASE.design.as_array())
    simulated = Competitor(
        label=f"paper's Case {CASE.name}, simulated here" + (f" with {data.case_kit.label}" if several else ""),
        height_m=float(evaluations.height_m[0]),
        energy_j=float(evaluations.energy_j[0]),
    )
    front, objectives = data.front(), data.study.objectives
    chosen = []
    with contextlib.suppress(SelectionError):
        wanted = MinHeight(height_m=simulated.height_m)
        chosen.append(("front: at least that height", pick(front, wanted, objectives).trial))
    chosen.append(("front: knee", knee_trial))
    jumps = front.set_index("trial")
    return (
        Competitor(label=f"paper's Case {CASE.name}, as published", height_m=CASE.height_m, energy_j=CASE.energy_j),
        simulated,
        *(
            Competitor(
                label=f"{label}, trial {trial}" + (f", {jumps.loc[trial, 'motor']}" if several else ""),
                height_m=float(jumps.loc[trial, "height_m"]),
                energy_j=float(jumps.loc[trial, "energy_j"]),
            )
            for label, trial in chosen
        ),
    )
