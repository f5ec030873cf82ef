"""Check a search algorithm of the user's own, and rebuild it by asking it again.

A database stores the name of its class, never the algorithm. That it asks for the same designs again is checked against
all stored trials when a study goes on.
"""

import re
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from pareto_monoped.definition.algorithms import OWN_ALGORITHM, OwnSettings
from pareto_monoped.errors import StudyError, complaint
from pareto_monoped.search.algorithm import Algorithm, Floats, Proposal, Scores, Space

_SAME = 1e-9
"""Relative difference up to which a variable counts as the stored one."""


def own_algorithm_name(given: object) -> str:
    """Return "own:" and the name of the class; refuse what neither has ``ask`` and ``tell`` nor can be called."""
    if not (callable(given) or (hasattr(given, "ask") and hasattr(given, "tell"))):
        allowed = "a name, a mapping of settings, or an object with ask and tell or a function that makes one"
        raise StudyError(complaint("algorithm", given, allowed, "give one of these"))
    name = given.__name__ if hasattr(given, "__name__") else type(given).__name__
    if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]{0,99}", name):
        raise StudyError(f"own algorithm {name!r}: must be called by letters, digits and '_'; give its class a name")
    return f"{OWN_ALGORITHM}{name}"


class OwnAlgorithm(Algorithm):
    """Adapts an algorithm of the user's own, whose trials are replayed on restore."""

    def __init__(self, space: Space, settings: OwnSettings, seed: int, given: Any) -> None:
        """Take an object with ``ask`` and ``tell``, or call a class or function of space and seed that makes one."""
        self._space = space
        self._source = f"own algorithm {settings.name.removeprefix(OWN_ALGORITHM)!r}"
        if given is None:
            raise StudyError(
                f"{self._source}: only your program has it; go on from Python: "
                "pareto_monoped.resume(db, algorithm=...), or name another algorithm"
            )
        if own_algorithm_name(given) != settings.name:
            other = own_algorithm_name(given).removeprefix(OWN_ALGORITHM)
            raise StudyError(f"{self._source}: is the study's, {other!r} is given; give the one that it began with")
        made = isinstance(given, type) or not hasattr(given, "ask")
        self._inner = self._called(given, space, seed) if made else given
        for part in ("ask", "tell"):
            if not callable(getattr(self._inner, part, None)):
                raise StudyError(f"{self._source}: has no {part}(); it must have ask() and tell(scores)")

    def ask(self) -> Proposal | None:
        """Return the designs that the algorithm gives: an array of shape (n, d), a ``Proposal``, or None at its end."""
        given = self._called(self._inner.ask)
        if given is None:
            return None
        weight = given.height_weight if isinstance(given, Proposal) else None
        values = self._values(given.values if isinstance(given, Proposal) else given)
        return Proposal(values=self._space.snap(values), height_weight=weight)

    def tell(self, scores: Scores) -> None:
        """Pass the scores on."""
        self._called(self._inner.tell, scores)

    def state(self) -> dict[str, Any]:
        """Return nothing: the trials are in the database, and they are replayed on restore."""
        return {}

    def restore(self, state: dict[str, Any], history: Iterable[tuple[Floats, Scores]]) -> None:
        """Replay the stored trials; raise ``StudyError`` if the algorithm asks for other designs."""
        for number, (values, scores) in enumerate(history):
            asked = self.ask()
            if asked is None or not self.same_designs(asked.values, values):
                raise self.other_designs(f"generation {number}", "")
            self.tell(scores)

    def same_designs(self, asked: Floats, stored: Floats) -> bool:
        """Compare every value to nine digits: another version of a library may round otherwise in the last ones."""
        return asked.shape == stored.shape and bool(np.allclose(asked, stored, rtol=_SAME, atol=_SAME))

    def other_designs(self, trials: str, source: str) -> StudyError:
        """Blame the algorithm, not the database."""
        return StudyError(
            f"{self._source}: asks for other designs in {trials} than those stored; give it as it was at the start of "
            "the study, with the same seed"
        )

    def _values(self, given: object) -> Floats:
        try:
            values = np.array(given, dtype=np.float64)
        except (TypeError, ValueError):
            allowed = "None, or designs of shape (n, d)"
            raise StudyError(complaint(f"{self._source}: ask()", given, allowed, "return one of these")) from None
        lower, upper = self._space.edges
        if values.ndim != 2 or values.shape[1] != len(lower) or len(values) == 0:
            allowed = f"(n, {len(lower)}), for {', '.join(self._space.names)}"
            raise StudyError(complaint(f"{self._source}: shape of ask()", values.shape, allowed, "correct it"))
        outside = np.argwhere(~((values >= lower) & (values <= upper)))
        for row, k in outside[:1]:
            allowed = f"{lower[k]:g} to {upper[k]:g}"
            name = f"{self._source}: {self._space.names[k]}"
            raise StudyError(complaint(name, float(values[row, k]), allowed, "keep it within its bounds"))
        return values

    def _called(self, function: Callable[..., Any], *arguments: object) -> Any:
        try:
            return function(*arguments)
        except Exception as error:
            text = re.sub(r"\s+", " ", f"{type(error).__name__}: {error}")
            raise StudyError(f"{self._source}: {text}; correct it") from error
