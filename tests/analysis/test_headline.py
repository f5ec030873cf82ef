from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from pareto_monoped.actuator.ratiomap import joint_maps
from pareto_monoped.actuator.search import map_for
from pareto_monoped.analysis.choices import headline
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.measures import MEASURE_NAMES
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY


@pytest.fixture(scope="module")
def simulated():
    """Case C as the study below simulates it."""
    jump = Evaluator(map_for("U8"), load_calibration("ideal"))(PAPER_CASES["C"].design.as_array())
    return {name: float(jump.of(name)[0]) for name in MEASURE_NAMES}


def study(*front, motors=("U8",)):
    """A study with this front of trial, height and energy, all with the last motor.

    Each rises by a third of its height, and half of that above standing; of trial 9 that is not known.
    """
    table = pd.DataFrame(front, columns=["trial", "height_m", "energy_j"]).assign(motor=motors[-1])
    table["rise_m"] = (table["height_m"] / 3.0).where(table["trial"] != 9)
    table["above_standing_m"] = table["rise_m"] / 2.0
    return SimpleNamespace(
        front=lambda: table[table["trial"] != 1],
        sound=table,
        study=SimpleNamespace(objectives=HEIGHT_AND_ENERGY, kits=[(name, name) for name in motors]),
        case_kit=joint_maps(map_for("U8")),
        calibration=load_calibration("ideal"),
    )


def test_the_papers_design_stands_beside_the_fronts(simulated):
    height = simulated["height_m"]
    rows = headline(study((7, 0.7, 10.0), (5, 0.85, 20.0), (3, height + 0.01, 30.0), (9, height + 0.1, 50.0)), 7)
    assert [(row.label, row.height_m, row.energy_j) for row in rows] == [
        ("paper's Case C, as published", 0.8, 15.36),
        ("paper's Case C, simulated here", height, simulated["energy_j"]),
        ("front: at least that height, trial 3", height + 0.01, 30.0),
        ("exported, trial 7", 0.7, 10.0),
    ]
    rises = [(row.rise_m, row.above_standing_m) for row in rows]
    assert np.isnan(rises[0]).all()
    assert rises[1] == (simulated["rise_m"], simulated["above_standing_m"])
    assert rises[3] == (0.7 / 3.0, 0.7 / 6.0)


def test_the_chosen_design_may_be_behind_the_front(simulated):
    """The main job crashed: the knee of the designs that are not dear was not on the front."""
    rows = headline(study((7, 0.7, 10.0), (1, 0.6, 11.0)), 1)
    assert [(row.label, row.height_m) for row in rows[2:]] == [("exported, trial 1", 0.6)]


def test_a_study_without_rises_has_the_same_lines(simulated):
    rows = headline(study((7, 0.7, 10.0), (9, simulated["height_m"] + 0.1, 50.0)), 7)
    assert [row.label for row in rows[2:]] == ["front: at least that height, trial 9", "exported, trial 7"]
    assert np.isnan(rows[2].rise_m)


def test_a_front_below_the_papers_height_has_no_design_for_it():
    labels = [row.label for row in headline(study((7, 0.7, 10.0)), 7)]
    assert labels[2:] == ["exported, trial 7"]


def test_with_several_motors_every_design_names_its_own(simulated):
    labels = [row.label for row in headline(study((7, 0.7, 10.0), motors=("U8", "U10")), 7)]
    assert labels == [
        "paper's Case C, as published",
        "paper's Case C, simulated here with U8",
        "exported, trial 7, U10",
    ]
