"""Every example runs as it stands, is short, and makes what it says."""

import runpy
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"
MAKES = {
    "one_jump": ("J at the battery", ("jump.png",)),
    "constrained_study": ("the least energy from the battery", ("light.db", "front.html")),
    "logged_study": ("front of", ("logged.db",)),
    "own_algorithm": ("the least energy", ("least.db",)),
    "own_calibration": ("wet_floor: ", ("wet.db",)),
    "own_goals": ("own_load_factor", ("gentle.db",)),
    "own_motor": ("ESSPG", ()),
    "own_objective": ("m/s", ()),
    "own_sampler": ("m on", ("sampled.db",)),
    "export_a_pick": ("files,", ("built.db", "built.html", "built_leg/design.json", "built_leg/assembly.step")),
}
"""Example -> words that it prints, and files that it makes."""
FEWER = {
    "logged_study": {"evaluations=160": "evaluations=40"},
    "own_algorithm": {"evaluations=120": "evaluations=60", "evaluations=200": "evaluations=100"},
    "own_calibration": {"evaluations=120": "evaluations=40", "evaluations=160": "evaluations=60"},
    "own_goals": {"evaluations=160": "evaluations=60", "evaluations=240": "evaluations=90"},
    "own_sampler": {"n_trials=100": "n_trials=10"},
    "export_a_pick": {"evaluations=400": "evaluations=120"},
}
"""Example -> words in it, and others that take less time."""


def test_every_example_is_known_here():
    assert {path.stem for path in EXAMPLES.glob("*.py")} == set(MAKES)


# What it does is what the documents' commands do, too; it takes longer than all others together.
LONG = {"constrained_study", "export_a_pick"}


@pytest.mark.usefixtures("unchecked")
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.long) if name in LONG else name for name in MAKES]
)
def test_an_example_runs(name, tmp_path, monkeypatch, capsys):
    path = EXAMPLES / f"{name}.py"
    assert len(path.read_text(encoding="utf-8").splitlines()) < 40
    monkeypatch.chdir(tmp_path)
    shown = path.read_text(encoding="utf-8")
    for more, fewer in FEWER.get(name, {}).items():
        assert more in shown
        shown = shown.replace(more, fewer)
    (tmp_path / path.name).write_text(shown, encoding="utf-8")
    runpy.run_path(str(tmp_path / path.name), run_name="__main__")
    words, files = MAKES[name]
    assert words in capsys.readouterr().out
    for file in files:
        assert (tmp_path / file).stat().st_size > 0
