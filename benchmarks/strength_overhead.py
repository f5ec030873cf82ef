"""What the strength check costs the batch evaluator, measured in pairs.

Every round evaluates a population, and then computes the safety factors of the same population alone, from the loads of
its jumps. The share is the median of the rounds' ratios of processor time. The factors of the population are first
compared with those of its members one by one.

    python benchmarks/strength_overhead.py [ROUNDS]
"""

import statistics
import sys
import time
from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import LOWER, NAMES, UPPER, complete
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.strength.factors import TABLE, capacities, safeties, strength_factors
from pareto_monoped.strength.joint import LOAD_NAMES, Loads, loads_of

Floats = NDArray[np.float64]

ALLOWED = 0.03
"""Of the evaluator's time."""


def main(rounds: int) -> None:
    """Print one line per batch size: time per jump, time of its factors, and the share."""
    actuators = map_for("VT8020")
    evaluator = Evaluator(actuators, load_calibration("reference"))
    start = time.perf_counter()
    capacities(actuators)
    print(f"{len(TABLE)} joints; their capacities take {time.perf_counter() - start:.2f} s once per actuator map")

    def factors_of(designs: Floats, loads: Loads) -> object:
        return safeties(strength_factors(designs, actuators, loads))

    print(f"{'batch':>6} {'us/jump':>9} {'us/factors':>11} {'share':>8}")
    for size in (8, 40, 200):
        designs = complete(np.random.default_rng(size).uniform(LOWER, UPPER, (size, len(LOWER))))
        columns = dict(zip(NAMES, designs.T, strict=True)) | evaluator(designs).as_columns()
        loads = loads_of({name: columns[name] for name in LOAD_NAMES})
        factors = strength_factors(designs, actuators, loads)
        for i in range(size):
            one = {name: loads[name][i : i + 1] for name in LOAD_NAMES}
            if not np.array_equal(strength_factors(designs[i : i + 1], actuators, one)[0], factors[i]):
                raise SystemExit("a design has other factors alone than in its batch: no share is printed")
        pairs = [
            (
                _busy(partial(evaluator, designs)),
                _busy(partial(factors_of, designs, loads)),
            )
            for _ in range(rounds)
        ]
        share = statistics.median(alone / whole for whole, alone in pairs)
        whole, alone = (1e6 * statistics.median(times) / size for times in zip(*pairs, strict=True))
        word = "" if share <= ALLOWED else f"  more than {100 * ALLOWED:g} %"
        print(f"{size:6d} {whole:9.1f} {alone:11.2f} {100 * share:7.3f} %{word}")


def _busy(way: Callable[[], object]) -> float:
    """Processor time of one call."""
    start = time.process_time()
    way()
    return time.process_time() - start


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 15)
