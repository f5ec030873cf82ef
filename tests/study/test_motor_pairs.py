"""Studies that choose the motors of hip and knee each: definition, coordinates, algorithms, storage, and readers."""

import json
import sqlite3
from functools import cache
from itertools import product
from types import SimpleNamespace

import numpy as np
import optuna
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pareto_monoped.actuator.motors import load_motor
from pareto_monoped.actuator.search import map_of
from pareto_monoped.analysis.verify import verify
from pareto_monoped.definition.study import load_study, study_from_dict
from pareto_monoped.design import NAMES, RATIOS
from pareto_monoped.errors import DatabaseError, StudyError
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.search.registry import make_algorithm
from pareto_monoped.search.response_surface import features_of
from pareto_monoped.search.space import kit_maps, searched_coordinates
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import resume, run
from pareto_monoped.study.simulator import load_simulator
from tests.study.support import assert_refused, change, made_study, search_among_motors, study_of

HIP, KNEE = ("U8", "VT8020"), ("VT8020", "MN8014", "U8")
ALGORITHMS = ("nsga2", "sms_emoa", "age_moea2", "surrogate", "optuna_nsga2", "optuna_tpe", "random")


def pairs(hip=HIP, knee=KNEE, **more):
    listed = [list(names) if isinstance(names, tuple) else names for names in (hip, knee)]
    return made_study(hip_motor=listed[0], knee_motor=listed[1], gear_list=True, rules="iso6336", **more)


def coordinates_for(study):
    maps = [map_of(load_motor(name), study.rules) for name in study.motors]
    return searched_coordinates(study, kit_maps(study, maps))


@cache
def both_chosen():
    return coordinates_for(pairs())


@cache
def knee_chosen():
    return coordinates_for(pairs(hip="U12"))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"motor": "U8", "hip_motor": "U8", "knee_motor": "U10"}, ["motor and hip_motor are both given", "drop one"]),
        ({"motor": ["U8", "U10"], "knee_motor": "U10"}, ["motor and knee_motor are both given", "both joints"]),
        ({"hip_motor": "U8"}, ["hip_motor is given without knee_motor", "name both"]),
        ({"hip_motor": "U8", "knee_motor": ["U8"]}, ["knee_motor = ['U8']", "at least two", 'knee_motor = "U8"']),
        ({"hip_motor": ["U8", "u8"], "knee_motor": "U8"}, ["hip_motor = ['U8', 'u8']", "'u8' once"]),
        ({"hip_motor": 3, "knee_motor": "U8"}, ["hip_motor = 3", "correct it"]),
        (
            {"hip_motor": "U8", "knee_motor": ["U8", "U10"], "algorithm": {"name": "weighted_cmaes"}},
            ["knee_motor = ['U8', 'U10']", "weighted_cmaes searches with one motor"],
        ),
    ],
)
def test_what_does_not_name_the_motors_of_both_joints_is_refused(given, words):
    assert_refused(given, words)


def test_one_motor_named_for_both_joints_is_the_same_study_as_motor():
    """And has the same hash, so that either file continues what the other began."""
    named, short = study_of(hip_motor="U8", knee_motor="u8"), study_of(motor="U8")
    assert named == short
    assert named.as_dict() == short.as_dict()
    assert not {"hip_motor", "knee_motor"} & set(short.as_dict())


def test_the_definition_survives_storage_and_lists_every_pair_once():
    study = pairs()
    assert study_from_dict(json.loads(json.dumps(study.as_dict())), source="stored") == study
    assert "motor" not in study.as_dict()
    assert study.motors == ("U8", "VT8020", "MN8014")
    assert study.kits == tuple(product(HIP, KNEE))
    assert study.motor_choices == ("hip_motor", "knee_motor")
    assert study.motor_text == "hip U8, VT8020; knee VT8020, MN8014, U8"
    assert pairs(hip="U12").motor_choices == ("knee_motor",)


def test_files_of_motors_are_found_beside_the_study_file(tmp_path):
    (tmp_path / "s.toml").write_text(
        'name = "s"\nevaluations = 1\nhip_motor = ["a.toml", "U8"]\nknee_motor = "b.toml"\n'
    )
    assert load_study(tmp_path / "s.toml").motors == (str(tmp_path / "a.toml"), "U8", str(tmp_path / "b.toml"))


def test_two_different_motors_need_no_choice_and_any_algorithm_takes_them():
    study = pairs("U8", "VT8020", algorithm={"name": "weighted_cmaes"})
    coordinates = coordinates_for(study)
    assert coordinates.space.choices == ()
    hip, knee = (coordinates.space.gears[name] for name in ("hip_ratio", "knee_ratio"))
    assert hip[-1].ratio != knee[-1].ratio
    assert make_algorithm(study, coordinates).ask() is not None


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from([both_chosen, knee_chosen]),
    st.lists(st.lists(st.floats(0.0, 1.0), min_size=9, max_size=9), min_size=1, max_size=8),
)
def test_coordinates_and_designs_are_each_others_inverse(where, unit):
    where = where()
    space = where.space
    lower, upper = space.edges
    values = space.snap(lower + np.array(unit)[:, : len(lower)] * (upper - lower))
    assert np.array_equal(space.snap(values), values)
    designs, motors = where.designs(values), where.motors_of(values)
    assert np.array_equal(where.values(designs, motors), values)
    for row, (design, k) in enumerate(zip(designs, where.kits(motors), strict=True)):
        kit = where.maps[k]
        for name, names in motors.items():
            assert kit.of(name.removesuffix("_motor")).motor.name == names[row]
        for ratio in RATIOS:
            real = design[NAMES.index(ratio)]
            assert kit.of(ratio.removesuffix("_ratio")).lookup(real).ratio == real


def test_a_joint_with_one_motor_keeps_its_list_of_whole_numbers():
    space = knee_chosen().space
    assert (space.listed, tuple(space.gears)) == (("knee_ratio",), ("hip_ratio",))
    assert [choice.name for choice in space.choices] == ["knee_motor"]
    assert space.upper[space.names.index("hip_ratio")] == len(space.gears["hip_ratio"]) - 1.0


@pytest.mark.parametrize("where", [both_chosen, knee_chosen], ids=["both", "knee"])
def test_the_surrogate_sees_each_joint_s_own_actuator(where):
    where = where()
    space = where.space
    values = space.snap(np.random.default_rng(1).uniform(*space.edges, (200, len(space.names))))
    features = features_of(space)
    assert np.abs(features.scaled(values)).max() <= 1.0 + 1e-12
    raw = 0.5 * (features.scaled(values) + 1.0) * features.extent + features.lower
    designs, kits = where.designs(values), where.kits_of(values)
    knee = [
        where.maps[k].knee.lookup(design[NAMES.index("knee_ratio")]) for design, k in zip(designs, kits, strict=True)
    ]
    place = space.names.index("knee_ratio")
    assert raw[:, place] == pytest.approx([np.log(a.peak_torque_n_m) for a in knee], rel=1e-9)
    assert raw[:, place + 1] == pytest.approx([np.log(a.no_load_speed_rad_per_s) for a in knee], rel=1e-9)
    hip = [where.maps[k].hip.lookup(design[NAMES.index("hip_ratio")]) for design, k in zip(designs, kits, strict=True)]
    masses = [column for column in raw.T if np.allclose(column, [a.mass_kg for a in hip], rtol=1e-9)]
    assert len(masses) == 1


@pytest.fixture
def interpreted(monkeypatch):
    """AGE-MOEA2's loops, which pymoo compiles for five seconds in every process, run as the Python that they are."""
    from pymoo.algorithms.moo import age, age2

    types = SimpleNamespace(float64=np.float64, intp=np.intp, boolean=np.bool_)
    for module in (age, age2):
        monkeypatch.setattr(module, "numba", types)
        for place in (module, *(each for each in vars(module).values() if isinstance(each, type))):
            for name, function in list(vars(place).items()):
                inner = getattr(function, "__func__", function)
                if hasattr(inner, "py_func"):
                    plain = inner.py_func if inner is function else staticmethod(inner.py_func)
                    monkeypatch.setattr(place, name, plain)


def search(study, generations=6, algorithm=None):
    return search_among_motors(study, coordinates_for(study), (1.0, 2.0), generations, algorithm)


@pytest.mark.parametrize("name", ALGORITHMS)
def test_every_algorithm_asks_for_new_points_and_finds_the_best_pair(interpreted, name):
    study, generations = pairs(algorithm={"name": name, "population": 20}), 3 if name == "optuna_tpe" else 6
    _, history = search(study, generations)
    values, space = np.vstack([asked for asked, _ in history]), both_chosen().space
    assert len(values) == (80 if name == "surrogate" else 20 * generations)
    assert np.array_equal(space.snap(values), values)
    assert len({row.tobytes() for row in values}) == len(values)
    assert len({tuple(row) for row in values[:20, -2:]}) > 3
    if name != "random":
        best = (values[:, -2] == 1.0) & (values[:, -1] == 2.0)
        assert best[-20:].mean() > best[:20].mean()


@pytest.mark.parametrize("name", ALGORITHMS)
def test_restored_from_state_and_history_it_continues_alike(interpreted, name):
    study = pairs(algorithm={"name": name, "population": 10})
    told, more = (3, 2) if name == "optuna_tpe" else (5, 3)
    first, history = search(study, told)
    again = make_algorithm(study, coordinates_for(study))
    again.restore(json.loads(json.dumps(first.state())), history)
    for (values, _), (expected, _) in zip(
        search(study, more, algorithm=again)[1], search(study, more, algorithm=first)[1], strict=True
    ):
        assert np.array_equal(values, expected)


@pytest.fixture(scope="module")
def db(tmp_path_factory):
    path = tmp_path_factory.mktemp("pairs") / "s.db"
    run(pairs(evaluations=60, audit=False, algorithm={"name": "nsga2", "population": 20}), path)
    return path


@pytest.mark.long
def test_the_database_names_the_motors_of_each_design(db):
    data = read_study(db)
    with sqlite3.connect(db) as connection:
        stored = connection.execute("SELECT motor, hip_motor, knee_motor FROM monoped_trials ORDER BY trial").fetchall()
    assert [row[1:] for row in stored] == list(zip(data.trials["hip_motor"], data.trials["knee_motor"], strict=True))
    assert {row[0] for row in stored} == {None}
    assert set(data.trials["hip_motor"]) == set(HIP)
    assert set(data.trials["knee_motor"]) == set(KNEE)
    for trial in data.trials["trial"][:20]:
        row, kit = data.trials.iloc[trial], data.kit_of_trial(trial)
        assert (kit.hip.motor.name, kit.knee.motor.name) == (row["hip_motor"], row["knee_motor"])
        assert row["motor"] == kit.label
        for joint in ("hip", "knee"):
            assert kit.of(joint).lookup(row[f"{joint}_ratio"]).ratio == row[f"{joint}_ratio"]


def test_every_stored_measure_is_that_of_the_design_with_its_motors(db):
    data, seen = read_study(db), 0
    for kit, rows in data.kit_rows(data.trials):
        members = data.trials.iloc[rows]
        again = Evaluator(kit, data.calibration)(members[list(NAMES)].to_numpy())
        for name in ("height_m", "energy_j", "mass_kg", "gear_safety"):
            assert getattr(again, name).tobytes() == members[name].to_numpy().tobytes()
        seen += len(rows)
    assert seen == len(data.trials)


def test_optuna_sees_two_categorical_distributions(db):
    study = optuna.load_study(study_name="made", storage=f"sqlite:///{db}")
    trials = read_study(db).trials
    for name, motors in (("hip_motor", HIP), ("knee_motor", KNEE)):
        assert [trial.params[name] for trial in study.trials] == trials[name].tolist()
        assert study.trials[0].distributions[name] == optuna.distributions.CategoricalDistribution(motors)


def test_optuna_s_tables_are_checked_against_both_motors_and_jumps_made_again(db, tmp_path):
    assert verify(db, simulate=20).findings == ()
    copy = tmp_path / "copy.db"
    copy.write_bytes(db.read_bytes())
    change(
        copy,
        "UPDATE trial_params SET param_value = 1 - param_value WHERE param_name = 'hip_motor' AND trial_id = 4",
    )
    assert any("hip_motor" in line for line in verify(copy).findings)


def test_a_database_with_an_unknown_motor_is_damaged(db, tmp_path):
    copy = tmp_path / "copy.db"
    copy.write_bytes(db.read_bytes())
    change(copy, "UPDATE monoped_trials SET hip_motor = 'MN8014' WHERE trial = 5")
    with pytest.raises(DatabaseError, match="hip motor 'MN8014' is not of the study"):
        read_study(copy)


def test_other_lists_are_refused_on_resume(db):
    """With the same motors at other joints, too."""
    for hip, knee in ((KNEE, HIP), (HIP[::-1], KNEE), (HIP, KNEE[:2])):
        study = pairs(hip, knee, evaluations=60, audit=False, algorithm={"name": "nsga2", "population": 20})
        with pytest.raises(StudyError, match=r"motor"):
            run(study, db)


def test_stopped_within_a_generation_and_resumed_it_is_as_in_one_go(db, tmp_path):
    study = pairs(evaluations=60, audit=False, algorithm={"name": "nsga2", "population": 20})
    path = tmp_path / "cut.db"
    run(study, path, evaluations=27)
    assert len(read_study(path).trials) == 27
    resume(path, evaluations=60)
    assert read_study(path).trials.equals(read_study(db).trials)
    assert read_study(path).front().equals(read_study(db).front())


def test_a_fixed_pair_stores_no_motor_and_reads_both(tmp_path):
    path = tmp_path / "fixed.db"
    run(pairs("U8", "VT8020", evaluations=8, algorithm={"name": "random", "population": 8}, audit=False), path)
    with sqlite3.connect(path) as connection:
        stored = connection.execute("SELECT DISTINCT motor, hip_motor, knee_motor FROM monoped_trials").fetchall()
    assert stored == [(None, None, None)]
    data = read_study(path)
    assert set(data.trials["motor"]) == {"U8 hip, VT8020 knee"}
    assert (set(data.trials["hip_motor"]), set(data.trials["knee_motor"])) == ({"U8"}, {"VT8020"})
    assert data.case_kit.label == "U8 hip, VT8020 knee"


def test_a_stored_pair_of_motors_is_the_simulator_again(db):
    data = read_study(db)
    assert list(data.meta.contents) == ["motor_1", "motor_2", "motor_3", "calibration"]
    fresh = load_simulator(data.study, workers=1)
    assert [kit.label for kit in fresh.evaluator.actuator_maps] == [kit.label for kit in data.kits]
    assert len(data.meta.probe) == 8 * len(HIP) * len(KNEE)
