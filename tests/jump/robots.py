"""Plausible robots, made without actuator search and part models."""

from dataclasses import replace

import numpy as np

from pareto_monoped.design import BASE_START_HEIGHT_M, LOWER, UPPER
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.leg.stops import Bumper, JointStop
from pareto_monoped.materials import MATERIALS
from pareto_monoped.robot.population import JointStops, RobotArrays

_HIP = Bumper(diameter_mm=20.0, length_mm=28.0, elastomer=MATERIALS.fluoroelastomer)
_KNEE = Bumper(diameter_mm=28.0, length_mm=28.0, elastomer=MATERIALS.fluoroelastomer)
_STOPS = JointStops(
    hip=JointStop(
        lower_rad=-np.radians(100.0), upper_rad=np.radians(100.0), lever_mm=67.0, half_face_mm=9.0, bumper=_HIP
    ),
    knee=JointStop(
        lower_rad=np.radians(15.0), upper_rad=np.radians(133.0), lever_mm=51.0, half_face_mm=13.0, bumper=_KNEE
    ),
)


def wild_calibration():
    """A floor so stiff that a jump of large steps by MuJoCo blows up on it."""
    reference = load_calibration("reference-3")
    return replace(
        reference,
        contact=replace(reference.contact, stiffness_n_per_m=1e15, damping_n_s_per_m=1e9),
        simulation=replace(reference.simulation, timestep_s=0.02, control_period_s=None),
    )


def random_designs(n, seed=0):
    return np.random.default_rng(seed).uniform(LOWER, UPPER, (n, 7))


def plausible_robots(designs):
    """Round numbers near those of the paper's robot: 3.2 to 4 kg, VT8020 motors, links of 0.235 kg + 0.828 kg/m."""
    designs = np.atleast_2d(designs)
    thigh, shank, ratio = designs[:, 0], designs[:, 1], designs[:, [3, 2]]
    n = len(designs)
    actuator = 0.93 + 0.045 * (ratio - 4.0)
    mass = np.stack([actuator[:, 0] + 0.3, actuator[:, 1] + 0.235 + 0.828 * thigh, 0.385 + 0.828 * shank], axis=1)
    com = np.zeros((n, 3, 3))
    com[:, 1, 2] = -0.4 * thigh * (0.235 + 0.828 * thigh) / mass[:, 1]
    com[:, 2, 2] = -0.6 * shank
    inertia = np.zeros((n, 3, 3, 3))
    inertia[:, 0] = 0.002 * np.eye(3)
    inertia[:, 1] = (0.002 + 0.12 * (0.235 + 0.828 * thigh) * thigh**2)[:, None, None] * np.eye(3)
    inertia[:, 2] = (0.001 + 0.12 * (0.385 + 0.828 * shank) * shank**2)[:, None, None] * np.eye(3)
    both = np.ones((n, 2))
    return RobotArrays(
        thigh_length_m=thigh,
        shank_length_m=shank,
        body_mass_kg=mass,
        body_com_m=com,
        body_inertia_kg_m2=inertia,
        foot_radius_m=np.full(n, 0.025),
        stand_mass_kg=np.full(n, 0.4),
        start_height_m=np.full(n, BASE_START_HEIGHT_M),
        ratio=ratio,
        armature_kg_m2=1.0e-4 * ratio**2,
        rotor_inertia_kg_m2=1.0e-4 * both,
        knee_reflected_kg_m2=1.0e-4 * ratio[:, 1] ** 2,
        knee_coupling_kg_m2=1.0e-4 * ratio[:, 1],
        rotor_excess_kg_m2=np.zeros(n),
        sprocket_radius_m=np.full(n, 0.026),
        drive_stiffness_n_m_per_rad=np.tile([20000.0, 2000.0], (n, 1)),
        peak_torque_n_m=5.5 * ratio,
        rated_torque_n_m=5.5 * ratio,
        continuous_torque_n_m=3.82 * ratio,
        no_load_speed_rad_per_s=502.65 / ratio,
        efficiency=0.97 * both,
        efficiency_total=0.94 * both,
        torque_constant_n_m_per_a=0.0955 * both,
        winding_resistance_ohm=0.06 * both,
        cost_eur=np.full(n, 12000.0),
        made_parts=np.full(n, 70.0),
        bought_parts=np.full(n, 230.0),
        reason=("",) * n,
        stops=_STOPS,
    )
