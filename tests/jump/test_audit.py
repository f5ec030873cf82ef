from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import DEFAULTS, NAMES, PAPER_CASES, RATIOS, columns
from pareto_monoped.jump.audit import (
    CLEAR_HALF_STEP,
    CLEAR_SPREAD,
    LIMITS,
    ONLY_IN_FULL,
    PERTURBATION,
    PERTURBED,
    SPREAD_PERCENTILE,
    Jumps,
    _brief_spread,
    _changes,
    _percentile,
    _within,
    audit,
    exceeded,
    finer,
    perturbed,
)
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.measures import measure
from tests.jump.robots import random_designs

MAP = map_for("VT8020")


MOST = {limit.name: limit.most for limit in LIMITS}


def _at_90(designs, name, perturbations):
    """The audits, and the 90th percentile of each limited measure over the designs."""
    found = audit(designs, MAP, load_calibration(name), perturbations=perturbations, workers=2)
    return found, {key: np.nanpercentile(getattr(found, key), 90, method="higher") for key in MOST}


@pytest.mark.parametrize("count", [10, pytest.param(200, marks=pytest.mark.long)])
def test_reference_is_well_conditioned_over_the_whole_space(count):
    found, at_90 = _at_90(random_designs(count, seed=0), "reference", 4)
    for name, most in MOST.items():
        assert at_90[name] <= most, name
    assert found.well_conditioned.mean() >= 0.9


def test_paper_is_not_and_the_audit_says_so():
    found, at_90 = _at_90(random_designs(10, seed=0), "paper", 4)
    assert at_90["half_step_energy"] > MOST["half_step_energy"]
    bad = np.flatnonzero(~found.well_conditioned)
    assert len(bad) > 5
    assert all(found.reason[i] for i in bad)


def test_what_is_asked_of_a_well_conditioned_jump():
    """The limits that the documentation gives, and nothing else."""
    assert MOST == {
        "spread_height_m": 0.001,
        "spread_energy": 0.005,
        "half_step_height_m": 0.003,
        "half_step_energy": 0.01,
        "energy_balance_error": 0.01,
    }
    assert PERTURBATION == 1e-6
    for name in ("spread_height_m", "spread_energy"):
        assert f"{SPREAD_PERCENTILE:.0f}th percentile" in measure(name).label
        assert f"by {PERTURBATION:.0e}".replace("-0", "-") in measure(name).label


@pytest.mark.parametrize("name", MOST)
def test_each_limit_alone_makes_a_jump_ill_conditioned(name):
    at_the_limit = dict(MOST)
    assert exceeded(at_the_limit) == ()
    (line,) = exceeded(at_the_limit | {name: MOST[name] * 1.001})
    text = next(limit.text for limit in LIMITS if limit.name == name)
    assert line.startswith(f"{text} off by ")
    assert len(exceeded(at_the_limit | {name: np.nan})) == 1


def test_a_reason_gives_value_and_limit_in_readable_units():
    over = dict(MOST) | {"spread_height_m": 0.0123, "half_step_energy": 0.5}
    assert exceeded(over) == (
        "height under perturbations off by 12.3 mm (limit 1)",
        "energy with the step halved off by 50 percent (limit 1)",
    )


def test_the_spread_is_the_second_largest_of_ten_changes():
    """90th percentile, and the worst: against jumps of the same copies, under the literal model, which spreads."""
    calibration, design = load_calibration("paper"), PAPER_CASES["A"].design.as_array()
    found = audit(design, MAP, calibration, perturbations=10, seed=4)
    jumps = Evaluator(MAP, calibration)
    base, copies = jumps(design), jumps(perturbed(design, 10, np.random.default_rng(4)))
    height = np.sort(np.abs(copies.height_m - base.height_m))
    energy = np.sort(np.abs(copies.energy_j / base.energy_j - 1.0))
    assert height[4] < height[7] < height[8] < height[9]
    assert (found.spread_height_m[0], found.worst_height_m[0]) == (height[8], height[9])
    assert (found.spread_energy[0], found.worst_energy[0]) == (energy[8], energy[9])


@pytest.fixture(scope="module")
def full_and_brief():
    """Audits of random designs under the literal model, which spreads, and under the reference, which does not."""
    designs = random_designs(7, seed=6)
    return {
        name: [audit(designs, MAP, load_calibration(name), brief=brief) for brief in (False, True)]
        for name in ("paper", "reference")
    }


@pytest.mark.parametrize("name", ["paper", "reference"])
def test_a_brief_audit_has_the_verdict_of_a_full_one(full_and_brief, name):
    full, brief = full_and_brief[name]
    assert brief.reason == full.reason
    assert brief.well_conditioned.tolist() == full.well_conditioned.tolist()
    if name == "paper":
        assert not full.well_conditioned.all()
    for measured in ("half_step_height_m", "half_step_energy", "energy_balance_error"):
        np.testing.assert_array_equal(getattr(brief, measured), getattr(full, measured))
    assert np.isnan([getattr(brief, measured) for measured in ONLY_IN_FULL]).all()


def test_a_brief_audit_perturbs_a_design_as_often_as_a_full_one_unless_the_first_copies_hardly_change(full_and_brief):
    full, brief = full_and_brief["paper"]
    spread = full.spread_height_m > MOST["spread_height_m"]
    assert 0 < spread.sum() < len(spread)
    for measured in ("spread_height_m", "spread_energy", "worst_height_m", "worst_energy"):
        np.testing.assert_array_equal(getattr(brief, measured)[spread], getattr(full, measured)[spread])
    clear, also = full_and_brief["reference"]
    jumped = clear.status == "ok"
    assert (also.worst_height_m[jumped] <= clear.worst_height_m[jumped]).all()
    assert (also.worst_height_m[jumped] < clear.worst_height_m[jumped]).any()


def test_a_single_copy_that_changes_is_followed_up():
    """Designs whose first copies change by just more and just less than the share; the last is not smooth."""
    copies = np.zeros((3, 10, 1))
    copies[:, 1, 0] = np.array([1.1, 0.9, 0.9]) * CLEAR_SPREAD
    copies[:, 2:] = 2.0
    base = Jumps(status=np.array(["ok"] * 3), height_m=np.ones(3), energy_j=np.ones(3))

    def jumps(rows):
        height = 1.0 + rows[:, 0] * MOST["spread_height_m"]
        return SimpleNamespace(height_m=height, energy_j=np.ones(len(rows)))

    found = _brief_spread(copies, base, jumps, np.array([True, True, False]))["spread_height_m"]
    assert found / MOST["spread_height_m"] == pytest.approx([2.0, 0.9 * CLEAR_SPREAD, 2.0], rel=1e-9)


def test_only_a_jump_that_half_a_step_hardly_changes_counts_as_smooth():
    share = np.array([0.19, 0.21, 0.19, np.nan, np.inf])
    other = np.array([0.19, 0.19, 0.21, 0.0, 0.0])
    changes = {
        "half_step_height_m": share * MOST["half_step_height_m"],
        "half_step_energy": other * MOST["half_step_energy"],
        "quarter_step_energy": np.full(5, 9.9),
    }
    assert _within(CLEAR_HALF_STEP, changes).tolist() == [True, False, False, False, False]


def test_known_jumps_are_not_simulated_again(monkeypatch):
    calibration, designs = load_calibration(), np.array([PAPER_CASES[case].design.as_array() for case in ("A", "C")])
    base = Evaluator(MAP, calibration)(designs)
    known = Jumps(status=base.status, height_m=base.height_m, energy_j=base.energy_j)
    counted = []
    plain = Evaluator.__call__

    def counting(self, values):
        counted.append((len(values), self.calibration.simulation.timestep_s))
        return plain(self, values)

    monkeypatch.setattr(Evaluator, "__call__", counting)
    found = audit(designs, MAP, calibration, known=known, brief=True)
    assert counted == [(2, 0.0001), (4, 0.0002)]
    expected = audit(designs, MAP, calibration, brief=True)
    for name, values in expected.as_columns().items():
        np.testing.assert_array_equal(found.as_columns()[name], values)


def test_a_lost_jump_is_an_infinite_change():
    changes = np.array([[0.1, np.nan, 0.3, 0.2], [np.nan, 0.1, 0.1, 0.1]])
    np.testing.assert_array_equal(_percentile(changes, np.array([0]), 75.0), [0.3, np.nan])
    np.testing.assert_array_equal(_percentile(changes, np.array([0, 1]), 90.0), [np.inf, np.inf])


def test_a_jump_that_a_finer_step_loses_has_changed_without_limit():
    base = SimpleNamespace(ok=np.array([True, True]), height_m=np.array([1.0, 1.0]), energy_j=np.array([20.0, 20.0]))
    finer = SimpleNamespace(
        ok=np.array([True, False]), height_m=np.array([0.9, np.nan]), energy_j=np.array([22, np.nan])
    )
    found = _changes("half_step", base, finer)
    np.testing.assert_allclose(found["half_step_height_m"], [0.1, np.inf])
    np.testing.assert_allclose(found["half_step_energy"], [0.1, np.inf])


def test_steps_are_halved_and_quartered():
    calibration, design = load_calibration(), PAPER_CASES["C"].design.as_array()
    found = audit(design, MAP, calibration, perturbations=1)
    base = Evaluator(MAP, calibration)(design)
    for name, parts in (("half", 2), ("quarter", 4)):
        simulation = replace(calibration.simulation, timestep_s=0.0002 / parts)
        other = Evaluator(MAP, replace(calibration, simulation=simulation))(design)
        height, energy = getattr(found, f"{name}_step_height_m"), getattr(found, f"{name}_step_energy")
        assert height[0] == abs(other.height_m[0] - base.height_m[0]) > 0.0
        assert energy[0] == abs(other.energy_j[0] / base.energy_j[0] - 1.0) > 0.0


def test_columns_have_one_row_per_design():
    designs = np.array([PAPER_CASES["C"].design.as_array(), np.full(len(NAMES), np.nan)])
    found = audit(designs, MAP, load_calibration(), perturbations=2)
    assert found.well_conditioned.tolist() == [True, False]
    assert found.reason[1] == "no jump: bad_input"
    columns = found.as_columns()
    assert all(len(values) == 2 for values in columns.values())
    assert np.isnan(columns["spread_height_m"][1])


def test_same_seed_same_audit():
    design = PAPER_CASES["C"].design.as_array()
    first, second = (audit(design, MAP, load_calibration(), perturbations=3, brief=True).as_columns() for _ in "ab")
    for name, values in first.items():
        np.testing.assert_array_equal(values, second[name])


def test_perturbations_are_small_and_leave_the_gearbox_alone():
    design = PAPER_CASES["nominal"].design.as_array()
    copies = perturbed(design, 50, np.random.default_rng(0))
    with np.errstate(invalid="ignore"):
        change = np.abs(copies / design - 1.0)
    assert copies.shape == (50, len(NAMES))
    assert 0.0 < change[:, [NAMES.index(name) for name in PERTURBED]].max() <= 1e-6
    np.testing.assert_array_equal(columns(copies, RATIOS), np.tile(columns(design, RATIOS), (50, 1)))
    np.testing.assert_array_equal(columns(copies, DEFAULTS), np.tile([*DEFAULTS.values()], (50, 1)))


def test_an_optional_variable_in_use_is_perturbed_too():
    design = PAPER_CASES["nominal"].design.replace({"knee_release_rad": 0.3, "rest_length_m": 8.0}).as_array()
    copies = perturbed(design, 50, np.random.default_rng(0))
    used = ("knee_release_rad", "rest_length_m")
    change = np.abs(columns(copies, used) / columns(design, used) - 1.0)
    assert np.all((change > 0.0) & (change <= 1e-6))
    assert np.all(columns(copies, ("start_height_m",)) == 0.5)


def test_the_step_is_refined_alone_where_the_control_period_is_named():
    for parts in (2, 4):
        present = finer(load_calibration("reference"), parts).simulation
        assert (present.timestep_s, present.period_s) == (2e-4 / parts, 1e-3)
        # Where none is named, each step is a period.
        first = finer(load_calibration("reference-1"), parts).simulation
        assert (first.timestep_s, first.period_s) == (1e-3 / parts, 1e-3 / parts)


def test_a_long_delay_keeps_the_period_of_a_calibration_that_names_none():
    """Otherwise the controller would have to keep more commands than it can."""
    first = load_calibration("reference-1")
    late = replace(first, simulation=replace(first.simulation, delay_s=3e-3))
    simulation = finer(late, 4).simulation
    assert (simulation.timestep_s, simulation.period_s, simulation.delay_s) == (2.5e-4, 1e-3, 3e-3)


@pytest.mark.parametrize(("name", "quarter_s"), [("reference", 5e-5), ("reference-3", 2.5e-4), ("reference-1", 2.5e-4)])
@pytest.mark.parametrize("delay_s", [0.0, 2e-3])
def test_the_effect_of_the_control_period_is_that_of_a_quarter_of_it_at_one_step(name, quarter_s, delay_s):
    """Four jumps by hand; what the audit reuses of its other jumps must not show, nor a delay."""
    start, designs = load_calibration(name), np.array([PAPER_CASES[case].design.as_array() for case in ("A", "C")])
    calibration = replace(start, simulation=replace(start.simulation, delay_s=delay_s))
    found = audit(designs, MAP, calibration, perturbations=1)

    def jumps(period_s):
        timed = replace(start.simulation, timestep_s=quarter_s, control_period_s=period_s)
        return Evaluator(MAP, replace(start, simulation=timed))(designs)

    held, prompt = jumps(1e-3), jumps(2.5e-4)
    np.testing.assert_array_equal(found.control_period_height_m, np.abs(prompt.height_m - held.height_m))
    np.testing.assert_array_equal(found.control_period_energy, np.abs(prompt.energy_j / held.energy_j - 1.0))
    assert np.all(found.control_period_energy > 0.002)


def test_the_control_period_is_no_condition():
    """It is a property of the machine, not an error of the simulation."""
    assert not any("control_period" in limit.name for limit in LIMITS)


def test_half_a_step_changes_less_than_a_control_period():
    """The reference's own error is far below the effect of the period, over random designs."""
    found = audit(random_designs(6, seed=3), MAP, load_calibration(), perturbations=1)
    assert np.median(found.half_step_energy) < 0.1 * np.median(found.control_period_energy)
