"""The process of a campaign that runs a study and reports its progress, and ends with its coordinator."""

import warnings
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pareto_monoped.compute.processes import asked_to_stop, say
from pareto_monoped.definition.study import Study


@dataclass(frozen=True, slots=True, kw_only=True)
class Advanced:
    """A study has stored another generation; fields as of ``study.session.Progress``."""

    evaluations: int
    per_second: float
    seconds_left: float
    hypervolume: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Noted:
    """A line of a study for the user."""

    line: str
    shared: bool = False  #: Whether it is about scheduler and workers, of which every study hears the same.


@dataclass(frozen=True, slots=True, kw_only=True)
class Ended:
    """A study has ended, or has stopped as it was told to; fields as of ``study.run.RunSummary``."""

    evaluations: int
    front_size: int
    hypervolume: float
    stop_reason: str
    remarks: tuple[str, ...]


def run_study(study: Study, db: Path, threads: int, scheduler: str | None, seat: int) -> Ended:
    """Run a study or continue it, by threads or the workers of a scheduler; it can stop after each generation.

    ``seat`` tells studies that run side by side apart, see ``compute.crew.Crew``; errors are those of
    ``study.run.run``.
    """
    from pareto_monoped.analysis.remarks import remarks
    from pareto_monoped.jump.peers import cluster
    from pareto_monoped.study.run import run

    def advance(progress: Any) -> bool:
        found = {name: getattr(progress, name) for name in Advanced.__dataclass_fields__}
        say(Advanced(**found))
        return asked_to_stop()

    def tell(line: str) -> None:
        say(Noted(line=line, shared=True))

    warnings.simplefilter("ignore")  # they are for developers, and would be written across the table
    with nullcontext() if scheduler is None else cluster(scheduler, tell=tell, seat=seat) as executor:
        done = run(
            study, db, workers=threads, executor=executor, progress=advance, notify=lambda line: say(Noted(line=line))
        )
    found = {name: getattr(done, name) for name in Ended.__dataclass_fields__ if name != "remarks"}
    return Ended(**found, remarks=tuple(remarks(done.data)))
