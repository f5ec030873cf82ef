"""The page of a study that chooses from several motors: each design with its own gearboxes, colour and commands."""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.design import NAMES
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.report.card import Source
from pareto_monoped.report.front_figure import front_figure
from pareto_monoped.report.page import build, page
from pareto_monoped.report.resimulation import resimulate
from pareto_monoped.robot.population import robot_arrays
from pareto_monoped.storage.reader import read_study
from tests.lazily import Lazily
from tests.report.conftest import made

mpl = Lazily("matplotlib.figure")

MOTORS = ("U8", "VT8020", "MN8014")
TINTS = 6


@pytest.fixture(scope="module")
def several(folder):
    algorithm = {"name": "random", "population": 30}
    listed = {"gear_list": True, "rules": "iso6336", "motor": list(MOTORS)}
    data = read_study(made(folder, name="any", evaluations=90, audit=False, algorithm=algorithm, **listed))
    assert data.front()["motor"].nunique() > 1
    return Source(data=data, resimulation=resimulate(data, most_jumps=4), models={})


@pytest.fixture(scope="module")
def payload(several):
    return build([several])


def test_every_trial_has_its_own_motor_s_gearboxes(several, payload):
    (card,) = payload.studies
    trials = several.data.trials.set_index("trial")
    assert [table.motor for table in payload.maps] == list(MOTORS)
    for row, trial in enumerate(card.trials.trial):
        stored = trials.loc[trial]
        assert payload.kits[card.trials.columns["motor"][row]].motor == stored["motor"]
        for joint in ("hip", "knee"):
            gearbox = payload.gearboxes[card.trials.columns[f"{joint}_gearbox"][row]]
            assert gearbox.motor == stored["motor"]
            assert gearbox.ratio == pytest.approx(stored[f"{joint}_ratio"], abs=1e-4)


def test_jumps_masses_and_cases_are_those_of_the_motor(several, payload):
    (card,) = payload.studies
    data, front = several.data, several.data.front()
    # The heights of the jumps simulated again are those stored, so each had its own motor.
    assert several.resimulation.drift_m < 1e-9
    assert len(card.jumps.keys) >= 4
    for place, (_, row) in enumerate(front.iterrows()):
        robots = robot_arrays(row[list(NAMES)].to_numpy(float), data.actuator_maps[row["motor"]], data.calibration.mass)
        shown = [card.more[f"{body}_kg"][place] for body in ("base", "thigh", "shank")]
        assert shown == pytest.approx(robots.body_mass_kg[0], abs=1e-4)
    assert card.case_motor == "VT8020"
    case = next(case for case in card.cases if case.name == "C")
    design = next(c["design"] for c in payload.published if c["name"] == "C")
    alone = Evaluator(data.actuator_maps["VT8020"], data.calibration)(np.array([list(design.values())]))
    assert case.height_m == pytest.approx(alone.height_m[0], abs=1e-4)


def test_pairs_of_motors_have_gearboxes_of_either_and_a_leg_of_both(folder):
    listed = {"gear_list": True, "rules": "iso6336", "hip_motor": "VT8020", "knee_motor": ["U8", "MN8014"]}
    algorithm = {"name": "random", "population": 60}
    data = read_study(made(folder, name="pairs", evaluations=60, audit=False, algorithm=algorithm, **listed))
    again = resimulate(data, most_jumps=3)
    assert again.drift_m < 1e-9
    payload = build([Source(data=data, resimulation=again, models={})])
    (card,) = payload.studies
    assert [table.motor for table in payload.maps] == ["VT8020", "U8", "MN8014"]
    assert [(kit.motor, kit.hip, kit.knee) for kit in payload.kits] == [
        ("VT8020 hip, U8 knee", 0, 1),
        ("VT8020 hip, MN8014 knee", 0, 2),
    ]
    assert dict(card.motor_names) == {"0": ("VT8020", "U8"), "1": ("VT8020", "MN8014")}
    trials = data.trials.set_index("trial")
    for row, trial in enumerate(card.trials.trial):
        stored, kit = trials.loc[trial], payload.kits[card.trials.columns["motor"][row]]
        assert kit.motor == stored["motor"]
        for joint in ("hip", "knee"):
            gearbox = payload.gearboxes[card.trials.columns[f"{joint}_gearbox"][row]]
            assert gearbox.motor == stored[f"{joint}_motor"]
            assert gearbox.ratio == pytest.approx(stored[f"{joint}_ratio"], abs=1e-4)
    # The page draws the wider case, and the thigh's plate of the knee's own motor.
    legs = [leg_dimensions(kit) for kit in data.kits]
    for kit, leg in zip(payload.kits, legs, strict=True):
        assert kit.leg.housing_radius_m == pytest.approx(1e-3 * leg.hip.housing_radius_mm)
        assert kit.leg.thigh_hip_radius_m == pytest.approx(1e-3 * leg.knee.rim_radius_mm)
    assert set(data.front()["motor"]) <= words_of_the_front(payload)


def test_a_study_with_one_motor_has_no_column_of_motors(source):
    (card,) = build([source]).studies
    assert "motor" not in card.trials.columns
    assert (card.motor, card.case_motor, dict(card.motor_names)) == (
        "VT8020",
        "VT8020",
        {"0": ("VT8020", "VT8020")},
    )


def test_studies_share_maps_of_equal_motors_and_rules(several, source):
    twice = build([several, several])
    assert [table.motor for table in twice.maps] == list(MOTORS)
    assert dict(twice.studies[1].motor_names) == {str(k): (motor, motor) for k, motor in enumerate(MOTORS)}
    # The other study has its gearboxes by other rules, so a map of its own.
    other = build([source, several])
    assert [table.motor for table in other.maps] == ["VT8020", *MOTORS]
    assert set(other.studies[1].motor_names) == {"1", "2", "3"}
    assert (other.studies[0].kit, other.studies[1].kit) == (0, 2)


def words_of_the_front(payload):
    """What the legends of the figure for print say."""
    figure = mpl.Figure()
    assert front_figure(payload, figure)
    legends = [*figure.legends, *(axes.get_legend() for axes in figure.axes if axes.get_legend())]
    return {text.get_text() for legend in legends for text in legend.get_texts()}


def test_the_figure_for_print_names_the_motors(several, payload):
    assert set(several.data.front()["motor"]) <= words_of_the_front(payload)


@pytest.mark.browser
def test_the_page_shows_colours_and_filters_motors(several, payload, folder, open_tab):
    file = folder / "motors.html"
    file.write_text(page(payload), encoding="utf-8")
    tab, front = open_tab(file), several.data.front()

    def marker(name):
        return tab.page.evaluate(
            f"document.getElementById('front-chart').layers.find((t) => t.name === 'front').marker.{name}"
        )

    order = [MOTORS.index(motor) for motor in front["motor"]]
    tints = [
        tab.page.evaluate(f"getComputedStyle(document.documentElement).getPropertyValue('--c{k}').trim()")
        for k in range(3)
    ]
    assert marker("color") == [tints[k] for k in order]
    assert marker("symbol") == [["circle", "square", "diamond"][k] for k in order]
    hovers = tab.texts("front")
    assert all(text.endswith(f"motor {motor}") for text, motor in zip(hovers, front["motor"], strict=True))
    # The selected design: its motor in words, in the table of its gearboxes, and in its commands.
    tab.page.focus("#front-chart")
    tab.page.keyboard.press("Home")
    for place, motor in enumerate(front["motor"]):
        if place:
            tab.page.keyboard.press("ArrowRight")
        assert tab.text("#subject span").startswith(f"{motor}; ")
        assert f"motor\t{motor}\t{motor}" in tab.text("#gears table")
        assert f"--motor {motor} " in tab.text("#commands")
    # Without a motor its designs are faint on the front, and gone from the count beside the parallel axes.
    left = front["motor"].iloc[0]
    number = MOTORS.index(left)
    tab.page.uncheck(f"[data-motor='{number}']")
    assert marker("opacity") == [0.15 if motor == left else 1 for motor in front["motor"]]
    tab.expects("#brush-note", " designs on the front, ")
    tab.page.click("#clear-ranges")
    tab.to_front()
    assert tab.page.is_checked(f"[data-motor='{number}']")
    assert marker("opacity") == [1] * len(front)
    tab.scroll_through()
    tab.quiet(file)


@pytest.mark.long
@pytest.mark.browser
def test_three_objectives_keep_the_colour_and_leave_the_mark_to_the_motor(several, folder, open_tab):
    objectives = replace(several.data.study.objectives, names=("height_m", "energy_j", "mass_kg"))
    corner = replace(several.data.study.reference_point, objectives=objectives, values=(0.55, 100.0, 10.0))
    data = replace(several.data, study=replace(several.data.study, objectives=objectives, reference_point=corner))
    file = folder / "three_motors.html"
    file.write_text(page(build([replace(several, data=data)])), encoding="utf-8")
    tab = open_tab(file)
    shown = "document.getElementById('front-chart').layers.find((t) => t.name === 'front').marker"
    front = data.front()
    assert tab.page.evaluate(f"{shown}.color") == pytest.approx(front["mass_kg"].tolist(), rel=1e-4)
    marks = [["circle", "square", "diamond"][MOTORS.index(motor)] for motor in front["motor"]]
    assert tab.page.evaluate(f"{shown}.symbol") == marks
