"""Names that the page's scripts and their payload use: each is known to a table or a record in Python."""

import json
import re
from dataclasses import fields, is_dataclass, replace
from importlib import resources
from pathlib import Path

import pytest

from pareto_monoped.design import NAMES
from pareto_monoped.jump.frames import FRAME_COLUMNS
from pareto_monoped.measures import AUDIT_MEASURES, GOAL_NAMES, SCREEN_MEASURES
from pareto_monoped.report import schema
from pareto_monoped.report.page import embedded, page
from pareto_monoped.report.schema import Payload

TABLES = {*NAMES, *GOAL_NAMES, *(one.name for one in (*AUDIT_MEASURES, *SCREEN_MEASURES))}
CHOSEN = {"hip_gearbox", "knee_gearbox", "motor"}
"""What a trial chooses by number: columns of the payload beside variables and measures."""
OF_A_JUMP = {*FRAME_COLUMNS, "time_s", "foot_z_m"}
"""Columns of a packed jump, and the two that ``jumps.js`` makes of them."""
BODIES = {"base_kg", "thigh_kg", "shank_kg"}
RECORDS = {
    field.name
    for kind in vars(schema).values()
    if isinstance(kind, type) and is_dataclass(kind)
    for field in fields(kind)
}
SCRIPTS = [
    script
    for room in ("report", "campaign")
    for script in sorted((resources.files("pareto_monoped") / room / "assets").iterdir(), key=lambda path: path.name)
    if script.name.endswith(".js")
]


def code_of(script) -> str:
    """A script without its comments."""
    return re.sub(r"(?m)(^|\s)//.*$", "", script.read_text(encoding="utf-8"))


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.name)
def test_a_script_uses_no_name_that_python_does_not_have(script):
    """Names with underscores are Python's: scripts call their own things otherwise."""
    used = set(re.findall(r"(?<![\w$])[a-z][a-z0-9]*(?:_[a-z0-9]+)+(?![\w$])", code_of(script)))
    plotlys = {name for name in used if name.startswith(("plotly_", "error_")) or name.endswith("_bgcolor")}
    assert used - RECORDS - TABLES - CHOSEN - OF_A_JUMP - BODIES - plotlys == set()


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.name)
def test_a_script_lists_no_measures(script):
    """What a list of measures or variables holds is a choice of their rows; a script gets it with the payload."""
    quoted = "|".join(sorted(TABLES, key=len, reverse=True))
    assert re.findall(rf'"(?:{quoted})"\s*,\s*"(?:{quoted})"', code_of(script)) == []


def test_the_scripts_read_only_what_the_payload_has():
    there = {field.name for field in fields(Payload)}
    own = Path(str(resources.files("pareto_monoped.report"))) / "assets"
    used = {script.name: set(re.findall(r"\bpage\.(\w+)", code_of(script))) for script in own.glob("*.js")}
    assert {name: names - there for name, names in used.items() if names - there} == {}
    assert sum(map(len, used.values())) > len(there)


def test_every_name_in_the_payload_stands_in_a_table(payload):
    read = json.loads(embedded(payload)[1])
    (card,) = read["studies"]
    for names in (read["goals"], read["leading"], read["compared"], read["energies"], read["axes"]):
        assert set(names) <= TABLES
    assert {quantity["name"] for quantity in read["quantities"]} <= TABLES
    assert set(card["trials"]["columns"]) | set(card["trials"]["packed"]) <= TABLES | CHOSEN
    assert {name for case in card["cases"] for name in case["measures"]} <= TABLES
    assert {name for audit in card["audits"].values() for name in audit} <= TABLES | {"good", "reason"}
    assert set(read["energies"]) <= set(read["compared"])
    assert set(read["leading"]) <= set(read["compared"])


@pytest.fixture
def comparing(folder, open_tab):
    """Open a page and keep two designs, which it then compares."""

    def opened(payload):
        file = folder / "names.html"
        file.write_text(page(payload), encoding="utf-8")
        tab = open_tab(file)
        assert tab.complaints == []
        (card,) = payload.studies
        trials = [card.trials.trial[row] for row in (card.front[0], card.front[-1])]
        tab.page.evaluate(f"location.hash = '#view=1&keep=0:{trials[0]}:&keep=0:{trials[1]}:'")
        tab.expects("#shortlist", f"trial {trials[1]}")
        return tab

    return opened


@pytest.mark.browser
def test_every_measure_of_the_comparison_has_a_row(payload, comparing):
    tab = comparing(payload)
    tab.expects("#compare-table", "Energies and loads")
    rows = tab.page.locator("#compare-table tbody").last.locator("tr:not(.group) th").all_inner_texts()
    labels = {quantity.name: quantity.label for quantity in payload.quantities}
    assert rows == [labels[name] for name in payload.compared]
    assert tab.complaints == []


@pytest.mark.browser
def test_an_unknown_measure_is_an_error_of_the_page_and_not_a_missing_row(payload, comparing):
    tab = comparing(replace(payload, compared=(*payload.compared, "peak_kneee_force_n")))
    assert tab.complaints == ["unknown measure or variable: peak_kneee_force_n"]
