"""Search coordinates of a study that chooses from several motors: one more coordinate, which has no order.

Each motor has its own list of gearboxes, of its own length. A free gear ratio is therefore a share of the list of the
design's motor, from 0, its lowest ratio, to 1, its highest: when the motor changes, a low ratio stays a low one.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.design import NAMES
from pareto_monoped.study.coordinates import Coordinates, coordinates_of
from pareto_monoped.study.definition import Study
from pareto_monoped.study.protocol import MOTOR, Floats, MotorKind, Space


@dataclass(frozen=True, kw_only=True)  # without slots: the cached property needs a place to keep its value
class MotorCoordinates:
    """Free variables and the motors that a study chooses from.

    Attributes:
        study: the definition.
        maps: the gearboxes of each motor.
        parts: coordinates of the same study with each motor alone.
    """

    study: Study
    maps: tuple[ActuatorMap, ...]
    parts: tuple[Coordinates, ...]

    @property
    def motors(self) -> tuple[str, ...]:
        """The motors' names, in the order of the study."""
        return tuple(one.motor.name for one in self.maps)

    @cached_property
    def space(self) -> Space:
        """The space that an algorithm searches."""
        plain, lists = self.parts[0].space, self.parts[0].gears
        lower = [0.0 if name in lists else low for name, low in zip(plain.names, plain.lower, strict=True)]
        upper = [1.0 if name in lists else high for name, high in zip(plain.names, plain.upper, strict=True)]
        kinds = [
            MotorKind(
                name=one.motor.name,
                peak_torque_n_m=one.motor.peak_torque_n_m,
                no_load_speed_rad_per_s=one.motor.no_load_speed_rad_per_s,
                gears=part.gears,
            )
            for one, part in zip(self.maps, self.parts, strict=True)
        ]
        return Space(
            names=(*plain.names, MOTOR),
            lower=np.array([*lower, 0.0]),
            upper=np.array([*upper, len(kinds) - 1.0]),
            objectives=plain.objectives,
            motors=tuple(kinds),
        )

    def designs(self, values: Floats) -> Floats:
        """Designs, shape (n, number of variables), from coordinates, shape (n, d)."""
        space, motors = self.space, self.motors_of(values)
        positions = np.array(values[:, :-1])
        for name in space.listed:
            positions[:, space.names.index(name)] = space.gear_of(name, values)
        designs = np.empty((len(values), len(NAMES)))
        for k, part in enumerate(self.parts):
            designs[motors == k] = part.designs(positions[motors == k])
        return designs

    def motors_of(self, values: Floats) -> NDArray[np.intp]:
        """Which of ``motors`` each design has, from coordinates, shape (n, d) -> (n,)."""
        return self.space.motor_of(values)

    def values(self, designs: Floats, motors: Sequence[str]) -> Floats:
        """Coordinates, shape (n, d), of designs, shape (n, number of variables), and the names of their motors."""
        chosen = np.array([self.motors.index(name) for name in motors], dtype=np.intp)
        values = np.empty((len(designs), len(self.space.names)))
        values[:, -1] = chosen
        for k, part in enumerate(self.parts):
            rows = chosen == k
            values[rows, :-1] = part.values(designs[rows])
            for name, gears in part.gears.items():
                values[rows, self.space.names.index(name)] /= max(len(gears) - 1, 1)
        return values

    def limits(self, name: str) -> tuple[float, float]:
        """Least and greatest value of a free variable in a stored design, whatever its motor."""
        lows, highs = zip(*(part.limits(name) for part in self.parts), strict=True)
        return min(lows), max(highs)


AnyCoordinates = Coordinates | MotorCoordinates
"""Coordinates of a study with one motor or with several."""


def searched_coordinates(study: Study, maps: Sequence[ActuatorMap]) -> AnyCoordinates:
    """The coordinates of a study, with the map of each of its motors.

    Raises:
        StudyError: a motor has no gearbox with a ratio within the bounds of a free gear ratio.
    """
    parts = tuple(coordinates_of(study, one) for one in maps)
    return parts[0] if len(parts) == 1 else MotorCoordinates(study=study, maps=tuple(maps), parts=parts)
