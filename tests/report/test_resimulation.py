import numpy as np
import pytest

from pareto_monoped.design import NAMES, Design
from pareto_monoped.jump.single import simulate
from pareto_monoped.report.resimulation import COUNTS, FRAMES, in_few_frames, jumps_of


@pytest.fixture(scope="module")
def best(data):
    row = data.front().iloc[-1]
    design = Design.from_array(row[list(NAMES)].to_numpy(dtype=float))
    return design, row, simulate(design, data.case_kit, data.calibration, trace=True)


def test_frames_follow_the_whole_trace(best, data):
    design, row, result = best
    jump = jumps_of(design.as_array()[None], data.case_kit, data.calibration)[0]
    time = np.array(jump.columns["time_s"]) * jump.scale["time_s"]
    assert len(time) <= FRAMES
    assert time[0] == 0.0
    assert time[-1] == pytest.approx(result.trace["time_s"][-1], abs=1e-4)
    assert jump.height_m == pytest.approx(row["height_m"], abs=1e-9)
    for name, size in COUNTS.items():
        kept = np.array(jump.columns[name]) * size
        expected = np.interp(time, result.trace["time_s"], result.trace[name])
        # A frame's time is rounded, too, to a tenth of a step or so.
        np.testing.assert_allclose(kept, expected, atol=size + 0.11 * np.abs(np.diff(result.trace[name])).max())


def test_joint_angles_of_the_frames_lead_from_the_base_to_the_foot(best, data):
    """Kinematics as the page's animation has it, against the simulated foot."""
    design, _, _ = best
    jump = jumps_of(design.as_array()[None], data.case_kit, data.calibration)[0]
    frame = {name: np.array(values) * jump.scale[name] for name, values in jump.columns.items()}
    hip, both = frame["hip_rad"], frame["hip_rad"] + frame["knee_rad"]
    foot_z = frame["base_z_m"] - design.thigh_length_m * np.cos(hip) - design.shank_length_m * np.cos(both)
    np.testing.assert_allclose(foot_z, frame["foot_z_m"], atol=3e-4)


def test_lift_off_is_the_last_contact():
    steps = np.arange(100)
    trace = {name: np.zeros(100) for name in COUNTS} | {"time_s": 0.01 * steps, "contact_z_n": 1.0 * (steps <= 60)}
    assert in_few_frames(trace).lift_off_s == pytest.approx(0.60)


def test_what_is_simulated_again_agrees_with_the_database(resimulation):
    assert resimulation.drift_m == pytest.approx(0.0, abs=1e-9)
