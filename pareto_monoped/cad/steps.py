"""The steps of putting an assembly together: what comes to what, from where, and which screws are then driven.

The assembly is taken apart, two halves at a time: the reverse is the order in which it goes together.

Wilson and Latombe (Geometric reasoning about mechanical assembly, 1994): among bodies with fixed ways out, let i point
to j where i, moved along a direction, runs into j. A set that contains all that its members point to can leave in this
direction as a whole. Fasteners whose keys have room are undone first; all others tie the bodies that they thread into.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pareto_monoped.cad.assembly import ACTUATOR_UNITS
from pareto_monoped.cad.bodies import DIRECTIONS, Blocking, Bools

Members = frozenset[int]

_PIECE = 3  # cost of every piece into which the rest falls, over that of a cut through a link: both are our own choice
_CUT_ACTUATOR = 10  # cost of a cut through an actuator, over that through a link: more than there are links
MOST_ADDED = 4  #: Additions in a step; more would not be told apart in its picture.
_BY_HAND = 3  # bodies that need no step of their own to be put together, if they need no screws


@dataclass(frozen=True, slots=True, kw_only=True)
class Whole:
    """Bodies that do not come apart: one, or several that last together."""

    members: Members  #: indices of bodies
    stuck: bool = False  #: whether they should come apart, but no straight way leads out


@dataclass(frozen=True, slots=True, kw_only=True)
class Joined:
    """Two assemblies that are put together, and the fasteners that are then driven."""

    kept: "Assembly"  #: stays where it is
    added: "Assembly"  #: comes to it
    out: str  #: the direction in which ``added`` leaves; it comes the other way
    fasteners: tuple[int, ...]  #: driven once both are together

    @property
    def members(self) -> Members:
        """Indices of all bodies."""
        return self.kept.members | self.added.members | frozenset(self.fasteners)


Assembly = Whole | Joined


def take_apart(blocking: Blocking, members: Members | None = None) -> Assembly:
    """Take an assembly apart as far as straight ways out and room for keys allow."""
    everything = frozenset(range(len(blocking.bodies))) if members is None else members
    order = sorted(everything)
    lasting = len(list(_pieces(_masks(blocking.lasting[np.ix_(order, order)]), (1 << len(order)) - 1)))
    if lasting == 1:
        return Whole(members=everything)
    undone = _undone(blocking, everything)
    rest = everything - undone
    if not rest:
        # Fasteners only: any one of them can be put aside.
        first = min(everything)
        aside = Whole(members=frozenset({first}))
        return Joined(kept=take_apart(blocking, everything - {first}), added=aside, out=DIRECTIONS[0], fasteners=())
    if len(rest) == 1:
        nothing = Whole(members=frozenset())
        return Joined(kept=Whole(members=rest), added=nothing, out=DIRECTIONS[0], fasteners=tuple(sorted(undone)))
    split = _best_split(blocking, rest)
    if split is None:
        return Whole(members=everything, stuck=True)
    out, leaving = split
    leaving, staying, crossing = _shared(blocking, out, leaving, rest - leaving, undone)
    if len(leaving) > len(staying):
        leaving, staying = staying, leaving
        out = ("-" if out[0] == "+" else "+") + out[1]
    kept, added = take_apart(blocking, staying), take_apart(blocking, leaving)
    return Joined(kept=kept, added=added, out=out, fasteners=tuple(sorted(crossing)))


def stuck(assembly: Assembly) -> Iterator[Members]:
    """Yield the wholes of an assembly that should come apart and do not."""
    if isinstance(assembly, Whole):
        if assembly.stuck:
            yield assembly.members
        return
    yield from stuck(assembly.kept)
    yield from stuck(assembly.added)


def _undone(blocking: Blocking, members: Members) -> Members:
    """Return the fasteners that can be undone, one after the other."""
    undone: set[int] = set()
    waiting = {k for k in members if blocking.bodies[k].is_fastener}
    while True:
        left = members - undone
        free = {k for k in waiting if not all(way & left for way in blocking.key[k])}
        if not free:
            return frozenset(undone)
        undone |= free
        waiting -= free


def _best_split(blocking: Blocking, rest: Members) -> tuple[str, Members] | None:
    """Return a direction and a set that can leave in it: fewest units are cut, then the halves are most balanced."""
    order = sorted(rest)
    everything = (1 << len(order)) - 1
    touching = _masks(blocking.touching[np.ix_(order, order)])
    best: tuple[tuple[int, int, int], str, Members] | None = None
    for direction in DIRECTIONS:
        if best is not None and direction not in blocking.along:
            break  # across the axis only what does not leave along it
        reach = _masks(_closure(_edges(blocking, direction, order)))
        seen: set[int] = set()
        for k, mask in enumerate(_candidates(blocking, order, reach, touching)):
            if mask in (0, everything) or mask in seen:
                continue
            seen.add(mask)
            leaving = frozenset(order[m] for m in _bits(mask))
            # What falls to pieces once the set has gone has to be held in its place meanwhile.
            pieces = sum(1 for _ in _pieces(touching, everything & ~mask)) - 1
            cost = _cuts(blocking, leaving, rest - leaving) + _PIECE * pieces
            score = (cost, -min(len(leaving), len(rest) - len(leaving)), k)
            if best is None or score < best[0]:
                best = (score, direction, leaving)
    return None if best is None else best[1:]


def _edges(blocking: Blocking, direction: str, order: list[int]) -> Bools:
    """Return true at (i, j) where i takes j with it: it runs into j, or is tied to it."""
    rows = np.stack([blocking.blocked(direction, k) for k in order])[:, order]
    chosen = np.ix_(order, order)
    return np.asarray(rows | blocking.tied[chosen] | blocking.lasting[chosen])


def _closure(edges: Bools) -> Bools:
    """Return what each node reaches, itself included."""
    reach = edges | np.eye(len(edges), dtype=bool)
    # Warshall 1962: ways over the first k nodes.
    for k in range(len(reach)):
        reach[reach[:, k]] |= reach[k]
    return np.asarray(reach)


def _candidates(
    blocking: Blocking, order: Sequence[int], reach: Sequence[int], touching: Sequence[int]
) -> Iterator[int]:
    """Yield masks of sets that can leave and hold together: what units, and then single bodies, take with them.

    Of a set in several pieces each piece that runs into no other can leave by itself. ``reach`` and ``touching`` have
    per body a mask of what it takes with it and of what it touches.
    """
    units = [blocking.bodies[k].unit for k in order]
    seeds = [_united(reach, (k for k, name in enumerate(units) if name == unit)) for unit in dict.fromkeys(units)]
    for mask in dict.fromkeys([*seeds, *reach]):
        pieces = list(_pieces(touching, mask))
        # A piece may run into another that it does not touch.
        yield from (piece for piece in pieces if _united_in(reach, piece) == piece)
        if len(pieces) > 1:
            yield mask


def _masks(rows: Bools) -> list[int]:
    """Return each row as an integer whose bit m is the row's element m."""
    return [int.from_bytes(row.tobytes(), "little") for row in np.packbits(rows, axis=1, bitorder="little")]


def _bits(mask: int) -> Iterator[int]:
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low


def _united(masks: Sequence[int], members: Iterable[int]) -> int:
    found = 0
    for k in members:
        found |= masks[k]
    return found


def _united_in(masks: Sequence[int], members: int) -> int:
    """Return the same for members that are the bits of a mask."""
    found = 0
    while members:
        low = members & -members
        found |= masks[low.bit_length() - 1]
        members ^= low
    return found


def _pieces(touching: Sequence[int], mask: int) -> Iterator[int]:
    """Yield the pieces into which a set of bodies falls, as masks, from that of the lowest body."""
    while mask:
        piece = fresh = mask & -mask
        while fresh:
            fresh = _united_in(touching, fresh) & mask & ~piece
            piece |= fresh
        yield piece
        mask &= ~piece


def _cuts(blocking: Blocking, one: Members, other: Members) -> int:
    """Return what it costs that units have bodies on both sides; an actuator is tested on the bench as a whole."""
    names = [{blocking.bodies[k].unit for k in side} for side in (one, other)]
    return sum(_CUT_ACTUATOR if name in ACTUATOR_UNITS else 1 for name in names[0] & names[1])


def _shared(
    blocking: Blocking, out: str, leaving: Members, staying: Members, undone: Members
) -> tuple[Members, Members, Members]:
    """Return both sides with the undone fasteners that belong to one alone, and those that join or part both."""
    sides, crossing = (set(leaving), set(staying)), set()
    for k in sorted(undone):
        joins = blocking.goes_through[k] - undone
        leaves, stays = (bool(joins & side) for side in (leaving, staying))
        if leaves:
            parts = bool(staying & set(np.flatnonzero(blocking.blocked(out, k)).tolist()))
        else:
            parts = any(blocking.blocked(out, m)[k] for m in leaving)
        if (leaves and stays) or parts:
            crossing.add(k)
        else:
            sides[0 if leaves else 1].add(k)
    return frozenset(sides[0]), frozenset(sides[1]), frozenset(crossing)


@dataclass(frozen=True, slots=True, kw_only=True)
class Addition:
    """Bodies that come to an assembly together, along a straight line."""

    members: Members  #: indices of bodies
    out: str  #: the direction in which they would leave; they come the other way
    number: int | None = None  #: of the step that has put them together; None if they need none


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """One step."""

    number: int  #: from 1
    base: Members  #: what is together already, or the first body
    base_number: int | None  #: of the step that has put the base together; None for a single body
    additions: tuple[Addition, ...]  #: what comes to it, one after the other
    fasteners: tuple[int, ...]  #: indices of the screws that are driven then

    @property
    def members(self) -> Members:
        """Indices of all bodies that are together after the step."""
        return self.base.union(*(addition.members for addition in self.additions), self.fasteners)


def steps_of(assembly: Assembly) -> tuple[Step, ...]:
    """Return the steps in order: each assembly is made in consecutive steps, what comes to it is made before."""
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
        new = Step(
            number=len(found) + 1,
            base=assembly.kept.members,
            base_number=base_number,
            additions=additions,
            fasteners=assembly.fasteners,
        )
        found.append(new)
    return found[-1].number


def titled(step: Step, blocking: Blocking) -> str:
    """Return what a step works at: the names of the units that it touches, the greatest first."""
    names: dict[str, int] = {}
    for k in step.members:
        unit = blocking.bodies[k].unit
        names[unit] = names.get(unit, 0) + 1
    order = sorted(names, key=lambda name: -names[name])
    words = [name.replace("_", " ") for name in order]
    text = words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
    return text[0].upper() + text[1:]
