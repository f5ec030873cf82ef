"""The drawings of an export: one of each made part, one of the assembly, the same each time."""

import csv
import dataclasses
import io
from collections import Counter
from types import SimpleNamespace

import numpy as np
import pytest
import shapely

from pareto_monoped.cad.cables import cables
from pareto_monoped.cad.drawing import assembly_sheets, drawings
from pareto_monoped.cad.drawing.assembly_sheets import assembly_sheet, cable_sheet, exploded_sheets
from pareto_monoped.cad.drawing.assembly_views import FROM_FRONT
from pareto_monoped.cad.drawing.drawings import assembly_drawing, origin_of, part_drawings
from pareto_monoped.cad.drawing.paper import overlapping
from pareto_monoped.cad.write.tables import parts_list
from tests.cad.drawing.crossings import crossed
from tests.cad.drawing.reader import pages, texts


@pytest.fixture(scope="module")
def origin():
    return origin_of(
        {
            "source": {"study": "mine", "trial": 7, "date": "2025-03-04"},
            "motor": "VT8020",
            "rules": "iso6336",
            "design_hash": "0123456789ab",
            "made_by": "pareto-monoped 1",
        }
    )


@pytest.fixture(scope="module")
def drawn_once(product, origin):
    """The drawing of the assembly, and the sheets that were made for it by the names of the functions."""
    sheets = {}

    def kept(make):
        return lambda product: sheets.setdefault(make.__name__, make(product))

    with pytest.MonkeyPatch.context() as patch:
        for make in (assembly_sheet, exploded_sheets, cable_sheet):
            patch.setattr(drawings, make.__name__, kept(make))
        return assembly_drawing(product, origin), sheets


@pytest.fixture(scope="module")
def drawn(drawn_once):
    """The drawing of the assembly."""
    return drawn_once[0]


@pytest.fixture(scope="module")
def first_sheet(drawn_once):
    return drawn_once[1]["assembly_sheet"]


@pytest.fixture(scope="module")
def exploded(drawn_once):
    return drawn_once[1]["exploded_sheets"]


@pytest.fixture(scope="module")
def sheet_of_cables(drawn_once):
    return drawn_once[1]["cable_sheet"]


def test_an_export_draws_the_parts_that_are_made_and_no_others(exported):
    with (exported.folder / "bom.csv").open(newline="") as stream:
        made = {row["part"] for row in csv.DictReader(stream) if row["made_or_bought"] == "made"}
    assert len(made) > 30
    assert {path.stem for path in (exported.folder / "drawings").iterdir()} == made | {"assembly"}
    assert {f"drawings/{name}.pdf" for name in (*made, "assembly")} <= set(exported.files)


def test_a_title_block_says_what_the_part_is_and_where_it_comes_from(exported):
    record = exported.record
    said = texts((exported.folder / "drawings" / "hip_actuator_carrier.pdf").read_bytes())
    with (exported.folder / "bom.csv").open(newline="") as stream:
        row = next(row for row in csv.DictReader(stream) if row["part"] == "hip_actuator_carrier")
    assert "hip actuator carrier" in said
    assert "EN AW-7075 T6" in said
    assert "150 HBW" in said
    assert f"{float(row['mass_g']):.1f} g" in said
    assert "ISO 2768-mK" in said
    assert record["design_hash"] in said
    assert f"case C, {record['motor']}, iso6336" in said
    assert record["made_by"] in said


def test_the_assembly_lists_its_items_in_the_order_of_the_parts_list(product, drawn):
    page, *_ = pages(drawn)
    rows = list(csv.DictReader(io.StringIO(parts_list(product))))
    heights = {text: y for text, _, y in page.texts}
    names = [row["part"].replace("_", " ") for row in rows]
    assert set(names) <= set(heights)
    column = {text: round(x) for text, x, _ in page.texts}
    first = [name for name in names if column[name] == column[names[0]]]
    assert first == sorted(first, key=lambda name: -heights[name])
    assert (page.width_mm, page.height_mm) == pytest.approx((841.0, 594.0), abs=1e-3)


def test_the_first_sheet_has_one_balloon_for_each_of_few_items(product, first_sheet):
    """Small items have theirs on the exploded sheets, so that leaders can be followed here."""
    paper, *_ = first_sheet
    circles = [shapely.Polygon(s.points) for s in paper.strokes if s.closed and len(s.points) > 2]
    middles = [circle.centroid for circle in circles if _is_balloon(circle)]
    numbers = [
        label.text
        for label in paper.labels
        if label.text.isdigit() and any(np.hypot(label.x - at.x, label.y + 1.25 - at.y) < 0.1 for at in middles)
    ]
    assert len(numbers) == len(middles) == len(set(numbers))
    assert 20 < len(numbers) < 0.5 * len(product.unique)


def test_the_first_sheet_says_how_high_the_robot_is(product, first_sheet):
    paper, *_ = first_sheet
    points = np.concatenate(
        [unique.mesh.points_mm @ i.world[:3, :3].T + i.world[:3, 3] for i, unique in product.placed()]
    )
    said = {label.text for label in paper.labels}
    for axis in (0, 2):
        assert f"{np.ptp(points[:, axis]):.1f}".rstrip("0").rstrip(".") in said


def test_the_exploded_sheets_number_every_item_once(product, drawn):
    _, *read, _ = pages(drawn)
    assert read
    above_title_mm = 65.0
    numbers = [text for page in read for text, _, y in page.texts if text.isdigit() and y > above_title_mm]
    assert sorted(map(int, numbers)) == list(range(1, len(product.unique) + 1))
    said = [text for page in read for text, _, _ in page.texts]
    assert [f"A1   {k}/{len(read) + 2}" in said for k in range(2, len(read) + 2)] == [True] * len(read)


def test_the_exploded_sheets_number_an_item_of_two_units_once(product):
    """As two actuators of one gear ratio share theirs; here the foot has an item of the base."""
    base, foot = (next(k for k, i in enumerate(product.instances) if i.unit == unit) for unit in ("base_frame", "foot"))
    kinds = [product.kinds[base if k == foot else k] for k in range(len(product.kinds))]
    sheets = exploded_sheets(dataclasses.replace(product, kinds=tuple(kinds)))
    numbers = Counter(label.text for paper, *_ in sheets for label in paper.labels if label.text.isdigit())
    assert set(numbers) == {f"{kind + 1}" for kind in kinds}
    assert set(numbers.values()) == {1}


def test_the_sheet_of_the_cables_notes_a_bend_that_is_too_tight(product, sheet_of_cables, monkeypatch):
    made = cables(product.robot)
    assert not any(label.text.startswith("Hip motor cable: ") for label in sheet_of_cables[0].labels)
    tight = dataclasses.replace(made[0], bend_radius_mm=2.5 * made[0].diameter_mm)
    monkeypatch.setattr("pareto_monoped.cad.drawing.assembly_sheets.cables", lambda _: (tight, *made[1:]))
    said = " ".join(label.text for label in cable_sheet(product)[0].labels)
    assert f"{tight.warning[0].upper()}{tight.warning[1:]}." in said


def test_the_sheet_of_the_cables_shows_the_base_and_housings_but_no_plates_of_the_leg(product, monkeypatch):
    monkeypatch.setattr(assembly_sheets, "outline_of", lambda region: region)
    monkeypatch.setattr(assembly_sheets, "placed", lambda *_: SimpleNamespace(project=shapely.Polygon))
    items = {seen.item for seen in assembly_sheets._near_cables(product, FROM_FRONT)}
    names = {i.part.name for i, kind in zip(product.instances, product.kinds, strict=True) if kind in items}
    assert {"base_near_cheek", "base_far_cheek", "base_rod", "knee_driver"} <= names
    assert not [name for name in names if name.startswith(("thigh_plate", "shank", "foot"))]


def test_the_sheet_of_the_cables_says_how_to_cut_them(product, drawn):
    *_, sheet = pages(drawn)
    said = [text for text, _, _ in sheet.texts]
    for letter, cable in zip("ABCD", cables(product.robot), strict=True):
        assert f"{cable.start} to {cable.end}" in said
        assert f"{cable.wires} x {cable.designation}" in said
        assert f"{cable.cut_mm:g}" in said
        # In both views and in the table.
        assert [said.count(f"{letter}{k}") for k in range(1, len(cable.notes) + 1)] == [3] * len(cable.notes)


def test_no_line_runs_through_a_text_of_the_assembly(first_sheet, exploded, sheet_of_cables):
    for paper, size, _ in (first_sheet, *exploded, sheet_of_cables):
        assert crossed(paper) == []
        assert overlapping(paper.labels) == []
        x0, y0, x1, y1 = paper.box()
        assert x0 > 20.0
        assert y0 > 10.0
        assert x1 < size.width_mm - 10.0
        assert y1 < size.height_mm - 10.0


def test_leaders_on_exploded_sheets_cross_next_to_no_part(product, exploded):
    """A leader ends in a dot within its own part; every other outline that it meets is one too many."""
    leaders, crossings = 0, 0
    for paper, _, _ in exploded:
        outlines = [shapely.Polygon(s.points) for s in paper.strokes if s.closed and len(s.points) > 2]
        circles = [one for one in outlines if _is_balloon(one)]
        parts = shapely.STRtree([outline for outline in outlines if outline not in circles])
        for stroke in paper.strokes:
            if stroke.closed or len(stroke.points) != 2 or not _begins_at(stroke.points[0], circles):
                continue
            leaders += 1
            tip = shapely.Point(stroke.points[1])
            met = parts.query(shapely.LineString(stroke.points), predicate="crosses")
            crossings += sum(not parts.geometries[k].buffer(0.01).covers(tip) for k in met)
    assert leaders == len(product.unique)
    assert crossings <= 0.1 * leaders


def _is_balloon(outline):
    return len(outline.exterior.coords) > 30 and abs(outline.area - np.pi * 4.0**2) < 0.3


def _begins_at(point, circles):
    return any(abs(np.hypot(*(point - np.array(circle.centroid.coords[0]))) - 4.0) < 0.05 for circle in circles)


def test_drawings_are_the_same_bytes_each_time(product, origin, sheet_of_cables):
    parts = product.unique[:6]
    assert part_drawings(parts, origin) == part_drawings(parts, origin)
    again, known = (list(drawings._content(paper)) for paper, *_ in (cable_sheet(product), sheet_of_cables))
    assert again == known


@pytest.mark.long
def test_the_drawing_of_the_assembly_is_the_same_bytes_each_time(product, origin, drawn):
    assert assembly_drawing(product, origin) == drawn


def test_some_drawings_are_the_same_as_all_of_them_from_their_first_number(product, origin):
    made = [unique for unique in product.unique if unique.part.process != "bought"][:5]
    assert part_drawings(made[:2], origin) | part_drawings(made[2:], origin, 3) == part_drawings(made, origin)


def test_the_date_is_the_design_s_and_nothing_else(product, origin):
    (content, *_) = part_drawings(product.unique[:3], origin).values()
    assert "2025-03-04" in texts(content)
    assert "mine trial 7, VT8020, iso6336" in texts(content)
