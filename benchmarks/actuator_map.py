"""Time of stage 1: the whole map of every motor under both sets of rules, and one interval against a plain loop.

It is processor time, so that other processes disturb it little. The two sets of rules take turns, so that the ratio of
their times is that of the same moment.

Run: python benchmarks/actuator_map.py
"""

import sys
import time
from collections.abc import Callable
from functools import partial
from importlib import import_module
from pathlib import Path

import numpy as np

from pareto_monoped.actuator.judge import candidates
from pareto_monoped.actuator.motors import load_motor, motor_names
from pareto_monoped.actuator.search import build_map
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.design import RULE_SETS

sys.path.insert(0, str(Path(__file__).parent.parent))
REPEATS = 7


def seconds(action: Callable[[], object]) -> float:
    started = time.process_time()
    action()
    return time.process_time() - started


def main() -> None:
    best_in = import_module("tests.actuator.loop").best_in
    settings = ActuatorSettings(rules="paper")
    chosen = {rules: ActuatorSettings(rules=rules) for rules in RULE_SETS}
    print(f"{'':12} {'gearboxes':^17} {'median s':^17} {'worst s':^17} {'ratio':>7}")
    print(f"{'motor':12}" + 3 * "".join(f" {rules:>8}" for rules in RULE_SETS) + f" {'median':>7}")
    totals = np.zeros(len(RULE_SETS))
    for name in motor_names():
        motor = load_motor(name)
        counts = [np.isfinite(build_map(motor, chosen[rules]).masses_kg()).sum() for rules in RULE_SETS]
        taken = np.array(
            [[seconds(partial(build_map, motor, chosen[rules])) for rules in RULE_SETS] for _ in range(REPEATS)]
        )
        middle, worst = np.median(taken, axis=0), taken.max(axis=0)
        totals += middle
        cells = [f"{count:8d}" for count in counts] + [f"{value:8.3f}" for value in (*middle, *worst)]
        print(f"{name:12} {' '.join(cells)} {np.median(taken[:, 1] / taken[:, 0]):7.2f}")
    print(f"{'all':12} {'':17} {totals[0]:8.3f} {totals[1]:8.3f}")

    motor = load_motor("VT8020")
    started = time.process_time()
    expected = best_in(motor, "ISSPG", 40, settings)
    slow = time.process_time() - started
    got = build_map(motor, settings).entries[0].families["ISSPG"].best
    assert expected is not None
    assert got is not None
    assert expected[1] == got.gears
    sets = len(np.asarray(candidates(79.0, settings).sun_teeth))
    print(f"plain loop, one interval of one family: {slow:.2f} s, same gear set; the search weighs {sets} sets at once")


if __name__ == "__main__":
    main()
