"""``simulate --gif``, ``--video`` and ``--view``."""

import pytest
from PIL import Image

from pareto_monoped.cli import _run as cli
from pareto_monoped.cli import watching


@pytest.mark.long
def test_a_gif_is_written_beside_the_numbers(tmp_path, capsys):
    path = tmp_path / "jump.gif"
    assert cli(["simulate", "--case", "C", "--gif", str(path), "--slower", "1"]) == 0
    said = capsys.readouterr()
    assert "height_m" in said.out
    assert f"wrote {path}" in said.err
    with Image.open(path) as read:
        assert read.n_frames > 5
    assert cli(["simulate", "--case", "A", "--gif", str(path), "--slower", "1"]) == 0
    (tmp_path / "notes.gif").write_text("mine")
    assert cli(["simulate", "--case", "C", "--gif", str(tmp_path / "notes.gif"), "--slower", "1"]) == 2
    assert (tmp_path / "notes.gif").read_text() == "mine"


def test_a_viewer_without_display_says_what_to_do(monkeypatch, capsys):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setattr(watching.sys, "platform", "linux")
    assert cli(["simulate", "--view"]) == 2
    said = capsys.readouterr()
    assert "the display is not set" in said.err
    assert "--gif FILE" in said.err
    assert len(said.err.splitlines()) == 1


def test_a_display_that_cannot_be_opened_is_told_before_anything_is_simulated(monkeypatch, capsys, tmp_path):
    """MuJoCo ended the process with a message of its own, and left a log in the user's folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("DISPLAY", ":77")
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setattr(watching.sys, "platform", "linux")
    assert cli(["simulate", "--view"]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err == (
        "error: --view: the display cannot be opened (DISPLAY is ':77'); use --gif FILE or --video FILE\n"
    )
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["jump.avi", "jump"])
def test_a_video_of_another_kind_is_refused_before_anything_is_simulated(name, tmp_path, capsys):
    assert cli(["simulate", "--video", str(tmp_path / name)]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert ".mp4 or .webm" in said.err


def test_the_help_lists_the_variables_with_their_units(capsys):
    assert cli(["simulate", "--help"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    assert any(line.split() == ["stiffness_n_per_m", "N/m", "5", "to", "200"] for line in lines)


def test_a_gif_is_not_written_under_the_name_of_another_kind(tmp_path, capsys):
    assert cli(["simulate", "--case", "C", "--gif", str(tmp_path / "jump.png")]) == 2
    assert capsys.readouterr().err.rstrip().endswith("must be a file ending in .gif; correct the name, or use --video")
    assert list(tmp_path.iterdir()) == []
