"""Runs the studies of a campaign side by side over the cores, and sees to it that each ends or says why not."""

import queue
import time
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass, field, fields
from typing import Any

from pareto_monoped.campaign.folder import NO_FEASIBLE_DESIGN, Place, State, Stored, is_ended, stored_state
from pareto_monoped.campaign.worker import Advanced, Ended, Noted, run_study
from pareto_monoped.compute.chunks import cores as cores_here
from pareto_monoped.compute.crew import LostError
from pareto_monoped.compute.processes import GRACE_S, Processes
from pareto_monoped.errors import ParetoMonopedError
from pareto_monoped.storage.lock import holder
from pareto_monoped.study.session import Interrupt

MOST_DEATHS = 2  #: Deaths of its process after which a study is given up: one may be chance. Our own choice.
WORTH_S = 10.0  #: Time left that is worth a restart with more threads: ten times what that takes. Our own choice.
_LISTEN_S = 0.1
_SAME_S = 30.0  #: Time within which equal lines about scheduler or workers mean one event. Our own choice.
_HELD_S = 3.0  #: How long to wait for the workers of a coordinator that was killed a moment ago: our own choice.


@dataclass(slots=True, kw_only=True)
class Standing:
    """How one study stands; the rate, the time left and the threads are of a running one."""

    place: Place
    state: State
    evaluations: int  #: Number of trials stored; there shall be ``budget``.
    budget: int
    hypervolume: float
    hypervolume_unit: str
    new_evaluations: int = 0  #: Trials stored since the campaign was started.
    per_second: float = 0.0
    seconds_left: float | None = None
    threads: int = 0
    seconds: float = 0.0  #: Running time that is stored, over all sessions.
    front: int = 0  #: Number of designs on the front.
    reason: str = ""  #: Why it failed.
    deaths: int = 0  #: How often its process was killed.

    @classmethod
    def of(cls, place: Place, stored: Stored) -> "Standing":
        """Return the standing of a study that no worker has yet."""
        known = {each.name: getattr(stored, each.name) for each in fields(stored) if each.name != "summary"}
        return cls(place=place, **known)

    @property
    def name(self) -> str:
        """Of the study in the campaign."""
        return self.place.name

    @property
    def doing(self) -> str:
        """The state in a word; the front of a study that has all its trials is being audited."""
        return "auditing" if self.state == "running" and self.evaluations >= self.budget else self.state

    def as_dict(self) -> dict[str, Any]:
        """Return it as JSON values."""
        return {
            "study": self.name,
            "database": str(self.place.db),
            "state": self.doing,
            "evaluations": self.evaluations,
            "budget": self.budget,
            "per_second": round(self.per_second, 1),
            "seconds_left": None if self.seconds_left is None else round(self.seconds_left, 1),
            "hypervolume": self.hypervolume,
            "hypervolume_unit": self.hypervolume_unit,
            "front": self.front,
            "wall_time_s": round(self.seconds, 1),
            "reason": self.reason,
        }


Changed = Callable[[Standing], object]  #: Called when a study's standing has changed.


def run_campaign(
    standings: Sequence[Standing],
    *,
    cores: int | None = None,
    scheduler: str | None = None,
    changed: Changed,
    notify: Callable[[str], None],
) -> bool:
    """Run every study that has not ended; return whether all could, rather than being interrupted.

    A study that fails says so in its standing and does not stop the others; ``standings`` are brought up to date, and
    ``changed`` is called when one has begun, stored a generation, or ended. ``cores`` are the threads of all studies
    together, or with ``scheduler`` (the address of a Dask scheduler) how many studies run at a time; None means all of
    this machine or of the scheduler's workers. Results do not depend on it.

    Raises:
        InputError: the address is none, or Dask is not installed.
        WorkerError: no scheduler answers there; no study has begun.
    """
    to_run = [one for one in standings if not is_ended(one.place, stored_state(one.place))]
    if scheduler is not None and to_run:
        from pareto_monoped.compute.cluster import threads_of

        there = threads_of(scheduler)  # also where it is not needed: all studies would fail one by one
        cores = cores or there
    return _Coordinator(cores or cores_here(), scheduler, changed, notify).run(to_run)


def standings_of(places: Sequence[Place]) -> list[Standing]:
    """Return how the studies of a campaign stand according to their databases."""
    return [Standing.of(place, stored_state(place)) for place in places]


@dataclass(slots=True, kw_only=True)
class _Job:
    """A study that a worker is at."""

    standing: Standing
    worker: Processes
    before: int
    seat: int
    again_with: int | None = None  #: Number of threads of its next run if it is to stop for that; else None.


@dataclass(slots=True)
class _Coordinator:
    cores: int
    scheduler: str | None
    changed: Changed
    notify: Callable[[str], None]
    waiting: deque[Standing] = field(default_factory=deque)
    jobs: list[_Job] = field(default_factory=list)
    idle: list[Processes] = field(default_factory=list)
    news: "queue.SimpleQueue[tuple[Processes, object]]" = field(default_factory=queue.SimpleQueue)
    """What workers say, each with its worker, and their results as futures."""
    slots: int = 1
    told_s: dict[str, float] = field(default_factory=dict)  #: When a line about scheduler or workers was told.

    def run(self, standings: Sequence[Standing]) -> bool:
        """Run all of them; returns whether none was left out because of an interrupt."""
        if not standings:
            return True
        # The longest first: what ends last then ends as early as it can.
        self.waiting.extend(sorted(standings, key=lambda one: one.evaluations - one.budget))
        self.slots = min(self.cores, len(standings))
        for standing in standings:
            _wait_for_release(standing)
            standing.state, standing.reason = ("unfinished" if standing.evaluations else "waiting"), ""
        stopped_s: float | None = None
        try:
            with Interrupt(lambda _: None) as interrupt:
                while self.jobs or (self.waiting and stopped_s is None):
                    if interrupt.asked and stopped_s is None:
                        stopped_s = time.monotonic()
                        self.notify("interrupted: ending after these generations; press Ctrl-C again to end at once")
                        self._stop_all()
                    if stopped_s is None:
                        self._fill()
                        self._widen()
                    elif time.monotonic() - stopped_s > GRACE_S:
                        break
                    with suppress(queue.Empty):
                        self._hear(*self.news.get(timeout=_LISTEN_S))
            return stopped_s is None
        finally:
            for job in self.jobs:
                job.worker.kill()
                self.idle.append(job.worker)
                self._release(job, "unfinished")
            for wait in (False, True):  # all of them first, so that they end together
                for worker in self.idle:
                    worker.shutdown(wait)

    def _fill(self) -> None:
        """Begin waiting studies while there are cores: each has the same share of them, the first ones one more."""
        while self.waiting and len(self.jobs) < self.slots:
            share = 1 if self.scheduler else self.cores // self.slots
            free = self.cores - sum(job.standing.threads for job in self.jobs)
            others = self.slots - len(self.jobs) - 1
            self._begin(self.waiting.popleft(), min(share + 1, free - others * share))

    def _widen(self) -> None:
        """Give idle cores to a study that still takes long: it stops, and goes on with twice as many threads or more.

        Only one study changes at a time, so that no core is promised twice.
        """
        if self.scheduler or self.waiting or not self.jobs or any(job.again_with for job in self.jobs):
            return
        fair = self.cores // len(self.jobs)
        slow = [job for job in self.jobs if (job.standing.seconds_left or 0.0) > WORTH_S]
        slow = [job for job in slow if fair >= 2 * job.standing.threads]
        if slow:
            chosen = max(slow, key=lambda job: job.standing.seconds_left or 0.0)
            chosen.again_with = fair
            chosen.worker.stop()

    def _begin(self, standing: Standing, threads: int, worker: Processes | None = None) -> None:
        worker = worker or self._free_worker()
        standing.state, standing.threads = "running", threads
        seat = min(set(range(len(self.jobs) + 1)) - {job.seat for job in self.jobs})
        before = standing.evaluations - standing.new_evaluations
        self.jobs.append(_Job(standing=standing, worker=worker, before=before, seat=seat))
        place = standing.place
        result = worker.submit(run_study, place.study, place.db, threads, self.scheduler, seat)
        result.add_done_callback(lambda result: self.news.put((worker, result)))
        self.changed(standing)

    def _free_worker(self) -> Processes:
        if self.idle:
            return self.idle.pop()
        worker = Processes(hear=lambda said: self.news.put((worker, said)))
        return worker

    def _hear(self, worker: Processes, said: object) -> None:
        job = next(job for job in self.jobs if job.worker is worker)
        standing = job.standing
        match said:
            case Advanced():
                standing.evaluations, standing.hypervolume = said.evaluations, said.hypervolume
                standing.new_evaluations = said.evaluations - job.before
                standing.per_second, standing.seconds_left = said.per_second, said.seconds_left
                self.changed(standing)
            case Noted() if said.shared:
                self._tell_once(said.line)
            case Noted() if standing.evaluations < standing.budget:  # else of the audit, which the state tells
                self.notify(f"{standing.name}: {said.line}")
            case Future():
                match said.exception():
                    case None:
                        self._end(job, said.result())
                    case LostError() as death:
                        self._bury(job, str(death))
                    case problem:
                        self._fail(job, problem)

    def _tell_once(self, line: str) -> None:
        """Tell what every study says of the same scheduler and workers, once."""
        now_s = time.monotonic()
        if now_s - self.told_s.get(line, -_SAME_S) >= _SAME_S:
            self.notify(line)
            self.told_s[line] = now_s

    def _fail(self, job: _Job, problem: BaseException) -> None:
        unexpected = "" if isinstance(problem, ParetoMonopedError) else f"unexpected {type(problem).__name__}: "
        job.standing.reason = " ".join(f"{unexpected}{problem}".split())
        self._release(job, "failed")
        self.idle.append(job.worker)

    def _end(self, job: _Job, ended: Ended) -> None:
        standing, again = job.standing, job.again_with
        standing.evaluations, standing.hypervolume = ended.evaluations, ended.hypervolume
        standing.new_evaluations, standing.front = ended.evaluations - job.before, ended.front_size
        standing.seconds = stored_state(standing.place).seconds
        if ended.stop_reason == "interrupted":
            self._release(job, "unfinished")
            if again is not None:
                self._begin(standing, again, job.worker)
                return
        elif ended.front_size == 0:
            standing.reason = ended.remarks[0] if ended.remarks else NO_FEASIBLE_DESIGN
            self._release(job, "failed")
        else:
            self._release(job, "finished")
        self.idle.append(job.worker)

    def _bury(self, job: _Job, how: str) -> None:
        """A worker has died: its study goes on later, unless that has happened before."""
        standing = job.standing
        job.worker.shutdown()
        standing.deaths += 1
        if standing.deaths < MOST_DEATHS:
            self._release(job, "unfinished")
            self.waiting.append(standing)
            self.notify(f"{standing.name}: {how}; the study goes on later from what is stored")
        else:
            standing.reason = f"{how}, for the second time; run the campaign again, with fewer --workers if memory ends"
            self._release(job, "failed")

    def _release(self, job: _Job, state: State) -> None:
        self.jobs = [other for other in self.jobs if other is not job]
        standing = job.standing
        standing.state, standing.threads, standing.per_second, standing.seconds_left = state, 0, 0.0, None
        self.changed(standing)

    def _stop_all(self) -> None:
        for job in self.jobs:
            job.again_with = None
            job.worker.stop()


def _wait_for_release(standing: Standing) -> None:
    """Wait until the worker of a coordinator that was killed a moment ago has ended; running reports a longer hold."""
    end_s = time.monotonic() + _HELD_S
    while holder(standing.place.db) is not None and time.monotonic() < end_s:
        time.sleep(0.05)
