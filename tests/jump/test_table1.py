from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.jump.audit import perturbed
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.table1 import paper_spreads, table1


@pytest.fixture(scope="module")
def rows():
    return {row.case: row for row in table1(map_for("VT8020", "paper"), map_for("VT8020"), workers=2)}


@pytest.mark.parametrize("case", PAPER_CASES)
def test_paper_is_within_five_percent_of_table_1(rows, case):
    row = rows[case]
    assert row.paper.height_m == pytest.approx(row.published.height_m, rel=0.05)
    assert row.paper.energy_j == pytest.approx(row.published.energy_j, rel=0.05)
    assert row.paper.height_p05_m <= row.paper.height_m <= row.paper.height_p95_m
    assert row.paper.energy_p05_j <= row.paper.energy_j <= row.paper.energy_p95_j
    # Medians over the few copies that happen to jump would say nothing.
    assert row.paper.jumped_share == 1.0


def test_case_c_saves_what_the_paper_finds(rows):
    """At least 45 percent of the nominal design's energy; the paper's 51."""
    assert rows["C"].paper.energy_j <= 0.55 * rows["nominal"].paper.energy_j


def test_reference_column_is_that_of_the_default_calibration(rows):
    jumps = Evaluator(map_for("VT8020"), load_calibration())
    found = jumps(np.array([case.design.as_array() for case in PAPER_CASES.values()]))
    assert [rows[name].reference.height_m for name in PAPER_CASES] == found.height_m.tolist()
    assert [rows[name].reference.energy_j for name in PAPER_CASES] == found.energy_j.tolist()


def test_reference_ranks_the_cases_as_the_paper_does_in_energy(rows):
    energies = [rows[name].reference.energy_j for name in ("nominal", "A", "B", "C")]
    assert energies == sorted(energies, reverse=True)


def test_rows_are_plain_values(rows):
    assert set(rows["A"].as_dict()) == {"case", "published", "paper", "reference"}


@pytest.mark.parametrize("count", [4, 5])
def test_medians_of_an_even_and_of_an_odd_number_of_copies(count):
    """An even number has its median halfway between the two in the middle."""
    actuator_map, calibration = map_for("VT8020", "paper"), load_calibration("paper")
    designs = np.array([case.design.as_array() for case in PAPER_CASES.values()])
    copies = perturbed(designs, count, np.random.default_rng(8))
    copies[::count] = designs
    jumps = Evaluator(actuator_map, calibration)(copies)
    heights, energies = (np.sort(values.reshape(4, count), axis=1) for values in (jumps.height_m, jumps.energy_j))
    low, high = (count - 1) // 2, count // 2
    spreads = paper_spreads(actuator_map, calibration, perturbations=count, seed=8)
    for k, spread in enumerate(spreads):
        assert spread.height_m == pytest.approx((heights[k, low] + heights[k, high]) / 2.0, rel=1e-12)
        assert spread.energy_j == pytest.approx((energies[k, low] + energies[k, high]) / 2.0, rel=1e-12)
        assert spread.height_p05_m == pytest.approx(np.percentile(heights[k], 5.0), rel=1e-12)
        assert spread.energy_p95_j == pytest.approx(np.percentile(energies[k], 95.0), rel=1e-12)
    if count == 4:  # the two in the middle differ by more than the tolerance
        assert np.all(heights[:, high] - heights[:, low] > 1e-10)


def test_copies_that_do_not_jump_are_left_out_and_counted():
    actuator_map, calibration = map_for("VT8020", "paper"), load_calibration("paper")
    never = replace(calibration, simulation=replace(calibration.simulation, time_limit_s=0.1))
    for spread in paper_spreads(actuator_map, never, perturbations=2):
        assert spread.jumped_share == 0.0
        assert np.isnan([spread.height_m, spread.energy_j, spread.height_p05_m, spread.energy_p95_j]).all()
