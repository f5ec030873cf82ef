"""Search coordinates of a study that chooses from several motors: one more coordinate per choice, without an order.

A study chooses the motor of both joints, or that of the hip and that of the knee. Each motor has its own list of
gearboxes, of its own length. A free gear ratio is therefore a share of the list of its joint's motor, from 0, its
lowest ratio, to 1, its highest: when the motor changes, a low ratio stays a low one.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.joint_maps import JointMaps, Maps, joint_maps
from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.design import NAMES
from pareto_monoped.study.coordinates import Coordinates, coordinates_of
from pareto_monoped.study.definition import Study
from pareto_monoped.study.protocol import MOTOR_OF, Floats, MotorChoice, MotorKind, Space


@dataclass(frozen=True, kw_only=True)  # without slots: the cached property needs a place to keep its value
class MotorCoordinates:
    """Free variables and the motors that a study chooses from.

    Attributes:
        study: the definition.
        maps: the gearboxes of each kit of motors: of each motor that both joints may have, or of each pair of hip and
            knee; in the order of ``Study.kits``.
        parts: coordinates of the same study with each kit alone.
    """

    study: Study
    maps: tuple[JointMaps, ...]
    parts: tuple[Coordinates, ...]

    @cached_property
    def choices(self) -> Mapping[str, tuple[str, ...]]:
        """Coordinate that chooses a motor -> names of the motors, in the order of the study."""
        found = {}
        for name in self.study.motor_choices:
            joint = MOTOR_OF[name][0]
            found[name] = tuple(dict.fromkeys(one.of(joint).motor.name for one in self.maps))
        return found

    @cached_property
    def space(self) -> Space:
        """The space that an algorithm searches."""
        choices = tuple(self._choice(name) for name in self.choices)
        listed = {gear for choice in choices for gear in choice.motors[0].gears}
        plain, lists = self.parts[0].space, self.parts[0].gears
        lower = [0.0 if name in listed else low for name, low in zip(plain.names, plain.lower, strict=True)]
        upper = [1.0 if name in listed else high for name, high in zip(plain.names, plain.upper, strict=True)]
        return Space(
            names=(*plain.names, *self.choices),
            lower=np.array([*lower, *(0.0 for _ in choices)]),
            upper=np.array([*upper, *(len(choice.motors) - 1.0 for choice in choices)]),
            objectives=plain.objectives,
            gears={name: gears for name, gears in lists.items() if name not in listed},
            choices=choices,
        )

    def _choice(self, name: str) -> MotorChoice:
        joints, kinds = MOTOR_OF[name], {}
        for one, part in zip(self.maps, self.parts, strict=True):
            motor = one.of(joints[0]).motor
            gears = {ratio: part.gears[ratio] for ratio in part.gears if ratio.removesuffix("_ratio") in joints}
            kinds[motor.name] = MotorKind(
                name=motor.name,
                peak_torque_n_m=motor.peak_torque_n_m,
                no_load_speed_rad_per_s=motor.no_load_speed_rad_per_s,
                gears=gears,
            )
        return MotorChoice(name=name, motors=tuple(kinds[motor] for motor in self.choices[name]))

    def designs(self, values: Floats) -> Floats:
        """Designs, shape (n, number of variables), from coordinates, shape (n, d)."""
        space, kits = self.space, self.kits_of(values)
        positions = np.array(values[:, : len(space.names) - len(space.choices)])
        for name in space.listed:
            positions[:, space.names.index(name)] = space.gear_of(name, values)
        designs = np.empty((len(values), len(NAMES)))
        for k in np.unique(kits).tolist():
            designs[kits == k] = self.parts[k].designs(positions[kits == k])
        return designs

    def kits_of(self, values: Floats) -> NDArray[np.intp]:
        """Which of ``maps`` each design has, from coordinates, shape (n, d) -> (n,)."""
        picked = [self.space.picked(choice, values) for choice in self.space.choices]
        return np.ravel_multi_index(picked, [len(choice.motors) for choice in self.space.choices])

    def kits(self, motors: Mapping[str, Sequence[str]]) -> NDArray[np.intp]:
        """Which of ``maps`` each design has, from the names of the motors of each choice."""
        picked = [np.array([names.index(one) for one in motors[name]], int) for name, names in self.choices.items()]
        return np.ravel_multi_index(picked, [len(names) for names in self.choices.values()])

    def motors_of(self, values: Floats) -> dict[str, tuple[str, ...]]:
        """Names of each design's motors, of each choice, from coordinates, shape (n, d)."""
        picked = {choice.name: self.space.picked(choice, values) for choice in self.space.choices}
        return {name: tuple(self.choices[name][k] for k in rows.tolist()) for name, rows in picked.items()}

    def values(self, designs: Floats, motors: Mapping[str, Sequence[str]]) -> Floats:
        """Coordinates, shape (n, d), of designs, shape (n, number of variables), and the names of their motors."""
        space, chosen = self.space, self.kits(motors)
        values = np.empty((len(designs), len(space.names)))
        for place, (name, names) in zip(space.choice_columns, self.choices.items(), strict=True):
            values[:, place] = [names.index(one) for one in motors[name]]
        first_choice = len(space.names) - len(space.choices)
        for k in np.unique(chosen).tolist():
            rows, part = chosen == k, self.parts[k]
            values[rows, :first_choice] = part.values(designs[rows])
            for name in space.listed:
                values[rows, space.names.index(name)] /= max(len(part.gears[name]) - 1, 1)
        return values

    def motor_limits(self, name: str) -> tuple[str, dict[str, tuple[float, float]]] | None:
        """Which choice decides the gearboxes of a variable, and their least and greatest ratio with each motor.

        None for a variable whose limits are the same with every motor.
        """
        if name not in self.space.listed:
            return None
        choice = self.space.choice_for(name)
        ratios = {motor.name: [gear.ratio for gear in motor.gears[name]] for motor in choice.motors}
        return choice.name, {motor: (found[0], found[-1]) for motor, found in ratios.items()}

    def limits(self, name: str) -> tuple[float, float]:
        """Least and greatest value of a free variable in a stored design, whatever its motors."""
        lows, highs = zip(*(part.limits(name) for part in self.parts), strict=True)
        return min(lows), max(highs)


AnyCoordinates = Coordinates | MotorCoordinates
"""Coordinates of a study with one kit of motors or with several."""


def searched_coordinates(study: Study, maps: Sequence[Maps]) -> AnyCoordinates:
    """The coordinates of a study, with the maps of each of its kits of motors (``Study.kits``).

    Raises:
        StudyError: a motor has no gearbox with a ratio within the bounds of a free gear ratio.
    """
    kits = tuple(map(joint_maps, maps))
    parts = tuple(coordinates_of(study, one) for one in kits)
    return parts[0] if len(parts) == 1 else MotorCoordinates(study=study, maps=kits, parts=parts)


def kit_maps(study: Study, maps: Sequence[ActuatorMap]) -> tuple[JointMaps, ...]:
    """The gearboxes of each kit of motors.

    Args:
        study: the definition.
        maps: of each of ``Study.motors``.
    """
    of = dict(zip(study.motors, maps, strict=True))
    return tuple(JointMaps(hip=of[hip], knee=of[knee]) for hip, knee in study.kits)
