"""An executor over workers that may die, hang, be slow, come late or compute other numbers.

A ``Crew`` hands each task to one worker at a time and does it again elsewhere if that worker is lost. The first result
counts; tasks must therefore be pure functions. A ``Staff`` knows the workers: processes of this machine
(``compute.processes``) or those of a Dask scheduler (``compute.cluster``).
"""

import queue
import threading
import time
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import CancelledError, Executor, Future, InvalidStateError
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from pareto_monoped.errors import WorkerError

_TICK_S = 0.1  #: Between two looks at the clock. Our own choice: short beside a task.
_AHEAD = 1  #: Tasks given to a worker beyond those that it does at a time: the next is then already there.
_MOST_LOSSES = 4  #: Workers that a task may lose before it fails: it may be what ends them. Our own choice.
_STILLBORN = 6  #: Workers that may end before their first answer, one after the other. Our own choice.
_PATIENT_S = 2.0  #: Time without workers before the user hears of it; a scheduler lists them within a second.
_LATE = 4.0  #: A task that takes so many times as long as usual is also given to a worker that has nothing to do.


class LostError(Exception):
    """A worker could not take a task, or has ended under it; the message says how."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Member:
    """A worker; an ``executor`` that does tasks on this worker and nowhere else."""

    name: str  #: As the user knows it, such as ``worker tcp://10.0.0.7:40001``.
    executor: Executor
    threads: int = 1  #: That a task of it may use.
    slots: int = 1  #: Tasks that it does at a time.


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """How long a crew waits. Our own choices: a task of jumps takes half a second, the first one a few seconds more."""

    task_s: float = 60.0  #: Least time after which a worker that does not answer counts as hung.
    times: float = 20.0  #: The same as a multiple of the longest task so far.
    first_s: float = 300.0  #: The same for a worker's first task, for which it may have to compile.
    absent_s: float = 60.0  #: How long to wait for scheduler and workers before giving up.


EXPORT_LIMITS = Limits(task_s=900.0)  #: For exports: each takes ten seconds to several minutes. Our own choice.


class Staff(ABC):
    """Workers that come and go."""

    label: str  #: Of all of them, for messages, such as ``scheduler tcp://10.0.0.7:8786``.
    cure: str  #: What the user can do if nobody is there.
    replaces = False  #: Whether a worker that is dismissed is ended and replaced.

    @abstractmethod
    def present(self) -> Mapping[str, Member]:
        """Return who is there now, by name; returns at once."""

    def state(self) -> str:
        """Return why nobody may be there, in a few words."""
        return "has no worker"

    def is_loss(self, problem: BaseException) -> bool:
        """Return whether a task failed because its worker was lost, and not by itself."""
        return False

    def dismiss(self, name: str) -> None:  # noqa: B027 - nothing, where workers belong to somebody else
        """Forget a worker."""

    @abstractmethod
    def close(self) -> None:
        """Let all of them go."""


@dataclass(eq=False, slots=True)
class Task:
    """A function of a module, by whose name another process finds it, with its arguments."""

    function: Callable[..., Any]
    arguments: tuple[Any, ...]
    future: Future[Any] = field(default_factory=Future)
    number: int = 0  #: Among the tasks of its executor.
    losses: int = 0
    holders: set[str] = field(default_factory=set)


@dataclass(eq=False, slots=True)
class _Post:
    """A member at work: what it has been given, the oldest first, and when it last had less to do than it can."""

    member: Member
    accepted: bool = False
    suspended: bool = False
    given: deque["_Given"] = field(default_factory=deque)
    idle_s: float = 0.0


@dataclass(eq=False, slots=True)
class _Given:
    """A task in the hands of a worker since ``since_s``."""

    task: Task
    since_s: float


Check = Callable[[Any], str | None]  #: What is wrong with a worker by its answer to the greeting; None if it may work.


class Crew(Executor):
    """Shares tasks out among the workers of a staff, which is closed with the crew.

    ``greeting`` is the first task of every worker and gets the worker's number of threads; ``check`` says what is wrong
    with its answer. ``tell`` is called with lines for the user. Crews that share workers, such as those of a campaign's
    studies, have different ``seat`` numbers: among workers with equally little to do, each prefers another.
    """

    def __init__(
        self,
        staff: Staff,
        *,
        greeting: Callable[[int], Any],
        check: Check,
        tell: Callable[[str], None] = lambda _: None,
        limits: Limits | None = None,
        seat: int = 0,
    ) -> None:
        self._seat = seat
        self._staff, self._greeting, self._check, self._tell = staff, greeting, check, tell
        self._limits = limits or Limits()
        self._waiting: deque[Task] = deque()
        self._posts: dict[str, _Post] = {}
        self._refused: dict[str, str] = {}
        self._longest_s = self._usual_s = 0.0
        self._stillborn = 0
        self._alone_since_s: float | None = None
        self._said_alone = False
        self._news: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._door = threading.Lock()
        self._closed, self._ended = False, threading.Event()
        self._thread = threading.Thread(target=self._work, name="crew", daemon=True)
        self._thread.start()

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **named: Any) -> Future[Any]:
        """Have a task done; see ``concurrent.futures.Executor``. Named arguments are not taken."""
        if named:
            raise TypeError("tasks of a crew take positional arguments only")
        task = Task(function, arguments)
        with self._door:
            if self._closed:
                raise RuntimeError("cannot schedule new futures after shutdown")
            self._news.put(lambda: self._waiting.append(task))
        return task.future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Let the workers go; tasks that have no result yet are cancelled."""
        with self._door:
            self._closed = True
        # Behind the last task in the queue, so that each task is known when what is open is called off.
        self._news.put(self._ended.set)
        if self._thread is not threading.current_thread():
            self._thread.join()
        self._staff.close()

    # Everything below runs in the crew's thread.

    def _work(self) -> None:
        while not self._ended.is_set():
            try:
                with suppress(queue.Empty):
                    self._news.get(timeout=_TICK_S)()
                    while not self._ended.is_set():
                        self._news.get_nowait()()
                self._meet()
                self._watch()
                self._give()
                self._give_up_alone()
            except Exception as problem:  # a fault of ours must not leave callers waiting forever
                self._fail(problem)
        for task in self._open():
            if not task.future.cancel():
                task.future.set_exception(CancelledError())

    def _meet(self) -> None:
        """Greet who has come, and take back the tasks of who has gone."""
        present = self._staff.present()
        for name in [name for name in self._posts if name not in present]:
            # Where all go at once, their scheduler has, and is reported itself.
            self._lose(name, "has gone", say=bool(present))
        for name, member in present.items():
            if name not in self._posts and name not in self._refused:
                post = self._posts[name] = _Post(member)
                task = Task(self._greeting, (member.threads,))
                task.future.add_done_callback(partial(self._greeted, name))
                self._send(post, task)
        self._refused = {name: why for name, why in self._refused.items() if name in present}

    def _greeted(self, name: str, answer: "Future[Any]") -> None:
        if (post := self._posts.get(name)) is None or answer.cancelled():
            return
        try:
            text = self._check(answer.result())
        except Exception as problem:  # the answer of another version may have another form
            text = f"{type(problem).__name__}: {problem}"
        if text is None:
            post.accepted, self._stillborn = True, 0
            return
        text = " ".join(text.split())
        self._refused[name] = text
        del self._posts[name]
        self._tell(f"{name} is refused: {text}")

    def _send(self, post: _Post, task: Task) -> None:
        try:
            answer = post.member.executor.submit(task.function, *task.arguments)
        except Exception as problem:  # a broken pool or a closed client refuses tasks in many ways
            answer = Future()
            answer.set_exception(LostError(str(problem)))
        task.holders.add(post.member.name)
        given = _Given(task, time.monotonic())
        post.given.append(given)
        answer.add_done_callback(lambda answer: self._news.put(lambda: self._answered(post, given, answer)))

    def _answered(self, post: _Post, given: _Given, answer: "Future[Any]") -> None:
        task, now = given.task, time.monotonic()
        problem = None if answer.cancelled() else answer.exception()
        if answer.cancelled() or isinstance(problem, LostError) or (problem and self._staff.is_loss(problem)):
            if given in post.given and self._posts.get(post.member.name) is post:
                self._lose(post.member.name, "was lost", say=self._staff.replaces)
            return
        if given in post.given:
            post.given.remove(given)
            if task.function is not self._greeting:
                taken_s = now - max(given.since_s, post.idle_s)
                self._longest_s = max(self._longest_s, taken_s)
                self._usual_s = taken_s if self._usual_s == 0.0 else 0.8 * self._usual_s + 0.2 * taken_s
            post.idle_s = now
        if post.suspended and self._posts.get(post.member.name) is post:
            post.suspended = False
            self._tell(f"{post.member.name} answers again")
        if task.future.done():  # another worker was first
            return
        if problem is not None:
            task.future.set_exception(problem)
        else:
            task.future.set_result(answer.result())

    def _lose(self, name: str, how: str, *, say: bool = True) -> None:
        """Take back what a worker was given, and forget the worker; if it is still there, it is greeted anew."""
        post = self._posts[name]
        if not post.accepted:
            self._stillborn += self._staff.replaces
        elif say:
            self._tell(f"{name} {how}; its work goes elsewhere")
        del self._posts[name]
        self._take_back(post)
        self._staff.dismiss(name)

    def _take_back(self, post: _Post) -> None:
        given, post.given = post.given, deque()
        for one in reversed(given):
            task = one.task
            task.holders.discard(post.member.name)
            if task.function is self._greeting or task.future.done() or task.holders:
                continue
            task.losses += one in list(given)[: post.member.slots]  # the others had not begun
            if task.losses >= _MOST_LOSSES:
                task.future.set_exception(
                    WorkerError(f"a task: ended {task.losses} workers one after the other; look at their memory")
                )
            else:
                self._waiting.appendleft(task)

    def _watch(self) -> None:
        """Take tasks back from workers that take far too long."""
        usual_s = max(self._limits.task_s, self._limits.times * self._longest_s)
        for name, post in list(self._posts.items()):
            patience_s = usual_s if post.accepted else self._limits.first_s
            if post.given and not post.suspended and time.monotonic() - post.given[0].since_s > patience_s:
                words = f"has not answered for {patience_s:.0f} s"
                if self._staff.replaces:
                    self._lose(name, words)
                else:
                    post.suspended = True
                    self._take_back(post)
                    self._tell(f"{name} {words}; its work goes elsewhere")

    def _able(self) -> list[_Post]:
        return [post for post in self._posts.values() if post.accepted and not post.suspended]

    def _give(self) -> None:
        """Give what waits to who has least to do; what is late also to who has nothing to do."""
        able = sorted(self._able(), key=lambda one: one.member.name)
        slots = [post.member.slots for post in able]
        # As many seats per worker as it has threads, one of each worker first.
        seats = [k for turn in range(max(slots, default=0)) for k, count in enumerate(slots) if turn < count]
        first = seats[self._seat % len(seats)] if seats else 0
        own_first = able[first:] + able[:first]
        while able and self._waiting:
            post = min(own_first, key=lambda one: len(one.given) / one.member.slots)
            if len(post.given) >= post.member.slots + _AHEAD:
                return
            task = self._waiting.popleft()
            # Marked as running at first: a caller that has cancelled it wants no result.
            if task.future.running() or task.future.set_running_or_notify_cancel():
                self._send(post, task)
        for idle in [post for post in able if not post.given]:
            if (late := self._late(idle)) is not None:
                self._send(idle, late)

    def _late(self, idle: _Post) -> Task | None:
        limit_s = max(1.0, _LATE * self._usual_s)
        now = time.monotonic()
        for post in self._posts.values():
            for given in post.given if post is not idle and post.accepted else ():
                alone = len(given.task.holders) == 1 and not given.task.future.done()
                if alone and now - given.since_s > limit_s:
                    return given.task
        return None

    def _give_up_alone(self) -> None:
        """Fail what waits once nobody is left to do it."""
        if self._able():
            self._alone_since_s = None
            return
        if self._alone_since_s is None:
            self._alone_since_s, self._said_alone = time.monotonic(), False
        if not self._waiting:
            return
        coming = any(not post.suspended for post in self._posts.values())
        waited_s, label, (why, cure) = time.monotonic() - self._alone_since_s, self._staff.label, self._absence()
        if self._refused and not self._posts:
            complaint = next(iter(self._refused.values()))
            why, cure = (
                f"none of its {len(self._refused)} workers may be used ({complaint})",
                "install the same versions there, or leave the option out",
            )
        elif self._stillborn >= _STILLBORN:
            why, cure = f"{self._stillborn} ended before they did anything", self._staff.cure
        elif waited_s > self._limits.absent_s and not coming:
            why = f"{why}, for {self._limits.absent_s:.0f} s"
        else:
            if waited_s > _PATIENT_S and not coming and not self._said_alone:
                self._said_alone = True
                self._tell(f"{label}: {why}; waiting up to {self._limits.absent_s:.0f} s")
            return
        self._fail(WorkerError(f"{label}: {why}; {cure}"))

    def _absence(self) -> tuple[str, str]:
        """Return why no worker is available, and what the user can do."""
        count = len(self._posts)
        if not count:
            return self._staff.state(), self._staff.cure
        why = "its only worker does not answer" if count == 1 else f"none of its {count} workers answers"
        return why, "end what hangs and start it again, then give the same command again"

    def _fail(self, problem: Exception) -> None:
        for task in self._open():
            with suppress(InvalidStateError):  # a caller may cancel it at this moment
                task.future.set_exception(problem)
        self._waiting.clear()
        self._stillborn = 0
        self._alone_since_s = None

    def _open(self) -> list[Task]:
        tasks = [*self._waiting, *(given.task for post in self._posts.values() for given in post.given)]
        return [task for task in dict.fromkeys(tasks) if not task.future.done() and task.function is not self._greeting]
