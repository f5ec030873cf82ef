import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.design import CONTROL, NAMES, columns
from pareto_monoped.jump.frames import FRAME_COLUMNS, Recording, frame_steps, recordings
from pareto_monoped.report.packing import COUNTS, lift_off_s, packed, unpacked
from pareto_monoped.robot.population import robot_arrays


@st.composite
def jumps(draw):
    """A jump with any ends and any values, ones among them that are as wild as two bytes can hold."""
    last = draw(st.integers(2, 3_000))
    lift_off = draw(st.integers(1, last - 1))
    frames = draw(st.integers(6, 56))
    steps = frame_steps(lift_off, last, frames)
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    counts = draw(st.sampled_from([0.0, 1.0, 30.0, 3000.0]))
    values = {name: counts * COUNTS[name] * rng.standard_normal(len(steps)) for name in FRAME_COLUMNS}
    return frames, Recording(height_m=1.0, step_s=1e-3, lift_off_step=lift_off, steps=steps, columns=values)


@given(st.lists(jumps(), min_size=1, max_size=3))
def test_jumps_come_back_to_half_a_count_each_by_its_key(some):
    frames = some[0][0]
    made = [
        Recording(
            height_m=jump.height_m,
            step_s=jump.step_s,
            lift_off_step=jump.lift_off_step,
            steps=frame_steps(jump.lift_off_step, int(jump.steps[-1]), frames),
            columns={
                name: np.resize(values, len(frame_steps(jump.lift_off_step, int(jump.steps[-1]), frames)))
                for name, values in jump.columns.items()
            },
        )
        for _, jump in some
    ]
    keys = [100 + 7 * i for i in range(len(made))]
    text = packed(dict(zip(keys, made, strict=True)), frames)
    assert list(text.keys) == keys
    for key, jump in zip(keys, made, strict=True):
        found = unpacked(text, key)
        np.testing.assert_allclose(found["time_s"], jump.time_s)
        assert lift_off_s(text, key) == jump.lift_off_step * jump.step_s
        for name, count in COUNTS.items():
            np.testing.assert_allclose(found[name], jump.columns[name], atol=0.5001 * count, rtol=0.0)


def test_no_jumps_are_hardly_any_text():
    assert len(packed({}, 56).data) < 16


def test_a_real_jump_takes_a_tenth_of_what_it_took_as_numbers(data):
    front = data.front()
    designs = front[list(NAMES)].to_numpy(dtype=np.float64)
    robots = robot_arrays(designs, data.case_kit, data.calibration.mass)
    made = recordings(robots, columns(designs, CONTROL), data.calibration, 56)
    text = packed(dict(enumerate(made)), 56)
    assert len(text.data) / len(made) < 400
    for place, jump in enumerate(made):
        assert unpacked(text, place)["base_z_m"].max() == pytest.approx(jump.height_m, abs=1e-3)
