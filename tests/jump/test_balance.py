"""The energy balance of a jump: every entry on its own, and the sum."""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import CONTROL, LOWER, PAPER_CASES, UPPER, columns, complete
from pareto_monoped.jump.balance import EnergyBalance, energy_balance
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.single import trace_of
from pareto_monoped.leg.stops import knee_stop
from pareto_monoped.robot.population import robot_arrays

MAP = map_for("VT8020")
REFERENCE = load_calibration("reference-3")
PAPER = complete(np.array([case.design.as_array() for case in PAPER_CASES.values()]))
RANDOM = complete(np.random.default_rng(5).uniform(LOWER, UPPER, (100, len(LOWER))))


def balance_of(design, calibration=REFERENCE):
    robots = robot_arrays(design, MAP, calibration.mass)
    return robots, energy_balance(robots, columns(design[None], CONTROL), calibration)


def turned(angle, vector):
    """A vector (x, z) turned about +y."""
    x, z = vector
    return np.array([np.cos(angle) * x + np.sin(angle) * z, np.cos(angle) * z - np.sin(angle) * x])


def bodies_kinetic_j(robots, trace):
    """Of base, thigh and shank at the end of a trace, each a rigid body in the plane."""
    hip, knee = (trace[f"{joint}_rad"][-1] for joint in ("hip", "knee"))
    spin, knee_spin = (trace[f"{joint}_rad_per_s"][-1] for joint in ("hip", "knee"))
    half = 0.5 * trace["time_s"][1]
    hip, knee = hip - half * spin, knee - half * knee_spin
    base = np.array([trace["base_x_m_per_s"][-1], trace["base_z_m_per_s"][-1]])

    def end(start, rate, arm):
        return start + rate * np.array([arm[1], -arm[0]])

    at_knee = end(base, spin, turned(hip, (0.0, -robots.thigh_length_m[0])))
    energy = 0.5 * robots.body_mass_kg[0, 0] * base @ base
    for body, start, rate, angle in ((1, base, spin, hip), (2, at_knee, spin + knee_spin, hip + knee)):
        speed = end(start, rate, turned(angle, robots.body_com_m[0, body][[0, 2]]))
        energy += 0.5 * robots.body_mass_kg[0, body] * speed @ speed
        energy += 0.5 * robots.body_inertia_kg_m2[0, body, 1, 1] * rate**2
    return energy


@pytest.mark.parametrize("design", PAPER, ids=PAPER_CASES)
def test_every_entry_of_the_papers_designs_is_what_it_says(design):
    robots, balance = balance_of(design)
    jump = Evaluator(MAP, REFERENCE)(design)
    assert balance.motor_work_j == pytest.approx(jump.energy_j[0] - jump.absorbed_j[0], rel=1e-9)
    assert balance.mesh_loss_j + balance.chain_loss_j == pytest.approx(jump.drive_loss_j[0], rel=1e-9)
    assert balance.stops_absorbed_j + balance.stops_stored_j == pytest.approx(jump.stop_energy_j[0], rel=0.02)
    trace = trace_of(robots, columns(design[None], CONTROL), REFERENCE)
    assert balance.bodies_kinetic_j == pytest.approx(bodies_kinetic_j(robots, trace), rel=1e-6)
    whole = balance.bodies_kinetic_j + balance.rotors_kinetic_j
    assert whole == pytest.approx(trace["kinetic_j"][-1], rel=0.05)
    entries = ("mesh_loss", "chain_loss", "bodies_kinetic", "rotors_kinetic", "potential", "damping", "friction")
    assert all(getattr(balance, f"{entry}_j") > 0.0 for entry in (*entries, "stops_absorbed", "contact"))


@pytest.mark.parametrize(
    "designs",
    [PAPER, RANDOM[:30], pytest.param(RANDOM[30:], marks=pytest.mark.long)],
    ids=["paper", "random", "more"],
)
def test_the_balance_closes_to_a_thousandth(designs):
    """Without the integrator's own loss, which is an entry too, to a fifth of a percent."""
    for design in designs:
        _, balance = balance_of(design)
        assert abs(balance.residual_j) < 0.001 * balance.joint_work_j
        assert balance.error < 0.002


def test_the_integrators_loss_is_first_order_in_the_step():
    """It is what remains of Coriolis forces that are taken half a step early."""
    losses = []
    for step_s in (5e-4, 2.5e-4):
        calibration = replace(REFERENCE, simulation=replace(REFERENCE.simulation, timestep_s=step_s))
        losses.append(balance_of(PAPER[0], calibration)[1].integration_j)
    assert losses[1] == pytest.approx(0.5 * losses[0], rel=0.1)


def test_a_jump_that_is_cut_off_in_the_stop_has_energy_stored_there():
    whole = trace_of(robot_arrays(PAPER[0], MAP), columns(PAPER[0][None], CONTROL), REFERENCE)
    deepest = float(whole["time_s"][whole["knee_rad"].argmin()])
    cut = replace(REFERENCE, simulation=replace(REFERENCE.simulation, time_limit_s=deepest))
    robots, balance = balance_of(PAPER[0], cut)
    stop = knee_stop(None)
    beyond = np.linspace(0.0, stop.lower_rad - whole["knee_rad"].min(), 400)
    held = np.trapezoid(robots.stops.knee.torque_n_m(beyond), beyond)
    # The simulated stop is a fit of the part over its whole travel (tests/jump/test_end_stops.py). At four fifths of
    # the travel it has stored a quarter less.
    assert balance.stops_stored_j == pytest.approx(0.75 * held, rel=0.03)
    assert abs(balance.residual_j) < 0.001 * balance.joint_work_j


def test_chain_and_mesh_share_the_loss_by_their_efficiencies():
    """The mesh takes its share of the torque first, the chain its share of what is left; the hip has no chain."""
    drive = REFERENCE.drive
    without_chain = replace(REFERENCE, drive=replace(drive, chain_efficiency=1.0))
    without_mesh = replace(REFERENCE, drive=replace(drive, mesh_losses=False))
    assert balance_of(PAPER[0], without_chain)[1].chain_loss_j == 0.0
    assert balance_of(PAPER[0], without_mesh)[1].mesh_loss_j == 0.0
    robots, balance = balance_of(PAPER[0])
    trace = trace_of(robots, columns(PAPER[0][None], CONTROL), REFERENCE)
    mesh, chain = robots.efficiency_total[0, 1], drive.chain_efficiency
    speed = 0.5 * (trace["knee_rad_per_s"][1:] + trace["knee_rad_per_s"][:-1])
    lost = (trace["knee_motor_torque_n_m"] - trace["knee_torque_n_m"])[:-1] @ speed * trace["time_s"][1]
    assert balance.chain_loss_j == pytest.approx(lost * mesh * (1.0 - chain) / (1.0 - mesh * chain), rel=1e-9)


def test_the_error_counts_the_integrators_loss_and_what_nothing_explains():
    terms = dict.fromkeys(EnergyBalance.__slots__, 0.0) | {
        "motor_work_j": 21.0,
        "mesh_loss_j": 0.4,
        "chain_loss_j": 0.6,
        "bodies_kinetic_j": 1.0,
        "potential_j": 12.0,
        "stops_absorbed_j": 6.0,
        "integration_j": 0.5,
    }
    balance = EnergyBalance(**terms)
    assert balance.joint_work_j == 20.0
    assert balance.residual_j == 0.5
    assert balance.error == 0.05


def test_without_losses_joints_and_drives_lose_nothing():
    _, balance = balance_of(PAPER[3], load_calibration("ideal"))
    assert balance.damping_j == balance.friction_j == balance.mesh_loss_j == balance.chain_loss_j == 0.0


def test_a_jump_by_runge_kutta_closes_too():
    simulation = replace(REFERENCE.simulation, integrator="RK4", positions_read="state", timestep_s=2e-4)
    _, balance = balance_of(PAPER[3], replace(REFERENCE, simulation=simulation))
    assert balance.integration_j == 0.0
    assert balance.error < 0.001
