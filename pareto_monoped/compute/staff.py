"""Who works for a ``Crew``: what it must know of workers, and how long it waits for them."""

from collections.abc import Mapping
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True, kw_only=True)
class Member:
    """A worker."""

    name: str  #: as the user knows it, such as ``worker tcp://10.0.0.7:40001``
    executor: Executor  #: does tasks on this worker and nowhere else
    threads: int = 1  #: that a task of it may use
    slots: int = 1  #: tasks that it does at a time


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """How long a crew waits. Our own choices: a task of jumps takes half a second, the first one a few seconds more."""

    task_s: float = 60.0  #: least time after which a worker that does not answer counts as hung
    times: float = 20.0  #: the same as a multiple of the longest task so far
    first_s: float = 300.0  #: the same for a worker's first task, for which it may have to compile
    absent_s: float = 60.0  #: how long to wait for scheduler and workers before giving up


EXPORT_LIMITS = Limits(task_s=900.0)
"""For tasks that are exports: each takes ten seconds to a minute, on a busy machine several. Our own choice."""


class Staff(Protocol):
    """Workers that come and go."""

    label: str  #: of all of them, for messages, such as ``scheduler tcp://10.0.0.7:8786``
    replaces: bool  #: whether a worker that is dismissed is ended and replaced
    cure: str  #: what the user can do if nobody is there

    def present(self) -> Mapping[str, Member]:
        """Who is there now, by name; returns at once."""

    def state(self) -> str:
        """Why nobody may be there, in a few words."""

    def is_loss(self, problem: BaseException) -> bool:
        """Whether a task failed because its worker was lost, and not by itself."""

    def dismiss(self, name: str) -> None:
        """Forget a worker."""

    def close(self) -> None:
        """Let all of them go."""
