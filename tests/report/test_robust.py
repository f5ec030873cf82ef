"""Designs under uncertainty and alternatives on the page: as stored, and as the page's scripts read them."""

from dataclasses import replace
from importlib import resources

import numpy as np
import pytest

from pareto_monoped.analysis import limit
from pareto_monoped.analysis.alternatives import alternatives
from pareto_monoped.analysis.robustness import robust, robust_front, robust_trials
from pareto_monoped.analysis.sensitivity import sensitivity
from pareto_monoped.measures import ROBUST_NAMES
from pareto_monoped.report.card import Source
from pareto_monoped.report.page import build, embedded, page
from pareto_monoped.report.robust import best_of, robust_of
from pareto_monoped.storage.extra_rows import read_limits, read_robustness, read_sensitivity
from pareto_monoped.storage.reader import read_study
from pareto_monoped.uncertainty.settings import load_uncertainty
from tests.report.conftest import grown, made, unpacked

ASSETS = resources.files("pareto_monoped") / "report" / "assets"


@pytest.fixture(scope="module")
def stored(folder, few_samples):
    """A study of its own: the database of the others stays as it is."""
    db = made(folder, seed=11, evaluations=60)
    robust(db, load_uncertainty(), trials=read_study(db).front()["trial"].tolist()[:4], samples=32, workers=2)
    return read_robustness(db)


@pytest.fixture(scope="module")
def searched(folder, stored):
    """Limits of the same designs, after few jumps."""
    db = folder / "surrogate_11_60.db"
    with pytest.MonkeyPatch.context() as patch:  # few robots as built, of which the page tells nothing
        patch.setattr(limit, "sampling", lambda *_: (load_uncertainty(), 16, 1))
        limit.limits(db, read_study(db).front().iloc[:4], jumps=60, workers=2)
    return read_limits(db)


@pytest.fixture(scope="module")
def uncertain(folder, stored, searched, resimulation):
    data = read_study(folder / "surrogate_11_60.db")
    return Source(data=data, resimulation=resimulation, models={}, robustness=stored, limits=searched)


@pytest.fixture(scope="module")
def shown(uncertain):
    return build([uncertain])


def test_the_page_has_what_is_stored(shown, uncertain, stored):
    card = shown.studies[0]
    assert [card.trials.trial[row] for row in card.robust.rows] == sorted(stored)
    assert (card.robust.ranges, card.robust.samples, card.robust.others) == ("default", 32, 0)
    known = [stored[trial].result for trial in sorted(stored)]
    for name in ("height_m.p05", "energy_j.p95", "mass_kg.mean"):
        base, _, statistic = name.partition(".")
        expected = [getattr(result.measures[base], statistic) for result in known]
        assert unpacked(card.robust.packed[name]) == pytest.approx(expected, rel=1e-6)
    assert unpacked(card.robust.packed["failed_share"]) == pytest.approx([result.failed for result in known])
    front = robust_front(uncertain.data, robust_trials(uncertain.data, stored))["trial"].tolist()
    assert [card.trials.trial[row] for row in card.robust.front] == front
    assert {q.name for q in shown.quantities} >= set(card.robust.packed)


@pytest.mark.parametrize("strength", [True, False])
def test_the_page_has_the_front_of_the_best_torque(strength, uncertain, searched):
    """Of jumps that overload no part, if the study asks for them: no other, nor a design, is as high on as little."""
    data = replace(uncertain.data, study=replace(uncertain.data.study, strength=strength))
    first, known = next(iter(searched.items()))
    searched = searched | {first: replace(known, result=replace(known.result, controller_gap_held=None))}
    best = best_of(data, searched, {trial: trial for trial in searched})
    end = "_held" if strength else ""
    assert (best.energy, best.held) == ("energy_j", strength)
    found = {trial: stored.result for trial, stored in searched.items()}
    for trial, gap in zip(best.rows, best.gap, strict=True):
        expected = getattr(found[trial], f"controller_gap{end}")
        assert gap == (expected if expected is None else pytest.approx(expected, rel=1e-3))
    jumps = [(trial, getattr(one, f"{name}{end}")) for trial, one in found.items() for name in ("least", "greatest")]
    every = {(trial, jump.height_m, jump.energy_j) for trial, jump in jumps if jump is not None}
    own = {(-1, row.height_m, row.energy_j) for row in data.sound.itertuples()}
    front = [a for a in every if not any(b[1] >= a[1] and b[2] <= a[2] and b != a for b in every | own)]
    assert best.front == [pytest.approx(one, rel=1e-4) for one in sorted(front, key=lambda one: one[1])]
    assert 1 < len(front) < len(every)


def test_a_study_without_robustness_has_none(payload):
    assert payload.studies[0].robust is None
    assert payload.studies[0].best is None
    assert not {q.name for q in payload.quantities} & set(ROBUST_NAMES)


def test_designs_that_the_page_has_not_are_left_out(uncertain, stored):
    some = replace(uncertain, data=replace(uncertain.data, trials=uncertain.data.trials.iloc[:5]))
    card = build([some]).studies[0]
    there = [trial for trial in sorted(stored) if trial < 5]
    assert [card.trials.trial[row] for row in card.robust.rows] == there


def test_each_pick_has_its_alternatives(data, resimulation):
    many = grown(data, 600)
    card, found = build([Source(data=many, resimulation=resimulation, models={})]).studies[0], 0
    for picked in card.picks:
        expected = alternatives(many, card.trials.trial[picked.row])
        assert [card.trials.trial[one.row] for one in picked.alternatives] == [one.trial for one in expected]
        assert [one.text for one in picked.alternatives] == [one.text() for one in expected]
        assert [one.price for one in picked.alternatives] == pytest.approx([one.price for one in expected], abs=1e-5)
        found += len(expected)
    assert found > 0


def test_studies_with_other_objectives_share_a_page(uncertain, source):
    """An objective under uncertainty is of one study only; the other one's trials have no value of it."""
    study = replace(uncertain.data.study, name="other")
    data = replace(
        uncertain.data,
        study=replace(study, objectives=replace(study.objectives, names=("height_m.p05", "energy_j"))),
        trials=uncertain.data.trials.assign(**{"height_m.p05": 0.98 * uncertain.data.trials["height_m"]}),
    )
    first, second = build([source, replace(uncertain, data=data)]).studies
    assert all(value is None for value in first.trials.columns["height_m.p05"])
    jumped = data.trials["height_m"].notna().to_numpy()
    values = np.array(second.trials.columns["height_m.p05"], dtype=float)
    assert values[jumped] == pytest.approx(data.trials["height_m.p05"][jumped], rel=1e-4)


def test_the_page_has_the_stored_sensitivities(data, resimulation, folder):
    db = folder / "surrogate_11_60.db"
    trial = int(read_study(db).front()["trial"].iloc[0])
    found = sensitivity(db, trial, load_uncertainty(), blocks=32, workers=2)
    own = Source(data=read_study(db), resimulation=resimulation, models={}, sensitivities=read_sensitivity(db))
    card = build([own]).studies[0]
    assert list(card.sensitivity) == [str(trial)]
    for one in found:
        shown = card.sensitivity[str(trial)][one.about]
        assert shown.jumps == one.jumps
        assert [factor[:2] for factor in shown.factors] == [(f.factor.label, f.factor.text) for f in one.factors]
        for name, rows in shown.measures.items():
            expected = [(f.measures[name].change, f.measures[name].total, f.measures[name].error) for f in one.factors]
            assert np.array(rows, dtype=float) == pytest.approx(np.array(expected), rel=1e-3, abs=1e-12)


@pytest.mark.browser
def test_the_scripts_read_the_same_numbers(shown, stored, browser):
    tab = browser.new_page()
    numbers, text = embedded(shown)
    try:
        column, single, names = tab.evaluate(
            """([script, numbers, text]) => {
                const page = JSON.parse(text), content = Uint8Array.from(numbers).buffer;
                const once = (map, key, find) => map.get(key) ?? map.set(key, find()).get(key);
                const parts = `${script}; return { columnOf, valueAt, knownNames };`;
                const found = new Function("page", "content", "once", parts)(page, content, once);
                const single = page.studies[0].trials.trial.map((_, row) => found.valueAt(0, "height_m.p05", row));
                return [[...found.columnOf(0, "height_m.p05")], single, found.knownNames()];
            }""",
            [(ASSETS / "data.js").read_text(encoding="utf-8"), list(numbers), text],
        )
    finally:
        tab.close()
    for row, trial in enumerate(shown.studies[0].trials.trial):
        if trial in stored:
            expected = stored[trial].result.measures["height_m"].p05
            assert (column[row], single[row]) == pytest.approx((expected, expected), rel=1e-6)
        else:
            assert np.isnan(column[row])
            assert single[row] is None
    assert "electrical_energy_j.p95" in names


@pytest.mark.long
@pytest.mark.browser
def test_the_page_tells_numerical_and_physical_tests_apart(shown, stored, searched, folder, open_tab):
    file = folder / "robust.html"
    file.write_text(page(shown), encoding="utf-8")
    tab = open_tab(file)
    tab.scroll_through()
    card = shown.studies[0]
    for row in (card.robust.rows[0], next(row for row in card.front if row not in card.robust.rows)):
        at = card.front.index(row)
        tab.reset()
        for _ in range(at):
            tab.page.keyboard.press("ArrowRight")
        trial = card.trials.trial[row]
        tab.expects("#subject", f"Trial {trial}")
        if trial in stored:
            known = stored[trial].result
            low, high = (getattr(known.measures["height_m"], end) for end in ("p05", "p95"))
            tab.expects(
                "#audit", f"Tested as built in 32 jumps, nine of ten robots: height {low:.3f} m to {high:.3f} m"
            )
            tab.expects("#audit", f"{100 * known.failed:.1f} % of the jumps fail")
            tab.expects("#audit", f"{100 * known.overloaded:.1f} % overload a part")
        else:
            tab.expects("#audit", f"Not tested as built: pareto-monoped robust DB --trial {trial}")
        tab.expects("#audit", "neither rounding nor the time step")
        if trial in searched:
            tab.expects("#audit", f"takes {searched[trial].result.controller_gap:.1f} % less of mechanical energy")
    found = "document.getElementById('front-chart').layers.find((t) => t.name === 'best')"
    assert tab.page.evaluate(f"{found}.x") == pytest.approx([energy for _, _, energy in card.best.front])
    assert tab.page.evaluate(f"{found}.y") == pytest.approx([height for _, height, _ in card.best.front])
    tab.page.locator("[data-show=best]").click()
    assert tab.page.evaluate(f"{found} === undefined")
    tab.quiet(file)


def test_the_page_tells_designs_that_fail_often_from_those_with_other_settings(uncertain, stored):
    first, second, third, fourth = sorted(stored)
    often = {
        trial: replace(stored[trial], result=replace(stored[trial].result, failed=0.9)) for trial in (first, third)
    }
    again = {fourth: replace(stored[fourth], settings=dict(stored[fourth].settings) | {"seed": 99})}
    found = robust_of(uncertain.data, stored | often | again, {trial: trial for trial in stored})
    assert (found.fragile, found.others) == (2, 1)
    assert found.rows == [second]
