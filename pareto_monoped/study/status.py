"""Progress and settings of a study."""

from typing import Any

from pareto_monoped.design import HEADLINE_HEIGHT_M
from pareto_monoped.pareto.at_height import best_at_height
from pareto_monoped.pareto.indicators import hypervolume
from pareto_monoped.study.lock import holder
from pareto_monoped.study.place import StudyPlace
from pareto_monoped.study.summary import read_summary


def status(db: StudyPlace) -> dict[str, Any]:
    """Progress and settings of a study, as JSON values.

    Raises:
        DatabaseError: not a study, damaged, or of a newer version.
    """
    data = read_summary(db)
    objectives, done, seconds = data.study.objectives, sum(data.counts.values()), data.seconds
    high = data.energies_j[data.heights_m >= HEADLINE_HEIGHT_M]
    best = best_at_height(data.front, objectives)
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
        **data.counts,
        "wall_time_s": seconds,
        "evaluations_per_second": done / seconds if seconds > 0.0 else None,
        "front": len(data.front),
        "ill_conditioned": data.ill_conditioned,
        "foreign": data.foreign,
        "hypervolume": hypervolume(data.front, data.study.reference_point),
        "hypervolume_unit": objectives.volume_unit,
        "objectives": objectives.directions,
        "reference_point": data.study.reference_point.as_dict(),
        "least_energy_at_0_8_m_j": float(high.min()) if len(high) else None,
        "best_at_0_8_m": None if best is None else {best.measure.name: best.value},
        "hash": data.meta.hash,
        "versions": data.meta.versions,
        "created": data.meta.created,
        "strength": data.study.strength,
        "settings": data.study.as_dict(),
    }
