"""Audits of the front: is each of its points a property of the design, or an accident of the simulation?"""

from collections.abc import Callable
from pathlib import Path

from pareto_monoped.design import NAMES
from pareto_monoped.study.reader import read_study
from pareto_monoped.study.simulator import Simulator
from pareto_monoped.study.store import Store

_CHUNK = 64
"""Designs audited and stored at a time: an interrupt loses no more than that."""


def audit_front(db: Path, store: Store, simulator: Simulator, notify: Callable[[str], None]) -> None:
    """Audit every design of the front that has no audit yet, and store the audits.

    What fails its audit leaves the front, and what it dominated comes up; so it goes on until all of the front is
    audited.
    """
    from pareto_monoped.jump.audit import audit

    while True:
        data = read_study(db)
        front = data.front()
        fresh = front[~front["trial"].isin(data.audits["trial"])]
        if len(fresh) == 0:
            return
        notify(f"auditing {len(fresh)} designs of the front")
        for first in range(0, len(fresh), _CHUNK):
            rows = fresh.iloc[first : first + _CHUNK]
            audits = audit(
                rows[list(NAMES)].to_numpy(),
                simulator.evaluator.actuator_map,
                simulator.calibration,
                workers=simulator.evaluator.workers,
            )
            columns = {name: values.tolist() for name, values in audits.as_columns().items()}
            good = columns.pop("well_conditioned")
            store.set_audits(
                [
                    (int(trial), bool(good[i]), {name: values[i] for name, values in columns.items()})
                    for i, trial in enumerate(rows["trial"])
                ]
            )
