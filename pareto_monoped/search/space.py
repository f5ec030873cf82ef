"""Turn designs into search coordinates and back; vary those that choose a motor.

With ``gear_list``, a gear ratio is the position of a gearbox in a list; designs store the real ratio of that gearbox. A
choice between motors is a coordinate without order: children take their parents' choice, and mutations any other one.
Each motor has its own list of gearboxes; a ratio is then a share of it, from 0, the lowest, to 1, the highest, so that
a low ratio stays low when the motor changes. All other free variables are coordinates as they are.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from pymoo.core.problem import Problem
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM

from pareto_monoped.actuator.ratiomap import ActuatorMap, JointMaps, Maps, joint_maps
from pareto_monoped.definition.study import Study
from pareto_monoped.definition.variables import Bounds
from pareto_monoped.design import NAMES, RATIOS
from pareto_monoped.errors import StudyError
from pareto_monoped.search.algorithm import MOTOR_OF, Floats, Gear, MotorChoice, MotorKind, Space

Motors = Mapping[str, tuple[str, ...]]
"""Coordinate that chooses a motor -> name of each design's; empty where a study has no such choice."""


class Coordinates(ABC):
    """Base class of the coordinates of a study: ``KitCoordinates`` and ``MotorCoordinates``."""

    study: Study  #: the definition

    @property
    @abstractmethod
    def space(self) -> Space:
        """The space that an algorithm searches."""

    @abstractmethod
    def designs(self, values: Floats) -> Floats:
        """Return designs, shape (n, number of variables), for coordinates, shape (n, d)."""

    @abstractmethod
    def values(self, designs: Floats, motors: Motors | None = None) -> Floats:
        """Return coordinates, shape (n, d), for designs, shape (n, number of variables), and their motors."""

    @abstractmethod
    def motors_of(self, values: Floats) -> Motors:
        """Return the names of each design's motors for coordinates, shape (n, d)."""

    @abstractmethod
    def kits(self, motors: Motors) -> NDArray[np.intp] | None:
        """Return the positions of n designs' kits of motors in ``Study.kits``, shape (n,); None for the only kit."""

    @abstractmethod
    def limits(self, name: str) -> tuple[float, float]:
        """Return the least and the greatest value of a free variable in a stored design, whatever its motors."""

    def beginning(self, begin: Callable[[], Floats]) -> "Coordinates":
        """Return the same coordinates, of which a search begins with some designs; those of several motors do not."""
        return self

    def motor_limits(self, name: str) -> tuple[str, dict[str, tuple[float, float]]] | None:
        """Return the choice that decides a variable's gearboxes, and the ratios' ends with each motor; else None."""
        return None


@dataclass(frozen=True, slots=True, kw_only=True)
class KitCoordinates(Coordinates):
    """Free variables of a study with one kit of motors, and the gearboxes that they choose from."""

    study: Study
    fixed: Floats  #: a design with the fixed variables at their values, shape (number of variables,)
    #: for each free gear ratio that is searched as a list, its gearboxes by ascending real ratio
    gears: Mapping[str, tuple[Gear, ...]] = field(default_factory=dict)
    begin: Callable[[], Floats] | None = None  #: designs that a search begins with, as ``Space.begin``

    @property
    def space(self) -> Space:
        """The space that an algorithm searches; a list of n gearboxes has the bounds 0 and n - 1."""
        free, lower, upper = self._free, self.study.lower, self.study.upper
        for name, gears in self.gears.items():
            lower[NAMES.index(name)], upper[NAMES.index(name)] = 0.0, len(gears) - 1.0
        return Space(
            names=self.study.free,
            lower=lower[free],
            upper=upper[free],
            objectives=self.study.objectives,
            gears=self.gears,
            begin=None if self.begin is None else self._begun,
        )

    def designs(self, values: Floats) -> Floats:
        """Return designs, shape (n, number of variables), for coordinates, shape (n, d)."""
        designs = np.tile(self.fixed, (len(values), 1))
        designs[:, self._free] = values
        for name, ratios in self._ratios.items():
            column = designs[:, NAMES.index(name)]
            column[:] = ratios[column.astype(np.intp)]
        return designs

    def values(self, designs: Floats, motors: Motors | None = None) -> Floats:
        """Return coordinates, shape (n, d), for designs; a ratio means the nearest gearbox."""
        values = np.array(designs, dtype=np.float64)
        for name, ratios in self._ratios.items():
            column = values[:, NAMES.index(name)]
            column[:] = np.abs(column[:, None] - ratios).argmin(axis=1)
        return values[:, self._free]

    def motors_of(self, values: Floats) -> Motors:
        """Return nothing: there is no choice."""
        return {}

    def kits(self, motors: Motors) -> None:
        """Return None: all designs have the same kit."""

    def limits(self, name: str) -> tuple[float, float]:
        """Return the least and the greatest value of a free variable in a stored design."""
        if name in self.gears:
            return self.gears[name][0].ratio, self.gears[name][-1].ratio
        bounds = self.study.variables[name]
        assert isinstance(bounds, Bounds)
        return bounds.lower, bounds.upper

    def beginning(self, begin: Callable[[], Floats]) -> "KitCoordinates":
        """Return the same coordinates, of which a search begins with some designs."""
        return replace(self, begin=begin)

    def _begun(self) -> Floats:
        assert self.begin is not None
        points = self.values(self.begin())
        return np.clip(points, self.space.lower, self.space.upper)

    @property
    def _free(self) -> NDArray[np.bool_]:
        return np.array([name in self.study.free for name in self.study.names])

    @property
    def _ratios(self) -> dict[str, Floats]:
        return {name: np.array([gear.ratio for gear in gears]) for name, gears in self.gears.items()}


def coordinates_of(study: Study, maps: Maps) -> KitCoordinates:
    """Make the coordinates of a study with one motor, or with one for the hip and one for the knee.

    Raises:
        StudyError: no gearbox has a ratio within the bounds of a free gear ratio.
    """
    if not study.gear_list:
        return plain_coordinates(study)
    fixed, gears, both = study.lower, {}, joint_maps(maps)
    for name in RATIOS:
        value, actuator_map = study.variables[name], both.of(name.removesuffix("_ratio"))
        if isinstance(value, Bounds):
            gears[name] = gear_list(actuator_map, value)
            if not gears[name]:
                raise StudyError(
                    f"variables.{name} = {value.lower:g} to {value.upper:g}: {actuator_map.why_not(value.lower)}; "
                    "widen the bounds"
                )
        elif actuator_map.interval_index([value])[0] >= 0:
            fixed[NAMES.index(name)] = actuator_map.lookup(value).ratio
    return KitCoordinates(study=study, fixed=fixed, gears=gears)


def plain_coordinates(study: Study) -> KitCoordinates:
    """Make the coordinates of a study that searches ratios: every free variable within its bounds."""
    return KitCoordinates(study=study, fixed=study.lower)


def gear_list(actuator_map: ActuatorMap, bounds: Bounds) -> tuple[Gear, ...]:
    """List the gearboxes that ratios within the bounds, both included, lead to; by ascending real ratio.

    An interval of the map counts if the bounds touch it, so that 8.7 as the upper bound includes the gearbox of [8.7,
    8.8). Where all intervals within the bounds are empty, there is none.
    """
    lows = actuator_map.ratios_low
    within = lows[(lows > bounds.lower) & (lows < bounds.upper)]
    ratios = np.concatenate(([bounds.lower], within, [bounds.upper]))
    indices = actuator_map.interval_index(ratios)
    if all(actuator_map.stand_in(ratio) for ratio in ratios[indices >= 0]):
        return ()
    chosen = np.unique(indices)
    gears = []
    for index in chosen[chosen >= 0]:
        actuator = actuator_map.entries[index].actuator
        assert actuator is not None
        gears.append(
            Gear(
                ratio=actuator.ratio,
                mass_kg=actuator.mass_kg,
                efficiency=actuator.efficiency,
                reflected_inertia_kg_m2=actuator.reflected_inertia_kg_m2,
            )
        )
    return tuple(sorted(gears, key=lambda gear: gear.ratio))


@dataclass(frozen=True, kw_only=True)  # without slots: the cached property needs a place to keep its value
class MotorCoordinates(Coordinates):
    """Free variables and the motors that a study chooses from."""

    study: Study
    #: the gearboxes of each kit of motors: of each motor that both joints may have, or of each pair of hip and knee; in
    #: the order of ``Study.kits``
    maps: tuple[JointMaps, ...]
    parts: tuple[KitCoordinates, ...]  #: coordinates of the same study with each kit alone

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
        """Return designs, shape (n, number of variables), for coordinates, shape (n, d)."""
        space, kits = self.space, self.kits_of(values)
        positions = np.array(values[:, : len(space.names) - len(space.choices)])
        for name in space.listed:
            positions[:, space.names.index(name)] = space.gear_of(name, values)
        designs = np.empty((len(values), len(self.study.names)))
        for k in np.unique(kits).tolist():
            designs[kits == k] = self.parts[k].designs(positions[kits == k])
        return designs

    def kits_of(self, values: Floats) -> NDArray[np.intp]:
        """Return which of ``maps`` each design has, from coordinates, shape (n, d) -> (n,)."""
        picked = [self.space.picked(choice, values) for choice in self.space.choices]
        return np.ravel_multi_index(picked, [len(choice.motors) for choice in self.space.choices])

    def kits(self, motors: Motors) -> NDArray[np.intp]:
        """Return which of ``maps`` each design has, from the names of the motors of each choice."""
        picked = [np.array([names.index(one) for one in motors[name]], int) for name, names in self.choices.items()]
        return np.ravel_multi_index(picked, [len(names) for names in self.choices.values()])

    def motors_of(self, values: Floats) -> Motors:
        """Return the names of each design's motors for coordinates, shape (n, d)."""
        picked = {choice.name: self.space.picked(choice, values) for choice in self.space.choices}
        return {name: tuple(self.choices[name][k] for k in rows.tolist()) for name, rows in picked.items()}

    def values(self, designs: Floats, motors: Motors | None = None) -> Floats:
        """Return coordinates, shape (n, d), for designs, shape (n, number of variables), and their motors."""
        motors = motors or {}
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
        """Find which choice decides a variable's gearboxes, and their least and greatest ratio with each motor."""
        if name not in self.space.listed:
            return None
        choice = self.space.choice_for(name)
        ratios = {motor.name: [gear.ratio for gear in motor.gears[name]] for motor in choice.motors}
        return choice.name, {motor: (found[0], found[-1]) for motor, found in ratios.items()}

    def limits(self, name: str) -> tuple[float, float]:
        """Return the least and the greatest value of a free variable in a stored design, whatever its motors."""
        lows, highs = zip(*(part.limits(name) for part in self.parts), strict=True)
        return min(lows), max(highs)


def searched_coordinates(study: Study, maps: Sequence[Maps]) -> Coordinates:
    """Make the coordinates of a study, with the maps of each of its kits of motors (``Study.kits``)."""
    kits = tuple(map(joint_maps, maps))
    parts = tuple(coordinates_of(study, one) for one in kits)
    return parts[0] if len(parts) == 1 else MotorCoordinates(study=study, maps=kits, parts=parts)


def kit_maps(study: Study, maps: Sequence[ActuatorMap]) -> tuple[JointMaps, ...]:
    """Return the gearboxes of each kit of motors, from those of each of ``Study.motors``."""
    of = dict(zip(study.motors, maps, strict=True))
    return tuple(JointMaps(hip=of[hip], knee=of[knee]) for hip, knee in study.kits)


_EXCHANGED = 0.5
"""Probability that two children exchange their choices: uniform crossover (Syswerda 1989)."""


def exchanged(parents: Floats, generator: np.random.Generator) -> Floats:
    """Return the choices of two children for each pair of parents, shape (2, n) -> (2, n)."""
    swap = generator.random(parents.shape[1]) < _EXCHANGED
    return np.where(swap, parents[::-1], parents)


def mutated(choices: Floats, count: int, probability: float, generator: np.random.Generator) -> Floats:
    """Return choices from 0 to ``count`` - 1, shape (n,); with some probability each becomes one of the others."""
    changes = generator.random(len(choices)) < probability
    others = (choices + generator.integers(1, count, len(choices))) % count
    return np.where(changes, others, choices)


class MotorSBX(SBX):  # type: ignore[misc]  # pymoo has no types
    """Crosses numbers by simulated binary crossover, and exchanges motors."""

    def __init__(self, space: Space, **settings: float) -> None:
        super().__init__(**settings)
        self._places = space.choice_columns

    def _do(
        self, problem: Problem, X: Floats, *more: object, random_state: np.random.Generator, **settings: object
    ) -> Floats:
        children: Floats = super()._do(problem, X, *more, random_state=random_state, **settings)
        for place in self._places:
            children[:, :, place] = exchanged(X[:, :, place], random_state)
        return children


class MotorPM(PM):  # type: ignore[misc]  # pymoo has no types
    """Mutates numbers by polynomial mutation, and takes another motor with the same probability."""

    def __init__(self, space: Space, **settings: float) -> None:
        super().__init__(**settings)
        self._counts = dict(zip(space.choice_columns, (len(one.motors) for one in space.choices), strict=True))

    def _do(
        self, problem: Problem, X: Floats, *more: object, random_state: np.random.Generator, **settings: object
    ) -> Floats:
        varied: Floats = super()._do(problem, X, *more, random_state=random_state, **settings)
        for place, count in self._counts.items():
            before = X[:, place].astype(np.float64)
            varied[:, place] = mutated(before, count, 1.0 / X.shape[1], random_state)
        return varied
