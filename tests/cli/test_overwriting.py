"""Every command that writes a file replaces its own earlier output, but no study and nothing of another kind."""

import shutil
from pathlib import Path

import pytest

from pareto_monoped.cli import _run as cli

STORED = Path(__file__).parent.parent / "storage" / "data" / "plain.db"

COMMANDS = {
    "front": (("front", "s.db", "--csv"), ".csv"),
    # tests/api/test_outputs.py writes reports every time.
    "report": (("report", "s.db", "-o"), ".html"),
    "trace": (("simulate", "--trace"), ".csv"),
    "model": (("simulate", "--model"), ".xml"),
    "actuators": (("actuators", "--csv"), ".csv"),
    "figure": (("actuators", "--figure"), ".svg"),
}


@pytest.mark.parametrize(
    ("words", "ending"),
    [
        pytest.param(*each, marks=pytest.mark.long if name == "report" else (), id=name)
        for name, each in COMMANDS.items()
    ],
)
def test_targets(tmp_path, monkeypatch, capsys, words, ending):
    monkeypatch.chdir(tmp_path)
    shutil.copy(STORED, "s.db")
    study = (tmp_path / "s.db").read_bytes()
    notes = tmp_path / f"notes{ending}"
    notes.write_text("my notes\n")
    victim = tmp_path / f"victim{ending}"
    victim.symlink_to("s.db")
    for force in ([], ["--force"]):
        assert cli([*words, str(victim), *force]) == 2
        assert "no output replaces" in capsys.readouterr().err.splitlines()[-1]
    assert (tmp_path / "s.db").read_bytes() == study
    assert cli([*words, str(notes)]) == 2
    assert "would be lost; give another name, or --force" in capsys.readouterr().err
    assert notes.read_text() == "my notes\n"
    assert cli([*words, str(notes), "--force"]) == 0
    assert notes.read_text() != "my notes\n"
    assert cli([*words, str(notes)]) == 0  # now its own
