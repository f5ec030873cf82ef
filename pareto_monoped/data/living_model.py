"""The robot of this folder as a model that can be changed, with build123d alone.

    python model.py                               all solids, and the assembly, as STEP into changed/
    python model.py thigh_length=330 hip_module=0.6   the same with other drivers
    python model.py --parts thigh_plate_inner     some parts only
    python model.py --changed thigh_length=330    only the parts that differ from those of the drivers as they stand
    python model.py --list                        the drivers with their values
    python model.py --out FOLDER                  into another folder

Section 1 has the drivers: change them here or on the command line. Section 2 has the equations that follow from them,
section 3 what shapes are made of, section 4 the parts, section 5 the assembly with its joints. Lengths are in mm,
angles of drivers in degrees, all others in radians. Parts lie in the frames of their units: z along the joints' axes.
"""

import re
import runpy
import sys
from io import BytesIO
from itertools import pairwise
from math import acos, asin, atan, atan2, ceil, cos, degrees, floor, hypot, pi, radians, sin, sqrt, tan  # noqa: F401
from pathlib import Path

from build123d import (
    Align,
    Axis,
    Box,
    Color,
    Compound,
    Edge,
    Face,
    Location,
    Plane,
    Pos,
    RevoluteJoint,
    RigidJoint,
    Rot,
    Solid,
    Sphere,
    Vector,
    Wire,
    export_step,
)
from OCP.Interface import Interface_Static
from OCP.STEPCAFControl import STEPCAFControl_Controller


def given(names):
    """Replace drivers by those of the command line."""
    for text in sys.argv[1:] if __name__ == "__main__" else ():
        name, equals, value = text.partition("=")
        if equals and not name.startswith("-"):
            if name not in DRIVERS:
                sys.exit(f"{name}: is no driver; see python model.py --list")
            names[name] = float(value)


# <drivers and equations>
DRIVERS = {}
rack_addendum, rack_dedendum, rack_fillet, rack_pressure_angle = 1.0, 1.25, 0.38, 20.0
hip_angle = knee_angle = thigh_length = 0.0
# </drivers and equations>
# ---------------------------------------------------------------------------------------------------------------------
# 3. SHAPES: outlines are lists of pieces, each ("line", x0, y0, x1, y1), ("arc", x, y, radius, start, end) or
# ("spline", points); round ones are ("circle", x, y, radius).
# ---------------------------------------------------------------------------------------------------------------------
PARTS, UNITS = {}, []


def circle(radius, x=0.0, y=0.0):
    """Disc."""
    return [[("circle", x, y, radius)]]


def pattern(radius, pitch_radius, count, phase=0.0, x=0.0, y=0.0):
    """Discs evenly spread on a circle."""
    angles = [phase + 2 * pi * k / round(count) for k in range(round(count))]
    return [[("circle", x + pitch_radius * cos(a), y + pitch_radius * sin(a), radius)] for a in angles]


def path(*pieces):
    """Outline of lines and arcs."""
    return [list(pieces)]


def line(x0, y0, x1, y1):
    """Straight piece of an outline."""
    return ("line", x0, y0, x1, y1)


def arc(x, y, radius, start, end):
    """Round piece of an outline, from one angle to another."""
    return ("arc", x, y, radius, start, end)


def turned(pieces, angle):
    """Pieces of an outline turned about the origin."""
    found = []
    for kind, *numbers in pieces:
        if kind == "line":
            found.append(("line", *turn(numbers[0], numbers[1], angle), *turn(numbers[2], numbers[3], angle)))
        elif kind == "arc":
            x, y, radius, start, end = numbers
            found.append(("arc", *turn(x, y, angle), radius, start + angle, end + angle))
        else:
            found.append(("spline", [turn(*point, angle) for point in numbers[0]]))
    return found


def turn(x, y, angle):
    """Point turned about the origin."""
    return x * cos(angle) - y * sin(angle), x * sin(angle) + y * cos(angle)


def spread(one, count, phase=0.0):
    """The same outline repeated around the origin."""
    return [turned(one[0], phase + 2 * pi * k / round(count)) for k in range(round(count))]


def polygon(points):
    """Polygon through points, anticlockwise."""
    return [[("line", *one, *other) for one, other in zip(points, [*points[1:], points[0]], strict=True)]]


def rectangle(width, height, x=0.0, y=0.0):
    """Rectangle around a point."""
    w, h = width / 2, height / 2
    return polygon([(x - w, y - h), (x + w, y - h), (x + w, y + h), (x - w, y + h)])


def hexagon(flats, phase=0.0):
    """Hexagon, two of its flats across the x axis."""
    corner = flats / sqrt(3)
    return polygon([(corner * cos(phase + pi / 6 + k * pi / 3), corner * sin(phase + pi / 6 + k * pi / 3))
                    for k in range(6)])  # fmt: skip


def rounded(half_width, high, low, corner):
    """Upright rectangle on the y axis with round corners."""
    x, top, end = half_width - corner, high - corner, low + corner
    return belt([(x, top, corner), (-x, top, corner), (-x, end, corner), (x, end, corner)])


def hull(top_radius, bottom_radius, length, y=0.0):
    """Hull of two discs, the lower one ``length`` below the upper one at height y."""
    return belt([(0.0, y, top_radius), (0.0, y - length, bottom_radius)])


def rounded_hull(points, radius):
    """Hull of discs of one radius."""
    rest, hull_points = sorted(points), []
    for side in (rest, rest[::-1]):
        part = []
        for point in side:
            while len(part) > 1 and (
                (part[-1][0] - part[-2][0]) * (point[1] - part[-2][1])
                <= (part[-1][1] - part[-2][1]) * (point[0] - part[-2][0])
            ):
                part.pop()
            part.append(point)
        hull_points += part[:-1]
    return belt([(x, y, radius) for x, y in hull_points])


def belt(pulleys):
    """Outline that runs anticlockwise around pulleys (x, y, radius) on tangents; a negative radius makes a fillet."""
    normals = []
    for (x0, y0, s0), (x1, y1, s1) in zip(pulleys, [*pulleys[1:], pulleys[0]], strict=True):
        normals.append(atan2(y1 - y0, x1 - x0) - acos((s0 - s1) / hypot(x1 - x0, y1 - y0)))
    pieces = []
    for k, (x, y, s) in enumerate(pulleys):
        before, after = normals[k - 1], normals[k]
        if s > 0:
            start, sweep = before, (after - before + 1e-9) % (2 * pi) - 1e-9
        else:
            start, sweep = before + pi, 1e-9 - (before - after + 1e-9) % (2 * pi)
        parts = 2 if abs(sweep) > 3 else 1
        for j in range(parts):
            pieces.append(("arc", x, y, abs(s), start + sweep * j / parts, start + sweep * (j + 1) / parts))
        x1, y1, s1 = pulleys[(k + 1) % len(pulleys)]
        cx, cy = cos(after), sin(after)
        pieces.append(("line", x + s * cx, y + s * cy, x1 + s1 * cx, y1 + s1 * cy))
    return [pieces]


def sprocket(teeth, pitch, roller):
    """Chain sprocket (ISO 606), the middle of a tooth gap on the x axis: seats, tangents, tips."""
    pitch_radius, seat = 0.5 * pitch / sin(pi / teeth), 0.505 * roller
    tip = pitch_radius + 0.25 * (pitch * (1 - 1.6 / teeth) + 1.25 * pitch) - 0.5 * roller
    half = radians(0.5 * (140 - 90 / teeth))
    end = (pitch_radius - seat * cos(half), seat * sin(half))
    along = (sin(half), cos(half))
    inwards = end[0] * along[0] + end[1] * along[1]
    reach = sqrt(inwards**2 + tip**2 - end[0] ** 2 - end[1] ** 2) - inwards
    rim = (end[0] + reach * along[0], end[1] + reach * along[1])
    rim_angle, step = atan2(rim[1], rim[0]), 2 * pi / teeth
    gap = [
        ("line", rim[0], -rim[1], end[0], -end[1]),
        ("arc", pitch_radius, 0.0, seat, pi + half, pi - half),
        ("line", *end, *rim),
        ("arc", 0.0, 0.0, tip, rim_angle, step - rim_angle),
    ]
    return [[piece for k in range(round(teeth)) for piece in turned(gap, k * step)]]


RACK_ANGLE = radians(rack_pressure_angle)
POINTS = 8  # of the splines along a flank and along a root


def half_angle(teeth, module, shift, alpha, radius):
    """Half angle of a tooth, or of a ring's space, at a radius: pi / 2z + 2x tan(a) / z + inv(a) - inv(a_r)."""
    roll = sqrt(max((radius / (0.5 * module * teeth * cos(alpha))) ** 2 - 1, 0.0))
    return (0.5 * pi + 2 * shift * tan(alpha)) / teeth + tan(alpha) - alpha - (roll - atan(roll))


def flank(teeth, module, shift, alpha, start, end):
    """Points of an involute between two radii, evenly spaced in roll angle."""
    base, found = 0.5 * module * teeth * cos(alpha), []
    low, high = (sqrt(max(radius**2 - base**2, 0.0)) for radius in (start, end))
    for k in range(POINTS):
        radius = hypot(base, low + (high - low) * k / (POINTS - 1))
        angle = half_angle(teeth, module, shift, alpha, radius)
        found.append((radius * cos(angle), radius * sin(angle)))
    return found


def cut_by_rack(teeth, shift, theta, alpha):
    """Point of a root in modules, from the gear's axis along the middle of the space, and across: a trochoid."""
    depth, rolled = rack_dedendum - rack_fillet - shift, 0.5 * teeth
    across, along = depth * tan(theta) + rack_fillet * sin(theta), rolled - depth - rack_fillet * cos(theta)
    middle = 0.25 * pi - rack_dedendum * tan(alpha) - rack_fillet * (1 - sin(alpha)) / cos(alpha)
    rolled_by = (depth * tan(theta) - middle) / rolled
    return along * cos(rolled_by) + across * sin(rolled_by), across * cos(rolled_by) - along * sin(rolled_by)


def root_end(teeth, shift, alpha):
    """Angle at which the root goes over into the flank: the end of the rack's rounding, or before if undercut."""
    end = 0.5 * pi - alpha
    if rack_dedendum - rack_fillet * (1 - sin(alpha)) - shift > 0.5 * teeth * sin(alpha) ** 2:
        low, high = 0.0, end
        for _ in range(40):
            middle = 0.5 * (low + high)
            along, across = cut_by_rack(teeth, shift, middle, alpha)
            tangent = (hypot(along, across) / (0.5 * teeth * cos(alpha))) ** 2 - 1
            roll = sqrt(max(tangent, 0.0))
            space = (0.5 * pi - 2 * shift * tan(alpha)) / teeth - (tan(alpha) - alpha) + roll - atan(roll)
            if tangent < 0 or atan2(across, along) > space:
                low = middle
            else:
                high = middle
        end = low
    return end


def root(teeth, shift, alpha):
    """Points of a root, evenly spaced, in modules."""
    end, fine = root_end(teeth, shift, alpha), 50 * POINTS
    thetas = [end * k / (fine - 1) for k in range(fine)]
    points = [cut_by_rack(teeth, shift, theta, alpha) for theta in thetas]
    along = [0.0]
    for (x0, y0), (x1, y1) in pairwise(points):
        along.append(along[-1] + hypot(x1 - x0, y1 - y0))
    found, k = [], 0
    for wanted in (along[-1] * j / (POINTS - 1) for j in range(POINTS)):
        while k < fine - 2 and along[k + 1] < wanted:
            k += 1
        share = min((wanted - along[k]) / (along[k + 1] - along[k]), 1.0)
        found.append(cut_by_rack(teeth, shift, thetas[k] + share * (thetas[k + 1] - thetas[k]), alpha))
    return found


def toothed(teeth, phase, half, far, far_angle, near, near_angle):
    """Closed outline from the upper half of a tooth or space around the x axis, whose pieces run outwards."""
    step, pieces = 2 * pi / round(teeth), []
    for k in range(round(teeth)):
        for kind, *numbers in half:
            if kind == "arc":
                x, y, radius, start, end = numbers
                lower = ("arc", x, -y, radius, -start, -end)
            else:
                lower = ("spline", [(x, -y) for x, y in numbers[0]])
            pieces += turned([lower], phase + k * step)
        pieces.append(("arc", 0.0, 0.0, far, phase + k * step - far_angle, phase + k * step + far_angle))
        for kind, *numbers in reversed(half):
            if kind == "arc":
                x, y, radius, start, end = numbers
                upper = ("arc", x, y, radius, end, start)
            else:
                upper = ("spline", numbers[0][::-1])
            pieces += turned([upper], phase + k * step)
        pieces.append(("arc", 0.0, 0.0, near, phase + k * step + near_angle, phase + (k + 1) * step - near_angle))
    return [pieces]


def gear(teeth, module, shift=0.0, backlash=0.0, tip_shortening=0.0, phase=0.0, alpha=RACK_ANGLE):
    """Spur gear as a rack cuts it: involutes, and trochoids at the roots; a tooth at ``phase``."""
    cut = shift - 0.5 * backlash / (module * tan(alpha))
    tip = module * (0.5 * teeth + rack_addendum + shift - tip_shortening)
    space = [(module * x, -module * y) for x, y in root(teeth, cut, alpha)]
    space = [turn(x, y, pi / teeth) for x, y in space]
    form = hypot(*space[-1])
    half = [("spline", space), ("spline", flank(teeth, module, cut, alpha, form, tip))]
    near = module * (0.5 * teeth - rack_dedendum + cut)
    tip_angle = half_angle(teeth, module, cut, alpha, tip)
    return toothed(teeth, phase, half, tip, tip_angle, near, atan2(space[0][1], space[0][0]))


def ring_gear(teeth, module, shift=0.0, backlash=0.0, tip_shortening=0.0, phase=0.0, alpha=RACK_ANGLE):
    """Toothed hole of a ring: involutes, and arcs at the roots; a space at ``phase``."""
    cut = shift + 0.5 * backlash / (module * tan(alpha))
    tip = module * (0.5 * teeth - rack_addendum + shift + tip_shortening)
    far, fillet = module * (0.5 * teeth + rack_dedendum + shift), rack_fillet * module
    base = 0.5 * module * teeth * cos(alpha)
    form = hypot(base, sqrt(max((far - fillet) ** 2 - base**2, 0.0)) + fillet)
    middle = half_angle(teeth, module, cut, alpha, far - fillet) - fillet / base
    x, y = (far - fillet) * cos(middle), (far - fillet) * sin(middle)
    touch = half_angle(teeth, module, cut, alpha, form)
    start = atan2(form * sin(touch) - y, form * cos(touch) - x)
    sweep = (middle - start + pi) % (2 * pi) - pi
    half = [("spline", flank(teeth, module, cut, alpha, tip, form)), ("arc", x, y, fillet, start, start + sweep)]
    return toothed(teeth, phase, half, far, middle, tip, half_angle(teeth, module, cut, alpha, tip))


def slab(outline, low, high, *holes):
    """Outline with holes, extruded from one height to another."""
    return ("slab", outline, low, high, [contour for hole in holes for contour in hole])


def mouth(at, edge, face, end):
    """Countersinks or chamfers of holes: cones from the radius ``edge`` in the face to that of the holes."""
    return ("cut", at, edge, face, end)


def chamfer(at, edge, face, end):
    """Chamfers of shafts: all that is outside a cone from the radius ``edge`` in the face to that of the shafts."""
    return ("turn", at, edge, face, end)


def head(at, edge, face, end):
    """Countersunk heads: cones that are added."""
    return ("add", at, edge, face, end)


def ball(radius, y, top, pocket=None):
    """Ball on the y axis, cut flat at the height ``top`` above its centre, with a pocket."""
    return ("ball", radius, y, top, pocket)


def wire(contour, z):
    """Contour as a wire at a height."""
    if contour[0][0] == "circle":
        _, x, y, radius = contour[0]
        return Wire([Edge.make_circle(radius, Plane((x, y, z)))])
    edges = []
    for kind, *numbers in contour:
        if kind == "line":
            x0, y0, x1, y1 = numbers
            edges.append(Edge.make_line((x0, y0, z), (x1, y1, z)))
        elif kind == "arc":
            x, y, radius, start, end = numbers
            angles = (start, 0.5 * (start + end), end)
            points = [(x + radius * cos(a), y + radius * sin(a), z) for a in angles]
            edges.append(Edge.make_three_point_arc(*points))
        else:
            edges.append(Edge.make_spline([(x, y, z) for x, y in numbers[0]]))
    return Wire(edges)


def extruded(outline, low, high, holes):
    """Solids of a slab; several contours share the holes."""
    up = Vector(0, 0, high - low)
    if len(outline) == 1:
        return [Solid.extrude(Face(wire(outline[0], low), [wire(hole, low) for hole in holes]), up)]
    solids = [Solid.extrude(Face(wire(contour, low)), up) for contour in outline]
    tools = [Solid.extrude(Face(wire(hole, low)), up) for hole in holes]
    return [body for solid in solids for body in (solid.cut(*tools).solids() if tools else [solid])]


def cone(x, y, edge, radius, face, end):
    """Cone between the radius ``edge`` at the height ``face`` and ``radius`` at ``end``."""
    plane = Plane((x, y, face), z_dir=(0, 0, 1 if end > face else -1))
    return Solid.make_cone(edge, radius, abs(end - face), plane)


def together(steps):
    """Steps of the same body: slices of teeth become one with the widest bore, and rings fill it where it is narrower.

    To unite slices along all their flanks would take the kernel seconds.
    """
    slices = [s for s in steps if s[0] == "slab" and len(s[1][0]) > 40 and len(s[4]) == 1 and s[3] - s[2] > 1e-9]
    slices.sort(key=lambda s: s[2])
    joined = all(one[1] == next_one[1] and abs(one[3] - next_one[2]) < 1e-9 for one, next_one in pairwise(slices))
    if len(slices) < 2 or not joined or any(len(s[4][0]) != 1 or s[4][0][0][1:3] != (0.0, 0.0) for s in slices):
        return steps
    widest = max((s[4][0] for s in slices), key=lambda bore: bore[0][3])
    rings = [slab([widest], s[2], s[3], [s[4][0]]) for s in slices if widest[0][3] - s[4][0][0][3] > 1e-9]
    whole = slab(slices[0][1], slices[0][2], slices[-1][3], [widest])
    return [whole, *rings, *(s for s in steps if s not in slices)]


def build(steps):
    """Solid of a part from its steps; a compound if it has several bodies."""
    steps = together(steps)
    bodies, cuts = [], []
    for step in steps:
        if step[0] in ("cut", "turn"):
            for ((_, x, y, radius),) in step[1]:
                if step[0] == "cut" and step[2] != radius:
                    cuts.append((min(step[3:]), max(step[3:]), cone(x, y, step[2], radius, *step[3:])))
                elif step[0] == "turn" and step[2] != radius:
                    low, high = min(step[3:]), max(step[3:])
                    around = Solid.make_cylinder(2 * radius, high - low, Plane((x, y, low)))
                    cuts.append((low, high, around.cut(cone(x, y, step[2], radius, *step[3:]))))
    for step in steps:
        if step[0] == "slab" and step[3] - step[2] > 1e-9:
            bodies += extruded(*step[1:])
        elif step[0] == "add":
            for ((_, x, y, radius),) in step[1]:
                bodies.append(cone(x, y, step[2], radius, *step[3:]))
        elif step[0] == "ball":
            _, radius, y, top, pocket = step
            above = Pos(0, y + top, 0) * Box(
                2 * radius, radius, 2 * radius, align=(Align.CENTER, Align.MIN, Align.CENTER)
            )
            shape = Pos(0, y, 0) * Sphere(radius) - above
            bodies += shape.cut(*extruded(*pocket[1:])).solids() if pocket else shape.solids()
    shape = bodies[0] if len(bodies) == 1 else bodies[0].fuse(*bodies[1:])
    if cuts:
        shape = shape.cut(*(tool for *_, tool in cuts))
    solids = shape.solids()
    return solids[0] if len(solids) == 1 else Compound(solids)


def part(material, density, colour, made):
    """Register a part: the function below it returns its steps."""

    def register(steps):
        PARTS[steps.__name__] = (steps, material, density, colour, made)
        return steps

    return register


def unit(name, body, z, over, *members):
    """Register a group of parts that a body carries, its origin at z along the joint's axis; ``over``: turned over."""
    UNITS.append((name, body, z, over, members))


def use(steps, places=((0.0, 0.0, 0.0),), radius=0.0, count=1, phase=0.0, moves=lambda place: (0.0, 0.0)):
    """Instances of a part: on circles around places, or at these.

    ``moves`` gives for an angle on the circle by what the circle turns, and by what the part turns on its place.
    """
    return steps.__name__, places, radius, round(count), phase, moves


# <parts and assembly>
hip_range = knee_range = (-180.0, 180.0)
CONDITIONS = []


# </parts and assembly>
# ---------------------------------------------------------------------------------------------------------------------
# 6. RUN
# ---------------------------------------------------------------------------------------------------------------------
def locations(member, z, over):
    """Places of a part's instances in its body's frame: x forward, y to the left along the joints' axes, z up."""
    _, places, radius, count, phase, moves = member
    frame = Rot(90, 0, 0) * Pos(0, 0, z) * (Rot(180, 0, 0) if over else Location())
    for place in places:
        for k in range(count):
            around, own = moves(2 * pi * k / count)
            if radius == 0.0:
                yield frame * Pos(*place) * Rot(0, 0, degrees(around))
            else:
                at = Rot(0, 0, degrees(around + phase + 2 * pi * k / count)) * Pos(radius, 0, 0)
                yield frame * Pos(*place) * at * Rot(0, 0, degrees(own))


def solid(name):
    """Solid of a part with its name, colour and material."""
    steps, _, _, colour, _ = PARTS[name]
    shape = build(steps())
    shape.label, shape.color = name, Color(*colour)
    return shape


def assembly(solids):
    """The robot: base, thigh and shank, each a compound of its units, joined by hip and knee."""
    bodies = {"base": [], "thigh": [], "shank": []}
    for name, body, z, over, members in UNITS:
        children = []
        for member in members:
            for location in locations(member, z, over):
                copy = solids[member[0]].moved(location)
                copy.label, copy.color = member[0], solids[member[0]].color
                children.append(copy)
        bodies[body].append(Compound(label=name, children=children))
    base, thigh, shank = (Compound(label=name, children=units) for name, units in bodies.items())
    # Both axes are named before anything moves.
    y = Axis((0, 0, 0), (0, 1, 0))
    hip = RevoluteJoint("hip", base, y, angular_range=hip_range)
    knee = RevoluteJoint("knee", thigh, Axis((0, 0, -thigh_length), (0, 1, 0)), angular_range=knee_range)
    hip.connect_to(RigidJoint("hip", thigh, y.location), angle=hip_angle)
    knee.connect_to(RigidJoint("knee", shank, y.location), angle=knee_angle)
    return Compound(label="monoped", children=[base, thigh, shank])


def broken():
    """Conditions under which the parts have this form, and which the drivers break."""
    return [text for text in CONDITIONS if not eval(text)]  # noqa: S307


def write(shape, path):
    """Write a shape as STEP: AP242, which build123d's header does not name, with materials, which it does not write."""
    STEPCAFControl_Controller.Init_s()
    Interface_Static.SetCVal_s("write.step.schema", "AP242DIS")
    stream = BytesIO()
    export_step(shape, stream, timestamp="2025-01-01T00:00:00")
    schema = "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF {1 0 10303 442 1 1 4 }"
    text = stream.getvalue().decode().replace("AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }", schema)
    path.write_text(text.replace("ENDSEC;\nEND-ISO", "".join(materials(text)) + "ENDSEC;\nEND-ISO"))


def materials(text):
    """Entities that give the products of a STEP file their materials and densities, in g/cm3."""
    products = dict(re.findall(r"#(\d+) = PRODUCT\('([^']*)'", text))
    versions = dict(re.findall(r"#(\d+) = PRODUCT_DEFINITION_FORMATION\w*\([^#]*#(\d+)", text))
    (context, *_) = re.findall(r"#(\d+) = \( GEOMETRIC_REPRESENTATION_CONTEXT\(3\)", text)
    number = max(int(found) for found in re.findall(r"^#(\d+) =", text, re.M))
    for definition, version in re.findall(r"#(\d+) = PRODUCT_DEFINITION\([^#]*#(\d+)", text):
        _, material, density, *_ = PARTS.get(products[versions[version]], (None, None, None))
        if material is None:
            continue
        for what, item in (
            ("material name", f"DESCRIPTIVE_REPRESENTATION_ITEM('{material}','')"),
            (
                "density",
                f"MEASURE_REPRESENTATION_ITEM('density measure',POSITIVE_RATIO_MEASURE({density}),#{number + 13})",
            ),
        ):
            yield f"#{number + 1} = PROPERTY_DEFINITION('material property','{what}',#{definition});\n"
            yield f"#{number + 2} = PROPERTY_DEFINITION_REPRESENTATION(#{number + 1},#{number + 3});\n"
            yield f"#{number + 3} = REPRESENTATION('{what}',(#{number + 4}),#{context});\n#{number + 4} = {item};\n"
            number += 4
        yield f"#{number + 1} = ( MASS_UNIT() NAMED_UNIT(*) SI_UNIT($,.GRAM.) );\n"
        yield f"#{number + 2} = ( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.CENTI.,.METRE.) );\n"
        yield f"#{number + 3} = DERIVED_UNIT_ELEMENT(#{number + 1},1.);\n"
        yield f"#{number + 4} = DERIVED_UNIT_ELEMENT(#{number + 2},-3.);\n"
        yield f"#{number + 5} = DERIVED_UNIT((#{number + 3},#{number + 4}));\n"
        number += 5


def main():
    """Make what the command line asks for."""
    arguments = sys.argv[1:]
    if "--list" in arguments:
        for name, unit_of in DRIVERS.items():
            print(f"{name} = {globals()[name]:g} {unit_of}".rstrip())
        return
    for text in broken():
        print(f"warning: no longer holds: {text}; look at the parts that depend on it")
    if "--changed" in arguments:
        before = runpy.run_path(__file__)["PARTS"]
        wanted = [name for name in PARTS if PARTS[name][0]() != before[name][0]()]
    else:
        wanted = list(PARTS)
    wanted = arguments[arguments.index("--parts") + 1].split(",") if "--parts" in arguments else wanted
    beside = Path(__file__).parent / "changed"
    folder = Path(arguments[arguments.index("--out") + 1]) if "--out" in arguments else beside
    folder.mkdir(parents=True, exist_ok=True)
    solids = {}
    for name in wanted:
        solids[name] = solid(name)
        valid = "valid" if solids[name].is_valid else "NOT VALID"
        print(f"{name}: {solids[name].volume:.3f} mm3, {PARTS[name][2] * 1e-3 * solids[name].volume:.2f} g, {valid}")
        write(solids[name], folder / f"{name}.step")
    if len(wanted) == len(PARTS):
        write(assembly(solids), folder / "assembly.step")


if __name__ == "__main__":
    main()
