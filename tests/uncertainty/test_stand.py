"""Ranges of the test stand: drawn where the calibration has one, and without any trace elsewhere."""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.analysis.robustness import robust
from pareto_monoped.analysis.sensitivity import sensitivity
from pareto_monoped.definition.study import Study, study_from_dict
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.storage.extra_rows import read_robustness
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import run
from pareto_monoped.uncertainty.samples import RobustEvaluator, sobol_samples, variations
from pareto_monoped.uncertainty.settings import Range, Sampling, load_uncertainty, sampling_of

PLAIN = load_uncertainty()
STAND = PLAIN.where(stand=True)
CASES = np.array([case.design.as_array() for case in PAPER_CASES.values()])
MINE = Range(lower=0.0, upper=0.3, source="scales")


def test_the_ranges_are_there_with_a_stand_only():
    assert set(STAND.ranges) - set(PLAIN.ranges) == {"stand_mass", "rail_friction"}
    assert (STAND.stand_mass.lower, STAND.stand_mass.upper) == (-0.05, 0.15)
    assert (STAND.rail_friction.lower, STAND.rail_friction.upper) == (-0.6, 0.6)
    assert "stand_mass" not in PLAIN.as_dict()
    assert STAND.where(stand=False) == PLAIN
    own = replace(PLAIN, stand_mass=MINE).where(stand=True)
    assert (own.stand_mass, own.rail_friction) == (MINE, STAND.rail_friction)


def test_without_a_stand_the_points_are_those_of_twenty_one_coordinates():
    """With a stand there are two more coordinates, which fill their ranges evenly."""
    from scipy.stats import qmc

    generator = qmc.Sobol(d=21, scramble=True, rng=np.random.default_rng(4))
    np.testing.assert_array_equal(sobol_samples(PLAIN, 16, 4).points, generator.random_base2(4))
    drawn = sobol_samples(STAND, 16, 4)
    assert drawn.points.shape == (16, 23)
    for name in ("stand_mass", "rail_friction"):
        ends = STAND.ranges[name]
        cells = np.floor(16 * (drawn.values[name][:, 0] - ends.lower) / (ends.upper - ends.lower) + 1e-9)
        assert sorted(cells) == list(range(16))


def test_a_study_on_the_stand_stores_its_ranges_and_another_study_none():
    for name, has in (("stand", True), ("stand-2", True), ("stand-1", True), ("reference", False)):
        study = Study.define(name="s", evaluations=40, calibration=name, objectives=["height_m.p05", "energy_j.p95"])
        stored = study.as_dict()["uncertainty"]
        assert ("rail_friction" in stored) is has
        assert study_from_dict(study.as_dict(), source="again") == study


def test_jumps_under_uncertainty_are_those_of_a_stand_as_varied():
    """Rails alone vary: the jumps are those of calibrations with that friction, sample by sample."""
    nothing = Range(lower=0.0, upper=0.0, source="x")
    still = replace(STAND, **{name: nothing for name in STAND.ranges if name != "rail_friction"})
    known, drawn = load_calibration("stand"), sobol_samples(still, 4)
    found = Evaluator(map_for("VT8020"), known)(np.repeat(CASES[3:], 4, axis=0), variations=variations(drawn, 1, known))
    for k, factor in enumerate(1.0 + drawn.values["rail_friction"][:, 0]):
        there = replace(known, stand=replace(known.stand, rail_friction_n=factor * known.stand.rail_friction_n))
        alone = Evaluator(map_for("VT8020"), there)(CASES[3:])
        assert found.height_m[k] == pytest.approx(alone.height_m[0], rel=1e-12)


@pytest.mark.parametrize(("name", "count"), [("stand", 23), ("reference", 21)])
def test_a_search_draws_what_its_calibration_has(name, count):
    """A study that names no ranges of the stand, as one with a calibration file does not, has the shipped ones."""
    evaluator = Evaluator(map_for("VT8020"), load_calibration(name))
    sampling = Sampling(ranges=PLAIN, samples=16)
    searching = RobustEvaluator(evaluator=evaluator, sampling=sampling, names=("height_m.p05",), least={})
    assert searching.drawn.points.shape == (16, count)
    assert sampling_of({"stand_mass": {"lower": 0.0, "upper": 0.3, "source": "scales"}}, source="t").ranges.stand_mass


@pytest.mark.long
def test_robust_and_sensitivity_of_a_study_on_the_stand(tmp_path):
    db = tmp_path / "s.db"
    file = {"name": "s", "evaluations": 8, "audit": False, "calibration": "stand", "algorithm": {"name": "random"}}
    run(study_from_dict(file | {"gear_list": True, "rules": "iso6336"}, source="test"), db, workers=2)
    data = read_study(db)
    assert data.calibration == load_calibration("stand")
    trial = int(data.trials[data.trials["status"] == "ok"]["trial"].iloc[0])
    robust(db, PLAIN, trials=[trial], workers=2)
    assert read_robustness(db)[trial].settings["uncertainty"] == STAND.as_dict()
    _, assumptions = sensitivity(db, trial, PLAIN, blocks=32, workers=2)
    changes = {one.factor.name: one.measures["height_m"].change for one in assumptions.factors}
    assert len(changes) == 23
    assert changes["stand_mass"] < 0.0
    assert changes["rail_friction"] < 0.0
