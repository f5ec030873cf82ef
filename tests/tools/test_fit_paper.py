"""The script that fits the literal model changes at most four numbers, which its file marks as fitted."""

import re
from pathlib import Path

import numpy as np

from pareto_monoped.jump.calibration import load_calibration

ROOT = Path(__file__).parents[2]
SHIPPED = ROOT / "pareto_monoped" / "data" / "calibrations" / "paper.toml"


def test_at_most_four_numbers_are_fitted_and_the_file_marks_them(script):
    marked = re.findall(r"(?m)^(\w+) = [^#\n]*# fitted", SHIPPED.read_text(encoding="utf-8"))
    assert sorted(marked) == sorted(script.FITTED)
    assert len(marked) <= 4


def test_the_rest_is_not_touched(script):
    """New numbers change the fitted fields of the calibration and nothing else."""
    start = load_calibration("paper")
    numbers = np.array([0.0123456789, 1.2345678912, 0.2543219876])
    changed = script.with_numbers(start, numbers)
    assert [script._current(changed, key) for key in script.FITTED] == [0.01235, 1.235, 0.254]
    assert script.with_numbers(changed, np.array([script._current(start, key) for key in script.FITTED])) == start


def test_written_numbers_are_read_back(script, tmp_path):
    path = tmp_path / "paper.toml"
    path.write_text(SHIPPED.read_text(encoding="utf-8"), encoding="utf-8")
    changed = script.with_numbers(load_calibration("paper"), np.array([0.05, 1.25, 0.25]))
    script.write(changed, path)
    assert load_calibration(str(path)) == changed
    before, after = (text.splitlines() for text in (SHIPPED.read_text("utf-8"), path.read_text("utf-8")))
    assert sum(a != b for a, b in zip(before, after, strict=True)) == len(script.FITTED)


def test_an_island_beside_the_fit_counts(script):
    """The objective is the worst over lighter and heavier links."""
    assert min(script.LINK_SCALES) < 1.0 < max(script.LINK_SCALES)
    start = load_calibration("paper")
    numbers = np.array([script._current(start, key) for key in script.FITTED])
    assert script.objective(start)(numbers) < 0.06
