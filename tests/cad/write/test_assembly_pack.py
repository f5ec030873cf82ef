"""The assembly pack: its page, its lists, and the mould, read back."""

import csv
import io
import re
from html import escape

import manifold3d as m3
import numpy as np
import pytest
import trimesh

from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.as_built import as_built
from pareto_monoped.cad.assembly import Pose, instances
from pareto_monoped.cad.product import Listed, ListedPart, part_file_name
from pareto_monoped.cad.shape.meshes import flaws
from pareto_monoped.cad.shape.outlines import contours, polygon
from pareto_monoped.cad.write import assembly_pack, meshes
from pareto_monoped.cad.write.assembly_pack import COLLAR_MM, foot_mould
from pareto_monoped.design import PAPER_CASES, Design
from pareto_monoped.geometry.roles import FASTENERS, JointKind, Role
from pareto_monoped.robot.build import build_robot


@pytest.fixture(scope="module")
def pack(exported):
    """The files of an export's pack, by path."""
    return {f"assembly/{path.name}": path.read_bytes() for path in (exported.folder / "assembly").iterdir()}


@pytest.fixture(scope="module")
def listed(exported, actuator_map):
    """The parts of the same robot: each once, with how many there are."""
    placed = {}
    robot = build_robot(Design(**exported.record["as_built"]), actuator_map)
    for instance in instances(robot, Pose(hip_rad=0.0, knee_rad=1.0)):
        placed.setdefault(id(instance.part), []).append(instance)
    found = []
    for members in placed.values():
        units, part = tuple(dict.fromkeys(one.unit for one in members)), members[0].part
        found.append(ListedPart(name=part_file_name(units, part.name), part=part, count=len(members), units=units))
    return found


@pytest.fixture(scope="module")
def listed_framed():
    """A robot whose two motors are framed."""
    found = map_for("MN8014", "iso6336")
    robot = build_robot(as_built(PAPER_CASES["C"].design, found), found)
    unique = {id(part): (unit.name, part) for unit in robot.units for part in unit.parts}
    rows = [ListedPart(name=f"{unit}_{part.name}", part=part, count=1, units=(unit,)) for unit, part in unique.values()]
    return Listed(robot=robot, unique=tuple(rows))


def rows_of(pack):
    return list(csv.DictReader(io.StringIO(pack["assembly/hardware.csv"].decode())))


def test_the_page_shows_every_picture_and_names_every_part(pack, listed):
    page = pack["assembly/index.html"].decode()
    shown = re.findall(r"src='(step_\d+\.png)'", page)
    assert sorted(f"assembly/{name}" for name in shown) == sorted(name for name in pack if name.endswith(".png"))
    assert len(shown) > 20
    steps = page[: page.index("<h2>Screws</h2>")]
    assert len(listed) > 80
    assert [u.part.name for u in listed if u.part.name.replace("_", " ") not in steps] == []


def test_the_steps_name_every_adhesive_and_grease_where_its_part_is_put_in(pack, listed):
    """Once per unit at least, in a line with the part, also where several parts come together."""
    page = pack["assembly/index.html"].decode()
    lines = re.findall(r"<li>(.*?)</li>", page[: page.index("<h2>Screws</h2>")])
    bonds = greased = 0
    for part, units in ((unique.part, unique.units) for unique in listed):
        orders = [order for order in part.purchases if order.kind == "grease"]
        bonds += part.joint is not None and part.joint.adhesive is not None
        greased += len(orders)
        if part.joint is not None and part.joint.adhesive is not None:
            orders.append(part.joint.adhesive)
        for order in orders:
            said = [line for line in lines if part.name.replace("_", " ") in line and order.designation in line]
            assert len(said) >= len(units), (part.name, order.designation)
    assert (bonds >= 10, greased >= 8) == (True, True)
    # A bond is made when the second of its parts comes, although the first stands in an earlier line or step.
    together = [line for line in lines if line.startswith("Bond what comes together: ")]
    assert any("ring is bonded into ring housing" in line for line in together)


def sections(pack):
    """The lines of each step."""
    page = pack["assembly/index.html"].decode()
    page = page[: page.index("<h2>Screws</h2>")]
    return [re.findall(r"<li>(.*?)</li>", one) for one in page.split("<section>")[1:]]


def test_each_joint_is_made_once_and_not_before_its_partner_is_there(pack, listed):
    """A ring is not said to be bonded into a housing that comes later, nor a nut to be on such a stud."""
    steps, places = sections(pack), {}
    for part, count in ((u.part, len(u.units)) for u in listed):
        if part.joint is not None and part.joint.kind not in (JointKind.MOULDED, JointKind.RUNNING):
            key = tuple(text.replace("_", " ") for text in (part.name, part.joint.text, part.joint.partner))
            places[key] = places.get(key, 0) + count
    assert len(places) > 15
    for (name, said, partner), count in places.items():
        line = re.compile(rf"\b{name} (in place [a-z ]+\. (It|They) )?(is|are) {re.escape(said)}\.")
        made = [k for k, lines in enumerate(steps) if any(map(line.search, lines))]
        assert len(made) == count, (name, said)
        named = re.compile(rf"\b{partner}\b.*(\.|, | and )")
        there = [k for k, lines in enumerate(steps) for one in lines if named.search(one.split(said)[0])]
        assert min(there) <= min(made), (name, said)


def test_what_to_watch_stands_in_the_step_in_which_a_part_is_put_in(pack, listed):
    """Say: where dowels are bonded, whose holes were reamed before, once in each unit."""
    steps, looked_at = sections(pack), 0
    for part in (u.part for u in listed if u.part.at_assembly):
        name, joint = part.name.replace("_", " "), part.joint.text.replace("_", " ") if part.joint else ""
        watched = re.compile(rf"(\d+ x )?{name}: {re.escape(escape(part.at_assembly))}\.")
        said = [k for k, lines in enumerate(steps) if any(map(watched.fullmatch, lines))]
        units = {
            unit
            for u in listed
            if u.part.name == part.name and u.part.at_assembly == part.at_assembly
            for unit in u.units
        }
        assert len(said) >= len(units), name
        put_in = [
            k for k, lines in enumerate(steps) for line in lines if re.search(rf"\b{name}\b", line) and joint in line
        ]
        assert set(said) <= set(put_in), name
        looked_at += part.role is Role.PIN and "reamed together before" in part.at_assembly
    assert looked_at >= 7


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("thigh core", "epoxy on its whole faces"),
        ("shank core", "epoxy on its whole faces"),
        ("sun", "bond it 0.2 +-0.1 mm deeper"),
        ("encoder", "1 mm from the magnet, within 0.5 mm"),
        ("ring", "the planets centre it"),
        ("motor stator", "guide it along three rods"),
        ("2 x turnbuckle end hip", "steel held against its other head"),
        ("knee spacer", "ground before it goes in"),
    ],
)
def test_a_step_says_what_is_set_glued_or_ground_in_it(pack, name, said):
    assert any(line.startswith(f"{name}: ") and said in line for lines in sections(pack) for line in lines)


def test_dowels_holes_are_reamed_before_the_first_step_all_of_them(pack, listed):
    """Steps told it where carriers were closed and greased, and chips would have fallen into the gears."""
    page = pack["assembly/index.html"].decode()
    before = page[page.index("<h2>Before the first step</h2>") : page.index("<h2>Steps</h2>")]
    dowels = {u.part.name.replace("_", " ") for u in listed if u.part.role is Role.PIN and "dowel" in u.part.name}
    assert len(dowels) >= 7
    assert set(before[before.index("dowels are: ") + 12 : before.index(".</p>")].split(", ")) == dowels


def test_a_turnbuckle_is_put_together_before_it_comes(pack):
    """Its bar was on the stud a step before the nut that goes onto the same stud."""
    (step,) = (lines for lines in sections(pack) if any("turnbuckle nut hip" in line for line in lines))
    (line,) = (line for line in step if "turnbuckle nut hip" in line and line.startswith(("Put together ", "Take ")))
    for name in ("turnbuckle nut knee", "turnbuckle bar", "turnbuckle end hip", "turnbuckle end knee"):
        assert name in line
    assert any("each nut onto the stud of its fork first" in line for line in step)


def test_screws_that_close_the_chain_of_bearings_are_tightened_at_the_end(pack):
    page = pack["assembly/index.html"].decode()
    last = page[page.index("<h2>Before the first jump</h2>") : page.index("<h2>Screws</h2>")]
    (line,) = re.findall(r"<li>(.*?)</li>", last)
    assert line.startswith("Swing the thigh through its whole range; once it swings freely, take off the knee driver, ")
    assert re.findall(r"base \w+ rod screw far \(\d\.\d N m\)", line) != []
    driven = [line for lines in sections(pack) for line in lines if "rod screw far, " in line]
    assert len(driven) == 2
    assert all("by hand only and dry, until the thigh has swung freely" in line for line in driven)


def test_a_motor_whose_screws_come_late_is_held_until_then(listed_framed, monkeypatch):
    """Its base is centred by the sun alone, so that no screw in it is tightened before the sun has turned."""
    for name in ("step_picture", "stage_of", "png"):
        monkeypatch.setattr(assembly_pack, name, lambda *_: b"")
    steps = sections(assembly_pack.assembly_pack(listed_framed))
    lines = [(k, line) for k, lines in enumerate(steps) for line in lines]
    ((held, text),) = (
        (k, line) for k, line in lines if line.startswith("Hold backplate and motor stator together with ")
    )
    assert "4 x cap screw ISO 4762 - M4 x 8 - 8.8" in text
    assert "finger-tight now" in text
    ((late, exchanged),) = ((k, line) for k, line in lines if line.startswith("4 x journal screw: "))
    assert "take out the screws that have held it" in exchanged
    assert late > held
    (own,) = (k for k, line in lines if line.startswith("4 x stator screw: finger-tight now"))
    turned = [k for k, line in lines if line.startswith("sun: ") and "tighten the screws in its base" in line]
    assert len(turned) == 2
    assert turned[0] > held
    assert turned[1] > own


def test_every_screw_has_a_torque_and_a_lock(pack, listed):
    page = pack["assembly/index.html"].decode()
    table = page[page.index("<h2>Screws</h2>") : page.index("<h2>Chain</h2>")]
    rows = [re.findall(r"<td>(.*?)</td>", row) for row in table.split("<tr>")[2:]]
    assert len(rows) == sum(unique.part.role in FASTENERS for unique in listed)
    assert all(cell for row in rows for cell in row)
    assert sum(int(row[1]) for row in rows) == sum(u.count for u in listed if u.part.role in FASTENERS)


def test_the_purchasing_list_has_every_solid_that_is_bought(pack, listed):
    rows = rows_of(pack)
    counts = {unique.name: unique.count for unique in listed}
    bought = {unique.name for unique in listed if unique.part.process == "bought"}
    ordered = [row for row in rows if row["solids"]]
    assert {name for row in ordered for name in row["used_for"].split()} == bought
    for row in ordered:
        assert int(row["solids"]) == sum(counts[name] for name in row["used_for"].split()), row
    assert len({(row["kind"], row["designation"]) for row in rows}) == len(rows)
    for row in ordered:
        if row["kind"] in ("screw", "bearing", "chain", "retaining ring", "pin", "needle roller", "washer"):
            assert row["standard"], row
        several = {"needle roller": 15, "rubber": 28, "motor": 0.5}.get(row["kind"], 1)
        assert float(row["count"]) == several * int(row["solids"]), row


def test_the_purchasing_list_can_be_ordered(pack, listed):
    rows = {row["designation"]: row for row in rows_of(pack)}
    kinds = {row["kind"] for row in rows.values()}
    assert {
        "adhesive",
        "bearing",
        "chain",
        "grease",
        "magnet",
        "motor",
        "needle roller",
        "nut",
        "pin",
        "screw",
    } <= kinds
    bonded = {u.name for u in listed if u.part.joint is not None and "bonded" in u.part.joint.how}
    assert bonded
    glued = {name for row in rows.values() if row["kind"] == "adhesive" for name in row["used_for"].split()}
    assert bonded <= glued
    assert rows["NSK 6804VVC3, 20 x 32 x 7 mm"]["alternatives"] == "NTN 6804LLB/C3; SKF 61804-2RZ/C3"
    grease = next(row for row in rows.values() if row["kind"] == "grease")
    assert grease["unit"] == "g"
    assert 1 <= int(grease["count"]) <= 10


def test_the_mould_is_watertight_and_its_cavity_is_the_foot_without_its_pocket(product):
    parts = {unique.part.name: unique.part for unique in product.unique}
    foot = next(part for part in parts.values() if part.role is Role.FOOT)
    block = parts[foot.joint.partner]
    halves = foot_mould(foot, block)
    for half in halves:
        assert flaws(half.points_mm[half.triangles]) == ""
        assert trimesh.load(io.BytesIO(meshes.stl(half)), file_type="stl").is_watertight
    (ball,) = foot.balls
    radius, top = float(ball.radius_mm), float(ball.top_mm)
    # The block stands in the collar, here in its front half.
    body = next(prism for prism in block.prisms if prism.holes)
    (outline,) = contours(body.outline)
    width = np.ptp(polygon(outline)[:, 0])
    standing = m3.Manifold.cube((width, COLLAR_MM, float(body.z1_mm))).translate(
        (-0.5 * width, top, -float(body.z1_mm))
    )
    assert (halves[0].body ^ standing).volume() == pytest.approx(0.0, abs=1e-6)
    # A slice well below pins and collar: a square with half a disc cut out.
    for half in halves:
        body = half.body
        low, high = np.array(body.bounding_box()[:3]), np.array(body.bounding_box()[3:])
        assert high[1] == pytest.approx(top + COLLAR_MM)
        level = -0.3 * radius
        across = body.rotate((90.0, 0.0, 0.0)).slice(level)
        box = (high[0] - low[0]) * (high[2] - low[2])
        disc = 0.5 * np.pi * (radius**2 - level**2)
        assert across.area() == pytest.approx(box - disc, rel=2e-3)
