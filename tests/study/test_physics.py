import numpy as np
import pytest

from pareto_monoped.errors import CalibrationError, MotorError
from pareto_monoped.study.physics import load_physics
from tests.study.support import made_study


def test_the_probe_is_a_fingerprint_of_the_results():
    first, again = (load_physics(made_study(), workers=w).probe() for w in (1, 2))
    assert first == again
    assert load_physics(made_study(calibration="ideal"), workers=1).probe() != first
    assert all(0.5 < height < 3.0 and energy > 0.0 for height, energy in first if height is not None)


def test_contents_hold_every_value_of_motor_and_calibration():
    physics = load_physics(made_study(motor="U8"), workers=1)
    assert physics.contents["motor"]["name"] == "U8"
    assert physics.contents["motor"]["rated_voltage_v"] == 24
    assert physics.contents["calibration"]["simulation"]["timestep_s"] == physics.calibration.simulation.timestep_s
    assert physics.files == {"motor": None, "calibration": None}


def test_a_users_file_and_its_stored_text_give_the_same(tmp_path):
    from importlib import resources

    text = (resources.files("pareto_monoped") / "data" / "calibrations" / "reference.toml").read_text()
    (tmp_path / "mine.toml").write_text(text.replace('name = "reference"', 'name = "mine"'))
    study = made_study(calibration=str(tmp_path / "mine.toml"))
    first = load_physics(study, workers=1)
    (tmp_path / "mine.toml").unlink()
    again = load_physics(study, workers=1, files=first.files)
    assert again.contents == first.contents
    design = np.array([[0.4, 0.4, 6.0, 6.0, 50.0, 2.5, 10.0]])
    assert again.evaluator(design).height_m == first.evaluator(design).height_m


@pytest.mark.parametrize("name", ["../../../etc/passwd.toml", "/etc/cron.d/x.toml", "..", ".toml"])
def test_a_strangers_file_name_leads_nowhere(tmp_path, monkeypatch, name):
    """The text is not valid, so nothing may exist after; the name's folders are never made or written to."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(CalibrationError, match="not valid TOML"):
        load_physics(made_study(calibration=name), workers=1, files={"motor": None, "calibration": "x = "})
    assert list(tmp_path.iterdir()) == []


def test_unknown_names_are_refused():
    with pytest.raises(MotorError):
        load_physics(made_study(motor="none such"), workers=1)
    with pytest.raises(CalibrationError):
        load_physics(made_study(calibration="none such"), workers=1)
