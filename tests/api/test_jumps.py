"""Designs in every form make the same jumps, and those of the command line."""

import json

import numpy as np
import pandas as pd
import pytest

import pareto_monoped as pm
from pareto_monoped.cli import _run as cli
from pareto_monoped.design import NAMES, PAPER_NAMES

C = pm.PAPER_CASES["C"].design
CASES = [case.design for case in pm.PAPER_CASES.values()]


@pytest.fixture(scope="module")
def jumps():
    return pm.simulate(CASES)


FORMS = {
    "list of designs": CASES,
    "paper's variables": np.array([design.as_array() for design in CASES])[:, : len(PAPER_NAMES)],
    "all variables": np.array([design.as_array() for design in CASES]),
    "nested list": [design.as_array().tolist() for design in CASES],
    "data frame": pd.DataFrame([design.as_dict() for design in CASES]).assign(state="feasible"),
    "mapping of columns": {name: [getattr(design, name) for design in CASES] for name in NAMES},
}


@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS.keys())
def test_every_form_of_designs_makes_the_same_jumps(form, jumps):
    pd.testing.assert_frame_equal(pm.simulate(form, workers=1), jumps, check_exact=True)


@pytest.mark.parametrize("form", [C, C.as_dict(), C.as_array()], ids=["design", "mapping", "row"])
def test_one_design_is_one_row(form, jumps):
    row = pm.simulate(form)
    pd.testing.assert_frame_equal(row, jumps.iloc[[-1]].reset_index(drop=True), check_exact=True)


@pytest.mark.parametrize(
    "named",
    [{}, {"motor": "U8"}, {"hip_motor": "VT8020", "knee_motor": "U8"}, {"calibration": "paper"}, {"rules": "paper"}],
    ids=str,
)
def test_a_jump_is_that_of_the_command_line(named, capsys):
    """To the last bit by one engine; the command's single jump is MuJoCo's, and differs by rounding from compiled."""
    row = pm.simulate(C, **named).iloc[0]
    options = [word for name, value in named.items() for word in (f"--{name.replace('_', '-')}", value)]
    assert cli(["simulate", "--case", "C", "--json", *options]) == 0
    said = json.loads(capsys.readouterr().out)
    for entry in pm.MEASURES:
        value = row[entry.name]
        same = value if named.get("calibration") == "paper" else pytest.approx(value, rel=1e-9, abs=1e-12)
        assert said[entry.name] == (same if np.isfinite(value) else None), entry.name


def test_motors_and_calibrations_may_be_objects_files_and_names(tmp_path, jumps):
    known = jumps.iloc[[-1]].reset_index(drop=True)
    motor, calibration = pm.load_motor("VT8020"), pm.load_calibration()
    pd.testing.assert_frame_equal(pm.simulate(C, motor=motor, calibration=calibration), known, check_exact=True)
    (tmp_path / "own.toml").write_text(
        "kv_rpm_per_v = 100.0\nrated_voltage_v = 48.0\nmax_continuous_current_a = 30.0\n"
        "winding_resistance_ohm = 0.1\n[framed]\nmass_kg = 0.3\nouter_diameter_mm = 90.0\nlength_mm = 30.0\n"
    )
    assert pm.load_motor(tmp_path / "own.toml") == pm.load_motor(str(tmp_path / "own.toml"))


def test_a_design_that_fails_is_a_row_with_its_status():
    rows = pm.simulate([C, C.replace({"thigh_length_m": 0.1}), C.replace({"hip_ratio": 30.0})])
    assert rows["status"].tolist() == ["ok", "cannot_stand", "no_gearbox"]
    assert rows["height_m"].isna().tolist() == [False, True, True]
    assert all(rows["reason"][1:])


def test_a_trace_ends_at_the_apex_of_the_jump(jumps):
    steps = pm.trace(C)
    assert steps["base_z_m"].max() == pytest.approx(jumps["height_m"].iloc[-1], rel=1e-9)  # by the other engine
    assert steps["time_s"].iloc[-1] == pytest.approx(jumps["apex_s"].iloc[-1], abs=1e-12)


def test_a_robot_has_the_mass_that_jumps(jumps):
    assert pm.build_robot(C).mass_kg == pytest.approx(jumps["mass_kg"].iloc[-1], rel=1e-9)
    both = pm.build_robot(C, knee_motor="U8")
    assert both.mass_kg == pytest.approx(pm.simulate(C, knee_motor="U8")["mass_kg"][0], rel=1e-9)


def test_a_landing_is_that_of_the_command(capsys):
    (row,) = pm.simulate(pm.PAPER_CASES["C"].design, landing=True).to_dict(orient="records")
    assert cli(["simulate", "--case", "C", "--landing", "--json"]) == 0
    said = json.loads(capsys.readouterr().out)["landing"]
    assert row["landing_ok"] is said["landing_ok"] is False
    assert row["landing_peak_foot_force_n"] == pytest.approx(said["landing_peak_foot_force_n"], rel=1e-12)
    assert row["height_m"] == pm.simulate(pm.PAPER_CASES["C"].design)["height_m"][0]
