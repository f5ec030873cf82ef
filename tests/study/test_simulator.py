import json
from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.actuator.motors import motor_names
from pareto_monoped.errors import CalibrationError, DatabaseError, MotorError
from pareto_monoped.jump.calibration import calibration_names
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.simulator import continued_simulator, load_simulator, stored_simulator
from tests.study.support import copied_database, made_study


def stored(data, simulator):
    """The study as if it had been stored with this simulator, through JSON as in the database."""
    return replace(data, meta=replace(data.meta, contents=json.loads(json.dumps(simulator.contents))))


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    path = tmp_path_factory.mktemp("stored") / "s.db"
    copied_database(path)
    return read_study(path)


def test_the_probe_is_a_fingerprint_of_the_results():
    first, again = (load_simulator(made_study(), workers=w).probe() for w in (1, 2))
    assert first == again
    assert load_simulator(made_study(calibration="ideal"), workers=1).probe() != first
    assert all(0.5 < height < 3.0 and energy > 0.0 for height, energy in first if height is not None)


def test_contents_hold_every_value_of_motor_and_calibration():
    simulator = load_simulator(made_study(motor="U8"), workers=1)
    assert simulator.contents["motor"]["name"] == "U8"
    assert simulator.contents["motor"]["rated_voltage_v"] == 24
    assert simulator.contents["calibration"]["simulation"]["timestep_s"] == simulator.calibration.simulation.timestep_s
    assert simulator.files == {"motor": None, "calibration": None}


@pytest.mark.parametrize(
    ("motor", "calibration"),
    [
        # A motor and a calibration are stored each by itself: every one of either, every pair in the long tests.
        pytest.param(
            motor, calibration, marks=() if motor == "VT8020" or calibration == "reference" else pytest.mark.long
        )
        for motor in motor_names()
        for calibration in calibration_names()
    ],
)
def test_stored_contents_give_the_same_motor_and_calibration_to_the_last_bit(data, motor, calibration):
    first = load_simulator(made_study(motor=motor, calibration=calibration), workers=1)
    again = stored_simulator(stored(data, first), workers=1)
    # All their values are numbers, text and None; repr() tells any two floats apart.
    assert repr(again.motors) == repr(first.motors)
    assert repr(again.calibration) == repr(first.calibration)
    assert json.dumps(again.contents) == json.dumps(first.contents)
    assert again.evaluator.actuator_map == first.evaluator.actuator_map


def test_a_users_files_are_not_needed_again(data, tmp_path):
    from importlib import resources

    folder = resources.files("pareto_monoped") / "data" / "calibrations"
    text = (folder / "reference.toml").read_text().replace('name = "reference"', 'name = "mine"')
    (tmp_path / "mine.toml").write_text(text)
    first = load_simulator(made_study(calibration=str(tmp_path / "mine.toml")), workers=1)
    assert first.files == {"motor": None, "calibration": text}
    (tmp_path / "mine.toml").unlink()
    again = stored_simulator(stored(data, first), workers=1)
    design = np.array([[0.4, 0.4, 6.0, 6.0, 50.0, 2.5, 10.0]])
    assert again.evaluator(design).height_m == first.evaluator(design).height_m


OWN = """
kv_rpm_per_v = 100.0
max_continuous_current_a = 40.0
rated_voltage_v = 48.0
winding_resistance_ohm = 0.06
framed = { mass_kg = 0.71, outer_diameter_mm = 89.0, length_mm = 50.0 }
"""


def with_stored_inertia(data, simulator):
    """The study as a version with another estimate of the rotor would have stored it, and its names and files."""
    bent = stored(data, simulator)
    contents = bent.meta.contents | {"motor": bent.meta.contents["motor"] | {"rotor_inertia_kg_m2": 1e-3}}
    return replace(bent, meta=replace(bent.meta, contents=contents, files=dict(simulator.files)))


@pytest.mark.parametrize("shipped", [True, False])
def test_what_the_user_has_not_changed_is_as_stored(data, tmp_path, shipped):
    (tmp_path / "own.toml").write_text(OWN)
    study = made_study() if shipped else made_study(motor=str(tmp_path / "own.toml"))
    before = with_stored_inertia(replace(data, study=study), load_simulator(study, workers=1))
    again = continued_simulator(before, study, workers=1)
    assert again.contents == before.meta.contents
    assert again.motors[0].rotor_inertia_kg_m2 == 1e-3


@pytest.mark.parametrize("change", ["another shipped motor", "another file", "the file's text", "from name to file"])
def test_what_the_user_has_changed_is_read_again(data, tmp_path, change):
    own = tmp_path / "own.toml"
    own.write_text(OWN)
    named = change in ("another shipped motor", "from name to file")
    study = made_study() if named else made_study(motor=str(own))
    before = with_stored_inertia(replace(data, study=study), load_simulator(study, workers=1))
    if change == "another shipped motor":
        study = made_study(motor="U8")
    elif change == "another file":
        (tmp_path / "other.toml").write_text(OWN.replace("0.06", "0.07"))
        study = made_study(motor=str(tmp_path / "other.toml"))
    elif change == "the file's text":
        own.write_text(OWN.replace("0.06", "0.07"))
    else:
        study = made_study(motor=str(own))
    again = continued_simulator(before, study, workers=1)
    assert again.motors == load_simulator(study, workers=1).motors
    assert again.contents != before.meta.contents


@pytest.mark.parametrize("name", ["../../../etc/passwd.toml", "/etc/cron.d/x.toml", "..", ".toml"])
def test_a_strangers_file_name_leads_nowhere(data, tmp_path, monkeypatch, name):
    """Names and texts of files in a database are never used."""
    monkeypatch.chdir(tmp_path)
    bent = stored(data, load_simulator(made_study(), workers=1))
    study = replace(data.study, motor=name, calibration=name)
    meta = replace(bent.meta, motor=name, calibration=name, files={"motor": "x = ", "calibration": "x = "})
    simulator = stored_simulator(replace(bent, study=study, meta=meta), workers=1)
    assert (simulator.motors[0].name, simulator.calibration.name) == ("VT8020", "reference")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("part", "key", "value", "words"),
    [
        ("motor", "winding_resistance_ohm", -1.0, "winding_resistance_ohm = -1.0"),
        ("motor", "mount_holes", "none", "mount_holes = 'none'"),
        ("motor", "surprise", 1, "unknown key 'surprise'"),
        ("calibration", "version", 0, "version = 0"),
        ("calibration", "simulation", {"integrator": "Euler", "timestep_s": 1e-9}, "timestep_s = 1e-09: must be at"),
    ],
)
def test_damaged_contents_are_refused(data, part, key, value, words):
    bent = stored(data, load_simulator(made_study(), workers=1))
    bent.meta.contents[part][key] = value
    with pytest.raises(DatabaseError, match=words) as caught:
        stored_simulator(bent, workers=1)
    assert str(caught.value).startswith(f"study database {str(data.db)!r}: ")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("part", ["motor", "calibration"])
def test_missing_contents_are_refused(data, part):
    bent = stored(data, load_simulator(made_study(), workers=1))
    del bent.meta.contents[part]
    with pytest.raises(DatabaseError, match="is missing"):
        stored_simulator(bent, workers=1)


def test_unknown_names_are_refused():
    with pytest.raises(MotorError):
        load_simulator(made_study(motor="none such"), workers=1)
    with pytest.raises(CalibrationError):
        load_simulator(made_study(calibration="none such"), workers=1)
