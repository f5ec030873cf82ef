"""Exports and reports from scripts are those of the command line."""

import json

import numpy as np
import pytest

import pareto_monoped as pm
from pareto_monoped.cli import _run as cli
from pareto_monoped.errors import CheckError, InputError, OutputError, SelectionError

STILL = [np.zeros((480, 720, 3), np.uint8)]
C = pm.PAPER_CASES["C"].design


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    return pm.run(pm.Study.define(name="s", evaluations=60, seed=3, audit=False), tmp_path_factory.mktemp("o") / "s.db")


@pytest.mark.usefixtures("unchecked")
@pytest.mark.long
def test_a_design_is_exported_as_by_the_command_line(tmp_path):
    record = pm.export(C, tmp_path / "api", formats=["mjcf", "urdf"])
    assert json.loads((tmp_path / "api" / "design.json").read_text()) == json.loads(json.dumps(record))
    assert cli(["export", "--case", "C", "--formats", "mjcf,urdf", "-o", str(tmp_path / "cli")]) == 0
    said = json.loads((tmp_path / "cli" / "design.json").read_text())
    assert {**said, "source": None} == {**json.loads(json.dumps(record)), "source": None}
    with pytest.raises(OutputError):
        pm.export(C.replace({"stiffness_n_per_m": 9.0}), tmp_path / "api", formats=["mjcf"])


@pytest.mark.long
def test_a_film_of_a_jump_is_written_by_its_ending(tmp_path):
    from PIL import Image

    with Image.open(pm.film(C, tmp_path / "c.gif", slower=1.0)) as drawn:
        assert drawn.n_frames > 5
    with pytest.raises(InputError, match=r"c\.avi': must be a file ending in"):
        pm.film(C, tmp_path / "c.avi")


def test_a_film_is_written_where_it_is_asked_for(tmp_path, monkeypatch):
    """Of three pictures of no jump."""
    pictures = [np.full((480, 720, 3), grey, np.uint8) for grey in (0, 100, 200)]
    monkeypatch.setattr("pareto_monoped.api.outputs.trace", lambda *_, **__: {})
    monkeypatch.setattr("pareto_monoped.api.outputs.build_robot", lambda *_, **__: None)
    monkeypatch.setattr("pareto_monoped.cad.film.film", lambda *_, **__: pictures)
    path = pm.film(C, tmp_path / "c.gif")
    assert path == tmp_path / "c.gif"
    assert path.read_bytes()[:6] == b"GIF89a"


@pytest.mark.usefixtures("unchecked")
def test_a_trial_is_exported_with_what_its_study_stores(stored, tmp_path):
    picked = stored.pick("knee")
    record = pm.export_trial(stored, picked, tmp_path / "knee", formats=["dxf"])
    assert record["jumps"]["searched"]["height_m"] == pytest.approx(picked.row["height_m"], rel=1e-9)  # by MuJoCo
    assert repr(record) == f"Export({str(tmp_path / 'knee')!r}, {len(record.files)} files, {record['mass_kg']:.2f} kg)"
    assert all(path.is_file() for path in record.files)
    for study in (stored, stored.path):
        with pytest.raises(SelectionError, match="trial = 9999"):
            pm.export_trial(study, 9999, tmp_path / "none")
    assert not (tmp_path / "none").exists()


@pytest.mark.long
def test_a_design_that_does_not_hold_is_refused_unless_asked(tmp_path, request):
    weak = C.replace({"hip_ratio": 8.7, "knee_ratio": 8.7, "stiffness_n_per_m": 20.0})
    with pytest.raises(CheckError):
        pm.export(weak, tmp_path / "weak", formats=["mjcf"])
    assert not (tmp_path / "weak").exists()
    request.getfixturevalue("unchecked")  # all checks but that of strength have passed
    pm.export(weak, tmp_path / "weak", formats=["mjcf"], strength=False)


def test_a_report_is_written_and_not_over_something_else(stored, tmp_path):
    pm.write_report(stored.path, tmp_path / "r.html")
    assert "</html>" in (tmp_path / "r.html").read_text(encoding="utf-8")
    pm.write_report([stored.path], str(tmp_path / "r.html"))
    by_path = (tmp_path / "r.html").read_text(encoding="utf-8")
    pm.write_report(stored, tmp_path / "r.html")
    assert len((tmp_path / "r.html").read_text(encoding="utf-8")) == len(by_path)
    with pytest.raises(InputError, match=r"^studies = DataFrame: must be a study as load_study returns it, the path"):
        pm.write_report(stored.front(), tmp_path / "r.html")
    (tmp_path / "notes.html").write_text("mine")
    with pytest.raises(OutputError):
        pm.write_report(stored.path, tmp_path / "notes.html")
    assert (tmp_path / "notes.html").read_text() == "mine"


def test_a_film_has_the_motors_of_either_joint(tmp_path, monkeypatch):
    asked = []
    monkeypatch.setattr("pareto_monoped.cad.film.film", lambda robot, steps, **_: asked.append((robot, steps)) or STILL)
    pm.film(C, tmp_path / "c.gif", hip_motor="U8", knee_motor="VT8020")
    ((robot, steps),) = asked
    assert (robot.hip.motor.name, robot.knee.motor.name) == ("U8", "VT8020")
    traced, exchanged = (pm.trace(C, **{f"{joint}_motor": "U8"}) for joint in ("hip", "knee"))
    np.testing.assert_array_equal(steps["base_z_m"], traced["base_z_m"])
    assert traced["base_z_m"].max() != exchanged["base_z_m"].max()


@pytest.mark.parametrize(
    ("asked", "found"),
    [
        ({"motor": "U8"}, ("U8", "U8")),
        ({"motor": "U8", "hip_motor": "VT8020"}, ("VT8020", "U8")),
        ({"motor": "U8", "knee_motor": "VT8020"}, ("U8", "VT8020")),
    ],
)
def test_an_export_has_the_motors_of_either_joint(tmp_path, monkeypatch, asked, found):
    jobs = []
    monkeypatch.setattr("pareto_monoped.cad.batch.run", lambda job: jobs.append(job) or {})
    pm.export(C, tmp_path, **asked)
    maps = jobs[0].maps()
    assert (maps.hip.motor.name, maps.knee.motor.name) == found
