"""The front chart's axes, colours and sizes by choice, its 3D view, and what it shows of designs under uncertainty."""

from types import SimpleNamespace

import numpy as np
import pytest

from pareto_monoped.report.card import Source
from pareto_monoped.report.packing import unpacked_column
from pareto_monoped.report.page import build, page
from pareto_monoped.storage.extra_rows import Stored
from pareto_monoped.uncertainty.statistics import Robustness, Spread

pytestmark = pytest.mark.browser


@pytest.fixture
def tab(shared):
    shared.reset()
    shared.to_front()
    return shared


def layer(tab, name):
    return tab.page.evaluate(
        """(name) => {
            const gd = document.getElementById("front-chart"), t = gd.layers.find((t) => t.name === name);
            return t && { x: t.x, y: t.y, color: t.marker?.color, size: t.marker?.size, ramp: t.marker?.ramp,
                ends: t.ends, px: [...t.px], py: [...t.py] };
        }""",
        name,
    )


def test_any_measure_can_be_an_axis_a_colour_and_a_size_of_all_trials(tab, data, payload):
    (card,) = payload.studies
    chosen = {
        "across": "electrical_energy_j",
        "upward": "mass_kg",
        "colour": "peak_foot_force_n",
        "size": "thigh_length_m",
    }
    for box, name in chosen.items():
        tab.page.select_option(f"#{box}", name)
    scale = {q.name: q.scale for q in payload.quantities}
    stored = data.trials.set_index("trial")
    front = stored.loc[[card.trials.trial[row] for row in card.front]]
    found = layer(tab, "front")
    for key, name in (("x", "electrical_energy_j"), ("y", "mass_kg"), ("color", "peak_foot_force_n")):
        assert found[key] == pytest.approx((scale[name] * front[name]).tolist(), rel=6e-5)
    assert found["ramp"] == pytest.approx([min(found["color"]), max(found["color"])])
    lengths = front["thigh_length_m"].to_numpy()
    sizes = np.array(found["size"])
    assert sizes[lengths.argmax()] == sizes.max() > 2.5 * sizes[lengths.argmin()]
    dominated = layer(tab, "dominated")
    stored_energies = set(np.round(unpacked_column(card.trials.packed["electrical_energy_j"]).astype(float), 2))
    feasible = stored[stored["state"] == "feasible"]
    assert len(dominated["x"]) == len(feasible) - len(front)
    assert set(np.round(dominated["x"], 2)) <= stored_energies
    ramp = tab.text("#ramp")
    assert "Colour: peak foot force, N" in ramp
    assert "Size: thigh length, mm" in ramp


def test_a_logarithmic_axis_places_points_by_their_logarithm(tab):
    tab.page.check("#log-x")
    found = layer(tab, "front")
    assert np.ptp(found["x"]) > 0
    fit = np.polyfit(np.log10(found["x"]), found["px"], 1)
    assert np.polyval(fit, np.log10(found["x"])) == pytest.approx(found["px"], abs=0.05)
    tab.page.uncheck("#log-x")
    found = layer(tab, "front")
    fit = np.polyfit(found["x"], found["px"], 1)
    assert np.polyval(fit, found["x"]) == pytest.approx(found["px"], abs=0.05)


def test_a_measure_over_decades_gets_a_logarithmic_axis_by_itself(tab, payload):
    (card,) = payload.studies
    ratios = {}
    for name, text in card.trials.packed.items():
        values = unpacked_column(text)[list(card.front)]
        if np.isfinite(values).all() and values.min() > 0 and np.ptp(values) > 0:
            ratios[name] = float(np.quantile(values, 0.95) / np.quantile(values, 0.05))
    calm = min(ratios, key=ratios.get)
    assert ratios[calm] < 20
    tab.page.select_option("#across", calm)
    assert not tab.page.is_checked("#log-x")
    # All that span decades, and a few of those that do not: each costs a drawing.
    asked = [name for name, ratio in ratios.items() if ratio > 25]
    asked += sorted((name for name, ratio in ratios.items() if ratio < 7.5), key=ratios.get)[-5:]
    many = tab.page.evaluate(
        """(asked) => {
            const select = document.getElementById("across");
            return [...select.options].map((o) => o.value).filter((name) => asked.includes(name)).filter((name) => {
                select.value = name;
                select.dispatchEvent(new Event("change"));
                return document.getElementById("log-x").checked;
            });
        }""",
        asked,
    )
    known = {name for name, ratio in ratios.items() if ratio > 25}
    assert known <= set(many)
    assert not {name for name, ratio in ratios.items() if ratio < 15 and name in many and ratio * 2 < 15}


@pytest.mark.long
def test_three_measures_have_a_view_in_space_that_turns(tab, payload):
    (card,) = payload.studies
    tab.page.select_option("#colour", "mass_kg")
    tab.page.check("#space")
    first = layer(tab, "front")
    box = tab.page.evaluate("(({ box }) => box)(document.getElementById('front-chart').chart)")
    assert np.isfinite(first["px"]).all()
    assert min(first["px"]) > 0
    assert max(first["px"]) < box["all"][0]
    tab.page.fill("#turn", "40")
    second = layer(tab, "front")
    assert np.abs(np.subtract(first["px"], second["px"])).max() > 20
    # A turn is about the upright axis: seen from the side, at no tilt, heights stay.
    tab.page.evaluate("() => { const c = document.getElementById('front-chart').chart; c.tilt = 0; c.turnTo(-60); }")
    level = layer(tab, "front")
    tab.page.evaluate("() => document.getElementById('front-chart').chart.turnTo(60)")
    assert layer(tab, "front")["py"] == pytest.approx(level["py"], abs=1e-3)
    at = len(card.front) - 1
    tab.page.focus("#front-chart")
    tab.page.keyboard.press("End")
    ring = tab.page.locator("#front-chart .ring").bounding_box()
    now, chart = layer(tab, "front"), tab.page.locator("#front-chart").bounding_box()
    assert ring["x"] + 0.5 * ring["width"] == pytest.approx(chart["x"] + now["px"][at], abs=2)
    assert ring["y"] + 0.5 * ring["height"] == pytest.approx(chart["y"] + now["py"][at], abs=2)


def test_a_frame_drawn_with_the_mouse_zooms_and_a_double_click_shows_the_whole(tab):
    x, y = tab.point("front", 0)
    ranges = "(({ x, y }) => [x.range, y.range])(document.getElementById('front-chart').chart)"
    whole = tab.page.evaluate(ranges)
    tab.page.mouse.move(x - 40, y - 60)
    tab.page.mouse.down()
    tab.page.mouse.move(x + 10, y, steps=3)
    tab.page.mouse.move(x + 60, y + 20, steps=3)
    tab.page.mouse.up()
    near = tab.page.evaluate(ranges)
    assert near[0][1] - near[0][0] < 0.5 * (whole[0][1] - whole[0][0])
    px, py = tab.point("front", 0)
    assert tab.page.evaluate("([x, y]) => document.elementFromPoint(x, y).closest('#front-chart') !== null", [px, py])
    tab.page.mouse.dblclick(px + 200, py - 150)
    assert tab.page.evaluate(ranges) == whole


def test_hovering_tells_of_the_design_under_the_pointer(tab, payload):
    (card,) = payload.studies
    at = len(card.front) // 2
    tab.page.mouse.move(*tab.point("front", at))
    words = tab.text("#front-chart .tip")
    crowd = {card.trials.trial[row] for row in card.front}
    assert int(words.split()[1]) in crowd


@pytest.fixture(scope="module")
def robust(source, folder):
    """Some designs of the front under uncertainty, with spreads that are easy to know again."""
    front = source.data.front()
    chosen = front.iloc[:: max(len(front) // 8, 1)]
    stored = {}
    for at, (_, row) in enumerate(chosen.iterrows()):
        spread = {
            name: Spread(mean=row[name], deviation=0.1, p05=row[name] * (0.9 - 0.01 * at), p95=row[name] * 1.1)
            for name in ("height_m", "energy_j")
        }
        result = Robustness(samples=256, failed=0.0, overloaded=0.02 * at, measures=spread)
        stored[int(row["trial"])] = Stored(settings={"samples": 256, "seed": 0}, result=result)
    payload = build([Source(data=source.data, resimulation=source.resimulation, models={}, robustness=stored)])
    made = folder / "robust.html"
    made.write_text(page(payload), encoding="utf-8")
    return SimpleNamespace(file=made, stored=stored, card=payload.studies[0])


def test_designs_under_uncertainty_have_bars_and_a_front_of_their_bad_ends(robust, open_tab):
    tab = open_tab(robust.file)
    bars = layer(tab, "spread")
    card = robust.card
    trials = [card.trials.trial[row] for row in card.robust.rows]
    assert len(trials) > 3
    for ends, trial in zip(bars["ends"], trials, strict=True):
        measures = robust.stored[trial].result.measures
        expected = [getattr(measures[name], end) for name in ("energy_j", "height_m") for end in ("p05", "p95")]
        assert ends == pytest.approx(expected, rel=3e-5)
    front = layer(tab, "robust")
    bad = {
        t: (one.result.measures["height_m"].p05, one.result.measures["energy_j"].p95)
        for t, one in robust.stored.items()
    }
    best = {
        t: (h, e)
        for t, (h, e) in bad.items()
        if not any(u >= h and v <= e and (u, v) != (h, e) for u, v in bad.values())
    }
    assert sorted(zip(front["y"], front["x"], strict=True)) == [
        pytest.approx(one, rel=3e-5) for one in sorted(best.values())
    ]
    for key, name in (("spread", "spread"), ("robust", "robust")):
        tab.page.uncheck(f"[data-show={key}]")
        assert layer(tab, name) is None
    tab.page.select_option("#colour", "overloaded_share")
    assert "overload" in tab.text("#ramp")
    tab.quiet(robust.file)


def test_a_picture_holds_the_marks_and_names_that_lie_over_the_lines(tab):
    tab.to_front()
    made = tab.page.evaluate(
        """async () => {
            const kept = Plotly.downloadImage, box = document.getElementById("front-chart").parentElement;
            let made = null;
            Plotly.downloadImage = ({ layout }) => { made = layout; };
            box.querySelector('[data-title="Picture as PNG"]').click();
            Plotly.downloadImage = kept;
            const painted = async ({ source }) => {
                const image = new Image(), canvas = document.createElement("canvas");
                image.src = source;
                await image.decode();
                Object.assign(canvas, { width: image.width, height: image.height });
                const context = canvas.getContext("2d");
                context.drawImage(image, 0, 0);
                const { data } = context.getImageData(0, 0, image.width, image.height);
                return data.filter((value, i) => i % 4 === 3 && value > 0).length;
            };
            const images = await Promise.all(made.images.map(painted));
            const names = made.annotations.map(({ text }) => text);
            return { layers: made.images.map(({ layer }) => layer), images, names };
        }"""
    )
    assert made["layers"] == ["below", "above"]
    assert (
        made["images"][0] > 100
    )  # a cloud of dominated designs; so few designs are on the front that they are no crowd
    shown = tab.page.eval_on_selector_all("#front-chart .name", "(all) => all.map((one) => one.textContent)")
    assert "knee" in shown
    assert made["names"] == shown


def test_marks_and_names_go_along_while_the_chart_is_moved(tab):
    tab.to_front()
    tab.page.click('.framed:has(#front-chart) [data-title="Pan"]')
    box = tab.page.locator("#front-chart .sheet.below").bounding_box()
    middle = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    before = tab.page.locator("#front-chart .name").first.bounding_box()
    tab.page.mouse.move(*middle)
    tab.page.mouse.down()
    tab.page.mouse.move(middle[0] + 40, middle[1] + 25, steps=4)
    tab.page.wait_for_timeout(100)
    names = tab.page.locator("#front-chart .name").first.bounding_box()
    clouds = tab.page.locator("#front-chart .sheet.below canvas").bounding_box()
    tab.page.mouse.up()
    assert (names["x"] - before["x"], names["y"] - before["y"]) == pytest.approx((40, 25), abs=1.5)
    assert (clouds["x"] - box["x"], clouds["y"] - box["y"]) == pytest.approx((40, 25), abs=1.5)
    # At rest all of it is painted anew, where it then belongs.
    tab.page.wait_for_timeout(400)
    clouds = tab.page.locator("#front-chart .sheet.below canvas").bounding_box()
    assert (clouds["x"], clouds["y"]) == pytest.approx((box["x"], box["y"]), abs=0.5)
