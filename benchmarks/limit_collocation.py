"""Least energy of a jump's torques by direct collocation, against the search of ``pareto-monoped limit``.

Nothing of the simulator is used but the robots' numbers: the Lagrangian is written down, CasADi differentiates it, and
IPOPT solves for states and torques together (Hermite and Simpson's rule). On the ground the foot rolls without slip on
a hard floor, with two degrees of freedom; in flight there are four and no torque. Needs ``pip install casadi``.

    python benchmarks/limit_collocation.py [--jumps N]
"""

import argparse
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

from pareto_monoped.actuator.search import map_for
from pareto_monoped.analysis import limit
from pareto_monoped.design import CONTROL, PAPER_CASES, Design, columns
from pareto_monoped.jump.calibration import Calibration, FadeGate, load_calibration
from pareto_monoped.jump.engines import population_of
from pareto_monoped.jump.model import start_pose
from pareto_monoped.robot.population import robot_arrays

GRAVITY, FRICTION = 9.81, 1.0
STANCE, FLIGHT = 60, 30
DESIGNS = {
    "paper's nominal": PAPER_CASES["nominal"].design,
    "paper's B": PAPER_CASES["B"].design,
    "paper's C": PAPER_CASES["C"].design,
    "0.90 m": Design.from_array([0.5, 0.301, 4.09, 4.09, 5.0, 10.0, 0.0]),
    "1.25 m": Design.from_array([0.5, 0.5, 7.2, 4.09, 7.5, 0.2, 0.0]),
}


class Leg:
    """The equations of motion of one robot, from its Lagrangian."""

    def __init__(self, record: np.void, start: np.ndarray) -> None:
        self.record, self.start = record, start
        q, v = ca.SX.sym("q", 4), ca.SX.sym("v", 4)  # x, z, hip, knee
        self._q, self._v = q, v
        l1, l2 = record["thigh_length_m"], record["shank_length_m"]

        def turned(angle: ca.SX, point: tuple[float, float]) -> ca.SX:
            s, c = ca.sin(angle), ca.cos(angle)
            return ca.vertcat(c * point[0] + s * point[1], c * point[1] - s * point[0])

        base, below = q[:2], q[2] + q[3]
        knee = base + turned(q[2], (0.0, -l1))
        self.foot = knee + turned(below, (0.0, -l2))
        thigh, shank = (
            base + turned(q[2], tuple(record["thigh_com_m"])),
            knee + turned(below, tuple(record["shank_com_m"])),
        )
        masses = record["body_mass_kg"]
        points = (base, thigh, shank)
        speeds = [ca.jtimes(point, q, v) for point in points]
        turning = (
            record["link_inertia_kg_m2"][0] * v[2] ** 2 + record["link_inertia_kg_m2"][1] * (v[2] + v[3]) ** 2
        ) / 2
        motors = (record["armature_kg_m2"][0] * v[2] ** 2 + record["armature_kg_m2"][1] * v[3] ** 2) / 2
        motors += record["coupling_kg_m2"] * v[2] * v[3]
        self.kinetic = sum(m * ca.sumsqr(s) / 2 for m, s in zip(masses, speeds, strict=True)) + turning + motors
        self.potential = GRAVITY * sum(m * point[1] for m, point in zip(masses, points, strict=True))
        self.mass = float(masses.sum())
        centre = sum(m * point for m, point in zip(masses, points, strict=True)) / self.mass
        self.centre = ca.Function("centre", [q], [centre])
        self.foot_of = ca.Function("foot", [q], [self.foot])

    def _bumper(self, q: ca.SX, v: ca.SX) -> Any:
        torques: list[Any] = []
        for j in range(2):
            lower, upper = self.record["lower_stop_rad"][j], self.record["upper_stop_rad"][j]
            per, scale, chi = (self.record[name][j] for name in ("bumper_per_rad", "bumper_n_m", "bumper_s_per_rad"))
            torque: Any = 0
            for side, beyond in ((1.0, lower - q[j]), (-1.0, q[j] - upper)):
                share = per * (beyond + ca.sqrt(beyond**2 + 1e-8)) / 2
                slow = scale * (1.25 * share**1.5 + 50.0 * share**6)
                damped = 1.0 - side * chi * v[j]
                torque += side * slow * (damped + ca.sqrt(damped**2 + 1e-6)) / 2
            torques.append(torque)
        return ca.vertcat(*torques)

    def flight(self) -> ca.Function:
        """Return accelerations of all four coordinates, and no torque."""
        q, v = self._q, self._v
        forces = ca.vertcat(0, 0, self._bumper(q[2:], v[2:]))
        return ca.Function("flight", [q, v], [self._accelerations(q, v, self.kinetic, self.potential, forces)])

    @staticmethod
    def _accelerations(q: ca.SX, v: ca.SX, kinetic: ca.SX, potential: ca.SX, forces: ca.SX) -> ca.SX:
        momentum = ca.gradient(kinetic, v)
        matrix = ca.jacobian(momentum, v)
        rest = ca.jtimes(momentum, q, v) - ca.gradient(kinetic, q) + ca.gradient(potential, q)
        return ca.solve(matrix, forces - rest)

    def stance(self) -> tuple[ca.Function, ca.Function]:
        """Return accelerations of hip and knee under torques with the floor's force, and all coordinates from both."""
        angles, rates, torque = ca.SX.sym("angles", 2), ca.SX.sym("rates", 2), ca.SX.sym("torque", 2)
        hanging = ca.substitute(self.foot, self._q, ca.vertcat(0, 0, angles))
        turn = ca.sum1(angles) - float(self.start[2] + self.start[3])
        foot0 = np.array(self.foot_of(self.start)).ravel()
        radius = self.record["foot_radius_m"]
        base = ca.vertcat(foot0[0] + radius * turn, foot0[1]) - hanging  # the foot rolls
        q = ca.vertcat(base, angles)
        v = ca.jtimes(q, angles, rates)
        kinetic, potential = (
            ca.substitute(one, ca.vertcat(self._q, self._v), ca.vertcat(q, v)) for one in (self.kinetic, self.potential)
        )
        a = self._accelerations(angles, rates, kinetic, potential, torque + self._bumper(angles, rates))
        centre = ca.substitute(self.mass * self.centre(self._q), self._q, q)
        speed = ca.jtimes(centre, angles, rates)
        force = ca.jtimes(speed, angles, rates) + ca.jtimes(speed, rates, a) + ca.vertcat(0, self.mass * GRAVITY)
        return ca.Function("stance", [angles, rates, torque], [a, force]), ca.Function("whole", [angles, rates], [q, v])


def least_energy(design: Design, calibration: Calibration, height_m: float) -> float:
    """Return the least energy of torques that lift the base to a height, begun with the jump of a design.

    It is infinite if IPOPT finds none.
    """
    values, maps = design.as_array()[None], map_for("VT8020")
    robots = robot_arrays(values, maps, calibration.mass)
    population = population_of(robots, columns(values, CONTROL), start_pose(robots, calibration), calibration)
    seen = population.observed()[0]
    record = population.records[0]
    left, step = int(record["lift_off_step"]) - 1, calibration.simulation.timestep_s
    leg = Leg(record, seen[0, :4])
    stance, whole = leg.stance()
    flight = leg.flight()
    limit = record["torque_limit_n_m"]
    slope = limit / (record["no_load_speed_rad_per_s"] - record["corner_speed_rad_per_s"])

    opti = ca.Opti()
    t1, t2 = opti.variable(), opti.variable()
    n, m = STANCE, FLIGHT
    q1, v1, u1 = opti.variable(2, 2 * n + 1), opti.variable(2, 2 * n + 1), opti.variable(2, 2 * n + 1)
    work = opti.variable(2, 2 * n + 1)
    q2, v2 = opti.variable(4, 2 * m + 1), opti.variable(4, 2 * m + 1)
    opti.subject_to(opti.bounded(0.05, t1, 1.0))
    opti.subject_to(opti.bounded(0.02, t2, 1.0))
    a1 = []
    for k in range(2 * n + 1):
        a, force = stance(q1[:, k], v1[:, k], u1[:, k])
        a1.append(a)
        opti.subject_to(force[1] >= 0.0)
        opti.subject_to(opti.bounded(-FRICTION * force[1], force[0], FRICTION * force[1]))
        for j in range(2):
            opti.subject_to(opti.bounded(-limit[j], u1[j, k], limit[j]))
            opti.subject_to(u1[j, k] <= slope[j] * (record["no_load_speed_rad_per_s"][j] - v1[j, k]))
            opti.subject_to(u1[j, k] >= -slope[j] * (record["no_load_speed_rad_per_s"][j] + v1[j, k]))
            opti.subject_to(work[j, k] >= u1[j, k] * v1[j, k] / 100.0)
            opti.subject_to(work[j, k] >= 0.0)
    a2 = [flight(q2[:, k], v2[:, k]) for k in range(2 * m + 1)]

    def joined(q: ca.MX, v: ca.MX, a: list[ca.MX], h: ca.MX, parts: int) -> None:
        for k in range(0, 2 * parts, 2):
            for y, dy in ((q, [v[:, i] for i in range(k, k + 3)]), (v, a[k : k + 3])):
                opti.subject_to(y[:, k + 2] == y[:, k] + h / 6 * (dy[0] + 4 * dy[1] + dy[2]))
                opti.subject_to(y[:, k + 1] == (y[:, k] + y[:, k + 2]) / 2 + h / 8 * (dy[0] - dy[2]))

    joined(q1, v1, a1, t1 / n, n)
    joined(q2, v2, a2, t2 / m, m)
    for k in range(0, 2 * n, 2):
        opti.subject_to(u1[:, k + 1] == (u1[:, k] + u1[:, k + 2]) / 2)
    opti.subject_to(q1[:, 0] == leg.start[2:4])
    opti.subject_to(v1[:, 0] == 0)
    end_q, end_v = whole(q1[:, -1], v1[:, -1])
    opti.subject_to(q2[:, 0] == end_q)
    opti.subject_to(v2[:, 0] == end_v)
    opti.subject_to(v2[1, -1] == 0)
    opti.subject_to(q2[1, -1] >= height_m)
    lower, upper = record["lower_stop_rad"], record["upper_stop_rad"]
    for j in range(2):  # no bumper beyond its travel
        travel = (robots.stops.hip, robots.stops.knee)[j].travel_rad
        opti.subject_to(opti.bounded(lower[j] - travel, q1[j, :], upper[j] + travel))
        opti.subject_to(opti.bounded(lower[j] - travel, q2[2 + j, :], upper[j] + travel))
    clear = [leg.foot_of(q2[:, k])[1] for k in range(1, 2 * m + 1)]
    opti.subject_to(ca.vertcat(*clear) >= float(leg.foot_of(leg.start)[1]))
    energy: Any = 0
    for k in range(0, 2 * n, 2):
        energy += 100.0 * t1 / n / 6 * ca.sum1(work[:, k] + 4 * work[:, k + 1] + work[:, k + 2])
    opti.minimize(energy + 1e-5 * ca.sumsqr(u1[:, 1:] - u1[:, :-1]))

    def along(rows: np.ndarray, count: int) -> np.ndarray:
        places = np.linspace(0, len(rows) - 1, count)
        return np.array([np.interp(places, np.arange(len(rows)), column) for column in rows.T])

    opti.set_initial(t1, left * step)
    opti.set_initial(t2, (len(seen) - 1 - left) * step)
    opti.set_initial(q1, along(seen[: left + 1, 2:4], 2 * n + 1))
    opti.set_initial(v1, along(seen[: left + 1, 6:8], 2 * n + 1))
    opti.set_initial(u1, along(seen[: left + 1, 12:14], 2 * n + 1))
    opti.set_initial(q2, along(seen[left:, :4], 2 * m + 1))
    opti.set_initial(v2, along(seen[left:, 4:8], 2 * m + 1))
    # "sb": no banner, which would stand within the table.
    quiet = {"print_level": 0, "sb": "yes"}
    opti.solver("ipopt", {"expand": True, "print_time": False}, quiet | {"max_iter": 3000, "tol": 1e-6})
    try:
        return float(opti.solve().value(energy))
    except RuntimeError:
        return float("inf")


def main() -> None:
    """Print the table of docs/limit.md."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--jumps", type=int, default=6000)
    given = parser.parse_args()
    known = load_calibration("ideal")
    assert isinstance(known.gate, FadeGate)
    # Collocation ends the torque as the foot leaves the floor; the gate's usual 10 mm save the search 1 to 2 percent.
    calibration = replace(known, gate=replace(known.gate, length_m=0.002))
    # Without the law over the leg's length, so that the least energy is that of torques over time, as IPOPT has them.
    limit._as_built = lambda _, over_time, *__: (None, over_time, None)
    print("| design | height, m | virtual leg, J | search, J | collocation, J | from the search's jump, J | apart |")
    print("|---|---|---|---|---|---|---|")
    for name, design in DESIGNS.items():
        found = limit.limit_of(design.as_array(), map_for("VT8020"), calibration, jumps=given.jumps, workers=2)
        height_m, energy_j = found.least.height_m, found.least.energy_j
        from_virtual = least_energy(design, calibration, height_m)
        reached = Design(**found.least.design)  # type: ignore[arg-type]  # knots have names of their own
        from_search = least_energy(reached, calibration.under(limit.LAW), height_m)
        apart = 100.0 * (energy_j / min(from_virtual, from_search) - 1.0)
        numbers = f"{found.energy_j:.2f} | {energy_j:.2f} | {from_virtual:.2f} | {from_search:.2f} | {apart:+.1f} %"
        print(f"| {name} | {height_m:.3f} | {numbers} |", flush=True)


if __name__ == "__main__":
    main()
