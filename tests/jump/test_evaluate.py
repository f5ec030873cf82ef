from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.actuator.service.sheet import service_sheet
from pareto_monoped.design import LOWER, NAMES, PAPER_CASES, UPPER
from pareto_monoped.jump import evaluate
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import STATUSES, Evaluator, evaluate_robots
from pareto_monoped.measures import MEASURE_NAMES
from pareto_monoped.robot.population import robot_arrays
from pareto_monoped.robot.tables import actuator_table
from tests.jump.robots import random_designs, wild_calibration

GOOD = PAPER_CASES["C"].design.as_array()


@pytest.fixture(scope="module")
def evaluator():
    return Evaluator(map_for("VT8020"), load_calibration())


def changed(**values):
    design = GOOD.copy()
    for name, value in values.items():
        design[NAMES.index(name)] = value
    return design


BAD = {
    "not a number": (changed(thigh_length_m=np.nan), "bad_input", "thigh_length_m"),
    "infinite": (changed(stiffness_n_per_m=np.inf), "bad_input", "stiffness_n_per_m"),
    "negative length": (changed(shank_length_m=-0.4), "bad_input", "shank_length_m"),
    "no length": (changed(shank_length_m=0.0), "bad_input", "shank_length_m"),
    "negative damping": (changed(damping_n_s_per_m=-1.0), "bad_input", "damping_n_s_per_m"),
    "beyond all lengths": (changed(thigh_length_m=1e300), "bad_input", "at most 1e+09"),
    "beyond all ratios": (changed(knee_ratio=1e100), "bad_input", "at most 1e+09"),
    "no such gearbox": (changed(knee_ratio=40.0), "no_gearbox", "knee_ratio"),
    "too short": (changed(thigh_length_m=0.2, shank_length_m=0.2), "cannot_stand", "shorter than"),
    "too long": (changed(thigh_length_m=1.5), "cannot_stand", "cannot fold"),
    "too weak": (changed(stiffness_n_per_m=0.0, damping_n_s_per_m=1e4), "no_lift_off", "foot|sank"),
}


@pytest.mark.parametrize("name", BAD)
def test_every_failure_has_a_name_and_a_reason(evaluator, name):
    design, status, said = BAD[name]
    result = evaluator(design[None])
    assert result.status[0] == status
    assert status in STATUSES
    assert any(word in result.reason[0] for word in said.split("|"))
    assert np.isnan(result.height_m[0])
    assert np.isnan(result.energy_j[0])
    # No design that can be built is without a mass and a cost.
    built = status not in ("bad_input", "no_gearbox")
    for of_robot in ("mass_kg", "cost_eur", "made_parts", "bought_parts"):
        assert np.isfinite(result.of(of_robot)[0]) == built, of_robot


def test_a_hop_without_work_is_no_jump():
    """With an absurd damper the foot of the literal model can chatter off the floor although no motor works.

    Rounding decides for which dampers, so many are tried.
    """
    paper = load_calibration("paper")
    calibration = replace(paper, controller=replace(paper.controller, flight=None))
    robots = robot_arrays(GOOD, map_for("VT8020"), calibration.mass)
    idle = 0
    for exponent in range(40, 301, 20):
        result = evaluate_robots(robots, np.array([[GOOD[4], 10.0**exponent, GOOD[6]]]), calibration)
        if "without work" in result.reason[0]:
            idle += 1
            assert result.status[0] == "no_lift_off"
            assert np.isnan(result.energy_j[0])
    assert idle


def test_failures_do_not_touch_their_neighbours(evaluator):
    bad = [design for design, _, _ in BAD.values()]
    mixed = np.array([row for design in bad for row in (design, GOOD)])
    result = evaluator(mixed)
    alone = evaluator(GOOD[None])
    assert list(result.status[0::2]) == [status for _, status, _ in BAD.values()]
    assert set(result.status[1::2]) == {"ok"}
    for name in MEASURE_NAMES:
        assert set(result.as_columns()[name][1::2]) == {alone.as_columns()[name][0]}


def test_every_measure_of_a_jump_is_computed(evaluator):
    jump = evaluator(GOOD[None])
    assert [name for name in MEASURE_NAMES if not np.isfinite(jump.of(name)).all()] == []


def test_a_simulation_that_blows_up_is_diverged_and_alone():
    result = Evaluator(map_for("VT8020"), wild_calibration())(np.array([GOOD, GOOD]))
    assert list(result.status) == ["diverged"] * 2
    assert result.reason == ("its accelerations grew beyond all bounds",) * 2
    assert np.isnan(result.height_m).all()


def test_what_is_physically_certain_holds_for_random_designs(evaluator):
    result = evaluator(random_designs(50, seed=5))
    assert result.ok.all()
    gained = result.mass_kg * 9.81 * (result.height_m - 0.5)
    # The motors' net work exceeds what the base alone gains by what the leg weighs and gains, and by the losses.
    assert np.all(result.energy_j > 0.5 * gained)
    assert np.all(result.energy_j == pytest.approx(result.energy_hip_j + result.energy_knee_j))
    assert np.all(result.efficiency == pytest.approx(gained / result.energy_j))
    assert np.all((result.saturation_hip >= 0.0) & (result.saturation_knee <= 1.0))
    assert np.all(result.foot_clearance_m > 0.01)
    assert np.all((result.lift_off_s > 0.0) & (result.lift_off_s < result.apex_s))
    assert np.all(result.joule_heat_j > 0.0)
    # No jump rises faster on average than a throw to its height, which takes sqrt(2 h / g).
    rise = result.height_m - 0.5
    assert np.all(result.agility_m_per_s == pytest.approx(rise / result.apex_s))
    assert np.all((result.agility_m_per_s > 0.0) & (result.agility_m_per_s < np.sqrt(9.81 * rise / 2.0)))


def test_peaks_respect_the_motor(evaluator):
    designs = random_designs(20, seed=6)
    result = evaluator(designs)
    ratios = robot_arrays(designs, evaluator.actuator_map).ratio
    assert np.all(result.peak_torque_knee_n_m <= 5.5 * ratios[:, 1] + 1e-9)
    assert np.all(result.peak_torque_hip_n_m <= 5.5 * ratios[:, 0] + 1e-9)


def test_bits_do_not_depend_on_batch_order_or_workers(evaluator):
    designs = np.random.default_rng(9).uniform(LOWER, UPPER, (25, 7))
    whole = evaluator(designs).as_columns()
    order = np.random.default_rng(1).permutation(25)
    shuffled = Evaluator(evaluator.actuator_map, evaluator.calibration, workers=2)(designs[order]).as_columns()
    one = evaluator(designs[17:18]).as_columns()
    for name in MEASURE_NAMES:
        np.testing.assert_array_equal(shuffled[name], whole[name][order], err_msg=name)
        np.testing.assert_array_equal(one[name][0], whole[name][17], err_msg=name)


def test_no_designs_give_no_rows(evaluator):
    assert len(evaluator(np.empty((0, 7)))) == 0


def test_bounds_are_allowed_values(evaluator):
    """The paper's lower bounds of damping and torsional stiffness are zero."""
    result = evaluator(changed(damping_n_s_per_m=0.0, torsional_stiffness_n_m_per_rad=0.0)[None])
    assert result.status[0] == "ok"
    shortest = evaluator(np.array([changed(thigh_length_m=0.05), changed(thigh_length_m=0.049)]))
    assert list(shortest.status) == ["cannot_stand", "bad_input"]
    assert "must be at least 0.05" in shortest.reason[1]


def test_mass_is_known_of_every_robot_that_can_be_built(evaluator):
    result = evaluator(np.array([GOOD, changed(thigh_length_m=1.5), changed(knee_ratio=40.0)]))
    assert list(result.status) == ["ok", "cannot_stand", "no_gearbox"]
    assert 3.0 < result.mass_kg[0] < result.mass_kg[1] < 6.0
    assert np.isnan(result.mass_kg[2])
    assert np.isnan(result.efficiency[1])


@pytest.mark.parametrize(
    ("share", "status", "said"),
    [(0.5, "no_lift_off", "the foot had not left the floor"), (1.5, "timeout", "the base had not come to its apex")],
)
def test_a_jump_that_takes_too_long_says_what_was_missing(evaluator, share, status, said):
    """Time limits before lift-off, and between lift-off and apex; the limit itself is still allowed."""
    usual = evaluator(GOOD[None])
    assert 1.6 * usual.lift_off_s[0] < usual.apex_s[0]
    limit = round(share * usual.lift_off_s[0], 3)
    simulation = replace(evaluator.calibration.simulation, time_limit_s=limit)
    result = Evaluator(evaluator.actuator_map, replace(evaluator.calibration, simulation=simulation))(GOOD[None])
    assert result.status[0] == status
    assert result.reason[0] == f"{said} after {limit:.3f} s"


def test_a_leg_without_torque_sinks(evaluator):
    controller = replace(evaluator.calibration.controller, gravity_feed_forward=0.0)
    calibration = replace(evaluator.calibration, controller=controller)
    result = Evaluator(evaluator.actuator_map, calibration)(changed(stiffness_n_per_m=0.0)[None])
    assert result.status[0] == "no_lift_off"
    assert result.reason[0].startswith("the base sank to 0.1 m after 0.")


def test_long_batches_are_jumped_in_chunks(evaluator, monkeypatch):
    designs = random_designs(10, seed=2)
    whole = evaluator(designs)
    monkeypatch.setattr(evaluate, "_CHUNK", 3)
    np.testing.assert_array_equal(evaluator(designs).height_m, whole.height_m)


def test_losses_of_the_whole_gearbox_cost_height_and_more_than_those_of_the_meshes():
    designs = np.array([case.design.as_array() for case in PAPER_CASES.values()])
    reference = load_calibration()
    assert reference.drive.efficiency == "total"
    heights = [
        Evaluator(map_for("VT8020"), replace(reference, drive=replace(reference.drive, **changes)))(designs).height_m
        for changes in ({"mesh_losses": False}, {"efficiency": "mesh"}, {})
    ]
    assert np.all(heights[0] > heights[1])
    assert np.all(heights[1] > heights[2])


def test_the_table_of_a_map_has_the_total_of_every_service_sheet():
    found = map_for("VT8020")
    table = actuator_table(found)
    actuators = [entry.actuator for entry in found.entries if entry.actuator is not None]
    for row in (0, len(actuators) // 2, -1):
        losses = service_sheet(actuators[row], found.settings).losses
        assert table.efficiency_total[row] == losses.efficiency_total
        assert table.efficiency_total[row] < table.efficiency[row]
