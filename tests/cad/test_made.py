"""An export counts as made only if it is whole and is what would be made today."""

import dataclasses
import json
import math
import shutil

import pytest

from pareto_monoped.cad import batch
from pareto_monoped.cad.jobs import Job, case_job
from pareto_monoped.cad.records import is_made
from pareto_monoped.design import PAPER_CASES

FORMATS = ("dxf", "urdf")


@pytest.fixture(scope="module")
def original(unchecked_module, tmp_path_factory) -> Job:
    """An export of the nominal design."""
    job = case_job("nominal", folder=tmp_path_factory.mktemp("made") / "robot", formats=FORMATS)
    batch.run(job)
    return job


@pytest.fixture
def copy(original, tmp_path) -> Job:
    """The same export in a folder of its own, to be damaged."""
    shutil.copytree(original.folder, tmp_path / "robot")
    return dataclasses.replace(original, folder=tmp_path / "robot")


def edit(job, change):
    path = job.folder / "design.json"
    record = json.loads(path.read_text())
    change(record)
    path.write_text(json.dumps(record))


def test_an_export_is_made_once_it_is_there(original, tmp_path):
    assert is_made(original)
    assert not is_made(dataclasses.replace(original, folder=tmp_path / "robot"))


def test_a_copied_export_and_other_files_beside_it_change_nothing(copy):
    (copy.folder / "mine.txt").write_text("")
    assert is_made(copy)


def test_fewer_formats_are_made_and_more_are_not(original):
    assert is_made(dataclasses.replace(original, formats=("urdf",)))
    assert is_made(dataclasses.replace(original, formats=()))
    assert not is_made(dataclasses.replace(original, formats=("dxf", "urdf", "stl")))


@pytest.mark.parametrize("name", PAPER_CASES["nominal"].design.as_dict())
def test_an_export_of_another_design_is_stale(original, name):
    value = getattr(original.design, name)
    other = original.design.replace({name: math.nextafter(value, math.inf)})
    assert not is_made(dataclasses.replace(original, design=other))


@pytest.mark.long
def test_an_export_with_another_motor_is_stale(original):
    heavier = dataclasses.replace(
        original.motor, framed=dataclasses.replace(original.motor.framed, mass_kg=original.motor.framed.mass_kg + 1e-3)
    )
    assert not is_made(dataclasses.replace(original, motor=heavier))


def test_an_export_with_another_calibration_is_stale(original):
    version = original.calibration.version + 1
    other = dataclasses.replace(original.calibration, version=version)
    assert not is_made(dataclasses.replace(original, calibration=other))


def test_an_export_from_another_study_is_stale(original):
    assert not is_made(dataclasses.replace(original, source={"case": "A"}))


def test_an_export_in_another_pose_is_stale(original):
    pose = json.loads((original.folder / "design.json").read_text())["pose"]
    assert is_made(dataclasses.replace(original, hip_rad=pose["hip_rad"], knee_rad=pose["knee_rad"]))
    for name in ("hip_rad", "knee_rad"):
        other = dataclasses.replace(original, **{name: pose[name] + 1e-3})
        assert not is_made(other)
        assert is_made(other, any_pose=True)


@pytest.mark.parametrize("jump", ["as_built", "stand"])
def test_a_robot_that_cannot_stand_has_no_models_of_its_jumps(copy, jump):
    edit(copy, lambda record: record["formats"].append("mjcf"))
    job = dataclasses.replace(copy, formats=("mjcf",))
    assert not is_made(job)
    edit(copy, lambda record: record["jumps"][jump].update(status="cannot_stand"))
    assert is_made(job)


def test_an_export_by_another_version_is_stale(original, monkeypatch):
    monkeypatch.setattr("pareto_monoped.cad.as_built.MADE_BY", "pareto-monoped 99.0")
    assert not is_made(original)


def test_an_export_whose_geometry_came_out_otherwise_is_stale(copy):
    edit(copy, lambda record: record.update(mass_kg=record["mass_kg"] * (1.0 + 1e-6)))
    assert not is_made(copy)


def test_last_digits_of_another_machine_do_not_make_an_export_stale(copy):
    edit(copy, lambda record: record.update(mass_kg=record["mass_kg"] * (1.0 + 1e-12)))
    assert is_made(copy)


@pytest.mark.parametrize(
    "name", ["bom.csv", "checks.json", "README.md", "model/monoped.urdf", "laser/shank_plate_near.dxf"]
)
def test_an_export_with_a_missing_or_empty_file_is_not_made(copy, name):
    (copy.folder / name).write_text("")
    assert not is_made(copy)
    (copy.folder / name).unlink()
    assert not is_made(copy)


@pytest.mark.parametrize("name", ["bom.csv", "design.json", "model/monoped.urdf"])
def test_a_record_that_no_longer_lists_a_file_is_not_believed(copy, name):
    edit(copy, lambda record: record["files"].remove(name))
    assert not is_made(copy)


def test_a_record_that_lists_no_file_of_a_folder_is_not_believed(copy):
    edit(copy, lambda record: record.update(files=[f for f in record["files"] if not f.startswith("laser/")]))
    assert not is_made(copy)


_KEYS = (
    *("made_by", "motor", "calibration", "source", "searched", "as_built", "jumps", "mass_kg", "pose", "actuators"),
    *("formats", "motor_data", "calibration_data", "files"),
)


@pytest.mark.parametrize("key", _KEYS)
def test_a_record_without_one_of_its_keys_is_not_believed(copy, key):
    edit(copy, lambda record: record.pop(key))
    assert not is_made(copy)


@pytest.mark.parametrize(
    ("keys", "value"),
    [
        (("searched", "knee_ratio"), 6.1),
        (("as_built", "thigh_length_m"), 0.41),
        (("pose", "hip_rad"), 0.1),
        (("actuators", "hip", "planets"), 4),
        (("motor_data", "kv_rpm_per_v"), 1.0),
        (("calibration_data", "name"), "other"),
        (("motor",), "U8"),
        (("made_by",), "somebody else"),
        (("source", "case"), "A"),
    ],
)
def test_an_edited_record_is_not_believed(copy, keys, value):
    def change(record):
        for key in keys[:-1]:
            record = record[key]
        assert record[keys[-1]] != value
        record[keys[-1]] = value

    edit(copy, change)
    assert not is_made(copy)


@pytest.mark.parametrize("text", ["", "{", "[]", "null", '"x"', "[" * 100_000, "half"])
def test_a_truncated_or_senseless_record_is_not_believed(copy, text):
    path = copy.folder / "design.json"
    whole = path.read_text()
    path.write_text(whole[: len(whole) // 2] if text == "half" else text)
    assert not is_made(copy)


def test_a_stale_export_is_made_again(copy):
    (copy.folder / "model" / "monoped.urdf").unlink()
    batch.run(dataclasses.replace(copy, force=True))
    assert is_made(copy)
    assert (copy.folder / "model" / "monoped.urdf").is_file()


def test_a_design_that_cannot_be_built_is_never_made(copy):
    design = copy.design.replace({"knee_ratio": 99.0})
    edit(copy, lambda record: record["searched"].update(knee_ratio=99.0))
    assert not is_made(dataclasses.replace(copy, design=design))
