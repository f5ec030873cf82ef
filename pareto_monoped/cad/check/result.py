"""What a check found, compared with its limit, and the limits of all checks with their reasons."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace


@dataclass(frozen=True, slots=True, kw_only=True)
class Limit:
    """What a check allows."""

    name: str  #: of the check, as the export's reader sees it
    value: float  #: the greatest allowed value, or the least if ``at_least``
    unit: str  #: of the value; things that are counted name themselves
    at_least: bool = False  #: whether it is a lower limit

    def allows(self, value: float) -> bool:
        """Return whether a measured value is within the limit; NaN is not."""
        return value >= self.value if self.at_least else value <= self.value

    def of(self, body: str) -> "Limit":
        """Return the limit for one body, ``{}`` in its name replaced by the body's."""
        return replace(self, name=self.name.format(body))


VALID = Limit(name="solids are valid", value=0, unit="invalid solids")
WATERTIGHT = Limit(name="meshes are watertight", value=0, unit="open meshes")

MESH_VOLUME = Limit(name="meshes have the volumes of their parts", value=1.0, unit="%")
"""Facets within 0.01 mm of thin round parts take 0.3 percent."""

PART_MASS = Limit(name="parts weigh what was simulated", value=1.0, unit="%")
"""Two descriptions of one geometry: splines of gear teeth make 0.02 percent, the rest is far from any real fault."""

BODY_MASS = Limit(name="{} is the body that was simulated", value=0.5, unit="% of its mass")
"""Greatest found over all motors and both families: 0.002 percent."""

CENTRE_OF_MASS = Limit(name="{} has the centre of mass that was simulated", value=0.05, unit="mm")
"""Half of the step to which links are made. Greatest found over all motors and both families: 0.0013 mm."""

INERTIA = Limit(name="{} has the inertia that was simulated", value=3.0, unit="%")
"""Parts on circles count as evenly spread in the simulation. Greatest found over all motors and families: 1.04 percent.
Each entry ij of the tensor is compared with the square root of ii times jj, which bounds it."""

DEPTH_MM = 0.02
"""Mean depth below which an overlap is the facets of two fitting cylinders, which lie within 0.01 mm of the circle."""
OVERLAP = Limit(name="no two parts overlap", value=DEPTH_MM, unit="mm deep")
GEAR_MESH = Limit(name="gears mesh on their driving flanks", value=0.002, unit="mm too early")
"""Splines of teeth lie within 0.0005 mm of the involute; a tip in a root is early by as much as it overlaps."""
FREE_MOTION = Limit(name="the leg moves freely", value=DEPTH_MM, unit="mm deep")
END_STOP = Limit(name="end stops meet at the ends of the ranges", value=0.5, unit="deg")
"""Half a degree of the simulated knee is 0.5 mm of a bumper's 20 mm. A stop that never meets counts as 180 degrees."""
SHANK_CLEARANCE = Limit(name="the shank passes the base", value=0.0, unit="mm", at_least=True)
"""Between all that the base reaches and all that the shank reaches, whatever the hip's angle."""

BOLT_OFFSET = Limit(name="bolt patterns coincide", value=0.05, unit="mm")
"""Half of the radial clearance of a fine clearance hole: M3 in 3.2 mm (ISO 273)."""
BOLT_PARTS = Limit(name="bolts join parts", value=2, unit="parts", at_least=True)

STRENGTH = Limit(
    name="joints have their required safety factors", value=0.98, unit="of the required factor", at_least=True
)
"""The links of a design are rounded to 0.1 mm after the search, which moves the loads of its jump a little. A design
that just holds in a study is not refused for that."""
SEATS = Limit(name="heads have countersinks and screws have threads", value=0, unit="screws without")

CHAINS = Limit(name="parts assemble and turn at the worst of their limits", value=0.0, unit="mm", at_least=True)
"""What the tightest dimension chain has over its least gap."""

LOOSE = Limit(name="every part is held", value=0, unit="loose parts")

# What stops a workshop: the dimensions allowed stand in ``making``.
SLOTS = Limit(name="slots can be cut", value=0, unit="slots too deep")
WINDOWS = Limit(name="windows can be milled", value=0, unit="windows too narrow")
WALLS = Limit(name="walls can be made", value=0, unit="walls too thin")
TAPS = Limit(name="taps run out over whole floors", value=0, unit="holes without room")
COLLARS = Limit(name="grooves of retaining rings have collars", value=0, unit="collars too thin")
GAUGES = Limit(name="fits can be gauged", value=0, unit="fits without gauge")
CENTRES = Limit(name="ground shafts have centres and reliefs", value=0, unit="places without")
DATUMS = Limit(name="ground shafts have a datum axis", value=0, unit="shafts without")


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One measured value, and what to say if it is beyond the limit."""

    value: float
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One check of an export."""

    name: str  #: what must hold
    looked_at: str  #: what was examined
    measured: float  #: the worst value found
    limit: float  #: what is allowed; at most, or at least if ``at_least``
    unit: str  #: of both
    failures: tuple[str, ...]  #: a sentence per failure
    at_least: bool = False  #: whether the limit is a lower one

    @property
    def passed(self) -> bool:
        """Whether nothing failed."""
        return not self.failures

    @property
    def worst(self) -> str:
        """The worst value beside its limit, in words."""
        bound = "at least" if self.at_least else "at most"
        return f"{_number(self.measured)} {self.unit} (allowed: {bound} {self.limit:g})"


def worst_of(limit: Limit, looked_at: str, findings: Iterable[Finding]) -> Check:
    """Return a check that fails for each value beyond the limit; without any it measures 0, or a lower limit's own."""
    found = sorted(findings, key=lambda finding: finding.value, reverse=not limit.at_least)
    nothing = limit.value if limit.at_least else 0.0
    return Check(
        name=limit.name,
        looked_at=looked_at,
        measured=float(found[0].value) if found else nothing,
        limit=limit.value,
        unit=limit.unit,
        failures=tuple(finding.text for finding in found if not limit.allows(finding.value)),
        at_least=limit.at_least,
    )


def count_of(limit: Limit, looked_at: str, failures: Sequence[str]) -> Check:
    """Return a check of things that are right or wrong: the measured value is the number of the wrong ones."""
    return replace(worst_of(limit, looked_at, ()), measured=float(len(failures)), failures=tuple(failures))


def _number(value: float) -> str:
    return f"{value:.0f}" if value == round(value) else f"{value:.3f}"
