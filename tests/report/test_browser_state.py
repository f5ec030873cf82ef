"""The page's one state: conditions that everything obeys, its place in the address, and undo."""

import re
from types import SimpleNamespace
from urllib.parse import quote

import numpy as np
import pytest

from tests.report.conftest import front_below, telling_mass_kg

pytestmark = pytest.mark.browser


@pytest.fixture
def tab(shared):
    shared.reset()
    return shared


@pytest.fixture(scope="module")
def card(payload):
    return payload.studies[0]


@pytest.fixture(scope="module")
def limits(card):
    """A height and a mass, the designs that meet them, and the front of these, by brute force."""
    columns = card.trials.columns
    height = float(np.quantile([columns["height_m"][row] for row in card.front], 0.3))
    mass = telling_mass_kg(card, height)
    kept, able = front_below(card, height, mass)
    assert set(kept) - set(card.front), "the conditions bring something to the front"
    return SimpleNamespace(height=height, mass=mass, kept=kept, able=able)


def ask(tab, limits):
    tab.page.fill("#ask-height", repr(limits.height))
    tab.page.fill("#ask-mass_kg", repr(limits.mass))


def address(tab, words):
    """The fragment, once it has these words."""
    tab.page.wait_for_function("(words) => location.hash.includes(words)", arg=words)
    return tab.page.evaluate("location.hash")


def trial_shown(tab):
    return int(tab.text("#subject").split()[1].strip(","))


def test_conditions_combine_and_everything_obeys_them(tab, card, limits):
    ask(tab, limits)
    columns = card.trials.columns
    best = min(limits.kept, key=lambda row: (columns["energy_j"][row], -columns["height_m"][row]))
    assert trial_shown(tab) == card.trials.trial[best]
    assert f"{len(limits.able)} designs meet this, {len(limits.kept)} on the front." in tab.text("#ask-answer")
    assert f"{len(limits.kept)} designs on the front" in tab.text("#brush-note")
    # The keys stop nowhere else.
    tab.page.focus("#front-chart")
    seen = []
    tab.page.keyboard.press("Home")
    for _ in range(len(limits.kept)):
        seen.append(trial_shown(tab))
        tab.page.keyboard.press("ArrowRight")
    assert seen == [card.trials.trial[row] for row in limits.kept]
    assert trial_shown(tab) == seen[-1]


def test_what_cannot_be_had_names_the_nearest(tab, card):
    columns = card.trials.columns
    height = max(columns["height_m"][row] for row in card.front)
    able = [row for row, letter in enumerate(card.trials.state) if letter == "f" and row not in card.ill_conditioned]
    mass = min(columns["mass_kg"][row] for row in able)
    if any(columns["height_m"][r] >= height and columns["mass_kg"][r] <= mass for r in able):
        pytest.skip("the lightest design is the best")
    # The highest jump is shown, so that the least mass brings another design.
    tab.page.focus("#front-chart")
    tab.page.keyboard.press("End")
    before = trial_shown(tab)
    tab.page.fill("#ask-mass_kg", repr(mass))
    chosen = trial_shown(tab)
    tab.page.fill("#ask-height", repr(height))
    spans = {n: np.ptp([columns[n][r] for r in able]) for n in ("height_m", "mass_kg")}

    def short(row):
        lacking = max(height - columns["height_m"][row], 0) / spans["height_m"]
        return max(lacking, max(columns["mass_kg"][row] - mass, 0) / spans["mass_kg"])

    nearest = card.trials.trial[min(able, key=short)]
    assert f"meets all of this. The nearest is trial {nearest}," in tab.text("#ask-answer")
    lightest = min(columns["mass_kg"][row] for row in able if columns["height_m"][row] >= height)
    offered = re.search(r"mass ≤ ([0-9.]+) kg", tab.text("#ask-answer"))
    assert lightest <= float(offered[1]) <= lightest + 1e-4
    assert trial_shown(tab) == chosen != before


def test_a_link_brings_the_same_view_back(tab, file, card, limits, open_tab):
    ask(tab, limits)
    tab.page.check("[data-show=infeasible]")
    fragment = address(tab, "layers=")
    again = open_tab(file, fragment=fragment)
    assert trial_shown(again) == trial_shown(tab)
    assert again.text("#ask-answer") == tab.text("#ask-answer")
    assert again.text("#brush-note") == tab.text("#brush-note")
    assert again.page.is_checked("[data-show=infeasible]")
    assert float(again.page.input_value("#ask-height")) == pytest.approx(limits.height, rel=1e-5)
    again.page.reload()
    again.page.wait_for_selector("#table.live")
    assert again.page.evaluate("location.hash") == fragment
    assert trial_shown(again) == trial_shown(tab)
    # A link opened in the same tab does the same.
    tab.reset()
    tab.page.wait_for_function("() => !location.hash.includes('range=')")
    tab.page.evaluate("(hash) => { location.hash = hash; }", fragment)
    tab.expects("#ask-answer", again.text("#ask-answer"))


@pytest.mark.parametrize(
    "damage",
    [
        *("at=0:999999", "range=height_m:low:", "%", "keep=0:x"),
        *(
            pytest.param(damage, marks=pytest.mark.long)
            for damage in (
                *("range=none:1:2", "range=height_m:2:1", "shine=1", "hide=x"),
                *("at=0:case:none", "sort=none", "keep=0:1:%E0%A4%A"),
            )
        ),
    ],
)
def test_a_damaged_address_is_left_out_with_one_line(tab, damage):
    tab.page.evaluate("location.hash = '#view=1&log=x'")
    tab.page.wait_for_function("() => document.getElementById('page-note').textContent === ''")
    before = trial_shown(tab)
    tab.page.evaluate("(fragment) => { location.hash = fragment; }", f"#view=1&log=y&{damage}")
    tab.expects("#page-note", "is damaged or of another report")
    assert trial_shown(tab) == before
    assert [tab.page.is_checked(f"#log-{axis}") for axis in "xy"] == [True, False]
    assert tab.complaints == []
    # The first change writes a good one.
    tab.page.fill("#ask-height", "0.7")
    assert damage not in address(tab, "range=height_m:0.7:")


def test_a_page_opened_at_a_damaged_address_is_as_without_one(file, card, open_tab):
    tab = open_tab(file, fragment="#view=1&at=0:999999")
    assert "is damaged or of another report" in tab.text("#page-note")
    assert trial_shown(tab) == card.trials.trial[card.picks[0].row]
    assert tab.complaints == []


def test_undo_and_redo_walk_through_the_views(tab, card, limits):
    start = trial_shown(tab)
    tab.page.wait_for_timeout(1100)
    tab.page.fill("#ask-height", repr(limits.height))
    tab.page.wait_for_timeout(1100)
    first = trial_shown(tab)
    tab.page.fill("#ask-mass_kg", repr(limits.mass))
    second = trial_shown(tab)
    tab.page.uncheck("[data-show=cloud]")
    tab.page.focus("#front-chart")
    tab.page.keyboard.press("Control+z")
    assert tab.page.is_checked("[data-show=cloud]")
    for _ in range(6):
        tab.page.click("#undo")
        if not tab.page.input_value("#ask-mass_kg"):
            break
    assert trial_shown(tab) == first
    assert tab.page.input_value("#ask-height") != ""
    for _ in range(10):  # more than there are steps: a walk that goes nowhere ends
        if not tab.page.input_value("#ask-height"):
            break
        tab.page.click("#undo")
    assert trial_shown(tab) == start
    for _ in range(20):
        if not tab.page.is_enabled("#redo"):
            break
        tab.page.click("#redo")
    assert trial_shown(tab) == second
    assert not tab.page.is_checked("[data-show=cloud]")
    # What was undone is gone after another change: one step back is the view in which that was made.
    for _ in range(2):
        tab.page.click("#undo")
    height, mass = (tab.page.input_value(name) for name in ("#ask-height", "#ask-mass_kg"))
    tab.page.wait_for_timeout(1100)
    tab.page.uncheck("[data-show=cloud]")
    assert not tab.page.is_enabled("#redo")
    tab.page.click("#undo")
    assert (tab.page.input_value("#ask-height"), tab.page.input_value("#ask-mass_kg")) == (height, mass)


def test_conditions_stand_in_words_and_can_be_dropped_one_by_one(tab, limits):
    ask(tab, limits)
    assert tab.page.locator("#conditions button").count() == 3
    tab.page.click("#conditions [data-drop=mass_kg]")
    assert tab.page.input_value("#ask-mass_kg") == ""
    assert tab.page.locator("#conditions button").count() == 1
    tab.page.click("#conditions [data-drop=height_m]")
    assert not tab.page.is_visible("#conditions")
    assert tab.text("#ask-answer") == ""


def test_links_within_the_page_keep_the_view(tab, limits):
    ask(tab, limits)
    fragment = address(tab, "mass_kg")
    tab.page.click("nav a[href='#search']")
    tab.page.wait_for_timeout(300)
    assert tab.page.evaluate("location.hash") == fragment
    assert tab.page.evaluate("document.activeElement.id") == "search"
    assert tab.page.evaluate("document.getElementById('search').getBoundingClientRect().top") < 300


def test_keys_reach_every_study_shown(both, both_file, open_tab):
    tab = open_tab(both_file)
    first, second = both.studies
    tab.page.focus("#front-chart")
    tab.page.keyboard.press("Home")
    assert trial_shown(tab) == first.trials.trial[first.front[0]]
    height = first.trials.columns["height_m"][first.front[0]]
    heights = second.trials.columns["height_m"]
    nearest = min(second.front, key=lambda row: abs(heights[row] - height))
    tab.page.keyboard.press("Shift+ArrowRight")
    assert second.label in tab.text("#subject")
    assert trial_shown(tab) == second.trials.trial[nearest]
    tab.page.keyboard.press("Shift+ArrowLeft")
    assert first.label in tab.text("#subject")
    tab.page.uncheck("[data-study='0']")
    tab.page.focus("#front-chart")
    tab.page.keyboard.press("ArrowRight")
    assert second.label in tab.text("#subject")
    # A question is answered by the studies shown.
    tab.page.fill("#ask-height", str(round(min(heights[row] for row in second.front), 3) - 0.001))
    assert f"of {second.label}" in tab.text("#ask-answer")


def test_a_note_of_the_shortlist_survives_the_address(file, card, open_tab):
    row = card.front[2]
    note = "light & strong: 50 %, \N{GREEK SMALL LETTER OMEGA}"
    tab = open_tab(file, fragment=f"#view=1&keep=0:{card.trials.trial[row]}:{quote(note, safe='')}")
    tab.page.fill("#ask-height", "0.7")
    assert quote(note, safe="") in address(tab, "range=")
    assert tab.text("#page-note") == ""
