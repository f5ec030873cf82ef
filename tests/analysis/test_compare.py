"""Logs of jumps compared and fitted: blind logs come from ``tests/jump/planar.py``, which shares no code with us."""

from functools import cache

import numba
import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.analysis.compare import PARAMETERS, Log, _Machine, compare, read_log
from pareto_monoped.design import NAMES, PAPER_CASES, control_of
from pareto_monoped.errors import InputError
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.single import trace_of
from pareto_monoped.robot.population import robot_arrays
from tests.jump import planar
from tests.jump.test_independent_simulator import machine

NOISE = {"height": 2e-3, "hip": 2e-3, "knee": 2e-3, "hip_current": 0.3, "knee_current": 0.3}
"""Standard deviations of string potentiometer, encoders of 12 bits and current sensors, in SI units."""


@numba.njit
def recorded(m, q, delay, constant):
    """Rows of height, angles of both motors and their torques every 1 ms; a command acts ``delay`` substeps late."""
    n = len(q)
    q, v, motor, mode = q.copy(), np.zeros(n), np.zeros(2), np.zeros(5, np.int64)
    stood = off = False
    h, loads = 1e-3 / planar.SUBSTEPS, np.zeros(5)
    torques, shares, rows = np.zeros((3000, 2)), np.zeros((3000, 2)), np.zeros((3000, 5))
    for period in range(3000):
        clearance = q[1] - m.thigh * np.cos(q[2]) - m.shank * np.cos(q[2] + q[3]) - m.radius
        stood |= clearance <= 0
        hip, knee = q[n - 2], q[n - 1]
        read = q[1] - m.thigh * np.cos(hip) - m.shank * np.cos(hip + knee) - m.radius
        off |= stood and read >= m.fade
        if off and v[1] <= 0:
            return rows[:period]
        u = min(max(read / m.fade, 0.0), 1.0)
        hip_torque, knee_torque = planar.wanted(q, v, m)
        torques[period, 0], torques[period, 1] = constant * hip_torque, constant * knee_torque
        shares[period, 0] = shares[period, 1] = 0.0 if off else 1 - 3 * u**2 + 2 * u**3
        for substep in range(planar.SUBSTEPS):
            if (period * planar.SUBSTEPS + substep - delay) % planar.SUBSTEPS == 0:
                due = (period * planar.SUBSTEPS + substep - delay) // planar.SUBSTEPS
                for j in range(2):
                    motor[j] = shares[due, j] * planar.limited(torques[due, j], v, m, j) if due >= 0 else 0.0
            if substep == 0:
                rows[period, 0], rows[period, 1], rows[period, 2] = q[1], q[n - 2], q[n - 1]
                rows[period, 3], rows[period, 4] = motor[0], motor[1]
            planar.step(q, v, motor, m, mode, loads, h)
    return rows


@cache
def known(case):
    """Design, robot and what the independent simulator takes of both."""
    design = PAPER_CASES[case].design
    robots = robot_arrays(design.as_array(), map_for("VT8020"))
    numbers = dict(zip(NAMES, design.as_array(), strict=True))
    return design, robots, machine(robots, 0, numbers, load_calibration("reference"))


def blind_log(case, true, rng):
    """A log of a machine that differs from its design by ``true``: friction, constant, delay in s, stiffness."""
    _, robots, m = known(case)
    friction, constant, delay, stiffness = true
    m = m._replace(
        friction=m.friction * friction,
        peak=m.peak * constant,
        spring=m.spring * stiffness,
    )
    rows = recorded(m, planar.standing(m), round(delay / 1e-3 * planar.SUBSTEPS), constant)
    rows[:, 3:] /= constant * robots.ratio[0] * robots.torque_constant_n_m_per_a[0]
    rows += rng.normal(0.0, 1.0, 5) * 2.0 * np.array(list(NOISE.values()))  # wrong zeros of all sensors
    signals = dict(
        zip(NOISE, rows.T + rng.normal(0.0, 1.0, rows.T.shape) * np.array(list(NOISE.values()))[:, None], strict=True)
    )
    return Log(time_s=1e-3 * np.arange(len(rows)), signals=signals)


def blind(seed):
    """True values and what a comparison with the log says of them."""
    rng = np.random.default_rng(seed)
    true = np.array([rng.uniform(0.5, 2.0), rng.uniform(0.92, 1.1), 50e-6 * rng.integers(0, 60), rng.uniform(0.7, 1.3)])
    case = ("nominal", "A", "B", "C")[seed % 4]
    log = blind_log(case, true, rng)
    return true, compare(log, known(case)[0], map_for("VT8020"), load_calibration("reference"))


@pytest.mark.parametrize(("logs", "least"), [pytest.param(20, 18, marks=pytest.mark.long)])
def test_true_values_lie_inside_the_intervals_of_blind_logs(logs, least):
    """In nearly all logs all four at once; and no interval is so wide that it says nothing."""
    held, widths = 0, []
    for seed in range(logs):
        true, found = blind(seed)
        ends = np.array([(found.fitted[name].lower, found.fitted[name].upper) for name in PARAMETERS])
        held += bool(((ends[:, 0] <= true) & (true <= ends[:, 1])).all())
        widths.append(ends[:, 1] - ends[:, 0])
        assert all(found.after[name] == pytest.approx(noise, rel=0.25) for name, noise in NOISE.items())
        assert found.before["knee"] > 2.0 * found.after["knee"]
    assert held >= least
    assert (np.median(widths, axis=0) < [0.7, 0.015, 0.5e-3, 0.1]).all()


def test_a_stronger_motor_scales_everything_that_its_controller_commands():
    """All of spring, damper, torsion and weight are commanded as currents."""
    machine = _Machine(known("C")[0], map_for("VT8020"), load_calibration("reference"))
    plain, strong = machine._population(np.array([[1.0, 1.0, 0.0, 1.0], [1.0, 1.25, 0.0, 1.0]])).records
    for name in ("stiffness_n_per_m", "damping_n_s_per_m", "torsional_stiffness_n_m_per_rad", "weight_n"):
        assert strong[name] == pytest.approx(1.25 * plain[name], rel=1e-12)
        assert plain[name] > 0.0
    assert strong["torque_limit_n_m"] == pytest.approx(1.25 * plain["torque_limit_n_m"], rel=1e-12)


LINES = ["time_ms,hip_deg,knee_rad,knee_current_mA,height_mm", "0,-45,1.5,0,450", "1,-44,1.4,12000,451"]


def test_a_log_is_read_in_the_units_of_its_header(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("\n".join(LINES) + "\n")
    log = read_log(path)
    assert log.time_s == pytest.approx([0.0, 1e-3])
    assert log.signals["hip"] == pytest.approx([-np.pi / 4, -44 * np.pi / 180])
    assert log.signals["knee_current"] == pytest.approx([0.0, 12.0])
    assert log.signals["height"] == pytest.approx([0.45, 0.451])
    assert set(log.signals) == {"hip", "knee", "knee_current", "height"}


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ([], "is empty; give a header"),
        (["time,hip_rad,hip_current_a", "0,0,0"], "column = 'time': must be one of time_s|ms"),
        (["time_s,hip_rad,hip_deg,hip_current_a"], "column 'hip_deg' stands twice"),
        (["time_s,height_m,hip_current_a", "0,0,0"], "has no column hip or knee with its unit"),
        (["time_s,hip_rad", "0,0"], "has no column hip_current or knee_current with its unit"),
        ([LINES[0], "0,1,2"], "row 2: has 3 cells, must be 5"),
        ([LINES[0], "0,1,2,x,4"], "row 2: knee_current = 'x': must be a finite number"),
        ([LINES[0], LINES[1], LINES[1]], "time must rise from row to row"),
    ],
)
def test_a_wrong_log_ends_in_one_line(tmp_path, lines, said):
    path = tmp_path / "log.csv"
    path.write_text("\n".join(lines))
    with pytest.raises(InputError) as raised:
        read_log(path)
    assert said in str(raised.value)
    assert "\n" not in str(raised.value)


def test_a_log_of_too_few_samples_is_refused():
    design, calibration = PAPER_CASES["C"].design, load_calibration("reference")
    robots = robot_arrays(design.as_array(), map_for("VT8020"))
    jump = trace_of(robots, control_of(design.as_array()[None]), calibration)
    ampere = jump["knee_motor_torque_n_m"] / (robots.ratio[0, 1] * robots.torque_constant_n_m_per_a[0, 1])
    signals = {"height": jump["base_z_m"], "knee": jump["knee_rad"], "knee_current": ampere}
    few = Log(time_s=jump["time_s"][::50], signals={name: column[::50] for name, column in signals.items()})
    with pytest.raises(InputError, match=r"samples = .*must be 50 at least during the push; log faster"):
        compare(few, design, map_for("VT8020"), calibration)
