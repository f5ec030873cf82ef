"""The workers of a Dask scheduler. Dask sends pickles, so all hosts must trust each other (``docs/scaling.md``)."""

import logging
import threading
import time
from collections.abc import Mapping
from concurrent.futures import CancelledError, Future
from contextlib import closing, suppress
from ssl import SSLError
from typing import TYPE_CHECKING, Any

from pareto_monoped.compute.crew import Member, Staff
from pareto_monoped.errors import InputError, WorkerError, require_extra

if TYPE_CHECKING:
    from distributed import Client

_NEWS_S = 0.5  #: Between two questions to the scheduler who its workers are.
_ANSWER_S = 5.0  #: For the answer; a network that is cut for longer than this gives no news, see ``_SILENT_S``.
_SILENT_S = 30.0  #: Time without news before the scheduler counts as lost: three times a short network failure.
_CONNECT_S = 8.0  #: For the first connection: then a wrong address is likelier than a slow scheduler. Our own choice.
_NO_WORKER = "has no worker"


class DaskWorkers(Staff):
    """Workers that the scheduler at an address such as ``tcp://10.0.0.7:8786`` knows, as they come and go.

    Raises:
        InputError: Dask is not installed here, the text is no address, or it asks for TLS without certificates.
        WorkerError: no scheduler answers.
    """

    cure = "start scheduler and workers, then give the same command again"

    def __init__(self, address: str) -> None:
        self.label = f"scheduler {address}"
        self._address = address
        require_extra("cluster", self.label)
        _refuse_no_address(address)
        # What goes wrong is said in our own words, once. Dask sets levels of its own when it is imported, as it now is.
        for name in ("distributed", "distributed.client", "tornado.application", "asyncio"):
            logging.getLogger(name).setLevel(logging.CRITICAL)
        self._client = self._first_connection()
        self._members: dict[str, Member] = {}
        self._state = _NO_WORKER
        self._closed = threading.Event()
        self._thread = threading.Thread(target=self._listen, name="scheduler", daemon=True)
        self._thread.start()

    def present(self) -> Mapping[str, Member]:
        """Return the workers that the scheduler named last; none while there is no connection to it."""
        return self._members if self._client.status == "running" else {}

    def state(self) -> str:
        """Return why none may be there."""
        broken = self._client.status != "running" and self._state == _NO_WORKER
        return "does not answer (the connection has ended)" if broken else self._state

    def threads(self) -> int:
        """Return the present number of threads of all workers; raise ``WorkerError`` if no scheduler answers."""
        try:
            return sum(self._ask().values())
        except Exception as problem:  # see ``_listen``
            raise WorkerError(f"{self.label}: does not answer ({_words(problem)}); {self.cure}") from None

    def is_loss(self, problem: BaseException) -> bool:
        """Return whether a task ended because worker, scheduler or connection did."""
        from distributed.client import FutureCancelledError, FuturesCancelledError
        from distributed.comm import CommClosedError
        from distributed.scheduler import KilledWorker, NoValidWorkerError

        lost = (FutureCancelledError, FuturesCancelledError, KilledWorker, NoValidWorkerError, CommClosedError)
        return isinstance(problem, (CancelledError, *lost))

    def close(self) -> None:
        """Leave the scheduler; its workers stay."""
        self._closed.set()
        self._thread.join()
        with suppress(Exception):
            self._client.close(timeout=2)

    def _first_connection(self) -> "Client":
        end_s = time.monotonic() + _CONNECT_S
        while True:
            try:
                return self._connected()
            except (OSError, TypeError, ValueError) as error:
                if self._address.startswith(_ENCRYPTED) and isinstance(error, TypeError | FileNotFoundError | SSLError):
                    lack = "are missing" if isinstance(error, TypeError) else f"cannot be used ({_words(error)})"
                    raise InputError(
                        f"{self.label}: its TLS certificates {lack}; set distributed.comm.tls.ca-file, .client.cert "
                        "and .client.key in Dask's configuration"
                    ) from None
                # A relay, such as a tunnel of SSH, breaks a connection at once where the scheduler is about to start.
                if time.monotonic() > end_s or not isinstance(error, OSError):
                    raise WorkerError(
                        f"{self.label}: does not answer within {_CONNECT_S:.0f} s ({_words(error)}); check the "
                        "address, or start it with: dask scheduler"
                    ) from None
                time.sleep(_NEWS_S)

    def _connected(self) -> "Client":
        """Return a new connection, made aside: where somebody accepts it and then stays silent, Dask waits for ever."""
        found: Future[Client] = Future()
        threading.Thread(target=self._connect, args=(found,), name="connecting", daemon=True).start()
        try:
            return found.result(_CONNECT_S + _ANSWER_S)
        finally:
            found.cancel()  # a connection that comes too late is nobody's

    def _connect(self, found: "Future[Client]") -> None:
        import dask
        from distributed import Client

        class Kept(Client):  # type: ignore[misc]  # Dask tells no types
            """A client that only ``close`` closes.

            Dask's own closes itself in the thread in which the garbage collector runs; if that thread is just starting
            the next client, it waits for a lock that it holds itself.
            """

            def __del__(self) -> None:
                """Nothing."""

        try:
            with dask.config.set({"distributed.comm.retry.count": 3, "distributed.comm.timeouts.connect": "10s"}):
                client = Kept(self._address, timeout=_CONNECT_S, set_as_default=False)
        except Exception as problem:  # raised again where somebody waits for it
            if found.set_running_or_notify_cancel():
                found.set_exception(problem)
            return
        if found.set_running_or_notify_cancel():
            found.set_result(client)
        else:
            client.close(timeout=_NEWS_S)

    def _listen(self) -> None:
        heard_s = time.monotonic()
        while not self._closed.wait(_NEWS_S):
            try:
                if self._client.status == "closed":
                    self._members = {}  # their executors are of the connection that is no more
                    self._client = self._connected()
                threads = self._ask()
            except Exception as problem:  # Dask, tornado and the operating system each have their own
                cut = self._client.status == "running" and time.monotonic() - heard_s < _SILENT_S
                if not cut:
                    self._members, self._state = {}, f"does not answer ({_words(problem)})"
                continue
            heard_s = time.monotonic()
            self._members = {name: self._member(name, count) for name, count in _named(threads).items()}
            self._state = _NO_WORKER

    def _ask(self) -> Mapping[str, int]:
        """Return the number of threads by address of each worker, as the scheduler now answers."""
        threads: Mapping[str, int] = self._client.sync(self._client.scheduler.ncores, callback_timeout=_ANSWER_S)
        return threads

    def _member(self, name: str, threads: int) -> Member:
        known = self._members.get(name)
        if known is not None and known.slots == threads:
            return known
        where = [name.removeprefix(_WORKER)]
        executor: Any = self._client.get_executor(workers=where, allow_other_workers=False, pure=False)
        return Member(name=name, slots=threads, executor=executor)


def threads_of(address: str) -> int:
    """Return the present number of threads of a scheduler's workers, which may be 0; raises as ``DaskWorkers`` does."""
    with closing(DaskWorkers(address)) as workers:
        return workers.threads()


def _refuse_no_address(address: str) -> None:
    """Raise ``InputError`` at once for what cannot be an address, which Dask would try again and again."""
    from distributed.comm.addressing import get_address_host_port

    try:
        host, port = get_address_host_port(address, strict=False)
    except ValueError:
        host, port = "", 0
    if not host or not 0 < port < 65536:
        raise InputError(f"scheduler {address!r}: is no address of a scheduler; give tcp://HOST:PORT")


_ENCRYPTED = ("tls://", "wss://")
_WORKER = "worker "


def _named(threads: Mapping[str, int]) -> dict[str, int]:
    return {f"{_WORKER}{address}": count for address, count in threads.items()}


def _words(problem: BaseException) -> str:
    return " ".join(f"{type(problem).__name__}: {problem}".split())[:120].rstrip(": ")
