"""The default search and NSGA-II on standard test problems, whose landscapes are not those of a jump.

    python benchmarks/search_landscapes.py                              # a short look: two problems, two seeds
    python benchmarks/search_landscapes.py --full                       # all problems, five seeds
    python benchmarks/search_landscapes.py --only osy zdt4 --seeds 21 30

Problems and hypervolume are pymoo's. Quality is the hypervolume of all designs evaluated so far as a share of that of
the best known front: the true one, where pymoo computes it or it is written here, joined with all that was found.
"""

import argparse
import statistics
import warnings
from unittest.mock import patch

import moocore
import numpy as np
from numpy.typing import NDArray
from pymoo.indicators.hv import HV
from pymoo.problems import get_problem
from pymoo.util.remote import Remote

from pareto_monoped.definition.algorithms import EvolutionSettings, SurrogateSettings
from pareto_monoped.pareto.objectives import Objectives
from pareto_monoped.search.algorithm import Algorithm, Scores, Space
from pareto_monoped.search.evolution import Evolution
from pareto_monoped.search.surrogate import SurrogateSearch

Floats = NDArray[np.float64]
# Names of measures that are minimised, for the problems' objectives.
NAMES = ("energy_j", "mass_kg", "peak_foot_force_n")
# Problem -> arguments of get_problem, corner of the hypervolume: a little beyond the true front where a search comes
# near it, far off where it does not. The first eight are those that the search was developed on.
PROBLEMS: dict[str, tuple[dict[str, int], tuple[float, ...]]] = {
    "osy": ({}, (0.0, 100.0)),
    "zdt3": ({}, (1.1, 1.1)),
    "zdt4": ({}, (1.1, 100.0)),
    "kursawe": ({}, (-13.0, 2.0)),
    "dtlz2": ({"n_var": 11, "n_obj": 2}, (1.1, 1.1)),
    "dtlz2-3": ({"n_var": 12, "n_obj": 3}, (1.1, 1.1, 1.1)),
    "mw7": ({}, (1.5, 1.5)),
    "zdt6": ({}, (1.1, 10.0)),
    "srn": ({}, (250.0, 10.0)),
    "tnk": ({}, (1.2, 1.2)),
    "bnh": ({}, (140.0, 50.0)),
    "mw1": ({}, (1.5, 1.5)),
    "c2dtlz2": ({"n_var": 11, "n_obj": 2}, (1.1, 1.1)),
    "wfg4": ({"n_var": 10, "n_obj": 2}, (2.3, 4.5)),
    "wfg5": ({"n_var": 10, "n_obj": 2}, (2.3, 4.5)),
    "dtlz7": ({"n_var": 11, "n_obj": 2}, (1.1, 4.4)),
}
CONTENDERS: dict[str, SurrogateSettings | EvolutionSettings] = {
    "surrogate": SurrogateSettings(name="surrogate"),
    "nsga2-40": EvolutionSettings(name="nsga2", population=40),
    "nsga2-100": EvolutionSettings(name="nsga2", population=100),
}


def osy_front() -> Floats:
    """Designs of the true front of OSY: five segments (Deb 2001, figure 235)."""
    t, zero, one = np.linspace(0.0, 1.0, 2000), np.zeros(2000), np.ones(2000)
    first = 4.056 + 0.944 * t
    segments = (
        (5.0 * one, one, 1.0 + 4.0 * t, zero, 5.0 * one, zero),
        (5.0 * one, one, 1.0 + 4.0 * t, zero, one, zero),
        (first, (first - 2.0) / 3.0, one, zero, one, zero),
        (zero, 2.0 * one, 1.0 + 2.732 * t, zero, one, zero),
        (t, 2.0 - t, one, zero, one, zero),
    )
    return np.vstack([np.column_stack(segment) for segment in segments])


def algorithm(contender: str, space: Space, seed: int) -> Algorithm:
    """A search of the space."""
    settings = CONTENDERS[contender]
    if isinstance(settings, SurrogateSettings):
        return SurrogateSearch(space, settings, seed)
    return Evolution(space, settings, seed)


def search(name: str, contender: str, seed: int, evaluations: int) -> Floats:
    """Objectives of all feasible designs that a search finds, shape (n, m)."""
    problem = get_problem(name.split("-")[0], **PROBLEMS[name][0])
    objectives, ones = Objectives(names=NAMES[: problem.n_obj]), np.ones(problem.n_var)
    space = Space(
        names=tuple(f"x{k}" for k in range(problem.n_var)),
        lower=problem.xl * ones,
        upper=problem.xu * ones,
        objectives=objectives,
    )
    one, found, total = algorithm(contender, space, seed), [], 0
    while total < evaluations and (proposal := one.ask()) is not None:
        values = proposal.values
        points, missed = problem.evaluate(values, return_values_of=["F", "G"])
        violation = np.maximum(missed, 0.0).sum(axis=1)
        one.tell(Scores(objectives=objectives, values=points, violation=violation, constraints=missed))
        found.append(points[: evaluations - total][violation[: evaluations - total] == 0.0])
        total += len(values)
    return np.vstack(found)


def known(name: str) -> list[Floats]:
    """The true front, if pymoo computes it or it is written here."""
    problem = get_problem(name.split("-")[0], **PROBLEMS[name][0])
    if name == "osy":
        return [problem.evaluate(osy_front(), return_values_of=["F"])]
    if name.startswith("wfg"):  # a quarter of an ellipse; pymoo draws points of it at random
        angle = np.linspace(0.0, 0.5 * np.pi, 2000)
        return [np.column_stack((2.0 * np.sin(angle), 4.0 * np.cos(angle)))]
    with warnings.catch_warnings(), patch.object(Remote, "load", side_effect=OSError("equal with and without network")):
        warnings.simplefilter("ignore")
        try:
            front = problem.pareto_front()
        except OSError:  # a front that pymoo would fetch
            return []
    return [] if front is None or front.shape[1] != problem.n_obj else [front]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--full", action="store_true", help="all problems, seeds 11 to 15")
    parser.add_argument("--only", nargs="+", choices=PROBLEMS, help="these problems alone")
    parser.add_argument("--seeds", nargs=2, type=int, metavar=("FIRST", "LAST"))
    parser.add_argument("--evaluations", type=int, default=1000)
    given = parser.parse_args()
    first, last = given.seeds or ((11, 15) if given.full else (1, 2))
    print(f"| problem | {' | '.join(CONTENDERS)} |\n|---|{'---|' * len(CONTENDERS)}")
    for name in given.only or (PROBLEMS if given.full else ("osy", "zdt4")):
        volume = HV(ref_point=np.array(PROBLEMS[name][1]))
        found = {
            one: [search(name, one, seed, given.evaluations) for seed in range(first, last + 1)] for one in CONTENDERS
        }
        points = np.vstack([*known(name), *(front for fronts in found.values() for front in fronts)])
        whole = volume(moocore.filter_dominated(points))
        cells = []
        for fronts in found.values():
            shares = [100.0 * volume(front) / whole if len(front) else 0.0 for front in fronts]
            cells.append(f"{statistics.median(shares):.1f} ({min(shares):.1f} to {max(shares):.1f})")
        print(f"| {name} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
