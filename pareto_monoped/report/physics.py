"""What the report simulates or weighs again: the jumps of the front's designs, the paper's cases, gearboxes, masses."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import LOWER, NAMES, PAPER_CASES
from pareto_monoped.leg.dimensions import LegDimensions, leg_dimensions
from pareto_monoped.leg.shank import foot_part
from pareto_monoped.report.leg import leg_table
from pareto_monoped.report.records import ActuatorTable, Case, Gearbox, Jump, MapPoint, Number
from pareto_monoped.study.reader import StudyData

if TYPE_CHECKING:
    from pareto_monoped.actuator.actuator import Actuator
    from pareto_monoped.actuator.search import ActuatorMap
    from pareto_monoped.jump.calibration import Calibration

FRAMES = 56
"""Moments of a jump that the page keeps."""
MOST_JUMPS = 60
"""Designs of a front whose jump the page keeps, spread evenly over it if it has more."""
_HIGHEST_RATIO = 9.0  # of the map that is shown: beyond it the paper's motor has no gearbox and stage 2 does not look

SCALES: Mapping[str, float] = {
    "time_s": 1e-4,
    "base_x_m": 1e-4,
    "base_z_m": 1e-4,
    "foot_z_m": 1e-4,
    "hip_rad": 1e-4,
    "knee_rad": 1e-4,
    "hip_rad_per_s": 1e-2,
    "knee_rad_per_s": 1e-2,
    "hip_motor_torque_n_m": 1e-2,
    "knee_motor_torque_n_m": 1e-2,
    "contact_z_n": 1e-1,
}
"""Columns of a jump's trace that the page keeps, and the size of one count."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """A motor's gearboxes, and its map with their numbers."""

    gearboxes: list[Gearbox]
    map: ActuatorTable


@dataclass(frozen=True, slots=True, kw_only=True)
class Extras:
    """What one study needs beyond its database.

    Attributes:
        actuator_map, calibration: what it was simulated with.
        jumps: by trial number.
        cases: the paper's four designs.
        drift_m: largest difference between a stored height and that of the same design simulated now.
    """

    actuator_map: "ActuatorMap"
    calibration: "Calibration"
    jumps: Mapping[int, Jump]
    cases: Sequence[Case]
    drift_m: float

    @property
    def leg(self) -> LegDimensions:
        """Dimensions of the leg that was simulated: they follow from the study's motor."""
        return leg_dimensions(self.actuator_map)

    @property
    def foot_radius_m(self) -> float:
        """Of the foot that was simulated."""
        given = self.calibration.mass.foot_radius_m
        return 1e-3 * self.leg.foot_radius_mm if given is None else given

    def table(self, first: int) -> Table:
        """The stage 1 map, its gearboxes numbered from ``first``."""
        gearboxes: list[Gearbox] = []
        points = []
        for entry in self.actuator_map.entries:
            if entry.ratio_low > _HIGHEST_RATIO and entry.actuator is None:
                continue
            number = None
            if entry.actuator is not None:
                number = first + len(gearboxes)
                gearboxes.append(_gearbox(entry.actuator))
            best = {family: found.best.mass_kg for family, found in entry.families.items() if found.best is not None}
            reason = "" if entry.actuator is not None else entry.why_not()
            points.append(
                MapPoint(
                    ratio_low=entry.ratio_low,
                    gearbox=number,
                    reason=reason,
                    family_mass_kg={family: round(mass, 4) for family, mass in best.items()},
                )
            )
        motor = self.actuator_map.motor.name
        return Table(gearboxes=gearboxes, map=ActuatorTable(motor=motor, points=points, leg=leg_table(self.leg)))

    def gearboxes(self, ratios: NDArray[np.float64]) -> NDArray[np.intp]:
        """Numbers of the gearboxes of ratios, shape (n,), counted as in ``table`` from 0; -1 where there is none."""
        has = np.array([entry.actuator is not None for entry in self.actuator_map.entries])
        interval = self.actuator_map.interval_index(ratios)
        return np.where(interval >= 0, (np.cumsum(has) - 1)[interval], -1)

    def body_masses_kg(self, designs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Masses of base, thigh and shank of designs, shape (n, 7) -> (n, 3)."""
        from pareto_monoped.robot.population import robot_arrays

        if len(designs) == 0:
            return np.zeros((0, 3))
        return robot_arrays(designs, self.actuator_map, self.calibration.mass).body_mass_kg

    @property
    def foot_kg(self) -> float:
        """Mass of the foot that was simulated, a part of the shank's."""
        given = self.calibration.mass.foot_mass_kg
        return float(foot_part(float(LOWER[1]), self.leg).mass_kg()) if given is None else given


def simulate_extras(data: StudyData, *, most_jumps: int = MOST_JUMPS) -> Extras:
    """Simulate what the page shows of a study beyond its database."""
    from pareto_monoped.pareto.pick import Knee, pick

    actuator_map, calibration = data.actuator_map, data.calibration
    front = data.front()
    chosen = set(_spread(len(front), most_jumps))
    if len(front):
        knee = pick(front, Knee()).trial
        chosen.add(int(np.flatnonzero(front["trial"] == knee)[0]))
    rows = front.iloc[sorted(chosen)]
    jumps = jumps_of(rows[list(NAMES)].to_numpy(dtype=np.float64), actuator_map, calibration)
    return Extras(
        actuator_map=actuator_map,
        calibration=calibration,
        jumps=dict(zip(rows["trial"].astype(int).tolist(), jumps, strict=True)),
        cases=paper_cases(actuator_map, calibration),
        drift_m=max((abs(jump.height_m - h) for jump, h in zip(jumps, rows["height_m"], strict=True)), default=0.0),
    )


def _spread(n: int, most: int) -> list[int]:
    """Positions spread evenly over ``n``, both ends among them."""
    return sorted(set(np.linspace(0, n - 1, min(n, most)).round().astype(int).tolist())) if n else []


def jumps_of(designs: NDArray[np.float64], actuator_map: "ActuatorMap", calibration: "Calibration") -> list[Jump]:
    """The jumps of designs that can stand, shape (n, 7), in few frames each."""
    from pareto_monoped.jump.rows import take
    from pareto_monoped.jump.single import trace_of
    from pareto_monoped.robot.population import robot_arrays

    if len(designs) == 0:
        return []
    robots = robot_arrays(designs, actuator_map, calibration.mass)
    return [
        in_few_frames(trace_of(take(robots, np.array([i])), designs[i : i + 1, 4:7], calibration))
        for i in range(len(designs))
    ]


def in_few_frames(trace: Mapping[str, NDArray[np.float64]], frames: int = FRAMES) -> Jump:
    """A trace at ``frames`` moments, two thirds of them before lift-off, where everything happens.

    Args:
        trace: columns of ``jump.single.TRACE_COLUMNS``, shape (steps,).
        frames: how many.
    """
    time = trace["time_s"]
    touching = np.flatnonzero(trace["contact_z_n"] > 0.0)
    last = int(touching[-1]) if len(touching) else 0
    stance = 2 * frames // 3
    wanted = np.concatenate((np.linspace(0, last, stance), np.linspace(last, len(time) - 1, frames - stance + 1)[1:]))
    rows = np.unique(wanted.round().astype(int))
    columns = {
        name: np.round(np.nan_to_num(trace[name][rows]) / size).astype(int).tolist() for name, size in SCALES.items()
    }
    return Jump(
        height_m=float(trace["base_z_m"].max()),
        lift_off_s=float(time[last]),
        columns=columns,
        scale=SCALES,
    )


def paper_cases(actuator_map: "ActuatorMap", calibration: "Calibration") -> list[Case]:
    """The paper's four designs, simulated."""
    from pareto_monoped.jump.evaluate import Evaluator

    designs = np.array([case.design.as_array() for case in PAPER_CASES.values()])
    result = Evaluator(actuator_map, calibration)(designs)
    jumps = iter(jumps_of(designs[result.ok], actuator_map, calibration))

    def number(value: float) -> Number:
        return round(float(value), 4) if np.isfinite(value) else None

    return [
        Case(
            name=name,
            status=str(result.status[i]),
            reason=result.reason[i],
            height_m=number(result.height_m[i]),
            energy_j=number(result.energy_j[i]),
            mass_kg=number(result.mass_kg[i]),
            jump=next(jumps) if result.ok[i] else None,
        )
        for i, name in enumerate(PAPER_CASES)
    ]


def _gearbox(actuator: "Actuator") -> Gearbox:
    gears = actuator.gears
    body = actuator.motor.frameless if actuator.family == "ISSPG" else actuator.motor.framed
    return Gearbox(
        motor=actuator.motor.name,
        family=actuator.family,
        ratio=round(actuator.ratio, 4),
        sun_teeth=int(gears.sun_teeth),
        planet_teeth=int(gears.planet_teeth),
        ring_teeth=int(gears.ring_teeth),
        module_mm=float(gears.module_mm),
        planets=int(gears.planets),
        face_width_mm=round(actuator.face_width_mm, 2),
        mass_kg=round(actuator.mass_kg, 4),
        peak_torque_n_m=round(actuator.peak_torque_n_m, 2),
        no_load_speed_rad_per_s=round(actuator.no_load_speed_rad_per_s, 1),
        efficiency=round(actuator.efficiency, 4),
        motor_diameter_mm=body.outer_diameter_mm if body is not None else 0.0,
    )
