"""A job carries what its source says: the trial's design, the study's motor and jump model, the angles asked for."""

import math
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from pareto_monoped.actuator.motors import load_motor
from pareto_monoped.actuator.ratiomap import JointMaps, joint_maps
from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad import batch
from pareto_monoped.cad.jobs import case_job, front_jobs, trial_job
from pareto_monoped.cad.write.folder import FORMATS
from pareto_monoped.cli import main
from pareto_monoped.design import LOWER, NAMES, PAPER_CASES, UPPER, complete
from pareto_monoped.errors import InputError
from pareto_monoped.jump.calibration import load_calibration


@pytest.fixture
def data():
    """A study of ten trials with a motor and a calibration that are not the defaults; its front is 7, 2, 5, 4, 0."""
    values = complete(np.random.default_rng(1).uniform(LOWER, UPPER, size=(10, len(LOWER))))
    trials = pd.DataFrame(values, columns=list(NAMES)).assign(trial=np.arange(10))
    return SimpleNamespace(
        trials=trials,
        front=lambda: trials.set_index("trial", drop=False).loc[[7, 2, 5, 4, 0]].reset_index(drop=True),
        motor=load_motor("U8"),
        kit_of_trial=lambda trial: joint_maps(map_for("U8")),
        calibration=load_calibration("ideal"),
        study=SimpleNamespace(strength=False, name="mine", rules="iso6336"),
        meta=SimpleNamespace(created="2025-03-04T05:06:07+00:00"),
        content_hash="12ab",
        sealed=True,
    )


def test_a_trial_is_exported_with_its_design_and_the_study_s_motor_and_calibration(data, tmp_path):
    job = trial_job(data, 4, folder=tmp_path, formats=["stl", "step"], force=True, hip_rad=0.1, knee_rad=0.2)
    assert job.design.as_array() == pytest.approx(data.trials.loc[4, list(NAMES)].to_numpy(float), abs=0.0)
    assert (job.motor, job.calibration, job.rules) == (data.motor, data.calibration, "iso6336")
    expected = {"study": "mine", "trial": 4, "date": "2025-03-04", "content_hash": "12ab", "sealed": True}
    assert job.source == expected
    assert (job.folder, job.formats, job.force) == (tmp_path, ("step", "stl"), True)
    assert (job.hip_rad, job.knee_rad) == (0.1, 0.2)


def test_each_joint_has_its_own_motor_and_shared_ones_are_named_once(data, tmp_path):
    assert trial_job(data, 4, folder=tmp_path).knee_motor is None
    assert case_job("B", folder=tmp_path).knee_motor is None
    data.kit_of_trial = lambda trial: JointMaps(hip=map_for("U8"), knee=map_for("MN8014"))
    for job in (
        trial_job(data, 4, folder=tmp_path),
        case_job("B", motor="U8", knee_motor="MN8014", folder=tmp_path),
    ):
        assert (job.motor.name, job.knee_motor.name) == ("U8", "MN8014")
        assert [job.maps().of(joint).motor.name for joint in ("hip", "knee")] == ["U8", "MN8014"]


def test_a_front_is_exported_in_its_order_each_n_th_from_the_first(data, tmp_path):
    assert [job.source["trial"] for job in front_jobs(data, folder=tmp_path)] == [7, 2, 5, 4, 0]
    jobs = front_jobs(data, folder=tmp_path, every=2, formats=["dxf"])
    assert [job.folder for job in jobs] == [tmp_path / name for name in ("trial_7", "trial_5", "trial_0")]
    assert all(job.formats == ("dxf",) and job.hip_rad is None and not job.force for job in jobs)


def test_a_row_of_table_1_has_the_paper_s_motor_and_the_reference_calibration(tmp_path):
    job = case_job("B", folder=tmp_path, hip_rad=0.1, knee_rad=0.2)
    assert job.design == PAPER_CASES["B"].design
    assert (job.motor.name, job.calibration.name, job.rules) == ("VT8020", "reference", "iso6336")
    assert case_job("B", folder=tmp_path, rules="paper").rules == "paper"
    assert (job.hip_rad, job.knee_rad, job.formats) == (0.1, 0.2, FORMATS)
    with pytest.raises(InputError, match="format = 'dwg'"):
        case_job("B", folder=tmp_path, formats=["dwg"])


def test_the_command_line_s_angles_are_degrees_of_the_joint_they_name(monkeypatch, tmp_path):
    asked = []

    def run(job, *, progress, note):
        asked.append(job)
        jump = {"height_m": 1.0, "energy_j": 2.0, "status": "ok"}
        return {"files": [], "jumps": {"searched": jump, "as_built": jump}}

    monkeypatch.setattr(batch, "run", run)
    with pytest.raises(SystemExit):
        main(["export", "--case", "C", "-o", str(tmp_path), "--hip-deg", "-30", "--knee-deg", "90", "--formats", "stl"])
    (job,) = asked
    assert job.hip_rad == pytest.approx(-math.pi / 6.0)
    assert job.knee_rad == pytest.approx(math.pi / 2.0)
    assert job.formats == ("stl",)
