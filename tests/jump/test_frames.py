from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import CONTROL, columns
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.frames import FRAME_COLUMNS, frame_steps, recordings
from pareto_monoped.jump.single import trace_of
from pareto_monoped.jump.variations import take
from pareto_monoped.robot.population import robot_arrays
from tests.jump.robots import random_designs


@given(st.integers(1, 2_000), st.integers(1, 2_000), st.integers(4, 80))
def test_kept_steps_are_few_and_even_and_hold_start_lift_off_and_apex(before, after, frames):
    steps = frame_steps(before, before + after, frames)
    assert len(steps) <= frames + 1
    assert {0, before, before + after} <= set(steps.tolist())
    gaps = np.diff(steps)
    assert (gaps > 0).all()
    lift_off = int(np.flatnonzero(steps == before)[0])
    assert len(set(gaps[1:lift_off].tolist())) <= 1
    assert len(set(gaps[lift_off:-1].tolist())) <= 1


@pytest.mark.parametrize("name", ["reference", "reference-3", "stand", "stand-1", "paper"])
def test_frames_are_those_of_the_whole_trace(name):
    """Bit by bit by the same engine, but the floor's force, which follows from the momentum here and not there."""
    calibration, maps = load_calibration(name), map_for("VT8020")
    designs = random_designs(2, seed=3)
    robots, control = robot_arrays(designs, maps, calibration.mass), columns(designs, CONTROL)
    made = recordings(robots, control, calibration, 40)
    for i, jump in enumerate(made):
        trace = trace_of(take(robots, np.array([i])), control[i : i + 1], calibration)
        assert jump.steps[-1] == len(trace["time_s"]) - 1
        assert jump.height_m == pytest.approx(trace["base_z_m"].max(), rel=1e-9)
        for column in FRAME_COLUMNS[:-1]:
            rounding = 1e-7 if calibration.simulation.engine == "compiled" else 0.0
            np.testing.assert_allclose(
                jump.columns[column], trace[column][jump.steps], rounding, rounding, err_msg=column
            )
        if name == "paper":
            continue  # its integrator spreads a contact's force over the step
        off = np.abs(jump.columns["contact_z_n"] - trace["contact_z_n"][jump.steps]) / trace["contact_z_n"].max()
        at_lift_off = jump.steps == jump.lift_off_step  # the step in which the contact ends
        assert off[~at_lift_off].max() < 0.06
        assert np.median(off[jump.steps < jump.lift_off_step]) < 0.003
        assert off[at_lift_off] < 0.15
        assert jump.lift_off_step == np.flatnonzero(trace["contact_z_n"] > 0.0)[-1]


def test_rough_rails_push_down_on_the_way_up():
    """The floor's force of a film, which follows from the momentum, against MuJoCo's own under rails of 5 N each."""
    known = load_calibration("stand")
    calibration = replace(known, stand=replace(known.stand, rail_friction_n=5.0))
    designs = random_designs(1, seed=3)
    robots, control = robot_arrays(designs, map_for("VT8020"), calibration.mass), columns(designs, CONTROL)
    for i, jump in enumerate(recordings(robots, control, calibration, 40)):
        trace = trace_of(take(robots, np.array([i])), control[i : i + 1], calibration)
        rising = (jump.steps > 3) & (jump.steps < jump.lift_off_step)
        off = jump.columns["contact_z_n"] - trace["contact_z_n"][jump.steps]
        assert np.abs(np.median(off[rising])) < 1.0


def test_a_jump_does_not_depend_on_the_others_or_on_the_threads():
    calibration, maps = load_calibration("reference"), map_for("VT8020")
    designs = random_designs(300, seed=8)  # more than one chunk
    robots, control = robot_arrays(designs, maps, calibration.mass), columns(designs, CONTROL)
    every = recordings(robots, control, calibration, 30, workers=2)
    alone = np.array([3, 299])
    for place, jump in zip(alone, recordings(take(robots, alone), control[alone], calibration, 30), strict=True):
        assert every[place].lift_off_step == jump.lift_off_step
        for column in FRAME_COLUMNS:
            np.testing.assert_array_equal(every[place].columns[column], jump.columns[column])


def test_a_jump_without_an_apex_is_none():
    calibration, maps = load_calibration("reference"), map_for("VT8020")
    designs = random_designs(2, seed=1)
    control = columns(designs, CONTROL)
    control[0] = 0.0  # no stiffness: it sinks
    robots = robot_arrays(designs, maps, calibration.mass)
    first, second = recordings(robots, control, calibration, 20)
    assert first is None
    assert second is not None
