"""The page for everyone: axe-core, the keyboard alone, a finger on a phone."""

from pathlib import Path

import pytest

pytestmark = pytest.mark.browser

AXE = (Path(__file__).parent / "axe" / "axe.min.js").read_text(encoding="utf-8")
VIEWS = {
    "new": "",
    "conditions": "#view=1&range=mass_kg::4.6&colour=electrical_energy_j&size=mass_kg&rows=all"
    "&parallel=height_m,mass_kg,peak_foot_force_n",
    "space": "#view=1&space=1&colour=mass_kg&log=x",
}


@pytest.fixture(scope="module")
def file(both_file):
    return both_file


# Of every two of size, colours and view one is tried that has both; the other half takes longer tests.
LOOKS = [
    pytest.param(*size, view, marks=() if (i + k) % 2 == 0 else pytest.mark.long)
    for i, size in enumerate(((1440, 900), (390, 844)))
    for k, view in enumerate(VIEWS)
]


@pytest.mark.parametrize(("width", "height", "view"), LOOKS)
@pytest.mark.long
def test_axe_finds_nothing_serious(file, open_tab, width, height, view):
    """All its rules in light colours; of those, only contrast depends on the scheme."""
    tab = open_tab(file, width=width, height=height, fragment=VIEWS[view])
    tab.scroll_through()
    tab.page.evaluate("document.querySelectorAll('details').forEach((d) => { d.open = true; })")
    tab.page.evaluate(AXE)
    found = tab.page.evaluate("axe.run(document, { resultTypes: ['violations'] })")
    assert len(found["passes"]) > 20
    tab.look(width, height, "dark")
    dark = tab.page.evaluate("axe.run(document, { resultTypes: ['violations'], runOnly: ['color-contrast'] })")
    assert [one["id"] for one in dark["passes"]] == ["color-contrast"]
    serious = [
        (one["id"], [node["html"][:120] for node in one["nodes"][:3]])
        for one in (*found["violations"], *dark["violations"])
        if one["impact"] in ("serious", "critical")
    ]
    assert serious == []
    tab.quiet(file)


def focused(tab, selector, most=120):
    """Press Tab until an element has the focus."""
    for _ in range(most):
        tab.page.keyboard.press("Tab")
        if tab.page.evaluate("(s) => document.activeElement.matches(s)", selector):
            return
    raise AssertionError(f"{selector} cannot be reached with the keyboard")


@pytest.mark.parametrize(("width", "height"), [(1440, 900), pytest.param(390, 844, marks=pytest.mark.long)])
def test_the_keyboard_alone_asks_walks_zooms_sorts_and_keeps(file, open_tab, width, height):
    tab = open_tab(file, width=width, height=height)
    keys = tab.page.keyboard
    focused(tab, "#ask-height")
    keys.type("0.7")
    assert "on the front" in tab.text("#ask-answer")
    focused(tab, "#undo")
    focused(tab, ".fold summary")
    if not tab.page.evaluate("document.querySelector('.fold').open"):
        keys.press("Enter")
    focused(tab, "#log-x")
    keys.press("Space")
    tab.page.wait_for_function("() => document.getElementById('front-chart').chart.x.kind === 'log'")
    focused(tab, "#front-chart")
    before = tab.text("#subject")
    keys.press("End")
    assert tab.text("#subject") != before
    ends = "() => document.getElementById('front-chart').chart.x.range"
    whole = tab.page.evaluate(ends)
    keys.press("+")
    near = tab.page.evaluate(ends)
    assert near[1] / near[0] < whole[1] / whole[0]
    keys.press("0")
    assert tab.page.evaluate(ends) == whole
    keys.press("Shift+ArrowRight")
    assert "u12" in tab.text("#subject")
    focused(tab, "[data-study='1']")
    keys.press("Space")
    focused(tab, "#rows-choice")
    focused(tab, "[data-sort=mass_kg]")
    keys.press("Enter")
    assert tab.page.get_attribute("th:has([data-sort=mass_kg])", "aria-sort") == "ascending"
    focused(tab, "#rows-body input")
    keys.press("Space")
    focused(tab, "#rows-body button")
    keys.press("Enter")
    assert tab.page.locator("#rows-body tr.chosen").count() == 1
    tab.page.wait_for_function("() => location.hash.includes('keep=')")
    tab.quiet(file)


@pytest.mark.long
def test_a_swipe_over_the_charts_scrolls_the_page_and_a_tap_selects(file, open_tab):
    tab = open_tab(file, width=390, height=844, options={"has_touch": True, "is_mobile": True})
    session = tab.context.new_cdp_session(tab.page)
    for chart in ("front-chart", "parallel-chart", "convergence", "map-chart"):
        tab.page.evaluate("(id) => document.getElementById(id).scrollIntoView({ block: 'center' })", chart)
        tab.page.wait_for_timeout(150)
        box = tab.page.locator(f"#{chart}").bounding_box()
        before = tab.page.evaluate("[scrollY, JSON.stringify(document.getElementById('front-chart').chart.view)]")
        x, y = box["x"] + 0.5 * min(box["width"], 360), box["y"] + 0.6 * box["height"]
        finger = {"type": "touchStart", "touchPoints": [{"x": x, "y": y}]}
        session.send("Input.dispatchTouchEvent", finger)
        for step in range(1, 11):
            finger = {"type": "touchMove", "touchPoints": [{"x": x, "y": y - 15 * step}]}
            session.send("Input.dispatchTouchEvent", finger)
            tab.page.wait_for_timeout(16)
        session.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
        after = tab.page.evaluate("[scrollY, JSON.stringify(document.getElementById('front-chart').chart.view)]")
        assert after[0] > before[0] + 60, chart
        assert after[1] == before[1]
    assert tab.page.evaluate("location.hash") == ""
    tab.to_front()
    words = tab.text("#subject")
    tab.page.touchscreen.tap(*tab.point("front", 0))
    tab.page.wait_for_function("(words) => document.getElementById('subject').innerText !== words", arg=words)
    tab.quiet(file)
