"""Progress and settings of a study."""

from pathlib import Path
from typing import Any

from pareto_monoped.design import HEADLINE_HEIGHT_M
from pareto_monoped.pareto.indicators import hypervolume
from pareto_monoped.study.lock import holder
from pareto_monoped.study.reader import read_study


def status(db: Path) -> dict[str, Any]:
    """Progress and settings of a study, as JSON values.

    Raises:
        DatabaseError: not a study, damaged, or of a newer version.
    """
    data = read_study(db)
    front = data.front()
    states = data.trials["state"]
    done, seconds = len(data.trials), data.wall_time_s
    high = front[front["height_m"] >= HEADLINE_HEIGHT_M]
    running = holder(db)
    return {
        "name": data.study.name,
        "database": str(db),
        "motor": data.meta.motor,
        "calibration": data.meta.calibration,
        "algorithm": data.study.algorithm.name,
        "seed": data.study.seed,
        "free": list(data.study.free),
        "state": "running" if running else "finished" if data.meta.finished else "unfinished",
        "process": running,
        "stop_reason": data.meta.stop_reason,
        "evaluations": done,
        "budget": data.meta.budget,
        "feasible": int((states == "feasible").sum()),
        "infeasible": int((states == "infeasible").sum()),
        "failed": int((states == "failed").sum()),
        "wall_time_s": seconds,
        "evaluations_per_second": done / seconds if seconds > 0.0 else None,
        "front": len(front),
        "ill_conditioned": len(data.ill_conditioned),
        "hypervolume": hypervolume(front[["height_m", "energy_j"]].to_numpy(), data.reference_point),
        "reference_point": {"height_m": data.reference_point.height_m, "energy_j": data.reference_point.energy_j},
        "least_energy_at_0_8_m_j": float(high["energy_j"].iloc[0]) if len(high) else None,
        "hash": data.meta.hash,
        "versions": data.meta.versions,
        "created": data.meta.created,
        "settings": data.study.as_dict(),
    }
