"""Audits of a study's front: whether each point is a property of its design or an accident of the simulation."""

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pandas as pd

from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.design import NAMES
from pareto_monoped.study.reader import StudyData, read_study
from pareto_monoped.study.simulator import Simulator
from pareto_monoped.study.store import Store

_CHUNK = 64
"""Designs that are audited and stored together; an interrupt loses at most this many audits."""


def audit_front(db: Path, store: Store, simulator: Simulator, notify: Callable[[str], None]) -> None:
    """Audit every design on the front that has no audit yet, and store the audits.

    A design that fails its audit leaves the front, and designs that it dominated may enter. The audit therefore
    repeats until every design on the front has passed. It is a brief one: ``simulate --audit`` makes the full one.
    """
    from pareto_monoped.jump.audit import ONLY_IN_FULL, Jumps, audit

    while True:
        data = read_study(db)
        front = data.front()
        fresh = front[~front["trial"].isin(data.audits["trial"])]
        if len(fresh) == 0:
            return
        notify(f"auditing {len(fresh)} designs of the front")
        for actuator_map, rows in _chunks(data, fresh):
            audits = audit(
                rows[list(NAMES)].to_numpy(),
                actuator_map,
                simulator.calibration,
                workers=simulator.evaluator.workers,
                known=Jumps(
                    status=rows["status"].to_numpy(dtype=np.str_),
                    height_m=rows["height_m"].to_numpy(dtype=np.float64),
                    energy_j=rows["energy_j"].to_numpy(dtype=np.float64),
                ),
                brief=True,
            )
            columns = {
                name: values.tolist() for name, values in audits.as_columns().items() if name not in ONLY_IN_FULL
            }
            good = columns.pop("well_conditioned")
            store.set_audits(
                [
                    (int(trial), bool(good[i]), {name: values[i] for name, values in columns.items()})
                    for i, trial in enumerate(rows["trial"])
                ]
            )


def _chunks(data: StudyData, trials: pd.DataFrame) -> Iterator[tuple[ActuatorMap, pd.DataFrame]]:
    """Trials that are audited together, all with the same motor, and the gearboxes of that motor."""
    for actuator_map, places in data.motor_rows(trials):
        for first in range(0, len(places), _CHUNK):
            yield actuator_map, trials.iloc[places[first : first + _CHUNK]]
