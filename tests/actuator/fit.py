"""Whether the parts of an actuator fit together, from radii and heights alone: rings of material in r and z."""

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.shapes import Circle, Pattern, Shape

# Pairs that touch or mesh by design, checked in other ways.
MESHING = {frozenset(pair) for pair in (("planet", "sun"), ("planet", "ring"))}


@dataclass(frozen=True, slots=True, kw_only=True)
class Ring:
    """Material between two radii and two heights."""

    part: str
    group: str
    r0: float
    r1: float
    z0: float
    z1: float
    outline: Shape
    holes: tuple[Shape, ...]

    def fits(self, other: "Ring") -> bool:
        """Whether one is splined into the other: the same toothing outside and inside."""
        return any(
            isinstance(inner.outline, ExternalGear) and inner.outline in outer.holes
            for inner, outer in ((self, other), (other, self))
        )


def outer_mm(shape: Shape) -> float:
    if isinstance(shape, Circle):
        return float(shape.radius_mm)
    assert isinstance(shape, ExternalGear)
    return float(shape.tip_radius_mm)


def inner_mm(holes: tuple[Shape, ...]) -> float:
    """Radius of the central hole; patterns of holes are left out, which is on the safe side."""
    centred = [hole.radius_mm for hole in holes if isinstance(hole, Circle)]
    centred += [hole.root_radius_mm for hole in holes if isinstance(hole, ExternalGear)]  # a spline
    centred += [hole.tip_radius_mm for hole in holes if isinstance(hole, InternalGear)]
    assert len(centred) <= 1
    return float(centred[0]) if centred else 0.0


def rings(part: Part) -> list[Ring]:
    """A part's material; of parts on a circle, all of the annulus that they sweep."""
    found = []
    for prism in part.prisms:
        r0, r1 = inner_mm(prism.holes), outer_mm(prism.outline)
        if part.pitch_radius_mm:
            r0, r1 = part.pitch_radius_mm - r1, part.pitch_radius_mm + r1
        found.append(ring_of(part, prism, r0, r1))
    return found


def ring_of(part: Part, prism: Prism, r0: float, r1: float) -> Ring:
    return Ring(
        part=part.name,
        group=part.group,
        r0=r0,
        r1=r1,
        z0=float(prism.z0_mm),
        z1=float(prism.z1_mm),
        outline=prism.outline,
        holes=prism.holes,
    )


def gap_mm(a: Ring, b: Ring) -> float:
    """How far two rings are apart, in r or in z, whichever is more; negative if they share material."""
    return max(a.r0 - b.r1, b.r0 - a.r1, a.z0 - b.z1, b.z0 - a.z1)


def holes_for_pins(carrier: Part, pin: Part) -> bool:
    """Whether every prism of a carrier that a pin runs through has holes just where the pins are."""
    low, high = min(prism.z0_mm for prism in pin.prisms), max(prism.z1_mm for prism in pin.prisms)
    radius = pin.prisms[0].outline.radius_mm
    for prism in carrier.prisms:
        if prism.z1_mm <= low + 1e-9 or prism.z0_mm >= high - 1e-9:
            continue
        fitting = [
            hole
            for hole in prism.holes
            if isinstance(hole, Pattern)
            and hole.count == pin.count
            and abs(hole.pitch_radius_mm - pin.pitch_radius_mm) < 1e-9
            and abs(hole.radius_mm - radius) < 1e-9
            and hole.phase_rad == pin.phase_rad
        ]
        if not fitting:
            return False
    return True


def screw_clashes(screw: Part, other: Part) -> list[str]:
    """Where a screw runs through material of another part that has no hole for it, or turns past it too closely."""
    found = []
    for body in screw.prisms:
        radius, middle = float(body.outline.radius_mm), float(screw.pitch_radius_mm)
        play = 0.2 if other.group != screw.group else 0.0
        for prism in other.prisms:
            if min(prism.z1_mm, body.z1_mm) - max(prism.z0_mm, body.z0_mm) < 1e-9 - play:
                continue
            if outer_mm(prism.outline) <= middle - radius - play + 1e-9:
                continue
            if inner_mm(prism.holes) >= middle + radius + play - 1e-9:
                continue
            if any(
                isinstance(hole, Pattern)
                and hole.count == screw.count
                and abs(hole.pitch_radius_mm - middle) < 1e-9
                and hole.radius_mm >= radius - 1e-9
                and hole.phase_rad == screw.phase_rad
                for hole in prism.holes
            ):
                continue
            found.append(f"{screw.name} has no hole in {other.name} between {prism.z0_mm} and {prism.z1_mm}")
    return found


def clashes(actuator: Actuator, clearance_mm: float = 0.2) -> list[str]:
    """Every pair of parts that share material, or turn past each other with less than the clearance."""
    parts = {part.name: part for part in actuator.parts}
    found = []
    for a, b in combinations(actuator.parts, 2):
        pair = frozenset((a.name, b.name))
        if pair in MESHING:
            continue
        if a.pitch_radius_mm and b.pitch_radius_mm:
            # Planet, bush, pin and its screw on one axis: nested, seen from that axis. All others: side by side.
            one_axis = abs(a.pitch_radius_mm - b.pitch_radius_mm) < 1e-9
            if one_axis and is_fastener(a) and is_fastener(b) and a.phase_rad != b.phase_rad and beside(a, b):
                continue
            rings_a, rings_b = (rings_about_own_axis(part) if one_axis else rings(part) for part in (a, b))
        elif is_fastener(a) or is_fastener(b):
            screw, other = (a, b) if is_fastener(a) else (b, a)
            found += screw_clashes(screw, other)
            continue
        elif "planet_pin" in pair and pair & {"carrier", "secondary_carrier"}:
            carrier = parts["carrier"] if "carrier" in pair else parts["secondary_carrier"]
            if not holes_for_pins(carrier, parts["planet_pin"]):
                found.append(f"{carrier.name} has no holes for the pins")
            continue
        else:
            rings_a, rings_b = rings(a), rings(b)
        turning = a.group != b.group and not any("bearing" in name or "bush" in name for name in pair)
        needed = clearance_mm if turning else 0.0
        least = min(gap_mm(x, y) for x in rings_a for y in rings_b if not x.fits(y))
        if least < needed - 1e-9:
            found.append(f"{a.name} and {b.name}: {least:.3f} mm, {needed} needed")
    return found


def rings_about_own_axis(part: Part) -> list[Ring]:
    return [ring_of(part, prism, inner_mm(prism.holes), outer_mm(prism.outline)) for prism in part.prisms]


def is_fastener(part: Part) -> bool:
    """Whether it stands in holes that other parts have for it."""
    return part.name.endswith(("_screw", "_dowel"))


def beside(a: Part, b: Part) -> bool:
    """Whether two fasteners on one circle stand at angles that leave room between them."""
    turns = {
        (k / n * 2.0 * np.pi + part.phase_rad, part.name) for part in (a, b) for n in [part.count] for k in range(n)
    }
    radius = max(float(prism.outline.radius_mm) for prism in a.prisms) + max(
        float(prism.outline.radius_mm) for prism in b.prisms
    )
    return all(
        2.0 * a.pitch_radius_mm * abs(np.sin(0.5 * (one - other))) >= radius
        for (one, name), (other, its) in combinations(turns, 2)
        if name != its
    )


def overlaps_within(part: Part) -> list[str]:
    """Prisms of one part that share material, and holes that are not inside their outline."""
    own = rings_about_own_axis(part)
    found = [f"{part.name}: prisms overlap" for a, b in combinations(own, 2) if gap_mm(a, b) < -1e-9]
    for prism in part.prisms:
        r0, r1 = inner_mm(prism.holes), outer_mm(prism.outline)
        if isinstance(prism.outline, ExternalGear):
            r1 = float(prism.outline.root_radius_mm)
        if r1 <= r0:
            found.append(f"{part.name}: no wall between {r0} and {r1}")
        patterns = [hole for hole in prism.holes if isinstance(hole, Pattern)]
        for hole in patterns:
            if hole.pitch_radius_mm - hole.radius_mm < r0 or hole.pitch_radius_mm + hole.radius_mm > r1:
                found.append(f"{part.name}: holes {hole.pitch_radius_mm}+-{hole.radius_mm} not between {r0} and {r1}")
        discs = [(centre, float(hole.radius_mm)) for hole in patterns for centre in hole.centres_mm()]
        for (c, r), (d, s) in combinations(discs, 2):
            if ((c[0] - d[0]) ** 2 + (c[1] - d[1]) ** 2) ** 0.5 < r + s - 1e-9:
                found.append(f"{part.name}: two holes overlap")
                break
    return found


def pieces(part: Part) -> int:
    """Into how many pieces a part falls: prisms hold together where they share a face."""
    own = rings_about_own_axis(part)
    left, found = set(range(len(own))), 0
    while left:
        found += 1
        front = [left.pop()]
        while front:
            a = own[front.pop()]
            touching = [k for k in left if share_a_face(a, own[k])]
            left.difference_update(touching)
            front += touching
    return found


def share_a_face(a: Ring, b: Ring) -> bool:
    across = min(a.r1, b.r1) - max(a.r0, b.r0)
    along = min(a.z1, b.z1) - max(a.z0, b.z0)
    return (across > 0.4 and abs(along) < 1e-9) or (along > 0.4 and abs(across) < 1e-9)
