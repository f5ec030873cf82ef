"""The best torque found for a design's hardware: certificates, gaps, the floor, and the command."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import pareto_monoped as pm
from pareto_monoped.actuator.search import map_for
from pareto_monoped.analysis import limit as module
from pareto_monoped.analysis.limit import LAW, chosen, limit_of, limits
from pareto_monoped.cli import cli
from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.design import ALL_NAMES, PAPER_CASES, control_of
from pareto_monoped.errors import ParetoMonopedError
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.engines import told_profiles
from pareto_monoped.robot.population import robot_arrays
from pareto_monoped.storage.reader import read_study
from pareto_monoped.strength.groups import REQUIRED_MEASURES
from pareto_monoped.study.run import run

REFERENCE = load_calibration("reference")
LIGHT = pm.Design.from_array([0.5, 0.5, 5.2, 4.09, 5.0, 5.0, 0.0]).as_array()


@pytest.fixture(scope="module")
def found():
    return limit_of(LIGHT, map_for("VT8020"), REFERENCE, jumps=480, workers=2)


def test_every_value_found_is_reached_by_a_jump_of_mujoco(found):
    """The jump of the other engine, from the design alone as ``simulate`` takes it."""
    calibration = REFERENCE.by("mujoco")
    for reached in (found.least, found.greatest, found.least_held, found.greatest_held):
        jump = pm.simulate(reached.design, calibration=calibration, controller=LAW.as_dict()).iloc[0]
        assert jump.status == "ok"
        assert jump.height_m == pytest.approx(reached.height_m, rel=1e-8)
        assert jump.energy_j == pytest.approx(reached.energy_j, rel=1e-8)
        assert max(jump.stop_compression_hip, jump.stop_compression_knee) <= 1.0
        assert abs(reached.half_step_energy) < 0.01
    for reached in (found.least_held, found.greatest_held):
        jump = pm.simulate(reached.design, controller=LAW.as_dict()).iloc[0]
        assert min(jump[name] for name in REQUIRED_MEASURES) >= 1.0


def test_the_gap_lies_between_the_design_and_the_floor(found):
    own = pm.simulate(pm.Design.from_array(LIGHT)).iloc[0]
    assert (found.height_m, found.energy_j) == (own.height_m, own.energy_j)
    assert found.least.height_m >= own.height_m
    assert found.floor_j < found.least.energy_j <= found.least_held.energy_j
    assert found.controller_gap == pytest.approx(100.0 * (own.energy_j - found.least.energy_j) / own.energy_j)
    assert found.controller_gap >= found.controller_gap_held > 5.0
    assert found.greatest.height_m >= found.greatest_held.height_m > own.height_m + 0.05


@pytest.mark.parametrize(("case", "holds"), [("C", True), ("nominal", False)])
def test_a_search_of_no_jumps_leaves_the_virtual_leg(case, holds):
    """The design's own jump is among the candidates, and among those that hold if it does."""
    design = PAPER_CASES[case].design
    one, own = limit_of(design.as_array(), map_for("VT8020"), REFERENCE, jumps=0), pm.simulate(design).iloc[0]
    assert all(own[name] >= 1.0 for name in REQUIRED_MEASURES) is holds
    assert one.controller_gap >= 0.0
    assert one.greatest.height_m >= one.height_m
    assert (one.least_held is not None) is holds


def test_a_jump_counts_that_presses_no_bumper_beyond_a_limit(monkeypatch, found):
    """At a limit below what the highest jump needs, a lower one is found that keeps it."""
    free = pm.simulate(found.greatest.design, controller=LAW.as_dict()).iloc[0]
    assert free.stop_compression_knee > 0.4
    monkeypatch.setattr(module, "_COMPRESSION", 0.4)
    one = limit_of(LIGHT, map_for("VT8020"), REFERENCE, jumps=240)
    kept = pm.simulate(one.greatest.design, controller=LAW.as_dict() if one.greatest.profile else None).iloc[0]
    assert not one.greatest.profile or max(kept.stop_compression_hip, kept.stop_compression_knee) <= 0.4


def test_the_number_of_workers_changes_no_number():
    one, other = (limit_of(LIGHT, map_for("VT8020"), REFERENCE, jumps=96, workers=n) for n in (1, 2))
    assert one.as_dict() == other.as_dict()
    assert limit_of(LIGHT, map_for("VT8020"), REFERENCE, jumps=96, seed=2).as_dict() != one.as_dict()


def test_the_knots_begin_near_the_jump_of_the_virtual_leg():
    """The torques told to the drivers, as twelve knots, make nearly the same jump."""
    robots, own = robot_arrays(LIGHT, map_for("VT8020")), pm.simulate(pm.Design.from_array(LIGHT)).iloc[0]
    profile = told_profiles(robots, control_of(LIGHT[None]), REFERENCE, LAW)
    design = pm.Design.from_array(np.concatenate([LIGHT, profile[0]]))
    jump = pm.simulate(design, controller=LAW.as_dict()).iloc[0]
    assert jump.height_m == pytest.approx(own.height_m, abs=0.02)
    assert jump.energy_j == pytest.approx(own.energy_j, rel=0.05)
    assert len(ALL_NAMES) == len(design.as_array())


@pytest.fixture(scope="module")
def db(tmp_path_factory):
    db = tmp_path_factory.mktemp("limit") / "s.db"
    file = {"name": "s", "evaluations": 40, "audit": False, "algorithm": {"name": "random"}, "gear_list": True}
    run(
        study_from_dict(file | {"rules": "iso6336", "variables": {"thigh_length_m": 0.5}}, source="test"), db, workers=1
    )
    return db


def test_a_front_is_thinned_evenly_with_both_ends(db):
    data = read_study(db)
    front = data.front().sort_values("height_m")
    rows = chosen(data, data.front(), (), 3)
    assert len(rows) == min(3, len(front))
    assert rows["trial"].iloc[0] == front["trial"].iloc[0]
    assert rows["trial"].iloc[-1] == front["trial"].iloc[-1]
    with pytest.raises(ParetoMonopedError, match="trial 99: is not there or did not jump"):
        chosen(data, data.front(), (99,), 3)
    trial = int(rows["trial"].iloc[0])
    (one,) = limits(data, chosen(data, data.front(), (trial, trial), 3), jumps=24, workers=1)
    assert one.trial == trial
    assert one.energy == "energy_j"


def test_the_command_prints_a_table_of_eighty_columns_and_json(db):
    words = ["limit", str(db), "--designs", "2", "--jumps", "24"]
    done = CliRunner().invoke(cli, words)
    assert done.exit_code == 0, done.output
    lines = done.stdout.splitlines()
    assert max(map(len, lines)) <= 80
    assert "gap %" in lines[1]
    assert "2/2 designs, 0:00 left" in done.stderr
    printed = json.loads(CliRunner().invoke(cli, [*words, "--json"]).stdout)
    row = lines[2].split()
    first = printed["limits"][0]
    assert [int(row[0]), float(row[1])] == [first["trial"], round(first["height_m"], 3)]
    assert float(row[5]) == round(first["controller_gap"], 1)


def test_a_study_of_profiles_has_no_gap_to_the_virtual_leg(tmp_path):
    file = {"name": "free", "evaluations": 8, "audit": False, "algorithm": {"name": "random", "population": 8}}
    file |= {"controller": {"kind": "torque_over_time", "knots": 6}}
    run(study_from_dict(file, source="test"), tmp_path / "f.db", workers=1)
    data = read_study(tmp_path / "f.db")
    with pytest.raises(ParetoMonopedError, match="the study has another controller"):
        list(limits(data, data.trials.iloc[:1]))
