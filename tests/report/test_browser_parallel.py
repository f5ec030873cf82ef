"""The parallel coordinates: any measure as an axis, their order by mouse and keyboard, the design under the pointer."""

import re

import numpy as np
import pytest

pytestmark = pytest.mark.browser

ORDER = "(all) => all.map((g) => g.dataset.axis)"


@pytest.fixture
def tab(shared):
    shared.reset()
    shared.to_chart("parallel-chart")
    return shared


def order(tab):
    return tab.page.eval_on_selector_all("#parallel-chart g.axis", ORDER)


def line(tab):
    """Where the line of the selected design meets the axes."""
    d = tab.page.get_attribute("#parallel-selected", "d")
    return [[float(v) for v in point.split()] for point in d[1:].split("L")]


def heads(tab):
    """Names over the axes from left to right, as a screen reader meets them."""
    return tab.page.eval_on_selector_all("#parallel-chart [data-head]", "(all) => all.map((one) => one.dataset.head)")


def tick_box(tab, name, checked):
    tab.page.evaluate("document.querySelector('#parallel-axes').closest('details').open = true")
    tab.page.set_checked(f"[data-parallel={name}]", checked)
    tab.to_chart("parallel-chart")


def test_any_measure_can_be_an_axis_and_undo_takes_it_back(tab, data, payload, file):
    (card,) = payload.studies
    before = order(tab)
    tick_box(tab, "peak_foot_force_n", True)
    tick_box(tab, "mass_kg", False)
    now = order(tab)
    assert now == heads(tab) == [*(name for name in before if name != "mass_kg"), "peak_foot_force_n"]
    # The new axis spans what the feasible trials have, and the selected design's line meets it at its value.
    group = "#parallel-chart g[data-axis=peak_foot_force_n]"
    top, bottom = (float(tab.page.get_attribute(f"{group} line >> nth=0", key)) for key in ("y1", "y2"))
    assert tab.page.get_attribute(group, "data-kind") == "linear"
    stored = data.trials.set_index("trial")
    forces = stored.loc[stored["state"] == "feasible", "peak_foot_force_n"]
    chosen = stored.loc[card.trials.trial[card.front[0]], "peak_foot_force_n"]
    share = (chosen - forces.min()) / np.ptp(forces)
    assert line(tab)[-1][1] == pytest.approx(bottom - share * (bottom - top), abs=0.2)
    # Its range can be typed, too, and is the whole page's.
    tab.page.evaluate("document.getElementById('brush-fields').closest('details').open = true")
    tab.page.fill("[data-range=peak_foot_force_n-to]", str(round(float(forces.median()), 1)))
    tab.page.keyboard.press("Tab")
    assert "peak foot force" in tab.text("#conditions")
    tab.page.wait_for_function("(words) => location.hash.includes(words)", arg=f"parallel={','.join(now)}")
    for _ in range(6):
        if order(tab) == before:
            break
        tab.page.click("#undo")
        tab.to_chart("parallel-chart")
    assert order(tab) == before
    assert tab.page.is_checked("[data-parallel=mass_kg]")
    tab.quiet(file)


@pytest.mark.long
def test_axes_are_ordered_by_dragging_their_names(tab):
    before = order(tab)
    head, goal = (tab.page.locator(f"[data-head={name}]").bounding_box() for name in (before[1], before[4]))
    y = head["y"] + 0.5 * head["height"]
    tab.page.mouse.move(head["x"] + 0.5 * head["width"], y)
    tab.page.mouse.down()
    tab.page.mouse.move(goal["x"] + 0.5 * goal["width"], y, steps=8)
    tab.page.mouse.up()
    after = [before[0], *before[2:5], before[1], *before[5:]]
    assert order(tab) == heads(tab) == after
    assert tab.page.locator("#conditions button").count() == 0
    # One step to undo, however many places it passed.
    tab.page.click("#undo")
    tab.to_chart("parallel-chart")
    assert order(tab) == before


def test_axes_are_ordered_by_the_keyboard_and_the_link_brings_the_order_back(tab, file, open_tab):
    before = order(tab)
    trial = tab.text("#subject").split()[1]
    tab.page.focus(f"[data-head={before[2]}]")
    for _ in range(3):
        tab.page.keyboard.press("ArrowLeft")
    after = [before[2], *before[:2], *before[3:]]
    assert order(tab) == heads(tab) == after
    assert tab.page.evaluate("document.activeElement.dataset.head") == before[2]
    assert "axis 1 of 10" in tab.page.get_attribute(f"[data-head={before[2]}]", "aria-label")
    assert tab.text("#subject").split()[1] == trial
    # The address follows a moment later, and may have been written between two of the keys as well.
    tab.page.wait_for_function("(words) => location.hash.includes(words)", arg=f"parallel={','.join(after)}")
    again = open_tab(file, fragment=tab.page.evaluate("location.hash"))
    again.to_chart("parallel-chart")
    assert order(again) == after


def test_hovering_tells_of_the_design_whose_line_is_under_the_pointer(tab, payload):
    (card,) = payload.studies
    points, box = line(tab), tab.page.locator("#parallel-chart").bounding_box()
    (x1, y1), (x2, y2) = points[-2:]
    x, y = x1 + 0.4 * (x2 - x1), y1 + 0.4 * (y2 - y1)
    tab.page.mouse.move(box["x"] + x, box["y"] + y)
    trial = int(re.match(r"trial (\d+)", tab.text("#parallel-chart .tip"))[1])
    # It is the selected design or one that lies as near: its line is drawn and passes there.
    d = tab.page.evaluate("document.querySelector('#parallel-selected').nextElementSibling.getAttribute('d')")
    drawn = [[float(v) for v in point.split()] for point in d[1:].split("L")]
    assert drawn[-2][1] + 0.4 * (drawn[-1][1] - drawn[-2][1]) == pytest.approx(y, abs=8.1)
    heights = card.trials.columns["height_m"]
    best, least = max(heights[row] for row in card.front), min(heights[row] for row in card.front)
    assert heights[card.trials.trial.index(trial)] - heights[card.front[0]] < 0.2 * (best - least)
    tab.page.mouse.move(box["x"] + x, box["y"] - 40)
    assert not tab.page.is_visible("#parallel-chart .tip")
