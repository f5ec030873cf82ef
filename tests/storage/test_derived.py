from pathlib import Path

import numpy as np
import pandas as pd

from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.design import NAMES
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.storage.front_reader import read_front
from pareto_monoped.storage.reader import read_study, with_agility
from pareto_monoped.study.run import run

DATA = Path(__file__).parent / "data"


def test_an_agility_filled_in_equals_a_simulated_one_to_the_last_bit(tmp_path):
    study = study_from_dict({"name": "agile", "evaluations": 16, "seed": 2, "audit": False}, source="test")
    run(study, tmp_path / "agile.db")
    data = read_study(tmp_path / "agile.db")
    rows = data.trials[data.trials["status"] == "ok"]
    again = Evaluator(data.case_kit, data.calibration)(rows[list(NAMES)].to_numpy(dtype=np.float64))
    assert (rows["agility_m_per_s"] == again.agility_m_per_s).all()
    emptied = rows.assign(agility_m_per_s=np.nan)
    assert (with_agility(emptied)["agility_m_per_s"] == again.agility_m_per_s).all()


def test_a_jump_that_failed_has_no_agility():
    nan = float("nan")
    trials = pd.DataFrame(
        {"height_m": [nan, 0.9, 0.9], "start_height_m": 0.4, "apex_s": [nan, nan, 0.25], "agility_m_per_s": nan}
    )
    np.testing.assert_array_equal(with_agility(trials)["agility_m_per_s"], [nan, nan, 2.0])


def test_what_is_stored_stays():
    trials = pd.DataFrame({"height_m": [0.9], "start_height_m": 0.5, "apex_s": [0.25], "agility_m_per_s": [1.25]})
    assert with_agility(trials)["agility_m_per_s"].tolist() == [1.25]


def test_earlier_studies_have_it_with_and_without_their_other_trials():
    data = read_study(DATA / "plain.db")
    front = read_front(DATA / "plain.db").rows
    assert front["agility_m_per_s"].tolist() == data.front()["agility_m_per_s"].tolist()
    assert (front["agility_m_per_s"] > 0.5).all()
