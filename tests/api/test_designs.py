"""Designs in the forms of pandas, whose columns may name motors, and names that no design has."""

import numpy as np
import pandas as pd
import pytest

import pareto_monoped as pm
from pareto_monoped.api.given import given_designs
from pareto_monoped.design import NAMES
from pareto_monoped.errors import DesignError

C = pm.PAPER_CASES["C"].design
TINY = {"name": "tiny", "evaluations": 40, "algorithm": "random", "audit": False, "strength": False}


def made(tmp_path_factory, **motors):
    return pm.run(pm.Study.define(**TINY, **motors), tmp_path_factory.mktemp("designs") / "tiny.db")


@pytest.fixture(scope="module")
def u8(tmp_path_factory):
    """A study with another motor than the default."""
    return made(tmp_path_factory, motor="U8")


@pytest.fixture(scope="module")
def two(tmp_path_factory):
    """A study that chooses the motor of both joints."""
    return made(tmp_path_factory, motor=["U8", "VT8020"])


@pytest.fixture(scope="module")
def joints(tmp_path_factory):
    """A study that chooses the motor of the hip."""
    return made(tmp_path_factory, hip_motor=["U8", "VT8020"], knee_motor="U8")


CALLS = {
    "simulate": lambda rows: pm.simulate(rows),
    "simulate a row": lambda rows: pm.simulate(rows.iloc[0]),
    "simulate a list of rows": lambda rows: pm.simulate([C, rows.iloc[0]]),
    "simulate a mapping": lambda rows: pm.simulate(rows.iloc[0].to_dict()),
    "trace": lambda rows: pm.trace(rows.iloc[0]),
    "build_robot": lambda rows: pm.build_robot(rows.iloc[0]),
    "export": lambda rows: pm.export(rows.iloc[0], "out"),
}


@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS.keys())
def test_rows_of_a_study_never_jump_with_a_motor_that_they_do_not_name(call, u8, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    match = r"^motor of design \d = 'U8': must be 'VT8020', which is used here; let StoredStudy\.simulate take .* drop"
    with pytest.raises(DesignError, match=match):
        call(u8.front())
    assert list(tmp_path.iterdir()) == []


def test_rows_of_a_study_jump_with_the_motor_that_they_name(u8):
    front = u8.front()
    for jumps in (pm.simulate(front, motor="u8"), u8.simulate(front)):
        np.testing.assert_array_equal(jumps["height_m"], front["height_m"])
    dropped = pm.simulate(front.drop(columns="motor"))
    assert (dropped["height_m"] != front["height_m"]).all()
    highest = pm.trace(front.iloc[0], motor="U8")["base_z_m"].max()  # by MuJoCo
    assert highest == pytest.approx(front["height_m"][0], rel=1e-9)
    assert pm.build_robot(front.iloc[0], motor="U8").mass_kg == pytest.approx(front["mass_kg"][0], rel=1e-9)


@pytest.mark.parametrize("study", ["two", pytest.param("joints", marks=pytest.mark.long)])
def test_every_row_of_a_stored_study_jumps_with_its_own_motors_in_the_order_given(study, request):
    stored = request.getfixturevalue(study)
    rows = stored.trials[stored.trials["status"] == "ok"].iloc[::-1]
    assert rows["motor"].nunique() == 2
    again = stored.simulate(rows)
    for name in (*NAMES, "height_m", "energy_j", "mass_kg"):
        np.testing.assert_array_equal(again[name], rows[name])
    plain = rows[[name for name in rows if "motor" not in name]]
    first = rows.iloc[0]
    others = stored.simulate(plain, trial=int(first["trial"]))["height_m"].to_numpy()
    np.testing.assert_array_equal(others == rows["height_m"], rows["motor"] == first["motor"])


def test_picked_designs_jump_with_their_motors_alone_and_in_a_list(two):
    numbers = [int(two.trials.loc[i, "trial"]) for i in two.front()["trial"]]
    picked = [two.pick(trial=number) for number in numbers]
    heights = two.front()["height_m"]
    np.testing.assert_array_equal(two.simulate(picked)["height_m"], heights)
    np.testing.assert_array_equal([two.simulate(one)["height_m"][0] for one in picked], heights)
    np.testing.assert_array_equal(two.simulate([picked[0], picked[0].design])["height_m"][0], heights[0])


def test_rows_with_motors_that_a_study_does_not_have_are_refused(u8, two, joints):
    with pytest.raises(DesignError, match=r"motor of design 0 = '.*VT8020.*': must be 'U8', as the study has; take"):
        u8.simulate(joints.trials[joints.trials["hip_motor"] == "VT8020"])
    with pytest.raises(DesignError, match=r"= 'U8 hip, unknown knee': must be 'U8' or 'VT8020'"):
        two.simulate(C.as_dict() | {"hip_motor": "U8"})
    assert len(u8.simulate(C)) == len(u8.simulate(pd.DataFrame([C.as_dict()]).assign(motor=np.nan))) == 1


def test_what_frames_say_of_motors():
    row = C.as_dict()
    said = {
        "U8": {"motor": "U8"},
        "U8 hip, U10 knee": {"hip_motor": "U8", "knee_motor": "U10", "motor": "U8 hip, U10 knee"},
        "U10": {"motor": "U10", "hip_motor": float("nan"), "knee_motor": None},
        "": {"motor": pd.NA},
    }
    frame = pd.DataFrame([row | motors for motors in said.values()])
    assert given_designs(frame).motors == tuple(said)
    assert given_designs([row | motors for motors in said.values()]).motors == tuple(said)
    assert given_designs(row | {"thigh_length_m": [0.4, 0.5], "motor": "U8"}).motors == ("U8", "U8")


@pytest.mark.parametrize("form", [lambda row: row, pd.Series, lambda row: pd.DataFrame([row])])
def test_a_misspelt_optional_variable_does_not_fall_to_its_default(form):
    with pytest.raises(DesignError, match=r"'start_heigth_m' is neither .* did you mean 'start_height_m'\?$"):
        pm.simulate(form(C.as_dict() | {"start_heigth_m": 0.4}))
    with pytest.raises(DesignError, match=r"'note' is neither .* correct the name, or drop it$"):
        pm.simulate(form(C.as_dict() | {"note": "x"}))


def test_one_row_of_a_frame_or_a_mapping_is_one_design_everywhere():
    frame = pd.DataFrame([C.as_dict()])
    jump, steps, robot = pm.simulate(C), pm.trace(C), pm.build_robot(C)
    for one in (frame.iloc[0], C.as_dict(), frame):
        pd.testing.assert_frame_equal(pm.simulate(one), jump, check_exact=True)
        pd.testing.assert_frame_equal(pm.trace(one), steps, check_exact=True)
        assert pm.build_robot(one).mass_kg == robot.mass_kg
    with pytest.raises(DesignError, match="number of designs = 2: must be 1"):
        pm.build_robot(pd.concat([frame, frame]))


@pytest.mark.parametrize("given", [None, 3.0, True])
def test_what_is_no_design_is_not_an_array_of_another_shape(given):
    with pytest.raises(DesignError, match=r"^designs = \S+: must be a Design, a list of them, a mapping or data frame"):
        pm.simulate(given)
