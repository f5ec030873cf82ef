"""Every drawing of some very different robots: nothing overlaps, and every dimension is there."""

import re
from collections import Counter

import numpy as np
import pytest
import shapely

from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.drawing.bores import Bore, bores, number
from pareto_monoped.cad.drawing.dimension import FRAME_MM
from pareto_monoped.cad.drawing.drawings import pdf
from pareto_monoped.cad.drawing.end_view import _pointed, draw_bore
from pareto_monoped.cad.drawing.paper import TIMES, Paper, overlapping
from pareto_monoped.cad.drawing.part_sheet import part_sheet, round_part
from pareto_monoped.cad.drawing.plan import cut_along, is_square, plan_of, repeats, rounded_rectangle
from pareto_monoped.cad.drawing.plan_sheet import _APART_MM, _with_detail, plan_tables, section_marks, section_place
from pareto_monoped.cad.drawing.profile import cylinders, faces, half_section, is_round, teeth_of
from pareto_monoped.cad.drawing.section import diameter_text
from pareto_monoped.cad.drawing.sheet import MARGIN_MM, SCALES, SIZES, TITLE_MM, Title, titled
from pareto_monoped.cad.shape.outlines import polygon
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.geometry.features import Cone, Hole, ShaftEnd
from pareto_monoped.geometry.gears import InternalGear
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.shapes import Circle, Pattern
from pareto_monoped.leg.chain import CHEEK
from pareto_monoped.robot.build import build_robot
from tests.cad.drawing.crossings import crossed
from tests.cad.signed import of_pdf
from tests.cad.test_signatures import compare

ROBOTS = [
    ("A", "VT8020", "iso6336"),
    pytest.param(("B", "U12", "iso6336"), marks=pytest.mark.long),
    pytest.param(("C", "VT8020", "paper"), marks=pytest.mark.long),
    pytest.param(("A", "U8", "iso6336"), marks=pytest.mark.long),
]


@pytest.fixture(params=ROBOTS, ids=str, scope="module")
def sheets(request):
    """Every part that a robot's workshop makes, with its sheet."""
    case, motor, rules = request.param
    robot = build_robot(PAPER_CASES[case].design, map_for(motor, rules))
    made = {id(part): part for unit in robot.units for part in unit.parts if part.process != "bought"}
    return [(part, *part_sheet(part)) for part in made.values()]


TITLE = Title(
    name="knee actuator secondary carrier",
    number="0123456789ab-99",
    material="42CrMo4, quenched, tempered and nitrided",
    hardness="550 to 650 HV",
    mass="1000.0 g",
    count=13,
    process="3D printed",
    tolerances="ISO 2768-mK",
    finish="12.5",
    design="a study of a long name trial 12345, VT8020, iso6336",
    digest="0123456789ab",
    date="2025-01-01",
    maker="pareto-monoped 0.10.0",
)


def test_no_text_stands_on_another_nor_leaves_the_frame(sheets):
    for part, paper, size, scale in sheets:
        whole = Paper()
        whole.lay(paper)
        titled(whole, size, scale, TITLE)
        pairs = [(a.text, b.text) for a, b in overlapping(whole.labels)]
        assert pairs == [], part.name
        for label in whole.labels:
            x0, y0, x1, y1 = label.box()
            inside = x0 > 20.0 and y0 > MARGIN_MM and x1 < size.width_mm - MARGIN_MM and y1 < size.height_mm - MARGIN_MM
            assert inside, (part.name, label.text)


class Circles(Paper):
    """A paper that knows the centres of its circles."""

    def __init__(self):
        super().__init__()
        self.centres = []

    def circle(self, x, y, radius, **_):
        self.centres.append((round(x, 6), round(y, 6)))


@pytest.mark.parametrize("from_above", [True, False])
def test_a_leader_ends_at_a_hole_that_is_drawn_also_in_a_view_from_below(from_above):
    """Holes that are not symmetric left and right stand on the other side there."""
    three = Pattern(radius_mm=2.0, pitch_radius_mm=20.0, count=3, phase_rad=0.1, x_mm=1.0)
    holes = Bore(shape=three, low=0.0, high=4.0, through=True, feature=None, fit=None)
    paper = Circles()
    draw_bore(paper, holes, 1.0, visible=True, from_above=from_above)
    ((x, y),) = _pointed([holes], 1.0, from_above)
    assert (round(float(x), 6), round(float(y), 6)) in paper.centres[:3]


@pytest.mark.parametrize("sheets", ROBOTS[:1], ids=str, indirect=True)
def test_every_sheet_has_its_signature(sheets):
    """Of parts of other gearboxes, with more planets and an external sun, than those of ``test_signatures.py``."""
    compare(
        {
            f"{place} {part.name}.pdf": [
                *of_pdf(pdf([(paper, size.width_mm, size.height_mm)], "")),
                size.width_mm,
                scale,
            ]
            for place, (part, paper, size, scale) in enumerate(sheets)
        },
        "sheets of case A",
    )


def test_no_line_runs_through_a_text(sheets):
    for part, paper, size, scale in sheets:
        whole = Paper()
        whole.lay(paper)
        titled(whole, size, scale, TITLE)
        assert crossed(whole) == [], part.name


def test_every_chamfer_of_a_part_with_layers_is_said(sheets):
    """By its size in the row of its hole or boss; chamfers of threads by a note."""
    chamfers = 0
    for part, paper, _, _ in sheets:
        said = [label.text for label in paper.labels]
        for feature in part.features if not is_round(part) else ():
            if isinstance(feature, Hole) and feature.thread is not None:
                assert any("chamfered at 90°" in text for text in said), part.name
                continue
            mouths = [feature.low, feature.high] if isinstance(feature, Hole) else []
            sizes = [(m.depth_mm, m.radius_mm - feature.shapes[0].radius_mm) for m in mouths if m is not None]
            sizes += [(feature.depth_mm, feature.width_mm)] if isinstance(feature, ShaftEnd) else []
            if any(m is not None and m.kind is Cone.COUNTERSINK for m in mouths):
                continue
            for along, across in sizes:
                chamfers += 1
                angle = round(float(np.degrees(np.arctan2(across, along))), 1)
                assert any(f"chamfer {along:g} {TIMES} {angle:g}°" in text for text in said), part.name
    assert chamfers >= 3


def test_positions_refer_to_the_axis_that_the_fits_name(sheets):
    """A sheet with a datum in its fits gives no position without it."""
    with_datum = 0
    for part, paper, _, _ in sheets:
        said = [label.text for label in paper.labels]
        if is_round(part) or "A" not in said or not part.toleranced or "shoulders" not in said:
            continue
        with_datum += 1
        positions = [text for text in said if text in ("Ø0.02", "Ø0.1") or text.startswith(("Ø0.02 ", "Ø0.1 "))]
        frames = sum(text == "Ø0.02" for text in said)
        assert sum(text.endswith(" A") for text in positions) + frames == len(positions), part.name
    assert with_datum >= 2


def test_every_position_refers_to_a_datum_that_the_views_show(sheets):
    """The letter of a datum is no hole's name, and stands in a frame outside of all tables, too."""
    shown = 0
    for part, paper, _, _ in sheets:
        said = [label.text for label in paper.labels]
        tolerances = [text for text in said if text.startswith(("Ø0.02", "Ø0.1")) and text.endswith((" A", "datum A"))]
        if not any(hole.place_mm is not None and hole.fit is not None for hole in bores(part, on_axis=True)):
            continue
        squares = [s.points for s in paper.strokes if s.closed and np.ptp(s.points, axis=0) == pytest.approx(FRAME_MM)]
        framed = [
            label
            for label in paper.labels
            if label.text == "A" and any(np.all(np.abs(p.mean(axis=0) - _middle(label)) < 1.0) for p in squares)
        ]
        table = next((label for label in paper.labels if label.text == "Fits (ISO 286-2)"), None)
        assert framed, part.name
        assert len(framed) == said.count("A"), part.name
        assert any(table is None or label.x < table.x - 5.0 for label in framed), part.name
        shown += bool(tolerances)
    assert shown >= 3


def _middle(label):
    x0, _, x1, _ = label.box()
    return np.array([0.5 * (x0 + x1), label.y + 0.5 * label.height_mm])


def test_plates_with_many_holes_have_a_detail_with_their_names(sheets):
    details = 0
    for part, paper, _, scale in sheets:
        said = Counter(label.text for label in paper.labels)
        captions = [text for text in said if text.startswith("Z, ")]
        if captions:
            details += 1
            assert said["Z"] == 1, part.name
            assert [text for text in captions if SCALES[0] >= _scale(text) > scale] == captions
            # A circle around the crowd in the view, and one around its detail.
            ratio = _scale(captions[0]) / scale
            widths = sorted(np.ptp(s.points[:, 0]) for s in paper.strokes if s.closed and len(s.points) > 20)
            assert any(abs(large / small - ratio) < 0.02 for small in widths for large in widths if large > small), (
                part.name
            )
    assert details >= 1


def _scale(caption):
    one, other = caption.removeprefix("Z, ").split(":")
    return float(one) / float(other)


@pytest.mark.parametrize(("wide", "tall"), [(60.0, 20.0), (20.0, 60.0)])
def test_a_detail_stands_below_a_wide_view_and_beside_a_tall_one(wide, tall):
    view, detail = Paper(), Paper()
    view.line([(5.0, 7.0), (5.0 + wide, 7.0 + tall)])
    detail.line([(-3.0, 11.0), (7.0, 21.0)])
    first, second = (shapely.box(*np.ravel([s.points[0], s.points[1]])) for s in _with_detail(view, detail).strokes)
    assert first.distance(second) == pytest.approx(_APART_MM)
    along = 0 if tall > wide else 1  # they stand apart along this axis, and their middles are at one height across it
    middles = [np.array(box.centroid.coords[0]) for box in (first, second)]
    assert middles[0][1 - along] == pytest.approx(middles[1][1 - along])
    low, high = np.array(first.union(second).bounds).reshape(2, 2)[:, 1]
    assert low + high == pytest.approx(0.0)


def test_no_line_crosses_the_title_block_or_the_frame(sheets):
    for part, paper, size, _ in sheets:
        corner = (size.width_mm - MARGIN_MM - TITLE_MM[0], MARGIN_MM + TITLE_MM[1])
        for stroke in paper.strokes:
            low, high = stroke.points.min(axis=0), stroke.points.max(axis=0)
            assert np.all(low > (20.0, MARGIN_MM)), part.name
            assert np.all(high < (size.width_mm - MARGIN_MM, size.height_mm - MARGIN_MM)), part.name
            assert high[0] < corner[0] or low[1] > corner[1], part.name


def test_scales_are_standard_and_readable(sheets):
    for part, _, _, scale in sheets:
        assert scale in SCALES
        if is_round(part):
            low, _, high, outer = half_section(part).bounds
            assert scale * max(high - low, 2.0 * outer) >= 60.0 or scale == SCALES[0], part.name


def test_every_diameter_of_a_round_part_stands_once_beside_its_section(sheets):
    for part, paper, _, _ in sheets:
        if not is_round(part):
            continue
        upright = Counter(label.text for label in paper.labels if label.upward and label.text.startswith("Ø"))
        wanted = {diameter_text(round(c.radius, 6), part.toleranced) for c in cylinders(half_section(part))}
        assert upright == Counter(wanted), part.name


def test_every_face_of_a_round_part_has_its_length_once(sheets):
    for part, paper, _, _ in sheets:
        if not is_round(part):
            continue
        drawn = round_part(part)
        wanted = {number(abs(round(f.z, 6) - drawn.datum)) for f in faces(drawn.body)}
        found = Counter(label.text for label in paper.labels if label.upward and label.text[0].isdigit())
        found = Counter({text: count for text, count in found.items() if "°" not in text})
        assert found == Counter(wanted), part.name


def test_every_hole_has_its_size_and_its_place(sheets):
    for part, paper, _, _ in sheets:
        said = [label.text for label in paper.labels]
        holes = bores(part) if is_round(part) else plan_of(part).bores
        for hole in holes:
            assert any(hole.size() in text for text in said), (part.name, hole.size())
            if not is_round(part):
                assert number(float(hole.shape.x_mm)) in said, part.name
                assert number(float(hole.shape.y_mm)) in said, part.name


def test_a_contour_can_be_drawn_again_from_its_table(sheets):
    """The polygon through the nodes of a table has the area between the part's own, less and more its arcs."""
    tables = 0
    for part, paper, _, _ in sheets:
        if is_round(part) or part.balls:
            continue
        said = Counter(label.text for label in paper.labels)
        plan = plan_of(part)
        for layer in plan.layers:
            if layer.outline.circle is not None:
                continue
            tables += 1
            corners = polygon(layer.outline)
            assert number(float(corners[0, 0])) in said, part.name
            assert number(float(corners[0, 1])) in said, part.name
    assert tables > 10


def test_blanks_are_as_large_as_the_parts(sheets):
    """Against polygons within 1e-6 mm of the arcs; those that are drawn are up to 0.01 mm smaller."""
    blanks = 0
    for part, paper, _, _ in sheets:
        if is_round(part):
            continue
        blanks += 1
        plan = plan_of(part)
        points = np.concatenate([polygon(layer.outline, 1e-6) for layer in plan.layers])
        size = np.ptp(points, axis=0)
        assert plan.bounds == pytest.approx([*points.min(axis=0), *points.max(axis=0)], abs=2e-6)
        on_axis = any((bore.shape.x_mm, bore.shape.y_mm) == (0.0, 0.0) for bore in plan.bores)
        assert on_axis or plan.bounds[:2] == pytest.approx([0.0, 0.0], abs=1e-9)
        said = " ".join(label.text for label in paper.labels)
        assert f"Blank {number(float(size[0]))} {TIMES} {number(float(size[1]))} {TIMES} " in said, part.name
    assert blanks > 10


def test_gears_have_their_data_and_fits_their_limits(sheets):
    gears = 0
    for part, paper, _, _ in sheets:
        said = [label.text for label in paper.labels]
        for teeth in teeth_of(part) if is_round(part) else ():
            gears += 1
            assert f"{int(teeth.gear.teeth)}" in said
            assert any(text.startswith(("Base tangent length W over", "Between pins")) for text in said)
        for fit in part.toleranced:
            assert f"Ø{fit.text}" in said, part.name
        if part.toleranced:
            assert "Fits (ISO 286-2)" in said
    assert gears >= 5


def test_rings_have_the_fit_of_their_outside(sheets):
    rings = 0
    for part, paper, _, _ in sheets:
        if not is_round(part) or part.role is not Role.GEAR:
            continue
        if any(isinstance(teeth.gear, InternalGear) for teeth in teeth_of(part)):
            rings += 1
            assert any(label.text.endswith(" h6") for label in paper.labels), part.name
    assert rings


def test_a_fitted_pattern_of_holes_has_a_frame_with_its_position(sheets):
    frames = 0
    for part, paper, _, _ in sheets:
        if not is_round(part):
            continue
        placed = [hole for hole in bores(part) if hole.place_mm is not None]
        values = Counter(label.text for label in paper.labels)
        squares = [s for s in paper.strokes if s.closed and np.ptp(s.points[:, 1]) == pytest.approx(FRAME_MM)]
        for hole in placed:
            frames += 1
            assert values[f"Ø{number(hole.place_mm)}"] >= 1, part.name
        assert len(squares) >= len(placed), part.name
    assert frames >= 2


def _axes(part, centres):
    """Where axes of a part are in its unit's frame, as complex numbers, and its height there, at every place."""
    for x, y, z in part.places_mm:
        for k in range(int(part.count) if float(part.pitch_radius_mm) else 1):
            turn = np.exp(1j * (float(part.phase_rad) + 2.0 * np.pi * k / int(part.count)))
            yield from ((complex(x, y) + turn * (float(part.pitch_radius_mm) + complex(*at)), z) for at in centres)


def _passed(hole, part, others):
    """Whether a round body of another part fills a hole but for 0.3 mm."""
    for axis, z in _axes(part, hole.centres):
        for other in others:
            for prism in (one for one in other.prisms if isinstance(one.outline, Circle)):
                if not -0.1 < hole.radius - float(prism.outline.radius_mm) < 0.3:
                    continue
                for place, height in _axes(other, [(prism.outline.x_mm, prism.outline.y_mm)]):
                    low, high = height + prism.z0_mm, height + prism.z1_mm
                    if abs(axis - place) < 1e-6 and min(high, z + hole.high) > max(low, z + hole.low) + 1e-6:
                        return True
    return False


@pytest.mark.parametrize(("case", "motor"), [("A", "VT8020"), ("C", "MAD_M6C12"), ("B", "U12")])
def test_every_hole_that_something_fills_off_its_axis_has_a_zone_for_its_place(case, motor):
    """The holes of base rods, sleeve nuts and dowels had general tolerances: 0.3 mm at 92 mm, with 0.3 mm of play."""
    filling = {Role.SCREW, Role.BOLT, Role.PIN, Role.ROD, Role.STATOR_SCREW}
    found = set()
    for unit in build_robot(PAPER_CASES[case].design, map_for(motor, "iso6336")).units:
        others = [part for part in unit.parts if part.role in filling]
        for part in (part for part in unit.parts if part.process != "bought" and part.role not in filling):
            for hole in bores(part):
                if max(map(abs, hole.centres[0])) > 1e-6 and _passed(hole, part, others):
                    found.add(part.name)
                    assert hole.place_mm is not None, (part.name, hole.size())
                    assert hole.place_mm <= 0.1, (part.name, hole.size())
    assert found >= {"base_near_cheek", "base_far_cheek", "thigh_plate_inner", "shank_core", "hip_seat_front"}


def test_countersinks_are_of_90_degrees(sheets):
    """ISO 10642 and ISO 7721: the heads of all metric countersunk screws are."""
    said = [label.text for _, paper, _, _ in sheets for label in paper.labels]
    angles = [angle for text in said for angle in re.findall(rf"countersink Ø[\d.]+ {TIMES} ([\d.]+)°", text)]
    assert len(angles) >= 3
    assert set(angles) == {"90"}


@pytest.mark.parametrize(
    ("scale", "text"), [(10.0, "10:1"), (2.0, "2:1"), (1.0, "1:1"), (0.5, "1:2"), (0.2, "1:5"), (0.1, "1:10")]
)
def test_scales_are_written_as_paper_to_part(scale, text):
    """ISO 5455; they stand in the title block."""
    paper = Paper()
    titled(paper, SIZES[0], scale, TITLE)
    assert text in [label.text for label in paper.labels]


def test_a_section_is_marked_by_an_arrow_and_its_letter_at_each_end(sheets):
    """ISO 128-3: the arrows point at the ends of the line of cut, outside of the part, with the letter beside them."""
    part = next(part for part, *_ in sheets if not is_round(part) and not part.balls)
    plan, paper = plan_of(part), Paper()
    section_marks(paper, plan, 1.0)
    _, low, _, high = plan.bounds
    ends = zip(paper.strokes[::2], paper.strokes[1::2], paper.fills, paper.labels, strict=True)
    for (cut, shaft, head, letter), inside in zip(ends, (lambda y: y <= high, lambda y: y >= low), strict=True):
        (x0, y0), (x1, y1) = shaft.points
        assert not any(inside(y) for y in (*cut.points[:, 1], y0))
        assert y0 == y1
        assert min(cut.points[:, 1]) < y0 < max(cut.points[:, 1])
        assert x0 < x1 == cut.points[0, 0] == cut.points[1, 0]
        assert head.points[0].tolist() == [x1, y1]
        assert x0 - 2.0 < letter.box()[2] < x0
        assert letter.y + 0.5 * letter.height_mm == pytest.approx(y0)


def test_the_section_of_a_fork_shows_its_slot(sheets):
    """It went through the stud, in the middle of the sheet, and showed a square: nothing of the fork around it."""
    fork = next(part for part, *_ in sheets if part.name == "turnbuckle_end_hip")
    plan = plan_of(fork)
    (pin,) = (layer.outline.circle for layer in plan.layers if layer.outline.circle is not None)
    assert section_place(plan) == pin.x_mm
    # Along the edge of the cut, beside the pin, only the cheeks are left.
    edge = shapely.box(plan.low, plan.bounds[1], plan.high, plan.bounds[1] + 0.1)
    cheeks = shapely.get_parts(cut_along(plan, section_place(plan)).intersection(edge))
    assert [piece.bounds[2] - piece.bounds[0] for piece in cheeks] == pytest.approx([CHEEK, CHEEK])


def test_sheets_have_the_sizes_of_the_a_series():
    """ISO 216: the longer side of An is 1000 mm over the fourth root of 2^(2n - 1), less what is below 1 mm."""
    for size in SIZES:
        n = int(size.name.removeprefix("A"))
        sides = sorted(int(1000.0 / 2.0 ** ((2 * k - 1) / 4) + 0.2) for k in (n, n + 1))
        assert [size.width_mm, size.height_mm] == (sides if size.name == "A4" else sides[::-1])


def rows_of(table):
    """What a table says, its rows from the top down, each as the texts with their places from the left."""
    rows = {}
    for label in table.labels:
        rows.setdefault(round(label.y, 3), []).append((label.x, label.text))
    return [[text for _, text in sorted(row)] for _, row in sorted(rows.items(), reverse=True)]


def swept(here, onward, there):
    """Twice the area between the origin and the piece from one node to the next, as its row in the table says it."""
    (x0, y0), (x1, y1) = here, there
    if onward[0] == "line":
        return x0 * y1 - x1 * y0
    radius, x, y = float(re.search(r"R([\d.]+)", onward[0])[1]), float(onward[1]), float(onward[2])
    assert np.hypot(x0 - x, y0 - y) == pytest.approx(radius, abs=0.002)
    assert np.hypot(x1 - x, y1 - y) == pytest.approx(radius, abs=0.002)
    turn = np.arctan2(y1 - y, x1 - x) - np.arctan2(y0 - y, x0 - x)
    turn = -(-turn % (2.0 * np.pi)) if "clockwise" in onward[0] else turn % (2.0 * np.pi)
    return radius**2 * turn + x * (y1 - y0) - y * (x1 - x0)


def test_lines_and_arcs_of_the_table_enclose_the_contour(sheets):
    """Arcs go on anticlockwise unless the table says clockwise; each piece counts with the sector that it sweeps."""
    turns = Counter()
    for part, _, _, _ in sheets:
        if is_round(part) or part.balls:
            continue
        plan = plan_of(part)
        tables = [rows_of(table) for table in plan_tables(plan, part)[0]]
        listed = [row for rows in tables if rows[0][0].startswith("Contours, ") for row in rows[2:] if row[0].isdigit()]
        found = [((float(row[1]), float(row[2])), row[3:]) for row in listed]
        turns.update("clockwise" if "clockwise" in row[3] else row[3].split()[0] for row in listed)
        for contour in (contour for layer in plan.layers for contour in (layer.outline, *layer.holes)):
            outline = any(contour is layer.outline for layer in plan.layers)
            if contour.circle or (is_square(contour) if outline else rounded_rectangle(contour)):
                continue
            times = repeats(contour)
            mine, found = found[: len(contour.pieces) // times], found[len(contour.pieces) // times :]
            (x, y), turn = mine[0][0], 2.0 * np.pi / times
            ends = [here for here, _ in mine[1:]]
            ends.append((x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn)))
            area = 0.5 * times * sum(swept(*piece, there) for piece, there in zip(mine, ends, strict=True))
            assert area == pytest.approx(shapely.Polygon(polygon(contour, 1e-5)).area, rel=1e-3), part.name
        assert found == [], part.name
    assert min(turns["clockwise"], turns["arc"], turns["line"]) >= 3
