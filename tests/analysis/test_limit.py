"""The best torque found for a design's hardware: certificates, gaps, the floor, and the command."""

import json
import re
import shutil
import sqlite3
from contextlib import closing
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from click.testing import CliRunner

import pareto_monoped as pm
from pareto_monoped.actuator.search import map_for
from pareto_monoped.analysis import limit as module
from pareto_monoped.analysis.limit import JUMPS, LAW, MOST_DESIGNS, TRACKING, chosen, limit_of, limits
from pareto_monoped.analysis.verify import verify
from pareto_monoped.cli import cli
from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.design import ALL_NAMES, PAPER_CASES, control_of
from pareto_monoped.errors import ParetoMonopedError
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.engines import told_profiles
from pareto_monoped.jump.evaluate import Evaluator, evaluate_robots
from pareto_monoped.jump.laws import law_of
from pareto_monoped.robot.population import robot_arrays
from pareto_monoped.storage.extra_rows import read_limits
from pareto_monoped.storage.reader import read_study
from pareto_monoped.strength.groups import REQUIRED_MEASURES
from pareto_monoped.study.run import run
from pareto_monoped.uncertainty.samples import sobol_samples, variations
from pareto_monoped.uncertainty.settings import load_uncertainty
from pareto_monoped.uncertainty.statistics import robustness

REFERENCE = load_calibration("reference")
LIGHT = pm.Design.from_array([0.5, 0.5, 5.2, 4.09, 5.0, 5.0, 0.0]).as_array()


@cache
def few():
    return sobol_samples(load_uncertainty(), 64)


@pytest.fixture(scope="module")
def found():
    """With more jumps for the tracking law than it has of so few."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(module, "_SHARE", 2)
        return limit_of(LIGHT, map_for("VT8020"), REFERENCE, jumps=200, workers=2, samples=few())


@pytest.fixture(autouse=True)
def few_samples(monkeypatch):
    """Robots as built take no time in the tests of commands."""
    monkeypatch.setattr(module, "sampling", lambda *_: (load_uncertainty(), 16, 1))


def test_every_value_found_is_reached_by_a_jump_of_mujoco(found):
    """The jump of the other engine, from the design alone as ``simulate`` takes it."""
    calibration = REFERENCE.by("mujoco")
    every = (found.least, found.greatest, found.least_held, found.greatest_held, found.over_time, found.tracking)
    for reached in every:
        jump = pm.simulate(reached.design, calibration=calibration, controller=reached.controller).iloc[0]
        assert jump.status == "ok"
        assert jump.height_m == pytest.approx(reached.height_m, rel=1e-8)
        assert jump.energy_j == pytest.approx(reached.energy_j, rel=1e-8)
        assert max(jump.stop_compression_hip, jump.stop_compression_knee) <= 1.0
        assert abs(reached.half_step_energy) < 0.01
    for reached in (found.least_held, found.greatest_held, found.tracking):
        jump = pm.simulate(reached.design, controller=reached.controller).iloc[0]
        assert min(jump[name] for name in REQUIRED_MEASURES) >= 1.0


def test_the_gap_lies_between_the_design_and_the_floor(found):
    own = pm.simulate(pm.Design.from_array(LIGHT)).iloc[0]
    assert (found.height_m, found.energy_j) == (own.height_m, own.energy_j)
    assert found.least.height_m >= own.height_m
    assert found.floor_j < found.least.energy_j <= found.least_held.energy_j
    assert found.controller_gap == pytest.approx(100.0 * (own.energy_j - found.least.energy_j) / own.energy_j)
    assert found.controller_gap >= found.controller_gap_held > 5.0
    assert found.greatest.height_m >= found.greatest_held.height_m > own.height_m + 0.05


def test_delay_and_other_torques_do_what_they_do_to_another_calibration_or_robot(found):
    """A late calibration; and a robot with weaker motors, by which the damper of the tracking law acts as well."""
    for reached in (found.over_time, found.tracking):
        model = REFERENCE.under(law_of(reached.controller, source="test"))
        late = replace(model, simulation=replace(model.simulation, delay_s=0.002))
        design = pm.Design(**reached.design).as_array()
        height_m = Evaluator(map_for("VT8020"), late)(design).height_m[0]
        assert height_m - reached.height_m == pytest.approx(reached.perturbed.late_m, abs=1e-9)
        robots, control = robot_arrays(design, map_for("VT8020"), model.mass), control_of(design[None])
        control[0, 1] *= 0.95  # C
        weak = evaluate_robots(replace(robots, peak_torque_n_m=0.95 * robots.peak_torque_n_m), control, model)
        assert weak.height_m[0] - reached.height_m == pytest.approx(reached.perturbed.weak_m, abs=1e-9)
        assert reached.perturbed.weak_m < -0.005 < 0.005 < reached.perturbed.strong_m


def test_robots_as_built_are_those_of_robust(found):
    """Shares are those that ``robustness`` makes of the same samples; a robot that does not jump has no height."""
    least = dict.fromkeys(REQUIRED_MEASURES, 1.0)
    for reached in (found.over_time, found.tracking):
        model = REFERENCE.under(law_of(reached.controller, source="test"))
        designs = np.repeat(pm.Design(**reached.design).as_array()[None], len(few()), axis=0)
        jumps = Evaluator(map_for("VT8020"), model, 2)(designs, variations=variations(few(), 1, model))
        known, perturbed = robustness(jumps, slice(None), least), reached.perturbed
        ends = np.quantile(np.where(jumps.ok, jumps.height_m, 0.0), (0.05, 0.95))
        assert (perturbed.p05_m, perturbed.p95_m) == pytest.approx(tuple(ends), rel=1e-12)
        pressed = np.maximum(jumps.stop_compression_hip, jumps.stop_compression_knee) > 1.0
        held = 1.0 - known.overloaded - known.failed
        assert perturbed.holds <= held <= perturbed.holds + pressed.mean()
        assert reached.perturbed.reaches == (jumps.height_m >= 0.95 * found.height_m).mean()


def test_the_tracking_law_survives_what_torque_over_time_does_not(found):
    assert found.tracking.perturbed.reaches > 0.95 > found.over_time.perturbed.reaches + 0.15
    assert found.tracking.perturbed.holds > 0.95
    assert found.tracking.height_m >= found.height_m
    assert found.tracking.energy_j < 0.8 * found.energy_j
    assert found.tracking.design["damping_n_s_per_m"] > 0.0
    saved, kept = 1.0 - found.tracking.energy_j / found.energy_j, found.tracking.perturbed.reaches
    assert f"tracking takes {100 * saved:.1f} % less, and {100 * kept:.0f} % of robots as built" in found.text()


def test_the_search_of_the_tracking_law_begins_near_the_torque_over_time(found):
    """Its knots make up for whatever damper it begins with."""
    tracked, starts = module._Tracked(LIGHT, map_for("VT8020"), REFERENCE, "energy_j", 1), []
    for damping in (0.0, 10.0):
        with pytest.MonkeyPatch.context() as patched:
            patched.setattr(module, "_DAMPING_N_S_PER_M", damping)
            starts.append(tracked.designs(tracked.start(pm.Design(**found.over_time.design).as_array())[None])[0])
    jumps = Evaluator(map_for("VT8020"), REFERENCE.under(TRACKING))(np.array(starts))
    np.testing.assert_allclose(jumps.height_m, found.over_time.height_m, atol=0.04)
    np.testing.assert_allclose(jumps.energy_j, found.over_time.energy_j, rtol=0.02)
    assert abs(np.diff(jumps.height_m)) < 0.002


@pytest.mark.parametrize(("case", "holds"), [("C", True), ("nominal", False)])
def test_a_search_of_no_jumps_leaves_the_virtual_leg(case, holds):
    """The design's own jump is among the candidates, and among those that hold if it does."""
    design = PAPER_CASES[case].design
    one, own = (
        limit_of(design.as_array(), map_for("VT8020"), REFERENCE, jumps=0, samples=few()),
        pm.simulate(design).iloc[0],
    )
    assert all(own[name] >= 1.0 for name in REQUIRED_MEASURES) is holds
    assert one.controller_gap >= 0.0
    assert one.greatest.height_m >= one.height_m
    assert (one.least_held is not None) is holds


@pytest.mark.long
def test_a_jump_counts_that_presses_no_bumper_beyond_a_limit(monkeypatch, found):
    """At a limit below what the highest jump needs, a lower one is found that keeps it."""
    free = pm.simulate(found.greatest.design, controller=found.greatest.controller).iloc[0]
    assert free.stop_compression_knee > 0.4
    monkeypatch.setattr(module, "_COMPRESSION", 0.4)
    one = limit_of(LIGHT, map_for("VT8020"), REFERENCE, jumps=240, samples=few())
    kept = pm.simulate(one.greatest.design, controller=one.greatest.controller).iloc[0]
    assert (
        one.greatest.controller == {"kind": "virtual_leg"}
        or max(kept.stop_compression_hip, kept.stop_compression_knee) <= 0.4
    )


@pytest.mark.long
def test_the_number_of_workers_changes_no_number():
    one, other = (limit_of(LIGHT, map_for("VT8020"), REFERENCE, jumps=48, workers=n, samples=few()) for n in (1, 2))
    assert one.as_dict() == other.as_dict()
    assert limit_of(LIGHT, map_for("VT8020"), REFERENCE, jumps=48, seed=2, samples=few()).as_dict() != one.as_dict()


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
    with pytest.raises(ParetoMonopedError, match="trial = 99: must be a trial of the study that jumped"):
        chosen(data, data.front(), (99,), 3)
    trial = int(rows["trial"].iloc[0])
    assert chosen(data, data.front(), (trial, trial), 3)["trial"].tolist() == [trial]


def test_limits_are_stored_and_only_those_are_searched_that_are_not_there(db):
    front, searched = read_study(db).front(), []
    for count in (1, 2):
        found = limits(db, front.iloc[:count], jumps=6, workers=1, progress=lambda *done: searched.append(done))
    assert searched == [(1, 1), (1, 1)]
    assert [one.trial for one in found] == front["trial"].tolist()[:2]
    assert {one.energy for one in found} == {"energy_j"}
    assert [stored.result for stored in read_limits(db).values()] == sorted(found, key=lambda one: one.trial)
    limits(db, front.iloc[:1], jumps=6, seed=2, workers=1, progress=lambda *done: searched.append(done))
    assert len(searched) == 3


def lowest(db):
    """The limit of the lowest jump of the front, which the command finds stored."""
    data = read_study(db)
    (one,) = limits(db, chosen(data, data.front(), (), 2).iloc[:1], jumps=24, workers=1)
    return one


def test_pick_tells_the_gap_of_a_design_that_was_searched(db):
    trials, one = read_study(db).front().sort_values("height_m")["trial"].tolist(), lowest(db)
    words = " ".join(CliRunner().invoke(cli, ["pick", str(db), "--trial", str(one.trial)]).stdout.split())
    assert f"the best torque found takes {one.controller_gap:.1f} % less for its height" in words
    printed = json.loads(CliRunner().invoke(cli, ["pick", str(db), "--trial", str(one.trial), "--json"]).stdout)
    assert (printed["controller_gap"], printed["controller_gap_held"]) == (one.controller_gap, one.controller_gap_held)
    assert "controller gap" not in CliRunner().invoke(cli, ["pick", str(db), "--trial", str(trials[-1])]).stdout


def test_damage_to_a_stored_limit_is_found(db, tmp_path):
    lowest(db)
    copy = shutil.copy(db, tmp_path / "copy.db")
    with closing(sqlite3.connect(copy)) as connection:
        connection.execute("UPDATE monoped_limits SET result = replace(result, 'energy_j', 'energy_J')")
        connection.commit()
    with pytest.raises(ParetoMonopedError, match="of its limits does not match its hash"):
        verify(copy)


def test_the_command_prints_a_table_of_eighty_columns_and_json(db):
    words = ["limit", str(db), "--designs", "2", "--jumps", "24"]
    done = CliRunner().invoke(cli, words)
    assert done.exit_code == 0, done.output
    lines = done.stdout.splitlines()
    assert max(map(len, lines)) <= 80
    assert "gap %" in lines[1]
    assert re.search(r"(1/1|2/2) designs, 0:00 left", done.stderr)
    printed = json.loads(CliRunner().invoke(cli, [*words, "--json"]).stdout)
    row = lines[2].split()
    first = printed["limits"][0]
    assert [int(row[0]), float(row[1])] == [first["trial"], round(first["height_m"], 3)]
    assert float(row[5]) == round(first["controller_gap"], 1)
    built = next(line for line in lines[4:] if line.split()[:1] == row[:1]).split()
    as_built = first["over_time"]["perturbed"]
    assert built[4:7] == [
        f"{as_built['p05_m']:.3f}-{as_built['p95_m']:.3f}",
        *(f"{100.0 * as_built[name]:.0f}" for name in ("reaches", "holds")),
    ]


def test_a_study_of_profiles_has_no_gap_to_the_virtual_leg(tmp_path):
    file = {"name": "free", "evaluations": 8, "audit": False, "algorithm": {"name": "random", "population": 8}}
    file |= {"controller": {"kind": "torque_over_time", "knots": 6}}
    run(study_from_dict(file, source="test"), tmp_path / "f.db", workers=1)
    with pytest.raises(ParetoMonopedError, match=r"must be .virtual_leg., with which limit compares"):
        limits(tmp_path / "f.db", read_study(tmp_path / "f.db").trials.iloc[:1])


def test_the_command_has_the_defaults_of_the_computation():
    """Its help imports no simulator, so it cannot read them there."""
    defaults = {one.name: one.default for one in cli.get_command(None, "limit").params}
    assert (defaults["designs"], defaults["jumps"]) == (MOST_DESIGNS, JUMPS)
