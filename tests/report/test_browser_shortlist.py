"""The shortlist and the comparison in a browser: by mouse, by keyboard alone, on paper, and without scripts."""

import re
import subprocess
from types import SimpleNamespace

import pytest


@pytest.fixture(scope="module")
def made(payload, file) -> SimpleNamespace:
    (card,) = payload.studies
    return SimpleNamespace(file=file, card=card)


@pytest.fixture
def tab(shared):
    shared.reset()
    return shared


def go_to(tab, made, place):
    trial = made.card.trials.trial[made.card.front[place]]
    tab.page.evaluate(f"location.hash = '#view=1&at=0:{trial}'")
    tab.expects("#subject", f"Trial {trial}")
    return trial


def keep(tab, made, *places):
    trials = []
    for place in places:
        rest = "".join(f"&keep=0:{trial}:" for trial in trials)
        trial = made.card.trials.trial[made.card.front[place]]
        tab.page.evaluate(f"location.hash = '#view=1&at=0:{trial}{rest}'")
        tab.expects("#subject", f"Trial {trial}")
        tab.page.click("#keep button")
        trials.append(trial)
    return trials


def jumping(made, count):
    """Places on the front of designs whose jump the page has."""
    front = [made.card.trials.trial[row] for row in made.card.front]
    return [place for place, trial in enumerate(front) if trial in made.card.jumps.keys][:count]


def test_two_kept_designs_are_compared_value_by_value(tab, made):
    places = jumping(made, 2)
    assert tab.page.is_hidden("#comparison")
    trials = keep(tab, made, *places)
    assert tab.page.is_visible("#comparison")
    heads = tab.page.locator("#compare-table thead th").all_inner_texts()
    assert heads[1:3] == [f"trial {trial}" for trial in trials]
    rows = {
        row[0]: row[1:]
        for row in (line.split("\t") for line in tab.page.locator("#compare-table tbody tr").all_inner_texts())
    }
    columns = made.card.trials.columns
    for name, label, scale, decimals in (("thigh_length_m", "thigh length", 1000, 1), ("height_m", "height", 1, 3)):
        expected = [f"{columns[name][made.card.front[place]] * scale:.{decimals}f}" for place in places]
        assert [cell.strip() for cell in rows[label][:2]] == expected


def test_the_robots_play_together_at_one_scale(tab, made):
    keep(tab, made, *jumping(made, 3))
    assert tab.page.locator("#race-stage svg").count() == 1
    lanes = "#race-stage svg > g"
    assert tab.page.locator(lanes).count() == 3
    assert tab.page.locator("#race-chart path.js-line").count() == 3
    base = f"{lanes} > g > path:first-child"

    def places():
        return tab.page.locator(base).evaluate_all("(all) => all.map((part) => part.getAttribute('transform'))")

    tab.page.fill("#race-scrub", "0")
    start = places()
    tab.page.select_option("#race-speed", "1")
    tab.page.click("#race-play")
    tab.expects("#race-play", "Play all")
    assert all(a != b for a, b in zip(start, places(), strict=True))
    assert float(tab.page.input_value("#race-scrub")) == 1000


def test_one_command_exports_them_all(tab, made):
    trials = keep(tab, made, *jumping(made, 2))
    line = tab.text("#export-all code")
    assert f"for n in {trials[0]} {trials[1]}; do pareto-monoped export " in line
    said = re.sub(r"pareto-monoped export", "echo", line)
    ran = subprocess.run(["sh", "-c", said], capture_output=True, text=True, check=True).stdout.splitlines()
    assert [text.split(" --trial ")[1] for text in ran] == [f"{trial} -o cad/trial_{trial}" for trial in trials]


def test_notes_and_shortlist_come_back_with_the_link(tab, made, open_tab):
    keep(tab, made, *jumping(made, 2))
    tab.page.fill("#kept li:nth-child(2) input", "lighter: <b>& more")
    tab.page.wait_for_timeout(400)
    link = tab.page.evaluate("location.href")
    other = open_tab(made.file)
    other.page.goto(link)
    other.page.reload()
    other.page.wait_for_selector("#kept input")
    assert other.page.input_value("#kept li:nth-child(2) input") == "lighter: <b>& more"
    assert other.page.is_visible("#comparison")
    tab.page.click("#kept li:nth-child(1) button:last-child")
    tab.page.wait_for_timeout(50)
    assert tab.page.locator("#kept li").count() == 1
    tab.page.click("#undo")
    assert tab.page.locator("#kept li").count() == 2


def test_a_link_followed_is_not_written_over_before_it_is_read(tab, made):
    """A reload at once came back without the link's view: what was still to be written took its place."""
    first, second = jumping(made, 2)
    keep(tab, made, first)
    tab.page.wait_for_timeout(400)
    link = tab.page.evaluate("location.hash")
    keep(tab, made, second)
    found = tab.page.evaluate(
        "link => { document.querySelector('#kept li:nth-child(1) button:last-child').click();"
        " location.hash = link; window.dispatchEvent(new Event('pagehide')); return location.hash; }",
        link,
    )
    assert found == link


@pytest.mark.long
def test_seven_do_not_fit(tab, made):
    keep(tab, made, *range(6))
    go = made.card.trials.trial[made.card.front[7]]
    kept = "&".join(f"keep=0:{made.card.trials.trial[made.card.front[i]]}:" for i in range(6))
    tab.page.evaluate(f"location.hash = '#view=1&at=0:{go}&{kept}'")
    tab.expects("#keep", "Shortlist is full")
    assert tab.page.is_disabled("#keep button")


@pytest.mark.parametrize(("width", "scheme"), [(1440, "light"), (390, "dark")])
def test_by_keyboard_alone_at_any_width_and_in_any_colours(tab, made, width, scheme):
    tab.look(width, 900, scheme)
    tab.page.focus("#keep button")
    tab.page.keyboard.press("Enter")
    assert tab.page.evaluate("document.activeElement.closest('#keep') !== null")
    tab.page.focus("#front-chart")
    tab.page.keyboard.press("ArrowRight")
    tab.page.focus("#keep button")
    tab.page.keyboard.press("Space")
    tab.page.wait_for_selector("#comparison:not([hidden])")
    tab.page.focus("#kept input >> nth=0")
    tab.page.keyboard.type("first")
    assert tab.page.input_value("#kept input >> nth=0") == "first"
    tab.page.keyboard.press("Tab")
    tab.page.keyboard.press("Enter")
    assert tab.page.locator("#kept li").count() == 1
    assert tab.page.evaluate("document.activeElement.closest('#kept') !== null")
    assert tab.page.evaluate("document.documentElement.scrollWidth") <= width
    tab.quiet(made.file)


@pytest.mark.long
def test_paper_is_light_whatever_the_screen(tab):
    tab.look(scheme="dark")
    assert tab.page.evaluate("getComputedStyle(document.documentElement).getPropertyValue('--ink').trim()") == "#e6edf3"
    tab.medium("print", "dark")
    assert tab.page.evaluate("getComputedStyle(document.documentElement).getPropertyValue('--ink').trim()") == "#1b1f24"
    for selector in ("#ask", "nav", ".player", "#keep"):
        assert tab.page.is_hidden(selector)
    swatch = tab.page.locator("#mass .stack i").first
    assert swatch.evaluate("(node) => getComputedStyle(node).printColorAdjust") == "exact"
    # A link's paper shows what is folded away, and the screen folds it again.
    folded = tab.page.locator("details:not([open])").count()
    assert folded
    tab.page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    assert tab.page.locator("details:not([open])").count() == 0
    tab.page.evaluate("window.dispatchEvent(new Event('afterprint'))")
    assert tab.page.locator("details:not([open])").count() == folded


def test_without_scripts_the_tables_are_there(made, browser):
    context = browser.new_context(java_script_enabled=False)
    tab = context.new_page()
    tab.goto(made.file.as_uri())
    text = tab.text_content("body")
    assert "need JavaScript" in text
    for words in ("Among published jumping robots", "The paper's designs (Table I)", "m J from", "is reproduced by"):
        assert words in text
    context.close()
