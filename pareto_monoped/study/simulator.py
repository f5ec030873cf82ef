"""What a study simulates with, from the names in its study file or from what its database holds."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.motors import Motor, load_motor, motor_source, motor_values
from pareto_monoped.actuator.search import map_of
from pareto_monoped.design import LOWER, PAPER_CASES, UPPER, complete
from pareto_monoped.jump.calibration import Calibration, calibration_values, load_calibration
from pareto_monoped.jump.evaluate import Evaluations, Evaluator
from pareto_monoped.leg.motor_fit import require_leg
from pareto_monoped.study.coordinates import Coordinates, coordinates_of
from pareto_monoped.study.definition import Study
from pareto_monoped.study.reader import StudyData

Evaluate = Callable[[NDArray[np.float64]], Evaluations]
"""Designs, see ``design.complete``, to their evaluations, in order."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Simulator:
    """What a study simulates with.

    Attributes:
        motor, calibration: what decides every jump.
        evaluator: designs to evaluations, with the motor's actuator map and the calibration.
        files: texts of the ``motor`` and the ``calibration`` file where the study names files of the user's, else None.
    """

    motor: Motor
    calibration: Calibration
    evaluator: Evaluator
    files: dict[str, str | None]

    @property
    def contents(self) -> dict[str, dict[str, Any]]:
        """Every value of ``motor`` and ``calibration``, as JSON values."""
        return {"motor": motor_values(self.motor), "calibration": calibration_values(self.calibration)}

    def coordinates(self, study: Study) -> Coordinates:
        """What an algorithm searches in ``study``: lists of this motor's gearboxes where the study has them."""
        return coordinates_of(study, self.evaluator.actuator_map)

    def probe(self) -> list[list[float | None]]:
        """Height and energy of the paper's four designs and four fixed ones: a fingerprint of everything that counts.

        Code, compiler, library versions and processor all show in their last digits.
        """
        paper = np.array([case.design.as_array() for case in PAPER_CASES.values()])
        drawn = np.random.default_rng(20250101).uniform(LOWER, UPPER, size=(4, len(LOWER)))
        result = self.evaluator(np.vstack((paper, complete(drawn))))
        pairs = np.column_stack((result.height_m, result.energy_j))
        return [[value if np.isfinite(value) else None for value in row] for row in pairs.tolist()]


def load_simulator(study: Study, *, workers: int) -> Simulator:
    """The simulator of a study file: reads the motor and the calibration that it names.

    Args:
        study: names the motor and the calibration, or files of them.
        workers: threads that simulate.

    Raises:
        MotorError, CalibrationError: an unknown name or an unusable file, or a motor without any gearbox.
    """
    return _simulator(study, load_motor(study.motor), load_calibration(study.calibration), workers)


def continued_simulator(data: StudyData, study: Study, *, workers: int) -> Simulator:
    """The simulator of a study file that continues a stored study.

    A motor or calibration that the user has not changed is as stored: the same file, or the same shipped name. A later
    version may estimate more from the same file, or know better of the same shipped motor.

    Args:
        data: the stored study.
        study: names the motor and the calibration, or files of them.
        workers: threads that simulate.

    Raises:
        MotorError, CalibrationError: an unknown name or an unusable file, or a motor without any gearbox.
        DatabaseError: the stored motor or calibration is damaged.
    """

    def unchanged(key: str) -> bool:
        named, text = getattr(study, key), _text(getattr(study, key))
        same_name = text is not None or named.lower() == getattr(data.study, key).lower()
        return same_name and text == data.meta.files.get(key)

    motor = data.motor if unchanged("motor") else load_motor(study.motor)
    calibration = data.calibration if unchanged("calibration") else load_calibration(study.calibration)
    return _simulator(study, motor, calibration, workers)


def _simulator(study: Study, motor: Motor, calibration: Calibration, workers: int) -> Simulator:
    source = motor_source(study.motor)
    actuator_map = map_of(motor, study.rules, source=source)
    require_leg(actuator_map, source)
    return Simulator(
        motor=motor,
        calibration=calibration,
        evaluator=Evaluator(actuator_map, calibration, workers=workers),
        files={"motor": _text(study.motor), "calibration": _text(study.calibration)},
    )


def stored_simulator(data: StudyData, *, workers: int) -> Simulator:
    """The simulator of a stored study: from the database alone, whatever has become of the user's files.

    Raises:
        DatabaseError: the stored motor or calibration is damaged.
    """
    return Simulator(
        motor=data.motor,
        calibration=data.calibration,
        evaluator=Evaluator(data.actuator_map, data.calibration, workers=workers),
        files=dict(data.meta.files),
    )


def _text(name: str) -> str | None:
    """Text of a user's file; None for the name of a shipped one."""
    path = Path(name)
    return path.read_text(encoding="utf-8") if name.endswith(".toml") and path.is_file() else None
