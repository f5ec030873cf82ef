"""What a jump does against gravity: how far the centre of mass rises, how high a robot stands, what a height takes.

Angles are those of ``model``. The centre of mass is at the height z + s + a constant of the robot, with the height z of
the base and s = a cos h + b sin h + c cos f + d sin f, for the angles h of the thigh and f of the shank.
"""

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import GRAVITY_M_PER_S2, Floats
from pareto_monoped.jump.calibration import Calibration, SpringContact
from pareto_monoped.jump.end_stops import end_stops
from pareto_monoped.jump.model import SHANK, THIGH, compression_m, slow_force_n, stand_mass_kg, start_pose, wound_j
from pareto_monoped.jump.variations import take
from pareto_monoped.robot.population import RobotArrays

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)
_COARSE, _FINE, _TIMES = 97, 17, 3  # knee angles tried over the whole range, then around the best, and how often
_AT_ONCE = 1000  # robots searched together, so that their arrays stay in the processor's cache
_CLEAR_M = 1e-9  # by which rounding may put a foot on the floor below it


def _levers_m(robots: RobotArrays, stand_kg: Floats) -> Floats:
    """Return a, b, c and d, shape (4, n); a test stand of mass ``stand_kg``, shape (n,), rises with the base."""
    share = robots.body_mass_kg / (robots.body_mass_kg.sum(axis=1) + stand_kg)[:, None]
    thigh, shank = share[:, THIGH - 1], share[:, SHANK - 1]
    (thigh_x, _, thigh_z), (shank_x, _, shank_z) = robots.body_com_m[:, THIGH - 1].T, robots.body_com_m[:, SHANK - 1].T
    a = thigh * thigh_z - shank * robots.thigh_length_m
    return np.stack([a, -thigh * thigh_x, shank * shank_z, -shank * shank_x])


def _below_m(levers: Floats, thigh_rad: Floats, shank_rad: Floats) -> Floats:
    a, b, c, d = levers
    return np.asarray(a * np.cos(thigh_rad) + b * np.sin(thigh_rad) + c * np.cos(shank_rad) + d * np.sin(shank_rad))


def _height_m(levers: Floats, position: Floats) -> Floats:
    """Return z + s in states (x, z, hip, knee), shape (n, 4)."""
    _, z, hip, knee = position.T
    return np.asarray(z + _below_m(levers, hip, hip + knee))


def rise_m(robots: RobotArrays, records: NDArray[np.void]) -> Floats:
    """Return how far the centres of mass rise from lift-off to their apex, shape (n,), of jumps that have ended.

    On the test stand, they are those of robot and stand together.

    Lift-off is the moment at which the foot's lowest point leaves the floor, between the last state with contact and
    the next: from the last state itself, a rise would be up to 4 mm too large, by chance. A jump ends at the apex of
    its base. Its links then still swing, so its centre of mass still rises or falls already. As it flies on a parabola,
    its apex is v^2 / (2 g) above its height at the end, with its speed v there, whichever way it moves.
    """
    levers = _levers_m(robots, records["stand_mass_kg"])
    end, (_, rate, hip_rate, knee_rate) = records["position"], records["velocity"].T
    a, b, c, d = levers
    turning = np.stack([b * hip_rate, -a * hip_rate, d * (hip_rate + knee_rate), -c * (hip_rate + knee_rate)])
    speed = rate + _below_m(turning, end[:, 2], end[:, 2] + end[:, 3])
    return np.asarray(_height_m(levers, end) + np.square(speed) / (2.0 * GRAVITY_M_PER_S2) - left_m(robots, records)[0])


def left_m(robots: RobotArrays, records: NDArray[np.void]) -> tuple[Floats, Floats]:
    """Return heights and vertical speeds of the centres of mass at lift-off, both of shape (n,)."""
    levers, zero = _levers_m(robots, records["stand_mass_kg"]), np.zeros(len(robots))
    to_foot = np.stack([-robots.thigh_length_m, zero, -robots.shank_length_m, zero])
    before, after = records["lift_off_positions"][:, 0], records["lift_off_positions"][:, 1]
    below, above = (_height_m(to_foot, at) - robots.foot_radius_m for at in (before, after))
    share = np.clip(below / np.minimum(below - above, -1e-12), 0.0, 1.0)
    first, second = _height_m(levers, before), _height_m(levers, after)
    return (1.0 - share) * first + share * second, (second - first) / records["timestep_s"]


def standing_height_m(robots: RobotArrays, calibration: Calibration) -> Floats:
    """Return heights of bases that stand on legs as straight as the knee's stop allows, shape (n,)."""
    stop = end_stops(robots, calibration.joints)[1]
    knee = 0.0 if stop is None else float(np.clip(0.0, stop.lower_rad, stop.upper_rad))
    along = robots.thigh_length_m + robots.shank_length_m * np.cos(knee)
    return np.asarray(np.hypot(along, robots.shank_length_m * np.sin(knee)) + robots.foot_radius_m)


def least_energy_j(robots: RobotArrays, calibration: Calibration, height_m: Floats) -> Floats:
    """Return the energy below which no controller can bring each base to its height, shape (n,).

    It is the least rise of potential energy from the start to any pose with the base there, less what the springs of
    the foot and of elastic drives give back from the start. A pose is reachable with the foot not below the floor and
    both joints between their stops, whose bumpers may be pressed over their whole travel. It is 0 where a robot need
    not rise, and NaN for one that cannot stand.
    """
    weight_n, start_m = _start(robots, calibration)
    below = np.empty(len(robots))
    for first in range(0, len(robots), _AT_ONCE):
        rows = np.arange(first, min(first + _AT_ONCE, len(robots)))
        below[rows] = _least_below_m(take(robots, rows), calibration, height_m[rows])
    return np.asarray(np.maximum(weight_n * (height_m + below - start_m), 0.0))


def least_of_all_j(
    robots: RobotArrays, calibration: Calibration, heights_m: Floats, known_j: float | Floats = np.inf
) -> Floats:
    """Return the least ``least_energy_j`` of n robots at each height: no jump of any of them lies below it.

    A robot is searched at the heights only at which a bound is below what another one needs, or what is ``known_j`` of
    others. The bound is weak duality: with a price on the foot's depth below the floor and none on the stops, thigh and
    shank hang as they like.
    """
    weight_n, start_m = _start(robots, calibration)
    a, b, c, d = _levers_m(robots, stand_mass_kg(robots, calibration))
    lines = []
    for price in (0.0 * c, np.clip(-c / robots.shank_length_m, 0.0, 1.0)):
        hanging = np.hypot(a + price * robots.thigh_length_m, b) + np.hypot(c + price * robots.shank_length_m, d)
        lines.append((weight_n * (1.0 - price), weight_n * (price * robots.foot_radius_m - hanging - start_m)))

    def bound(rows: NDArray[np.intp]) -> Floats:
        (steep, low), (flat, high) = ((slope[rows, None], constant[rows, None]) for slope, constant in lines)
        return np.asarray(np.maximum(np.maximum(steep * heights_m + low, flat * heights_m + high), 0.0))

    least, every = np.full(len(heights_m), known_j), np.arange(len(heights_m))
    # After the first robots, few are near what those need.
    for rows in np.split(np.flatnonzero(np.isfinite(start_m)), [_AT_ONCE]):
        parts = np.array_split(rows, len(rows) // _AT_ONCE + 1)
        near = np.concatenate([part[(bound(part) < least).any(axis=1)] for part in parts])
        if not len(near):
            continue
        bounds, columns = bound(near), every
        found = bounds.argmin(axis=0)
        for _ in range(2):
            np.minimum.at(least, columns, least_energy_j(take(robots, near[found]), calibration, heights_m[columns]))
            found, columns = np.nonzero(bounds < least)
    return least


def _start(robots: RobotArrays, calibration: Calibration) -> tuple[Floats, Floats]:
    """Return weight, and z + s at the start with what its springs hold counted as height, shape (n,) each."""
    stand_kg = stand_mass_kg(robots, calibration)
    weight_n = (robots.body_mass_kg.sum(axis=1) + stand_kg) * GRAVITY_M_PER_S2
    pose, zero = start_pose(robots, calibration), np.zeros(len(robots))
    spring_j = zero
    if isinstance(contact := calibration.contact, SpringContact):
        sunk = compression_m(contact, weight_n)
        spring_j = 0.5 * sunk * (_WEIGHTS @ slow_force_n(contact, 0.5 * sunk * (1.0 + _NODES[:, None])))
    position = np.stack([zero, robots.start_height_m, pose.hip_rad, pose.knee_rad], axis=1)
    held_j = spring_j + wound_j(robots, calibration, pose)
    return weight_n, _height_m(_levers_m(robots, stand_kg), position) + held_j / weight_n


def _least_below_m(robots: RobotArrays, calibration: Calibration, height_m: Floats) -> Floats:
    """Return the least s of each robot's reachable poses with the base at its height, shape (n,).

    For a knee angle, s is a sinusoid of the hip angle, and so is the foot's depth below the base: the best hip angle is
    that of the sinusoid's least value, or an end of what the floor and the stops leave. Knee angles are searched finer
    and finer around the best.
    """
    (hip_low, hip_high), (knee_low, knee_high) = (
        (-np.pi, np.pi) if stop is None else (stop.lower_rad - stop.width_rad, stop.upper_rad + stop.width_rad)
        for stop in end_stops(robots, calibration.joints)
    )
    a, b, c, d = _levers_m(robots, stand_mass_kg(robots, calibration))[..., None]
    thigh, shank = robots.thigh_length_m[:, None], robots.shank_length_m[:, None]
    room = (height_m - robots.foot_radius_m)[:, None]
    middle, half = np.full((len(robots), 1), 0.5 * (knee_low + knee_high)), 0.5 * (knee_high - knee_low)
    for count in (_COARSE, *(_FINE,) * _TIMES):
        knee = np.clip(middle + half * np.linspace(-1.0, 1.0, count), knee_low, knee_high)
        sin, cos = np.sin(knee), np.cos(knee)
        p, q = a + c * cos + d * sin, b - c * sin + d * cos
        along, across = thigh + shank * cos, shank * sin
        turned, beside = np.arctan2(across, along), np.arccos(np.clip(room / np.hypot(along, across), -1.0, 1.0))
        best = np.full(knee.shape, np.inf)
        for hip in (np.arctan2(-q, -p), beside - turned, -beside - turned, hip_low, hip_high):
            angle = np.mod(hip + np.pi, 2.0 * np.pi) - np.pi
            sin_h, cos_h = np.sin(angle), np.cos(angle)
            free = (along * cos_h - across * sin_h <= room + _CLEAR_M) & (angle >= hip_low) & (angle <= hip_high)
            best = np.minimum(best, np.where(free, p * cos_h + q * sin_h, np.inf))
        chosen = best.argmin(axis=1)[:, None]
        middle, half = np.take_along_axis(knee, chosen, axis=1), 2.0 * half / (count - 1)
    return np.take_along_axis(best, chosen, axis=1)[:, 0]
