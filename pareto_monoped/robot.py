"""Design -> Robot: the one place where actuators, links and base become bodies with masses and inertias.

Both the simulation and the CAD read the robot from here.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

BODIES = ("base", "thigh", "shank")
JOINTS = ("hip", "knee")


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotArrays:
    """What the simulation needs of n robots; the last axes are in the order of ``BODIES`` and ``JOINTS``.

    Body frames: ``base`` at the hip axis, ``thigh`` at the hip axis, ``shank`` at the knee axis; x forward, y to the
    left (the joint axes), z up; at zero joint angles both links hang straight down along -z.

    Attributes:
        thigh_length_m, shank_length_m: hip axis to knee axis, knee axis to foot centre, shape (n,).
        body_mass_kg: shape (n, 3).
        body_com_m: centres of mass in the body frames, shape (n, 3, 3).
        body_inertia_kg_m2: about the centres of mass, axes of the body frames, shape (n, 3, 3, 3).
        foot_radius_m: shape (n,).
        ratio: real ratios of the gearboxes (not the searched ones), shape (n, 2).
        armature_kg_m2: reflected inertia of all that turns with the motor, at the joint, shape (n, 2).
        peak_torque_n_m, continuous_torque_n_m: at the joint, before losses, shape (n, 2).
        no_load_speed_rad_per_s: at the joint, shape (n, 2).
        efficiency: of the gear mesh, shape (n, 2).
        torque_constant_n_m_per_a, winding_resistance_ohm: of the motor itself, shape (n, 2).
        reason: why the robot cannot be built, empty if it can, n strings.
    """

    thigh_length_m: NDArray[np.float64]
    shank_length_m: NDArray[np.float64]
    body_mass_kg: NDArray[np.float64]
    body_com_m: NDArray[np.float64]
    body_inertia_kg_m2: NDArray[np.float64]
    foot_radius_m: NDArray[np.float64]
    ratio: NDArray[np.float64]
    armature_kg_m2: NDArray[np.float64]
    peak_torque_n_m: NDArray[np.float64]
    continuous_torque_n_m: NDArray[np.float64]
    no_load_speed_rad_per_s: NDArray[np.float64]
    efficiency: NDArray[np.float64]
    torque_constant_n_m_per_a: NDArray[np.float64]
    winding_resistance_ohm: NDArray[np.float64]
    reason: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.thigh_length_m)
