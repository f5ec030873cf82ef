"""The table of designs in the browser: sorted, searched, with chosen columns, downloaded, under the conditions."""

import csv
import io
import re
from importlib import resources

import numpy as np
import pytest

from pareto_monoped.pareto.selectors import Condition
from pareto_monoped.report.card import Source
from pareto_monoped.report.page import build, page
from pareto_monoped.report.tables import MOST_ROWS
from tests.report.conftest import grown, telling_mass_kg

pytestmark = pytest.mark.browser
ASSETS = resources.files("pareto_monoped") / "report" / "assets"


@pytest.fixture
def tab(shared):
    shared.reset()
    shared.page.locator("#rows").scroll_into_view_if_needed()
    shared.page.wait_for_selector("#rows-body tr[data-row]")
    return shared


@pytest.fixture(scope="module")
def card(payload):
    return payload.studies[0]


def rows(tab):
    """Cells of the rows in sight."""
    return tab.page.eval_on_selector_all(
        "#rows-body tr[data-row]", "(rows) => rows.map((row) => [...row.children].map((cell) => cell.textContent))"
    )


def downloaded(tab) -> list[dict[str, str]]:
    with tab.page.expect_download() as found:
        tab.page.click("#rows-csv")
    return list(csv.DictReader(io.StringIO(found.value.path().read_bytes().decode("utf-8"))))


def test_a_click_on_a_heading_sorts_and_another_turns_it_round(tab, card):
    columns = card.trials.columns
    order = sorted(card.front, key=lambda row: columns["mass_kg"][row])
    tab.page.click("[data-sort=mass_kg]")
    lightest = [float(cells[7]) for cells in rows(tab)]
    assert lightest == sorted(lightest)
    assert float(rows(tab)[0][7]) == pytest.approx(columns["mass_kg"][order[0]], abs=5e-4)
    assert tab.page.get_attribute("th:has([data-sort=mass_kg])", "aria-sort") == "ascending"
    tab.page.click("[data-sort=mass_kg]")
    assert float(rows(tab)[0][7]) == pytest.approx(columns["mass_kg"][order[-1]], abs=5e-4)
    assert tab.page.evaluate("document.activeElement.dataset.sort") == "mass_kg"


def test_the_download_has_all_rows_that_obey_the_conditions_and_what_was_stored(tab, card, data):
    limit = telling_mass_kg(card)
    tab.page.fill("#ask-mass_kg", repr(limit))
    kept = data.front(conditions=[Condition(name="mass_kg", side="max", value=limit)])["trial"].tolist()
    assert set(kept) - {card.trials.trial[row] for row in card.front}
    tab.page.locator("#rows").scroll_into_view_if_needed()
    tab.expects("#rows-note", f"{len(kept)} of {len(kept)} designs of the front within the conditions.")
    found = downloaded(tab)
    assert {int(row["trial"]) for row in found} == set(kept)
    stored = data.trials.set_index("trial")
    for row in found:
        assert (row["state"], row["motor"]) == ("feasible", "VT8020")
        for name in ("height_m", "energy_j", "electrical_energy_j", "thigh_length_m"):
            assert float(row[name]) == pytest.approx(stored.loc[int(row["trial"]), name], rel=6e-5)


def test_all_trials_and_any_column_can_be_had(tab, card, data):
    tab.page.select_option("#rows-choice", "all")
    tab.page.evaluate("document.querySelector('#table details').open = true")
    tab.page.check("[data-column=peak_chain_tension_n]")
    tab.page.uncheck("[data-column=mass_kg]")
    found = downloaded(tab)
    assert len(found) == len(data.trials)
    assert "mass_kg" not in found[0]
    pulls = data.trials.set_index("trial")["peak_chain_tension_n"]
    for row in found:
        expected = pulls[int(row["trial"])]
        assert (
            row["peak_chain_tension_n"] == ""
            if np.isnan(expected)
            else float(row["peak_chain_tension_n"]) == pytest.approx(expected, rel=3e-5)
        )
    heads = tab.page.locator("#rows-head th").all_text_contents()
    assert "peak chain tension, N" in heads


def test_the_search_finds_a_trial(tab, card):
    trial = card.trials.trial[card.front[3]]
    tab.page.fill("#rows-find", f"trial {trial} ")
    tab.page.wait_for_function("() => document.querySelectorAll('#rows-body tr[data-row]').length < 20")
    assert trial in {int(cells[1]) for cells in rows(tab)}
    tab.page.click(f"#rows-body button[aria-label='Select trial {trial}']")
    assert f"Trial {trial}" in tab.text("#subject")
    assert tab.page.locator("#rows-body tr.chosen").count() == 1


def test_a_condition_on_any_measure_is_the_whole_pages(tab, card, data):
    tab.page.select_option("#rows-measure", "peak_foot_force_n")
    forces = data.front()["peak_foot_force_n"]
    limit = round(float(forces.median()), 2)
    tab.page.fill("#rows-to", str(limit))
    tab.page.keyboard.press("Tab")
    kept = len(data.front(conditions=[Condition(name="peak_foot_force_n", side="max", value=limit)]))
    tab.expects("#rows-note", f"{kept} of {kept} designs of the front within the conditions.")
    assert f"{kept} designs on the front" in tab.text("#brush-note")
    assert "peak foot force" in tab.text("#conditions")


def test_a_measure_that_has_a_condition_already_is_chosen_with_its_ends(tab, card):
    limit = telling_mass_kg(card)
    tab.page.fill("#ask-mass_kg", repr(limit))
    for measure, shown in (("energy_j", ["", ""]), ("mass_kg", ["", repr(limit)])):
        tab.page.select_option("#rows-measure", measure)
        assert [tab.page.input_value(f"#rows-{end}") for end in ("from", "to")] == shown


def test_a_tick_keeps_a_design_and_six_are_the_most(tab, card):
    boxes = tab.page.locator("#rows-body input[type=checkbox]")
    for i in range(6):
        boxes.nth(i).check()
    boxes.nth(6).click()
    assert not boxes.nth(6).is_checked()
    assert "room for 6" in tab.text("#rows-note")
    tab.page.wait_for_function("() => location.hash.split('keep=').length === 7")
    tab.page.click("#undo")
    assert [boxes.nth(i).is_checked() for i in range(7)] == [True] * 5 + [False] * 2


@pytest.mark.long
def test_a_table_of_twenty_thousand_has_few_rows_in_the_document(data, resimulation, folder, open_tab):
    big = grown(data, 20_000)
    made = folder / "big_table.html"
    made.write_text(page(build([Source(data=big, resimulation=resimulation, models={})])), encoding="utf-8")
    tab = open_tab(made, fragment="#view=1&rows=all&sort=-energy_j")
    tab.page.locator("#rows").scroll_into_view_if_needed()
    tab.page.wait_for_selector("#rows-body tr[data-row]")
    assert tab.page.locator("#rows-body tr").count() < 60
    assert tab.page.get_attribute("#rows-table", "aria-rowcount") == str(len(big.trials) + 1)
    tab.page.evaluate("() => { const rows = document.getElementById('rows'); rows.scrollTop = rows.scrollHeight; }")
    tab.page.wait_for_function(
        "(n) => document.querySelector('#rows-body tr[data-row]:last-of-type')?.ariaRowIndex === String(n)",
        arg=len(big.trials) + 1,
    )
    assert tab.page.locator("#rows-body tr").count() < 60
    tab.quiet(made)


def test_without_scripts_and_in_print_the_plain_table_is_there(file, payload, browser, tab):
    context = browser.new_context(java_script_enabled=False)
    bare = context.new_page()
    bare.goto(file.as_uri())
    first = payload.studies[0]
    assert bare.locator("#table .plain tbody tr").count() == min(len(first.front), MOST_ROWS)
    assert bare.is_visible("#table .plain")
    assert not bare.is_visible("#rows")
    context.close()
    tab.medium("print", "light")
    assert tab.page.is_visible("#table .plain")
    assert not tab.page.is_visible("#rows")


@pytest.mark.parametrize("cell", ['5" leg', "a, b", "two\nlines", "plain", "", '"', "-1.5"])
def test_a_cell_of_a_csv_file_reads_back_as_it_was(tab, cell):
    """A quotation mark alone must be quoted, too (RFC 4180)."""
    source = (ASSETS / "table.js").read_text(encoding="utf-8")
    function = re.search(r"^function csvCell\(.*?^}", source, re.M | re.S)[0]
    line = tab.page.evaluate(f"cell => {{ {function}; return csvCell(cell) + ',end'; }}", cell)
    assert next(csv.reader(io.StringIO(line, newline=""))) == [cell, "end"]
    assert ('"' in line) == any(mark in cell for mark in ',\n"')
