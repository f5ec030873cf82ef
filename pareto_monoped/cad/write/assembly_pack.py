"""The folder ``assembly/`` of an export: steps with pictures, torques, chain, purchasing list, printing, foot mould."""

from collections.abc import Iterator, Sequence
from html import escape

import manifold3d as m3
import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.assembly import Instance, instances
from pareto_monoped.cad.bodies import Blocking, blocking_of, partners_of
from pareto_monoped.cad.cables import cables
from pareto_monoped.cad.check.retention import POSE
from pareto_monoped.cad.picture.drawing import png
from pareto_monoped.cad.picture.scenes import stage_of, step_picture
from pareto_monoped.cad.product import Listed
from pareto_monoped.cad.shape.meshes import Mesh, mesh_from
from pareto_monoped.cad.shape.outlines import all_polygons
from pareto_monoped.cad.steps import Addition, Step, steps_of, stuck, take_apart, titled
from pareto_monoped.cad.write import meshes
from pareto_monoped.cad.write.tables import cables_csv, hardware, items, tightening
from pareto_monoped.errors import CheckError
from pareto_monoped.geometry.dowels import REAMED
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import FASTENERS, GREASE, JointKind, Role
from pareto_monoped.geometry.shapes import Shape

# Our own layout, mm.
WALL_MM = 8.0  #: Least thickness around the foot.
COLLAR_MM = 12.0  #: How far the halves reach up beside the foot's block, which they hold in its place.
PLAY_MM = 0.15  #: Around the block: what a printed hole is too small by.
PIN_DEPTH_MM = 8.0  #: Depth in each half of the dowel pins 4 x 16 (ISO 2338) that align them.
_PIN_HOLE = 4.2
POUR_MM = 6.0  #: Diameter of the holes for pouring and for the air, beside the block.
_SEGMENTS = 160  # of the ball: 0.013 mm from round at a radius of 33 mm
FOLDER = "assembly"
_FROM = {
    "+y": "from the left",
    "-y": "from the right",
    "+x": "from the front",
    "-x": "from the back",
    "+z": "from above",
    "-z": "from below",
}
_VERB = {
    JointKind.PRESSED: "Press",
    JointKind.BONDED: "Bond",
    JointKind.THREADED: "Screw",
    JointKind.STUCK: "Stick",
    JointKind.ENGAGED: "Lay",
}  # moulding has a section of its own, and a rotor comes in its bearings
_TAILS = "80 mm for the splice inside the motor's back and 60 mm for the terminals"
_SLACK = 0.01
"""Sideways play of the chain's slack strand over its free length: half of what chain makers allow for level drives,
since the torque of a jump changes its sign. Our own choice."""
_STYLE = """body{font:16px/1.45 sans-serif;margin:2em auto;max-width:1120px;padding:0 1em;color:#111}
img{max-width:100%;border:1px solid #ddd}table{border-collapse:collapse;margin:1em 0}
td,th{border:1px solid #bbb;padding:.25em .6em;text-align:left;vertical-align:top}
section{break-inside:avoid;margin:1.5em 0}h2{margin-top:2em}"""


def foot_mould(foot: Part, block: Part) -> tuple[Mesh, Mesh]:
    """Return both halves of a mould for the rubber foot, which hold the foot's block by its sides.

    They lie as they are printed: the plane that parts them upwards, z upwards, millimetres. The foot is a ball that is
    cut flat, with a pocket for the tongue of the block, which stands on the foot's flat.
    """
    (ball,) = foot.balls
    radius, top = float(ball.radius_mm), float(ball.top_mm)
    body = next(prism for prism in block.prisms if prism.holes)
    low, high = _extent(body.outline)
    half_width, half_thick = 0.5 * (high[0] - low[0]) + PLAY_MM, float(body.z1_mm) + PLAY_MM
    outside = radius + WALL_MM
    # The foot's centre is the origin here, y up, z across the parting plane.
    solid = _box((-outside, -outside, -outside), (outside, top + COLLAR_MM, outside))
    cavity = m3.Manifold.sphere(radius, _SEGMENTS).trim_by_plane((0.0, -1.0, 0.0), -top)
    seat = _box((-half_width, top, -half_thick), (half_width, top + COLLAR_MM + 1.0, half_thick))
    solid = solid - cavity - seat
    flat = float(np.sqrt(radius**2 - top**2))
    pour = 0.5 * (half_width + flat)
    for side in (-1.0, 1.0):
        hole = m3.Manifold.cylinder(COLLAR_MM + 6.0, 0.5 * POUR_MM, circular_segments=48).rotate((-90.0, 0.0, 0.0))
        solid -= hole.translate((side * pour, top - 5.0, 0.0))
    at = 0.5 * (radius + outside) * np.sqrt(0.5) + 4.0
    for x, up in ((-at, -at), (at, -at), (-outside + 5.0, top), (outside - 5.0, top)):
        pin = m3.Manifold.cylinder(2.0 * PIN_DEPTH_MM, 0.5 * _PIN_HOLE, circular_segments=48, center=True)
        solid -= pin.translate((float(x), float(up), 0.0))
    front = solid.trim_by_plane((0.0, 0.0, -1.0), 0.0)
    back = solid.trim_by_plane((0.0, 0.0, 1.0), 0.0).rotate((0.0, 180.0, 0.0))
    return mesh_from(front), mesh_from(back)


def _box(low: tuple[float, float, float], high: tuple[float, float, float]) -> m3.Manifold:
    x, y, z = (b - a for a, b in zip(low, high, strict=True))
    return m3.Manifold.cube((x, y, z)).translate(low)


def _extent(outline: Shape) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    points = np.concatenate([np.asarray(polygon) for polygon in all_polygons([outline])])
    return points.min(axis=0), points.max(axis=0)


def assembly_pack(product: Listed) -> dict[str, bytes]:
    """Return content by path; ``CheckError`` if a part has no straight way in, or a screw no room for its key."""
    placed = instances(product.robot, POSE)
    blocking = blocking_of(placed)
    assembly = take_apart(blocking)
    for members in stuck(assembly):
        names = ", ".join(_name(blocking, k) for k in sorted(members))
        raise CheckError(
            f"assembly: {names} cannot be put together along straight lines with room for keys; choose another design, "
            "or leave the format assembly out"
        )
    steps = steps_of(assembly)
    stage = stage_of(blocking, placed)
    made = {f"{FOLDER}/step_{step.number:02d}.png": png(step_picture(step, stage)) for step in steps}
    foot = next(unique.part for unique in product.unique if unique.part.role is Role.FOOT)
    assert foot.joint is not None
    block = next(unique.part for unique in product.unique if foot.joint.partner == unique.part.name)
    for name, half in zip(("front", "back"), foot_mould(foot, block), strict=True):
        made[f"{FOLDER}/foot_mould_{name}.3mf"] = meshes.threemf(half, f"foot_mould_{name}")
    made[f"{FOLDER}/cables.csv"] = cables_csv(product).encode()
    made[f"{FOLDER}/hardware.csv"] = hardware(product).encode()
    made[f"{FOLDER}/index.html"] = "\n".join(_page(product, steps, blocking, placed, foot)).encode()
    return made


def _name(blocking: Blocking, body: int) -> str:
    return blocking.bodies[body].instance.part.name.replace("_", " ")


def _page(
    product: Listed, steps: Sequence[Step], blocking: Blocking, placed: Sequence[Instance], foot: Part
) -> Iterator[str]:
    yield f'<!doctype html><html lang="en"><meta charset="utf-8"><title>Assembly</title><style>{_STYLE}</style>'
    yield "<h1>Assembly</h1>"
    yield (
        "<p>Left, right, front and above are those of the robot: it looks forward, y is to the left. In the pictures "
        "the thigh hangs down and the shank points back. Grey is what is together already. Every way is straight, and "
        "a key of full length reaches every screw in its step: both were checked with the parts' shapes. "
        "The thigh is a clamshell: each actuator is screwed to its plate before the plates are joined.</p>"
    )
    dowels = sorted({u.part.name.replace("_", " ") for u in product.unique if u.part.at_assembly == REAMED})
    yield (
        "<h2>Before the first step</h2><p>Ream the holes of all dowels, while carriers are bare and without grease: "
        "screw the parts that they join together dry, ream through, mark how they stood, take them apart and clear out "
        "the chips; shank plates and knee axle with foot block and striker bolted between them. The dowels are: "
        f"{escape(', '.join(dowels))}.</p>"
    )
    yield "<h2>Steps</h2>"
    for step in steps:
        yield from _step(step, blocking, product)
    yield from _before_the_first_jump(product)
    yield (
        "<h2>Screws</h2><p>Clean the threads, wet them with the locker, tighten crosswise. Countersunk heads carry 80 "
        "percent of their threads (ISO 10642, ISO 14581; marked 08.8 and 010.9), so that they are tightened to 75 "
        "percent of the proof stress instead of 90; their torque is no less because the cone rubs more.</p>"
    )
    yield from _table(("screw", "count", "where", "torque", "lock"), _screws(product))
    yield from _chain(product)
    yield from _cables(product)
    yield "<h2>To buy</h2><p>The same as a table for a spreadsheet: <a href='hardware.csv'>hardware.csv</a>.</p>"
    yield from _table(
        ("kind", "designation", "or", "count"),
        (
            (o.kind, o.designation, "; ".join(o.alternatives) or "-", f"{item.amount} {o.unit}")
            for item in items(product)
            for o in (item.order,)
        ),
    )
    yield from _printing(product, foot)
    yield "</html>"


def _step(step: Step, blocking: Blocking, product: Listed) -> Iterator[str]:
    yield f"<section><h3>{step.number}. {escape(titled(step, blocking))}</h3><ol>"
    if step.base_number is None:
        yield f"<li>Take {_listed(sorted(step.base), blocking)}.</li>"
    elif step.base_number != step.number - 1:
        yield f"<li>Take what step {step.base_number} has made.</li>"
    yield from (f"<li>{_addition(addition, step, blocking)}</li>" for addition in step.additions)
    yield from (f"<li>{line}</li>" for line in (*_joined(step, blocking), *_greased(step, blocking)))
    watched = [k for k in sorted(step.members) if blocking.bodies[k].instance.part.at_assembly]
    for k in (k for k in watched if _is_put_in(k, step, blocking)):
        text = blocking.bodies[k].instance.part.at_assembly
        yield f"<li>{escape(_counted(k, blocking))}: {escape(text)}.</li>"
    yield from (f"<li>{line}</li>" for line in _held_for_now(step, blocking, product))
    for k in step.fasteners:
        yield f"<li>{_fastener(k, blocking)}</li>"
    yield f"</ol><img src='step_{step.number:02d}.png' alt='step {step.number}' loading='lazy'></section>"


def _addition(addition: Addition, step: Step, blocking: Blocking) -> str:
    way = _FROM[addition.out]
    if addition.number is not None:
        return f"Bring what step {addition.number} has made {way}."
    members = sorted(addition.members)
    if len(members) > 1:
        return f"Put together {_listed(members, blocking)}, and bring them {way}."
    joint = blocking.bodies[members[0]].instance.part.joint
    if joint is None or step.members.isdisjoint(partners_of(blocking.bodies, members[0])):
        # Its joint, if it has one, is made in the step in which its partner comes.
        return f"Put {_listed(members, blocking)} in place {way}."
    several = len(blocking.bodies[members[0]].instances) > 1
    how = f"{'They are' if several else 'It is'} {escape(joint.text.replace('_', ' '))}."
    return f"{_VERB.get(joint.kind, 'Put')} {_listed(members, blocking)} in place {way}. {how}"


def _made_before(step: Step) -> list[frozenset[int]]:
    """Return what comes to a step from earlier ones, which have bonded and greased it."""
    made = [addition.members for addition in step.additions if addition.number is not None]
    return made if step.base_number is None else [step.base, *made]


def _is_put_in(body: int, step: Step, blocking: Blocking) -> bool:
    """Return whether a step makes a body's joint with its partner, or brings the body if it has none."""
    joint = blocking.bodies[body].instance.part.joint
    if joint is None or joint.kind not in _VERB:
        return not any(body in made for made in _made_before(step))
    partners = step.members.intersection(partners_of(blocking.bodies, body))
    return bool(partners) and not any(body in made and partners & made for made in _made_before(step))


def _joined(step: Step, blocking: Blocking) -> Iterator[str]:
    """Yield the joints between what a step brings together; that of a single part stands in that part's own line."""
    alone = {k for one in step.additions if one.number is None and len(one.members) == 1 for k in one.members}
    for k in sorted(step.members - alone):
        joint = blocking.bodies[k].instance.part.joint
        if joint is not None and joint.kind in _VERB and _is_put_in(k, step, blocking):
            verb = "are" if len(blocking.bodies[k].instances) > 1 else "is"
            how = escape(joint.text.replace("_", " "))
            yield f"{_VERB[joint.kind]} what comes together: {_counted(k, blocking)} {verb} {how}."


def _greased(step: Step, blocking: Blocking) -> Iterator[str]:
    """Yield what is greased as it is put in, a line for each grease."""
    found: dict[str, list[str]] = {}
    for k in sorted(step.members.difference(*_made_before(step))):
        for order in blocking.bodies[k].instance.part.purchases:
            if order.kind == GREASE.kind:
                each = " each" if len(blocking.bodies[k].instances) > 1 else ""
                found.setdefault(order.designation, []).append(f"{_counted(k, blocking)}, {order.count:.2f} g{each}")
    for designation, places in found.items():
        yield escape(f"Grease with {designation}: {'; '.join(places)}.")


def _held_for_now(step: Step, blocking: Blocking, product: Listed) -> Iterator[str]:
    """Yield what holds a motor until another unit's screws do: the actuator's own, which are left out of the robot."""
    actuators = {"hip_actuator": product.robot.hip, "knee_actuator": product.robot.knee}
    for k, body in enumerate(blocking.bodies):
        if body.instance.part.role is not Role.MOTOR_STATOR or k not in step.members:
            continue
        screws = [part for part in actuators[body.unit].parts if part.role is Role.STATOR_SCREW]
        others = [j for j, through in blocking.goes_through.items() if k in through and j not in step.fasteners]
        for j in (j for j in others if screws and blocking.bodies[j].unit != body.unit):
            held = {m for m in blocking.goes_through[j] if blocking.bodies[m].unit == body.unit}
            if held <= step.members and not any(held <= made for made in _made_before(step)):
                spare = escape(f"{float(screws[0].count):g} x {screws[0].purchases[0].designation}")
                yield (
                    f"Hold {_listed(sorted(held), blocking)} together with {spare}, which are not counted in the parts "
                    f"to buy, until the {_name(blocking, j)}s take their place: {screws[0].at_assembly}."
                )


def _fastener(body: int, blocking: Blocking) -> str:
    part, name = blocking.bodies[body].instance.part, _counted(body, blocking)
    if part.role not in FASTENERS:
        return f"Snap {escape(name)} into its groove: {escape(part.described)}."
    torque, lock = tightening(part)
    return f"Drive {escape(name)}, {escape(part.described)}: {escape(torque)}, {escape(lock)}."


def _listed(members: Sequence[int], blocking: Blocking) -> str:
    words = [escape(_counted(k, blocking)) for k in members]
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


def _counted(body: int, blocking: Blocking) -> str:
    count = len(blocking.bodies[body].instances)
    return f"{count} x {_name(blocking, body)}" if count > 1 else _name(blocking, body)


def _before_the_first_jump(product: Listed) -> Iterator[str]:
    """Yield what is done when everything is together, each once for all its parts, with the torque of screws."""
    last: dict[str, list[str]] = {}
    for part in (unique.part for unique in product.unique if unique.part.at_last):
        torque = f" ({tightening(part)[0]})" if part.role in FASTENERS else ""
        last.setdefault(part.at_last, []).append(part.name.replace("_", " ") + torque)
    yield "<h2>Before the first jump</h2><ol>"
    for text, names in last.items():
        yield f"<li>{escape(text[0].upper() + text[1:])}: {escape(', '.join(names))}.</li>"
    yield "</ol>"


def _screws(product: Listed) -> Iterator[tuple[str, ...]]:
    for unique in product.unique:
        if unique.part.role in FASTENERS:
            torque, lock = tightening(unique.part)
            where = ", ".join(unit.replace("_", " ") for unit in unique.units)
            text = f"{unique.name.replace('_', ' ')}: {unique.part.described}"
            yield text, str(unique.count), where, torque, lock


def _chain(product: Listed) -> Iterator[str]:
    notes = [u.part.described for u in product.unique if u.part.role is Role.TURNBUCKLE]
    span_mm = 1000.0 * product.robot.design.thigh_length_m
    yield "<h2>Chain</h2><ol>"
    yield (
        "<li>Put the turnbuckles together before they go in: each nut onto the stud of its fork, then both forks into "
        "the bar by equal turns. Only then put the forks' pins through the last links of the chain.</li>"
    )
    yield from (f"<li>Turnbuckles: {escape(note)}.</li>" for note in notes)
    yield "<li>Turn the knee to a right angle and hold the shank. Turn both turnbuckles by equal angles.</li>"
    yield (
        f"<li>The chain is right when the slack strand gives {_SLACK * span_mm:.1f} mm to either side in its middle: "
        f"{100.0 * _SLACK:g} percent of its {span_mm:.0f} mm. It must not be taut in any pose of the knee.</li>"
    )
    yield "<li>Lock the nuts. Look again after the first 20 jumps, when the chain has bedded in.</li></ol>"


def _cables(product: Listed) -> Iterator[str]:
    made = cables(product.robot)
    yield "<h2>Cables</h2>"
    yield (
        "<p>The last sheet of <code>drawings/assembly.pdf</code> shows where they run, "
        "<a href='cables.csv'>cables.csv</a> has every corner. Lay them last, with the thigh hanging "
        "down: they slide up behind the drivers' boards. The cut length is the "
        f"path with {_TAILS}. Bend no cable more tightly than its radius.</p>"
    )
    yield from _table(
        ("cable", "from", "to", "cut", "path", "bend radius"),
        (
            (
                cable.name.replace("_", " "),
                cable.start,
                cable.end,
                f"{cable.wires} x {cable.cut_mm:g} mm, {cable.designation}",
                f"{cable.length_mm:.0f} mm",
                f"{cable.bend_radius_mm:.0f} mm",
            )
            for cable in made
        ),
    )
    yield from (f"<p><b>Note:</b> {cable.warning}.</p>" for cable in made if cable.warning)
    uncounted = sum(cable.mass_g for cable in made)
    yield (
        f"<p>The motors' wires weigh {uncounted:.0f} g. The robot's mass does not count them, since nobody knows where "
        "a motor's own leads end. The encoders' masses count 0.3 m of cable each. Supply and bus of the drivers come "
        "from the test stand.</p>"
    )


def _printing(product: Listed, foot: Part) -> Iterator[str]:
    """Yield the settings of all printed parts, the mould among them, and how the foot is cast."""
    yield "<h2>Printing</h2>"
    rows = [
        (u.name.replace("_", " "), str(u.count), u.part.material.name, u.part.note or "flat side down", "100 %")
        for u in product.unique
        if u.part.process == "3D printed"
    ]
    rows.append(("foot mould, front and back", "2", "PLA or PETG", "parting plane upwards, no supports", "25 %"))
    yield from _table(("part", "count", "material", "orientation", "infill"), rows)
    yield "<p>Nozzle 0.4 mm, layers 0.2 mm, 4 walls, no supports. Ream holes for bolts to size.</p>"
    yield "<h2>Casting the foot</h2><ol>"
    yield (
        "<li>Sand and wax both halves of the mould, put 4 dowel pins 4 x 16 (ISO 2338) between them, set the foot "
        "block into the collar with its tongue downwards, and clamp the halves.</li>"
    )
    mixed_ml = 1.1 * (1e-3 * float(foot.volume_mm3()))
    yield f"<li>Degrease and prime the tongue. Mix {mixed_ml:.0f} ml of polyurethane, {escape(foot.note)}.</li>"
    yield "<li>Pour through one hole until it stands in the other. Let it cure as its maker says.</li></ol>"


def _table(head: Sequence[str], rows: Iterator[tuple[str, ...]] | Sequence[tuple[str, ...]]) -> Iterator[str]:
    yield "<table><tr>" + "".join(f"<th>{escape(cell)}</th>" for cell in head) + "</tr>"
    for row in rows:
        yield "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>"
    yield "</table>"
