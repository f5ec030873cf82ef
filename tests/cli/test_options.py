"""Options that several commands share."""

import pytest

from pareto_monoped.cli import _run as cli
from tests.cli.support import STORED


@pytest.mark.parametrize(
    ("words", "option", "ending"),
    [
        (["front", STORED, "--csv", "a.parquet"], "--csv", ".csv"),
        (["trials", STORED, "--csv", "a.json"], "--csv", ".csv"),
        (["trials", STORED, "--parquet", "a.csv"], "--parquet", ".parquet"),
        (["simulate", "--case", "C", "--trace", "a.json"], "--trace", ".csv"),
        (["actuators", "VT8020", "--csv", "a.html"], "--csv", ".csv"),
        (["campaign", "a.toml", "--csv", "a.html"], "--csv", ".csv"),
        (["campaign", "a.toml", "--report", "a.csv"], "--report", ".html"),
        (["report", STORED, "-o", "a.txt"], "--output", ".html"),
        (["sensitivity", STORED, "--knee", "--plot", "a.png"], "--plot", ".html"),
    ],
)
def test_the_ending_of_another_kind_of_file_is_refused(tmp_path, monkeypatch, capsys, words, option, ending):
    """Comma-separated text was written to a file that called itself Parquet."""
    monkeypatch.chdir(tmp_path)
    assert cli([str(word) for word in words]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith(f"error: {option} = 'a.")
    assert said.err.endswith(f"must be a file ending in {ending}; correct the name\n")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["a.CSV", "a.txt", "a"])
def test_a_table_of_text_may_be_called_so_or_have_no_ending(tmp_path, name):
    assert cli(["front", str(STORED), "--csv", str(tmp_path / name)]) == 0
    assert (tmp_path / name).read_text().startswith("trial,")


ADDRESS = "postgresql://ann:S3cret@h/d"


@pytest.mark.parametrize(
    ("words", "what"),
    [
        (["run", ADDRESS], "STUDY.toml"),
        (["campaign", ADDRESS], "CAMPAIGN.toml"),
        (["campaign", "c.toml", "--folder", ADDRESS], "--folder"),
        (["campaign", "c.toml", "--csv", ADDRESS], "--csv"),
        (["pareto", ADDRESS], "[STUDY.toml]"),
        (["pareto", "-o", ADDRESS], "--output"),
        (["export", "--case", "C", "-o", ADDRESS], "--output"),
        (["report", "s.db", "-o", ADDRESS], "--output"),
        (["report", "s.db", "--exports", ADDRESS], "--exports"),
        (["robust", "s.db", "--uncertainty", ADDRESS], "--uncertainty"),
        (["actuators", "U8", "--csv", ADDRESS], "--csv"),
    ],
)
def test_an_address_where_a_file_is_wanted_is_refused_without_its_password(tmp_path, monkeypatch, capsys, words, what):
    """Messages repeated it, and folders were made that had it in their names."""
    monkeypatch.chdir(tmp_path)
    assert cli(words) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith(f"error: {what}: is the address of a server, must be the name of a file or folder;")
    assert len(captured.err.splitlines()) == 1
    assert "S3cret" not in captured.err
    assert list(tmp_path.iterdir()) == []
