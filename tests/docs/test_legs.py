"""docs/legs.md shows what its script prints, and the page, the figure and the examples belong together."""

import re

import pytest

from pareto_monoped.jump.rail_leg import load_leg
from tests.docs.scripts import ROOT, imported, rows

PAGE = (ROOT / "docs" / "legs.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def script():
    with imported("rail_legs") as found:
        yield found


@pytest.mark.long
def test_the_page_shows_what_its_script_predicts(script, capsys):
    leg = load_leg(script.LEG)
    found, _, term = script.fitted_leg(leg, script.TERM, script.FITTED_ON)
    script.print_predictions(leg, script.bands(leg), script.bands(found, term))
    shown = re.findall(r"<!-- made by: python benchmarks/rail_legs.py -->\n((?:\|.*\n)+)", PAGE)
    assert rows(shown[0]) == rows(capsys.readouterr().out)
    assert len(rows(shown[1])) == 1 + 2 * 4 * 3  # drives, terms, series


def test_the_figure_has_what_the_page_shows(script, tmp_path, monkeypatch):
    monkeypatch.setattr(script, "SAMPLES", 16)
    leg = load_leg(script.LEG)
    given = script.bands(leg)
    script.draw(leg, given, given, tmp_path / "leg.svg")
    assert (tmp_path / "leg.svg").stat().st_size > 10_000
    assert (ROOT / "docs" / "images" / "rail_leg.svg").is_file()


@pytest.mark.parametrize("path", sorted((ROOT / "examples" / "legs").glob("*.toml")), ids=lambda path: path.stem)
def test_examples_are_legs_that_the_page_names(path):
    load_leg(path)
    assert f"../examples/legs/{path.name}" in PAGE
