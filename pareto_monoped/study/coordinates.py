"""Search coordinates: what an algorithm sees of a design, and the way back.

A gear ratio only selects a gearbox, so a study with ``gear_list`` searches the list of gearboxes by position and stores
the real ratio of the chosen one. All other free variables are coordinates as they are.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.joint_maps import Maps, joint_maps
from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.design import NAMES, RATIOS
from pareto_monoped.errors import StudyError
from pareto_monoped.study.definition import Study
from pareto_monoped.study.free_variables import Bounds
from pareto_monoped.study.protocol import Floats, Gear, Space


@dataclass(frozen=True, slots=True, kw_only=True)
class Coordinates:
    """Free variables of a study and the gearboxes that they choose from.

    Attributes:
        study: the definition.
        fixed: a design with the fixed variables at their values, shape (number of variables,).
        gears: for each free gear ratio that is searched as a list, its gearboxes by ascending real ratio.
    """

    study: Study
    fixed: Floats
    gears: Mapping[str, tuple[Gear, ...]] = field(default_factory=dict)

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
        )

    def designs(self, values: Floats) -> Floats:
        """Designs, shape (n, number of variables), from coordinates, shape (n, d)."""
        designs = np.tile(self.fixed, (len(values), 1))
        designs[:, self._free] = values
        for name, ratios in self._ratios.items():
            column = designs[:, NAMES.index(name)]
            column[:] = ratios[column.astype(np.intp)]
        return designs

    def values(self, designs: Floats) -> Floats:
        """Coordinates, shape (n, d), of designs, shape (n, number of variables); a ratio means the nearest gearbox."""
        values = np.array(designs, dtype=np.float64)
        for name, ratios in self._ratios.items():
            column = values[:, NAMES.index(name)]
            column[:] = np.abs(column[:, None] - ratios).argmin(axis=1)
        return values[:, self._free]

    def limits(self, name: str) -> tuple[float, float]:
        """Least and greatest value of a free variable in a stored design."""
        if name in self.gears:
            return self.gears[name][0].ratio, self.gears[name][-1].ratio
        bounds = self.study.variables[name]
        assert isinstance(bounds, Bounds)
        return bounds.lower, bounds.upper

    @property
    def _free(self) -> NDArray[np.bool_]:
        return np.array([name in self.study.free for name in NAMES])

    @property
    def _ratios(self) -> dict[str, Floats]:
        return {name: np.array([gear.ratio for gear in gears]) for name, gears in self.gears.items()}


def coordinates_of(study: Study, maps: Maps) -> Coordinates:
    """The coordinates of a study with its motor, or with one of hip and one of knee.

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
    return Coordinates(study=study, fixed=fixed, gears=gears)


def plain_coordinates(study: Study) -> Coordinates:
    """Coordinates of a study that searches ratios: every free variable within its bounds."""
    return Coordinates(study=study, fixed=study.lower)


def gear_list(actuator_map: ActuatorMap, bounds: Bounds) -> tuple[Gear, ...]:
    """The gearboxes that ratios within the bounds, both included, lead to; by ascending real ratio.

    An interval of the map counts if the bounds touch it, so that 8.7 as the upper bound includes the gearbox of
    [8.7, 8.8), whose real ratio may be a little more. Where all intervals within the bounds are empty, there is none:
    a gearbox from outside does not stand in for all of them.
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
        gears.append(_gear(actuator))
    return tuple(sorted(gears, key=lambda gear: gear.ratio))


def _gear(actuator: Actuator) -> Gear:
    return Gear(ratio=actuator.ratio, mass_kg=actuator.mass_kg)
