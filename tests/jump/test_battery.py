"""Energy at the battery and the rate of jumps that the windings stand, from the trace of a jump."""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import LOWER, PAPER_CASES, UPPER, Design
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.single import simulate

REFERENCE = load_calibration("reference-3")
"""With rigid drives, whose motors have the speeds of the trace's joints (tests/jump/test_elastic.py has the others)."""
STEP = REFERENCE.simulation.timestep_s


def powers(design, calibration):
    """Mechanical power and winding heat of both motors in every step, shape (steps, 2), from the trace."""
    actuator_map = map_for("VT8020")
    trace = simulate(design, actuator_map, calibration, trace=True).trace
    motor = actuator_map.motor
    mechanical, heat = [], []
    for joint in ("hip", "knee"):
        torque = trace[f"{joint}_motor_torque_n_m"][:-1]
        speed = trace[f"{joint}_rad_per_s"]
        ratio = actuator_map.lookup(getattr(design, f"{joint}_ratio")).ratio
        current = torque / (ratio * motor.torque_constant_n_m_per_a)
        mechanical.append(torque * 0.5 * (speed[1:] + speed[:-1]))
        heat.append(motor.winding_resistance_ohm * current**2)
    return np.array(mechanical).T, np.array(heat).T


@pytest.mark.parametrize("share", [0.0, 0.6, 1.0])
def test_each_motor_takes_what_it_needs_and_gives_back_a_share(share):
    calibration = replace(REFERENCE, drive=replace(REFERENCE.drive, regeneration_share=share, standby_power_w=12.0))
    for case in PAPER_CASES.values():
        mechanical, heat = powers(case.design, calibration)
        electrical = mechanical + heat
        taken, back = np.maximum(electrical, 0.0).sum() * STEP, np.maximum(-electrical, 0.0).sum() * STEP
        evaluations = Evaluator(map_for("VT8020"), calibration)(case.design.as_array())
        expected = taken - share * back + 12.0 * evaluations.apex_s[0]
        assert evaluations.electrical_energy_j[0] == pytest.approx(expected, rel=1e-9)


def test_the_hotter_motor_sets_the_rate_of_jumps():
    motor = map_for("VT8020").motor
    for case in PAPER_CASES.values():
        _, heat = powers(case.design, REFERENCE)
        allowed = motor.winding_resistance_ohm * (motor.continuous_torque_n_m / motor.torque_constant_n_m_per_a) ** 2
        expected = 60.0 * allowed / (heat.sum(axis=0) * STEP).max()
        rate = Evaluator(map_for("VT8020"), REFERENCE)(case.design.as_array()).sustained_jumps_per_minute[0]
        assert rate == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("name", ["reference", "reference-3"])
def test_the_battery_pays_for_work_and_heat(name):
    """Without power that flows back, the battery's energy lies between the heat alone and work and heat together."""
    designs = np.random.default_rng(2).uniform(LOWER, UPPER, (40, len(LOWER)))
    found = Evaluator(map_for("VT8020"), load_calibration(name))(designs)
    ok = found.ok
    assert np.all(found.electrical_energy_j[ok] <= (found.energy_j + found.joule_heat_j)[ok] * (1.0 + 1e-12))
    assert np.all(found.electrical_energy_j[ok] >= (found.energy_j + found.joule_heat_j - found.absorbed_j)[ok])
    assert Design.from_array(designs[0])
