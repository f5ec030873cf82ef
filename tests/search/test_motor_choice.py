"""Studies that choose from several motors: definition, coordinates, algorithms, storage, and what reads them."""

import json
import shutil
import sqlite3
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import optuna
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pareto_monoped.actuator.motors import load_motor
from pareto_monoped.actuator.search import map_of
from pareto_monoped.definition.study import load_study, study_from_dict
from pareto_monoped.design import NAMES, RATIOS
from pareto_monoped.errors import DatabaseError, MotorError, StudyError
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.search.registry import make_algorithm
from pareto_monoped.search.response_surface import features_of
from pareto_monoped.search.space import exchanged, mutated, searched_coordinates
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.store import Store, create_database
from pareto_monoped.study.run import resume, run
from pareto_monoped.study.simulator import load_simulator
from tests.study.support import (
    assert_refused,
    change,
    made_evaluations,
    made_generation,
    made_meta,
    made_study,
    reseal,
    search_among_motors,
    study_of,
)

DATA = Path(__file__).parents[1] / "storage" / "data"
MOTORS = ("VT8020", "U8", "MN8014")
ALL = ("VT8020", "U8", "U12", "MN8014")
# AGE-MOEA2 compiles itself for some five seconds in every process, and TPE is slow; test_motor_pairs.py has both.
SLOW = tuple(pytest.param(name, marks=pytest.mark.long) for name in ("age_moea2", "optuna_tpe"))
ALGORITHMS = ("nsga2", "sms_emoa", "surrogate", "optuna_nsga2", "random", *SLOW)


def several(motors=MOTORS, **more):
    return made_study(motor=list(motors), gear_list=True, rules="iso6336", **more)


def coordinates_for(study):
    return searched_coordinates(study, [map_of(load_motor(name), study.rules) for name in study.motors])


@cache
def of_all():
    """Coordinates of four motors, whose maps take two seconds."""
    return coordinates_for(several(ALL))


@pytest.mark.parametrize(
    ("motor", "words"),
    [
        ([], ["motor = []", "at least two motors", "name the motors to choose from"]),
        (["U8"], ["motor = ['U8']", "at least two motors", 'motor = "U8"']),
        (["U8", "U10", "u8"], ["a list of different motors", "'u8' once"]),
        (["U8", 3], ["motor = ['U8', 3]", "correct it"]),
        ("", ["motor = ''", "correct it"]),
        ({"hip": "U8"}, ["motor = {'hip': 'U8'}", "correct it"]),
    ],
)
def test_what_is_no_motor_and_no_list_is_refused(motor, words):
    assert_refused({"motor": motor}, words)


def test_an_unknown_motor_of_a_list_is_named():
    with pytest.raises(MotorError, match="motor = 'U9': must be one of VT8020, U8") as caught:
        load_simulator(study_of(motor=["U8", "U9"]), workers=1)
    assert "\n" not in str(caught.value)


def test_two_files_of_one_motor_s_name_are_refused(tmp_path):
    for name in ("a", "b"):
        shutil.copy(DATA / "my_motor.toml", tmp_path / f"{name}.toml")
    (tmp_path / "s.toml").write_text('name = "s"\nevaluations = 1\nmotor = ["a.toml", "b.toml"]\n')
    study = load_study(tmp_path / "s.toml")
    assert study.motors == (str(tmp_path / "a.toml"), str(tmp_path / "b.toml"))
    with pytest.raises(StudyError, match="'MyMotor' is the name of 2") as caught:
        load_simulator(study, workers=1)
    assert "\n" not in str(caught.value)


def test_the_weighted_search_refuses_several_motors():
    assert_refused(
        {"motor": ["U8", "U10"], "algorithm": {"name": "weighted_cmaes"}},
        ["motor = ['U8', 'U10']", "weighted_cmaes searches with one motor", "another algorithm"],
    )


def test_a_list_survives_storage_and_one_motor_is_stored_as_before():
    study = several()
    assert study_from_dict(json.loads(json.dumps(study.as_dict())), source="stored") == study
    assert study_of(motor="U8").as_dict()["motor"] == "U8"


@settings(max_examples=100, deadline=None)
@given(st.lists(st.lists(st.floats(0.0, 1.0), min_size=8, max_size=8), min_size=1, max_size=8))
def test_coordinates_and_designs_are_each_others_inverse(unit):
    space = of_all().space
    lower, upper = space.edges
    values = space.snap(lower + np.array(unit) * (upper - lower))
    assert np.array_equal(space.snap(values), values)
    designs, motors = of_all().designs(values), of_all().motors_of(values)
    assert np.array_equal(of_all().values(designs, motors), values)
    for design, k in zip(designs, of_all().kits(motors), strict=True):
        for ratio in RATIOS:
            real = design[NAMES.index(ratio)]
            assert of_all().maps[k].of(ratio.removesuffix("_ratio")).lookup(real).ratio == real


@pytest.mark.parametrize("motor", range(len(ALL)))
def test_both_ends_of_every_list_and_all_between_are_reached_in_equal_shares(motor):
    space = of_all().space
    place, gears = space.names.index("knee_ratio"), space.choices[0].motors[motor].gears["knee_ratio"]
    values = np.tile(space.lower, (20001, 1))
    values[:, place], values[:, -1] = np.linspace(0.0, 1.0, len(values)), motor
    ratios = of_all().designs(space.snap(values))[:, NAMES.index("knee_ratio")]
    assert ratios[0] == gears[0].ratio
    assert ratios[-1] == gears[-1].ratio
    found, counts = np.unique(ratios, return_counts=True)
    assert found.tolist() == [gear.ratio for gear in gears]
    assert np.ptp(counts) <= 2


def test_changing_the_motor_keeps_the_place_in_the_list():
    space = of_all().space
    values = np.tile(space.lower, (len(ALL), 1))
    values[:, -1] = np.arange(len(ALL))
    for share in (0.0, 1.0):
        values[:, space.names.index("hip_ratio")] = share
        ratios = of_all().designs(space.snap(values))[:, NAMES.index("hip_ratio")]
        lists = [motor.gears["hip_ratio"] for motor in space.choices[0].motors]
        assert ratios.tolist() == [gears[-1 if share else 0].ratio for gears in lists]


def test_limits_of_a_variable_hold_every_design_of_every_motor():
    space = of_all().space
    values = np.tile(space.lower, (2 * len(ALL), 1))
    values[:, -1] = np.tile(np.arange(len(ALL)), 2)
    for name in space.names[:-1]:
        ends = values.copy()
        ends[len(ALL) :, space.names.index(name)] = space.upper[space.names.index(name)]
        found = of_all().designs(ends)[:, NAMES.index(name)]
        assert of_all().limits(name) == (found.min(), found.max())
    assert len({gears[-1].ratio for gears in (m.gears["hip_ratio"] for m in space.choices[0].motors)}) > 1


def test_a_fixed_ratio_is_each_motor_s_own_real_one():
    coordinates = coordinates_for(several(variables={"knee_ratio": 5.17}))
    values = coordinates.space.snap(np.tile(coordinates.space.lower, (3, 1)))
    values[:, -1] = [0, 1, 2]
    ratios = coordinates.designs(values)[:, NAMES.index("knee_ratio")]
    assert ratios.tolist() == [one.knee.lookup(5.17).ratio for one in coordinates.maps]


@given(st.lists(st.tuples(st.integers(0, 5), st.integers(0, 5)), min_size=1, max_size=40), st.integers(0, 2**32))
def test_children_have_the_motors_of_their_parents(pairs, seed):
    parents = np.array(pairs, dtype=float).T
    children = exchanged(parents, np.random.default_rng(seed))
    assert np.array_equal(np.sort(children, axis=0), np.sort(parents, axis=0))


def test_a_mutation_takes_any_other_motor_alike():
    choices = np.full(60000, 2.0)
    result = mutated(choices, 6, 0.5, np.random.default_rng(1))
    counts = np.bincount(result.astype(int), minlength=6)
    # Six standard deviations of binomial counts.
    assert abs(counts[2] - 30000) < 6 * np.sqrt(15000)
    assert np.abs(np.delete(counts, 2) - 6000).max() < 6 * np.sqrt(6000)


def search(study, generations=6, algorithm=None):
    return search_among_motors(study, coordinates_for(study), (1.0,), generations, algorithm)


@pytest.mark.parametrize("name", ALGORITHMS)
def test_every_algorithm_asks_for_points_of_the_space_and_for_none_twice(name):
    study = several(ALL, algorithm={"name": name, "population": 20})
    _, history = search(study)
    values, space = np.vstack([asked for asked, _ in history]), of_all().space
    assert len(values) == (80 if name == "surrogate" else 120)  # whose generations begin with half as many
    assert np.array_equal(space.snap(values), values)
    assert len({row.tobytes() for row in values}) == len(values)
    assert len(set(values[:20, -1])) > 3
    if name != "random":
        assert (values[-40:, -1] == 1.0).mean() > (values[:20, -1] == 1.0).mean()


@pytest.mark.parametrize("name", ALGORITHMS)
def test_restored_from_state_and_history_it_continues_alike(name):
    study = several(algorithm={"name": name, "population": 10})
    first, history = search(study, 5)
    again = make_algorithm(study, coordinates_for(study))
    again.restore(json.loads(json.dumps(first.state())), history)
    for (values, _), (expected, _) in zip(
        search(study, 3, algorithm=again)[1], search(study, 3, algorithm=first)[1], strict=True
    ):
        assert np.array_equal(values, expected)


# For all kinds of algorithms, with gearboxes alone: test_coordinates.py.
ENDING = [pytest.param(name, marks=pytest.mark.long) for name in ("nsga2", "optuna_nsga2")]


@pytest.mark.parametrize("name", ["surrogate", "random", *ENDING])
def test_a_search_ends_when_every_design_with_every_motor_was_tried(name):
    variables = dict.fromkeys(NAMES[:2], 0.4) | {"hip_ratio": 6.0, "knee_ratio": {"lower": 4.0, "upper": 5.0}}
    variables |= {"stiffness_n_per_m": 50.0, "damping_n_s_per_m": 2.5, "torsional_stiffness_n_m_per_rad": 10.0}
    study = several(algorithm={"name": name, "population": 4}, variables=variables)
    space = coordinates_for(study).space
    _, history = search(study, 60)
    values = np.vstack([asked for asked, _ in history])
    total = sum(len(motor.gears["knee_ratio"]) for motor in space.choices[0].motors)
    assert len({row.tobytes() for row in values}) == len(values) == total


def test_the_surrogate_tells_actuators_apart_by_what_they_do():
    """Greatest torque and speed at the joint and mass, against the actuators themselves."""
    space = of_all().space
    values = space.snap(np.random.default_rng(1).uniform(*space.edges, (200, len(space.names))))
    features = features_of(space)
    assert len(features.lower) == 5 + 2 * 3
    scaled = features.scaled(values)
    assert np.abs(scaled).max() <= 1.0 + 1e-12
    knee = space.names.index("knee_ratio")
    designs, kits = of_all().designs(values), of_all().kits_of(values)
    actuators = [of_all().maps[k].knee.lookup(d[NAMES.index("knee_ratio")]) for d, k in zip(designs, kits, strict=True)]
    for place, known in (
        (knee, [np.log(a.peak_torque_n_m) for a in actuators]),
        (knee + 1, [np.log(a.no_load_speed_rad_per_s) for a in actuators]),
        (knee + 2, [a.mass_kg for a in actuators]),
    ):
        raw = 0.5 * (scaled[:, place] + 1.0) * features.extent[place] + features.lower[place]
        assert raw == pytest.approx(known, rel=1e-9)


@pytest.fixture(scope="module")
def db(tmp_path_factory):
    path = tmp_path_factory.mktemp("motors") / "s.db"
    run(several(ALL, evaluations=60, audit=False, algorithm={"name": "nsga2", "population": 20}), path)
    return path


def test_the_database_names_the_motor_of_each_design(db):
    data = read_study(db)
    assert set(data.trials["motor"]) <= set(ALL)
    assert data.trials["motor"].nunique() > 3
    with sqlite3.connect(db) as connection:
        stored = [row[0] for row in connection.execute("SELECT motor FROM monoped_trials ORDER BY trial")]
    assert stored == data.trials["motor"].tolist()
    assert [motor.name for motor in data.motors] == list(ALL)
    for trial in data.trials["trial"][:20]:
        row = data.trials.iloc[trial]
        kit = data.kit_of_trial(trial)
        assert [motor.name for motor in kit.motors] == [row["motor"]]
        assert kit.knee.lookup(row["knee_ratio"]).ratio == row["knee_ratio"]


def test_every_stored_measure_is_that_of_the_design_with_its_motor(db):
    data = read_study(db)
    for kit, rows in data.kit_rows(data.trials):
        members = data.trials.iloc[rows]
        again = Evaluator(kit, data.calibration)(members[list(NAMES)].to_numpy())
        for name in ("height_m", "energy_j", "mass_kg", "gear_safety"):
            assert getattr(again, name).tobytes() == members[name].to_numpy().tobytes()


def test_optuna_sees_a_categorical_distribution(db):
    study = optuna.load_study(study_name="made", storage=f"sqlite:///{db}")
    trials = read_study(db).trials
    assert len(study.trials) == len(trials)
    for trial, name in zip(study.trials, trials["motor"], strict=True):
        assert trial.params["motor"] == name
        assert trial.distributions["motor"] == optuna.distributions.CategoricalDistribution(ALL)
    assert {trial.number for trial in study.best_trials} >= set(read_study(db).front()["trial"])


def test_tables_that_optuna_writes_itself_say_the_same(db, tmp_path):
    texts = []
    for schemas in ((), ("v3.2.0.a",)):
        study, path = several(), tmp_path / f"{len(schemas)}.db"
        coordinates = coordinates_for(study)
        create_database(path, study, made_meta(study), {})
        generation = made_generation(study, 0, 0, made_evaluations([0.8, 0.9, 1.0], [9.0, 10.0, 11.0]), state={})
        values = coordinates.space.snap(np.tile(coordinates.space.lower, (3, 1)))
        generation = replace(
            generation, designs=coordinates.designs(values), motors={"motor": ("U8", "VT8020", "MN8014")}
        )
        with Store(path, study, coordinates=coordinates, known_schemas=schemas) as store:
            store.add(generation)
        stored = optuna.load_study(study_name="made", storage=f"sqlite:///{path}")
        texts.append([(trial.params, trial.distributions, trial.values) for trial in stored.trials])
    assert texts[0] == texts[1]
    assert [params["motor"] for params, _, _ in texts[0]] == ["U8", "VT8020", "MN8014"]


def test_a_database_with_an_unknown_motor_is_damaged(db, tmp_path):
    copy = tmp_path / "copy.db"
    copy.write_bytes(db.read_bytes())
    with sqlite3.connect(copy) as connection:
        connection.execute("UPDATE monoped_trials SET motor = 'U9' WHERE trial = 5")
    with pytest.raises(DatabaseError, match="motor 'U9' is not of the study"):
        read_study(copy)


def test_another_list_or_order_is_refused_on_resume(db):
    """The order decides what an algorithm's numbers mean."""
    for motors in (("U8", "VT8020", *ALL[2:]), ALL[:-1]):
        study = several(motors, evaluations=60, audit=False, algorithm={"name": "nsga2", "population": 20})
        with pytest.raises(StudyError, match=r"motor_\d"):
            run(study, db)


def test_stopped_within_a_generation_and_resumed_it_is_as_in_one_go(db, tmp_path):
    study = several(ALL, evaluations=60, audit=False, algorithm={"name": "nsga2", "population": 20})
    path = tmp_path / "cut.db"
    run(study, path, evaluations=27)
    trials = read_study(path).trials
    assert len(trials) == 27
    # Stored motors are compared with those that the search asks for again.
    shutil.copy(path, tmp_path / "bent.db")
    one = next(name for name in ALL if name != trials["motor"][25])
    change(tmp_path / "bent.db", f"UPDATE monoped_trials SET motor = '{one}' WHERE trial = 25")
    reseal(tmp_path / "bent.db")
    with pytest.raises(DatabaseError, match="trials 20 to 26 do not follow"):
        resume(tmp_path / "bent.db", evaluations=60)
    resume(path, evaluations=60)
    assert read_study(path).trials.equals(read_study(db).trials)
    assert read_study(path).front().equals(read_study(db).front())


def test_a_study_of_one_motor_stores_no_motor_and_reads_its_name(tmp_path):
    path = tmp_path / "one.db"
    run(made_study(motor="U8", evaluations=8, algorithm={"name": "random", "population": 8}, audit=False), path)
    with sqlite3.connect(path) as connection:
        assert connection.execute("SELECT DISTINCT motor FROM monoped_trials").fetchall() == [(None,)]
        names = {row[0] for row in connection.execute("SELECT param_name FROM trial_params")}
    assert "motor" not in names
    data = read_study(path)
    assert set(data.trials["motor"]) == {"U8"}
    assert data.case_kit.label == "U8"
    assert list(data.meta.contents) == ["motor", "calibration"]
