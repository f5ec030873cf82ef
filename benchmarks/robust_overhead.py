"""What a robust evaluation costs over the bare simulation of as many jumps, measured in pairs.

Every round simulates designs of a study's front under uncertainty, as ``robust`` does (samples, jumps, statistics and
storage, all from the database), and then as many jumps of the same designs as designed, by the batch evaluator alone.
The ratio is the median of the rounds' ratios of processor time. First the stored numbers of some designs are compared
with those of their samples simulated one after the other.

    python benchmarks/robust_overhead.py STUDY.db [DESIGNS] [ROUNDS]
"""

import shutil
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from pareto_monoped.analysis.robustness import robust
from pareto_monoped.compute.chunks import cores
from pareto_monoped.design import NAMES
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.simulator import stored_simulator
from pareto_monoped.uncertainty.samples import DEFAULT_SAMPLES, sobol_samples, variations
from pareto_monoped.uncertainty.settings import load_uncertainty

ALLOWED = 1.3
_COMPARED = 2


def main(source: Path, count: int, rounds: int) -> None:
    """Print one line per round, and the median."""
    with tempfile.TemporaryDirectory() as folder:
        db = Path(folder) / "study.db"
        shutil.copy(source, db)
        data, ranges = read_study(db), load_uncertainty()
        front = data.front()
        rows = front.iloc[np.unique(np.linspace(0, len(front) - 1, count).astype(int))]
        trials = [int(trial) for trial in rows["trial"]]
        evaluator = stored_simulator(data, workers=cores()).evaluator
        designs, kits = rows[list(NAMES)].to_numpy(dtype=np.float64), data.kit_numbers(rows)

        found = robust(db, ranges, trials=trials[:_COMPARED])
        drawn = sobol_samples(ranges, DEFAULT_SAMPLES)
        for k, result in enumerate(found.values()):
            built = variations(drawn, 1, data.calibration)
            jumps = evaluator(
                np.tile(designs[k], (DEFAULT_SAMPLES, 1)), np.repeat(kits[k], DEFAULT_SAMPLES), variations=built
            )
            if result.measures["height_m"].p05 != float(np.percentile(jumps.height_m[jumps.ok], 5.0)):
                raise SystemExit("a design has other numbers alone than among others: no ratio is printed")

        many, their_kits = np.repeat(designs, DEFAULT_SAMPLES, axis=0), np.repeat(kits, DEFAULT_SAMPLES)
        evaluator(designs, kits)
        print(f"{len(trials)} designs, {DEFAULT_SAMPLES} samples each, {len(many)} jumps")
        ratios = []
        for number in range(rounds):
            # Another seed each time, so that nothing is taken from the database.
            whole = _busy(partial(robust, db, ranges, trials=trials, seed=number + 2))
            bare = _busy(lambda: evaluator(many, their_kits))
            ratios.append(whole / bare)
            per_jump = [1e3 * seconds / len(many) for seconds in (whole, bare)]
            print(f"robust {per_jump[0]:.3f} ms per jump, bare {per_jump[1]:.3f} ms: {ratios[-1]:.3f}")
        ratio = statistics.median(ratios)
        word = "" if ratio <= ALLOWED else f", more than {ALLOWED:g}"
        print(f"median ratio {ratio:.3f}{word}")


def _busy(way: Callable[[], object]) -> float:
    """Processor time of one call, in all threads."""
    start = time.process_time()
    way()
    return time.process_time() - start


if __name__ == "__main__":
    given = sys.argv[1:]
    if not given:
        raise SystemExit(__doc__)
    main(Path(given[0]), int(given[1]) if len(given) > 1 else 60, int(given[2]) if len(given) > 2 else 3)
