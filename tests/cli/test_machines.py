"""The commands on machines that exist."""

import json
from pathlib import Path

import pytest

from pareto_monoped.cli import main

LEGS = Path(__file__).parents[2] / "examples" / "legs"


def run(capsys, *words):
    with pytest.raises(SystemExit) as ended:
        main([str(word) for word in words])
    shown = capsys.readouterr()
    return ended.value.code, shown.out, shown.err


def test_replay_prints_predicted_beside_measured(capsys):
    words = ("replay", LEGS / "dfki_hopping_leg.toml", "--samples", 16, "--fit", "damping", "--on", "3")
    code, out, _ = run(capsys, *words)
    assert code == 0
    assert "fitted on series 3: damping 0.3" in out
    assert "sources: 10 read, 4 inferred, 15 computed" in out
    lines = [line for line in out.splitlines() if line.startswith("  take-off")]
    assert len(lines) == 3
    assert "2.150 +- 0.010" in lines[2]
    assert lines[2].split("(")[-2].endswith("2.150 ")
    assert max(map(len, out.splitlines())) <= 80


def test_replay_as_json_has_all_that_is_known(capsys):
    code, out, _ = run(capsys, "replay", LEGS / "odri_teststand.toml", "--samples", 16, "--json")
    found = json.loads(out)
    assert code == 0
    assert found["measured"] == {"25 N": None}
    band = found["as_given"][0]["bands"]["apex_m"]
    assert 0.3 < band["p05"] < band["nominal"] < band["p95"] < 0.6
    assert found["fitted"] is None
    assert set(found["sources"]) >= {"base", "series"}


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("--fit", "wear", "--on", "3"), "fit = 'wear': must be one of damping, friction"),
        (("--fit", "damping", "--on", "4"), "on = '4': must be one of 1, 2, 3"),
        (("--fit", "damping"), "--fit and --on go together; give both or none"),
        (("--samples", "17"), "samples = 17: must be a power of two"),
    ],
)
def test_replay_ends_in_one_line(capsys, words, line):
    code, out, err = run(capsys, "replay", LEGS / "dfki_hopping_leg.toml", *words)
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert line in err
