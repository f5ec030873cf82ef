"""The table of joints: every row of the strength check, in the order of ``strength.csv``."""

from pareto_monoped.strength import chain, drive, gears, knee, links, mounts, stop_seats, stops, turnbuckles
from pareto_monoped.strength.joint import ActuatorJoint, LegJoint

TABLE: tuple[ActuatorJoint | LegJoint, ...] = (
    *gears.JOINTS,
    *chain.JOINTS,
    *turnbuckles.JOINTS,
    *stops.JOINTS,
    *drive.JOINTS,
    *mounts.JOINTS,
    *stop_seats.JOINTS,
    *knee.JOINTS,
    *links.JOINTS,
)
"""All rows. A module with joints of its own adds its tuple here."""
