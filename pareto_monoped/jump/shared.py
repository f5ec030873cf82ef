"""Both sides of jumps that an executor shares out: the evaluator that asks and the function that answers.

What decides jumps travels as JSON text, as studies store it. A worker reads it once, builds the maps and keeps them.
"""

import json
from collections.abc import Sequence
from concurrent.futures import Executor
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pareto_monoped.actuator.motors import motor_values, stored_motor
from pareto_monoped.actuator.ratiomap import JointMaps, Maps, joint_maps
from pareto_monoped.actuator.search import map_of
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.compute.chunks import Pace, pace_of, spread, task_threads
from pareto_monoped.design import Floats, complete
from pareto_monoped.errors import InputError
from pareto_monoped.jump.calibration import Calibration, calibration_of, calibration_values
from pareto_monoped.jump.evaluate import Evaluations, Evaluator
from pareto_monoped.jump.variations import Variations, joined, take

Setup = tuple[tuple[JointMaps, ...], Calibration]  #: Gearboxes of every kit of motors, and the jump model.
_SOURCE = "a task's setup"


def setup_text(maps: Sequence[Maps], calibration: Calibration) -> str:
    """Return everything that decides jumps as JSON text, which ``built`` reads back.

    Raises:
        InputError: a map that was built with settings of its own, which no worker knows.
    """
    kits = [joint_maps(each) for each in maps]
    for kit in kits:
        if any(each.settings != ActuatorSettings(rules=each.settings.rules) for each in (kit.hip, kit.knee)):
            raise InputError(
                f"actuator map of {kit.label}: was built with settings of its own, an executor takes maps with the "
                "default ones; evaluate without an executor"
            )
    motors = {id(each): each for kit in kits for each in (kit.hip, kit.knee)}
    places = {key: place for place, key in enumerate(motors)}
    return json.dumps(
        {
            "motors": [[motor_values(each.motor), each.settings.rules] for each in motors.values()],
            "kits": [[places[id(kit.hip)], places[id(kit.knee)]] for kit in kits],
            "calibration": calibration_values(calibration),
        },
        sort_keys=True,
    )


@lru_cache(maxsize=16)
def built(text: str) -> Setup:
    """Return the setup in a text of ``setup_text``; kept for the next task."""
    values = json.loads(text)
    maps = [map_of(stored_motor(motor, source=_SOURCE), rules) for motor, rules in values["motors"]]
    kits = tuple(JointMaps(hip=maps[hip], knee=maps[knee]) for hip, knee in values["kits"])
    return kits, calibration_of(values["calibration"], source=_SOURCE)


def jumps_of(text: str, designs: Floats, motors: NDArray[np.intp], variations: Variations | None) -> Evaluations:
    """Let designs jump in a worker, see ``Evaluator``."""
    (first, *others), calibration = built(text)
    return Evaluator(first, calibration, task_threads(), others=others)(designs, motors, variations=variations)


class SharedEvaluator(Evaluator):
    """An ``Evaluator`` whose jumps an executor shares out at its pace. The results are the same to the last bit."""

    def __init__(
        self,
        actuator_map: Maps,
        calibration: Calibration,
        workers: int = 1,
        *,
        others: Sequence[Maps] = (),
        executor: Executor,
        pace: Pace | None = None,
    ) -> None:
        super().__init__(actuator_map, calibration, workers, others=others)
        self.executor = executor
        self._text = setup_text(self.actuator_maps, calibration)
        self.pace = pace or pace_of(executor, jumps_of, self._text)

    def __call__(
        self, designs: ArrayLike, motors: ArrayLike | None = None, *, variations: Variations | None = None
    ) -> Evaluations:
        """Jump with each design, see ``Evaluator``."""
        values = np.atleast_2d(complete(designs))
        if len(values) == 0:
            return super().__call__(values, motors, variations=variations)
        chosen = np.zeros(len(values), dtype=np.intp) if motors is None else np.asarray(motors, dtype=np.intp)

        def of_rows(rows: slice) -> tuple[str, Floats, NDArray[np.intp], Variations | None]:
            own = None if variations is None else take(variations, np.arange(rows.start, rows.stop))
            return self._text, values[rows], chosen[rows], own

        assert self.executor is not None
        return joined(spread(self.executor, self.pace, len(values), jumps_of, of_rows))


def evaluator_of(
    actuator_map: Maps,
    calibration: Calibration,
    workers: int = 1,
    *,
    others: Sequence[Maps] = (),
    executor: Executor | None = None,
) -> Evaluator:
    """Return an evaluator on this process's threads, or on an executor if there is one; ``workers`` are the threads."""
    if executor is None:
        return Evaluator(actuator_map, calibration, workers, others=others)
    return SharedEvaluator(actuator_map, calibration, workers, others=others, executor=executor)
