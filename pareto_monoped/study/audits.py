"""Audits of a study's front: whether each point is a property of its design or an accident of the simulation."""

from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from pareto_monoped.actuator.ratiomap import JointMaps
from pareto_monoped.design import designs_of
from pareto_monoped.storage.place import StudyPlace
from pareto_monoped.storage.reader import StudyData, read_study
from pareto_monoped.storage.store import Store
from pareto_monoped.study.simulator import Simulator

if TYPE_CHECKING:
    from pareto_monoped.jump.audit import Jumps

_SCREENED, _AUDITED = 256, 64
"""Designs that are screened together, and of these audited and stored together; an interrupt loses at most these."""


def audit_front(db: StudyPlace, store: Store, simulator: Simulator, notify: Callable[[str], None]) -> None:
    """Audit every design on the front that has no audit yet, and store the audits.

    A design that fails its audit leaves the front, and designs that it dominated may enter, so the audit repeats until
    every design on the front has passed.
    """
    while True:
        data = read_study(db)
        front = data.front()
        fresh = front[~front["trial"].isin(data.audits["trial"])]
        if len(fresh) == 0:
            return
        notify(f"auditing {len(fresh)} designs of the front")
        audit_trials(data, fresh, store, simulator)


def audit_trials(data: StudyData, trials: pd.DataFrame, store: Store, simulator: Simulator) -> None:
    """Audit trials of a study, and store the audits.

    MuJoCo makes every jump again, whatever engine the study has (``audit.judge``). For most designs one coarse jump
    shows that they pass the rest (``jump.screen``). The others have a brief audit: ``simulate --audit`` makes the full
    one.
    """
    from pareto_monoped.jump.audit import ONLY_IN_FULL, audit, judge
    from pareto_monoped.jump.screen import screened
    from pareto_monoped.jump.variations import take

    calibration, workers, executor = simulator.calibration, simulator.evaluator.workers, simulator.evaluator.executor
    for kit, rows in _chunks(data, trials):
        known, designs = _known(rows), _designs(rows)
        found = screened(designs, kit, calibration, known, workers=workers, executor=executor)
        judged = judge(designs, kit, calibration, known, workers=workers, executor=executor)
        clear = found.clear & judged.clear(known)
        columns = {k: values[clear] for k, values in (found.as_columns() | judged.as_columns()).items()}
        _store(store, rows[clear], np.ones(clear.sum(), dtype=bool), columns | {"reason": np.full(clear.sum(), "")})
        unclear = np.flatnonzero(~clear)
        for first in range(0, len(unclear), _AUDITED):
            places = unclear[first : first + _AUDITED]
            part = rows.iloc[places]
            audits = audit(
                designs[places],
                kit,
                calibration,
                workers=workers,
                executor=executor,
                known=take(known, places),
                judged=take(judged, places),
                brief=True,
            ).as_columns()
            good = audits.pop("well_conditioned")
            _store(store, part, good, {name: audits[name] for name in audits if name not in ONLY_IN_FULL})


def _designs(rows: pd.DataFrame) -> NDArray[np.float64]:
    return designs_of(rows)


def _known(rows: pd.DataFrame) -> "Jumps":
    """Return the jumps of trials, which need not be simulated again."""
    from pareto_monoped.jump.audit import Jumps

    return Jumps(
        status=rows["status"].to_numpy(dtype=np.str_),
        height_m=rows["height_m"].to_numpy(dtype=np.float64),
        energy_j=rows["energy_j"].to_numpy(dtype=np.float64),
    )


def _store(
    store: Store, rows: pd.DataFrame, good: NDArray[np.generic], columns: Mapping[str, NDArray[np.generic]]
) -> None:
    """Store the audits of trials: the verdicts, shape (n,), and columns of measures, each of shape (n,)."""
    if len(rows):
        values = {name: column.tolist() for name, column in columns.items()}
        store.set_audits(
            [
                (int(trial), bool(good[i]), {name: column[i] for name, column in values.items()})
                for i, trial in enumerate(rows["trial"])
            ]
        )


def _chunks(data: StudyData, trials: pd.DataFrame) -> Iterator[tuple[JointMaps, pd.DataFrame]]:
    """Yield trials that are screened together, all with the same motors, and the gearboxes of these motors."""
    for kit, places in data.kit_rows(trials):
        for first in range(0, len(places), _SCREENED):
            yield kit, trials.iloc[places[first : first + _SCREENED]]
