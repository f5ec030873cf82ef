"""What ``status`` tells of a stored study."""

import numpy as np

import pareto_monoped as pm
from pareto_monoped.storage.status import read_summary


def test_the_front_is_in_the_order_of_its_first_objective(tmp_path):
    """Also where this is neither height nor energy, whose order another one has."""
    study = pm.Study.define(
        name="light",
        evaluations=60,
        objectives=("mass_kg", "height_m"),
        algorithm="random",
        strength=False,
        audit=False,
    )
    db = pm.run(study, tmp_path / "light.db").path
    front = read_summary(db).front
    assert len(front) >= 3
    assert np.all(np.diff(front[:, 0]) > 0.0)
    assert not np.all(np.diff(read_summary(db).energies_j) > 0.0)
