"""The simulated end stops against the law of the parts, and against MuJoCo."""

import dataclasses

import mujoco
import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import LOWER, PAPER_CASES, UPPER, Design
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.end_stops import (
    IMPACT_KG_M2,
    IMPACT_M_PER_S,
    end_stops,
    rebound_rad_per_s,
    simulated,
    slow_torque_n_m,
)
from pareto_monoped.jump.single import simulate
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.leg.stops import hip_stop, knee_stop
from tests.jump.robots import plausible_robots, random_designs

MAP = map_for("VT8020")
LEG = leg_dimensions(MAP)
STOPS = {"hip": hip_stop(LEG), "knee": knee_stop(LEG)}
both = pytest.mark.parametrize("part", STOPS.values(), ids=STOPS)


def one_joint(stop, inertia_kg_m2, timestep_s=1e-5):
    """A wheel with the end stop as its limit, written from MuJoCo's documentation."""
    scale = (1.0 - stop.impedance) / inertia_kg_m2
    stiffness, damping = -stop.stiffness_n_m_per_rad * scale, -stop.damping_n_m_s_per_rad * scale
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><option gravity="0 0 0" timestep="{timestep_s}" tolerance="1e-14"/><compiler angle="radian"/>'
        f'<worldbody><body><inertial pos="0 0 0" mass="1" diaginertia="1 {inertia_kg_m2} 1"/>'
        f'<joint type="hinge" axis="0 1 0" limited="true" range="{stop.lower_rad} {stop.upper_rad}"'
        f' solreflimit="{stiffness} {damping}" solimplimit="0.0001 {stop.impedance} {stop.width_rad} 0.5 1"/>'
        "</body></worldbody></mujoco>"
    )


@both
def test_ends_are_those_of_the_part(part):
    stop = simulated(part)
    assert (stop.lower_rad, stop.upper_rad, stop.width_rad) == (part.lower_rad, part.upper_rad, part.travel_rad)


@both
def test_the_slow_torque_is_the_part_s_within_seven_percent_of_the_full_torque(part):
    beyond = np.linspace(0.0, part.travel_rad, 501)
    error = (slow_torque_n_m(simulated(part), beyond) - part.torque_n_m(beyond)) / part.torque_n_m(part.travel_rad)
    assert np.abs(error).max() < 0.065
    assert np.sqrt(np.square(error).mean()) < 0.042


@both
def test_no_other_stiffness_fits_better(part):
    beyond = np.linspace(0.0, part.travel_rad, 501)
    fitted, wanted = slow_torque_n_m(simulated(part), beyond), part.torque_n_m(beyond)
    least = np.square(fitted - wanted).sum()
    for factor in (0.99, 1.01):
        assert np.square(factor * fitted - wanted).sum() > least


@both
@pytest.mark.parametrize("share", [0.2, 0.6, 1.0, 1.3])
def test_mujoco_pushes_back_slowly_as_the_simulated_stop_says(part, share):
    stop = simulated(part)
    model = one_joint(stop, IMPACT_KG_M2)
    data = mujoco.MjData(model)
    data.qpos[0] = stop.upper_rad + share * stop.width_rad
    mujoco.mj_forward(model, data)
    torque = (data.efc_aref / data.efc_R)[0]
    assert torque == pytest.approx(slow_torque_n_m(stop, np.array([share * stop.width_rad]))[0], rel=2e-3)


@both
def test_an_impact_gives_back_what_the_elastomer_does(part):
    """By MuJoCo with a step of 10 us; the share is that of the energy (ISO 4662)."""
    model = one_joint(simulated(part), IMPACT_KG_M2)
    data = mujoco.MjData(model)
    speed = IMPACT_M_PER_S / (1e-3 * part.lever_mm)
    data.qpos[0], data.qvel[0] = part.lower_rad, -speed
    for _ in range(20000):
        mujoco.mj_step(model, data)
        if data.qpos[0] > part.lower_rad:
            break
    share = (data.qvel[0] / speed) ** 2
    assert share == pytest.approx(part.bumper.elastomer.rebound_resilience, abs=0.001)


def plain_rebound(stop, speed, inertia):
    """The same by Runge and Kutta's method in plain Python."""

    def acceleration(r, v):
        u = min(max(r / stop.width_rad, 0.0), 1.0)
        torque = stop.stiffness_n_m_per_rad * u * r + stop.damping_n_m_s_per_rad * v
        virtual = 1.0 / (1.0 - stop.impedance * u)
        return -max(0.0, u * (1.0 - stop.impedance) * virtual * torque) / (inertia * virtual)

    r, v, h = 0.0, speed, 0.005 * stop.width_rad / speed
    while r >= 0.0:
        k1 = v, acceleration(r, v)
        k2 = v + 0.5 * h * k1[1], acceleration(r + 0.5 * h * k1[0], v + 0.5 * h * k1[1])
        k3 = v + 0.5 * h * k2[1], acceleration(r + 0.5 * h * k2[0], v + 0.5 * h * k2[1])
        k4 = v + h * k3[1], acceleration(r + h * k3[0], v + h * k3[1])
        r += h / 6.0 * (k1[0] + 2.0 * k2[0] + 2.0 * k3[0] + k4[0])
        v += h / 6.0 * (k1[1] + 2.0 * k2[1] + 2.0 * k3[1] + k4[1])
    return -v


@both
@pytest.mark.parametrize("damping", [0.0, 0.3, 1.0, 4.0])
def test_the_compiled_rebound_is_that_of_plain_python(part, damping):
    stop = dataclasses.replace(simulated(part), damping_n_m_s_per_rad=damping)
    assert rebound_rad_per_s(stop, 80.0, 0.031) == pytest.approx(plain_rebound(stop, 80.0, 0.031), rel=1e-12)


def test_stops_come_from_the_calibration_or_the_parts():
    robots = plausible_robots(random_designs(1))
    given = load_calibration("reference-1").joints
    assert end_stops(robots, given) == (given.hip_stop, given.knee_stop)
    assert end_stops(robots, load_calibration("paper").joints) == (None, None)
    for name in ("reference", "reference-3"):
        found = end_stops(robots, load_calibration(name).joints)
        assert found == (simulated(robots.stops.hip), simulated(robots.stops.knee))


def rebound(design):
    """Speed with which the knee leaves its lower stop for the first time, over that with which it met it."""
    trace = simulate(design, MAP, load_calibration("reference-3"), trace=True).trace
    inside = np.flatnonzero(trace["knee_rad"] < STOPS["knee"].lower_rad)
    first = inside[0]
    out = first + np.flatnonzero(trace["knee_rad"][first:] >= STOPS["knee"].lower_rad)
    return trace["knee_rad_per_s"][out[0]] / -trace["knee_rad_per_s"][first - 1]


def test_knees_of_the_paper_s_designs_bounce_as_the_documentation_says():
    found = [rebound(case.design) for case in PAPER_CASES.values()]
    assert found == pytest.approx([0.285, 0.308, 0.255, 0.257], abs=0.02)


@pytest.mark.long
def test_knees_of_random_designs_bounce_as_the_documentation_says():
    designs = np.random.default_rng(9).uniform(LOWER, UPPER, (25, len(LOWER)))
    found = np.array([rebound(Design.from_array(values)) for values in designs])
    assert np.median(found) == pytest.approx(0.303, abs=0.02)
    assert (found.min(), found.max()) == pytest.approx((0.212, 0.375), abs=0.03)
