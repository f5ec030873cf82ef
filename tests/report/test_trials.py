import numpy as np
import pandas as pd
import pytest

from pareto_monoped.report import trials as trials_module
from pareto_monoped.report.trials import audit_records, history_columns, rows_per_study, thinned


def test_studies_share_the_rows_of_a_page_in_proportion(monkeypatch):
    monkeypatch.setattr(trials_module, "MOST_ROWS", 100)
    assert rows_per_study([40, 60]) == [40, 60]
    assert rows_per_study([100, 300, 1]) == [24, 74, 1]


def test_thinning_keeps_what_must_stay_and_spreads_the_others_evenly():
    trials = pd.DataFrame({"trial": np.arange(100)})
    always = np.isin(np.arange(100), [3, 50])
    kept = thinned(trials, always, 12)["trial"].tolist()
    assert len(kept) == 12
    assert kept == sorted(kept)
    assert {0, 3, 50, 99} <= set(kept)
    assert max(np.diff(sorted(set(kept) - {3, 50}))) <= 12
    assert thinned(trials, always, 100)["trial"].tolist() == list(range(100))
    assert thinned(trials, always, 1)["trial"].tolist() == [3, 50]


def test_a_long_history_keeps_its_ends():
    steps = np.arange(1, 1001)
    columns = history_columns(pd.DataFrame({"evaluations": steps, "hypervolume": 0.01 * steps}))
    assert len(columns["evaluations"]) == 300
    assert (columns["evaluations"][0], columns["evaluations"][-1]) == (1.0, 1000.0)
    assert columns["hypervolume"] == pytest.approx([0.01 * n for n in columns["evaluations"]], rel=1e-5)


def test_a_design_has_only_the_measures_of_its_own_audit():
    """Some designs are screened, others audited."""
    audits = pd.DataFrame(
        {
            "trial": [7, 9],
            "well_conditioned": [True, True],
            "spread_height_m": [np.nan, 1e-4],
            "double_step_height_m": [2e-4, np.nan],
            "reason": ["", ""],
        }
    )
    assert audit_records(audits) == {
        "7": {"double_step_height_m": 2e-4, "good": True, "reason": ""},
        "9": {"spread_height_m": 1e-4, "good": True, "reason": ""},
    }


def test_audits_come_with_verdict_and_reason():
    audits = pd.DataFrame(
        {"trial": [7, 9], "well_conditioned": [True, False], "spread_height_m": [1e-4, np.inf], "reason": ["", "fell"]}
    )
    assert audit_records(audits) == {
        "7": {"spread_height_m": 1e-4, "good": True, "reason": ""},
        "9": {"spread_height_m": None, "good": False, "reason": "fell"},
    }
