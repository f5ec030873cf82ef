import numpy as np
import pytest

from pareto_monoped.design import NAMES
from pareto_monoped.pareto.pick import pick
from pareto_monoped.pareto.selectors import Knee
from pareto_monoped.report.packing import packed
from pareto_monoped.report.resimulation import JUMPS_BYTES, LEAST_FRAMES, MOST_FRAMES, frames_for, jumps_of, resimulate


def test_what_is_simulated_again_agrees_with_the_database(resimulation):
    assert resimulation.drift_m == pytest.approx(0.0, abs=1e-9)


def test_every_design_of_the_front_jumps_unless_fewer_are_asked_for(data):
    front = data.front()["trial"].tolist()
    assert list(resimulate(data).jumps) == front
    some = resimulate(data, most_jumps=3).jumps
    assert {front[0], front[-1]} <= set(some) < set(front)
    assert not resimulate(data, most_jumps=0).jumps
    # The page opens on the knee, which has its jump however few there are.
    knee = pick(data.front(), Knee(), data.study.objectives).trial
    assert knee not in (front[0], front[-1])
    assert set(resimulate(data, most_jumps=2).jumps) == {front[0], knee, front[-1]}


def test_a_design_that_no_longer_jumps_is_left_out_and_told(data, monkeypatch):
    from pareto_monoped.report import resimulation

    made = resimulation.jumps_of
    monkeypatch.setattr(resimulation, "jumps_of", lambda *args: [None, *made(*args)[1:]])
    again = resimulate(data)
    front = data.front()
    assert list(again.jumps) == front["trial"].tolist()[1:]
    assert again.drift_m == front["height_m"].iloc[0]


def test_many_jumps_have_fewer_frames_and_stay_within_what_a_page_may_take(data):
    assert frames_for(0) == frames_for(60) == MOST_FRAMES
    assert frames_for(100_000) == LEAST_FRAMES
    rows = data.front()
    designs = rows[list(NAMES)].to_numpy(dtype=np.float64)
    for many in (5_000, 8_000, 12_000):
        frames = frames_for(many)
        jumps = dict(enumerate(jumps_of(designs, data.case_kit, data.calibration, frames)))
        each = len(packed(jumps, frames).data) / len(jumps)
        assert many * each < 1.1 * JUMPS_BYTES
    assert frames_for(5_000) > frames_for(8_000) > frames_for(12_000) > LEAST_FRAMES
