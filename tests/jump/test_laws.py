"""The laws of the motors: both engines, the exported replay, laws of one's own, and what a study file may say."""

import importlib.util
import json
from dataclasses import replace
from importlib import resources

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.interpolate import CubicHermiteSpline

import pareto_monoped as pm
from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.write.mjcf import jump_record
from pareto_monoped.cli import cli
from pareto_monoped.design import KNOT_NAMES, NAMES, PAPER_CASES, control_of, table_of
from pareto_monoped.errors import DesignError, ParetoMonopedError
from pareto_monoped.jump.calibration import calibration_of, calibration_values, load_calibration
from pareto_monoped.jump.document import mjcf
from pareto_monoped.jump.evaluate import Evaluator, evaluate_robots
from pareto_monoped.jump.laws import KINDS, PAPER_LAW, law_of
from pareto_monoped.jump.torques import between
from pareto_monoped.robot.population import robot_arrays

C = PAPER_CASES["C"].design
KNOTS = dict(
    zip((f"{j}_knot_{k}" for j in ("hip", "knee") for k in range(1, 8)), np.linspace(-0.2, 0.3, 14), strict=True)
)
PUSH = C.replace(KNOTS | {f"knee_knot_{k}": -0.9 + 0.05 * k for k in range(1, 8)} | {"push_time_s": 0.23})
"""A push of the knee with some torque of the hip, through seven knots."""
PROFILES = [{"kind": kind, "knots": 7, "between": way} for kind in KINDS[1:] for way in ("cubic", "linear")]


def law(table):
    return law_of(table, source="test")


@pytest.mark.parametrize(
    "table",
    [pytest.param(table, marks=() if k in (0, 3, 4) else pytest.mark.long) for k, table in enumerate(PROFILES)],
    ids=["-".join(map(str, table.values())) for table in PROFILES],
)
def test_both_engines_and_the_exported_replay_make_the_same_jump(table, tmp_path):
    calibration = load_calibration("reference").under(law(table))
    values, maps = PUSH.as_array(), map_for("VT8020")
    one, other = (Evaluator(maps, calibration.by(engine))(values) for engine in ("compiled", "mujoco"))
    assert one.status[0] == other.status[0] == "ok"
    np.testing.assert_allclose((one.height_m[0], one.energy_j[0]), (other.height_m[0], other.energy_j[0]), rtol=1e-9)
    robots = robot_arrays(values, maps, calibration.mass)
    (tmp_path / "jump.json").write_text(jump_record(robots, PUSH, calibration))
    (tmp_path / "monoped.xml").write_text(mjcf(robots, calibration))
    spec = importlib.util.spec_from_file_location("replay", resources.files("pareto_monoped") / "data" / "replay.py")
    replay = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(replay)
    height, energy, electrical = replay.replay(tmp_path)
    np.testing.assert_allclose(height, other.height_m[0], rtol=1e-9)
    np.testing.assert_allclose((energy, electrical), (other.energy_j[0], other.electrical_energy_j[0]), rtol=1e-9)


def test_knots_are_joined_by_lines_or_by_the_cubics_of_scipy():
    values, places = np.random.default_rng(3).uniform(-1.0, 1.0, 9), np.linspace(-0.1, 1.1, 97)
    at = np.linspace(0.0, 1.0, 9)
    clipped = np.clip(places, 0.0, 1.0)
    lines = [between(place, values, 9, False) for place in places]
    np.testing.assert_allclose(lines, np.interp(clipped, at, values), atol=1e-13)
    smooth = [between(place, values, 9, True) for place in places]
    slopes = np.gradient(values, at)  # central inside, of the outermost pairs at both ends
    np.testing.assert_allclose(smooth, CubicHermiteSpline(at, values, slopes)(clipped), atol=1e-13)


class Spring(pm.OwnLaw):
    """The paper's virtual leg, written by a user from its equations."""

    own_variables = ("k", "c", "t", "thigh", "shank", "weight_n")

    @staticmethod
    def torques(state, variables):
        stiffness, damping, torsion, _thigh, shank, weight = variables[:6]
        x, z, length = state.foot_x_m, state.foot_z_m, np.hypot(state.foot_x_m, state.foot_z_m)
        below = state.hip_rad + state.knee_rad
        knee_x, knee_z = -shank * np.sin(below), -shank * np.cos(below)
        vx = z * state.hip_rad_per_s + knee_z * state.knee_rad_per_s
        vz = -x * state.hip_rad_per_s - knee_x * state.knee_rad_per_s
        pull = stiffness * (10.0 - length) - damping * (x * vx + z * vz) / length
        turn = torsion * np.arctan2(-x, -z) / length
        fx = pull * x / length - turn * z / length
        fz = pull * z / length + turn * x / length - weight
        return z * fx - x * fz, knee_z * fx - knee_x * fz


@pytest.mark.parametrize("engine", ["compiled", "mujoco"])
def test_a_law_of_ones_own_makes_the_jump_of_the_same_law_of_the_package(engine):
    calibration = replace(load_calibration("reference"), name="mine").by(engine)
    own = {
        "k": C.stiffness_n_per_m, "c": C.damping_n_s_per_m, "t": C.torsional_stiffness_n_m_per_rad,
        "thigh": C.thigh_length_m, "shank": C.shank_length_m, "weight_n": 9.81 * pm.build_robot(C).mass_kg,
    }  # fmt: skip
    known = pm.simulate(C, calibration=calibration)
    mine = pm.simulate(C.as_dict() | own, calibration=calibration, controller=Spring())
    assert set(own) <= set(mine.columns)
    assert not set(KNOT_NAMES) & set(mine.columns)
    for name in ("height_m", "energy_j", "peak_foot_force_n"):
        np.testing.assert_allclose(mine[name][0], known[name][0], rtol=1e-9)
    if engine == "compiled":
        steps = pm.trace(C.as_dict() | own, calibration=calibration, controller=Spring())
        assert steps.base_z_m.max() == pytest.approx(known.height_m[0], rel=1e-9)


def test_no_file_names_or_holds_a_law_of_ones_own():
    with pytest.raises(ParetoMonopedError, match=r"controller = 'own': must be one of virtual_leg, torque_over_time"):
        pm.Study.define(name="mine", evaluations=40, controller="own")
    calibration = load_calibration("reference").under(Spring())
    with pytest.raises(DesignError, match="Spring: is your own, which no file holds"):
        jump_record(robot_arrays(C.as_array(), map_for("VT8020"), calibration.mass), C, calibration)


def test_a_calibration_with_a_law_is_stored_and_one_without_says_nothing():
    known = load_calibration("reference")
    assert "law" not in calibration_values(known)["controller"]
    assert known.under(PAPER_LAW) == known
    for table in PROFILES:
        changed = known.under(law(table))
        assert changed != known
        assert calibration_of(calibration_values(changed), source="test") == changed


def test_the_controller_of_the_command_line_is_that_of_scripts():
    changes = [f"--set={name}={value!r}" for name, value in PUSH.as_dict().items()]
    done = CliRunner().invoke(cli, ["simulate", "--controller", "torque_over_time:7", "--json", *changes])
    printed = json.loads(done.stdout)
    found = pm.simulate(PUSH, controller={"kind": "torque_over_time", "knots": 7})
    assert printed["height_m"] == pytest.approx(found.height_m[0], rel=1e-9)
    assert printed["design"]["hip_knot_2"] == PUSH.profile[2]


def test_torques_keep_the_motors_limits_and_end_with_the_foot_in_the_air():
    """Knots beyond the peak torque ask for more than the motors have; in flight they are told nothing."""
    strong = C.replace({f"knee_knot_{k}": -3.0 for k in range(1, 8)} | {"push_time_s": 2.0})
    steps = pm.trace(strong, controller={"kind": "torque_over_time", "knots": 7})
    limit = map_for("VT8020").motor.peak_torque_n_m * strong.knee_ratio
    assert steps.knee_motor_torque_n_m.abs().max() == pytest.approx(limit, rel=0.05)
    assert steps.knee_motor_torque_n_m.abs().max() <= limit * (1 + 1e-12)
    flying = steps.foot_clearance_m > 0.02  # beyond the gate by more than one control period
    assert flying.any()
    assert (steps.knee_motor_torque_n_m[flying] == 0.0).all()


def test_a_design_keeps_its_knots_in_every_form():
    assert pm.Design.from_array(PUSH.as_array()) == PUSH == pm.Design(**PUSH.as_dict())
    assert PUSH.replace({"hip_knot_1": 0.5}).profile[1] == 0.5
    assert set(NAMES) <= set(table_of(PUSH.as_array()[None]))
    assert "profile" not in repr(C)
    assert not set(KNOT_NAMES) & set(table_of(C.as_array()[None]))
    robots = robot_arrays(PUSH.as_array(), map_for("VT8020"))
    given = control_of(PUSH.as_array()[None])
    model = load_calibration("reference").under(law(PROFILES[0]))
    assert evaluate_robots(robots, given, model).ok[0]
