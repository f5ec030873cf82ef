"""Two engines behind one interface: a population at rest, which MuJoCo or the compiled leg lets jump."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import KNOT_NAMES, MOST_KNOTS, Floats
from pareto_monoped.jump.calibration import Calibration, SpringContact
from pareto_monoped.jump.controller_record import KNEE, OBSERVED
from pareto_monoped.jump.laws import Profile
from pareto_monoped.jump.model import StartPose, joint_friction_n_m, start_pose, start_qpos
from pareto_monoped.jump.population import Records, first_records, prepare, states
from pareto_monoped.jump.variations import Variations, vary_records
from pareto_monoped.robot.population import RobotArrays


class Jumping(Protocol):
    """The jumps of n robots in progress."""

    records: Records  #: the controller's record of each, shape (n,) of ``RECORD``

    def run(self) -> None:
        """Make all jumps to their end."""

    def observed(self) -> list[Floats]:
        """Make all jumps to their end, and return ``OBSERVED`` of each, n arrays of shape (steps, 16)."""

    def go_on(self, records: Records, calibration: Calibration) -> None:
        """Put all robots into the states in other records, with which they go on."""

    def complaints(self) -> list[str]:
        """Return what the engine found wrong in each jump; empty where nothing was."""


def population_of(
    robots: RobotArrays,
    control: Floats,
    pose: StartPose,
    calibration: Calibration,
    threads: int = 1,
    variations: Variations | None = None,
) -> Jumping:
    """Return n robots that can stand, at rest, for the engine of the calibration; see ``population.prepare``."""
    if calibration.simulation.engine == "mujoco":
        return prepare(robots, control, pose, calibration, threads, variations)
    return _planar(robots, control, pose, calibration, threads, variations)


@dataclass(slots=True, kw_only=True)
class PlanarPopulation:
    """The jumps of n robots by the engine ``compiled``."""

    records: Records
    grounds: NDArray[np.void]  #: shape (n,) of ``planar.GROUND``
    start: Floats  #: positions at rest, shape (n, nv)
    controls: int  #: torques that the controller sets
    threads: int

    def run(self) -> None:
        """Make all jumps to their end; a jump beyond all bounds ends as diverged."""
        self._run(np.empty((len(self.records), 0, sum(OBSERVED.values()))))

    def observed(self) -> list[Floats]:
        """Make all jumps to their end, and return ``OBSERVED`` of each, n arrays of shape (steps, 16)."""
        # Memory that no step is written to costs nothing.
        room = int(self.records["step_limit"].max(initial=0.0)) + 1
        seen = np.empty((len(self.records), room, sum(OBSERVED.values())))
        self._run(seen)
        return [one[:steps] for one, steps in zip(seen, self.records["steps"].astype(int), strict=True)]

    def go_on(self, records: Records, calibration: Calibration) -> None:
        """Put all robots into the states in other records, with which they go on."""
        self.records, (self.start, _) = records, states(records, calibration)

    def _run(self, seen: Floats) -> None:
        from pareto_monoped.jump.planar import stepper

        jumps, n = stepper(), len(self.records)
        cuts = np.linspace(0, n, min(self.threads, max(n, 1)) + 1).astype(int).tolist()
        parts = [slice(first, last) for first, last in pairwise(cuts)]

        def of_part(rows: slice) -> None:
            jumps(self.records[rows], self.grounds[rows], self.start[rows], self.controls, seen[rows])

        if len(parts) == 1:
            of_part(parts[0])
            return
        with ThreadPoolExecutor(len(parts)) as pool:
            list(pool.map(of_part, parts))

    def complaints(self) -> list[str]:
        """Return nothing: what is wrong with a jump of this engine is its status."""
        return [""] * len(self.records)


def told_profiles(
    robots: RobotArrays, control: Floats, calibration: Calibration, law: Profile, *, most: float = 1.0
) -> Floats:
    """Return profiles nearest to what the calibration's law tells the motors of n robots that can stand, shape (n, 25).

    The columns have the order of ``KNOT_NAMES``. Knots are those of the least squares of torques from the start to
    lift-off, each taken back by the delay, and at most ``most``; the push time ends there, too.
    """
    population = population_of(robots, control, start_pose(robots, calibration), calibration)
    found = np.zeros((len(robots), len(KNOT_NAMES)))
    late = round(calibration.simulation.delay_s / calibration.simulation.timestep_s)
    for row, seen in enumerate(population.observed()):
        record = population.records[row]
        end = max(int(record["lift_off_step"]) - 1, late + 2)
        told = seen[late:end, 12:14] / record["torque_limit_n_m"]
        time_s = np.arange(len(told), dtype=np.float64) * calibration.simulation.timestep_s
        directions = seen[: len(told), 8:12] * np.repeat([record["thigh_length_m"], record["shank_length_m"]], 2)
        leg_m = np.hypot(directions[:, 0] + directions[:, 2], directions[:, 1] + directions[:, 3])
        lever_m = (directions[:, 3] * directions[:, 0] - directions[:, 2] * directions[:, 1]) / leg_m
        told[:, KNEE] -= law.beside_knots(record, time_s, leg_m, lever_m) / record["torque_limit_n_m"][KNEE]
        straight_m = float(record["thigh_length_m"] + record["shank_length_m"])
        basis = law.basis(law.shares(time_s, np.asarray(leg_m), straight_m))
        knots = np.clip(np.linalg.lstsq(basis, told, rcond=None)[0], -most, most)
        found[row, 0] = time_s[-1]
        for joint in range(2):
            first = 1 + joint * MOST_KNOTS
            found[row, first : first + law.knots] = knots[:, joint]
    return found


def _planar(
    robots: RobotArrays,
    control: Floats,
    pose: StartPose,
    calibration: Calibration,
    threads: int,
    variations: Variations | None,
) -> PlanarPopulation:
    from pareto_monoped.jump.planar import FLOOR, GROUND

    assert isinstance(calibration.contact, SpringContact)
    records = first_records(robots, control, calibration)
    grounds = np.zeros(len(robots), dtype=GROUND)
    for name in FLOOR:
        grounds[name] = getattr(calibration.contact, name)
    grounds["joint_friction_n_m"] = joint_friction_n_m(robots, calibration.joints)
    if variations is not None:
        vary_records(records, robots.stops, calibration, variations)
        grounds["stiffness_n_per_m"] *= variations.foot_stiffness
        grounds["joint_friction_n_m"] *= variations.friction[:, None]
    return PlanarPopulation(
        records=records,
        grounds=grounds,
        start=start_qpos(robots, calibration, pose),
        controls=4 if calibration.joints.stop_law == "hunt_crossley" else 2,
        threads=threads,
    )
