"""Time of stage 1: the whole map of every motor, and one interval against a plain loop.

Run: python benchmarks/actuator_map.py
"""

import sys
import time
from collections.abc import Callable
from functools import partial
from importlib import import_module
from pathlib import Path

import numpy as np

from pareto_monoped.actuator.motors import load_motor, motor_names
from pareto_monoped.actuator.search import build_map, candidates
from pareto_monoped.actuator.settings import ActuatorSettings

sys.path.insert(0, str(Path(__file__).parent.parent))
REPEATS = 5


def seconds(action: Callable[[], object], repeats: int = REPEATS) -> tuple[float, float]:
    taken = []
    for _ in range(repeats):
        started = time.perf_counter()
        action()
        taken.append(time.perf_counter() - started)
    return float(np.median(taken)), max(taken)


def main() -> None:
    best_in = import_module("tests.actuator.loop").best_in
    settings = ActuatorSettings()
    print(f"{'motor':12} {'gearboxes':>9} {'median s':>9} {'worst s':>9}")
    total = 0.0
    for name in motor_names():
        motor = load_motor(name)
        found = build_map(motor, settings)
        middle, worst = seconds(partial(build_map, motor, settings))
        total += middle
        print(f"{name:12} {np.isfinite(found.masses_kg()).sum():9d} {middle:9.3f} {worst:9.3f}")
    print(f"{'all':12} {'':9} {total:9.3f}")

    motor = load_motor("VT8020")
    started = time.perf_counter()
    expected = best_in(motor, "ISSPG", 40, settings)
    slow = time.perf_counter() - started
    got = build_map(motor, settings).entries[0].families["ISSPG"].best
    assert expected is not None
    assert got is not None
    assert expected[1] == got.gears
    sets = len(np.asarray(candidates(79.0, settings).sun_teeth))
    print(f"plain loop, one interval of one family: {slow:.2f} s, same gear set; the search weighs {sets} sets at once")


if __name__ == "__main__":
    main()
