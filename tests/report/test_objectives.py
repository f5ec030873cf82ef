"""The page of studies with other objectives: axes, words, colours, and two fronts in one chart."""

import re
from dataclasses import replace

import pandas as pd
import pytest

from pareto_monoped.analysis.choices import choices, is_dear
from pareto_monoped.definition.study import open_up
from pareto_monoped.measures import measure
from pareto_monoped.report.card import Source
from pareto_monoped.report.comparison import least_second
from pareto_monoped.report.front_figure import front_figure
from pareto_monoped.report.page import build, page
from pareto_monoped.report.resimulation import resimulate
from pareto_monoped.report.summary import sentences
from pareto_monoped.report.tables import comparison_tables, head
from pareto_monoped.storage.reader import read_study
from tests.report.conftest import made

THREE = ("height_m", "electrical_energy_j", "mass_kg")
BATTERY = ("height_m", "electrical_energy_j")


def source_of(db):
    data = read_study(db)
    return Source(data=data, resimulation=resimulate(data, most_jumps=2), models={})


@pytest.fixture(scope="module")
def three(folder):
    return source_of(made(folder, name="three", objectives=list(THREE), evaluations=120, audit=False))


@pytest.fixture(scope="module")
def battery(folder):
    """The study of the other tests, by the energy at the battery."""
    return source_of(made(folder, objectives=list(BATTERY), evaluations=160, audit=False, algorithm={"name": "random"}))


@pytest.fixture(scope="module")
def two(source, battery):
    """Both fronts; the search may differ as little as the audit, or the two are no pair."""
    settings = {"algorithm": source.data.study.algorithm, "audit": True}
    return [source, replace(battery, data=replace(battery.data, study=replace(battery.data.study, **settings)))]


@pytest.fixture(scope="module")
def opened(source):
    """The first study with more variables free: the same jumps, on a tenth of the energy from the battery."""
    data = source.data
    trials = data.trials.assign(electrical_energy_j=0.1 * data.trials["electrical_energy_j"])
    return replace(source, data=replace(data, study=open_up(data.study), trials=trials))


@pytest.fixture(scope="module")
def three_payload(three):
    return build([three])


@pytest.fixture(scope="module")
def two_payload(two):
    return build(two)


def written(folder, name, payload):
    file = folder / name
    file.write_text(page(payload), encoding="utf-8")
    return file


def chart(tab, what):
    return tab.page.evaluate(f"(() => {{ const gd = document.getElementById('front-chart'); return {what}; }})()")


def test_the_page_has_every_objective_of_every_trial(three_payload, two_payload):
    payload = three_payload
    assert (tuple(payload.objectives), tuple(payload.goals)) == (THREE, THREE)
    (card,) = payload.studies
    for name in THREE:
        assert len(card.trials.columns[name]) == len(card.trials.trial)
    both = two_payload
    assert both.goals == ("height_m", "energy_j", "electrical_energy_j")
    assert [card.label for card in both.studies] == ["small by mechanical energy", "small by battery energy"]
    assert both.title == "small"


def test_its_words_name_the_objectives(three, three_payload):
    text = head(three_payload)
    data = three.data
    front = data.front()
    sentence, standing, _ = sentences(data, front, [])
    assert "standing up" in standing
    for name in THREE:
        entry = measure(name)
        assert f"{entry.label} ({entry.text(front[name].min())} to {entry.text(front[name].max())})" in sentence
    assert sentence in text
    assert "m J kg from 0.55 m, 200 J, 10 kg" in text
    reached = front[front["height_m"] >= 0.8]
    assert f"0.80 m needs at least {reached['electrical_energy_j'].min():.2f} J" in sentence


def test_three_objectives_have_a_chart_with_a_third_as_colour(three, three_payload, folder, open_tab):
    file = written(folder, "three_objectives.html", three_payload)
    tab = open_tab(file)
    front = three.data.front()
    shown = chart(tab, "gd.layers.filter((t) => t.name === 'front').map((t) => [t.x, t.y, t.marker.color, t.mode])")
    ((x, y, tints, mode),) = shown
    for values, name in ((x, "electrical_energy_j"), (y, "height_m"), (tints, "mass_kg")):
        assert values == pytest.approx(front[name].tolist(), rel=1e-4)
    assert mode == "markers"
    titles = "[gd.chart.given.x.title, document.querySelector('#ramp span').textContent]"
    assert chart(tab, titles) == ["energy from the battery, J", "Colour: mass, kg"]
    tab.page.select_option("#across", "mass_kg")
    assert chart(tab, titles) == ["mass, kg", "Colour: energy from the battery, J"]
    swapped = chart(tab, "gd.layers.find((t) => t.name === 'front').x")
    assert swapped == pytest.approx(front["mass_kg"].tolist(), rel=1e-4)
    assert not tab.page.is_visible("[data-show=published]")
    tab.scroll_through()
    # The form asks for the first two objectives.
    tab.page.fill("#ask-height", "0.8")
    best = front[front["height_m"] >= 0.8]
    tab.expects("#ask-answer", f"Trial {best.loc[best['electrical_energy_j'].idxmin(), 'trial']},")
    allowed = round(float(front["electrical_energy_j"].median()), 1)
    tab.page.fill("#ask-height", "")
    tab.page.fill("#ask-energy", str(allowed))
    able = front[front["electrical_energy_j"] <= allowed]
    tab.expects("#ask-answer", f"Trial {able.loc[able['height_m'].idxmax(), 'trial']},")
    assert tab.text("label[for='ask-energy']").startswith("Energy from the battery at most")
    tab.quiet(file)


@pytest.mark.long
def test_two_fronts_lie_in_one_chart_by_either_energy(two, two_payload, folder, open_tab):
    file = written(folder, "two_fronts.html", two_payload)
    tab = open_tab(file)
    modes = "gd.layers.filter((t) => t.name === 'front').map((t) => t.mode)"
    assert chart(tab, modes) == ["lines+markers", "markers"]
    tab.page.select_option("#across", "electrical_energy_j")
    assert chart(tab, modes) == ["markers", "lines+markers"]
    assert chart(tab, "gd.layers.filter((t) => t.name === 'published').length") == 0
    for shown, here in zip(chart(tab, "gd.layers.filter((t) => t.name === 'front').map((t) => t.x)"), two, strict=True):
        assert shown == pytest.approx(here.data.front()["electrical_energy_j"].tolist(), rel=1e-4)
    assert chart(tab, "gd.layers.find((t) => t.name === 'floor') !== undefined")
    tab.scroll_through()
    tab.quiet(file)


@pytest.mark.long
def test_no_page_is_wider_than_its_window(three_payload, two_payload, folder, open_tab):
    for name, payload in (("three_objectives.html", three_payload), ("two_fronts.html", two_payload)):
        tab = open_tab(written(folder, name, payload))
        for width in (1280, 420):
            tab.look(width)
            tab.scroll_through()
            assert tab.page.evaluate("document.documentElement.scrollWidth") <= width


def test_the_steps_of_the_front_can_be_reached(payload, shared):
    """Between two designs the chart shows the height of the lower one: the next is reached at its own energy only."""
    shared.reset()
    assert chart(shared, "gd.layers.find((t) => t.name === 'front').line.shape") == "hv"
    from matplotlib.figure import Figure

    figure = Figure()
    assert front_figure(payload, figure)
    (line,) = [line for line in figure.axes[0].lines if line.get_label() == "small"]
    assert line.get_drawstyle() == "steps-post"


def test_the_table_of_both_energies_says_what_the_first_costs(two, two_payload):
    text = comparison_tables(two_payload).split('id="energies"')[1]
    for row in choices(*(source.data for source in two)):
        assert f"{row.height_m:.1f} m" in text
        if row.cost is not None:
            assert f"{100 * row.cost:+.1f} %" in text
    assert "%" in text
    assert 'id="energies"' not in comparison_tables(build([two[0], two[0]]))


def test_an_opened_study_is_a_front_of_its_own_beside_the_pair(two, opened, two_payload):
    payload = build([*two, opened])
    labels = ["small by mechanical energy", "small by battery energy"]
    assert [card.label for card in payload.studies] == [*labels, "small with more variables free by mechanical energy"]
    assert [list(card.wider) for card in payload.studies] == [[2], [2], []]
    assert payload.title == "small"
    freed = "knee_release_rad 0 to 1, rest_length_m 1 to 20; start_height_m stays 0.5."
    assert [card.summary[-1].endswith(freed) for card in payload.studies] == [False, False, True]
    assert payload.studies[2].summary[-1].startswith("More free than in small: stiffness_n_per_m 0.5 to 200, ")
    # What is dear, and what choosing by mechanical energy costs, is said of the pair alone.
    assert payload.comparison.choices == build(two).comparison.choices != []
    for card, alone in zip(payload.studies, two_payload.studies, strict=False):
        assert card.picks == alone.picks


def test_a_design_is_dear_beside_studies_of_its_own_variables_only(two, opened, folder, open_tab):
    """The page marks those of the front that Python finds, although the opened study takes a tenth from the battery."""
    tab = open_tab(written(folder, "opened.html", build([*two, opened])))
    front, pair = two[0].data.front(), [source.data for source in two]
    dear = front[is_dear(front, pair)]
    assert 0 < len(dear) < len(front)
    texts = chart(tab, "gd.layers.filter((t) => t.name === 'front').flatMap((t) => t.x.map((_, i) => t.text(i)))")
    marked = [text for text in texts if "dear at the battery" in text]
    numbers = {int(re.search(r"trial (\d+)", text)[1]) for text in marked if "small by mechanical energy" in text}
    assert numbers == set(dear["trial"])
    tab.page.evaluate(f"location.hash = '#view=1&at=0:{dear['trial'].iloc[0]}'")
    tab.expects("#subject", "for this height with these variables free")
    tab.page.get_by_role("button", name="Show that").click()
    able = pd.concat([data.sound.assign(study=i) for i, data in enumerate(pair)])
    able = able[able["height_m"] >= dear["height_m"].iloc[0]]
    least = able.iloc[able["electrical_energy_j"].argmin()]
    label = ("mechanical", "battery")[least["study"]]
    tab.expects("#subject", f"Trial {least['trial']}, small by {label} energy")


def test_a_surface_of_two_minimised_objectives_counts_downward():
    import numpy as np

    from pareto_monoped.pareto.objectives import Objectives

    objectives = Objectives(names=("mass_kg", "electrical_energy_j"))
    front = np.array([[3.0, 50.0], [4.0, 20.0]])
    found = least_second(front, np.array([2.5, 3.0, 3.9, 4.0]), objectives)
    assert found.tolist() == [np.inf, 50.0, 50.0, 20.0]


def test_figures_for_print_have_the_objectives_as_axes(three_payload):
    from matplotlib.figure import Figure

    figure = Figure()
    assert front_figure(three_payload, figure)
    assert figure.axes[0].get_xlabel() == "energy from the battery (J)"
    assert figure.axes[0].get_ylabel() == "height (m)"
    assert figure.axes[1].get_ylabel() == "mass (kg)"
