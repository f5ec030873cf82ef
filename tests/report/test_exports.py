import base64

import numpy as np
import pytest
import trimesh

from pareto_monoped.report import exports
from pareto_monoped.report.exports import coarser, model_of, read_models


def corners_of(model):
    grid = np.frombuffer(base64.b64decode(model.positions), dtype="<i2").reshape(-1, 3, 3)
    return grid * model.step_mm


def ball(radius_mm, subdivisions=4):
    return trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius_mm).triangles


def test_a_body_with_few_triangles_stays_as_it_is():
    box = trimesh.creation.box(extents=(10.0, 20.0, 30.0)).triangles
    model = model_of([(box, (1, 2, 3))], 1000)
    np.testing.assert_allclose(corners_of(model), box, atol=model.step_mm)
    assert not model.simplified
    assert base64.b64decode(model.colours) == bytes([1, 2, 3] * 12)


@pytest.mark.parametrize("most", [100, 500, 2000])
def test_a_coarser_ball_is_still_a_ball(most):
    left = coarser(ball(50.0), most)
    assert 0.25 * most < len(left) <= most
    radius = np.linalg.norm(left, axis=2)
    # A triangle of a ball cut into n has an area of about 4 pi r^2 / n; corners move by less than its side.
    side = np.sqrt(4.0 * np.pi * 50.0**2 / len(left) / 0.43)
    assert np.abs(radius - 50.0).max() < side


def test_large_bodies_keep_more_of_their_triangles():
    shares = [len(coarser(ball(r), 400)) for r in (50.0, 5.0)]
    model = model_of([(ball(50.0), (255, 0, 0)), (ball(5.0), (0, 255, 0))], 800)
    colours = np.frombuffer(base64.b64decode(model.colours), dtype=np.uint8).reshape(-1, 3)
    assert (colours[:, 0] > 0).sum() > 4 * (colours[:, 1] > 0).sum()
    assert model.triangles <= 800 + 24
    assert min(shares) > 100


@pytest.fixture
def exported(tmp_path, data, monkeypatch):
    """Folders with a rod 0.6 m tall: one of them is an export of the study's trial, by the test for that."""
    trial = int(data.trials["trial"].iloc[5])
    for name in (f"trial_{trial}", f"trial_{trial + 1}", "trial_99999999", "elsewhere"):
        (tmp_path / name).mkdir()
        # GLB: metres, y up.
        rod = trimesh.creation.box(extents=(0.1, 0.6, 0.2))
        rod.visual = trimesh.visual.TextureVisuals(
            material=trimesh.visual.material.PBRMaterial(baseColorFactor=[200, 100, 50, 255])
        )
        trimesh.Scene(rod).export(tmp_path / name / "assembly.glb")
        (tmp_path / name / "design.json").write_text("{}")

    def is_made(job, *, any_pose):
        assert any_pose
        assert job.formats == ("glb",)
        assert job.folder == tmp_path / f"trial_{job.source['trial']}"
        assert job.source["study"] == data.study.name
        return job.source["trial"] == trial

    monkeypatch.setattr(exports, "is_made", is_made)
    return tmp_path, trial


def test_models_are_read_from_up_to_date_exports_and_stand_upright(exported, data):
    folder, trial = exported
    (models,) = read_models(folder, [data])
    assert list(models) == [trial]
    size = np.ptp(corners_of(models[trial]).reshape(-1, 3), axis=0)
    np.testing.assert_allclose(size, (200.0, 100.0, 600.0), atol=0.1)
    assert base64.b64decode(models[trial].colours)[:3] == bytes([200, 100, 50])


def test_exports_that_are_left_out_are_named(exported, data):
    folder, trial = exported
    notes = []
    read_models(folder, [data], note=notes.append)
    assert len(notes) == 2
    assert any(
        f"trial_{trial + 1}' is left out: it is not an up-to-date export of trial {trial + 1}" in n for n in notes
    )
    assert any("trial_99999999' is left out" in note for note in notes)


def test_an_export_that_is_stale_or_of_another_study_is_not_shown(tmp_path, data):
    """A folder's name once was enough: an export that was out of date or of another study passed for the trial's."""
    for trial, record in {1: "{}", 2: "[]", 3: "damaged", 4: None}.items():
        path = tmp_path / f"trial_{trial}"
        path.mkdir()
        trimesh.Scene(trimesh.creation.box()).export(path / "assembly.glb")
        if record is not None:
            (path / "design.json").write_text(record)
    notes = []
    (models,) = read_models(tmp_path, [data], note=notes.append)
    assert list(models) == [4]  # no record says that it is another
    assert len(notes) == 3
