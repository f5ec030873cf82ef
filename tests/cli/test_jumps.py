import csv
import json
import math
import re
from importlib import resources

import mujoco
import numpy as np
import pytest

from pareto_monoped.cli import jumps
from pareto_monoped.design import PAPER_CASES, PAPER_NAMES, VARIABLES
from pareto_monoped.jump.evaluate import STATUSES
from pareto_monoped.jump.table1 import Result, Row, Spread
from tests.cli.support import run


def test_simulate_json_has_what_others_rely_on(capsys):
    code, out, err = run(capsys, "simulate", "--case", "C", "--json")
    assert code == 0
    assert err.startswith("note: struck like this in each of 100000 jumps, the gears")
    assert err.count("note: ") == 1
    report = json.loads(out)
    assert report["status"] == "ok"
    assert report["calibration"] == "reference-4"
    assert report["design"] == PAPER_CASES["C"].design.as_dict()
    for name in ("height_m", "energy_j", "foot_clearance_m", "mass_kg"):
        assert report[name] > 0.0


def test_landing_and_hops_are_asked_for_and_leave_the_jump_as_it_is(capsys):
    plain = json.loads(run(capsys, "simulate", "--case", "C", "--json")[1])
    code, out, _ = run(capsys, "simulate", "--case", "C", "--landing", "--hops", "3", "--json")
    report = json.loads(out)
    landing, hops = report.pop("landing"), report.pop("hops")
    assert (code, report) == (0, plain)
    assert (landing["status"], landing["landing_ok"]) == ("landed", False)
    assert 1000.0 < landing["landing_peak_foot_force_n"] < 2000.0
    assert landing["landing_safety"] < landing["best_found"]["landing_safety"] < 1.0
    assert (hops["made"], hops["reason"]) == (3, "")
    assert hops["energy_j"] > plain["energy_j"]
    shown = run(capsys, "simulate", "--case", "C", "--landing")[1]
    assert f"landing_peak_foot_force_n {landing['landing_peak_foot_force_n']:.6g}" in " ".join(shown.split())


def test_rules_choose_the_gearboxes_and_a_stand_in_is_noted(capsys):
    code, out, err = run(capsys, "simulate", "--case", "A", "--set", "knee_ratio=6.15", "--rules", "iso6336", "--json")
    report = json.loads(out)
    assert (code, report["status"], report["rules"]) == (0, "ok", "iso6336")
    note = " ".join(err.split())
    assert "note: gear ratio 6.15: " in note
    assert "stands in" in note
    assert json.loads(run(capsys, "simulate", "--case", "A", "--set", "knee_ratio=6.15", "--json")[1]) == report
    plain = json.loads(
        run(capsys, "simulate", "--case", "A", "--set", "knee_ratio=6.15", "--rules", "paper", "--json")[1]
    )
    assert "rules" not in plain
    assert plain["height_m"] != report["height_m"]


def test_the_calibration_paper_goes_with_its_own_rules(capsys):
    code, _, err = run(capsys, "simulate", "--calibration", "paper", "--rules", "iso6336")
    assert code == 2
    assert err.splitlines() == [err.strip()]
    assert "rules = 'iso6336': must be 'paper' with the calibration 'paper'" in err


def test_set_changes_a_variable_and_notes_what_lies_outside_the_paper(capsys):
    code, out, err = run(capsys, "simulate", "--set", "thigh_length_m=0.55", "--set", "stiffness_n_per_m=30", "--json")
    assert code == 0
    design = json.loads(out)["design"]
    assert (design["thigh_length_m"], design["stiffness_n_per_m"]) == (0.55, 30.0)
    assert "note: outside the paper's bounds: thigh_length_m = 0.55 (0.3 to 0.5 m)" in err.splitlines()


def test_a_ratio_without_a_gearbox_is_refused_with_a_cure(capsys):
    code, _, err = run(capsys, "simulate", "--set", "knee_ratio=99")
    assert code == 2
    assert err.splitlines() == [
        "error: knee_ratio = 99: outside the map of VT8020, which covers 4 up to but not including 15; "
        "choose another ratio",
    ]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--set", "knee=6"), "thigh_length_m"),
        (("--set", "knee_ratio"), "NAME=X"),
        (("--set", "knee_ratio=six"), "a number"),
        (("--set", "knee_ratio=nan"), "finite"),
        (("--set", "knee_ratio=40"), "knee_ratio"),
        (("--set", "thigh_length_m=-0.4"), "at least"),
        (("--case", "D"), "nominal"),
        (("--calibration", "paperr"), "paper"),
        (("--motor", "nosuchmotor"), "nosuchmotor"),
        (("--set", "thigh_length_m=1.5", "--trace", "t.csv"), "cannot stand"),
        (("--trace", "no/such/folder/t.csv"), "no/such/folder"),
    ],
)
def test_bad_input_gets_one_line_and_leaves_nothing(capsys, tmp_path, monkeypatch, arguments, said):
    monkeypatch.chdir(tmp_path)
    code, out, err = run(capsys, "simulate", *arguments)
    assert code == 2
    assert out == ""
    *_, line = err.splitlines()
    assert err.count("error: ") == 1
    assert line.startswith("error: ")
    assert said in line
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("change", "status", "cure"),
    [
        ("thigh_length_m=1.5", "cannot_stand", "change the link lengths or start_height_m"),
        ("stiffness_n_per_m=0", "no_lift_off", "raise stiffness_n_per_m"),
    ],
)
def test_a_design_that_does_not_jump_is_told_and_ends_with_1(capsys, change, status, cure):
    """It ended with 0, as if all were well."""
    code, out, err = run(capsys, "simulate", "--set", change, "--json")
    report = json.loads(out)
    assert code == 1
    assert report["status"] == status
    assert report["height_m"] is None
    last = err.splitlines()[-1]
    assert last.startswith(f"error: jump: {status.replace('_', ' ')}, {report['reason']}; ")
    assert cure in last
    assert f"reason {report['reason']}" in " ".join(run(capsys, "simulate", "--set", change)[1].split())


def test_every_way_not_to_jump_has_a_cure():
    assert {*jumps._CURES, "ok", "bad_input", "no_gearbox"} == set(STATUSES)


def test_values_outside_their_bounds_are_two_notes_at_most_which_fit_eighty_columns(capsys):
    """Each was a note of its own, and long ones ran beyond the screen."""
    changes = [f"{variable.name}={variable.upper * 1.001!r}" for variable in VARIABLES]
    words = [word for change in changes for word in ("--set", change)]
    _, _, err = run(capsys, "simulate", "--json", *words)
    assert max(map(len, err.splitlines())) <= 80
    told = " ".join(err.split())
    assert [told.count(f"note: outside {whose} bounds: ") for whose in ("the paper's", "the usual")] == [1, 1]
    for variable in VARIABLES:
        assert told.count(f"{variable.name} = ") == 1


def test_trace_and_model_are_those_of_the_jump(capsys, tmp_path):
    trace, model = tmp_path / "jump.csv", tmp_path / "robot.xml"
    rigid = ("--calibration", "reference-3")  # whose stops are the model's own
    code, out, _ = run(capsys, "simulate", "--case", "B", "--json", "--trace", trace, "--model", model, *rigid)
    report = json.loads(out)
    assert code == 0
    with trace.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert max(float(row["base_z_m"]) for row in rows) == report["height_m"]
    loaded = mujoco.MjModel.from_xml_path(str(model))
    data = mujoco.MjData(loaded)
    mujoco.mj_resetDataKeyframe(loaded, data, loaded.key("start").id)
    # The recorded torques, played back in plain MuJoCo, make the same jump.
    for row in rows[:-1]:
        data.ctrl[:] = float(row["hip_torque_n_m"]), float(row["knee_torque_n_m"])
        mujoco.mj_step(loaded, data)
    mujoco.mj_kinematics(loaded, data)
    assert data.body("base").xpos[2] == pytest.approx(float(rows[-1]["base_z_m"]), abs=1e-12)


def test_audit_says_whether_to_trust_the_jump(capsys):
    _, out, _ = run(capsys, "simulate", "--case", "C", "--audit", "--json")
    audit = json.loads(out)["audit"]
    assert audit["well_conditioned"]
    assert audit["energy_balance_error"] < 0.01
    energy = audit["energy"]
    parts = sum(value for name, value in energy.items() if name not in ("motor_work_j", "joint_work_j"))
    assert parts == pytest.approx(energy["motor_work_j"])
    assert energy["joint_work_j"] == pytest.approx(
        energy["motor_work_j"] - energy["mesh_loss_j"] - energy["chain_loss_j"]
    )


def test_table1_json_has_the_three_results_of_each_case(capsys):
    code, out, _ = run(capsys, "table1", "--json")
    rows = json.loads(out)
    assert code == 0
    assert [row["case"] for row in rows] == list(PAPER_CASES)
    for row in rows:
        assert row["published"]["height_m"] == PAPER_CASES[row["case"]].height_m
        assert set(row["reference"]) == {"height_m", "energy_j"}
        spread = row["paper"]
        assert spread["height_p05_m"] <= spread["height_m"] <= spread["height_p95_m"]
        assert spread["energy_p05_j"] <= spread["energy_j"] <= spread["energy_p95_j"]


def test_tables_fit_eighty_columns(capsys):
    for arguments in (("table1",), ("simulate", "--audit")):
        _, out, _ = run(capsys, *arguments)
        assert max(len(line) for line in out.splitlines()) <= 80
        assert np.all([name in out for name in PAPER_NAMES]) or arguments == ("table1",)


@pytest.mark.parametrize("text", ["thigh_length_m=0.3", "thigh_length_m=0.5", "damping_n_s_per_m=0"])
def test_a_value_on_a_bound_is_within_it(capsys, text):
    assert "bounds" not in run(capsys, "simulate", "--set", text)[2]


def test_gears_that_do_not_last_their_duty_get_one_line_of_advice(capsys):
    """They last in Case C under the loads of rigid drives."""
    said = {}
    for case, calibration in (("nominal", "reference"), ("C", "reference-3")):
        code, out, err = run(capsys, "simulate", "--case", case, "--calibration", calibration, "--json")
        assert code == 0
        said[case] = json.loads(out), err
    weak, err = said["nominal"]
    assert weak["gear_strike_safety"] < 1.0
    assert weak["gear_life_jumps"] < 1e5
    assert err.count("note: ") == 1
    assert all(
        word in " ".join(err.split())
        for word in ("of 100000 jumps", "heavier gearboxes", "knee_release_rad", "gear_strike_safety")
    )
    strong, err = said["C"]
    assert strong["gear_strike_safety"] >= 1.0
    assert strong["gear_life_jumps"] >= 1e5
    assert err == ""
    # The rules of the paper know no fatigue.
    paper = json.loads(run(capsys, "simulate", "--calibration", "paper", "--json")[1])
    assert paper["gear_strike_safety"] is None
    assert "gear_life_jumps" not in paper


@pytest.mark.long
def test_hip_and_knee_may_have_different_motors(capsys, tmp_path):
    both = ("--hip-motor", "U8", "--knee-motor", "VT8020")
    mixed, swapped, one = (
        json.loads(run(capsys, "simulate", "--case", "C", "--json", *words)[1])
        for words in (both, ("--hip-motor", "VT8020", "--knee-motor", "U8"), ("--motor", "U8"))
    )
    assert (mixed["hip_motor"], mixed["knee_motor"], "motor" in mixed) == ("U8", "VT8020", False)
    assert mixed["height_m"] > one["height_m"] > swapped["height_m"]  # the knee does the work, the hip is carried
    twice = json.loads(run(capsys, "simulate", "--case", "C", "--json", "--hip-motor", "U8", "--knee-motor", "U8")[1])
    assert twice == one
    run(capsys, "simulate", "--case", "C", *both, "--model", tmp_path / "m.xml")
    assert "hip motor: U8; knee motor: VT8020" in (tmp_path / "m.xml").read_text()


def test_the_named_motor_and_calibration_are_used(capsys):
    default, other = (
        json.loads(run(capsys, "simulate", "--json", *more)[1])
        for more in ((), ("--motor", "U8", "--calibration", "ideal"))
    )
    assert (default["motor"], default["calibration"]) == ("VT8020", "reference-4")
    assert (other["motor"], other["calibration"]) == ("U8", "ideal-4")
    assert other["height_m"] != default["height_m"]


def test_measures_are_printed_with_six_digits(capsys):
    report = json.loads(run(capsys, "simulate", "--case", "C", "--json")[1])
    words = [line.split() for line in run(capsys, "simulate", "--case", "C")[1].splitlines()]
    printed = dict(pair for pair in words if len(pair) == 2)
    assert printed["height_m"] == f"{report['height_m']:.6g}"
    assert printed["joule_heat_j"] == f"{report['joule_heat_j']:.6g}"
    assert printed["thigh_length_m"] == "0.49"


def test_an_infinite_change_in_an_audit_is_null_in_json():
    assert (jumps._plain(math.inf), jumps._plain(math.nan), jumps._plain(0.25)) == (None, None, 0.25)


def test_the_printed_table1_has_heights_above_energies_and_says_which_copies_jump(capsys):
    spread = Spread(
        height_m=0.8164,
        energy_j=31.456,
        height_p05_m=0.7111,
        height_p95_m=0.9222,
        energy_p05_j=30.111,
        energy_p95_j=32.222,
        jumped_share=0.95,
    )
    row = Row(
        case="A",
        published=Result(height_m=0.887, energy_j=31.44),
        paper=spread,
        reference=Result(height_m=1.0771, energy_j=54.314),
    )
    jumps._print_table1((row,))
    out = capsys.readouterr().out
    lines = [line for line in out.splitlines() if line.startswith("│")]
    heights, energies = ([cell.strip() for cell in line.split("│")[1:-1]] for line in lines)
    assert heights == ["A", "0.887", "0.816 (0.711 to 0.922)", "1.077"]
    assert energies == ["", "31.44", "31.46 (30.11 to 32.22)", "54.31"]
    assert out.splitlines()[-1] == "A: 95% of its perturbed copies jump under `paper`"


@pytest.mark.parametrize("more", [(), ("--json",), ("--audit",), ("--trace", "t.csv", "--model", "m.xml")])
def test_a_jump_that_diverges_says_so_and_ends_with_code_1(capsys, tmp_path, monkeypatch, more):
    monkeypatch.chdir(tmp_path)
    rigid = resources.files("pareto_monoped") / "data" / "calibrations" / "earlier" / "reference-3.toml"
    text = rigid.read_text()
    for key, value in {"stiffness_n_per_m": "1e15", "damping_n_s_per_m": "1e9", "timestep_s": "0.02"}.items():
        text = re.sub(f"^{key} = .*$", f"{key} = {value}", text, flags=re.MULTILINE)
    (tmp_path / "wild.toml").write_text(re.sub("^control_period_s.*$", "", text, flags=re.MULTILINE))
    code, out, err = run(capsys, "simulate", "--calibration", "wild.toml", *more)
    assert (code, err) == (
        1,
        "error: jump: diverged, its accelerations grew beyond all bounds; choose softer contact and stops or a "
        "smaller time step in the calibration, or smaller gains\n",
    )
    assert "diverged" in out
    assert {path.name for path in tmp_path.iterdir()} == {"wild.toml", *more[1::2]}
