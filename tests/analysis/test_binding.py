"""The limits that a design is at."""

from dataclasses import replace

import pytest

from pareto_monoped.analysis.at_bounds import binding_limits
from pareto_monoped.storage.reader import read_study
from tests.study.support import made_database, made_study


@pytest.fixture
def data(tmp_path):
    """Trial 0 in the middle of all bounds, at 0.8 m."""
    study = made_study(constraints={"mass_kg": {"max": 4.0}, "drift_m": {"max": 0.1}, "height_m": {"min": 0.7}})
    made_database(tmp_path / "s.db", study=study)
    read = read_study(tmp_path / "s.db")
    middle = {
        name: 0.5 * (bounds.lower + bounds.upper) for name, bounds in study.variables.items() if name in study.free
    }
    return replace(read, trials=read.trials.assign(**middle, mass_kg=3.5, drift_m=0.05, height_m=0.8))


def test_a_free_design_has_none(data):
    assert binding_limits(data, 0) == []


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"knee_ratio": 4.02}, ["knee_ratio at its lower bound of 4"]),
        ({"knee_ratio": 4.03}, []),
        ({"thigh_length_m": 0.4995}, ["thigh_length_m at its upper bound of 0.5 m"]),
        ({"mass_kg": 3.961}, ["mass_kg 3.961 kg, at most 4 kg is asked"]),
        ({"mass_kg": 3.959}, []),
        ({"height_m": 0.706}, ["height_m 0.706 m, at least 0.7 m is asked"]),
        ({"height_m": 0.708}, []),
        # A limit that is missed does not hold the design where it is.
        ({"mass_kg": 4.01}, []),
        (
            {"drift_m": 0.1, "damping_n_s_per_m": 0.0},
            ["damping_n_s_per_m at its lower bound of 0 N s/m", "drift_m 0.1 m, at most 0.1 m is asked"],
        ),
    ],
)
def test_bounds_and_constraints_that_bind(data, change, expected):
    assert binding_limits(replace(data, trials=data.trials.assign(**change)), 0) == expected
