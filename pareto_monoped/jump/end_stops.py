"""End stops as the simulation has them: those that a calibration gives, or those of the leg's parts.

An ``EndStop`` becomes a joint limit of MuJoCo (``model.spring_fields``). Let u be the compression over the full width
w, D the impedance, and A the joint's inverse inertia at the zero pose. In a slow compression the stop pushes back with
the torque k w u^3 (1 - D) / (1 - D u). Its damping is c u (1 - D) / (1 - D u), and it adds the virtual inertia D u / (1
- D u) / A. Beyond w, damping and virtual inertia stay as at w, and the torque grows in proportion.
"""

import functools
import math
from dataclasses import replace

import numpy as np

from pareto_monoped.design import Floats
from pareto_monoped.jump.calibration import EndStop, Joints
from pareto_monoped.leg.stops import JointStop
from pareto_monoped.robot.population import RobotArrays

EndStops = tuple[EndStop | None, EndStop | None]  #: Of hip and knee; None for a joint that turns freely.

IMPACT_M_PER_S = 2.0  #: Speed at the bumper for which the elastomer's rebound holds, about that of knees at their stop.
IMPACT_KG_M2 = 0.031  #: Inertia of that impact: 1 / A of the knee, the median of 60 random designs (0.019 to 0.048).
IMPEDANCE = 0.6
"""D of the stops of parts. The slow torque fits that of the part about as well with any D from 0.1 to 0.6. By
simulation, this one makes heights and energies depend little on the step (docs/model.md)."""


def end_stops(robots: RobotArrays, joints: Joints) -> EndStops:
    """Return the end stops of both joints."""
    if joints.stops == "parts":
        return simulated(robots.stops.hip), simulated(robots.stops.knee)
    return joints.hip_stop, joints.knee_stop


def constraints(robots: RobotArrays, joints: Joints) -> EndStops:
    """Return the end stops that MuJoCo has as joint limits: none under a law of our own."""
    return (None, None) if joints.stop_law == "hunt_crossley" else end_stops(robots, joints)


@functools.lru_cache(maxsize=16)
def simulated(stop: JointStop) -> EndStop:
    """Return the end stop that behaves like a part: its slow torque is the least-squares fit over the bumper's travel.

    Its damping gives back the share of an impact's energy that the elastomer does (ISO 4662).
    """
    beyond = np.linspace(0.0, stop.travel_rad, 201)
    soft = EndStop(
        lower_rad=float(stop.lower_rad),
        upper_rad=float(stop.upper_rad),
        width_rad=stop.travel_rad,
        stiffness_n_m_per_rad=1.0,
        damping_n_m_s_per_rad=0.0,
        impedance=IMPEDANCE,
    )
    shape = slow_torque_n_m(soft, beyond)
    undamped = replace(soft, stiffness_n_m_per_rad=float(shape @ stop.torque_n_m(beyond) / (shape @ shape)))
    speed = IMPACT_M_PER_S / (1e-3 * stop.lever_mm)
    wanted = speed * math.sqrt(stop.bumper.elastomer.rebound_resilience)
    low, high = 0.0, 4.0 * math.sqrt(undamped.stiffness_n_m_per_rad * IMPACT_KG_M2)
    for _ in range(40):  # bisection: more damping, less rebound
        middle = 0.5 * (low + high)
        found = rebound_rad_per_s(replace(undamped, damping_n_m_s_per_rad=middle), speed, IMPACT_KG_M2)
        low, high = (middle, high) if found > wanted else (low, middle)
    return replace(undamped, damping_n_m_s_per_rad=0.5 * (low + high))


TEST_M_PER_S = (
    1.4  #: Speed of the pendulum with which ISO 4662 measures rebound. Knees meet their stop with 1.3 to 1.6.
)


def damping_s_per_m(rebound_resilience: Floats) -> Floats:
    """Return chi of bumpers that push back with f(x) (1 + chi v) and return a share of an impact's energy, shape (n,).

    K. H. Hunt and F. R. E. Crossley, "Coefficient of restitution interpreted as damping in vibroimpact", J. Appl.
    Mech. 42 (1975). For any f and any mass m, v dv / (1 + chi v) = -f dx / m. A body that comes with v and leaves with
    e v has a - ln(1 + a) = -e a - ln(1 - e a), with a = chi v. The share, e^2, is that of ISO 4662, at the speed of its
    test.
    """
    e = np.sqrt(rebound_resilience)
    low, high = np.zeros_like(e), 1.0 / e
    for _ in range(60):  # bisection: more damping, less rebound
        middle = 0.5 * (low + high)
        with np.errstate(divide="ignore"):
            gentle = middle - np.log1p(middle) + e * middle + np.log1p(-e * middle) > 0.0
        low, high = np.where(gentle, middle, low), np.where(gentle, high, middle)
    return np.asarray(0.5 * (low + high) / TEST_M_PER_S)


@functools.lru_cache(maxsize=16)
def bumper_damping_s_per_m(rebound_resilience: float) -> float:
    """Return ``damping_s_per_m`` of one material, which every batch of jumps asks for again."""
    return float(damping_s_per_m(np.array([rebound_resilience]))[0])


def slow_torque_n_m(stop: EndStop, beyond_rad: Floats) -> Floats:
    """Return the torque with which an end stop pushes back slowly at angles beyond its end of the range."""
    d = stop.impedance * np.clip(np.asarray(beyond_rad) / stop.width_rad, 0.0, 1.0)
    share = np.square(d / stop.impedance) * (1.0 - stop.impedance) / (1.0 - d)
    return np.asarray(stop.stiffness_n_m_per_rad * beyond_rad * share)


def rebound_rad_per_s(stop: EndStop, speed_rad_per_s: float, inertia_kg_m2: float) -> float:
    """Return the speed at which a free inertia leaves a stop that it met at a speed, see ``rebound``.

    The stop pushes and never pulls.
    """
    from pareto_monoped.jump.torques import rebound

    stiffness, damping = stop.stiffness_n_m_per_rad, stop.damping_n_m_s_per_rad
    return float(rebound(speed_rad_per_s, stop.width_rad, stop.impedance, stiffness, damping, inertia_kg_m2))
