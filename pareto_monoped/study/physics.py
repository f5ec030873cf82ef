"""From a study's names to the evaluator that it simulates with, and what that evaluator is made of."""

import json
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import LOWER, PAPER_CASES, UPPER
from pareto_monoped.jump.calibration import Calibration, load_calibration
from pareto_monoped.jump.evaluate import Evaluations, Evaluator
from pareto_monoped.study.definition import Study

Evaluate = Callable[[NDArray[np.float64]], Evaluations]
"""Designs, shape (n, 7), to their evaluations, in order."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Physics:
    """What a study simulates with.

    Attributes:
        evaluator: designs to evaluations.
        calibration: the jump model.
        contents: every value of ``motor`` and ``calibration``, as JSON values.
        files: text of the motor and the calibration file where the study names files of the user's, else None.
    """

    evaluator: Evaluator
    calibration: Calibration
    contents: dict[str, Any]
    files: dict[str, str | None]

    def probe(self) -> list[list[float | None]]:
        """Height and energy of the paper's four designs and four fixed ones: a fingerprint of everything that counts.

        Code, compiler, library versions and processor all show in their last digits.
        """
        paper = np.array([case.design.as_array() for case in PAPER_CASES.values()])
        drawn = np.random.default_rng(20250101).uniform(LOWER, UPPER, size=(4, len(LOWER)))
        result = self.evaluator(np.vstack((paper, drawn)))
        pairs = np.column_stack((result.height_m, result.energy_j))
        return [[value if np.isfinite(value) else None for value in row] for row in pairs.tolist()]


def load_physics(study: Study, *, workers: int, files: Mapping[str, str | None] | None = None) -> Physics:
    """Motor, actuator map, calibration and evaluator of a study.

    Args:
        study: names the motor and the calibration, or files of them.
        workers: threads that simulate.
        files: text of such files as stored with the study; without it they are read.

    Raises:
        MotorError, CalibrationError: an unknown name or an unusable file.
    """
    from pareto_monoped.actuator.motors import load_motor
    from pareto_monoped.actuator.search import build_map, map_for

    texts = {
        "motor": _text(study.motor) if files is None else files["motor"],
        "calibration": _text(study.calibration) if files is None else files["calibration"],
    }
    with tempfile.TemporaryDirectory() as folder:
        # The readers of motors and calibrations take files; texts that came with a database become files again.
        names = {
            key: name if text is None else _file(Path(folder), name, text)
            for (key, text), name in zip(texts.items(), (study.motor, study.calibration), strict=True)
        }
        motor = load_motor(names["motor"])
        actuator_map = map_for(names["motor"]) if texts["motor"] is None else build_map(motor)
        calibration = load_calibration(names["calibration"])
    return Physics(
        evaluator=Evaluator(actuator_map, calibration, workers=workers),
        calibration=calibration,
        contents=json.loads(json.dumps({"motor": asdict(motor), "calibration": asdict(calibration)})),
        files=texts,
    )


def _text(name: str) -> str | None:
    """Text of a user's file, None for a name (or for a file that is missing, which its reader reports)."""
    path = Path(name)
    return path.read_text(encoding="utf-8") if name.endswith(".toml") and path.is_file() else None


def _file(folder: Path, name: str, text: str) -> str:
    # Only the last part of a stored name is used: it may come from a stranger's database.
    path = folder / (Path(name).name if name.endswith(".toml") else "file.toml")
    path.write_text(text, encoding="utf-8")
    return str(path)
