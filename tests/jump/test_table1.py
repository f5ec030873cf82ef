import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.jump.table1 import table1


@pytest.fixture(scope="module")
def rows():
    return {row.case: row for row in table1(map_for("VT8020"), workers=2)}


@pytest.mark.parametrize("case", PAPER_CASES)
def test_paper_is_within_ten_percent_of_table_1(rows, case):
    row = rows[case]
    assert row.paper.height_m == pytest.approx(row.published.height_m, rel=0.10)
    assert row.paper.energy_j == pytest.approx(row.published.energy_j, rel=0.10)
    assert row.paper.height_p05_m <= row.paper.height_m <= row.paper.height_p95_m
    assert row.paper.energy_p05_j <= row.paper.energy_j <= row.paper.energy_p95_j
    # Medians over the few copies that happen to jump would say nothing.
    assert row.paper.jumped_share == 1.0


def test_case_c_saves_what_the_paper_finds(rows):
    """At least 45 percent of the nominal design's energy; the paper's 51."""
    assert rows["C"].paper.energy_j <= 0.55 * rows["nominal"].paper.energy_j


def test_reference_ranks_the_cases_as_the_paper_does_in_energy(rows):
    energies = [rows[name].reference.energy_j for name in ("nominal", "A", "B", "C")]
    assert energies == sorted(energies, reverse=True)


def test_rows_are_plain_values(rows):
    assert set(rows["A"].as_dict()) == {"case", "published", "paper", "reference"}
