"""Whether the parts of an actuator fit together, from radii and heights alone: rings of material in r and z."""

from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import combinations

import numpy as np

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.cad.shape.outlines import all_polygons
from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Group, Role
from pareto_monoped.geometry.shapes import Circle, Path, Pattern, Shape, Spread

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


@lru_cache(maxsize=256)  # each part is compared with every other
def reach_mm(shape: Shape) -> tuple[float, float]:
    """Least and greatest distance from the axis."""
    distances = np.concatenate([np.hypot(*points.T) for points in all_polygons([shape])])
    return float(distances.min()), float(distances.max())


def outer_mm(shape: Shape) -> float:
    if isinstance(shape, Circle):
        return float(shape.radius_mm)
    if isinstance(shape, Spread | Path):
        return reach_mm(shape)[1]
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
        if isinstance(prism.outline, Spread):
            r0 = reach_mm(prism.outline)[0]
        if part.pitch_radius_mm:
            r0, r1 = part.pitch_radius_mm - r1, part.pitch_radius_mm + r1
        found += [ring_of(part, prism, r0, r1, place) for place in part.places_mm]
    return found


def ring_of(part: Part, prism: Prism, r0: float, r1: float, place: tuple[float, float, float]) -> Ring:
    return Ring(
        part=part.name,
        group=part.group,
        r0=r0,
        r1=r1,
        z0=float(prism.z0_mm + place[2]),
        z1=float(prism.z1_mm + place[2]),
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
        if isinstance(prism.outline, Spread):
            continue  # between the pins, see ``web_gap_mm``
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
        radius, middle = outer_mm(body.outline), float(screw.pitch_radius_mm)
        play = 0.2 if other.group != screw.group else 0.0
        for prism in other.prisms:
            if min(prism.z1_mm, body.z1_mm) - max(prism.z0_mm, body.z0_mm) < 1e-9 - play:
                continue
            if isinstance(prism.outline, Spread) and beside_webs_mm(prism.outline, screw) >= play:
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
    own = {part.name: rings(part) for part in actuator.parts}
    found = []
    for a, b in combinations(actuator.parts, 2):
        pair = frozenset((a.name, b.name))
        if pair in MESHING:
            continue
        if a.pitch_radius_mm and b.pitch_radius_mm:
            # Planet, bush, pin and its screw on one axis: nested, seen from that axis. All others: side by side.
            if a.phase_rad != b.phase_rad:
                needed = clearance_mm if a.group != b.group else 0.0
                if heights_overlap(own[a.name], own[b.name]) and side_by_side_mm(a, b) < needed:
                    found.append(f"{a.name} and {b.name}: {side_by_side_mm(a, b):.3f} mm, {needed} needed")
                continue
            one_axis = abs(a.pitch_radius_mm - b.pitch_radius_mm) < 1e-9
            rings_a, rings_b = (rings_about_own_axis(part) if one_axis else own[part.name] for part in (a, b))
        elif is_fastener(a) or is_fastener(b):
            screw, other = (a, b) if is_fastener(a) else (b, a)
            found += screw_clashes(screw, other)
            continue
        elif "planet_pin" in pair and pair & {"carrier", "secondary_carrier"}:
            carrier = parts["carrier"] if "carrier" in pair else parts["secondary_carrier"]
            if not holes_for_pins(carrier, parts["planet_pin"]):
                found.append(f"{carrier.name} has no holes for the pins")
            continue
        elif {a.role, b.role} >= {Role.CARRIER} and Group.PLANET in (a.group, b.group):
            carrier, planet = (a, b) if a.role is Role.CARRIER else (b, a)
            if web_gap_mm(carrier, planet) < clearance_mm:
                found.append(f"{carrier.name} and {planet.name}: {web_gap_mm(carrier, planet):.3f} mm between them")
            turned = replace(carrier, prisms=tuple(p for p in carrier.prisms if not isinstance(p.outline, Spread)))
            rings_a, rings_b = rings(turned), own[planet.name]
        else:
            rings_a, rings_b = own[a.name], own[b.name]
        rolling = {Role.BEARING, Role.BUSH} & {a.role, b.role} or "planet_washer" in pair
        turning = a.group != b.group and not rolling
        needed = clearance_mm if turning else 0.0
        least = min(gap_mm(x, y) for x in distinct(rings_a) for y in distinct(rings_b) if not x.fits(y))
        if least < needed - 1e-9:
            found.append(f"{a.name} and {b.name}: {least:.3f} mm, {needed} needed")
    return found


def web_gap_mm(carrier: Part, planet: Part) -> float:
    """Least distance of a carrier's webs from what turns with the planets, seen along the axis."""
    webs = [prism.outline for prism in carrier.prisms if isinstance(prism.outline, Spread)]
    if not webs:
        return float("inf")
    return min(beside_webs_mm(web, planet) for web in webs)


def beside_webs_mm(web: Spread, part: Part) -> float:
    """Least distance of webs from the instances of a part on a circle, seen along the axis."""
    reach = max(outer_mm(prism.outline) for prism in part.prisms)
    corners = np.concatenate(all_polygons([web], 0.001))
    return float(np.hypot(*(corners[:, None] - centres_mm(part)[None]).T).min()) - reach


def side_by_side_mm(a: Part, b: Part) -> float:
    """Least distance of two parts on circles, seen along the axis."""
    apart = np.hypot(*(centres_mm(a)[:, None] - centres_mm(b)[None]).T).min()
    return float(apart) - sum(max(outer_mm(prism.outline) for prism in part.prisms) for part in (a, b))


def distinct(found: list[Ring]) -> list[Ring]:
    """Rings of which no two have the same radii, heights and toothing: those of parts on a circle are all alike."""
    return list({(r.r0, r.r1, r.z0, r.z1, id(r.outline), id(r.holes)): r for r in found}.values())


def heights_overlap(a: list[Ring], b: list[Ring]) -> bool:
    return any(min(x.z1, y.z1) > max(x.z0, y.z0) for x in distinct(a) for y in distinct(b))


def centres_mm(part: Part) -> np.ndarray:
    """Centres of the instances of a part on a circle, shape (n, 2)."""
    angles = part.phase_rad + 2.0 * np.pi * np.arange(int(part.count)) / int(part.count)
    return float(part.pitch_radius_mm) * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def rings_about_own_axis(part: Part) -> list[Ring]:
    return [
        ring_of(part, prism, inner_mm(prism.holes), outer_mm(prism.outline), place)
        for prism in part.prisms
        for place in part.places_mm
    ]


def is_fastener(part: Part) -> bool:
    """Whether it stands in holes that other parts have for it."""
    return part.name.endswith(("_screw", "_dowel"))


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
    own = rings_about_own_axis(replace(part, places_mm=part.places_mm[:1]))
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
