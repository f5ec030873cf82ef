"""The commands on machines that exist."""

import json
from pathlib import Path

import numpy as np
import pytest

from tests.analysis.test_compare import NOISE, blind_log
from tests.cli.support import run

LEGS = Path(__file__).parents[2] / "examples" / "legs"


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
        pytest.param(("--fit", "damping", "--on", "4"), "on = '4': must be one of 1, 2, 3", marks=pytest.mark.long),
        (("--fit", "damping"), "--fit and --on go together; give both or none"),
        (("--on", "3"), "--fit and --on go together; give both or none"),
        (("--samples", "17"), "samples = 17: must be a power of two"),
    ],
)
def test_replay_ends_in_one_line(capsys, words, line):
    code, out, err = run(capsys, "replay", LEGS / "dfki_hopping_leg.toml", *words)
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert line in err


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    """A log of Case C with 1.05 times the torque constant, as a file in units of its own."""
    found = blind_log("C", (1.2, 1.05, 1.2e-3, 0.9), np.random.default_rng(5))
    scale = {"height": ("height_mm", 1e3), "hip": ("hip_deg", 180.0 / np.pi), "knee": ("knee_rad", 1.0)}
    names = {name: scale.get(name, (f"{name}_a", 1.0)) for name in NOISE}
    rows = np.column_stack([found.time_s, *(found.signals[name] * factor for name, (_, factor) in names.items())])
    path = tmp_path_factory.mktemp("log") / "log.csv"
    header = ",".join(["time_s", *(title for title, _ in names.values())])
    np.savetxt(path, rows, delimiter=",", header=header, comments="")
    return path


def test_compare_prints_residuals_and_intervals(capsys, log):
    code, out, _ = run(capsys, "compare", log, "C")
    assert code == 0
    lines = {line.split(",")[0].strip(): line.split() for line in out.splitlines()}
    assert float(lines["torque_constant"][2]) == pytest.approx(1.05, abs=0.01)
    assert float(lines["delay"][2]) == pytest.approx(1.2, abs=0.2)
    for name, true in (("friction", 1.2), ("torque_constant", 1.05), ("delay", 1.2), ("stiffness", 0.9)):
        lower, upper = (float(lines[name][place]) for place in (-3, -1))
        assert lower <= true <= upper
    assert float(lines["knee"][2]) > 2.0 * float(lines["knee"][3])


@pytest.mark.long
def test_compare_as_json_fits_what_there_is(capsys, log):
    """Under ``ideal``, neither Coulomb friction nor elastic drives."""
    code, out, _ = run(capsys, "compare", log, "C", "--calibration", "ideal", "--json")
    found = json.loads(out)
    assert code == 0
    assert set(found["fitted"]) == {"torque_constant", "delay"}
    assert set(found["before"]) == set(NOISE)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("D",), "'D': cannot be read"),
        (("none.json",), "cannot be read"),
        (("C", "--calibration", "reference-3"), "calibration = 'reference-3': must be one with joints.stop_law"),
    ],
)
def test_compare_ends_in_one_line(capsys, log, words, said):
    code, out, err = run(capsys, "compare", log, *words)
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert said in err
