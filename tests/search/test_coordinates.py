"""Gears as gears: a study searches the list of gearboxes within its bounds, and stores their real ratios."""

import itertools
import json
import sqlite3

import numpy as np
import optuna
import pytest

from pareto_monoped.actuator.motors import load_motor
from pareto_monoped.actuator.search import map_of
from pareto_monoped.definition.study import load_study, study_from_dict
from pareto_monoped.definition.variables import Bounds
from pareto_monoped.design import NAMES, RULE_SETS
from pareto_monoped.errors import StudyError
from pareto_monoped.search.algorithm import Scores
from pareto_monoped.search.registry import make_algorithm
from pareto_monoped.search.space import coordinates_of, gear_list, plain_coordinates
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import resume, run
from pareto_monoped.study.simulator import load_simulator
from tests.study.support import MINIMAL, made_study

MOTORS = ("VT8020", "U8", "U10", "U12", "MN8014", "MAD_M6C12")
ALGORITHMS = ("surrogate", "nsga2", "sms_emoa", "optuna_nsga2", "optuna_tpe", "weighted_cmaes", "random")
KNEE, HIP = NAMES.index("knee_ratio"), NAMES.index("hip_ratio")


@pytest.fixture(scope="module")
def actuator_map():
    return map_of(load_motor("VT8020"), "iso6336")


def listed(**more):
    return made_study(gear_list=True, rules="iso6336", **more)


def searched(study, actuator_map, generations=4):
    """Designs that an algorithm asks for, scored by a plane so that it has something to do."""
    coordinates = coordinates_of(study, actuator_map)
    algorithm, asked = make_algorithm(study, coordinates), []
    for _ in range(generations):
        proposal = algorithm.ask()
        if proposal is None:
            break
        asked.append(proposal.values)
        values = np.column_stack((proposal.values[:, 0], proposal.values.sum(axis=1)))
        algorithm.tell(
            Scores(
                objectives=study.objectives,
                values=values,
                violation=np.zeros(len(values)),
                constraints=np.zeros((len(values), 0)),
            )
        )
    return coordinates, np.vstack(asked)


@pytest.mark.parametrize("rules", RULE_SETS)
@pytest.mark.parametrize("motor", MOTORS)
def test_the_list_has_every_gearbox_that_a_ratio_within_the_bounds_leads_to(motor, rules):
    """Against a fine sweep of ratios; both bounds count."""
    found = map_of(load_motor(motor), rules)
    for lower, upper in ((4.0, 8.7), (5.05, 6.25), (6.0, 6.1)):
        sweep = np.unique(np.concatenate((np.linspace(lower, upper, 5001), [lower, upper])))
        indices = np.unique(found.interval_index(sweep))
        ratios = sorted(found.entries[i].actuator.ratio for i in indices[indices >= 0])
        gears = gear_list(found, Bounds(lower=lower, upper=upper))
        assert [gear.ratio for gear in gears] == ratios
        for gear in gears:
            actuator = found.lookup(gear.ratio)
            assert (actuator.ratio, actuator.mass_kg) == (gear.ratio, gear.mass_kg)


def test_the_upper_bound_itself_is_in_the_list():
    """8.7:1 exists under the paper's rules; a search over ratios below 8.7 never finds it."""
    ratios = [gear.ratio for gear in gear_list(map_of(load_motor("VT8020"), "paper"), Bounds(lower=4.0, upper=8.7))]
    assert ratios[-1] == pytest.approx(8.7)


def test_coordinates_and_designs_are_each_others_inverse(actuator_map):
    coordinates = coordinates_of(listed(), actuator_map)
    space = coordinates.space
    lower, upper = space.edges
    values = space.snap(np.random.default_rng(1).uniform(lower, upper, (500, len(space.names))))
    designs = coordinates.designs(values)
    assert np.array_equal(coordinates.values(designs), values)
    real = {gear.ratio for gear in coordinates.gears["knee_ratio"]}
    assert set(designs[:, KNEE]) == real
    # The real ratio leads to the gearbox of this ratio.
    assert [actuator_map.lookup(ratio).ratio for ratio in designs[:50, HIP]] == designs[:50, HIP].tolist()


def test_a_ratio_between_or_beyond_gearboxes_means_the_nearest(actuator_map):
    coordinates = coordinates_of(listed(), actuator_map)
    space, ratios = coordinates.space, [gear.ratio for gear in coordinates.gears["knee_ratio"]]
    place, designs = space.names.index("knee_ratio"), coordinates.designs(np.zeros((1, len(space.names))))
    for k, (ratio, above) in enumerate(itertools.pairwise(ratios)):
        for share, nearest in ((0.0, k), (0.4, k), (0.6, k + 1), (1.0, k + 1)):
            designs[0, KNEE] = ratio + share * (above - ratio)
            assert coordinates.values(designs)[0, place] == nearest
    for beyond, nearest in ((ratios[0] - 0.3, 0), (ratios[-1] + 0.3, len(ratios) - 1)):
        designs[0, KNEE] = beyond
        assert coordinates.values(designs)[0, place] == nearest


def test_every_gearbox_is_drawn_equally_often(actuator_map):
    study = listed(algorithm={"name": "random", "population": 20000})
    coordinates, values = searched(study, actuator_map, 1)
    place = coordinates.space.names.index("knee_ratio")
    n = len(coordinates.gears["knee_ratio"])
    counts = np.bincount(values[:, place].astype(int), minlength=n)
    # Six standard deviations of a binomial count.
    share = 20000 / n
    assert np.abs(counts - share).max() < 6.0 * np.sqrt(share)


@pytest.mark.parametrize("name", ALGORITHMS)
def test_every_algorithm_chooses_from_the_list(actuator_map, name):
    coordinates, values = searched(listed(algorithm={"name": name}), actuator_map)
    space = coordinates.space
    assert (values >= space.lower).all()
    assert (values <= space.upper).all()
    for name in coordinates.gears:
        column = values[:, space.names.index(name)]
        assert np.array_equal(column, np.round(column))
        assert len(set(column)) > 3


# Searches of one library share what ends them: of pymoo's and of Optuna's, one each every time.
ENDING = [pytest.param(name, marks=pytest.mark.long) for name in ("sms_emoa", "optuna_tpe")]


@pytest.mark.parametrize("name", ["surrogate", "nsga2", "optuna_nsga2", "random", *ENDING])
def test_no_design_is_asked_for_twice_and_the_search_ends_when_there_is_no_other(actuator_map, name):
    """With nothing free but two short lists of gearboxes, all of them are tried once."""
    variables = dict.fromkeys(NAMES[:2], 0.4) | {"knee_ratio": {"lower": 4.0, "upper": 5.0}}
    variables |= {"hip_ratio": {"lower": 5.0, "upper": 5.4}}
    variables |= {"stiffness_n_per_m": 20.0, "damping_n_s_per_m": 2.0, "torsional_stiffness_n_m_per_rad": 10.0}
    study = listed(variables=variables, algorithm={"name": name, "population": 10})
    coordinates, values = searched(study, actuator_map, 60)
    assert len(np.unique(values, axis=0)) == len(values)
    pairs = len(coordinates.gears["knee_ratio"]) * len(coordinates.gears["hip_ratio"])
    assert 0.9 * pairs <= len(values) <= pairs


def test_the_weighted_search_starts_at_the_papers_gearbox(actuator_map):
    study = listed(algorithm={"name": "weighted_cmaes", "population": 2000, "sigma": 0.01})
    coordinates, values = searched(study, actuator_map, 1)
    place = coordinates.space.names.index("knee_ratio")
    ratios = np.array([gear.ratio for gear in coordinates.gears["knee_ratio"]])
    assert np.median(ratios[values[:, place].astype(int)]) == pytest.approx(6.0, abs=0.06)


def test_bounds_without_a_gearbox_are_refused():
    found = map_of(load_motor("MAD_M6C12"), "paper")
    study = made_study(gear_list=True, variables={"knee_ratio": {"lower": 4.0, "upper": 4.05}})
    with pytest.raises(StudyError, match=r"variables.knee_ratio = 4 to 4.05: .*; widen the bounds"):
        coordinates_of(study, found)


def test_a_fixed_ratio_is_stored_as_the_real_one_of_its_gearbox(actuator_map):
    coordinates = coordinates_of(listed(variables={"knee_ratio": 5.17}), actuator_map)
    design = coordinates.designs(coordinates.space.lower[None])[0]
    assert design[KNEE] == actuator_map.lookup(5.17).ratio != 5.17
    plain = plain_coordinates(made_study(variables={"knee_ratio": 5.17}))
    assert plain.designs(plain.space.lower[None])[0, KNEE] == 5.17


STUDY = 'name = "g"\nevaluations = 36\naudit = false\n[algorithm]\nname = "{name}"\npopulation = 12\n'


@pytest.mark.parametrize("name", ["nsga2", "optuna_nsga2"])
def test_a_stored_study_has_real_ratios_and_goes_on_from_them(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "g.toml"
    path.write_text(STUDY.format(name=name))
    study = load_study(path)
    assert study.gear_list
    assert study.as_dict()["gear_list"] is True
    assert study_from_dict(json.loads(json.dumps(study.as_dict())), source="db") == study
    run(study, tmp_path / "whole.db")
    run(study, tmp_path / "parts.db", evaluations=20)
    resume(tmp_path / "parts.db", evaluations=36)
    whole, parts = read_study(tmp_path / "whole.db"), read_study(tmp_path / "parts.db")
    assert whole.trials.equals(parts.trials)
    assert whole.checkpoint == parts.checkpoint
    real = {gear.ratio for gear in whole.coordinates.gears["knee_ratio"]}
    assert set(whole.trials["knee_ratio"]) <= real
    # Any ratio of the interval is the same jump.
    designs = whole.trials[list(NAMES)].to_numpy()[:20]
    moved = designs.copy()
    moved[:, KNEE] = np.floor(np.round(10.0 * moved[:, KNEE], 8)) / 10.0 + 0.05
    again = load_simulator(study, workers=1).evaluator(moved)
    assert np.array_equal(again.height_m, whole.trials["height_m"].to_numpy()[:20], equal_nan=True)
    # Optuna reads them, too.
    trials = optuna.load_study(study_name=None, storage=f"sqlite:///{tmp_path / 'whole.db'}").trials
    assert [trial.params["knee_ratio"] for trial in trials] == whole.trials["knee_ratio"].tolist()
    with sqlite3.connect(tmp_path / "whole.db") as database:
        text = database.execute("SELECT DISTINCT distribution_json FROM trial_params WHERE param_name = 'knee_ratio'")
        (limits,) = (json.loads(row[0]) for row in text)
    assert (limits["low"], limits["high"]) == (min(real), max(real))


def test_studies_of_earlier_versions_search_ratios():
    """A stored study without the key is stored as it was, and its hash stays."""
    study = study_from_dict(MINIMAL, source="db")
    assert not study.gear_list
    assert "gear_list" not in study.as_dict()
    assert plain_coordinates(study).space.gears == {}


def test_no_gearbox_from_outside_stands_in_for_bounds_that_have_none(actuator_map):
    assert [gear.ratio for gear in gear_list(actuator_map, Bounds(lower=8.0, upper=12.0))][-1] == pytest.approx(9.6)
    assert actuator_map.stand_in(9.7)
    assert gear_list(actuator_map, Bounds(lower=9.7, upper=12.0)) == ()
    with pytest.raises(
        StudyError, match=r"variables\.knee_ratio = 9\.7 to 12: VT8020 has no gearbox in \[9\.7, 9\.8\)"
    ):
        coordinates_of(listed(variables={"knee_ratio": {"lower": 9.7, "upper": 12.0}}), actuator_map)
