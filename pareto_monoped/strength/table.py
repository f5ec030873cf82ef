"""The table of joints: every row of the strength check, in the order of ``strength.csv``."""

from pareto_monoped.strength import chain, drive, gears, links, mounts, stops
from pareto_monoped.strength.joint import ActuatorJoint, LegJoint

TABLE: tuple[ActuatorJoint | LegJoint, ...] = (
    *gears.JOINTS,
    *chain.JOINTS,
    *stops.JOINTS,
    *drive.JOINTS,
    *mounts.JOINTS,
    *links.JOINTS,
)
"""All rows. A module with joints of its own adds its tuple here."""
