"""The groups of joints of which each has a measure, and which of these a design must keep. Needs no other module."""

from typing import Literal

Group = Literal["gears", "gear_strikes", "chain", "stops", "joints", "links"]
GROUP_MEASURES: dict[Group, str] = {
    "gears": "gear_safety",
    "gear_strikes": "gear_strike_safety",
    "chain": "chain_safety",
    "stops": "stop_safety",
    "joints": "joint_safety",
    "links": "link_safety",
}
"""Group -> the measure that is the least factor over required factor of its rows."""
INFORMING: frozenset[Group] = frozenset({"gear_strikes"})
"""Groups that inform: their factors are shown and stored, but no study and no export requires them by itself."""
REQUIRED_MEASURES: tuple[str, ...] = tuple(name for group, name in GROUP_MEASURES.items() if group not in INFORMING)
"""The measures that a design must have at 1 or more to hold."""
