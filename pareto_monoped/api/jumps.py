"""One robot or many, from their designs: gearboxes, parts and jumps."""

from collections.abc import Mapping, Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pareto_monoped.actuator.joint_maps import JointMaps
from pareto_monoped.actuator.motors import Motor, motor_source, motor_values, stored_motor
from pareto_monoped.actuator.motors import load_motor as motor_of
from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.actuator.search import map_of
from pareto_monoped.api.own import own_calibration
from pareto_monoped.design import (
    CONTROL,
    DEFAULT_RULES,
    DEFAULTS,
    NAMES,
    PAPER_MOTOR,
    PAPER_NAMES,
    Design,
    RuleSet,
    columns,
    complete,
)
from pareto_monoped.errors import CalibrationError, DesignError, MotorError, complaint, unknown_name
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.calibration import load_calibration as calibration_of
from pareto_monoped.jump.calibration_defaults import DEFAULT, rules_for
from pareto_monoped.leg.motor_fit import require_leg
from pareto_monoped.robot.build import Robot
from pareto_monoped.robot.build import build_robot as robot_of
from pareto_monoped.study.counts import count_of

if TYPE_CHECKING:
    from pandas import DataFrame

StrPath = str | PathLike[str]
AnyMotor = Motor | StrPath
AnyCalibration = Calibration | StrPath


def load_motor(name_or_path: StrPath) -> Motor:
    """A motor by the name of a shipped one (in any case), or from a TOML file with one motor.

    Raises:
        MotorError: an unknown name, an unreadable file, or a field that is missing, unknown or impossible.

    Example:
        >>> from pareto_monoped import load_motor
        >>> load_motor("VT8020").kv_rpm_per_v
        100.0
    """
    return motor_of(_name(name_or_path, "motor", MotorError))


def load_calibration(name_or_path: StrPath = DEFAULT) -> Calibration:
    """A jump model by its name, or from a TOML file.

    Raises:
        CalibrationError: an unknown name, an unreadable file, or a field that is missing, unknown or out of range.

    Example:
        >>> from pareto_monoped import load_calibration
        >>> load_calibration("reference").simulation.timestep_s
        0.001
    """
    return calibration_of(_name(name_or_path, "calibration", CalibrationError))


def actuator_map(motor: AnyMotor = PAPER_MOTOR, *, rules: RuleSet = DEFAULT_RULES) -> ActuatorMap:
    """The lightest planetary gearbox of a motor for every gear ratio: stage 1 of the paper.

    The search is exhaustive and takes a fraction of a second. A map is made once and kept while the process runs.

    Args:
        motor: a motor, the name of a shipped one, or a TOML file.
        rules: of the gearboxes. ``iso6336`` rates teeth, bearings and shafts; ``paper`` is what the paper asks for.

    Raises:
        MotorError: an unusable motor, or one without a gearbox at any ratio.

    Example:
        >>> from pareto_monoped import actuator_map
        >>> actuator_map("VT8020").lookup(6.0).ratio
        6.0
    """
    if not isinstance(rules, str) or rules not in get_args(RuleSet):
        raise MotorError(complaint("rules", rules, " or ".join(map(repr, get_args(RuleSet))), "correct it"))
    if isinstance(motor, Motor):
        return map_of(_own_motor(motor), rules)
    return map_of(load_motor(motor), rules, source=motor_source(fspath(motor)))


def _own_motor(motor: Motor) -> Motor:
    """A motor that a script made, checked as one from a file.

    Raises:
        MotorError: a value that no motor can have.
    """
    if type(motor) is not Motor:
        raise MotorError(
            f"motor {motor.name!r}: is a {type(motor).__name__}, must be a Motor itself; change the values of one: "
            "dataclasses.replace(load_motor('VT8020'), ...)"
        )
    try:
        values = motor_values(motor)
    except (AttributeError, TypeError, ValueError) as error:
        raise MotorError(f"motor {motor.name!r}: {error}; correct its values") from None
    return stored_motor(values, source=f"motor {motor.name!r}")


def joint_maps_of(
    motor: AnyMotor, hip_motor: AnyMotor | None, knee_motor: AnyMotor | None, rules: RuleSet
) -> JointMaps:
    """The gearboxes of a robot's joints; a leg fits them.

    Raises:
        MotorError: an unusable motor, or one that no gearbox or no leg fits.
    """
    hip, knee = (actuator_map(motor if own is None else own, rules=rules) for own in (hip_motor, knee_motor))
    maps = JointMaps(hip=hip, knee=knee)
    require_leg(maps)
    return maps


def build_robot(
    design: Design,
    *,
    motor: AnyMotor = PAPER_MOTOR,
    hip_motor: AnyMotor | None = None,
    knee_motor: AnyMotor | None = None,
    rules: RuleSet = DEFAULT_RULES,
) -> Robot:
    """The robot of a design with every part that has a mass, as it is simulated and exported.

    Args:
        design: its variables.
        motor: of both joints: a motor, the name of a shipped one, or a TOML file.
        hip_motor: of the hip, instead of ``motor``.
        knee_motor: of the knee, likewise.
        rules: of the gearboxes, see ``actuator_map``.

    Raises:
        MotorError: an unusable motor, or one that no gearbox or no leg fits.
        DesignError: a gear ratio without a gearbox.

    Example:
        >>> from pareto_monoped import PAPER_CASES, build_robot
        >>> round(build_robot(PAPER_CASES["C"].design).mass_kg, 1)
        4.8
    """
    checked = Design.from_array(as_values(require_design(design))[0])
    return robot_of(checked, joint_maps_of(motor, hip_motor, knee_motor, rules))


def simulate(
    designs: "Design | Mapping[str, float] | Sequence[Design] | DataFrame | ArrayLike",
    *,
    motor: AnyMotor = PAPER_MOTOR,
    hip_motor: AnyMotor | None = None,
    knee_motor: AnyMotor | None = None,
    calibration: AnyCalibration = DEFAULT,
    rules: RuleSet | None = None,
    workers: int | None = None,
) -> "DataFrame":
    """Let designs jump, and measure it.

    Args:
        designs: one ``Design`` or several; a mapping or a data frame with a column per variable; or an array of shape
            (n, 7), the paper's variables, or (n, number of variables), in the order of ``VARIABLES``. Optional
            variables that are left out have their defaults.
        motor: of both joints: a motor, the name of a shipped one, or a TOML file.
        hip_motor: of the hip, instead of ``motor``.
        knee_motor: of the knee, likewise.
        calibration: the jump model: a calibration, the name of a shipped one, or a TOML file.
        rules: of the gearboxes; by default those that go with the calibration.
        workers: number of threads, all cores if None. It does not change the results.

    Returns:
        One row per design, in the order given, with the variables, ``status``, ``reason``, and every measure of
        ``MEASURES`` in the unit of its name, NaN where the jump failed.

    Raises:
        DesignError: a missing or unknown variable, or an array of another shape. A design that cannot be built or does
            not jump is a row with its status, not an error.
        MotorError: an unusable motor, or one that no gearbox or no leg fits.
        CalibrationError: an unusable calibration.

    Example:
        >>> from pareto_monoped import PAPER_CASES, simulate
        >>> jump = simulate(PAPER_CASES["C"].design)
        >>> print(jump.status[0], f"{jump.height_m[0]:.2f} m")
        ok 1.05 m
    """
    model, chosen = calibrated(calibration, rules)
    return jumps_of(designs, joint_maps_of(motor, hip_motor, knee_motor, chosen), model, workers)


def jumps_of(designs: Any, maps: JointMaps, calibration: Calibration, workers: int | None) -> "DataFrame":
    """As ``simulate``, with gearboxes that are already made."""
    import pandas as pd

    from pareto_monoped.jump.evaluate import Evaluator
    from pareto_monoped.study.run import default_workers

    values, threads = as_values(designs), count_of("workers", workers)
    result = Evaluator(maps, calibration, workers=threads or default_workers())(values)
    return pd.DataFrame(dict(zip(NAMES, values.T, strict=True)) | result.as_columns())


def trace(
    design: Design | Mapping[str, float],
    *,
    motor: AnyMotor = PAPER_MOTOR,
    hip_motor: AnyMotor | None = None,
    knee_motor: AnyMotor | None = None,
    calibration: AnyCalibration = DEFAULT,
    rules: RuleSet | None = None,
) -> "DataFrame":
    """One jump step by step: states, torques, forces and energies, in the units of their names.

    Args:
        design: one design, see ``simulate``.
        motor: see ``simulate``.
        hip_motor: see ``simulate``.
        knee_motor: see ``simulate``.
        calibration: see ``simulate``.
        rules: see ``simulate``.

    Returns:
        One row per time step, with the columns of ``simulate --trace``; the jump is that of ``simulate`` to the last
        bit.

    Raises:
        DesignError: see ``simulate``; also if the design cannot be built or cannot stand.
        MotorError: see ``simulate``.
        CalibrationError: see ``simulate``.

    Example:
        >>> from pareto_monoped import PAPER_CASES, trace
        >>> steps = trace(PAPER_CASES["C"].design)
        >>> print(f"{steps.base_z_m.max():.2f} m")
        1.05 m
    """
    import pandas as pd

    from pareto_monoped.jump.single import trace_of
    from pareto_monoped.robot.population import robot_arrays

    values = as_values(design)
    if len(values) != 1:
        raise DesignError(complaint("number of designs", len(values), "1 for a trace", "trace them one by one"))
    model, chosen = calibrated(calibration, rules)
    maps = joint_maps_of(motor, hip_motor, knee_motor, chosen)
    one = jumps_of(values, maps, model, workers=1)
    if one["status"][0] in ("bad_input", "no_gearbox", "cannot_stand"):
        raise DesignError(f"design: has no jump to trace ({one['reason'][0]}); change it")
    robots = robot_arrays(values, maps, model.mass)
    return pd.DataFrame(trace_of(robots, columns(values, CONTROL), model))


def as_values(designs: Any) -> NDArray[np.float64]:
    """Designs in any form that ``simulate`` takes, as an array of shape (n, number of variables).

    Raises:
        DesignError: a missing or unknown variable, a value that is no number, or an array of another shape.
    """
    if isinstance(designs, Design):
        return _of_designs([designs])
    one = designs[0] if isinstance(designs, list | tuple) and designs else designs
    if isinstance(getattr(one, "design", None), Design):
        raise DesignError(f"designs: are of class {type(one).__name__}, must be Designs; {_cure_of_holder(one)}")
    if isinstance(designs, Mapping) or hasattr(designs, "columns"):
        return _of_columns(designs)
    if isinstance(designs, Sequence) and designs and all(isinstance(one, Design) for one in designs):
        return _of_designs(designs)
    try:
        values = np.atleast_2d(np.asarray(designs, dtype=np.float64))
    except (TypeError, ValueError, OverflowError):
        allowed = "a Design, a list of them, a mapping or data frame of variables, or an array of numbers"
        raise DesignError(complaint("designs", designs, allowed, "give one of these")) from None
    if values.ndim != 2:
        raise DesignError(complaint("dimensions of designs", values.ndim, "1 or 2", "give one row per design"))
    return complete(values)


def require_design(given: Any) -> Design:
    """One design.

    Raises:
        DesignError: something else.
    """
    if isinstance(given, Design):
        return given
    if isinstance(getattr(given, "design", None), Design):
        raise DesignError(f"design: is of class {type(given).__name__}, must be a Design; {_cure_of_holder(given)}")
    raise DesignError(complaint("design", given, "a Design", "give for example PAPER_CASES['C'].design"))


def _cure_of_holder(given: Any) -> str:
    """What to do with an object that has a design: one that was picked from a study has the study's motors, too."""
    if hasattr(given, "trial"):
        return "use its .design and the motors of its study, or what knows them: StoredStudy.simulate, export_trial"
    return "use its .design"


def _of_designs(designs: Sequence[Design]) -> NDArray[np.float64]:
    try:
        return np.array([one.as_array() for one in designs])
    except (TypeError, ValueError, OverflowError):
        raise DesignError("designs: must have a number for each variable; correct them") from None


def _of_columns(table: "Mapping[str, Any] | DataFrame") -> NDArray[np.float64]:
    """Designs from one column per variable; a data frame may have other columns, a mapping of one design may not."""
    if missing := [name for name in PAPER_NAMES if name not in table]:
        raise DesignError(f"designs: lack {', '.join(missing)}; add them")
    if isinstance(table, Mapping) and (unknown := [name for name in table if name not in NAMES]):
        raise DesignError(unknown_name("design variable", unknown[0], NAMES))
    given = [table[name] if name in table else DEFAULTS[name] for name in NAMES]
    try:
        return np.column_stack(np.broadcast_arrays(*(np.atleast_1d(np.asarray(v, dtype=np.float64)) for v in given)))
    except (TypeError, ValueError, OverflowError):
        raise DesignError("designs: must have numbers, as many of each variable; correct them") from None


def calibrated(calibration: AnyCalibration, rules: RuleSet | None) -> tuple[Calibration, RuleSet]:
    """The calibration, and the rules of gearboxes that go with it."""
    if isinstance(calibration, Calibration):
        model = own_calibration(calibration)
        return model, rules_for(model.name, rules)
    return load_calibration(calibration), rules_for(fspath(calibration), rules)


def _name(given: StrPath, what: str, error: type[MotorError] | type[CalibrationError]) -> str:
    """A name or path as text."""
    if isinstance(given, str | PathLike) and isinstance(text := fspath(given), str):
        try:
            Path(text).is_file()
        except (OSError, ValueError) as problem:
            raise error(f"{what}: cannot be the name of a file ({problem.args[-1]}); check the path") from None
        return text
    raise error(complaint(what, given, "a name or the path of a TOML file", "give one of these"))
