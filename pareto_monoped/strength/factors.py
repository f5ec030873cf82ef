"""The table of joints, and the safety factors of all joints of many robots at once.

Capacities are computed once per gearbox and per leg. ``joint_factors`` lists the factors of one design, as exports do.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pareto_monoped.actuator.ratiomap import ActuatorMap, JointMaps, Maps, joint_maps
from pareto_monoped.design import NAMES, Design, complete
from pareto_monoped.files import kept
from pareto_monoped.geometry.shapes import Floats
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.strength import chain, drive, gears, knee, links, mounts, plates, stops, threads
from pareto_monoped.strength.gears import MOST_JUMPS, strike_life_jumps, struck_safeties
from pareto_monoped.strength.groups import GROUP_MEASURES
from pareto_monoped.strength.joint import (
    LOAD_NAMES,
    SIDES,
    ActuatorJoint,
    LegJoint,
    Loads,
    Side,
    Structure,
    Together,
    over,
)

TABLE: tuple[ActuatorJoint | LegJoint, ...] = (
    *gears.JOINTS,
    *chain.JOINTS,
    *stops.STOP_JOINTS,
    *drive.JOINTS,
    *drive.WEB_JOINTS,
    *drive.RING_JOINTS,
    *knee.CHAIN_SUPPORT_JOINTS,
    *mounts.JOINTS,
    *threads.JOINTS,
    *stops.JOINTS,
    *knee.JOINTS,
    *links.JOINTS,
    *plates.JOINTS,
)
"""All rows. A module with joints of its own adds its tuple here."""
MOST_FACTOR = 1000.0
"""Factors are cut here, because a joint without load would have an infinite one, which JSON cannot hold."""
Of = Side | Literal["leg"]
"""What a capacity belongs to."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Capacities:
    """What the joints of robots with the same motors carry."""

    #: Side -> interval of its map -> row of its actuator, shape (intervals,), see ``robot.tables.ActuatorTable.row``
    row: Mapping[Side, NDArray[np.intp]]
    #: Of the joints of each side, and of those of the leg: all their capacities side by side, shape (actuators, k), or
    #: (1, k) for the leg
    values: Mapping[Of, Floats]
    columns: tuple[slice, ...]  #: of each row of ``TABLE``: where its capacities stand in ``values``

    def plain(self, of: Of) -> NDArray[np.intp]:
        """Return the columns of ``values`` with the capacities of ``_PLAIN``."""
        return np.array([self.columns[k].start for k in _PLAIN[of]], dtype=np.intp)


_OWNERS: tuple[Of, ...] = (*SIDES, "leg")
_ROWS: dict[Of, tuple[int, ...]] = {
    of: tuple(k for k, joint in enumerate(TABLE) if getattr(joint, "side", "leg") == of) for of in _OWNERS
}
# Most joints have one capacity over one load. They are computed in one operation, which is several times as fast.
_PLAIN: dict[Of, tuple[int, ...]] = {
    of: tuple(k for k in rows if TABLE[k].factor is over and len(TABLE[k].loads) == 1) for of, rows in _ROWS.items()
}
_PLAIN_LOADS = {
    of: np.array([LOAD_NAMES.index(TABLE[k].loads[0]) for k in rows], dtype=np.intp) for of, rows in _PLAIN.items()
}
_PLAIN_COLUMNS = {of: np.array(rows, dtype=np.intp) for of, rows in _PLAIN.items()}
_OTHERS = {of: tuple(k for k in rows if k not in _PLAIN[of]) for of, rows in _ROWS.items()}


@lru_cache(maxsize=64)
def capacities(maps: JointMaps) -> Capacities:
    """Return the capacities of every joint, computed once per gearbox, or once per leg; the result is kept."""
    keys = maps.hip.key, maps.knee.key
    found = kept(None if None in keys else repr(("capacities", keys)), lambda: _blocks(maps))
    columns: list[slice] = [slice(0)] * len(TABLE)
    for of, rows in _ROWS.items():
        ends = found[f"{of} ends"].tolist()
        for k, start, end in zip(rows, [0, *ends], ends, strict=False):
            columns[k] = slice(start, end)
    return Capacities(
        row={side: _rows(maps.of(side)) for side in SIDES},
        values={of: found[of] for of in _ROWS},
        columns=tuple(columns),
    )


def _blocks(maps: JointMaps) -> dict[str, NDArray[Any]]:
    """Return the values of ``Capacities``, and where the columns of each row of ``TABLE`` end in them."""
    leg = leg_dimensions(maps)
    structures = {
        one: [
            Structure(actuator=entry.actuator, leg=leg, settings=one.settings)
            for entry in one.entries
            if entry.actuator is not None
        ]
        for one in (maps.hip, maps.knee)
    }
    # Rows that share a capacity, such as those of hip and knee with the same motor, have it computed once.
    found: dict[Any, Floats] = {}

    def of_joint(joint: ActuatorJoint | LegJoint) -> Floats:
        own = isinstance(joint, ActuatorJoint)
        one = maps.of(joint.side) if isinstance(joint, ActuatorJoint) else maps.hip
        key = (joint.capacity, one, own)
        if key not in found:
            chosen = structures[one] if own else structures[one][:1]
            capacity = joint.capacity
            numbers = capacity.of(chosen) if isinstance(capacity, Together) else [capacity(s) for s in chosen]
            found[key] = np.array([np.atleast_1d(number) for number in numbers], dtype=np.float64)
        return found[key]

    blocks: dict[str, NDArray[Any]] = {}
    for of, rows in _ROWS.items():
        own = [of_joint(TABLE[k]) for k in rows]
        blocks[f"{of} ends"] = np.cumsum([block.shape[1] for block in own])
        blocks[of] = np.concatenate(own, axis=1) if own else np.zeros((1, 0))
    return blocks


def _rows(actuator_map: ActuatorMap) -> NDArray[np.intp]:
    present = [entry.actuator is not None for entry in actuator_map.entries]
    places: NDArray[np.intp] = np.maximum(np.cumsum(present) - 1, 0)
    return places


def strength_factors(designs: ArrayLike, maps: Maps, loads: Loads) -> Floats:
    """Return the safety factor of every joint of every design, shape (n, rows of ``TABLE``).

    ``designs``: shape (n, number of variables), see ``design.complete``; the ratios choose the gearboxes.

    Returns:
        At most ``MOST_FACTOR``; NaN where a load is unknown. A design without gearbox has NaN loads.
    """
    values, both = np.atleast_2d(complete(designs)), joint_maps(maps)
    table = capacities(both)
    acting = np.stack([loads[name] for name in LOAD_NAMES], axis=1)
    result = np.empty((len(values), len(TABLE)))
    with np.errstate(divide="ignore", invalid="ignore"):
        for of in _ROWS:
            carried = table.values[of]
            if of != "leg":
                intervals = both.of(of).interval_index(values[:, NAMES.index(f"{of}_ratio")])
                carried = carried[table.row[of][np.maximum(intervals, 0)]]
            result[:, _PLAIN_COLUMNS[of]] = carried[:, table.plain(of)] / acting[:, _PLAIN_LOADS[of]]
            for k in _OTHERS[of]:
                joint = TABLE[k]
                own = carried[:, table.columns[k]]
                result[:, k] = joint.factor(*own.T, *(loads[name] for name in joint.loads))
    return np.minimum(result, MOST_FACTOR)


_REQUIRED = np.array([joint.required for joint in TABLE])
_MEMBERS = {
    measure: np.array([i for i, joint in enumerate(TABLE) if joint.group == group], dtype=np.intp)
    for group, measure in GROUP_MEASURES.items()
}


def safeties(factors: Floats) -> dict[str, Floats]:
    """Return the measure of each group, the least factor over required factor of its rows, shape (n,)."""
    shares = factors / _REQUIRED
    return {measure: shares[:, members].min(axis=1, initial=MOST_FACTOR) for measure, members in _MEMBERS.items()}


@dataclass(frozen=True, slots=True, kw_only=True)
class JointFactor:
    """A joint of one design under the loads of its jump."""

    joint: ActuatorJoint | LegJoint  #: the row of the table
    factor: float  #: its safety factor
    loads: Mapping[str, float]  #: the loads that it comes from, by their names

    @property
    def share(self) -> float:
        """Factor over required factor; the joint holds from 1 up."""
        return self.factor / self.joint.required


def joint_factors(design: Design, maps: Maps, loads: Loads) -> tuple[JointFactor, ...]:
    """Return a design's factors in the order of the table without those unknown; none if its jump failed."""
    factors = strength_factors(design.as_array(), maps, loads)[0]
    known = ~np.isnan(factors)
    if not all(known[k] or joint.informs for k, joint in enumerate(TABLE)):
        return ()
    return tuple(
        JointFactor(joint=joint, factor=float(factor), loads={name: float(loads[name][0]) for name in joint.loads})
        for joint, factor, is_known in zip(TABLE, factors, known, strict=True)
        if is_known
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class GearLife:
    """How long gears last that are struck in every jump as in the one simulated."""

    jumps: float  #: for which the weaker gearbox has the safety of its duty; 0 if for none, at most ``MOST_JUMPS``
    duty_jumps: float  #: what the gears are made for
    flank_safety: float  #: least S_H against pits, if as many jumps as the duty has strike like this
    root_safety: float  #: least S_F against broken teeth, likewise
    asked: tuple[float, float]  #: S_H and S_F of the duty

    @property
    def text(self) -> str:
        """The number in words."""
        digits = max(0, int(np.log10(max(self.jumps, 1.0))) - 1)  # two that count
        return f"{MOST_JUMPS:.0e} or more" if self.jumps >= MOST_JUMPS else f"{round(self.jumps, -digits):.0f}"

    @property
    def safeties(self) -> str:
        """What the gears have against fatigue, and what their duty asks, in words."""
        flank, root = self.asked
        return (
            f"{self.flank_safety:.2f} against pits, where their duty asks {flank:g}, and {self.root_safety:.2f} "
            f"against broken teeth, where it asks {root:g}"
        )

    @property
    def advice(self) -> str:
        """One line where the gears do not last as long as they should; '' otherwise."""
        if self.jumps >= self.duty_jumps:
            return ""
        kept = f"for {self.text} jumps" if self.jumps > 0.0 else "in no number of jumps"
        return (
            f"struck like this in each of {self.duty_jumps:.0f} jumps, the gears have a safety of {self.safeties}; "
            f"they have both {kept}, while gear_safety tells whether they survive a strike once; choose heavier "
            "gearboxes, release the knee before its stop (knee_release_rad), or constrain gear_strike_safety to at "
            "least 1"
        )


def gear_life(design: Design, maps: Maps, loads: Loads) -> GearLife | None:
    """Return the life of a design's gears under strikes; None if its jump failed or its rules know no fatigue."""
    both = joint_maps(maps)
    leg, settings = leg_dimensions(both), both.hip.settings
    torques = {side: float(loads[f"peak_gear_torque_{side}_n_m"][0]) for side in SIDES}
    if settings.rules == "paper" or np.isnan(list(torques.values())).any():
        return None
    built = {
        side: Structure(actuator=both.of(side).lookup(getattr(design, f"{side}_ratio")), leg=leg, settings=settings)
        for side in torques
    }
    safeties = [struck_safeties(built[side], torque) for side, torque in torques.items()]
    return GearLife(
        jumps=min(strike_life_jumps(built[side], torque) for side, torque in torques.items()),
        duty_jumps=settings.parts.duty.jumps,
        flank_safety=min(flank for flank, _ in safeties),
        root_safety=min(root for _, root in safeties),
        asked=(settings.parts.rating.flank_safety, settings.parts.rating.root_safety),
    )
