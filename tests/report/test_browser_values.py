"""What the page draws and writes, compared with the payload that it was made from."""

import re
from decimal import ROUND_HALF_UP, Decimal
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

from pareto_monoped.report.card import Source
from pareto_monoped.report.exports import model_of
from pareto_monoped.report.figures import _states_data
from pareto_monoped.report.page import build, page
from tests.report.conftest import Tab, cut, unpacked

pytestmark = pytest.mark.browser

REASON = "the foot slips when it is pushed a little"


@pytest.fixture(scope="module")
def mixed(data, resimulation) -> SimpleNamespace:
    """A study with trials of every kind, whose rows on the page are not their numbers, and models of some of them."""
    front = data.front()["trial"].to_numpy()
    others = data.trials.loc[~data.trials["trial"].isin(front), "trial"].to_numpy()
    less = cut(data, ~data.trials["trial"].isin(others[:5]).to_numpy(), finished=True)
    less.trials.loc[less.trials["trial"].isin(others[5:25]), "state"] = "infeasible"
    ill = int(front[2])
    less.audits.loc[less.audits["trial"] == ill, ["well_conditioned", "reason"]] = [False, REASON]
    off = {"infeasible": int(others[5]), "dominated": int(others[-1]), "ill": ill}
    box = trimesh.creation.box(extents=(40.0, 80.0, 400.0)).triangles
    models = dict.fromkeys(off.values(), model_of([(box, (200, 80, 20))], 100))
    payload = build([Source(data=less, resimulation=resimulation, models=models)])
    return SimpleNamespace(payload=payload, card=payload.studies[0], off=off)


@pytest.fixture(scope="module")
def shared(mixed, folder, browser):
    file = folder / "mixed.html"
    file.write_text(page(mixed.payload), encoding="utf-8")
    tab = Tab(browser)
    tab.show(file)
    tab.scroll_through()
    yield tab
    tab.context.close()


@pytest.fixture
def tab(shared):
    """The page with the lowest jump of the front selected."""
    shared.reset()
    return shared


@pytest.fixture
def shown(mixed):
    """A value as the page shows it."""
    quantities = {q.name: q for q in mixed.payload.quantities}

    def text(name, value):
        q = quantities[name]
        # Exact halves go up in a browser, to the even digit in Python.
        up = Decimal(value * q.scale).quantize(Decimal(1).scaleb(-q.decimals), ROUND_HALF_UP)
        return f"{up} {q.unit}".removesuffix(" 1" if q.unit == "1" else "")

    return text


def traces(tab, name):
    return tab.page.evaluate(
        """(name) => document.getElementById("front-chart").layers.filter((t) => t.name === name)
            .map((t) => ({ x: t.x, y: t.y, text: t.x.map((_, i) => t.text(i)) }))[0]""",
        name,
    )


def rows_of_table(tab, selector):
    """Cells of each row."""
    return [
        [cell.strip() for cell in row]
        for row in tab.page.eval_on_selector_all(
            f"{selector} tbody tr", "(rows) => rows.map((row) => [...row.children].map((cell) => cell.textContent))"
        )
    ]


def go_to(tab, card, at):
    """Select the design at a place on the front."""
    tab.page.focus("#front-chart")
    tab.page.keyboard.press("Home")
    for _ in range(at):
        tab.page.keyboard.press("ArrowRight")
    tab.expects("#subject", f"Trial {card.trials.trial[card.front[at]]}")


def test_energy_lies_to_the_right_and_height_upward(tab, mixed, shown):
    card, columns = mixed.card, mixed.card.trials.columns
    titles = tab.page.evaluate("(({ x, y }) => [x.title, y.title])(document.getElementById('front-chart').chart.given)")
    assert ["energy" in title for title in titles] == [True, False]
    assert ["height" in title for title in titles] == [False, True]
    front = traces(tab, "front")
    assert front["x"] == [columns["energy_j"][row] for row in card.front]
    assert front["y"] == [columns["height_m"][row] for row in card.front]
    for row, text in zip(card.front, front["text"], strict=True):
        values = [shown(name, columns[name][row]) for name in ("height_m", "energy_j")]
        assert f"<b>trial {card.trials.trial[row]}</b><br>{values[0]} on {values[1]}<br>" in text
    published, cases = mixed.payload.published, traces(tab, "simulated")
    assert traces(tab, "published")["x"] == [case["energy_j"] for case in published]
    assert traces(tab, "published")["y"] == [case["height_m"] for case in published]
    dominated = traces(tab, "dominated")
    feasible = {
        (columns["energy_j"][row], columns["height_m"][row])
        for row, letter in enumerate(card.trials.state)
        if letter == "f"
    }
    assert set(zip(dominated["x"], dominated["y"], strict=True)) <= feasible
    named = tab.page.evaluate("document.getElementById('front-chart').chart.labels.map((a) => [a.text, a.x, a.y])")
    places = {(c["name"], c["energy_j"], c["height_m"]) for c in published}
    places |= set(zip([c.name for c in card.cases], cases["x"], cases["y"], strict=True))
    knee = next(pick.row for pick in card.picks if pick.name == "knee")
    assert {tuple(one) for one in named} == places | {("knee", columns["energy_j"][knee], columns["height_m"][knee])}


def test_the_ring_and_the_spoken_text_follow_the_selection(tab, mixed, shown):
    card, columns = mixed.card, mixed.card.trials.columns
    at = len(card.front) // 2
    go_to(tab, card, at)
    box = tab.page.locator("#front-chart .ring").bounding_box()
    centre = (box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    assert centre == pytest.approx(tab.point("front", at), abs=2.0)
    row = card.front[at]
    values = [shown(name, columns[name][row]) for name in ("height_m", "energy_j")]
    spoken = tab.page.get_attribute("#front-chart", "aria-valuetext")
    assert spoken == f"trial {card.trials.trial[row]}, {values[0]} on {values[1]}"


def test_every_value_beside_the_front_is_the_selected_designs(tab, mixed, shown):
    payload, card, columns = mixed.payload, mixed.card, mixed.card.trials.columns
    audited = [at for at, row in enumerate(card.front) if str(card.trials.trial[row]) in card.audits]
    at = audited[-1]
    row, trial = card.front[at], card.trials.trial[card.front[at]]
    assert row != trial
    go_to(tab, card, at)
    names = [variable["name"] for variable in payload.variables]

    shares = tab.page.eval_on_selector_all("#variables u", "(dots) => dots.map((dot) => parseFloat(dot.style.left))")
    bounds = [card.bounds[name] for name in names]
    assert shares == pytest.approx(
        [100 * (columns[name][row] - low) / (high - low) for name, (low, high) in zip(names, bounds, strict=True)],
        abs=0.01,
    )

    labels = {q.label: q.name for q in payload.quantities}
    measures = {labels[label]: text for label, text in rows_of_table(tab, "#measures")}
    packed = {name: unpacked(text)[row] for name, text in card.trials.packed.items()}
    known = {name for name, value in packed.items() if np.isfinite(value)}
    assert len(known) > 20
    assert known <= set(measures)
    for name, text in measures.items():
        assert text == shown(name, packed[name] if name in packed else columns[name][row])

    audit = card.audits[str(trial)]
    assert "Well-conditioned" in tab.text("#audit")
    assert {labels[label]: text for label, text in rows_of_table(tab, "#audit")} == {
        name: shown(name, value) for name, value in audit.items() if name in labels.values()
    }

    hip, knee = (payload.gearboxes[columns[f"{joint}_gearbox"][row]] for joint in ("hip", "knee"))
    gears = {name: cells for name, *cells in rows_of_table(tab, "#gears")}
    assert gears["family"] == [hip.family, knee.family]
    for name, of in {
        "real ratio": lambda g: f"{g.ratio:.3f} : 1",
        "mass with motor": lambda g: f"{g.mass_kg:.3f} kg",
        "peak torque": lambda g: f"{g.peak_torque_n_m:.1f} N m",
        "no-load speed": lambda g: f"{g.no_load_speed_rad_per_s:.1f} rad/s",
        "mesh efficiency": lambda g: f"{100 * g.efficiency:.1f} %",
    }.items():
        assert gears[name] == [of(hip), of(knee)]

    masses = {name: [float(cell.split()[0]) for cell in cells] for name, *cells in rows_of_table(tab, "#mass")}
    total = columns["mass_kg"][row]
    expected = {
        "hip actuator": hip.mass_kg,
        "knee actuator": knee.mass_kg,
        "base frame": card.more["base_kg"][at] - hip.mass_kg,
        "thigh with chain and journal": card.more["thigh_kg"][at] - knee.mass_kg,
        "shank": card.more["shank_kg"][at] - card.foot_mass_kg,
        "foot": card.foot_mass_kg,
        "robot": total,
    }
    assert masses == {name: pytest.approx([kg, 100 * kg / total], abs=0.51) for name, kg in expected.items()}
    assert {name: kg for name, (kg, _) in masses.items()} == pytest.approx(expected, abs=0.00051)

    pick, export, simulate = tab.page.locator("#commands code").all_text_contents()
    assert pick.endswith(f" --trial {trial}")
    assert export.endswith(f" --trial {trial} -o cad/trial_{trial}")
    settings = dict(re.findall(r"--set (\w+)=(\S+)", simulate))
    assert {name: float(value) for name, value in settings.items()} == {name: columns[name][row] for name in names}


def test_drawn_planets_touch_the_sun_and_the_ring(tab):
    drawings = tab.page.eval_on_selector_all(
        "#gears svg",
        """(drawings) => drawings.map((svg) => [...svg.querySelectorAll("circle")].map((c) =>
            ["cx", "cy", "r"].map((name) => Number(c.getAttribute(name))).concat(c.getAttribute("fill"))))""",
    )
    assert len(drawings) == 2
    for circles in drawings:
        (sun,) = (r for *_, r, fill in circles if fill == "var(--c4)")
        ring = next(r for x, y, r, fill in circles if fill == "var(--card)")
        planets = [(np.hypot(x, y), r) for x, y, r, fill in circles if fill == "var(--c0)"]
        assert len(planets) > 1
        for away, r in planets:
            assert [away - r, away + r] == pytest.approx([sun, ring])


def test_a_design_off_the_front_says_why_it_is_there(tab, mixed):
    card = mixed.card
    words = {"infeasible": "breaks a constraint", "dominated": "feasible, but dominated", "ill": "taken off the front"}
    for kind, trial in mixed.off.items():
        go_to(tab, card, 0)
        tab.page.click(f"#viewer button:text-is('trial {trial}')")
        tab.expects("#subject", f"Trial {trial}")
        assert words[kind] in tab.text("#subject")
        row = card.trials.trial.index(trial)
        assert f"{card.trials.columns['mass_kg'][row]:.3f} kg" in tab.text("#mass")
    assert f"Ill-conditioned: {REASON}." in tab.text("#audit")


def affine(pixels, values):
    """The line that takes pixels to values; the test fails if they do not lie on one."""
    slope, start = np.polyfit(pixels, values, 1)
    # Pixels are written to a tenth.
    assert np.abs(slope * np.asarray(pixels) + start - values).max() < 0.2 * abs(slope)
    return slope, start


def knee_jump(tab, mixed):
    """Select the knee of the front; its jump in SI units and its row."""
    card = mixed.card
    row = next(pick.row for pick in card.picks if pick.name == "knee")
    go_to(tab, card, list(card.front).index(row))
    return _states_data(card, row), row


def over_time(tab):
    """Of each chart over time its lines as x and y, and its level lines, as plotly draws them."""
    tab.to_chart("time-charts")
    return tab.page.evaluate(
        """() => {
            const { data, layout } = document.getElementById("time-charts");
            return [0, 1, 2, 3, 4].map((k) => {
                const axis = `y${k ? k + 1 : ""}`, own = (one) => (one.yaxis ?? one.yref) === axis;
                return [data.filter(own).map(({ x, y }) => ({ x, y })), layout.shapes.filter(own).map(({ y0 }) => y0)];
            });
        }"""
    )


def test_the_curves_over_time_are_the_jumps(tab, mixed):
    j, row = knee_jump(tab, mixed)
    columns = mixed.card.trials.columns
    charts = over_time(tab)
    assert f"lift-off at {j['lift_off_s']:.3f} s" in tab.text("#time-legend")
    sides = ("hip", "knee")
    names = [[f"{side}_motor_torque_n_m" for side in sides], [f"{side}_rad_per_s" for side in sides]]
    names += [[f"{side}_rad" for side in sides], ["contact_z_n"], ["base_z_m", "foot_z_m"]]
    for (lines, _), of in zip(charts, names, strict=True):
        *curves, lift = lines
        assert lift["x"] == pytest.approx([j["lift_off_s"]] * 2)
        for curve, name in zip(curves, of, strict=True):
            scale = 180.0 / np.pi if name.endswith("_rad") else 1.0
            assert curve["x"] == pytest.approx(j["time_s"])
            assert curve["y"] == pytest.approx([scale * value for value in j[name]], abs=1e-6)
    peaks = [
        sign * mixed.payload.gearboxes[columns[f"{joint}_gearbox"][row]].peak_torque_n_m
        for joint in sides
        for sign in (1, -1)
    ]
    assert charts[0][1] == pytest.approx(peaks)


@pytest.mark.long
def test_the_picture_shows_the_lift_off_and_the_vertical_line_its_moment(tab, mixed):
    j, _ = knee_jump(tab, mixed)
    end = j["time_s"][-1]
    assert float(tab.page.input_value("#scrub")) == pytest.approx(1000 * j["lift_off_s"] / end, abs=0.51)
    over_time(tab)
    frame = tab.page.locator("#time-charts .subplot.xy .bglayer, #time-charts .draglayer .xy rect").first.bounding_box()
    for share in (0.0, 0.6, 1.0):
        tab.page.fill("#scrub", str(round(1000 * share)))
        cursor = tab.page.locator("#time-charts .cursor").bounding_box()
        at = cursor["x"] + 0.5 * cursor["width"]
        assert (at - frame["x"]) / frame["width"] == pytest.approx(share, abs=0.01)


def test_the_drawn_links_hang_together_and_the_foot_is_where_it_was_simulated(tab, mixed):
    j, row = knee_jump(tab, mixed)
    columns = mixed.card.trials.columns
    thigh_m, shank_m = columns["thigh_length_m"][row], columns["shank_length_m"][row]
    standing = []
    for share in (0.0, 0.25, 0.5, 1.0):
        tab.page.fill("#scrub", str(round(1000 * share)))
        base, thigh, shank, pin = tab.page.evaluate(
            """() => {
                const [base, shank, thigh, , pin] = document.querySelector("#stage svg > g").querySelectorAll(
                    ":scope > path, :scope > g, :scope > circle");
                return [base, thigh, shank, pin].map((part) => {
                    const { a, b, c, d, e, f } = part.transform.baseVal.consolidate().matrix;
                    return [a, b, c, d, e, f];
                });
            }"""
        )

        def down(matrix, length):
            """The point this far down along a part, with z upward."""
            _, _, c, d, e, f = matrix
            return [e + c * length, -(f + d * length)]

        time = share * j["time_s"][-1]
        assert down(base, 0.0) == pytest.approx(
            [np.interp(time, j["time_s"], j[name]) for name in ("base_x_m", "base_z_m")], abs=1e-3
        )
        # The browser keeps coordinates in single precision, 1e-7 of a metre; x may be near 0.
        assert down(thigh, 0.0) == pytest.approx(down(base, 0.0), abs=1e-6)
        assert down(thigh, thigh_m) == pytest.approx(down(pin, 0.0), abs=1e-6)
        assert down(shank, 0.0) == pytest.approx(down(pin, 0.0), abs=1e-6)
        foot = down(shank, shank_m)
        assert foot[1] == pytest.approx(np.interp(time, j["time_s"], j["foot_z_m"]), abs=2e-3)
        if time < j["lift_off_s"]:
            standing.append(foot[0])
    assert len(standing) > 1
    assert np.ptp(standing) < 0.02


def test_the_arcs_of_the_joints_ranges_are_as_long_as_those(tab, mixed):
    """The hip's is more than half a circle, the knee's less."""
    radius_m = 0.085
    (ranges_rad,) = mixed.card.stops_rad.values()
    hip_rad, knee_rad = np.ptp(ranges_rad, axis=1)
    assert hip_rad > np.pi > knee_rad
    arcs_m = tab.page.eval_on_selector_all("#stage .stops path", "(arcs) => arcs.map((arc) => arc.getTotalLength())")
    assert arcs_m == pytest.approx([radius_m * hip_rad, radius_m * knee_rad], rel=1e-3)


def axis_of(tab, name):
    """Ends of an axis of the parallel coordinates, and its ticks: place and number."""
    return tab.page.evaluate(
        """(name) => {
            const group = document.querySelector(`#parallel-chart g[data-axis=${name}]`);
            const line = group.querySelector("line"), number = (node, key) => Number(node.getAttribute(key));
            // Along an axis of another kind what lies evenly is the logarithm, or the inverse hyperbolic sine.
            const { kind, soft } = group.dataset;
            const even = kind === "log" ? Math.log10 : kind === "soft" ? (v) => Math.asinh(v / soft) : (v) => v;
            const ticks = [...group.querySelectorAll("text")]
                .map((t) => [number(t, "y") - 4, even(Number(t.textContent))]);
            const ends = { top: number(line, "y1"), bottom: number(line, "y2") };
            return { kind, soft: Number(soft), x: number(line, "x1"), ...ends, ticks };
        }""",
        name,
    )


def test_the_line_of_the_selection_meets_each_axis_at_its_value(tab, mixed):
    card, columns = mixed.card, mixed.card.trials.columns
    quantities = {q.name: q for q in mixed.payload.quantities}
    at = len(card.front) // 2
    go_to(tab, card, at)
    d = tab.page.get_attribute("#parallel-selected", "d")
    points = [[float(v) for v in point.split()] for point in d[1:].split("L")]
    names = tab.page.eval_on_selector_all("#parallel-chart g.axis", "(all) => all.map((g) => g.dataset.axis)")
    assert len(points) == len(names) == 10
    for name, (x, y) in zip(names, points, strict=True):
        drawn, scale = axis_of(tab, name), quantities[name].scale

        def even(value, drawn=drawn, scale=scale):
            bent = {"log": np.log10, "soft": lambda v: np.arcsinh(v / (scale * drawn["soft"]))}
            return bent.get(drawn["kind"], lambda v: v)(scale * value)

        assert x == pytest.approx(drawn["x"], abs=0.1)
        slope, start = affine(*zip(*drawn["ticks"], strict=True))
        assert slope * y + start == pytest.approx(even(columns[name][card.front[at]]), abs=0.2 * abs(slope))
        if name in card.bounds:
            ends = [slope * drawn[end] + start for end in ("bottom", "top")]
            span = even(card.bounds[name][1]) - even(card.bounds[name][0])
            assert ends == pytest.approx([even(bound) for bound in card.bounds[name]], abs=0.01 * span)
            # Round numbers lie all along the axis.
            covered = np.ptp([y for y, _ in drawn["ticks"]]) / (drawn["bottom"] - drawn["top"])
            assert covered > 0.6
    between = [0.5 * (before + after) for before, after in zip(points[-2], points[-1], strict=True)]
    go_to(tab, card, 0)
    tab.page.locator("#parallel-chart").scroll_into_view_if_needed()
    box = tab.page.locator("#parallel-chart").bounding_box()
    tab.page.mouse.click(box["x"] + between[0], box["y"] + between[1])
    assert tab.page.get_attribute("#parallel-selected", "d") == d
    tab.page.evaluate("window.scrollTo(0, 0)")
    tab.click_point("simulated", 0)
    tab.expects("#subject", "nominal design")
    assert tab.page.get_attribute("#parallel-selected", "d") == ""


def test_typed_ranges_are_in_the_units_of_their_axes_and_include_their_ends(tab, mixed):
    card, columns = mixed.card, mixed.card.trials.columns
    tab.page.evaluate("document.querySelector('#parallel details').open = true")
    # Many designs may have one length, such as a bound.
    lengths = sorted({round(columns["thigh_length_m"][row], 4) for row in card.front})
    low = round(0.5 * sum(lengths[len(lengths) // 2 - 1 :][:2]) * 1000, 2)
    tab.page.fill("[data-range=thigh_length_m-from]", str(low))
    tab.page.keyboard.press("Tab")

    def counts(keep):
        feasible = [row for row, letter in enumerate(card.trials.state) if letter == "f"]
        able = [row for row in feasible if keep(row) and row not in card.ill_conditioned]
        points = {(-columns["height_m"][row], columns["energy_j"][row]) for row in able}
        front = sum(not any(p != q and p[0] <= q[0] and p[1] <= q[1] for p in points) for q in points)
        return f"{front} designs on the front, {sum(map(keep, feasible))} of {len(feasible)} feasible"

    assert counts(lambda row: columns["thigh_length_m"][row] >= low / 1000) in tab.text("#brush-note")
    line = axis_of(tab, "thigh_length_m")
    tab.page.locator("#parallel-chart").scroll_into_view_if_needed()
    box = tab.page.locator("#parallel-chart").bounding_box()
    tab.page.mouse.click(box["x"] + line["x"], box["y"] + 0.5 * (line["top"] + line["bottom"]))
    assert tab.page.input_value("[data-range=thigh_length_m-from]") == ""
    assert "Within" not in tab.text("#brush-note")
    heights = [columns["height_m"][card.front[at]] for at in (3, 8)]
    for side, height in zip(("from", "to"), heights, strict=True):
        tab.page.fill(f"[data-range=height_m-{side}]", repr(height))
        tab.page.keyboard.press("Tab")
    assert counts(lambda row: heights[0] <= columns["height_m"][row] <= heights[1]) in tab.text("#brush-note")
    tab.page.click("#clear-ranges")


def test_points_along_the_front_are_its_designs(tab, mixed):
    payload, card, columns = mixed.payload, mixed.card, mixed.card.trials.columns
    at = len(card.front) // 3
    go_to(tab, card, at)
    tab.to_chart("along-charts")
    cells = tab.page.evaluate("document.getElementById('along-charts').cells")
    rings = tab.page.eval_on_selector_all(
        "#along-charts .ring", "(all) => all.map((one) => [one.style.left, one.style.top])"
    )
    assert len(cells) == len(rings) == len(payload.variables)
    assert tab.page.locator("#along-charts .subplot").count() == len(cells)
    scales = {quantity.name: quantity.scale for quantity in payload.quantities}
    for variable, cell, ring in zip(payload.variables, cells, rings, strict=True):
        name = variable["name"]
        (points,) = cell["series"]
        assert points["x"] == pytest.approx([columns["height_m"][row] for row in card.front])
        assert points["y"] == pytest.approx([scales[name] * columns[name][row] for row in card.front])
        gearbox = columns.get(name.replace("_ratio", "_gearbox")) if name.endswith("_ratio") else None
        external = [gearbox is not None and payload.gearboxes[gearbox[row]].family == "ESSPG" for row in card.front]
        marks = points["mark"] if isinstance(points["mark"], list) else [points["mark"]] * len(card.front)
        assert [mark == "diamond" for mark in marks] == external
        assert all(float(place.removesuffix("px")) > 0 for place in ring)


def test_a_question_is_answered_with_the_designs_that_would_do(tab, mixed):
    card, columns = mixed.card, mixed.card.trials.columns
    front = card.front
    heights = [columns["height_m"][row] for row in front]
    # Not where neighbours are equal to all digits that the page has.
    at = next(k for k in range(7, len(front)) if len(set(heights[k - 3 : k + 2])) == 5)
    tab.page.fill("#ask-height", repr(columns["height_m"][front[at]]))
    tab.expects("#subject", f"Trial {card.trials.trial[front[at]]}")
    assert f" this, {len(front) - at} on the front" in tab.text("#ask-answer")
    tab.page.fill("#ask-height", "")
    tab.page.fill("#ask-energy", repr(columns["energy_j"][front[at - 2]]))
    tab.expects("#subject", f"Trial {card.trials.trial[front[at - 2]]}")
    assert f" this, {at - 1} on the front" in tab.text("#ask-answer")


@pytest.mark.long
def test_the_speed_is_a_share_of_real_time(tab, mixed):
    j, _ = knee_jump(tab, mixed)
    scrubbed = tab.page.evaluate(
        """() => {
            const { requestAnimationFrame: request } = window, now = performance.now;
            let step = null;
            window.requestAnimationFrame = (f) => { step = f; return 0; };
            performance.now = () => 0;
            const play = document.getElementById("play"), scrub = document.getElementById("scrub");
            scrub.value = 0;
            scrub.dispatchEvent(new Event("input"));
            document.getElementById("speed").value = "0.1";
            play.click();
            step(1000);
            play.click();
            window.requestAnimationFrame = request;
            performance.now = now;
            return Number(scrub.value);
        }"""
    )
    assert scrubbed == pytest.approx(1000 * 0.1 / j["time_s"][-1], abs=0.51)


def test_the_gearboxes_and_links_to_choose_from_are_the_maps(tab, mixed):
    (drawn,) = mixed.payload.maps
    chart = """(id) => document.getElementById(id).layers.map(({ name, x, y, marker }) => ({ name, x, y, marker }))"""
    for trace in tab.page.evaluate(chart, "map-chart"):
        family = trace["name"]
        points = [p for p in drawn.points if family in p.family_mass_kg]
        assert trace["x"] == [p.ratio_low for p in points]
        assert trace["y"] == [p.family_mass_kg[family] for p in points]
        lightest = [min(p.family_mass_kg, key=p.family_mass_kg.get) == family for p in points]
        assert [opacity == 1 for opacity in trace["marker"]["opacity"]] == lightest
    thigh, shank, _ = tab.page.evaluate(chart, "link-chart")
    assert (thigh["name"], thigh["y"]) == ("thigh", list(drawn.leg.thigh_kg))
    assert (shank["name"], shank["y"]) == ("shank", list(drawn.leg.shank_kg))
