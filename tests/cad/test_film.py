"""Films of a jump: what they show is the jump, at one scale, and other programs play them."""

import subprocess

import numpy as np
import pytest
from PIL import Image

import pareto_monoped as pm
from pareto_monoped.cad import film as film_files
from pareto_monoped.cad import film as module
from pareto_monoped.cad.film import FRAMES_PER_S, film, hold_frames, moments, write_gif, write_video
from pareto_monoped.errors import InputError, SimulationError

C = pm.PAPER_CASES["C"].design


@pytest.fixture(scope="module")
def trace():
    steps = pm.trace(C)
    return {name: steps[name].to_numpy() for name in steps}


@pytest.fixture(scope="module")
def pictures(trace):
    return list(film(pm.build_robot(C), trace, slower=1.0))


def dark_rows(picture):
    """Rows in which the robot is, the floor left out: its feet are black, its motors dark grey."""
    robot = picture[:, : module._WIDTH].astype(int)
    return np.flatnonzero((robot.max(axis=2) < 60).any(axis=1))


def test_moments_are_evenly_apart_and_end_at_the_apex(trace):
    shown = moments(trace, slower=4.0)
    times = np.array([moment.time_s for moment in shown])
    assert times[0] == 0.0
    assert times[-1] == trace["time_s"][-1]
    np.testing.assert_allclose(np.diff(times)[:-1], 1.0 / (4.0 * FRAMES_PER_S), atol=1.1e-3)
    assert shown[-1].base_z_m == trace["base_z_m"][-1]


def test_the_robot_rises_by_what_the_jump_says_at_one_scale(pictures, trace):
    """The scale follows from the rise of the highest dark pixel, and must fit the length of the floor plate."""
    rise_px = dark_rows(pictures[0])[0] - dark_rows(pictures[-1])[0]
    rise_m = trace["base_z_m"][-1] - trace["base_z_m"][0]
    floors = {
        tuple(np.flatnonzero((np.abs(picture[460, :320].astype(int) - 255) > 40).any(axis=1))) for picture in pictures
    }
    assert len({len(one) for one in floors}) == 1
    px_per_m = rise_px / rise_m
    assert 150.0 < px_per_m < 450.0


def test_the_line_in_the_curves_moves_with_time(pictures):
    columns = []
    for picture in pictures:
        changed = (picture[:, 320:] != pictures[-1][:, 320:]).any(axis=(0, 2))
        columns.append(np.flatnonzero(changed)[:1].tolist())
    places = [one[0] for one in columns[:-1]]
    assert places == sorted(places)
    assert places[0] < places[-1]


def test_a_gif_has_every_picture_and_rests_at_the_end(pictures, tmp_path):
    assert write_gif(tmp_path / "jump.gif", pictures) == len(pictures)
    with Image.open(tmp_path / "jump.gif") as read:
        assert (read.n_frames, read.size) == (len(pictures), (720, 480))
        assert read.info["loop"] == 0
        times = []
        for k in range(read.n_frames):
            read.seek(k)
            times.append(read.info["duration"])
        read.seek(0)
        first = np.asarray(read.convert("RGB")).astype(int)
    assert times[:-1] == [1000 // FRAMES_PER_S] * (len(pictures) - 1)
    assert times[-1] == hold_frames() * 1000 // FRAMES_PER_S
    assert np.abs(first - pictures[0]).mean() < 6.0


@pytest.mark.parametrize("suffix", [".mp4", ".webm"])
def test_a_video_plays_as_long_as_the_film(suffix, pictures, tmp_path):
    try:
        program = film_files.encoder()
    except InputError:
        pytest.skip("ffmpeg is not installed")
    path = tmp_path / f"jump{suffix}"
    count = write_video(path, pictures)
    assert count == len(pictures) + hold_frames()
    read = subprocess.run(
        [program, "-i", str(path), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"], capture_output=True, check=True
    ).stdout
    frames = np.frombuffer(read, np.uint8).reshape(-1, 480, 720, 3)
    assert len(frames) == count
    assert np.abs(frames[0].astype(int) - pictures[0]).mean() < 8.0


def test_a_video_of_another_kind_or_without_encoder_is_refused_in_a_line(tmp_path, monkeypatch):
    with pytest.raises(InputError, match=r"ending in \.mp4 or \.webm"):
        write_video(tmp_path / "jump.avi", [])
    monkeypatch.setattr(film_files.shutil, "which", lambda name: None)
    monkeypatch.setitem(__import__("sys").modules, "imageio_ffmpeg", None)
    with pytest.raises(InputError, match=r"pip install 'pareto-monoped\[video\]'"):
        write_video(tmp_path / "jump.mp4", [])
    assert list(tmp_path.iterdir()) == []


def test_an_encoder_that_fails_leaves_nothing(tmp_path, pictures, monkeypatch):
    monkeypatch.setattr(film_files, "encoder", lambda: "false")
    with pytest.raises(SimulationError, match="ffmpeg failed"):
        write_video(tmp_path / "jump.mp4", pictures[:2])
    assert list(tmp_path.iterdir()) == []
