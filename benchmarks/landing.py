"""Loads of jump and landing, and hops, of the paper's four cases with parts of today; the tables of docs/landing.md.

python benchmarks/landing.py [STUDY.db] [--hops N]

With a stored study, also whether designs of its front survive their landings.
"""

import argparse
from pathlib import Path

import numpy as np

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import NAMES, PAPER_CASES, complete, control_of
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.landing import best_landed, hops, landed
from pareto_monoped.jump.variations import take
from pareto_monoped.measures import measure
from pareto_monoped.robot.population import robot_arrays
from pareto_monoped.storage.reader import read_study
from pareto_monoped.strength.groups import REQUIRED_MEASURES

LOADS = (
    *("peak_gear_torque_hip_n_m", "peak_gear_torque_knee_n_m", "peak_chain_tension_n", "peak_stop_torque_n_m"),
    *("peak_foot_force_n", "peak_knee_force_n"),
)


DESIGNS = 60  #: Of a front, evenly spread; our own choice: a few seconds.


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--hops", type=int, default=30)
    parser.add_argument("db", type=Path, nargs="?", help="a stored study")
    given = parser.parse_args()
    designs = complete(np.array([case.design.as_array() for case in PAPER_CASES.values()]))
    maps, calibration = map_for("VT8020"), load_calibration("reference")
    jumps, found = Evaluator(maps, calibration)(designs), landed(designs, maps, calibration)
    print(f"| jump / landing | {' | '.join(PAPER_CASES)} |")
    print("|---|" + "---|" * len(PAPER_CASES))
    for name in LOADS:
        one = measure(name)
        pairs = zip(getattr(jumps, name), getattr(found, f"landing_{name}"), strict=True)
        cells = [f"{jump:.{one.decimals}f} / {land:.{one.decimals}f}" for jump, land in pairs]
        print(f"| {one.label}, {one.unit} | {' | '.join(cells)} |")
    held = np.min([getattr(jumps, name) for name in REQUIRED_MEASURES], axis=0)
    cells = [f"{jump:.2f} / {land:.2f}" for jump, land in zip(held, found.landing_safety, strict=True)]
    print(f"| least safety over the required one | {' | '.join(cells)} |")
    best = best_landed(designs, maps, calibration)
    print(f"| the same by the best landing tried | {' | '.join(f'{value:.2f}' for value in best.landing_safety)} |")
    print()
    print("| case | fall, m | taken up by the motors, J | fed back, J | time to rest, s |")
    print("|---|---|---|---|---|")
    for k, case in enumerate(PAPER_CASES):
        numbers = (found.landing_fall_m[k], found.landing_absorbed_j[k], found.landing_returned_j[k])
        print(f"| {case} | {' | '.join(f'{value:.2f}' for value in (*numbers, found.landing_time_s[k]))} |")
    print()
    if given.db:
        front = read_study(given.db).front()[list(NAMES)].to_numpy(dtype=np.float64)
        some = np.linspace(0, len(front) - 1, DESIGNS).round().astype(int)
        of_front = landed(front[some], maps, calibration)
        safety = of_front.landing_safety
        print("| designs of the front | survive their landing | least safety over the required one |\n|---|---|---|")
        tried = f"{len(some)} of {len(front)} | {np.count_nonzero(of_front.landing_ok)}"
        print(f"| {tried} | {safety.min():.2f} to {safety.max():.2f} |\n")
    print("| case | first / steady height, m | steady from hop | energy, J | from the battery, J | hops per minute |")
    print("|---|---|---|---|---|---|")
    robots, control = robot_arrays(designs, maps, calibration.mass), control_of(designs)
    for k, case in enumerate(PAPER_CASES):
        made = hops(take(robots, np.array([k])), control[k : k + 1], calibration, given.hops)
        heights = f"{made.height_m[0]:.3f} / {made.height_m[-1]:.3f}"
        energies = f"{made.energy_j[-1]:.1f} | {made.electrical_energy_j[-1]:.0f}"
        print(f"| {case} | {heights} | {made.steady_from} | {energies} | {made.hops_per_minute:.1f} |")


if __name__ == "__main__":
    main()
