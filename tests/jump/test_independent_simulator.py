"""The jump against a simulator that uses neither MuJoCo nor the package, only docs/model.md (``tests/jump/planar.py``).

Both get the same numbers: masses, centres, inertias, gearboxes, motors, stops and the calibration.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import LOWER, NAMES, PAPER_CASES, PAPER_CONTROL, UPPER, complete
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.end_stops import end_stops
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.robot.population import robot_arrays
from tests.jump import planar

CASES = np.array([case.design.as_array() for case in PAPER_CASES.values()])
RANDOM = complete(np.random.default_rng(11).uniform(LOWER, UPPER, (8, len(LOWER))))
OTHER = CASES[[0, 3]].copy()
"""Two of the paper's designs with other values of the optional variables."""
OTHER[:, [NAMES.index(name) for name in ("knee_release_rad", "rest_length_m", "start_height_m")]] = 0.4, 9.0, 0.45


ARMS_AND_CARRIAGES_KG = 2 * 0.0930 + 4 * 0.054 + 16 * 0.0010
"""Arms of the stand as ``leg.stand`` draws them for a VT8020, carriages as HIWIN weighs them, screws."""


def timed(calibration="reference", **changes):
    known = load_calibration(calibration)
    return replace(known, simulation=replace(known.simulation, **changes))


def machine(robots, i, design, calibration):
    """The numbers of robot ``i``, as the simulator without MuJoCo takes them."""
    joints, contact, drive = calibration.joints, calibration.contact, calibration.drive
    stops = end_stops(robots, joints)
    constant = robots.ratio[i] * robots.torque_constant_n_m_per_a[i]
    resistance = robots.winding_resistance_ohm[i] / constant**2
    return planar.with_inverse_masses(
        planar.Machine(
            thigh=robots.thigh_length_m[i],
            shank=robots.shank_length_m[i],
            radius=robots.foot_radius_m[i],
            mass=robots.body_mass_kg[i],
            centres=tuple(tuple(robots.body_com_m[i, body, [0, 2]]) for body in (1, 2)),
            inertia=robots.body_inertia_kg_m2[i, 1:, 1, 1] + [robots.rotor_excess_kg_m2[i], 0.0],
            reflected=np.array([robots.armature_kg_m2[i, 0], robots.knee_reflected_kg_m2[i]]),
            coupling=robots.knee_coupling_kg_m2[i],
            lower=np.array([stop.lower_rad for stop in stops]),
            upper=np.array([stop.upper_rad for stop in stops]),
            stop=tuple((s.stiffness_n_m_per_rad, s.damping_n_m_s_per_rad, s.width_rad, s.impedance) for s in stops),
            peak=robots.peak_torque_n_m[i],
            no_load=robots.no_load_speed_rad_per_s[i],
            corner=robots.no_load_speed_rad_per_s[i] - resistance * robots.peak_torque_n_m[i],
            loss=1.0 - robots.efficiency_total[i] * [1.0, drive.chain_efficiency],
            heat=resistance,
            gains=tuple(design[name] for name in PAPER_CONTROL),
            rest=design["rest_length_m"],
            release=design["knee_release_rad"],
            damping=joints.damping_n_m_s_per_rad,
            friction=joints.friction_n_m,
            loss_speed=drive.loss_speed_rad_per_s,
            foot=(contact.stiffness_n_per_m, contact.damping_n_s_per_m, contact.width_m, contact.impedance),
            mu=contact.friction,
            slip=contact.slip_ratio,
            fade=calibration.gate.length_m,
            inverse=np.zeros(3),
            start=robots.start_height_m[i],
            delay=round(calibration.simulation.delay_s / 1e-3),
            guided=not calibration.simulation.base_slides,
            stand=0.0 if calibration.stand is None else ARMS_AND_CARRIAGES_KG,
            rails=0.0 if calibration.stand is None else 4.0 * calibration.stand.rail_friction_n,
        )
    )


@cache
def by_hand(which):
    """Height in m, mechanical energy and energy at the battery in J, one row per design."""
    designs, changes = JUMPS[which]
    calibration = timed(**changes)
    robots = robot_arrays(designs, map_for("VT8020"))
    machines = [machine(robots, i, dict(zip(NAMES, row, strict=True)), calibration) for i, row in enumerate(designs)]
    return np.array([planar.jump(m, planar.standing(m)) for m in machines]).T


JUMPS = {
    "paper": (CASES, {}),
    "random": (RANDOM, {}),
    "optional": (OTHER, {}),
    "late": (RANDOM, {"delay_s": 2e-3}),
    "stand": (np.vstack((CASES, RANDOM)), {"calibration": "stand"}),
}


def compared(which, *, height_m, share, **fine):
    """Jump by hand and by package; the energies agree within a share."""
    designs, changes = JUMPS[which]
    height, energy, battery = by_hand(which)
    found = Evaluator(map_for("VT8020"), timed(**changes, **fine))(designs)
    np.testing.assert_allclose(found.height_m, height, atol=height_m, rtol=0.0)
    np.testing.assert_allclose(found.energy_j, energy, rtol=share)
    np.testing.assert_allclose(found.electrical_energy_j, battery, rtol=share)


@pytest.mark.parametrize("which", JUMPS)
def test_the_simulation_is_the_documented_one(which):
    """Within what its step of 1 ms loses (docs/model.md, "Integration and control period")."""
    compared(which, height_m=0.6e-3, share=2e-3)


@pytest.mark.parametrize("which", JUMPS)
def test_both_converge_to_the_same_jump(which):
    """With a fine step in MuJoCo as well, what is left is the order of two methods: 0.3 um and 5e-6 of the energy.

    On the stand it is how friction sets in: here at once, there over some millimetres per second.
    """
    height_m = 1e-4 if which == "stand" else 3e-6
    compared(which, height_m=height_m, share=3e-5, integrator="RK4", positions_read="state", timestep_s=5e-5)
