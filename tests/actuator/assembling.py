"""Gearboxes put together from parts off their dimensions, without the package's chains.

Along the axis, every part is a stack of rings, from one height to another; two rings of different bodies that overlap
across the axis cannot pass each other. What positions that leaves to the bodies are difference constraints, whose
shortest paths (Floyd and Warshall) say whether the bodies can be put together at all, and how close those that must not
touch can come. Backlash comes from the involute at the true distance of the axes.
"""

import numpy as np

from pareto_monoped.actuator.bearings import axial_play_mm, rated_bearing
from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from pareto_monoped.geometry.shapes import Circle

ALPHA = np.radians(20.0)
# What is one rigid body, or moves as one; the rings of a bearing are two bodies.
HOUSING = ("casing", "ring_housing", "backplate")
ROTOR = ("coupling", "motor_rotor")
APART = [("housing", "carrier"), ("housing", "planet"), ("housing", "rotor"), ("carrier", "rotor"), ("planet", "rotor")]
"""Bodies that turn against each other; between planets and carrier stand washers."""
TURNING_MM = 0.05
PLACE = "place, set when bonded"


def annulus(prism):
    """The radii between which a prism has material around its own axis, or None for outlines beside the axis."""
    outline = prism.outline
    if isinstance(outline, Circle):
        outer = float(outline.radius_mm)
    elif isinstance(outline, ExternalGear):
        outer = float(outline.tip_radius_mm)
    else:
        return None
    inner = 0.0
    for hole in prism.holes:
        if isinstance(hole, Circle):
            inner = max(inner, float(hole.radius_mm))
        elif isinstance(hole, ExternalGear | InternalGear):
            inner = max(inner, float(hole.tip_radius_mm))
    return inner, outer


def levels(part, off, which=0):
    """Height of every face as drawn -> its true height, shape (n,): lengths move faces against each other."""
    heights = {round(float(z), 6) for prism in part.prisms for z in (prism.z0_mm, prism.z1_mm)}
    edges = [(round(float(one.z0_mm), 6), round(float(one.z1_mm), 6), one.name) for one in part.lengths]
    for low, high, _ in edges:
        assert {low, high} <= heights, f"{part.name}: a length that ends at no face"
    found = {}
    for start in sorted(heights, reverse=True):
        if start in found:
            continue
        found[start], waiting = np.zeros_like(next(iter(off.values()))) + start, [start]
        while waiting:
            here = waiting.pop()
            for low, high, name in edges:
                for near, far, sign in ((low, high, 1.0), (high, low, -1.0)):
                    if near == here and far not in found:
                        found[far] = found[here] + (far - near) + sign * off.get((part.name, name, which), 0.0)
                        waiting.append(far)
    return found


class Bodies:
    """All rings of all bodies: (inner, outer, low, high) with heights of shape (n,)."""

    def __init__(self):
        self.rings = {}

    def add(self, body, part, at, shift=0.0, radii=None):
        for prism in part.prisms:
            found = annulus(prism) if radii is None else radii
            if found is not None:
                low, high = (at[round(float(z), 6)] + shift for z in (prism.z0_mm, prism.z1_mm))
                self.rings.setdefault(body, []).append((*found, low, high, float(prism.z0_mm), float(prism.z1_mm)))


def put_together(actuator, off):
    """Whether each of n gearboxes can be put together and turns, along the axis; ``off`` has all deviations by key."""
    parts = {part.name: part for part in actuator.parts}
    n = len(next(iter(off.values())))
    at = {name: levels(part, off) for name, part in parts.items()}
    bodies = Bodies()
    shift = {}

    def meets(fixed, part, z):
        """``part`` stands on a face of what is already placed."""
        z = round(float(z), 6)
        shift[part] = at[fixed][z] + shift[fixed] - at[part][z]

    length = {(part.name, one.name): one for part in actuator.parts for one in part.lengths}
    if actuator.family == "ISSPG":
        shift["casing"] = np.zeros(n)
        meets("casing", "ring_housing", length["casing", "register"].z1_mm)
        meets("casing", "backplate", length["casing", "length"].z0_mm)
        rear = parts["rear_bearing"].prisms[0]
        meets("backplate", "rear_bearing", rear.z0_mm)
        meets("rear_bearing", "coupling", rear.z1_mm)
        meets("coupling", "motor_rotor", length["coupling", "height"].z1_mm)
    else:
        shift["ring_housing"] = np.zeros(n)
        meets("ring_housing", "casing", length["ring_housing", "length"].z0_mm)
        meets("casing", "motor_rotor", length["casing", "length"].z0_mm)
        meets("motor_rotor", "coupling", length["motor_rotor", "length"].z1_mm)
    for name in HOUSING:
        if name in shift:
            bodies.add("housing", parts[name], at[name], shift[name])
    for name in ROTOR:
        if name in shift:
            bodies.add("rotor", parts[name], at[name], shift[name])
    dowel = parts["coupling_dowel"]
    top = max(dowel.prisms, key=lambda p: float(p.z1_mm))
    radius, pitch = annulus(top)[1] if annulus(top) else 1.25, float(dowel.pitch_radius_mm)
    out = off.get(("coupling_dowel", "stands out", 0), 0.0)
    face = "motor_rotor" if actuator.family == "ISSPG" else "coupling"
    high = max(z for z in at[face] if z < float(top.z1_mm) + 1e-6)
    tip = at[face][high] + shift[face] + float(top.z1_mm) - high + out
    bodies.rings["rotor"].append((pitch - radius, pitch + radius, tip - 1.0, tip, high - 1.0, float(top.z1_mm)))
    # The second carrier on its webs, or at the ends of the pins.
    carrier, second = at["carrier"], at["secondary_carrier"]
    front = max(second)
    if ("carrier", "web") in length:
        second_at = carrier[round(float(length["carrier", "web"].z0_mm), 6)]
    else:
        hole, pin, back = (
            length["carrier", "pin hole"],
            length["planet_pin", "length"],
            length["secondary_carrier", "pin hole"],
        )
        long = pin.nominal_mm + off["planet_pin", "length", 0]
        second_at = (
            carrier[round(float(hole.z1_mm), 6)] - long + (back.nominal_mm + off["secondary_carrier", "pin hole", 0])
        )
    bodies.add("carrier", parts["carrier"], carrier)
    bodies.add("carrier", parts["secondary_carrier"], second, second_at - second[front])
    for name in ("retaining_ring", "bore_retaining_ring", "ring"):
        if name in parts:
            bodies.add(name, parts[name], at[name])
    main = parts["main_bearing"]
    inner, outer = annulus(main.prisms[0])
    third = (outer - inner) / 3.0
    bodies.add("inner", main, at["main_bearing"], radii=(inner, inner + third))
    bodies.add("outer", main, at["main_bearing"], radii=(outer - third, outer))
    rp = float(parts["planet"].pitch_radius_mm)

    def around(part):
        reach = annulus(part.prisms[0])[1]
        return rp - reach, rp + reach

    bodies.add("planet", parts["planet"], at["planet"], radii=around(parts["planet"]))
    if "planet_washer" in parts:
        washer = parts["planet_washer"]
        for which, place in enumerate(washer.places_mm):
            heights = levels(washer, off, which)
            low, high = min(heights), max(heights)
            z = float(place[2])
            r = around(washer)
            entry = (*r, z + heights[low], z + heights[high], z + low, z + high)
            bodies.rings.setdefault(f"washer {which}", []).append(entry)
    else:
        pressed = off.get(("planet_bush", "stands out", 0), 0.0)
        bodies.add("planet", parts["planet_bush"], at["planet_bush"], pressed, radii=around(parts["planet_bush"]))
    names = list(bodies.rings)
    # far[a, b]: how far body a can be above body b at most, off their drawn places.
    far = np.full((len(names), len(names), n), np.inf)
    for a, first in enumerate(names):
        far[a, a] = 0.0
        for b, other in enumerate(names):
            if a != b:
                far[a, b] = room(bodies.rings[first], bodies.rings[other], n)
    play = 0.5 * axial_play_mm(rated_bearing(2.0 * inner))
    between = off.get(("main_bearing", "axial play", 0), np.full(n, play))
    i, o = names.index("inner"), names.index("outer")
    far[i, o], far[o, i] = np.minimum(far[i, o], between), np.minimum(far[o, i], between)
    # A body meets another through others as well.
    contact = far.copy()
    for pair in APART:
        a, b = (names.index(name) for name in pair)
        contact[a, b] = contact[b, a] = np.inf
    # Bearings and bonds hold the rotor where it is.
    housing, rotor = names.index("housing"), names.index("rotor")
    contact[housing, rotor] = contact[rotor, housing] = 0.0
    for k in range(len(names)):
        contact = np.minimum(contact, contact[:, k, None] + contact[None, k, :])
    fits = np.array([contact[k, k] >= -1e-9 for k in range(len(names))]).all(axis=0)
    for pair in APART:
        a, b = (names.index(name) for name in pair)
        for one, other in ((a, b), (b, a)):
            if np.isfinite(far[one, other]).all():
                fits &= far[one, other] - contact[one, other] >= TURNING_MM - 1e-9
    return fits & float_of_planets(names, contact)


def room(lower, upper, n):
    """By how much one body can rise before one of its rings meets a ring of the other that is drawn above it."""
    found = np.full(n, np.inf)
    for inner, outer, _, high, _, drawn in lower:
        for other_in, other_out, low, _, drawn_low, _ in upper:
            if min(outer, other_out) - max(inner, other_in) > 1e-3 and drawn <= drawn_low + 1e-6:
                found = np.minimum(found, low - high)
    return found


def float_of_planets(names, contact):
    """The planets move a little between the carriers, so that they turn."""
    c, p = names.index("carrier"), names.index("planet")
    return contact[p, c] + contact[c, p] >= TURNING_MM - 1e-9


def pins_fit(actuator, off):
    """Whether the pins leave the second carrier on its webs."""
    parts = {part.name: part for part in actuator.parts}
    carrier, pin, second = (levels(parts[name], off) for name in ("carrier", "planet_pin", "secondary_carrier"))
    length = {(part.name, one.name): one for part in actuator.parts for one in part.lengths}
    if ("carrier", "web") not in length:
        return True
    web, hole = length["carrier", "web"], length["carrier", "pin hole"]
    depth = length["secondary_carrier", "pin hole"]

    def gap(at, one):
        return abs(at[round(float(one.z1_mm), 6)] - at[round(float(one.z0_mm), 6)])

    long = abs(max(pin.items())[1] - min(pin.items())[1])
    return gap(carrier, web) + gap(carrier, hole) + gap(second, depth) - long >= -1e-9


def inv(angle):
    return np.tan(angle) - angle


def meshes(actuator, off):
    """Whether both meshes keep some backlash, from the involute at the true distance of the axes."""
    gears = actuator.gears
    sun, planet, ring = gears.sun(), gears.planet(), gears.ring()
    module, distance = float(gears.module_mm), float(gears.carrier_radius_mm)

    def thickness(part, gear, sign):
        """Of a tooth (or of a ring's tooth) on the reference circle."""
        thin = off.get((part, "thinning of teeth", 0), 0.0) + float(gear.backlash_mm)
        shifted = sign * 2.0 * float(gear.shift) * module * np.tan(ALPHA)
        return 0.5 * np.pi * module + shifted - thin

    def off_centre(*keys):
        return sum(off.get(key, 0.0) for key in keys)

    pin = off_centre(("carrier", "place of the pin", 0), ("planet", "eccentricity", 0))
    at_sun = distance + pin + off_centre(("carrier", "place of the end bearing", 0), ("sun", "eccentricity", 0))
    at_ring = distance + pin - off_centre(("ring", "place, set when bonded", 0), ("ring", "eccentricity", 0))
    z1, z2, z3 = (float(gear.teeth) for gear in (sun, planet, ring))

    def working(axis, teeth):
        return np.arccos(0.5 * module * teeth * np.cos(ALPHA) / axis)

    def arc(gear, teeth, own, radius, angle, sign):
        return 2.0 * radius * (own / (module * teeth) + sign * (inv(ALPHA) - inv(angle)))

    angle = working(at_sun, z1 + z2)
    r1, r2 = at_sun * z1 / (z1 + z2), at_sun * z2 / (z1 + z2)
    pitch = 2.0 * np.pi * r1 / z1
    outer = pitch - arc(sun, z1, thickness("sun", sun, 1.0), r1, angle, 1.0)
    outer = outer - arc(planet, z2, thickness("planet", planet, 1.0), r2, angle, 1.0)
    angle = working(at_ring, z3 - z2)
    r2, r3 = at_ring * z2 / (z3 - z2), at_ring * z3 / (z3 - z2)
    pitch = 2.0 * np.pi * r2 / z2
    # A ring's tooth grows outwards: its arc takes the involute with the other sign.
    inner = pitch - arc(planet, z2, thickness("planet", planet, 1.0), r2, angle, 1.0)
    inner = inner - arc(ring, z3, thickness("ring", ring, -1.0), r3, angle, -1.0)
    return (outer >= 0.0) & (inner >= 0.0)


def tips_run(actuator, off):
    """Whether tips keep 0.05 modules from their mates' roots on the line of centres, and 0.3 modules of their width.

    The rack that cuts a space fills it; its tip is 1.25 modules below the line on which it is as wide as its gaps.
    """
    gears = actuator.gears
    module, fits = float(gears.module_mm), True

    def at(part, name):
        return off.get((part, name, 0), 0.0)

    shapes = {"sun": gears.sun(), "planet": gears.planet(), "ring": gears.ring()}
    pin = float(gears.carrier_radius_mm) + at("carrier", "place of the pin") + at("planet", "play on its pin")
    axis = {"sun": -at("carrier", "place of the end bearing"), "planet": pin, "ring": at("ring", PLACE)}
    # The axis to which the sun is moved away from the planet lies on its other side.
    sides = {"sun": -1.0, "planet": 1.0, "ring": 1.0}
    teeth_at = {part: axis[part] + sides[part] * at(part, "eccentricity") for part in shapes}
    tips_at = {part: axis[part] + sides[part] * at(part, "eccentricity of tips") for part in shapes}
    tip_mm, root_mm = {}, {}
    for part, gear in shapes.items():
        pitch, inner = 0.5 * module * float(gear.teeth), part == "ring"
        thin = float(gear.backlash_mm) + at(part, "thinning of teeth")
        outwards = -float(gear.shift) if inner else float(gear.shift)
        thick = 0.5 * np.pi * module + 2.0 * outwards * module * np.tan(ALPHA) - thin
        tip_mm[part] = float(gear.tip_radius_mm) + 0.5 * at(part, "tip diameter")
        root_mm[part] = pitch + 0.5 * (thick - 0.5 * np.pi * module) / np.tan(ALPHA) - 1.25 * module
        if inner:
            root_mm[part] = pitch + (1.25 + float(gear.shift)) * module
        # Off its teeth, a tip circle cuts one tooth as if it were larger.
        radius = tip_mm[part] + at(part, "eccentricity of tips") - at(part, "eccentricity")
        if not inner:
            radius = tip_mm[part] + at(part, "eccentricity") - at(part, "eccentricity of tips")
        lean = inv(np.arccos(pitch * np.cos(ALPHA) / radius)) - inv(ALPHA)
        wide = 2.0 * radius * (0.5 * thick / pitch + (lean if inner else -lean))
        fits &= wide >= 0.3 * module - 1e-9
    gaps = (
        teeth_at["planet"] - root_mm["planet"] - tips_at["sun"] - tip_mm["sun"],
        tips_at["planet"] - tip_mm["planet"] - teeth_at["sun"] - root_mm["sun"],
        teeth_at["ring"] + root_mm["ring"] - tips_at["planet"] - tip_mm["planet"],
        tips_at["ring"] + tip_mm["ring"] - teeth_at["planet"] - root_mm["planet"],
    )
    return fits & np.all([gap >= 0.05 * module - 1e-9 for gap in gaps], axis=0)


def bearings_run(off):
    """Whether all bearings keep clearance: of the smaller bore on the larger shaft, 0.85 is lost (Harris, ch. 3)."""
    fits = True
    for name in {key[0] for key in off if key[1] == "radial clearance"}:
        tight = np.maximum(off[name, "shaft", 0] - off[name, "bore", 0], 0.0)
        fits &= off[name, "radial clearance", 0] - 0.85 * tight >= 0.0
    return fits


def rings_in_grooves(actuator, off):
    """Whether the retaining rings go into their grooves."""
    fits = True
    for ring, held in (("retaining_ring", "carrier"), ("bore_retaining_ring", "ring_housing")):
        parts = {part.name: part for part in actuator.parts}
        if ring in parts:
            groove = next(one for one in parts[held].lengths if one.name == "groove")
            thick = next(one for one in parts[ring].lengths if one.name == "thickness")
            wide = groove.nominal_mm + off[held, "groove", 0]
            fits &= wide >= thick.nominal_mm + off[ring, "thickness", 0]
    return fits
