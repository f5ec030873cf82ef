"""The sensitivity of a trial of a small real study: against plain jumps, stored, checked, and on the command line."""

import json
import shutil
import sqlite3
from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.analysis import sensitivity as module
from pareto_monoped.analysis.sensitivity import importances, sensitivity
from pareto_monoped.analysis.verify import verify
from pareto_monoped.cli import _run as cli
from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.design import NAMES
from pareto_monoped.errors import DatabaseError, InputError, SelectionError
from pareto_monoped.storage.extra_rows import read_sensitivity
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import run
from pareto_monoped.study.simulator import stored_simulator
from pareto_monoped.uncertainty.samples import DIMENSIONS, samples_at, variations
from pareto_monoped.uncertainty.settings import load_uncertainty

RANGES = load_uncertainty()


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A study of 30 trials, and the sensitivity of the highest of its front."""
    db = tmp_path_factory.mktemp("sensitivity") / "s.db"
    file = {"name": "s", "evaluations": 30, "audit": False, "strength": True, "algorithm": {"name": "random"}}
    holding = {"knee_ratio": {"lower": 4.0, "upper": 6.0}, "knee_release_rad": {"lower": 0.3, "upper": 1.0}}
    file |= {"gear_list": True, "rules": "iso6336", "variables": holding}
    run(study_from_dict(file, source="test"), db, workers=1)
    trial = int(read_study(db).front()["trial"].iloc[-2])
    return db, trial, sensitivity(db, trial, RANGES, blocks=32, workers=1)


@pytest.fixture
def db(made, tmp_path):
    shutil.copy(made[0], tmp_path / "s.db")
    return tmp_path / "s.db"


def design_of(data, trial):
    return data.trials.set_index("trial").loc[trial, list(NAMES)].to_numpy(dtype=np.float64)


def test_the_change_of_an_assumption_is_that_of_two_plain_jumps(made):
    """From one end of the mass of the thigh to the other, all else in the middle; the jump is nearly linear there."""
    db, trial, (_, assumptions) = made
    data = read_study(db)
    middle = np.full((2, sum(count for _, count in DIMENSIONS)), 0.5)
    middle[:, 1] = [0.0, 1.0]
    built = variations(samples_at(RANGES, middle), 1, data.calibration)
    jumps = stored_simulator(data, workers=1).evaluator(np.tile(design_of(data, trial), (2, 1)), variations=built)
    found = next(one for one in assumptions.factors if one.factor.label == "mass of the thigh")
    for name in ("height_m", "energy_j"):
        low, high = getattr(jumps, name)
        assert found.measures[name].change == pytest.approx(high - low, rel=0.2, abs=2e-4 * low)
    assert found.measures["height_m"].change < 0.0


def test_the_change_of_a_variable_is_that_of_two_plain_jumps(made):
    db, trial, (variables, _) = made
    data = read_study(db)
    found = next(one for one in variables.factors if one.factor.name == "stiffness_n_per_m")
    ends = np.tile(design_of(data, trial), (2, 1))
    ends[:, NAMES.index("stiffness_n_per_m")] = [found.factor.lower, found.factor.upper]
    low, high = stored_simulator(data, workers=1).evaluator(ends).height_m
    assert found.measures["height_m"].change == pytest.approx(high - low, rel=0.3, abs=3e-4)


def test_variables_move_within_their_bounds_and_gearboxes_to_their_neighbours(made):
    db, trial, (variables, _) = made
    data = read_study(db)
    design = data.trials.set_index("trial").loc[trial]
    assert [one.factor.name for one in variables.factors] == list(data.study.free)
    for one in variables.factors:
        name, bounds = one.factor.name, data.study.variables[one.factor.name]
        low, high = one.factor.lower, one.factor.upper
        assert low <= design[name] <= high
        if name.endswith("_ratio"):
            listed = [gear.ratio for gear in data.coordinates.gears[name]]
            at = listed.index(design[name])
            assert (low, high) == (listed[max(at - 1, 0)], listed[min(at + 1, len(listed) - 1)])
        else:
            step = 0.02 * (bounds.upper - bounds.lower)
            assert low == pytest.approx(max(design[name] - step, bounds.lower))
            assert high == pytest.approx(min(design[name] + step, bounds.upper))


def test_all_ten_assumptions_are_there(made):
    _, _, (_, assumptions) = made
    assert {one.factor.name.partition(".")[0] for one in assumptions.factors} == set(RANGES.ranges)
    assert len(assumptions.factors) == sum(count for _, count in DIMENSIONS)
    tolerances = {one.factor.label for one in assumptions.factors if one.factor.tolerance}
    assert {"mass of the base", "length of the shank", "joint friction"} <= tolerances
    assert not {"delay", "battery voltage", "gain K"} & tolerances


def test_a_range_of_nothing_is_left_out(db, made):
    from dataclasses import replace

    still = replace(RANGES, delay_s=replace(RANGES.delay_s, upper=0.0))
    _, assumptions = sensitivity(db, made[1], still, blocks=32, workers=1)
    assert "delay" not in [one.factor.label for one in assumptions.factors]


def test_it_is_stored_and_not_made_again(made, db, monkeypatch):
    _, trial, found = made
    stored = read_sensitivity(db)
    assert {key: one.result for key, one in stored.items()} == {(trial, one.about): one for one in found}
    assert stored[trial, "assumptions"].settings["uncertainty"] == RANGES.as_dict()
    asked = []
    monkeypatch.setattr(module, "indices", lambda *given: asked.append(given))
    assert sensitivity(db, trial, RANGES, blocks=32, workers=1) == found
    assert asked == []
    with pytest.raises(AttributeError):
        sensitivity(db, trial, RANGES, blocks=32, seed=2, workers=1)
    assert len(asked) == 1


@pytest.mark.long
def test_workers_change_no_number(made, tmp_path):
    db, trial, found = made
    copy = tmp_path / "copy.db"
    shutil.copy(db, copy)
    with sqlite3.connect(copy) as connection:
        connection.execute("UPDATE monoped_sensitivity SET settings = settings")
    connection.close()
    # Another reach of the variables makes them anew; the assumptions at another seed, and then as before.
    sensitivity(copy, trial, RANGES, blocks=32, seed=9, within=0.01, workers=2)
    assert sensitivity(copy, trial, RANGES, blocks=32, workers=2) == found


def test_the_study_stays_sound_and_damage_is_found(db):
    assert verify(db).findings == ()
    with sqlite3.connect(db) as connection:
        connection.execute("UPDATE monoped_sensitivity SET result = replace(result, '\"jumps\":', '\"jumps\": 1')")
    connection.close()
    for reader in (read_sensitivity, verify):
        with pytest.raises(DatabaseError, match="does not match its hash"):
            reader(db)


def test_a_study_without_any_has_none(tmp_path):
    from tests.study.support import made_database

    made_database(tmp_path / "s.db")
    assert read_sensitivity(tmp_path / "s.db") == {}


def test_what_cannot_be_asked_is_refused(db, made):
    with pytest.raises(SelectionError, match="trial = 999: must be a trial of the study that jumped"):
        sensitivity(db, 999, RANGES)
    with pytest.raises(InputError, match=r"within = 0\.6: must be a share above 0"):
        sensitivity(db, made[1], RANGES, within=0.6)


def test_the_command_prints_tables_of_80_columns_and_writes_a_chart(db, made, tmp_path, capsys):
    _, trial, (variables, assumptions) = made
    chart = tmp_path / "s.html"
    command = ["sensitivity", str(db), "--trial", str(trial), "--samples", "32", "--plot", str(chart)]
    assert cli(command) == 0
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    first = lines.index(f"assumptions about the robot as built, around trial {trial} ({assumptions.jumps} jumps)")
    ranked = assumptions.ranked("height_m")
    for line, one in zip(lines[first + 2 :], ranked, strict=False):
        assert line.startswith(one.factor.label)
        assert one.factor.text in line
        influence = one.measures["height_m"]
        assert f"{1000.0 * influence.change:+.1f}" in line
        ends = [min(max(influence.total + k * influence.error, 0.0), 1.0) for k in (-1, 1)]
        wide = ends[1] == 1.0 or influence.error > 0.1
        middle = f"{100.0 * influence.total:.0f}+-{100.0 * influence.error:.0f}"
        assert (f"{100.0 * ends[0]:.0f}..{100.0 * ends[1]:.0f}" if wide else middle) in line
    made_first, second = [one for one in ranked if one.factor.tolerance][:2]
    words = " ".join(" ".join(lines).split())
    assert f"the manufacturing tolerance that matters most: for height {made_first.factor.label}" in words
    pair = (made_first.measures["height_m"], second.measures["height_m"])
    low, high = pair[0].total - pair[0].error, pair[1].total + pair[1].error
    alike = f"{made_first.factor.label} or {second.factor.label}, which 32 samples do not tell apart"
    assert (f"for height {alike}" in words) == (low < high)
    text = chart.read_text(encoding="utf-8")
    assert "plotly" in text
    assert all(one.factor.label in text for one in (*variables.factors, *assumptions.factors))
    assert 'src="http' not in text
    assert cli([*command[:-2], "--json"]) == 0
    shown = json.loads(capsys.readouterr().out)
    assert shown["trial"] == trial
    assert shown["assumptions"]["factors"][0]["measures"].keys() == assumptions.factors[0].measures.keys()


def test_the_design_can_be_chosen_as_elsewhere(db, made, capsys):
    """The highest jump at most as costly as the design itself is the design."""
    _, trial, _ = made
    energy = float(read_study(db).trials.set_index("trial").loc[trial, "energy_j"])
    assert cli(["sensitivity", str(db), "--max-energy", str(energy), "--samples", "32", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["trial"] == trial


def test_the_importance_of_a_variable_is_seen_over_the_whole_study(tmp_path):
    """Each measure is made of one variable alone; a third variable decides nothing."""
    from tests.study.support import made_database, made_evaluations, made_generation, made_study

    study = made_study(evaluations=400)
    jumps = made_evaluations(np.full(400, 0.9), np.full(400, 20.0))
    made_database(tmp_path / "s.db", [made_generation(study, 0, 0, jumps)], study)
    data = read_study(tmp_path / "s.db")
    rng = np.random.default_rng(1)
    drawn = {name: rng.uniform(0.3, 0.5, 400) for name in ("thigh_length_m", "shank_length_m", "damping_n_s_per_m")}
    trials = data.trials.assign(**drawn)
    trials = trials.assign(height_m=trials["thigh_length_m"], energy_j=-trials["shank_length_m"])
    found = importances(replace(data, trials=trials), ["height_m", "energy_j", "drift_m"])
    assert max(found["height_m"], key=found["height_m"].get) == "thigh_length_m"
    assert max(found["energy_j"], key=found["energy_j"].get) == "shank_length_m"
    assert found["height_m"]["thigh_length_m"] > 0.9
    assert sum(found["energy_j"].values()) == pytest.approx(1.0)
    assert importances(replace(data, trials=trials.iloc[:20]), ["height_m"]) == {}
