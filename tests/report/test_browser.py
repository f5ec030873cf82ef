"""The page in headless Chromium, from a file, with the network off."""

import io
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from pareto_monoped.design import PAPER_CASES
from pareto_monoped.pareto.selectors import Condition
from pareto_monoped.report.card import Source
from pareto_monoped.report.exports import model_of
from pareto_monoped.report.page import build, embedded, page, payload_of
from tests.report.conftest import cut, grown

pytestmark = pytest.mark.browser


@pytest.fixture
def tab(shared):
    shared.reset()
    return shared


def written(folder, name, sources):
    file = folder / name
    file.write_text(page(build(sources)), encoding="utf-8")
    return file


def test_asks_for_nothing_and_complains_of_nothing(tab, file):
    tab.scroll_through()
    assert tab.page.evaluate("document.documentElement.scrollWidth") == 1440
    assert tab.page.locator("#convergence .main-svg").count() > 0
    assert tab.page.locator("#map-chart .main-svg").count() > 0
    tab.quiet(file)


def test_bounds_that_limit_the_front_stand_beside_its_variables_and_not_before_it(tab, payload):
    (card,) = payload.studies
    assert card.at_bounds
    tab.to_chart("parallel-chart")
    assert tab.text("#at-bounds").splitlines() == list(card.at_bounds)
    header = tab.text("header")
    assert [note for note in card.at_bounds if note in header] == []


def test_begins_with_the_knee_and_the_sentence(shared, payload):
    (card,) = payload.studies
    assert f"Trial {card.trials.trial[card.picks[0].row]}" in shared.at_first["#subject"]
    assert card.summary[0] in shared.at_first["header"]


def test_a_click_on_a_point_selects_it_everywhere(tab, payload, file):
    (card,) = payload.studies
    at = len(card.front) - 1
    row = card.front[at]
    tab.click_point("front", at)
    tab.expects("#subject", f"Trial {card.trials.trial[row]}")
    assert f"{card.trials.columns['height_m'][row]:.3f} m" in tab.text("#headline")
    assert f"{card.trials.columns['thigh_length_m'][row] * 1000:.1f} mm" in tab.text("#variables")
    knee = payload.gearboxes[card.trials.columns["knee_gearbox"][row]]
    assert f"{knee.sun_teeth}/{knee.planet_teeth}/{knee.ring_teeth}" in tab.text("#gears")
    assert f"{card.trials.columns['mass_kg'][row]:.3f} kg" in tab.text("#mass")
    assert f"--trial {card.trials.trial[row]}" in tab.text("#commands")
    assert tab.page.get_attribute("#front-chart", "aria-valuenow") == str(at + 1)
    tab.to_chart("time-charts")
    assert tab.page.locator("#time-charts .subplot").count() == 5
    tab.quiet(file)


def test_a_click_on_the_papers_diamond_shows_that_case(tab, payload):
    tab.click_point("simulated", 0)
    tab.expects("#subject", "nominal design")
    assert f"{payload.studies[0].cases[0].energy_j:.2f} J" in tab.text("#headline")
    assert "simulate --case nominal" in tab.text("#commands")


def test_the_efficiency_is_work_against_gravity_and_the_floor_that_of_all_poses(tab, data, payload):
    best = data.front().iloc[0]
    share = best["mass_kg"] * 9.81 * (best["height_m"] - 0.5) / best["energy_j"]
    assert share == pytest.approx(best["efficiency"], rel=1e-6)
    shown = re.search(r"([\d.]+) %\s*mechanical efficiency", tab.text("#headline"))
    assert float(shown[1]) == pytest.approx(100 * share, abs=0.1)  # the numbers of a page are rounded
    x, y = tab.page.evaluate(
        "(({ x, y }) => [x, y])(document.getElementById('front-chart').layers.find((t) => t.name === 'floor'))"
    )
    assert x[0] == 0
    assert x[1] > 0
    np.testing.assert_allclose(x, np.interp(y, payload.constants.floor_heights_m, payload.studies[0].floor_j))
    assert "floor: least rise of potential energy" in tab.text("#switches")


def test_a_case_has_the_gearboxes_of_its_ratios(tab, data):
    tab.click_point("simulated", 3)
    tab.expects("#subject", "Case C")
    case = PAPER_CASES["C"].design
    hip, knee = (data.case_kit.hip.lookup(ratio).gears for ratio in (case.hip_ratio, case.knee_ratio))
    row = " ".join(f"{g.sun_teeth}/{g.planet_teeth}/{g.ring_teeth}" for g in (hip, knee))
    assert row in " ".join(tab.text("#gears").split())


@pytest.mark.long
def test_the_drawn_robot_has_the_dimensions_of_its_own_motor(source, source_u12, both_file, open_tab):
    """The page once drew the default motor's leg, whatever the motor."""
    tab = open_tab(both_file)
    for study, here in enumerate((source, source_u12)):
        if study == 1:
            tab.page.uncheck("[data-study='0']")
        tab.click_point("front", 0)
        tab.expects("#subject", f"{here.data.study.name}")
        radius_m = float(tab.page.get_attribute("#stage g circle[fill='var(--metal)']", "r"))
        actuator = here.data.case_kit.hip.lookup(4.05)
        assert radius_m == pytest.approx(1e-3 * actuator.mount.housing_radius_mm)
    tab.to_chart("link-chart")
    tab.page.wait_for_function("() => document.getElementById('link-chart').layers?.length === 5")
    lines = tab.page.evaluate("document.getElementById('link-chart').layers.map((t) => t.name)")
    assert lines == ["thigh, VT8020", "shank, VT8020", "thigh, U12", "shank, U12", "published link"]
    published = tab.page.evaluate("(({ x, y }) => [x[0], y[0]])(document.getElementById('link-chart').layers.at(-1))")
    assert published == pytest.approx([150.0, 0.235 + 0.828 * 0.150])


def test_arrow_keys_move_along_the_front(tab, payload):
    (card,) = payload.studies
    tab.page.focus("#front-chart")
    tab.page.keyboard.press("Home")
    assert tab.page.get_attribute("#front-chart", "aria-valuenow") == "1"
    for _ in range(3):
        tab.page.keyboard.press("ArrowRight")
    assert f"Trial {card.trials.trial[card.front[3]]}" in tab.text("#subject")
    tab.page.keyboard.press("ArrowDown")
    assert f"Trial {card.trials.trial[card.front[2]]}" in tab.text("#subject")
    tab.click_point("simulated", 0)
    tab.expects("#subject", "nominal design")
    tab.page.keyboard.press("End")
    assert tab.page.get_attribute("#front-chart", "aria-valuenow") == str(len(card.front))


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_a_height_typed_in_gets_the_cheapest_design_that_reaches_it(tab, data, share):
    from pareto_monoped.pareto.pick import pick
    from pareto_monoped.pareto.selectors import MinHeight

    front = data.front()
    low, high = front["height_m"].min(), front["height_m"].max()
    wanted = round(low + share * (high - low), 3)
    tab.page.fill("#ask-height", str(wanted))
    trial = pick(front, MinHeight(height_m=wanted)).trial
    assert f"Trial {trial}" in tab.text("#subject")
    assert f"Trial {trial}" in tab.text("#ask-answer")


def test_a_number_is_typed_key_by_key(tab):
    """The page answers each key, and leaves what is typed alone."""
    tab.page.fill("#ask-height", "")
    tab.page.locator("#ask-height").press_sequentially("0.80")
    assert tab.page.input_value("#ask-height") == "0.80"


def test_an_energy_typed_in_gets_the_highest_jump_on_it(tab, data):
    from pareto_monoped.pareto.pick import pick
    from pareto_monoped.pareto.selectors import MaxEnergy

    front = data.front()
    # One decimal: the page rounds its values to five digits, which may move one across a finer limit.
    allowed = round(float(front["energy_j"].median()) + 0.05, 1)
    tab.page.fill("#ask-energy", str(allowed))
    assert f"Trial {pick(front, MaxEnergy(energy_j=allowed)).trial}" in tab.text("#subject")
    tab.page.fill("#ask-energy", "")
    tab.page.fill("#ask-height", "99")
    assert "No stored design meets this. The nearest is trial" in tab.text("#ask-answer")
    least = re.search(r"It is met with height ≥ ([0-9.]+) m", tab.text("#ask-answer"))
    assert front["height_m"].max() - 1e-4 <= float(least[1]) <= front["height_m"].max()


def drag_axis(tab, name, top=0.1, bottom=0.5):
    tab.to_chart("parallel-chart")
    line = tab.page.locator(f"#parallel-chart g[data-axis={name}] line").first
    box = line.bounding_box()
    tab.page.mouse.move(box["x"], box["y"] + top * box["height"])
    tab.page.mouse.down()
    tab.page.mouse.move(box["x"], box["y"] + 0.5 * (top + bottom) * box["height"])
    tab.page.mouse.move(box["x"], box["y"] + bottom * box["height"])
    tab.page.mouse.up()


def test_a_range_on_an_axis_dims_the_front_outside_it(tab, payload, data, file):
    (card,) = payload.studies
    drag_axis(tab, "energy_j")
    low, high = (float(tab.page.input_value(f"[data-range=energy_j-{side}]")) for side in ("from", "to"))
    tab.to_front()
    energies = [card.trials.columns["energy_j"][row] for row in card.front]
    inside = [low <= energy <= high for energy in energies]
    assert 0 < sum(inside) < len(inside)
    within = data.front(
        conditions=[Condition(name="energy_j", side=s, value=v) for s, v in (("min", low), ("max", high))]
    )
    assert f"{len(within)} designs on the front" in tab.text("#brush-note")
    opacity = tab.page.evaluate(
        "document.getElementById('front-chart').layers.find((t) => t.name === 'front').marker.opacity"
    )
    assert [value == 1 for value in opacity] == inside
    tab.page.click("#clear-ranges")
    assert tab.page.input_value("[data-range=energy_j-from]") == ""
    tab.quiet(file)


def test_a_range_can_be_typed(tab, payload):
    (card,) = payload.studies
    tab.page.click("#parallel summary")
    heights = [card.trials.columns["height_m"][row] for row in card.front]
    least = round(float(np.median(heights)), 3)
    tab.page.fill("[data-range=height_m-from]", str(least))
    tab.page.keyboard.press("Tab")
    inside = sum(height >= least for height in heights)
    assert 0 < inside < len(heights)
    assert f"{inside} designs on the front" in tab.text("#brush-note")
    tab.page.click("#clear-ranges")


def test_a_click_on_a_line_of_the_parallel_coordinates_selects_its_design(tab, payload):
    (card,) = payload.studies
    tab.to_chart("parallel-chart")
    lines = tab.page.locator("#parallel-chart g.axis > line:first-of-type")
    before, last = lines.nth(lines.count() - 2).bounding_box(), lines.last.bounding_box()
    # The top end of the energy axis belongs to the dearest design or one close to it.
    tab.page.mouse.click(0.5 * (before["x"] + last["x"]) + 20, before["y"] + 30)
    trial = int(re.search(r"Trial (\d+)", tab.text("#subject"))[1])
    heights = card.trials.columns["height_m"]
    assert heights[card.trials.trial.index(trial)] > np.median([heights[row] for row in card.front])


def test_the_jump_plays_and_the_foot_stands_on_the_floor(tab):
    tab.page.focus("#scrub")
    tab.page.keyboard.press("Home")
    first = tab.page.get_attribute("#stage svg > g > path", "transform")
    tab.page.select_option("#speed", "1")
    tab.page.click("#play")
    tab.expects("#play", "Play")
    assert float(tab.page.input_value("#scrub")) == 1000
    assert tab.page.get_attribute("#stage svg > g > path", "transform") != first


def test_switches_hide_and_show(tab):
    def names():
        return tab.page.evaluate("document.getElementById('front-chart').layers.map((t) => t.name)")

    assert not tab.page.is_visible("#motors")  # there is no choice
    assert {"front", "dominated", "published", "simulated", "floor", "picks"} <= set(names())
    assert "infeasible" not in names()
    for key in ("cloud", "published", "floor"):
        tab.page.uncheck(f"[data-show={key}]")
    tab.page.check("[data-show=infeasible]")
    assert not {"dominated", "published", "floor"} & set(names())
    assert "infeasible" in names()
    for key in ("cloud", "published", "floor"):
        tab.page.check(f"[data-show={key}]")
    tab.page.uncheck("[data-show=infeasible]")


@pytest.mark.parametrize(
    ("width", "height", "scheme"), [pytest.param(1440, 900, "light", marks=pytest.mark.long), (390, 844, "dark")]
)
def test_nothing_sticks_out_sideways(tab, file, width, height, scheme):
    tab.look(width, height)
    tab.scroll_through()
    tab.look(width, height, scheme)
    # A change of the scheme is heard before the next frame.
    tab.page.evaluate("new Promise((done) => requestAnimationFrame(() => setTimeout(done)))")
    assert tab.page.evaluate("document.documentElement.scrollWidth") == width
    background = tab.page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert background == {"light": "rgb(246, 248, 250)", "dark": "rgb(13, 17, 23)"}[scheme]
    # Canvases are drawn with colours of their own: they follow the scheme, too.
    tints = {"light": ("#0072b2", "#a3487f"), "dark": ("#56b4e9", "#dd8fbb")}[scheme]
    found = "(id) => document.getElementById(id).layers.map((t) => t.line?.color ?? t.marker.color)"
    for chart, tint in (("front-chart", tints[0]), ("convergence", tints[0]), ("map-chart", tints[1])):
        tab.page.locator(f"#{chart}").scroll_into_view_if_needed()
        tab.page.wait_for_function(f"(id) => ({found})(id).includes('{tint}')", arg=chart)
    tab.quiet(file)


def test_charts_have_words_and_controls_have_names(tab):
    tab.scroll_through()
    unnamed = tab.page.evaluate(
        """[...document.querySelectorAll("button, input, select, canvas, [role=img], [role=slider]")].filter((node) =>
            !(node.getAttribute("aria-label") || node.labels?.length || node.textContent.trim())
            && !node.closest("[aria-hidden=true]")).map((node) => node.outerHTML.slice(0, 120))"""
    )
    assert unnamed == []


def test_a_study_named_like_a_script_does_nothing(data, resimulation, folder, open_tab):
    data = cut(data, np.arange(len(data.trials)) < 90)
    nasty = "</title><script>alert(1)</script><img src=x onerror=alert(2)>"
    study = replace(data.study, name=nasty, description=nasty)
    renamed = replace(data, study=study, db=Path(f"{nasty}.db"))
    named = Source(data=renamed, resimulation=replace(resimulation, jumps={}), models={})
    file = written(folder, "nasty.html", [named, named])
    tab = open_tab(file)
    tab.scroll_through()
    tab.page.mouse.move(*tab.point("front", 0))
    tab.page.wait_for_timeout(100)
    assert nasty in tab.text("h1")
    assert tab.page.locator("img[src=x]").count() == 0
    tab.quiet(file)


@pytest.mark.parametrize(
    "kind", ["empty", *(pytest.param(k, marks=pytest.mark.long) for k in ("one", "none feasible", "unfinished"))]
)
def test_studies_that_are_not_much_of_one_give_a_sensible_page(data, resimulation, folder, open_tab, kind):
    feasible = np.flatnonzero(data.trials["state"] == "feasible")
    keep = np.zeros(len(data.trials), dtype=bool)
    keep[{"empty": [], "one": feasible[:1], "none feasible": feasible, "unfinished": np.arange(90)}[kind]] = True
    less = cut(data, keep, state="infeasible" if kind == "none feasible" else None)
    source = Source(data=less, resimulation=replace(resimulation, jumps={}), models={})
    file = written(folder, f"{kind}.html", [source])
    tab = open_tab(file)
    tab.scroll_through()
    tab.page.focus("#front-chart")
    tab.page.keyboard.press("ArrowRight")
    tab.page.fill("#ask-height", "0.7")
    expected = {
        "empty": "No design has been simulated yet",
        "one": "One design is on the front",
        "none feasible": "is feasible: there is no front",
        "unfinished": "Unfinished: 90 of 200",
    }[kind]
    assert expected in tab.text("header")
    tab.quiet(file)


def test_several_studies_lie_over_each_other_and_can_be_switched(seeds, weighted, folder, open_tab):
    file = folder / "several.html"
    content = payload_of([*seeds, weighted], most_jumps=1)
    file.write_text(page(content), encoding="utf-8")
    tab = open_tab(file)
    tab.scroll_through()

    def fronts():
        return tab.page.evaluate(
            "document.getElementById('front-chart').layers.filter((t) => t.name === 'front').length"
        )

    made = json.loads(embedded(content)[1])
    labels = [card["label"] for card in made["studies"]]
    first = made["studies"][0]
    assert f"Trial {first['trials']['trial'][first['picks'][0]['row']]}, {labels[0]}" in tab.text("#subject")
    assert fronts() == 4
    lines = "(id) => document.getElementById(id).layers.map(({ name, x, y, line }) => ({ name, x, y, line }))"
    growth = {line["name"]: line for line in tab.page.evaluate(lines, "convergence")}
    for card in made["studies"]:
        history = card["history"]
        assert [growth[card["label"]][key] for key in "xy"] == [history["evaluations"], history["hypervolume"]]
    tints = tab.page.evaluate(
        "document.getElementById('front-chart').layers.filter((t) => t.name === 'front').map((t) => t.marker.color)"
    )
    assert len(set(tints)) == 4
    assert [growth[label]["line"]["color"] for label in labels] == tints
    (surface,) = made["comparison"]["surfaces"]
    reached = tab.page.evaluate(lines, "attainment")
    for line, key in zip(reached, ("best", "median", "worst"), strict=True):
        assert line["name"].startswith(key)
        assert (line["x"], line["y"]) == (surface[key], surface["first"])
    assert [text.split("<br>")[0] for text in tab.texts("weighted")] == [
        f"weighted search, height weight {weight}" for weight, _ in made["studies"][3]["weighted"]
    ]
    assert tab.page.locator("#attainment .main-svg").count() > 0
    assert tab.page.locator("#search tbody tr").count() == 4
    # Two studies of one name were told apart everywhere but here.
    lines_at_bounds = tab.page.locator("#at-bounds li").all_inner_texts()
    assert {line.split(": ")[0] for line in lines_at_bounds} == set(labels)
    tab.page.uncheck("[data-study='1']")
    assert fronts() == 3
    tab.click_point("weighted", 0)
    tab.expects("#subject", "weighted")
    tab.quiet(file)


def test_an_exported_design_can_be_turned(source, payload, folder, open_tab):
    (card,) = payload.studies
    trial = card.trials.trial[card.picks[0].row]
    box = trimesh.creation.box(extents=(40.0, 80.0, 400.0)).triangles
    file = written(folder, "model.html", [replace(source, models={trial: model_of([(box, (200, 80, 20))], 100)})])
    tab = open_tab(file)
    canvas = tab.page.locator("#viewer canvas")
    canvas.scroll_into_view_if_needed()
    before = canvas.screenshot()
    canvas.focus()
    for _ in range(4):
        tab.page.keyboard.press("ArrowRight")
    assert canvas.screenshot() != before
    # Upright: the bar is much taller than wide in the picture.
    pixels = np.asarray(Image.open(io.BytesIO(canvas.screenshot())).convert("RGB"), dtype=int)
    orange = (pixels[..., 0] - pixels[..., 2]) > 40
    rows, columns = np.flatnonzero(orange.any(axis=1)), np.flatnonzero(orange.any(axis=0))
    assert np.ptp(rows) > 3 * np.ptp(columns) > 0
    tab.page.focus("#front-chart")
    tab.page.keyboard.press("Home")
    assert f"trial {trial}" in tab.text("#viewer")
    tab.quiet(file)


@pytest.mark.long
def test_twenty_thousand_trials_make_a_small_page_whose_chart_a_selection_does_not_redraw(
    data, resimulation, folder, open_tab
):
    big = grown(data, 20_000)
    source = Source(data=big, resimulation=resimulation, models={})
    file = written(folder, "big.html", [source])
    assert file.stat().st_size < 8e6
    tab = open_tab(file)
    tab.scroll_through()
    drawn, redrawn = tab.page.evaluate(
        """async () => {
            const gd = document.getElementById("front-chart"), draw = gd.chart.draw;
            let redrawn = 0;
            gd.chart.draw = () => { redrawn += 1; draw.call(gd.chart); };
            for (const key of ["Home", "ArrowRight", "ArrowRight", "End"]) {
                gd.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
                await new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
            }
            delete gd.chart.draw;
            return [gd.layers.find((t) => t.name === "dominated").x.length, redrawn];
        }"""
    )
    dominated = (big.trials["state"] == "feasible").sum() - len(big.front())
    assert drawn == dominated
    assert redrawn == 0
    assert f"Trial {big.front()['trial'].iloc[-1]}" in tab.text("#subject")
    tab.quiet(file)


def test_a_click_means_the_nearest_mark_and_never_a_dot_beneath_it(tab):
    """A diamond once could not be chosen, and clicks went to a neighbour."""
    tab.to_front()
    found = tab.page.evaluate(
        """() => {
            const gd = document.getElementById("front-chart"), chart = gd.chart;
            const names = ["front", "simulated"], marks = gd.layers.filter((t) => names.includes(t.name));
            const places = (t) => t.x.map((x, i) => chart.at(x, t.y[i]));
            const all = gd.layers.filter((t) => t.stands && !t.cloud).flatMap(places);
            let asked = 0, wrong = [];
            for (const layer of marks) layer.x.forEach((x, i) => {
                const [px, py] = chart.at(x, layer.y[i]);
                const crowd = all.filter(([u, v]) => Math.hypot(u - px, v - py) < 1).length;
                if (crowd > 1) return;
                asked += 1;
                const hit = chart.nearest(px, py);
                if (hit.layer !== layer || hit.i !== i) wrong.push([layer.name, i, hit.layer.name, hit.i]);
            });
            return { asked, wrong };
        }"""
    )
    assert found["asked"] > 10
    assert found["wrong"] == []
