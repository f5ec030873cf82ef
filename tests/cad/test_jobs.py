"""An export is made again from its design.json alone, byte for byte; a damaged or hostile record is refused."""

import json
from dataclasses import asdict
from importlib import resources
from pathlib import Path

import pytest

from pareto_monoped.actuator.motors import load_motor
from pareto_monoped.cad import batch, jobs, records
from pareto_monoped.cli import main
from pareto_monoped.config import checked
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.errors import InputError
from pareto_monoped.jump.calibration import load_calibration

FORMATS = ("dxf", "mjcf", "urdf", "3mf")


def contents(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


@pytest.fixture(scope="module")
def original(unchecked_module, tmp_path_factory):
    """An export with a motor and a calibration of the user's own, whose files are gone by now; and where it lies."""
    place = tmp_path_factory.mktemp("record")
    motor, model = place / "mine.toml", place / "soft.toml"
    motor.write_text(
        'description = "a user\'s own"\nkv_rpm_per_v = 90.0\nrated_voltage_v = 48.0\nmax_continuous_current_a = 38.0\n'
        "winding_resistance_ohm = 0.07\n"
        "framed = { mass_kg = 0.7, outer_diameter_mm = 88.0, length_mm = 45.0 }\n"
    )
    shipped = resources.files("pareto_monoped") / "data" / "calibrations" / "reference.toml"
    model.write_text(shipped.read_text().replace('name = "reference"', 'name = "soft"'))
    design = PAPER_CASES["C"].design.replace({"thigh_length_m": 0.412345, "knee_ratio": 6.55, "hip_ratio": 6.55})
    job = jobs.Job(
        design=design,
        motor=load_motor(str(motor)),
        calibration=load_calibration(str(model)),
        folder=place / "export",
        formats=FORMATS,
        source={"study": "mine", "trial": 7},
        knee_rad=1.25,
        rules="paper",  # whose map of a new motor is found in half the time
    )
    batch.run(job)
    motor.unlink()
    model.unlink()
    return job.folder


def export(capsys, *words):
    with pytest.raises(SystemExit) as end:
        main(["export", *(str(word) for word in words)])
    printed = capsys.readouterr()
    return end.value.code, printed.out, printed.err


def test_an_export_is_made_again_byte_for_byte(original, tmp_path, capsys):
    code, out, err = export(capsys, "--record", original / "design.json", "-o", tmp_path / "again")
    assert code == 0
    assert [line.split()[0] for line in out.splitlines()] == ["searched", "as"]
    assert "was made by" not in err
    before, after = contents(original), contents(tmp_path / "again")
    assert {"design.json", "bom.csv", "README.md", "checks.json", "model/monoped.xml"} <= set(before)
    assert set(before) == set(after)
    assert [name for name in before if before[name] != after[name]] == []
    record = json.loads(before["design.json"])
    assert record["motor"] == record["motor_data"]["name"] == "mine"
    assert record["calibration"] == "soft-4"
    assert record["pose"]["knee_rad"] == 1.25


def test_formats_of_the_record_can_be_limited(original, tmp_path):
    job = records.record_job(original / "design.json", folder=tmp_path / "again", formats=["dxf"])
    assert job.formats == ("dxf",)
    assert records.record_job(original / "design.json", folder=tmp_path / "again").formats == tuple(
        name for name in jobs.FORMATS if name in FORMATS
    )


@pytest.mark.parametrize("name", ["VT8020", "U8", "MN8014"])
def test_a_motor_comes_back_from_its_values(name):
    motor = load_motor(name)
    assert checked(type(motor), json.loads(json.dumps(asdict(motor))), source="") == motor


def test_each_joint_gets_its_own_motor_back(tmp_path):
    """From a record of another version, of which no jumps are simulated."""
    job = jobs.case_job("B", motor="U8", knee_motor="VT8020", rules="paper", folder=tmp_path)
    record = records.expected_record(job) | {"made_by": "pareto-monoped 0", "formats": []}
    (tmp_path / "design.json").write_text(json.dumps(record))
    again = records.record_job(tmp_path / "design.json", folder=tmp_path / "again")
    assert (again.motor, again.knee_motor) == (job.motor, job.knee_motor)


def damaged(change):
    """A function that changes a good record's values."""

    def written(original: Path, path: Path) -> Path:
        record = json.loads((original / "design.json").read_text())
        changed = change(record)
        path.write_text(changed if isinstance(changed, str) else json.dumps(record))
        return path

    return written


def drop(*keys):
    def change(record):
        inner = record
        for key in keys[:-1]:
            inner = inner[key]
        del inner[keys[-1]]

    return change


def put(value, *keys):
    def change(record):
        inner = record
        for key in keys[:-1]:
            inner = inner[key]
        inner[keys[-1]] = value

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda _: "", "not the record of an export (no JSON text: line 1, column 1); give the design.json of one"),
        (lambda _: '{\n"searched": }', "(no JSON text: line 2, column 13)"),
        (lambda _: "[1, 2]", "(no JSON object)"),
        (lambda _: "[" * 100000, "not the record of an export"),
        (lambda _: "\ufffd\x00", "(no JSON text: line 1, column 1)"),
        (put(5, "formats"), "(formats = 5 is no list)"),
        (drop("searched"), "no 'searched'"),
        (drop("searched", "hip_ratio"), "no 'hip_ratio'"),
        (drop("motor_data"), "no 'motor_data'"),
        (drop("calibration_data"), "no 'calibration_data'"),
        (drop("pose"), "no 'pose'"),
        (put("tall", "searched", "thigh_length_m"), '(thigh_length_m = "tall" is not a number)'),
        (put(float("nan"), "searched", "thigh_length_m"), "thigh_length_m = NaN is not a number"),
        (put(10**400, "searched", "stiffness_n_per_m"), "is not a number)"),
        (put(float("inf"), "pose", "hip_rad"), "hip_rad = Infinity is not a number"),
        (put(-0.4, "searched", "shank_length_m"), "shank_length_m"),
        (put(99.0, "searched", "knee_ratio"), "gear ratio = 99.0"),
        (put(["step", "../../x"], "formats"), "format = '../../x': must be one of"),
        (put(-1.0, "motor_data", "kv_rpm_per_v"), "kv_rpm_per_v = -1.0"),
        (put(1e9, "motor_data", "framed", "outer_diameter_mm"), "framed.outer_diameter_mm = 1000000000.0"),
        (put({"os": "rm"}, "motor_data", "extra"), "unknown key 'extra'"),
        (put("../../etc", "calibration_data", "name"), "name = '../../etc'"),
        (drop("calibration_data", "contact"), "contact is missing"),
        (put("motor", "motor_data"), "(motor_data has no fields)"),
        (put("x", "source"), "(source has no fields)"),
    ],
)
def test_a_damaged_or_hostile_record_is_one_line_and_writes_nothing(original, tmp_path, capsys, change, message):
    path = damaged(change)(original, tmp_path / "design.json")
    code, out, err = export(capsys, "--record", path, "-o", tmp_path / "out")
    assert code == 2
    assert out == ""
    assert message in err
    assert len([line for line in err.splitlines() if not line.endswith(" ...")]) == 1
    assert [entry.name for entry in tmp_path.iterdir()] == ["design.json"]


def more(*keys):
    """Add a thousandth and a bit."""

    def change(record):
        inner = record
        for key in keys[:-1]:
            inner = inner[key]
        inner[keys[-1]] *= 1.0011

    return change


@pytest.mark.parametrize(
    ("change", "field"),
    [
        (more("as_built", "thigh_length_m"), "as_built.thigh_length_m"),
        (more("as_built", "knee_ratio"), "as_built.knee_ratio"),
        (more("searched", "stiffness_n_per_m"), "design_hash"),
        (more("jumps", "searched", "height_m"), "jumps.searched.height_m"),
        (more("jumps", "as_built", "energy_j"), "jumps.as_built.energy_j"),
        (put("slipped", "jumps", "as_built", "status"), "jumps.as_built.status"),
        (more("mass_kg"), "mass_kg"),
        (more("actuators", "hip", "peak_torque_n_m"), "actuators.hip.peak_torque_n_m"),
        (put(17, "actuators", "knee", "sun_teeth"), "actuators.knee.sun_teeth"),
        (drop("actuators", "knee", "family"), "actuators.knee.family"),
        (put("U12", "motor"), "motor"),
        (put("reference-3", "calibration"), "calibration"),
        (drop("jumps"), "jumps"),
        (put(1, "invented"), "invented"),
    ],
)
def test_a_tampered_record_is_refused_with_the_field_that_disagrees(original, tmp_path, capsys, change, field):
    path = damaged(change)(original, tmp_path / "design.json")
    code, out, err = export(capsys, "--record", path, "-o", tmp_path / "out")
    assert code == 2
    assert out == ""
    assert len(err.splitlines()) == 1
    assert f"design.json': {field} = " in err
    assert "give the record as its export wrote it" in err
    assert [entry.name for entry in tmp_path.iterdir()] == ["design.json"]


@pytest.mark.parametrize(
    ("change", "refused"),
    [
        (put("pareto-monoped 0.1.0", "made_by"), None),
        (put(7.0, "as_built", "knee_ratio"), None),
        (put(9.0, "mass_kg"), None),
        (more("as_built", "thigh_length_m"), "as_built.thigh_length_m"),
        (put("U12", "motor"), "motor"),
    ],
)
def test_of_another_version_only_what_no_version_changes_is_compared(original, tmp_path, change, refused):
    def older(record):
        change(record)
        record["made_by"] = "pareto-monoped 0.1.0"

    path, notes = damaged(older)(original, tmp_path / "design.json"), []
    if refused is None:
        records.record_job(path, folder=tmp_path / "out", note=notes.append)
        assert len(notes) == 1
    else:
        with pytest.raises(InputError, match=f"{refused} = "):
            records.record_job(path, folder=tmp_path / "out", note=notes.append)


def test_a_missing_record_is_one_line(tmp_path, capsys):
    code, _, err = export(capsys, "--record", tmp_path / "none.json", "-o", tmp_path / "out")
    assert code == 2
    assert "cannot be read (No such file or directory)" in err
    assert len(err.splitlines()) == 1


@pytest.mark.usefixtures("unchecked")
def test_names_in_a_record_cannot_lead_outside_its_folder(original, tmp_path):
    outside = tmp_path / "precious.txt"
    outside.write_text("keep me")

    def hostile(record):
        record["motor_data"]["name"] = record["motor"] = "../../precious.txt"
        record["source"] = {"study": "../../x", "trial": "/etc/passwd"}
        record["files"] = ["../precious.txt", str(outside)]
        record["made_by"] = "../../x"

    path = damaged(hostile)(original, tmp_path / "design.json")
    notes = []
    folder = tmp_path / "out"
    batch.run(records.record_job(path, folder=folder, formats=(), note=notes.append))
    assert len(notes) == 1
    assert "was made by '../../x'" in notes[0]
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["design.json", "out", "precious.txt"]
    assert outside.read_text() == "keep me"
    assert {path.parent for path in folder.rglob("*")} == {folder, folder / "cad"}


def test_a_record_without_its_own_words_is_refused():
    with pytest.raises(InputError, match=r"give the design\.json of an export"):
        records.record_job(Path("/"), folder=Path("x"))


@pytest.mark.parametrize(
    "words", [("study.db",), ("--case", "C"), ("--knee",), ("--front",), ("--hip-deg", "3"), ("--knee-deg", "3")]
)
def test_a_record_stands_alone(original, tmp_path, capsys, words):
    code, _, err = export(capsys, "--record", original / "design.json", "-o", tmp_path / "x", *words)
    assert code == 2
    assert "--record takes no" in err
    assert list(tmp_path.iterdir()) == []
