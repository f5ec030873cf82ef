import os

import pytest

from pareto_monoped.errors import OutputError
from pareto_monoped.files import current_umask, replacing, write_bytes, write_text


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


def test_a_missing_folder_is_one_clear_line(tmp_path):
    with pytest.raises(OutputError, match="cannot be written") as caught:
        write_text(tmp_path / "missing" / "a.txt", "")
    assert "\n" not in str(caught.value)


def test_a_folder_in_the_way_is_one_clear_line_and_leaves_nothing(tmp_path):
    (tmp_path / "a.txt").mkdir()
    with pytest.raises(OutputError, match="name of a file"):
        write_text(tmp_path / "a.txt", "")
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]


def test_the_permissions_withheld_are_read_without_changing_them():
    before = os.umask(0o027)
    try:
        assert current_umask() == 0o027
        assert current_umask() == 0o027
    finally:
        os.umask(before)
