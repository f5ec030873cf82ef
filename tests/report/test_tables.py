import re
from dataclasses import replace

import pytest

from pareto_monoped.report.page import build
from pareto_monoped.report.tables import _duration, cases_table, comparison_tables, head, published_link, safe


def cells(table: str) -> list[list[str]]:
    rows = re.findall(r"<tr>(.*?)</tr>", table)
    return [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in rows]


def test_safe_escapes_markup_and_quotes():
    assert safe("<a b=\"c\" d='e'>&") == "&lt;a b=&quot;c&quot; d=&#x27;e&#x27;&gt;&amp;"


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.6, "1 s"), (119.4, "119 s"), (120.0, "2 min"), (7199.0, "120 min"), (7200.0, "2.0 h"), (9000.0, "2.5 h")],
)
def test_run_times_have_a_unit_that_fits(seconds, words):
    assert _duration(seconds) == words


def test_key_facts_of_a_study(payload):
    (card,) = payload.studies
    text = head(payload)
    assert f"{card.counts['feasible']} feasible, {card.counts['infeasible']} infeasible" in text
    assert "<dd>200</dd>" in text
    fewer = replace(card, counts=card.counts | {"total": 150}, reasons={"no_take_off": 3})
    text = head(replace(payload, studies=[fewer]))
    assert "<dd>150 of 200</dd>" in text
    assert "(no_take_off 3)" in text
    assert f"{card.hypervolume:.3f} m J from 0.55 m, 100 J" in text


def test_the_papers_table_stands_beside_what_is_simulated(payload):
    (card,) = payload.studies
    literal = [
        {"height_m": 0.8, "height_p05_m": 0.7, "height_p95_m": 0.9, "energy_j": 20.0, "energy_p05_j": 15.0,
         "energy_p95_j": 25.0}
    ] * 4  # fmt: skip
    rows = cells(cases_table(replace(payload, literal=literal)))
    heights = next(i for i, row in enumerate(rows) if row[0] == "height, m")
    for i, case in enumerate(payload.published):
        name, published, spread, here = rows[heights + 1 + i]
        assert name == ("nominal" if case["name"] == "nominal" else f"Case {case['name']}")
        assert published == f"{case['height_m']:.3f}"
        assert spread == "0.800 (0.700 to 0.900)"
        assert here == f"{card.cases[i].height_m:.3f}"
        assert rows[heights + 6 + i][1:] == [
            f"{case['energy_j']:.2f}",
            "20.00 (15.00 to 25.00)",
            f"{card.cases[i].energy_j:.2f}",
        ]


def test_a_case_without_a_jump_gives_its_status(payload):
    (card,) = payload.studies
    fallen = [replace(case, height_m=None, energy_j=None, status="fell") for case in card.cases]
    text = cases_table(replace(payload, studies=[replace(card, cases=fallen)]))
    assert text.count(">fell<") == 8


def test_comparison_has_a_row_per_study(source, source_u12):
    payload = build([source, source_u12])
    header, *rows = cells(comparison_tables(payload))
    assert header[:3] == ["study", "motor", "calibration"]
    assert header[-3:] == ["J at 0.7 m", "J at 0.8 m", "J at 0.9 m"]
    assert [row[1] for row in rows] == ["VT8020", "U12"]
    for row, compared in zip(rows, payload.comparison.rows, strict=True):
        assert row[-3:] == ["-" if energy is None else f"{energy:.2f}" for energy in compared["at_height"]]


def test_the_published_link_in_words(payload):
    assert published_link(payload) == "0.235 kg + 0.828 g/mm"
