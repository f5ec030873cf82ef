"""The folder is complete or absent, foreign files are safe, and the same design gives the same bytes."""

import dataclasses
import gc
import json

import pytest

from pareto_monoped.cad import batch, export, jobs
from pareto_monoped.cad.as_built import as_built, require_fit
from pareto_monoped.cad.check.result import Check
from pareto_monoped.cad.export import export_design
from pareto_monoped.cad.records import is_made
from pareto_monoped.cad.write.folder import safe
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.errors import CheckError, DesignError, DiskError, InputError, OutputError
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.robot.build import build_robot

DESIGN = PAPER_CASES["nominal"].design
LIGHT = ("dxf", "3mf")


def contents(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_as_built_rounds_lengths_and_takes_the_gearbox_s_ratio(actuator_map):
    design = DESIGN.replace({"thigh_length_m": 0.43216, "shank_length_m": 0.33333, "knee_ratio": 7.97})
    built = as_built(design, actuator_map)
    assert (built.thigh_length_m, built.shank_length_m) == (0.4322, 0.3333)
    assert built.knee_ratio == actuator_map.lookup(7.97).ratio
    assert built.stiffness_n_per_m == design.stiffness_n_per_m
    # Building what was built changes nothing.
    assert as_built(built, actuator_map) == built


def test_same_design_same_bytes_and_force_replaces_only_our_own_files(unchecked, actuator_map, calibration, tmp_path):
    folder = tmp_path / "robot"
    export_design(DESIGN, actuator_map, calibration, folder, formats=LIGHT)
    first = contents(folder)
    assert {"README.md", "bom.csv", "checks.json", "design.json", "print/thigh_core.3mf"} <= set(first)
    assert not any(name.endswith((".step", ".stl", ".png", ".xml")) for name in first)
    (folder / "mine.txt").write_text("keep me")
    with pytest.raises(OutputError, match="is not empty; give another folder, or --force"):
        export_design(DESIGN, actuator_map, calibration, folder, formats=LIGHT)
    assert contents(folder) == first | {"mine.txt": b"keep me"}
    export_design(DESIGN, actuator_map, calibration, folder, formats=("dxf",), force=True)
    second = contents(folder)
    assert second.pop("mine.txt") == b"keep me"
    assert not any(name.endswith(".3mf") for name in second)
    assert {n: d for n, d in second.items() if n.startswith("laser/")} == {
        n: d for n, d in first.items() if n.startswith("laser/")
    }
    assert [path.name for path in tmp_path.iterdir()] == ["robot"]


def test_python_collects_as_before_after_an_export(unchecked, monkeypatch, actuator_map, calibration, tmp_path):
    before = gc.get_threshold()
    seen = []
    monkeypatch.setattr(export, "built_of", lambda *_, **__: seen.append(gc.get_threshold()) or 1 / 0)
    with pytest.raises(ZeroDivisionError):
        export_design(DESIGN, actuator_map, calibration, tmp_path / "robot", formats=())
    assert seen[0][0] > before[0]
    assert gc.get_threshold() == before


def test_folders_above_that_are_missing_are_made(unchecked, actuator_map, calibration, tmp_path):
    export_design(DESIGN, actuator_map, calibration, tmp_path / "a" / "b" / "robot", formats=())
    assert (tmp_path / "a" / "b" / "robot" / "design.json").exists()


def test_a_record_cannot_make_force_delete_outside_the_folder(unchecked, actuator_map, calibration, tmp_path):
    outside = tmp_path / "precious.txt"
    outside.write_text("keep me")
    folder = tmp_path / "robot"
    folder.mkdir()
    (folder / "design.json").write_text(json.dumps({"files": ["../precious.txt", str(outside)]}))
    export_design(DESIGN, actuator_map, calibration, folder, formats=(), force=True)
    assert outside.read_text() == "keep me"
    assert json.loads((folder / "design.json").read_text())["as_built"] == DESIGN.as_dict()


def test_a_failed_check_names_the_parts_and_writes_nothing(unchecked, monkeypatch, actuator_map, calibration, tmp_path):
    failed = Check(
        name="no two parts overlap",
        looked_at="",
        measured=0.1,
        limit=0.02,
        unit="mm",
        failures=("a and b overlap by 3.00 mm3",),
    )
    monkeypatch.setattr(export, "run_checks", lambda *_, **__: (failed,))
    with pytest.raises(CheckError, match=r"a and b overlap by 3\.00 mm3; nothing was written"):
        export_design(DESIGN, actuator_map, calibration, tmp_path / "robot", formats=())
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("count", "more"), [(3, ""), (4, " (and 1 more)"), (6, " (and 3 more)")])
def test_a_failed_check_counts_the_failures_that_it_does_not_name(
    count, more, unchecked, monkeypatch, actuator_map, calibration, tmp_path
):
    failures = tuple(f"failure {k}" for k in range(count))
    failed = Check(name="some", looked_at="", measured=1.0, limit=0.0, unit="mm", failures=failures)
    monkeypatch.setattr(export, "run_checks", lambda *_, **__: (failed,))
    with pytest.raises(CheckError) as raised:
        export_design(DESIGN, actuator_map, calibration, tmp_path / "robot", formats=())
    assert str(raised.value).endswith(f": failure 0; failure 1; failure 2{more}; nothing was written")


def test_a_failure_while_writing_leaves_nothing(unchecked, monkeypatch, actuator_map, calibration, tmp_path):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(export, "parts_list", full)
    with pytest.raises(DiskError, match="No space left on device"):
        export_design(DESIGN, actuator_map, calibration, tmp_path / "robot", formats=())
    assert list(tmp_path.iterdir()) == []


def test_bad_requests_are_refused_before_any_work(actuator_map, calibration, tmp_path):
    with pytest.raises(InputError, match="format = 'dwg': must be one of step, stl"):
        export_design(DESIGN, actuator_map, calibration, tmp_path / "robot", formats=("dwg",))
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="is a file"):
        export_design(DESIGN, actuator_map, calibration, tmp_path / "file")
    with pytest.raises(DesignError):
        export_design(DESIGN.replace({"knee_ratio": 14.99}), actuator_map, calibration, tmp_path / "robot", formats=())
    with pytest.raises(OutputError, match=r"part name '\.\./x'"):
        safe("../x")


def test_actuators_that_fit_no_one_leg_are_refused_in_one_line(actuator_map):
    robot, leg = build_robot(DESIGN, actuator_map), leg_dimensions(actuator_map)
    weak = dataclasses.replace(leg.chain, breaking_n=1000.0)
    require_fit(robot, leg)
    with pytest.raises(DesignError, match=r"^bolt circle of the hip actuator = 98\.0 mm: must be 100\.0 mm.*drilled"):
        require_fit(robot, dataclasses.replace(leg, hip=dataclasses.replace(leg.hip, mount_pitch_radius_mm=50.0)))
    with pytest.raises(DesignError, match=r"^back's bolt circle of the hip actuator = 51\.0 mm: must be 50\.0 mm"):
        require_fit(robot, dataclasses.replace(leg, hip=dataclasses.replace(leg.hip, back_pitch_radius_mm=25.0)))
    with pytest.raises(DesignError, match=r"^peak torque of the knee .* at most 5\.7 N m.*084.*lower knee_ratio"):
        require_fit(robot, dataclasses.replace(leg, chain=weak))


def test_the_time_left_is_that_of_the_rest_at_the_mean_speed():
    progress = batch.Progress(job=None, made=5, total=20, elapsed_s=10.0)
    assert progress.left_s == pytest.approx(30.0)
    assert dataclasses.replace(progress, made=20).left_s == 0.0


def test_a_batch_leaves_alone_what_is_made(unchecked, actuator_map, calibration, tmp_path):
    job = jobs.Job(
        design=DESIGN,
        motor=actuator_map.motor,
        calibration=calibration,
        folder=tmp_path / "trial_1",
        formats=(),
        source={"trial": 1},
    )
    assert not is_made(job)
    batch.run(job)
    assert is_made(job)
    assert batch.run_all([job], workers=2) == 0
    assert not is_made(dataclasses.replace(job, design=DESIGN.replace({"shank_length_m": 0.35})))
    (tmp_path / "trial_1" / "bom.csv").unlink()
    assert not is_made(job)
