"""The table of joints: every row of the strength check, in the order of ``strength.csv``."""

from pareto_monoped.strength import (
    chain,
    chain_support,
    drive,
    gears,
    knee,
    links,
    mounts,
    plates,
    stop_seats,
    stops,
    threads,
    turnbuckles,
    webs,
)
from pareto_monoped.strength.joint import ActuatorJoint, LegJoint

TABLE: tuple[ActuatorJoint | LegJoint, ...] = (
    *gears.JOINTS,
    *chain.JOINTS,
    *turnbuckles.JOINTS,
    *stops.JOINTS,
    *drive.JOINTS,
    *webs.JOINTS,
    *chain_support.JOINTS,
    *mounts.JOINTS,
    *threads.JOINTS,
    *stop_seats.JOINTS,
    *knee.JOINTS,
    *links.JOINTS,
    *plates.JOINTS,
)
"""All rows. A module with joints of its own adds its tuple here."""
