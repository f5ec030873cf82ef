"""The steps of putting an assembly together: what comes to what, from where, and which screws are then driven."""

from dataclasses import dataclass, replace

from pareto_monoped.cad.assembling.bodies import Blocking
from pareto_monoped.cad.assembling.taking_apart import Assembly, Members, Whole

MOST_ADDED = 4
"""Additions in a step; more would not be told apart in its picture."""

_BY_HAND = 3
"""Bodies that need no step of their own to be put together, if they need no screws."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Addition:
    """Bodies that come to an assembly together, along a straight line.

    Attributes:
        members: indices of bodies.
        out: the direction in which they would leave; they come the other way.
        number: of the step that has put them together before; None for a single body, and for a few that are put
            together by hand before they come.
    """

    members: Members
    out: str
    number: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """One step.

    Attributes:
        number: from 1.
        base: what is together already, or the first body.
        base_number: of the step that has put the base together; None for a single body.
        additions: what comes to it, one after the other.
        fasteners: indices of the screws that are driven then.
    """

    number: int
    base: Members
    base_number: int | None
    additions: tuple[Addition, ...]
    fasteners: tuple[int, ...]

    @property
    def members(self) -> Members:
        """Indices of all bodies that are together after the step."""
        return self.base.union(*(addition.members for addition in self.additions), self.fasteners)


def steps_of(assembly: Assembly) -> tuple[Step, ...]:
    """The steps in order: each assembly is made in consecutive steps, what comes to it is made before."""
    found: list[Step] = []
    _make(assembly, found)
    return tuple(found)


def _make(assembly: Assembly, found: list[Step]) -> int | None:
    """Append the steps of an assembly, and return the number of its last one; None if it needs none."""
    if isinstance(assembly, Whole):
        return None
    base_number = _make(assembly.kept, found)
    before = len(found)
    number = _make(assembly.added, found)
    if len(found) == before + 1 and not found[-1].fasteners and len(assembly.added.members) <= _BY_HAND:
        number = None
        del found[-1]
    last = found[-1] if found else None
    added = Addition(members=assembly.added.members, out=assembly.out, number=number)
    additions = (added,) if added.members else ()
    continues = last is not None and last.number == base_number and before == len(found)
    if continues and last is not None and not last.fasteners and len(last.additions) < MOST_ADDED:
        found[-1] = replace(last, additions=(*last.additions, *additions), fasteners=assembly.fasteners)
    else:
        found.append(
            Step(
                number=len(found) + 1,
                base=assembly.kept.members,
                base_number=base_number,
                additions=additions,
                fasteners=assembly.fasteners,
            )
        )
    return found[-1].number


def titled(step: Step, blocking: Blocking) -> str:
    """What a step works at: the names of the units that it touches, the greatest first."""
    names: dict[str, int] = {}
    for k in step.members:
        unit = blocking.bodies[k].unit
        names[unit] = names.get(unit, 0) + 1
    order = sorted(names, key=lambda name: -names[name])
    words = [name.replace("_", " ") for name in order]
    text = words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
    return text[0].upper() + text[1:]
