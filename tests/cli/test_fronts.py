"""``front`` and ``pick`` as a user types them."""

import csv
import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from pareto_monoped.analysis.alternatives import alternatives
from pareto_monoped.cli import _run as cli
from pareto_monoped.cli.fronts import _print_table
from pareto_monoped.design import PAPER_NAMES, VARIABLES
from pareto_monoped.pareto.objectives import Objectives
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.store import Store
from tests.study.support import made_database, made_evaluations, made_generation, made_study

SYMBOLS = [variable.symbol for variable in VARIABLES if variable.name in PAPER_NAMES]

ANCHORS = ("study_content_hash", "study_sealed")
"""What ties a row to its study."""


@pytest.fixture
def db(tmp_path):
    """Its front: trials 4 (0.7 m, 8 J), 0 (0.8 m, 9 J), 3 (1.1 m, 30 J)."""
    made_database(tmp_path / "s.db")
    return str(tmp_path / "s.db")


def test_front_as_json(db, capsys):
    assert cli(["front", db, "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert [row["trial"] for row in rows] == [4, 0, 3]
    assert [list(row) for row in rows] == [["trial", "height_m", "energy_j", *PAPER_NAMES, *ANCHORS]] * 3
    anchors = {(row["study_content_hash"], row["study_sealed"]) for row in rows}
    assert anchors == {(read_study(Path(db)).content_hash, True)}
    assert (rows[0]["height_m"], rows[0]["energy_j"]) == (0.7, 8.0)


def test_front_as_csv_and_table(db, tmp_path, capsys):
    assert cli(["front", db, "--csv", str(tmp_path / "f.csv")]) == 0
    said = capsys.readouterr()
    assert said.out == ""
    assert "f.csv (3 designs)" in said.err
    with (tmp_path / "f.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert cli(["front", db, "--json"]) == 0
    exact = [{n: row[n] for n in row if n not in ANCHORS} for row in json.loads(capsys.readouterr().out)]
    assert [{name: float(value) for name, value in row.items()} for row in rows] == exact
    assert cli(["front", db]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 4
    assert max(map(len, lines)) <= 80


def long_front(path, designs):
    """A study whose front has so many designs: the higher, the more energy."""
    study, heights = made_study(), np.linspace(0.6, 1.2, designs)
    jumps = made_evaluations(heights.tolist(), (10.0 * heights).tolist(), seed=1)
    made_database(path, [made_generation(study, 0, 0, jumps, state={"after": 0})], study)
    return str(path)


def test_front_can_be_limited_to_some_designs_and_says_what_is_left_out(tmp_path, capsys):
    """It printed thousands of rows."""
    db = long_front(tmp_path / "long.db", 300)
    assert cli(["front", db]) == 0
    said = capsys.readouterr()
    whole = said.out.splitlines()
    assert len(whole) == 301
    assert "note: the front has 300 designs; --most 40 shows 40 of them, evenly spread\n" in said.err
    assert cli(["front", db, "--most", "4"]) == 0
    said = capsys.readouterr()
    assert said.out.splitlines() == [whole[0], *(whole[1 + place] for place in (0, 100, 199, 299))]
    assert "note: 4 of the front's 300 designs, evenly spread; leave out --most to see all\n" in said.err
    assert cli(["front", db, "--most", "2", "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)) == 2
    assert cli(["front", db, "--most", "1", "--csv", str(tmp_path / "one.csv")]) == 0
    assert (tmp_path / "one.csv").read_text().count("\n") == 2
    capsys.readouterr()
    assert cli(["front", db, "--most", "300"]) == 0
    said = capsys.readouterr()
    assert said.out.splitlines() == whole
    assert "evenly" not in said.err
    assert cli(["front", db, "--most", "0"]) == 2


@pytest.mark.parametrize(
    ("selector", "trial", "word"),
    [
        (["--min-height", "0.75"], 0, "least energy"),
        (["--max-energy", "29"], 0, "highest jump"),
        (["--knee"], 0, "knee"),
        (["--weights", "1,0"], 3, "weighted sum"),
        (["--trial", "4"], 4, "by its number"),
        (["--tradeoff"], 0, "largest trade-off"),
        (["--compromise", "0,1"], 4, "compromise"),
        (["--nearest", "height_m=0.85,energy_j=9"], 0, "nearest to the wish"),
        (["--min-height", "0.75", "--max-energy", "29"], 0, "reach 0.75 m and need at most 29 J"),
        (["--min", "height_m=0.75", "--knee"], 0, "knee"),
        (["--max", "height_m=0.75", "--weights", "1,0"], 4, "have at most 0.75 m of height"),
        (["--max", "height_m=1.0", "--min", "energy_j=8.5"], 0, "at least 8.5 J of energy"),
    ],
)
def test_pick(db, capsys, selector, trial, word):
    assert cli(["pick", db, *selector, "--json"]) == 0
    picked = json.loads(capsys.readouterr().out)
    assert list(picked) == ["trial", "height_m", "energy_j", *PAPER_NAMES, "why", "one_more", "limits"]
    assert picked["trial"] == trial
    assert word in picked["why"]
    assert cli(["pick", db, *selector]) == 0
    assert picked["why"] in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(
    ("selector", "word"),
    [
        ([], "no selector given"),
        (["--knee", "--trial", "4"], "2 selectors given"),
        (["--weights", "1"], "two numbers"),
        (["--weights", "a,b"], "two numbers"),
        (["--weights", "nan,1"], "nan,1"),
        (["--min-height", "nan"], "finite"),
        (["--min-height", "2"], "met with min-height = 1.1 m (0.9 m less)"),
        (["--trial", "1"], "must be a feasible design"),
        (["--trial", "-1"], "-1"),
        (["--min", "mass=4"], "did you mean 'mass_kg'?"),
        (["--max", "mass_kg"], "with a number"),
        (["--nearest", "apex_s=1"], "the name of a measure"),
        (["--nearest", "height_m=1,height_m=2"], "each measure once"),
        (["--compromise", "x"], "two numbers"),
        (["--min-height", "0.75", "--max-energy", "8.5"], "the nearest is trial 0 (0.800 m on 9.00 J)"),
    ],
)
def test_a_bad_selector_gets_one_line(db, capsys, selector, word):
    assert cli(["pick", db, *selector]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert word in said.err


def test_the_printed_front_has_named_units_and_fixed_decimals(db, capsys):
    assert cli(["front", db, "--json"]) == 0
    first = json.loads(capsys.readouterr().out)[0]
    assert cli(["front", db]) == 0
    heading, line, *_ = capsys.readouterr().out.splitlines()
    assert heading.split() == ["trial", "height", "m", "energy", "J", "l1", "l2", "g_k", "g_h", "K", "C", "T"]
    assert line.split() == ["4", "0.7000", "8.000", *(f"{first[name]:.3f}" for name in PAPER_NAMES)]


def test_the_printed_pick_has_six_digits(db, capsys):
    assert cli(["pick", db, "--trial", "4", "--json"]) == 0
    picked = json.loads(capsys.readouterr().out)
    assert cli(["pick", db, "--trial", "4"]) == 0
    why, *lines = capsys.readouterr().out.splitlines()
    assert why == picked["why"]
    names = ("height_m", "energy_j", *PAPER_NAMES)
    assert [line.split() for line in lines[: len(names)]] == [[name, f"{picked[name]:.6g}"] for name in names]
    assert " ".join(" ".join(lines[len(names) :]).split()) == (
        "one more centimetre of height costs 1 J of energy (trial 0: 0.800 m on 9.00 J) limits: none binds "
        "landing: left out, the leg is caught at the apex; 'export' says whether the design survives it"
    )


@pytest.fixture
def wide_db(tmp_path):
    """40 trials around 0.9 m and 20 J."""
    generator = np.random.default_rng(2)
    evaluations = made_evaluations(
        0.9 + 0.01 * generator.standard_normal(40), 20.0 + 0.2 * generator.standard_normal(40)
    )
    study = made_study()
    made_database(tmp_path / "wide.db", [made_generation(study, 0, 0, evaluations)], study)
    return str(tmp_path / "wide.db")


def test_alternatives(wide_db, capsys):
    data = read_study(Path(wide_db))
    trial = int(data.front()["trial"].iloc[0])
    ask = ["pick", wide_db, "--trial", str(trial), "--alternatives", "3", "--tolerance", "1.5"]
    assert cli([*ask, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["alternatives"]
    expected = alternatives(data, trial, count=3, tolerance=0.015)
    assert [one["trial"] for one in found] == [one.trial for one in expected]
    assert len(found) == 3
    assert cli(ask) == 0
    said = capsys.readouterr()
    assert max(map(len, said.out.splitlines())) <= 80
    words = " ".join(said.out.split())
    assert "alternatives within 1.5 percent, the most different first:" in words
    for one in expected:
        assert f"trial {one.trial} ({one.objectives.text(one.values)}): {one.text()}" in words
    assert said.err.endswith("note: alternatives without an audit: 3 of 3\n")


def test_alternatives_keep_the_conditions_and_may_be_none(wide_db, capsys):
    data = read_study(Path(wide_db))
    least = float(data.front()["height_m"].min())
    ask = ["pick", wide_db, "--min-height", repr(least), "--alternatives", "9", "--json"]
    assert cli(ask) == 0
    found = json.loads(capsys.readouterr().out)["alternatives"]
    assert found
    assert min(one["height_m"] for one in found) >= least
    assert cli(["pick", wide_db, "--knee", "--alternatives", "1", "--tolerance", "0"]) == 0
    assert "no other design is within 0 percent; raise --tolerance" in capsys.readouterr().out


def test_weights_are_height_then_energy(db, capsys):
    assert cli(["pick", db, "--weights", "0,1", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["trial"] == 4


def test_all_keeps_designs_that_failed_their_audit(db, capsys):
    """Trial 5, 0.9 m on 40 J, was dominated by trial 3, 1.1 m on 30 J."""
    data = read_study(Path(db))
    with Store(Path(db), data.study) as store:
        store.set_audits([(3, False, {})])

    def trials(*words):
        capsys.readouterr()
        assert cli(["front", db, "--json", *words]) == 0
        return [row["trial"] for row in json.loads(capsys.readouterr().out)]

    assert trials() == [4, 0, 5]
    assert trials("--all") == [4, 0, 3]
    assert cli(["pick", db, "--trial", "3"]) == 2


def test_other_objectives_take_other_designs_of_the_stored_trials(db, capsys):
    names = ["height_m", "electrical_energy_j"]
    assert cli(["front", db, "--objectives", ", ".join(names), "--json"]) == 0
    said = capsys.readouterr()
    rows = json.loads(said.out)
    assert f"note: designs without an audit: {len(rows)} of {len(rows)}\n" in said.err
    trials = read_study(Path(db)).trials
    able = trials[trials["state"] == "feasible"].to_dict(orient="records")
    expected = [
        int(a["trial"])
        for a in able
        if not any(
            b["height_m"] >= a["height_m"]
            and b["electrical_energy_j"] <= a["electrical_energy_j"]
            and b["trial"] != a["trial"]
            for b in able
        )
    ]
    assert sorted(row["trial"] for row in rows) == sorted(expected)
    assert [list(row) for row in rows] == [["trial", *names, *PAPER_NAMES, *ANCHORS]] * len(rows)


def test_designs_without_an_audit_are_counted_under_other_objectives_only(db, capsys):
    assert cli(["front", db, "--objectives", "height_m,energy_j", "--json"]) == 0
    said = capsys.readouterr()
    assert [row["trial"] for row in json.loads(said.out)] == [4, 0, 3]
    assert "without an audit" not in said.err
    assert cli(["front", db, "--objectives", "height_m,electrical_energy_j", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    with Store(Path(db), read_study(Path(db)).study) as store:
        store.set_audits([(rows[0]["trial"], True, {})])
    assert cli(["front", db, "--objectives", "height_m,electrical_energy_j", "--json"]) == 0
    assert f"note: designs without an audit: {len(rows) - 1} of {len(rows)}\n" in capsys.readouterr().err


@pytest.mark.parametrize(("designs", "told"), [(100, False), (101, True)])
def test_more_than_a_hundred_rows_are_told_how_to_be_fewer(tmp_path, capsys, designs, told):
    assert cli(["front", long_front(tmp_path / "long.db", designs)]) == 0
    said = capsys.readouterr()
    assert len(said.out.splitlines()) == designs + 1
    assert ("--most 40 shows 40 of them" in said.err) is told


def test_three_objectives_fit_into_the_window(db, capsys):
    assert cli(["front", db, "--objectives", "height_m,electrical_energy_j,mass_kg"]) == 0
    heading, *lines = capsys.readouterr().out.splitlines()
    assert heading.split()[:7] == ["trial", "height", "m", "battery", "J", "mass", "kg"]
    assert lines
    assert max(len(line) for line in (heading, *lines)) <= 80


@pytest.mark.parametrize(
    ("given", "word"),
    [
        ("height_m", "--objectives: number of objectives = 1: must be two or three"),
        ("height_m,watts", "--objectives: objective 'watts' is not a measure"),
        ("height_m,apex_s", "no direction"),
        ("height_m,energy_j,mass_kg,drift_m", "number of objectives = 4"),
    ],
)
def test_bad_objectives_get_one_line(db, capsys, given, word):
    assert cli(["front", db, "--objectives", given]) == 2
    said = capsys.readouterr()
    assert (said.out, said.err.count("\n")) == ("", 1)
    assert word in said.err


def test_a_measure_that_no_trial_has_is_refused(capsys):
    """Version 0.1.0 did not store what the battery pays."""
    old = Path(__file__).parents[1] / "storage" / "data" / "plain.db"
    assert cli(["front", str(old), "--objectives", "height_m,electrical_energy_j"]) == 2
    assert "no trial" in capsys.readouterr().err
    assert cli(["front", str(old), "--objectives", "height_m,mass_kg"]) == 0


def test_a_limit_on_any_measure(db, capsys):
    front = read_study(Path(db)).front()
    for drift in front["drift_m"]:
        assert cli(["pick", db, "--limit", f"drift_m={drift!r}", "--json"]) == 0
        able = front[front["drift_m"] <= drift]
        assert json.loads(capsys.readouterr().out)["trial"] == able.loc[able["height_m"].idxmax(), "trial"]


@pytest.mark.parametrize(
    ("limit", "word"),
    [
        ("drift_m", "with a number"),
        ("drift_m=x", "with a number"),
        ("apex_s=1", "a measure"),
        ("x=1", "a measure"),
    ],
)
def test_a_bad_limit_gets_one_line(db, capsys, limit, word):
    assert cli(["pick", db, "--limit", limit]) == 2
    said = capsys.readouterr()
    assert said.err.count("\n") == 1
    assert word in said.err


@pytest.mark.parametrize("joints", [["motor"], ["hip_motor", "knee_motor"]])
@pytest.mark.parametrize("count", [1, 40])
def test_a_front_of_motor_pairs_with_three_objectives_fits_into_the_window(capsys, joints, count):
    """It was 97 letters wide."""
    goals = ("height_m", "electrical_energy_j", "mass_kg")
    numbers = {name: np.linspace(0.1, 99.123456, count) for name in (*goals, *PAPER_NAMES)}
    rows = pd.DataFrame({"trial": np.arange(count), **numbers, **dict.fromkeys(joints, "MAD_M6C12")})
    _print_table(rows, Objectives(names=goals))
    said = capsys.readouterr()
    heading, *lines = said.out.splitlines()
    assert len(lines) == count
    assert max(len(line) for line in (heading, *lines)) <= 80
    assert all(len(line.split()) == len(heading.split()) - len(goals) for line in lines)
    left = [symbol for symbol in SYMBOLS if symbol not in heading.split()]
    assert heading.split()[-len(joints) :] == [name.removesuffix("_motor") for name in joints]
    assert " ".join(said.err.split()) == (
        f"note: {', '.join(left)} do not fit into the table; --csv and --json have all columns" if left else ""
    )
    assert len(left) < len(SYMBOLS) / 2


@pytest.mark.parametrize(("designs", "said"), [("2", True), ("3", False)])
def test_limit_says_how_many_of_the_front_it_takes_only_if_not_all(db, capsys, monkeypatch, designs, said):
    """The front has three designs."""
    monkeypatch.setattr("pareto_monoped.analysis.limit.limits", lambda *_, **__: [])
    assert cli(["limit", db, "--designs", designs, "--json"]) == 0
    assert ("of the front's 3 designs, evenly spread" in capsys.readouterr().err) is said
