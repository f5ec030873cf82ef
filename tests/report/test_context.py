import re
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from pareto_monoped.config import checked
from pareto_monoped.errors import InputError
from pareto_monoped.report.context import (
    _BOTTOM,
    _HEIGHT,
    _WIDTH,
    Jumper,
    _chart,
    _label_place,
    context_section,
    own_jumpers,
    published_jumpers,
)


def test_every_published_jumper_has_a_source_and_a_number():
    jumpers = published_jumpers()
    assert len({jumper.name for jumper in jumpers}) == len(jumpers) >= 12
    for jumper in jumpers:
        assert jumper.source
        assert jumper.drive
        assert jumper.height_m or jumper.agility_m_per_s


def test_a_value_that_no_jump_can_have_is_refused():
    with pytest.raises(InputError, match="mass_kg = -1"):
        checked(Jumper, {"name": "a", "drive": "b", "source": "c", "mass_kg": -1.0}, source="test")


def test_agility_and_height_are_those_of_the_front(payload, data):
    own = {jumper.name: jumper for jumper in own_jumpers(payload)}
    front = data.front()
    most = front.iloc[int(np.argmax(front["agility_m_per_s"]))]
    agile = next(jumper for name, jumper in own.items() if name.startswith("most agile"))
    assert agile.agility_m_per_s == pytest.approx((most["height_m"] - 0.5) / most["apex_s"], rel=1e-3)
    assert agile.mass_kg == pytest.approx(most["mass_kg"], rel=1e-3)
    highest = next(jumper for name, jumper in own.items() if "highest jump" in name)
    assert highest.height_m == pytest.approx(front.loc[front["height_m"].idxmax(), "rise_m"], rel=1e-3)
    (case,) = (case for case in payload.studies[0].cases if case.name == "C")
    assert own["the paper's Case C, simulated here"].height_m == case.measures["rise_m"] < case.height_m - 0.7


def test_a_study_without_agilities_and_rises_says_so_by_empty_cells(payload):
    (card,) = payload.studies
    without = {name: text for name, text in card.trials.packed.items() if name not in ("agility_m_per_s", "rise_m")}
    bare = replace(payload, studies=[replace(card, trials=replace(card.trials, packed=without))])
    names = [jumper.name for jumper in own_jumpers(bare)]
    assert not any("agile" in name for name in names)
    assert {jumper.height_m for jumper in own_jumpers(bare)[1:]} == {None}
    assert "<tr" in context_section(bare)


def test_the_table_goes_from_the_most_agile_down_and_numbers_its_sources(payload):
    text = context_section(payload)
    agilities = [float(value) for value in re.findall(r"</i><b>([0-9.]+)</b>", text)]
    assert agilities == sorted(agilities, reverse=True)
    assert len(agilities) >= 4
    numbers = re.findall(r">\[(\d+)\]</td>", text)
    sources = re.findall(r"<li>(.*?)</li>", text)
    assert max(map(int, numbers)) == len(sources)
    assert len(numbers) == len(published_jumpers())


def test_a_design_that_hardly_rises_stays_in_the_chart(payload):
    jumpers = [Jumper(name="a", drive="b", source="c", mass_kg=5.0, height_m=rise) for rise in (0.001, 0.06, 0.4)]
    low, middle, high = map(float, re.findall(r'class="ours" d="M[\d.]+ ([\d.]+)l', _chart(jumpers)))
    assert high + 6.0 < middle + 6.0 < low + 6.0 <= _HEIGHT - _BOTTOM


def test_names_of_points_cover_neither_points_nor_each_other(payload):
    svg = re.search(r"<svg.*?</svg>", _chart(own_jumpers(payload))).group()
    root = ElementTree.fromstring(svg)
    names = {jumper.name for jumper in published_jumpers()}
    points = [(float(node.get("cx")), float(node.get("cy"))) for node in root.iter("circle")]
    assert all(0 < x < _WIDTH and 0 < y < _HEIGHT for x, y in points)
    boxes = []
    for node in root.iter("text"):
        if node.text not in names:
            continue
        x, y, wide = float(node.get("x")), float(node.get("y")), 5.8 * len(node.text)
        left = x - {"start": 0.0, "middle": wide / 2, "end": wide}[node.get("text-anchor")]
        boxes.append((left, left + wide, y - 10.0, y))
    assert len(boxes) == len(points)
    for i, (left, right, top, bottom) in enumerate(boxes):
        assert not any(left < x < right and top < y < bottom for x, y in points)
        assert not any(left < b[1] and right > b[0] and top < b[3] and bottom > b[2] for b in boxes[:i])


def test_a_name_stands_below_its_point_where_nothing_else_is_free():
    """What begins right under its base line, 17 pixels below the point, is not in its way."""
    beside, above = (100.0, 300.0, 195.0, 203.0), (100.0, 300.0, 182.0, 190.0)
    box, anchor, dx, dy = _label_place(200.0, 200.0, 60.0, [beside, above, (100.0, 300.0, 217.5, 230.0)])
    assert (box, anchor, dx, dy) == ((170.0, 230.0, 207.0, 217.0), "middle", 0.0, 17.0)
    assert _label_place(200.0, 200.0, 60.0, [beside, above, (100.0, 300.0, 216.5, 230.0)])[1] == "start"


def test_lines_of_the_grid_lie_within_the_frame(payload):
    root = ElementTree.fromstring(re.search(r"<svg.*?</svg>", _chart(own_jumpers(payload))).group())
    (frame,) = (node for node in root.iter("rect") if node.get("class") == "frame")
    x, y, wide, tall = (float(frame.get(name)) for name in ("x", "y", "width", "height"))
    lines = [node for node in root.iter("line") if node.get("class") == "gridline"]
    assert all(x <= float(line.get(name)) <= x + wide for line in lines for name in ("x1", "x2"))
    assert all(y <= float(line.get(name)) <= y + tall for line in lines for name in ("y1", "y2"))


def test_names_are_escaped(payload):
    (card,) = payload.studies
    assert "<b>x" not in context_section(replace(payload, studies=[replace(card, case_motor="<b>x")]))
