from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.pareto.growth import left_to_gain
from pareto_monoped.report.summary import notes, sentences
from tests.report.conftest import cut


def front_of(data, points):
    rows = data.front().iloc[: len(points)].copy()
    rows["height_m"], rows["energy_j"] = zip(*points, strict=True)
    return rows


def test_the_sentence_gives_the_price_of_the_headline_height(data, resimulation):
    case = replace(next(c for c in resimulation.cases if c.name == "C"), height_m=0.9, energy_j=40.0)
    front = front_of(data, [(0.7, 12.0), (0.85, 20.0), (0.95, 30.0)])
    first, _, second, _ = sentences(data, front, [case])
    assert first.startswith("0.80 m costs at least 20.0 J; the front of 3 designs runs from 0.70 m on 12.0 J")
    assert "published: 0.80 m on 15.4 J" in second
    assert "reaches 0.90 m on 40.0 J" in second
    assert second.endswith("the front gets that high on 30.0 J, 25 % less.")


@pytest.mark.parametrize(
    ("height", "words"), [(1.2, "higher than this front goes"), (None, "does not jump under this study")]
)
def test_the_papers_case_may_be_out_of_reach(data, resimulation, height, words):
    case = replace(next(c for c in resimulation.cases if c.name == "C"), height_m=height, energy_j=40.0, reason="why")
    assert words in sentences(data, front_of(data, [(0.7, 12.0), (0.95, 30.0)]), [case])[2]


def test_a_sentence_says_how_much_of_a_height_is_standing_up(data, resimulation):
    front = front_of(data, [(0.7, 12.0), (0.85, 20.0), (0.95, 30.0)])
    front["above_standing_m"], front["rise_m"] = [-0.02, 0.1, 0.151], [0.03, 0.2, 0.249]
    sentence = sentences(data, front, resimulation.cases)[1]
    assert "standing up on a straight leg: 0.70 m of the lowest, 0.70 m, and 0.80 m of the highest, 0.95 m" in sentence
    assert sentence.endswith("Their centres of mass rise by 0.03 m and 0.25 m after lift-off.")
    older = front.assign(rise_m=np.nan)
    assert not any("standing up" in line for line in sentences(data, older, resimulation.cases))


def test_a_low_front_says_how_high_it_gets(data, resimulation):
    front = front_of(data, [(0.6, 5.0), (0.7, 12.0)])
    assert sentences(data, front, resimulation.cases)[0].startswith(
        "No design reaches 0.80 m, the highest jump is 0.700 m"
    )


def growth(data):
    return data.history["evaluations"], data.history["hypervolume"]


def test_notes_tell_of_drift_bad_audits_and_an_early_end(data, resimulation):
    *others, last = notes(data, resimulation)
    assert last.startswith("Strength was not asked for")
    gain = f"4 times as many designs would gain about {left_to_gain(*growth(data)):.1%} of the hypervolume"
    assert all("audit" in n or n.startswith(gain) for n in others)
    assert sum(n.startswith(gain) for n in others) == 1
    less = cut(data, np.arange(len(data.trials)) < 50)
    audits = data.audits.iloc[:2].copy()
    audits["well_conditioned"] = False
    lines = notes(replace(less, audits=audits), replace(resimulation, drift_m=0.02))
    assert lines[0].startswith("Unfinished: 50 of 200")
    assert lines[1].startswith("2 designs were taken off the front")
    auditing = replace(data, meta=replace(data.meta, finished=False))
    assert notes(auditing, resimulation)[0].startswith("All 200 designs are simulated. The audit of the front is not")
    assert "up to 20.0 mm" in lines[2]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({}, "Gears lose what machined ones do; printed ones lose 1.3 to 4 times as much under load."),
        ({"gear_loss": 2.3}, "Gears lose 2.3 times what machined ones do under load"),
        ({"mesh_losses": False}, "Gears lose nothing in this study."),
    ],
)
def test_the_last_sentence_says_which_gears_a_study_has(data, resimulation, change, words):
    drive = replace(data.calibration.drive, **{"mesh_losses": True} | change)
    rows = front_of(data, [(0.7, 12.0), (0.95, 30.0)])
    other = replace(data)
    other.__dict__["calibration"] = replace(data.calibration, drive=drive)  # a cached property
    assert sentences(other, rows, resimulation.cases)[-1].startswith(words)
