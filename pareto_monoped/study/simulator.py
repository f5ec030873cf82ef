"""What a study simulates with, from the names in its study file or from what its database holds."""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from pareto_monoped.actuator.motor import Motor
from pareto_monoped.actuator.motors import load_motor, motor_source, motor_values
from pareto_monoped.actuator.search import map_of
from pareto_monoped.definition.algorithms import DEFAULT_ALGORITHM
from pareto_monoped.definition.study import Study
from pareto_monoped.definition.variables import Bounds
from pareto_monoped.design import (
    ALL_DEFAULTS,
    LOWER,
    NAMES,
    PAPER_CASES,
    PAPER_CONTROL,
    UPPER,
    VARIABLES,
    Floats,
    complete,
    control_of,
)
from pareto_monoped.errors import CalibrationError, StudyError, complaint
from pareto_monoped.jump.audit import MedianEvaluator
from pareto_monoped.jump.calibration import Calibration, calibration_values, load_calibration
from pareto_monoped.jump.calibration_defaults import OWN_CALIBRATION
from pareto_monoped.jump.engines import told_profiles
from pareto_monoped.jump.evaluate import Evaluations, Evaluator
from pareto_monoped.jump.laws import OF_VIRTUAL_LEG, PAPER_LAW, Profile
from pareto_monoped.jump.shared import evaluator_of
from pareto_monoped.leg.thigh_outline import require_leg
from pareto_monoped.pareto.front import front_mask
from pareto_monoped.robot.population import robot_arrays
from pareto_monoped.search.registry import make_algorithm
from pareto_monoped.search.scoring import judge, scores
from pareto_monoped.search.space import Coordinates, kit_maps, searched_coordinates
from pareto_monoped.storage.meta import motor_keys
from pareto_monoped.storage.reader import StudyData
from pareto_monoped.uncertainty.samples import RobustEvaluator

Evaluate = Callable[..., Evaluations]
"""Designs, see ``design.complete``, and the positions of their kits of motors, None for the only one, to their
evaluations, in order."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Simulator:
    """What a study simulates with."""

    #: motors, calibration: what decides every jump
    motors: tuple[Motor, ...]
    calibration: Calibration
    evaluator: Evaluator  #: designs to evaluations, with the motors' actuator maps and the calibration
    #: Texts of the motors' and the ``calibration`` file where the study names files of the user's, else None
    files: dict[str, str | None]

    @property
    def contents(self) -> dict[str, dict[str, Any]]:
        """Every value of the motors and of ``calibration``, as JSON values."""
        motors = zip(motor_keys(len(self.motors)), map(motor_values, self.motors), strict=True)
        return {**dict(motors), "calibration": calibration_values(self.calibration)}

    def coordinates(self, study: Study) -> Coordinates:
        """Return what an algorithm searches in ``study``: lists of these motors' gearboxes where the study has them."""
        found = searched_coordinates(study, self.evaluator.actuator_maps)
        if study.controller == PAPER_LAW:
            return found
        return found.beginning(partial(_begun, study, self.evaluator))

    def probe(self) -> list[list[float | None]]:
        """Return height and energy of the paper's four designs and four fixed ones, with each kit of motors.

        Code, compiler, library versions and processor all show in their last digits.
        """
        paper = np.array([case.design.as_array() for case in PAPER_CASES.values()])
        drawn = np.random.default_rng(20250101).uniform(LOWER, UPPER, size=(4, len(LOWER)))
        eight, count = np.vstack((paper, complete(drawn))), len(self.evaluator.actuator_maps)
        result = self.evaluator(np.tile(eight, (count, 1)), np.repeat(np.arange(count), len(eight)))
        pairs = np.column_stack((result.height_m, result.energy_j))
        return [[value if np.isfinite(value) else None for value in row] for row in pairs.tolist()]


_BEFORE, _BEGUN = 800, 40
"""Jumps under the virtual leg before a study with another law begins, and designs that it begins with. Our own choice:
a fifth of the main job's jumps, and a generation."""


def _begun(study: Study, evaluator: Evaluator) -> Floats:
    """Return designs that begin with the torques which the virtual leg tells the motors, best first.

    They are those of a short search of the same study under the virtual leg, whose trials are not stored: its front,
    evenly spread, then what violates its limits least.
    """
    assert isinstance(study.controller, Profile)
    kept = {name: value for name, value in study.variables.items() if name in NAMES}
    gains = {v.name: Bounds(lower=v.lower, upper=v.upper) for v in VARIABLES if v.name in PAPER_CONTROL}
    first = replace(study, controller=PAPER_LAW, algorithm=DEFAULT_ALGORITHM, variables=kept | gains)
    maps, model = evaluator.actuator_maps[0], evaluator.calibration.under(PAPER_LAW)
    virtual, where = Evaluator(maps, model, evaluator.workers), searched_coordinates(first, [maps])
    algorithm, found = make_algorithm(first, where), np.zeros((0, len(NAMES) + 1 + len(first.objectives.names)))
    while len(found) < _BEFORE and (proposal := algorithm.ask()) is not None:
        designs = where.designs(proposal.values)
        jumps = virtual(designs)
        judged = scores(jumps, judge(jumps, first.constraints, first.objectives), first.objectives)
        algorithm.tell(judged)
        found = np.vstack((found, np.column_stack((designs, judged.violation, judged.values))[jumps.ok]))
    violation, values = found[:, len(NAMES)], found[:, len(NAMES) + 1 :]
    front = np.flatnonzero(front_mask(values, first.objectives, violation == 0.0))
    front = front[np.argsort(values[front, 0], kind="stable")]
    spread = front[np.unique(np.linspace(0, len(front) - 1, min(_BEGUN, len(front))).astype(int))]
    others = np.setdiff1d(np.argsort(violation, kind="stable")[: 2 * _BEGUN], front)
    rows = np.concatenate((spread, others))[:_BEGUN].astype(int)
    designs = found[rows, : len(NAMES)]
    robots = robot_arrays(designs, maps, model.mass)
    profiles = told_profiles(robots, control_of(designs), model, study.controller)
    own = [variable.name for variable in study.controller.variables]
    for name in OF_VIRTUAL_LEG:
        if name not in own:
            designs[:, NAMES.index(name)] = ALL_DEFAULTS.get(name, 0.0)
    return np.hstack((designs, profiles))


def evaluation_of(study: Study, evaluator: Evaluator) -> Evaluate:
    """Return what evaluates the trials of a study: jumps as designed or medians of copies, and as built if it asks."""
    if study.copies > 1:
        return MedianEvaluator(evaluator=evaluator, copies=study.copies)
    if study.uncertainty is None or not study.robust_names:
        return evaluator
    return RobustEvaluator(
        evaluator=evaluator, sampling=study.uncertainty, names=study.robust_names, least=study.least_safeties
    )


def load_simulator(
    study: Study, *, workers: int, executor: Executor | None = None, calibration: Calibration | None = None
) -> Simulator:
    """Make the simulator of a study file: read the motor, and the calibration unless the user's own is given.

    Raises:
        MotorError, CalibrationError: an unknown name or an unusable file, or a motor without any gearbox.
    """
    motors = [load_motor(name) for name in study.motors]
    return _simulator(study, motors, calibration or _named_calibration(study.calibration), workers, executor)


def continued_simulator(
    data: StudyData,
    study: Study,
    *,
    workers: int,
    executor: Executor | None = None,
    calibration: Calibration | None = None,
) -> Simulator:
    """Make the simulator of a study file that continues a stored study.

    A motor or calibration that the user has not changed is as stored: the same file, or the same shipped name. A later
    version may estimate more from the same file, or know better of the same shipped motor.

    Raises:
        MotorError, CalibrationError: an unknown name or an unusable file, or a motor without any gearbox.
        DatabaseError: the stored motor or calibration is damaged.
    """

    def unchanged(key: str, named: str, before: str) -> bool:
        text = _text(named)
        same_name = text is not None or named.lower() == before.lower()
        return same_name and text == data.meta.files.get(key)

    motors = (
        [load_motor(name) for name in study.motors]
        if len(study.motors) != len(data.study.motors)
        else [
            stored if unchanged(key, named, before) else load_motor(named)
            for key, stored, named, before in zip(
                motor_keys(len(study.motors)), data.motors, study.motors, data.study.motors, strict=True
            )
        ]
    )
    if calibration is None and unchanged("calibration", study.calibration, data.study.calibration):
        calibration = data.calibration
    return _simulator(study, motors, calibration or _named_calibration(study.calibration), workers, executor)


def _simulator(
    study: Study, motors: Sequence[Motor], calibration: Calibration, workers: int, executor: Executor | None
) -> Simulator:
    if study.engine == "compiled" and (lacks := calibration.lacks_for_compiled()):
        allowed = f"'mujoco', because calibration {calibration.name!r} does not have {lacks}"
        raise StudyError(complaint("engine", study.engine, allowed, "drop it, or choose another calibration"))
    if study.engine is not None:
        calibration = calibration.by(study.engine)
    if study.controller != PAPER_LAW:
        calibration = calibration.under(study.controller)
    names = [motor.name for motor in motors]
    for name in names:
        if names.count(name) > 1:
            raise StudyError(
                f"motor = {list(study.motors)}: must be different motors, {name!r} is the name of "
                f"{names.count(name)}; drop one, or give the motor in its file another name"
            )
    maps = [
        map_of(motor, study.rules, source=motor_source(named))
        for motor, named in zip(motors, study.motors, strict=True)
    ]
    kits = kit_maps(study, maps)
    for kit, named in zip(kits, study.kits, strict=True):
        require_leg(kit, *map(motor_source, named))
    keys = motor_keys(len(motors))
    return Simulator(
        motors=tuple(motors),
        calibration=calibration,
        evaluator=evaluator_of(kits[0], calibration, workers, others=kits[1:], executor=executor),
        files={
            **dict(zip(keys, map(_text, study.motors), strict=True)),
            "calibration": _text(study.calibration),
        },
    )


def stored_simulator(data: StudyData, *, workers: int, executor: Executor | None = None) -> Simulator:
    """Make the simulator of a stored study from the database alone, whatever has become of the user's files."""
    first, *others = data.kits
    return Simulator(
        motors=data.motors,
        calibration=data.calibration,
        evaluator=evaluator_of(first, data.calibration, workers, others=others, executor=executor),
        files=dict(data.meta.files),
    )


def _named_calibration(name: str) -> Calibration:
    """Return the calibration that a study names, unless only its user's program has it."""
    if name.startswith(OWN_CALIBRATION):
        raise CalibrationError(
            f"calibration {name.removeprefix(OWN_CALIBRATION)!r}: only your program has it; start the study from "
            "Python: pareto_monoped.run(study, db, calibration=...)"
        )
    return load_calibration(name)


def _text(name: str) -> str | None:
    """Return the text of a user's file; None for the name of a shipped one."""
    path = Path(name)
    return path.read_text(encoding="utf-8") if name.endswith(".toml") and path.is_file() else None
