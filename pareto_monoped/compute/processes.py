"""Fresh processes of this machine, which do tasks and can be ended at any moment: both ends of their connections.

``Processes`` gives tasks, ``serve`` does them. A process is started as a program of its own: the threads of simulator
and CAD kernel do not survive a fork, and ``multiprocessing`` would run a script again.
"""

import atexit
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor, Future
from contextlib import contextmanager, suppress
from multiprocessing import connection as connections
from multiprocessing.connection import Connection, Pipe
from typing import Any

from pareto_monoped.compute.crew import LostError, Member, Staff, Task

GRACE_S = 1.0  #: From the word to end until a process is killed. Our own choice: a user waits two seconds at most.
#: A terminal sends these to all its processes; only the first answers. Windows has no SIGHUP.
_TERMINAL = {signal.SIGINT, getattr(signal, "SIGHUP", signal.SIGINT)}
_PROGRAM = "import sys; from pareto_monoped.compute.processes import serve; serve(int(sys.argv[1]))"
_STOP, _END = b"stop", b"end"  #: What a process is told besides tasks, which are pickles; a number follows ``stop``.
_RESULT, _PROBLEM, _MESSAGE = b"r", b"p", b"m"  #: Before each pickle that a process sends back.


def _how_it_ended(code: int) -> Exception:
    if code < 0:
        with suppress(ValueError):
            return LostError(f"its process was ended by {signal.Signals(-code).name}")
    return LostError(f"its process ended by itself with code {code}")


@contextmanager
def _inheriting(handle: int) -> Iterator[dict[str, Any]]:
    """Yield what makes ``Popen`` start a process that has a handle of this one and does not hear the terminal."""
    if sys.platform == "win32":
        os.set_handle_inheritable(handle, True)
        inherited = subprocess.STARTUPINFO(lpAttributeList={"handle_list": [handle]})
        yield {"startupinfo": inherited, "creationflags": subprocess.CREATE_NEW_PROCESS_GROUP}
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _TERMINAL)  # a new process inherits it
    try:
        yield {"pass_fds": [handle]}
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class _Line:
    """A process and the connection to it."""

    def __init__(self, environment: Mapping[str, str]) -> None:
        os.getcwd()  # fails here, with a reason, where the folder has been deleted and no process could start
        self.connection, theirs = Pipe()
        self.sending = threading.Lock()
        # Use this process's import path, never the working directory.
        path = {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
        try:
            with _inheriting(theirs.fileno()) as how:
                self.process = subprocess.Popen(
                    [sys.executable, "-P", "-c", _PROGRAM, str(theirs.fileno())],
                    stdin=subprocess.DEVNULL,
                    env=os.environ | path | dict(environment),
                    **how,
                )
        finally:
            theirs.close()  # the process has its own: when it ends, ours reads the end of the file

    def tell(self, word: bytes) -> None:
        """Say a word to a process that may have ended, or may not listen to a task that is being sent."""
        if self.sending.acquire(timeout=GRACE_S):
            with suppress(OSError):
                self.connection.send_bytes(word)
            self.sending.release()

    def end(self, grace_s: float) -> int:
        """Wait until the process has ended, and kill it after a time; returns its exit code."""
        with suppress(subprocess.TimeoutExpired):
            return self.process.wait(grace_s)
        self.process.kill()
        return self.process.wait()


class Processes(Executor):
    """An executor of fresh processes, each of which does one task after the other.

    A process that ends under a task is not replaced: ``lost`` makes the task's exception from its exit code, and once
    no process is left all other tasks fail, too. ``hear`` is called with what tasks ``say``, in another thread and
    before the task has its result. If an exception leaves the context, the processes end at once.
    """

    def __init__(
        self,
        count: int = 1,
        *,
        hear: Callable[[Any], object] = lambda _: None,
        lost: Callable[[int], Exception] = _how_it_ended,
        environment: Mapping[str, str] | None = None,
    ) -> None:
        self._hear, self._lost = hear, lost
        self._waiting: deque[Task] = deque()
        self._changed = threading.Condition()
        self._closed, self._given = False, 0
        self._lines: list[_Line] = []
        atexit.register(self.kill)
        try:
            for _ in range(count):
                self._lines.append(_Line(environment or {}))
        except BaseException:
            self.kill()
            raise
        self._left = count
        # Daemons: the end of this process does not wait for a task.
        self._threads = [threading.Thread(target=self._work, args=(line,), daemon=True) for line in self._lines]
        for thread in self._threads:
            thread.start()

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **named: Any) -> Future[Any]:
        """Have a task done; see ``concurrent.futures.Executor``. Named arguments are not taken."""
        if named:
            raise TypeError("tasks of processes take positional arguments only")
        task = Task(function, arguments)
        with self._changed:
            if self._closed or self.ended:
                raise RuntimeError("cannot schedule new futures after shutdown")
            self._given = task.number = self._given + 1
            self._waiting.append(task)
            self._changed.notify()
        return task.future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Let the processes end once all tasks are done; see ``concurrent.futures.Executor``."""
        with self._changed:
            self._closed = True
            while cancel_futures and self._waiting:
                task = self._waiting.popleft()
                task.future.cancel()
                task.future.set_running_or_notify_cancel()
            self._changed.notify_all()
        atexit.unregister(self.kill)
        if wait:
            for thread in self._threads:
                thread.join()

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is not None:
            for line in self._lines:
                line.tell(_END)
            end_s = time.monotonic() + GRACE_S
            for line in self._lines:
                line.end(max(end_s - time.monotonic(), 0.0))
        self.shutdown(cancel_futures=kind is not None)

    @property
    def ended(self) -> bool:
        """Whether every process has ended under a task."""
        return not self._left

    def stop(self) -> None:
        """Ask all tasks given so far to come to an end, see ``asked_to_stop``."""
        for line in self._lines:
            line.tell(_STOP + str(self._given).encode())

    def kill(self) -> None:
        """Kill the processes without waiting for anything; tasks at hand fail."""
        for line in self._lines:
            line.process.kill()

    def do_here(self, which: Callable[[Task], bool]) -> bool:
        """Do in this process the task given last of those not begun that ``which`` accepts; False if there is none."""
        with self._changed:
            task = next(filter(which, reversed(self._waiting)), None)
            if task is None:
                return False
            self._waiting.remove(task)
        try:
            task.future.set_result(task.function(*task.arguments))
        except Exception as problem:
            task.future.set_exception(problem)
        return True

    def _next(self) -> Task | None:
        with self._changed:
            self._changed.wait_for(lambda: self._closed or self._waiting)
            return self._waiting.popleft() if self._waiting else None

    def _work(self, line: _Line) -> None:
        """Give one task after the other to a process, until it has ended or none is to come."""
        while (task := self._next()) is not None:
            if not task.future.set_running_or_notify_cancel():
                continue
            try:
                words = pickle.dumps((task.number, task.function, task.arguments), pickle.HIGHEST_PROTOCOL)
            except Exception as problem:  # which pickle raises for what cannot be sent
                task.future.set_exception(problem)
                continue
            try:
                answer = self._answer_to(words, line)
            except (OSError, EOFError):
                self._bury(line, task)
                break
            _settle(task.future, answer)
        else:
            line.tell(_END)
            line.end(GRACE_S)
        line.connection.close()

    def _answer_to(self, words: bytes, line: _Line) -> bytes:
        with line.sending:
            line.connection.send_bytes(words)
        while (answer := line.connection.recv_bytes())[:1] == _MESSAGE:
            self._hear(pickle.loads(answer[1:]))  # noqa: S301 - from our own process
        return answer

    def _bury(self, line: _Line, task: Task) -> None:
        code = line.end(GRACE_S)
        with self._changed:
            self._left -= 1
            lost = [task]
            while self.ended and self._waiting:
                waiting = self._waiting.popleft()
                if waiting.future.set_running_or_notify_cancel():
                    lost.append(waiting)
        for each in lost:
            each.future.set_exception(self._lost(code))


def _settle(future: Future[Any], answer: bytes) -> None:
    try:
        value = pickle.loads(answer[1:])  # noqa: S301 - from our own process
    except Exception as problem:  # which the value's own class raises, and no fault of the process
        future.set_exception(problem)
        return
    if answer[:1] == _PROBLEM:
        error, where = value
        error.__cause__ = RuntimeError(f"in another process:\n{where}")
        future.set_exception(error)
    else:
        future.set_result(value)


class LocalProcesses(Staff):
    """A number of processes, each with its threads; one that is lost is replaced."""

    replaces = True
    cure = "use fewer processes"

    def __init__(self, count: int, threads: int) -> None:
        self.label = f"{count} processes"
        self._threads, self._started = threads, 0
        self._members: dict[str, Member] = {}
        for _ in range(count):
            self._start()

    def _start(self) -> None:
        self._started += 1
        name = f"process {self._started}"
        self._members[name] = Member(name=name, threads=self._threads, executor=Processes())

    def present(self) -> Mapping[str, Member]:
        """Return all processes; one that has ended is found out by its tasks."""
        return dict(self._members)

    def dismiss(self, name: str) -> None:
        """End a process, whatever it is at, and start another."""
        self._end(name)
        self._start()

    def close(self) -> None:
        """End all processes."""
        for name in list(self._members):
            self._end(name)

    def _end(self, name: str) -> None:
        executor = self._members.pop(name).executor
        assert isinstance(executor, Processes)
        executor.kill()
        executor.shutdown(wait=False, cancel_futures=True)  # it keeps nothing, so nobody waits for it


# What follows runs in the other process.

_parent: Connection | None = None
_sending = threading.Lock()
_at_work = _asked = 0  #: Numbers of the task at hand, and of the last one that is asked to stop.


def _end() -> object:
    os._exit(0)


def say(message: object) -> None:
    """Send a message to ``hear`` of whoever gave this process its task; nothing happens where no process was asked."""
    _answer(_MESSAGE, message)


def asked_to_stop() -> bool:
    """Return whether the task at hand is asked to come to an end."""
    return _asked >= _at_work


def end_by(end: Callable[[], object]) -> None:
    """Let this process end by ``end`` when it is told to, is alone, or gets SIGTERM.

    ``end`` tidies up in a thread of its own while the task at hand goes on, and does not return.
    """
    global _end
    _end = end
    signal.signal(signal.SIGTERM, lambda *_: threading.Thread(target=end, daemon=True).start())


def serve(handle: int) -> None:
    """Do tasks from the connection with this file descriptor until the process at its other end has ended."""
    global _parent, _at_work
    with suppress(OSError):
        os.dup2(2, 1)  # what a library prints is not among the results of a command
    kind = getattr(connections, "PipeConnection", Connection)  # Windows has the first alone
    _parent = kind(handle)
    tasks: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(_parent, tasks), daemon=True).start()
    while True:
        try:
            _at_work, function, arguments = pickle.loads(tasks.get())  # noqa: S301 - from the process that started this one
            _answer(_RESULT, function(*arguments))
        except Exception as problem:
            where = traceback.format_exc()
            try:
                _answer(_PROBLEM, (problem, where))
            except Exception:  # which pickle raises for what cannot be sent
                _answer(_PROBLEM, (RuntimeError(f"{type(problem).__name__}: {problem}"), where))


def _answer(kind: bytes, value: object) -> None:
    words = kind + pickle.dumps(value, pickle.HIGHEST_PROTOCOL)
    with _sending, suppress(OSError):  # nobody hears it any more; ``_listen`` ends this process
        if _parent is not None:
            _parent.send_bytes(words)


def _listen(parent: Connection, tasks: "queue.SimpleQueue[bytes]") -> None:
    global _asked
    while True:
        try:
            words = parent.recv_bytes()
        except (EOFError, OSError):
            words = _END
        if words == _END:
            _end()
        elif words.startswith(_STOP):
            _asked = int(words.removeprefix(_STOP))
        else:
            tasks.put(words)
