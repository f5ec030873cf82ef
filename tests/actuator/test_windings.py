"""Torque and heat of three phases, added up over an electrical period, against the equivalent DC machine."""

import math
from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.actuator.motors import load_motor
from pareto_monoped.actuator.search import build_map, map_for
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.actuator.windings import PER_PHASE_AMPLITUDE, PER_PHASE_RMS
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.robot.population import robot_arrays

# The middles of equal steps, so that sums over a period are integrals.
ANGLE = (np.arange(60_000) + 0.5) * 2.0 * math.pi / 60_000
PHASES = ANGLE[None, :] - 2.0 * math.pi * np.arange(3)[:, None] / 3.0
# A motor of 100 rpm/V and 0.06 ohm between its terminals at 250 rad/s.
KT, R_LINE, SPEED = 60.0 / (2.0 * math.pi * 100.0), 0.06, 250.0


@pytest.fixture(scope="module")
def vt8020():
    motor = load_motor("VT8020")
    assert (motor.torque_constant_n_m_per_a, motor.terminal_resistance_ohm) == (pytest.approx(KT), R_LINE)
    return motor


def sinusoidal(amplitude_a):
    """Induced voltages and currents of a star whose voltage between two terminals has the peak k_t w."""
    emf = KT * SPEED / math.sqrt(3.0) * np.sin(PHASES)
    between = emf[0] - emf[1]
    assert between.max() == pytest.approx(KT * SPEED, rel=1e-6)
    return emf, amplitude_a * np.sin(PHASES)


def trapezoidal(current_a):
    """Induced voltages with flat tops of 120 degrees, and a current that two phases carry at a time."""
    turn = np.mod(PHASES, 2.0 * math.pi)
    rise = math.pi / 6.0
    shape = np.interp(
        turn,
        [0.0, rise, math.pi - rise, math.pi + rise, 2.0 * math.pi - rise, 2.0 * math.pi],
        [0.0, 1.0, 1.0, -1.0, -1.0, 0.0],
    )
    emf = 0.5 * KT * SPEED * shape
    on = (turn > rise) & (turn < math.pi - rise)
    off = (turn > math.pi + rise) & (turn < 2.0 * math.pi - rise)
    current = current_a * (on.astype(float) - off.astype(float))
    assert (np.count_nonzero(current, axis=0) == 2).all()
    assert np.abs(current.sum(axis=0)).max() == 0.0
    return emf, current


def torque_and_heat(emf, current):
    """Means over the period: power of the induced voltages over the speed, and the heat of a star's three phases."""
    return (emf * current).sum(axis=0).mean() / SPEED, (0.5 * R_LINE * current**2).sum(axis=0).mean()


@pytest.mark.parametrize("wave", [sinusoidal, trapezoidal])
@pytest.mark.parametrize("ampere", [3.0, 57.6])
def test_heat_of_all_phases_is_that_of_the_equivalent_dc_machine(vt8020, wave, ampere):
    torque, heat = torque_and_heat(*wave(ampere))
    assert vt8020.winding_heat_w(torque) == pytest.approx(heat, rel=1e-6)


def test_the_current_of_a_torque_is_that_of_two_phases_in_series(vt8020):
    torque, _ = torque_and_heat(*trapezoidal(40.0))
    assert vt8020.current_a(torque) == pytest.approx(40.0, rel=1e-9)


def test_factors_of_sinusoidal_currents(vt8020):
    torque, heat = torque_and_heat(*sinusoidal(10.0))
    assert torque == pytest.approx(PER_PHASE_AMPLITUDE * KT * 10.0, rel=1e-9)
    assert torque == pytest.approx(PER_PHASE_RMS * KT * 10.0 / math.sqrt(2.0), rel=1e-9)
    assert heat == pytest.approx(1.5 * 0.5 * R_LINE * 10.0**2, rel=1e-9)


def test_blocks_of_current_in_a_sinusoidal_motor_give_3_over_pi_of_the_torque():
    emf, _ = sinusoidal(1.0)
    _, current = trapezoidal(1.0)
    torque, _ = torque_and_heat(emf, current)
    assert torque == pytest.approx(3.0 / math.pi * KT, rel=1e-6)


@pytest.mark.parametrize("wave", [sinusoidal, trapezoidal])
def test_a_delta_of_the_same_line_to_line_resistance_makes_the_same_heat(wave):
    """Branches of 3/2 of the line-to-line resistance; their currents are those without a circulating one."""
    _, lines = wave(20.0)
    branches = (lines - np.roll(lines, 1, axis=0)) / 3.0
    # Each line splits into the difference of two branches.
    assert np.abs(branches - np.roll(branches, -1, axis=0) - lines).max() < 1e-12
    heat = (1.5 * R_LINE * branches**2).sum(axis=0).mean()
    assert heat == pytest.approx((0.5 * R_LINE * lines**2).sum(axis=0).mean(), rel=1e-9)


def test_the_resistance_of_a_phase_is_half_of_that_between_terminals(vt8020):
    phase = replace(vt8020, winding_resistance_kind="phase", winding_resistance_ohm=0.5 * R_LINE)
    assert phase.terminal_resistance_ohm == vt8020.terminal_resistance_ohm
    assert phase.winding_heat_w(1.0) == vt8020.winding_heat_w(1.0)


def test_jumps_use_the_line_to_line_resistance():
    """The M6C12's data sheet gives that of a phase: the simulation's is twice as large."""
    design = PAPER_CASES["C"].design.replace({"knee_ratio": 6.0, "hip_ratio": 5.0}).as_array()
    published = map_for("MAD_M6C12", "paper").motor
    assert (published.winding_resistance_ohm, published.winding_resistance_kind) == (0.063, "phase")
    assert robot_arrays(design, map_for("MAD_M6C12", "paper")).winding_resistance_ohm.tolist() == [[0.126, 0.126]]
    measured = replace(published, winding_resistance_kind="line_to_line", winding_resistance_ohm=0.99 / 7.872)
    few = build_map(measured, ActuatorSettings(rules="paper", modules_mm=(0.5, 0.6)))
    assert robot_arrays(design, few).winding_resistance_ohm == pytest.approx(0.126, rel=0.003)


def test_the_published_motor_constant_is_torque_per_root_of_this_heat():
    """T-Motor's AK80-6: 0.091 N m/A and 170 mohm phase to phase give 0.2206; the U8 is a motor of the same constant."""
    assert 0.091 / math.sqrt(0.170) == pytest.approx(0.2206, rel=1e-3)
    u8 = load_motor("U8")
    assert 1.0 / math.sqrt(u8.winding_heat_w(1.0)) == pytest.approx(0.2206, rel=0.01)
