"""Run one session of a study: ask, simulate, tell, store. Only this module knows algorithm, simulator and storage.

The first Ctrl-C asks for an orderly end, the second ends at once; SIGTERM and SIGHUP likewise.
"""

import signal
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import pairwise
from types import FrameType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.definition.study import Study
from pareto_monoped.design import designs_of
from pareto_monoped.errors import DatabaseError
from pareto_monoped.pareto.front import AtHeight, GrowingFront, best_at_height
from pareto_monoped.pareto.objectives import hypervolume
from pareto_monoped.search.algorithm import Algorithm, Scores
from pareto_monoped.search.registry import make_algorithm
from pareto_monoped.search.scoring import judge, missed, scores, values_of
from pareto_monoped.search.space import Coordinates, Motors, plain_coordinates
from pareto_monoped.storage.columns import Generation
from pareto_monoped.storage.reader import StudyData
from pareto_monoped.storage.store import Store
from pareto_monoped.study.simulator import Evaluate

_HANGUP = getattr(signal, "SIGHUP", None)  # Windows has none
_SIGNALS = [number for number in (signal.SIGINT, signal.SIGTERM, _HANGUP) if number is not None]


class Interrupt:
    """A context that catches the first SIGINT, SIGTERM or SIGHUP and sets ``asked``.

    Outside the main thread, where Python allows no signal handlers, it does nothing.
    """

    def __init__(self, notify: Callable[[str], None]) -> None:
        self.asked = False
        self._notify = notify
        self._main = threading.current_thread() is threading.main_thread()

    def __enter__(self) -> "Interrupt":
        if self._main:
            # What began with SIGHUP ignored (nohup) shall outlive its terminal.
            numbers = [n for n in _SIGNALS if n != _HANGUP or signal.getsignal(n) is not signal.SIG_IGN]
            self._before = {number: signal.signal(number, self._first) for number in numbers}
        return self

    def __exit__(self, *_: object) -> None:
        if self._main:
            for number, handler in self._before.items():
                signal.signal(number, handler)

    def _first(self, number: int, frame: FrameType | None) -> None:
        self.asked = True
        for each in self._before:
            signal.signal(each, signal.default_int_handler)
        self._notify("interrupted: ending after this generation; press Ctrl-C again to end at once")


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """How far a run is; everything it counts is already stored."""

    #: evaluations, budget: number of designs evaluated so far, and to be evaluated in all
    evaluations: int
    budget: int
    per_second: float  #: designs evaluated per second in this session
    seconds_left: float  #: time until the budget is used up, at this rate
    hypervolume: float  #: of the front so far, in the product of the objectives' units
    #: What the designs that reach ``HEADLINE_HEIGHT_M`` cost; None for objectives without a height
    at_height: AtHeight | None

    def text(self) -> str:
        """Return it in words, as a bar shows it."""
        headline = f", {self.at_height.text()}" if self.at_height else ""
        minutes, seconds = divmod(round(self.seconds_left), 60)
        return (
            f"{self.evaluations}/{self.budget}, {self.per_second:.0f}/s, {minutes}:{seconds:02d} left, "
            f"hypervolume {self.hypervolume:.2f}{headline}"
        )


class Session:
    """One session of a study: from the state in its database until something says stop."""

    def __init__(
        self,
        data: StudyData,
        study: Study,
        evaluate: Evaluate,
        store: Store,
        budget: int,
        progress: Callable[[Progress], object],
        coordinates: Coordinates | None = None,
        own_algorithm: Any = None,
    ) -> None:
        self._study = study
        self._evaluate = evaluate
        self._store = store
        self._budget = budget
        self._progress = progress
        self._halted = False
        self._coordinates = coordinates or plain_coordinates(study)
        self._generation = data.checkpoint.generation
        self.total = self._before = len(data.trials)
        self._seconds_before = data.wall_time_s
        self._started = time.monotonic()
        self._volumes: list[tuple[int, float]] = list(
            zip(data.history["evaluations"].tolist(), data.history["hypervolume"].tolist(), strict=True)
        )
        feasible = (data.trials["state"] == "feasible").to_numpy()
        names = list(study.objectives.names)
        self._front = GrowingFront(study.objectives)
        self._front.add(np.flatnonzero(feasible), data.trials.loc[feasible, names].to_numpy(dtype=np.float64))
        self._algorithm: Algorithm = make_algorithm(study, self._coordinates, own_algorithm)
        try:
            self._algorithm.restore(data.checkpoint.state, _history(data, self._coordinates))
        except (KeyError, TypeError, ValueError, IndexError) as error:
            raise DatabaseError(
                f"study database {str(store.path)!r}: its checkpoint is damaged ({error}); restore a copy"
            ) from None
        # Trials of a generation that the last budget cut short; the algorithm does not know their scores yet.
        self._designs, self._motors, self._scores = _rows(data, data.checkpoint.evaluations, len(data.trials))

    @property
    def elapsed(self) -> float:
        """Seconds since this session began."""
        return time.monotonic() - self._started

    def go(self, interrupt: Interrupt) -> str:
        """Run until a condition ends the session; return it, one of the stop reasons of ``RunSummary``."""
        writing: Future[Progress] | None = None
        with ThreadPoolExecutor(1, thread_name_prefix="store") as writer:
            while (reason := self._stop_reason(interrupt)) is None:
                generation = self._simulate()
                if generation is None:
                    reason = "exhausted"
                    break
                # The last generation was written while this one was simulated.
                self._report(writing)
                writing = writer.submit(self._write, generation, self._present())
            self._report(writing)
        return reason

    def _stop_reason(self, interrupt: Interrupt) -> str | None:
        stop = self._study.stop
        if interrupt.asked or self._halted:
            return "interrupted"
        if self.total >= self._budget:
            return "budget"
        if stop.wall_time_s is not None and self._seconds_before + self.elapsed >= stop.wall_time_s:
            return "wall_time"
        if stop.plateau_evaluations is not None and self._volumes:
            earlier = [volume for n, volume in self._volumes if n <= self.total - stop.plateau_evaluations]
            volume = self._volumes[-1][1]
            if earlier and earlier[-1] > 0.0 and volume - earlier[-1] < stop.plateau_growth * earlier[-1]:
                return "plateau"
        return None

    def _simulate(self) -> Generation | None:
        """Ask for designs, simulate what is missing, and tell the scores once complete; None if there is no more."""
        proposal = self._algorithm.ask()
        if proposal is None:
            return None
        designs = self._coordinates.designs(proposal.values)
        motors = self._coordinates.motors_of(proposal.values)
        there = len(self._designs)
        same = self._algorithm.same_designs(designs[:there], self._designs)
        if not same or _first(motors, there) != self._motors:
            trials = f"trials {self.total - there} to {self.total - 1}"
            raise self._algorithm.other_designs(trials, f"study database {str(self._store.path)!r}")
        missing = designs[there : there + self._budget - self.total]
        their_motors = {name: names[there : there + len(missing)] for name, names in motors.items()}
        started = datetime.now(UTC)
        evaluations = self._evaluate(missing, self._coordinates.kits(their_motors))
        objectives = self._study.objectives
        judgement = judge(evaluations, self._study.constraints, objectives)
        self._designs, self._motors = np.vstack((self._designs, missing)), _first(motors, there + len(missing))
        self._scores = _joined(self._scores, scores(evaluations, judgement, objectives))
        feasible = np.flatnonzero(judgement.state == "feasible")
        self._front.add(self.total + feasible, values_of(evaluations, objectives)[feasible])
        number, first = self._generation, self.total
        self.total += len(missing)
        state = None
        if len(self._designs) == len(designs):
            self._algorithm.tell(self._scores)
            state = self._algorithm.state()
            self._generation += 1
            self._designs, self._motors, self._scores = self._designs[:0], _first(motors, 0), self._scores.of(slice(0))
        volume = hypervolume(self._front.values, self._study.reference_point)
        self._volumes.append((self.total, volume))
        return Generation(
            number=number,
            first_trial=first,
            designs=missing,
            evaluations=evaluations,
            judgement=judgement,
            height_weight=proposal.height_weight,
            state=state,
            hypervolume=volume,
            seconds=self._seconds_before + self.elapsed,
            started=started,
            ended=datetime.now(UTC),
            motors=their_motors,
        )

    def _present(self) -> Progress:
        rate = (self.total - self._before) / max(self.elapsed, 1e-9)
        return Progress(
            evaluations=self.total,
            budget=self._budget,
            per_second=rate,
            seconds_left=(self._budget - self.total) / rate,
            hypervolume=self._volumes[-1][1],
            at_height=best_at_height(self._front.values, self._study.objectives),
        )

    def _write(self, generation: Generation, present: Progress) -> Progress:
        self._store.add(generation)
        return present

    def _report(self, writing: "Future[Progress] | None") -> None:
        """Tell of a generation that is stored. The next one is computed by then, and is stored even after a halt."""
        answer = None if writing is None else self._progress(writing.result())
        if isinstance(answer, bool | np.bool_) and answer:
            self._halted = True


def _first(motors: Motors, count: int) -> Motors:
    return {name: names[:count] for name, names in motors.items()}


def _rows(data: StudyData, first: int, end: int) -> tuple[NDArray[np.float64], Motors, Scores]:
    """Return designs, names of their motors where the study has a choice, and scores."""
    rows, study = data.trials.iloc[first:end], data.study
    motors = {name: tuple(rows[name]) for name in study.motor_choices}
    measures = {limit.measure: rows[limit.measure].to_numpy() for limit in study.constraints.limits}
    known = Scores(
        objectives=study.objectives,
        values=rows[list(study.objectives.names)].to_numpy(dtype=np.float64),
        violation=rows["violation"].to_numpy(),
        constraints=missed(study.constraints, measures, (rows["state"] == "failed").to_numpy()),
    )
    return designs_of(rows), motors, known


def _history(data: StudyData, coordinates: Coordinates) -> Iterator[tuple[NDArray[np.float64], Scores]]:
    """Yield coordinates and scores of every complete generation, in order."""
    numbers = data.trials["generation"].to_numpy()[: data.checkpoint.evaluations]
    edges = [0, *(np.flatnonzero(np.diff(numbers)) + 1).tolist(), data.checkpoint.evaluations]
    for first, end in pairwise(edges):
        if first < end:
            designs, motors, known = _rows(data, first, end)
            yield coordinates.values(designs, motors), known


def _joined(before: Scores, new: Scores) -> Scores:
    return Scores(
        objectives=before.objectives,
        values=np.concatenate((before.values, new.values)),
        violation=np.concatenate((before.violation, new.violation)),
        constraints=np.concatenate((before.constraints, new.constraints)),
    )
