import os
from pathlib import Path

import pytest

from pareto_monoped.errors import OutputError
from pareto_monoped.files import rename_new, replacing, write_bytes, write_text
from tests.study.support import made_database


def test_a_failed_write_leaves_the_old_file_and_nothing_else(tmp_path):
    target = tmp_path / "result.csv"
    write_text(target, "old\n")
    with pytest.raises(UnicodeEncodeError):
        write_text(target, "half" + "\ud800")
    assert target.read_text() == "old\n"
    assert list(tmp_path.iterdir()) == [target]


def test_text_is_utf8_with_unix_line_ends(tmp_path):
    write_text(tmp_path / "a.txt", "ζ\n")
    assert (tmp_path / "a.txt").read_bytes() == "ζ\n".encode()


def test_bytes_and_ordinary_permissions(tmp_path):
    (tmp_path / "plain").touch()
    write_bytes(tmp_path / "a.bin", b"\x00\x01")
    assert (tmp_path / "a.bin").read_bytes() == b"\x00\x01"
    assert (tmp_path / "a.bin").stat().st_mode == (tmp_path / "plain").stat().st_mode


def test_suffix_is_kept_for_writers_that_look_at_it(tmp_path):
    with replacing(tmp_path / "part.stl") as temporary:
        assert temporary.suffix == ".stl"


def test_a_rename_in_one_step_never_leaves_two_names_nor_replaces_anything(tmp_path, monkeypatch):
    """A kill between a link and the removal of the old name had left a second name of a study."""
    monkeypatch.delattr(os, "link")
    source, target = tmp_path / "a", tmp_path / "b"
    source.write_text("new")
    rename_new(source, target)
    assert (target.read_text(), list(tmp_path.iterdir())) == ("new", [target])
    monkeypatch.undo()
    source.write_text("newer")
    with pytest.raises(FileExistsError):
        rename_new(source, target)
    assert (source.read_text(), target.read_text()) == ("newer", "new")


def test_a_missing_folder_is_one_clear_line(tmp_path):
    with pytest.raises(OutputError, match="cannot be written") as caught:
        write_text(tmp_path / "missing" / "a.txt", "")
    assert "\n" not in str(caught.value)


def test_a_folder_in_the_way_is_one_clear_line_and_leaves_nothing(tmp_path):
    (tmp_path / "a.txt").mkdir()
    with pytest.raises(OutputError, match="name of a file"):
        write_text(tmp_path / "a.txt", "")
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]


def test_an_interrupt_as_soon_as_the_temporary_file_is_made_leaves_nothing(tmp_path, monkeypatch):
    touch = Path.touch

    def interrupted(self, *args, **kwargs):
        touch(self, *args, **kwargs)
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "touch", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_text(tmp_path / "a.txt", "")
    assert list(tmp_path.iterdir()) == []


@pytest.fixture
def study(tmp_path):
    made_database(tmp_path / "s.db")
    return tmp_path / "s.db"


@pytest.mark.parametrize("force", [False, True])
@pytest.mark.parametrize("name", ["s.db", "s.db-wal", "s.db-lock", "s.db-journal", "link.csv"])
def test_no_output_replaces_a_study_or_what_belongs_to_it(study, name, force):
    (study.parent / "link.csv").symlink_to(study)
    before = study.read_bytes()
    with pytest.raises(OutputError, match="database") as caught:
        write_text(study.parent / name, "a,b\n", force=force)
    assert "\n" not in str(caught.value)
    assert study.read_bytes() == before
    assert sorted(path.name for path in study.parent.iterdir()) == ["link.csv", "s.db"]


@pytest.mark.parametrize(
    ("old", "new", "replaced"),
    [
        ("trial,height_m\n1,2\n", "trial,mass_kg\n3,4\n", True),
        ("name,height_m\n1,2\n", "trial,height_m\n3,4\n", False),
        ("my notes\n", "trial,height_m\n", False),
        ("name = 's'\n", "<!doctype html>\n", False),
        ("", "trial,height_m\n", True),
        ("<!doctype html>\n<html>\n<p>mine", "<!doctype html>\n<html lang='en'>\n", False),
    ],
)
def test_only_a_file_of_its_kind_is_replaced(tmp_path, old, new, replaced):
    target = tmp_path / "a.txt"
    target.write_text(old)
    if replaced:
        write_text(target, new)
    else:
        with pytest.raises(OutputError, match="another kind, which would be lost; give another name, or --force"):
            write_text(target, new)
        assert target.read_text() == old
        assert list(tmp_path.iterdir()) == [target]
        write_text(target, new, force=True)
    assert target.read_text() == new


def test_a_pipe_is_not_read(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    write_text(tmp_path / "pipe", "x\n")
    assert (tmp_path / "pipe").read_text() == "x\n"


@pytest.mark.parametrize("force", [False, True])
def test_a_device_is_not_replaced(tmp_path, monkeypatch, force):
    monkeypatch.setattr(Path, "touch", lambda *_, **_2: pytest.fail("a file beside a device"))
    with pytest.raises(OutputError, match="'/dev/null': is a device; give the name of a file"):
        write_text(Path("/dev/null"), "x", force=force)
