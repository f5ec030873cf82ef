"""One robot or many, from their designs: gearboxes, parts and jumps."""

from collections.abc import Mapping, Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pareto_monoped.actuator.motor import Motor
from pareto_monoped.actuator.motors import load_motor as motor_of
from pareto_monoped.actuator.motors import motor_source, motor_values, stored_motor
from pareto_monoped.actuator.ratiomap import ActuatorMap, JointMaps
from pareto_monoped.actuator.search import map_of
from pareto_monoped.api.given import one_design, own_calibration, renamed, truth_of, with_motors
from pareto_monoped.compute.chunks import cores
from pareto_monoped.definition.given import count_of
from pareto_monoped.design import DEFAULT_RULES, PAPER_MOTOR, Design, RuleSet, control_of, designs_of, table_of
from pareto_monoped.errors import CalibrationError, DesignError, MotorError, complaint
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.calibration import load_calibration as calibration_of
from pareto_monoped.jump.calibration_defaults import DEFAULT, rules_for
from pareto_monoped.jump.laws import Law, law_of
from pareto_monoped.leg.thigh_outline import require_leg
from pareto_monoped.robot.build import Robot
from pareto_monoped.robot.build import build_robot as robot_of

if TYPE_CHECKING:
    from pandas import DataFrame

StrPath = str | PathLike[str]
AnyMotor = Motor | StrPath
AnyCalibration = Calibration | StrPath
AnyController = Law | Mapping[str, Any] | str


def load_motor(name_or_path: StrPath) -> Motor:
    """Return a motor by the name of a shipped one (in any case), or from a TOML file with one motor.

    Raises:
        MotorError: an unknown name, an unreadable file, or a field that is missing, unknown or impossible.

    Example:
        >>> from pareto_monoped import load_motor
        >>> load_motor("VT8020").kv_rpm_per_v
        100.0
    """
    return motor_of(_name(name_or_path, "motor", MotorError))


def load_calibration(name_or_path: StrPath = DEFAULT) -> Calibration:
    """Return a jump model by its name, or from a TOML file.

    Raises:
        CalibrationError: an unknown name, an unreadable file, or a field that is missing, unknown or out of range.

    Example:
        >>> from pareto_monoped import load_calibration
        >>> load_calibration("reference").simulation.timestep_s
        0.0002
    """
    return calibration_of(_name(name_or_path, "calibration", CalibrationError))


def actuator_map(motor: AnyMotor = PAPER_MOTOR, *, rules: RuleSet = DEFAULT_RULES) -> ActuatorMap:
    """Return the lightest planetary gearbox of a motor for every gear ratio: stage 1 of the paper.

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
    name = _name(motor, "motor", MotorError, f"a Motor, {_NAME}")
    return map_of(motor_of(name), rules, source=motor_source(name))


def _own_motor(motor: Motor) -> Motor:
    """Return a motor that a script made, checked as one from a file."""
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
    """Return the gearboxes of a robot's joints; raise ``MotorError`` if no gearbox or no leg fits a motor."""
    hip, knee = (actuator_map(motor if own is None else own, rules=rules) for own in (hip_motor, knee_motor))
    maps = JointMaps(hip=hip, knee=knee)
    require_leg(maps)
    return maps


def build_robot(
    design: "Design | Mapping[str, Any] | DataFrame | ArrayLike",
    *,
    motor: AnyMotor = PAPER_MOTOR,
    hip_motor: AnyMotor | None = None,
    knee_motor: AnyMotor | None = None,
    rules: RuleSet = DEFAULT_RULES,
) -> Robot:
    """Return the robot of a design with every part that has a mass, as it is simulated and exported.

    Args:
        design: its variables, in one of the forms that ``trace`` takes.
        motor: of both joints: a motor, the name of a shipped one, or a TOML file.
        hip_motor: of the hip, instead of ``motor``.
        knee_motor: of the knee, likewise.
        rules: of the gearboxes, see ``actuator_map``.

    Raises:
        MotorError: an unusable motor, or one that no gearbox or no leg fits.
        DesignError: a gear ratio without a gearbox, a missing or unknown variable, or a row that names other motors.

    Example:
        >>> from pareto_monoped import PAPER_CASES, build_robot
        >>> round(build_robot(PAPER_CASES["C"].design).mass_kg, 1)
        4.5
    """
    maps = joint_maps_of(motor, hip_motor, knee_motor, rules)
    return robot_of(one_design(design, maps), maps)


def simulate(
    designs: "Design | Mapping[str, Any] | Sequence[Any] | DataFrame | ArrayLike",
    *,
    motor: AnyMotor = PAPER_MOTOR,
    hip_motor: AnyMotor | None = None,
    knee_motor: AnyMotor | None = None,
    calibration: AnyCalibration = DEFAULT,
    controller: AnyController | None = None,
    rules: RuleSet | None = None,
    landing: bool = False,
    workers: int | None = None,
) -> "DataFrame":
    """Let designs jump, and measure it.

    Args:
        designs: one ``Design`` or several; a mapping or a data frame with a column per variable, a row of such a frame,
            or a list of these; or an array of shape (n, 7), the paper's variables, or (n, number of variables), in the
            order of ``VARIABLES``. Optional variables that are left out have their defaults. A frame may have the other
            columns of stored trials; the motors that it names must be those used here.
        motor: of both joints: a motor, the name of a shipped one, or a TOML file.
        hip_motor: of the hip, instead of ``motor``.
        knee_motor: of the knee, likewise.
        calibration: the jump model: a calibration, the name of a shipped one, or a TOML file.
        controller: what the motors are told, by its name or as the table ``[controller]`` of a study file, such as
            ``{"kind": "torque_over_time", "knots": 8}``, or an ``OwnLaw``; by default that of the calibration.
        rules: of the gearboxes; by default those that go with the calibration.
        landing: whether they also land; adds ``landing_ok`` and what ``LandingMeasures`` names to the columns.
        workers: number of threads, all cores if None. It does not change the results.

    Returns:
        One row per design, in the order given, with the variables, ``status``, ``reason``, and every measure of
        ``MEASURES`` in the unit of its name, NaN where the jump failed.

    Raises:
        DesignError: a missing or unknown variable, an array of another shape, or a row that names other motors, which
            ``StoredStudy.simulate`` would take. A design that cannot be built or does not jump is a row with its
            status, not an error.
        MotorError: an unusable motor, or one that no gearbox or no leg fits.
        CalibrationError: an unusable calibration.

    Example:
        >>> from pareto_monoped import PAPER_CASES, simulate
        >>> jump = simulate(PAPER_CASES["C"].design)
        >>> print(jump.status[0], f"{jump.height_m[0]:.2f} m")
        ok 1.06 m
    """
    model, chosen = calibrated(calibration, rules)
    maps = joint_maps_of(motor, hip_motor, knee_motor, chosen)
    designs, model, slots = _controlled(designs, model, controller)
    found = jumps_of(with_motors(designs, maps), [maps], model, workers)
    if truth_of("landing", landing):
        from pareto_monoped.jump.landing import landed
        from pareto_monoped.measures import LANDING_MEASURES

        landings = landed(designs_of(found), maps, model)
        for name in ("landing_ok", *(one.name for one in LANDING_MEASURES)):
            found[name] = getattr(landings, name)
    return found.rename(columns=slots)


def _controlled(
    designs: Any, calibration: Calibration, controller: AnyController | None
) -> tuple[Any, Calibration, dict[str, str]]:
    """Return designs in the columns that the law reads, the calibration with it, and what own variables are called."""
    if controller is None:
        return designs, calibration, {}
    law = law_of(controller, source="controller", error=DesignError)
    slots = law.slots
    return renamed(designs, slots), calibration.under(law), {slot: name for name, slot in slots.items()}


def jumps_of(
    values: NDArray[np.float64],
    kits: Sequence[JointMaps],
    calibration: Calibration,
    workers: int | None,
    motors: NDArray[np.intp] | None = None,
) -> "DataFrame":
    """Return the rows of ``simulate`` with gearboxes ``kits`` that are already made.

    ``motors`` has the row of ``kits`` for each design, shape (n,); None means the first.
    """
    import pandas as pd

    from pareto_monoped.jump.evaluate import Evaluator

    threads = count_of("workers", workers) or cores()
    result = Evaluator(kits[0], calibration, workers=threads, others=kits[1:])(values, motors)
    return pd.DataFrame(table_of(values) | result.as_columns())


def trace(
    design: "Design | Mapping[str, Any] | DataFrame | ArrayLike",
    *,
    motor: AnyMotor = PAPER_MOTOR,
    hip_motor: AnyMotor | None = None,
    knee_motor: AnyMotor | None = None,
    calibration: AnyCalibration = DEFAULT,
    controller: AnyController | None = None,
    rules: RuleSet | None = None,
) -> "DataFrame":
    """Return one jump step by step: states, torques, forces and energies, in the units of their names.

    Args:
        design: one design: a ``Design``, a mapping of variables, or a row of a data frame; see ``simulate``.
        motor: see ``simulate``.
        hip_motor: see ``simulate``.
        knee_motor: see ``simulate``.
        calibration: see ``simulate``.
        controller: see ``simulate``.
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
        1.06 m
    """
    import pandas as pd

    from pareto_monoped.jump.single import trace_of
    from pareto_monoped.robot.population import robot_arrays

    model, chosen = calibrated(calibration, rules)
    maps = joint_maps_of(motor, hip_motor, knee_motor, chosen)
    design, model, _ = _controlled(design, model, controller)
    values = with_motors(design, maps)
    if len(values) != 1:
        raise DesignError(complaint("number of designs", len(values), "1 for a trace", "trace them one by one"))
    one = jumps_of(values, [maps], model, workers=1)
    if one["status"][0] in ("bad_input", "no_gearbox", "cannot_stand"):
        raise DesignError(f"design: has no jump to trace ({one['reason'][0]}); change it")
    robots = robot_arrays(values, maps, model.mass)
    return pd.DataFrame(trace_of(robots, control_of(values), model))


def table1(*, workers: int | None = None) -> "DataFrame":
    """Return the paper's Table I as published, and as simulated here under ``paper`` and ``reference``.

    Args:
        workers: number of threads, all cores if None. It does not change the results.

    Returns:
        One row per case, with ``case`` and heights and energies such as ``published.height_m``. Under ``paper``, they
        are medians over 100 copies changed by up to 1e-6, with percentiles and ``paper.jumped_share``.

    Raises:
        InputError: no number of threads.

    Example:
        >>> from pareto_monoped import table1
        >>> print(table1().set_index("case").loc["C", ["published.height_m", "reference.height_m"]].round(3).to_dict())
        {'published.height_m': 0.8, 'reference.height_m': 1.058}
    """
    import pandas as pd

    from pareto_monoped.jump.table1 import table1 as rows_of

    maps = (actuator_map(rules=rules_for(name)) for name in ("paper", "reference"))
    rows = rows_of(*maps, workers=count_of("workers", workers) or cores())
    return pd.json_normalize([row.as_dict() for row in rows])


def calibrated(calibration: AnyCalibration, rules: RuleSet | None) -> tuple[Calibration, RuleSet]:
    """Return the calibration, and the rules of gearboxes that go with it."""
    if isinstance(calibration, Calibration):
        model = own_calibration(calibration)
        return model, rules_for(model.name, rules)
    name = _name(calibration, "calibration", CalibrationError, f"a Calibration, {_NAME}")
    return calibration_of(name), rules_for(name, rules)


_NAME = "a name or the path of a TOML file"


def _name(given: StrPath, what: str, error: type[MotorError] | type[CalibrationError], allowed: str = _NAME) -> str:
    if isinstance(given, str | PathLike) and isinstance(text := fspath(given), str):
        try:
            Path(text).is_file()
        except (OSError, ValueError) as problem:
            raise error(f"{what}: cannot be the name of a file ({problem.args[-1]}); check the path") from None
        return text
    raise error(complaint(what, given, allowed, "give one of these"))
