"""Stored studies and a robust front by the compiled engine, against MuJoCo's jumps of the same designs on all cores.

The study is the whole command: search, storage, audits, and MuJoCo's jump of every design of the front. Against it
stand the bare steps of MuJoCo for the designs that it found, without measures, strength and storage. The robust front
is stored, too; against it stand MuJoCo's jumps of the same designs and samples. No ratio is printed unless heights
agree within 1e-6 m. Times are by the clock, so that the machine must be quiet.

    python benchmarks/engine_studies.py                  # 4,000 jumps, 12 designs
    python benchmarks/engine_studies.py 20000 60
"""

import sys
import tempfile
import time
import tomllib
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from pareto_monoped.actuator.search import map_for
from pareto_monoped.analysis.robustness import robust
from pareto_monoped.compute.chunks import cores
from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.design import NAMES, PAPER_CASES, Floats, control_of
from pareto_monoped.jump.calibration import Calibration, load_calibration
from pareto_monoped.jump.engines import population_of
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.model import start_pose
from pareto_monoped.robot.population import robot_arrays
from pareto_monoped.storage.reader import StudyData, read_study
from pareto_monoped.study.run import run
from pareto_monoped.uncertainty.samples import DEFAULT_SAMPLES, sobol_samples, variations
from pareto_monoped.uncertainty.settings import load_uncertainty

MAIN_JOB = tomllib.loads((Path(__file__).parents[1] / "studies" / "case_c.toml").read_text(encoding="utf-8"))
AGREEMENT_M = 1e-6
_PART = 500  # jumps of one call of MuJoCo's engine, whose models take memory


def main(jumps: int, designs: int) -> None:
    """Print a row per algorithm, and one for the robust front."""
    by_mujoco = load_calibration("reference").by("mujoco")
    for calibration in (by_mujoco, load_calibration("reference")):  # what is compiled is not to be timed
        Evaluator(map_for("VT8020"), calibration)(PAPER_CASES["C"].design.as_array())
    print("| | by the compiled engine, s | MuJoCo's jumps, s | ratio |")
    print("|---|---:|---:|---:|")
    with tempfile.TemporaryDirectory() as folder:
        for name, least in (("nsga2", 1.5), ("surrogate", 0.9)):
            db = Path(folder) / f"{name}.db"
            study = study_from_dict(MAIN_JOB | {"evaluations": jumps, "algorithm": {"name": name}}, source=name)
            whole_s = timed(partial(run, study, db))
            data = read_study(db)
            bare_s = timed(partial(bare, data, by_mujoco))
            print(
                f"| `{name}`, {jumps} stored jumps | {whole_s:.1f} | {bare_s:.1f} | {bare_s / whole_s:.2f} ({least}) |"
            )
        print(robust_row(db, read_study(db), by_mujoco, designs))


def timed(work: Callable[[], object]) -> float:
    """Return the seconds that ``work`` takes by the clock."""
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


def bare(data: StudyData, by_mujoco: Calibration) -> None:
    """Step all designs of a study by MuJoCo, and compare the heights of those that jumped."""
    designs, maps = data.trials[list(NAMES)].to_numpy(dtype=np.float64), data.kits[0]
    heights_m = []
    for first in range(0, len(designs), _PART):
        part = designs[first : first + _PART]
        robots, control = robot_arrays(part, maps, by_mujoco.mass), control_of(part)
        population = population_of(robots, control, start_pose(robots, by_mujoco), by_mujoco, cores())
        population.run()
        heights_m.append(population.records["height_m"])
    require_equal(
        np.concatenate(heights_m), data.trials["height_m"].to_numpy(), (data.trials["status"] == "ok").to_numpy()
    )


def robust_row(db: Path, data: StudyData, by_mujoco: Calibration, count: int) -> str:
    """Return the row of the robust front."""
    front = data.front()
    rows = front.iloc[np.unique(np.linspace(0, len(front) - 1, count).astype(int))]
    ranges = load_uncertainty()
    whole_s = timed(lambda: robust(db, ranges, trials=rows["trial"].tolist()))
    drawn = sobol_samples(ranges.where(stand=False), DEFAULT_SAMPLES)
    evaluator = Evaluator(data.kits[0], by_mujoco, cores())
    compiled = Evaluator(data.kits[0], data.calibration, cores())
    designs = rows[list(NAMES)].to_numpy(dtype=np.float64)
    built = variations(drawn, 1, data.calibration)

    def by_engine(engine: Evaluator) -> list[tuple[Floats, NDArray[np.bool_]]]:
        found = [engine(np.tile(design, (DEFAULT_SAMPLES, 1)), variations=built) for design in designs]
        return [(one.height_m, one.ok) for one in found]

    theirs: list[tuple[Floats, NDArray[np.bool_]]] = []
    bare_s = timed(lambda: theirs.extend(by_engine(evaluator)))
    for (height_m, ok), (other_m, other_ok) in zip(by_engine(compiled), theirs, strict=True):
        require_equal(height_m, other_m, ok & other_ok)
    return (
        f"| robust front of {len(rows)} designs, {DEFAULT_SAMPLES} samples | {whole_s:.1f} | {bare_s:.1f} | "
        f"{bare_s / whole_s:.2f} (6) |"
    )


def require_equal(one_m: Floats, other_m: Floats, counts: NDArray[np.bool_]) -> None:
    """End without a ratio where heights differ."""
    apart_m = float(np.max(np.abs(one_m[counts] - other_m[counts])))
    if apart_m > AGREEMENT_M:
        raise SystemExit(f"heights differ by {apart_m:.2g} m: no ratio is printed")


if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:])) if sys.argv[1:] else main(4_000, 12)
