"""Commands of stage 2, physics: ``simulate`` and ``table1``."""

import json
import math
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pareto_monoped.cli import options
from pareto_monoped.cli.options import CSV_FILE, Local, chosen_motors, force_option, motor_options
from pareto_monoped.cli.terminal import echo, new_console, note
from pareto_monoped.cli.watching import require_what_shows, view_jump, write_films
from pareto_monoped.design import (
    ALL_NAMES,
    DEFAULT_RULES,
    NAMES,
    PAPER_CASES,
    PAPER_MOTOR,
    RULE_SETS,
    VARIABLES,
    Design,
    RuleSet,
    control_of,
)
from pareto_monoped.errors import DesignError, SimulationError, complaint, unknown_name
from pareto_monoped.jump.calibration_defaults import DEFAULT

if TYPE_CHECKING:
    from pareto_monoped.actuator.ratiomap import JointMaps
    from pareto_monoped.jump.calibration import Calibration
    from pareto_monoped.jump.laws import Law
    from pareto_monoped.jump.single import JumpResult
    from pareto_monoped.jump.table1 import Row

_OUTPUT = Local(dir_okay=False)
_VARIABLES = "\n".join(
    ["\b", "Design variables of --set, with their units and usual bounds:"]
    + [
        f"  {one.name:<32} {'' if one.unit == '1' else one.unit:<8} {one.lower:g} to {one.upper:g}"
        + ("" if one.default is None else f", optional, default {one.default:g}")
        for one in VARIABLES
    ]
)


@click.command(epilog=_VARIABLES)
@click.option(
    "--case",
    type=click.Choice(list(PAPER_CASES)),
    default="nominal",
    show_default=True,
    help="Start from a row of Table I.",
)
@click.option(
    "--set",
    "changes",
    metavar="NAME=X",
    multiple=True,
    shell_complete=options.variables,
    help="Change a design variable; may be repeated.",
)
@click.option(
    "--calibration",
    "calibration_name",
    metavar="NAME",
    shell_complete=options.calibrations,
    default=DEFAULT,
    show_default=True,
    help="Name or TOML file.",
)
@click.option(
    "--controller",
    metavar="NAME",
    help="virtual_leg, or a profile with its knots: torque_over_time:8.  [default: the calibration's]",
)
@motor_options()
@click.option("--rules", type=click.Choice(RULE_SETS), help=f"Rules of the gearboxes.  [default: {DEFAULT_RULES}]")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@click.option("--trace", metavar="FILE.csv", type=CSV_FILE, help="Write one row per time step.")
@click.option("--model", metavar="FILE.xml", type=_OUTPUT, help="Write the simulated model as MJCF.")
@click.option("--gif", metavar="FILE.gif", type=_OUTPUT, help="Write the jump as an animated picture.")
@click.option("--video", metavar="FILE.mp4", type=_OUTPUT, help="Write the jump as a video, .mp4 or .webm.")
@click.option("--view", is_flag=True, help="Show the jump in MuJoCo's viewer.")
@click.option(
    "--slower",
    type=click.FloatRange(1.0, 100.0),
    default=6.0,
    show_default=True,
    metavar="N",
    help="Films and viewer: N times slower than the jump.",
)
@force_option
@click.option("--audit", "audited", is_flag=True, help="Numerical audit: energy balance, finer steps, perturbations.")
def simulate(
    case: str,
    changes: tuple[str, ...],
    calibration_name: str,
    controller: str | None,
    motor: str | None,
    hip_motor: str | None,
    knee_motor: str | None,
    rules: RuleSet | None,
    as_json: bool,
    trace: Path | None,
    model: Path | None,
    gif: Path | None,
    video: Path | None,
    view: bool,
    slower: float,
    force: bool,
    audited: bool,
) -> None:
    """Simulate one jump and print its measures.

    A robot that cannot stand or does not jump has none. Its status and reason are printed, and the exit code is 1.
    """
    from pareto_monoped.jump.calibration import load_calibration
    from pareto_monoped.jump.calibration_defaults import rules_for
    from pareto_monoped.jump.single import simulate as jump
    from pareto_monoped.leg.thigh_outline import maps_for
    from pareto_monoped.robot.units import JOINTS

    shown = gif is not None or video is not None or view
    require_what_shows(gif, video, view)
    design = _design(case, changes)
    calibration = load_calibration(calibration_name)
    if controller is not None:
        calibration = calibration.under(_law(controller))
    hip, knee = chosen_motors(motor, hip_motor, knee_motor)
    maps = maps_for(hip, knee, rules_for(calibration_name, rules))
    served = {(maps.of(joint), getattr(design, f"{joint}_ratio")) for joint in JOINTS}
    stand_ins = list(filter(None, (one.stand_in(ratio) for one, ratio in sorted(served, key=lambda pair: pair[1]))))
    result = jump(design, maps, calibration, trace=trace is not None or shown)
    if result.status == "bad_input":
        raise DesignError(result.reason)
    if result.status == "no_gearbox":
        raise DesignError(f"{result.reason}; choose another ratio")
    if result.status == "cannot_stand" and (trace or model or shown):
        raise DesignError(f"design cannot stand: {result.reason}; there is no jump to write, change the link lengths")
    motors = _motors(hip, knee)
    report = _report(result, motors, maps)
    advice = _add_gear_life(report, result, maps)
    for text in (*advice, *stand_ins, *_outside(design)):
        note(text)
    if audited and result.status == "ok":
        report["audit"] = _audit(design, maps, calibration)
    if trace:
        _write_trace(trace, result, force=force)
    if model:
        _write_model(model, design, motors, maps, calibration, force=force)
    if gif is not None or video is not None:
        write_films(design, maps, result.trace, gif=gif, video=video, slower=slower, force=force)
    if as_json:
        echo(json.dumps(report, indent=2))
    else:
        _print(report)
    if view:
        view_jump(design, maps, calibration, result.trace, slower=slower)
    if result.status != "ok":
        raise SimulationError(f"jump: {result.status.replace('_', ' ')}, {result.reason}; {_CURES[result.status]}")


_CURES = {
    "cannot_stand": "change the link lengths or start_height_m",
    "no_lift_off": "raise stiffness_n_per_m or the gear ratios, or lower damping_n_s_per_m",
    "timeout": "lower stiffness_n_per_m or rest_length_m",
    "diverged": "choose softer contact and stops or a smaller time step in the calibration, or smaller gains",
}  #: How a jump can fail -> what may help.


def _design(case: str, changes: tuple[str, ...]) -> Design:
    numbers = {}
    for change in changes:
        name, equals, text = change.partition("=")
        name = name.strip()
        if not equals:
            raise DesignError(f"--set {change!r}: must be NAME=X; give for example knee_ratio=6.0")
        if name not in ALL_NAMES:
            raise DesignError(unknown_name("--set name", name, NAMES))
        try:
            numbers[name] = float(text)
        except ValueError:
            raise DesignError(complaint(name, text, "a number", "give for example 0.4")) from None
    return PAPER_CASES[case].design.replace(numbers)


def _law(text: str) -> "Law":
    """Return the controller of an option, such as "torque_over_time:8"."""
    from pareto_monoped.jump.laws import law_of

    kind, colon, knots = text.partition(":")
    if colon and not knots.isdigit():
        raise DesignError(complaint("--controller", text, "KIND or KIND:KNOTS", "give for example torque_over_time:8"))
    return law_of({"kind": kind} | ({"knots": int(knots)} if colon else {}), source="--controller", error=DesignError)


def _outside(design: Design) -> list[str]:
    """Return what to note of values outside their bounds: a line for the paper's variables, and one for the others."""
    found: dict[str, list[str]] = {}
    for variable in VARIABLES:
        value = getattr(design, variable.name)
        if not variable.lower <= value <= variable.upper:
            bounds = f"{variable.lower:g} to {variable.upper:g} {variable.unit}".removesuffix(" 1")
            whose = "the paper's" if variable.default is None else "the usual"
            found.setdefault(whose, []).append(f"{variable.name} = {value:g} ({bounds})")
    return [f"outside {whose} bounds: {', '.join(those)}" for whose, those in found.items()]


def _plain(value: float) -> float | None:
    """Return the value as a JSON number; None, which is null in JSON, if it is not finite."""
    return value if math.isfinite(value) else None


def _motors(hip: str, knee: str) -> dict[str, str]:
    """Return the motors as they were named: one for both joints, or one of each."""
    return {"motor": hip} if hip == knee else {"hip_motor": hip, "knee_motor": knee}


def _report(result: "JumpResult", motors: dict[str, str], maps: "JointMaps") -> dict[str, Any]:
    rules = maps.rules
    return {
        "status": result.status,
        "reason": result.reason,
        "calibration": result.calibration,
        **motors,
        **({} if rules == "paper" else {"rules": rules}),
        **{name: _plain(value) for name, value in result.measures.items()},
        "design": result.design.as_dict(),
    }


def _add_gear_life(report: dict[str, Any], result: "JumpResult", maps: "JointMaps") -> list[str]:
    """Return how many jumps gears that strike their stops in each last; with advice if that is too few."""
    import numpy as np

    from pareto_monoped.strength.factors import gear_life
    from pareto_monoped.strength.joint import loads_of

    known = result.measures | result.design.as_dict()
    life = gear_life(result.design, maps, loads_of({name: np.array([v]) for name, v in known.items()}))
    if life is None:
        return []
    report["gear_life_jumps"] = life.jumps
    return [life.advice] if life.advice else []


def _audit(design: Design, maps: "JointMaps", calibration: "Calibration") -> dict[str, Any]:
    from pareto_monoped.jump.audit import audit
    from pareto_monoped.jump.balance import energy_balance
    from pareto_monoped.robot.population import robot_arrays

    values = design.as_array()[None, :]
    audits = audit(values, maps, calibration).as_columns()
    # These stand in the report already.
    first = {
        name: column[0].item() for name, column in audits.items() if name not in ("status", "height_m", "energy_j")
    }
    balance = energy_balance(robot_arrays(values, maps, calibration.mass), control_of(values), calibration)
    return {
        **{name: _plain(value) if isinstance(value, float) else value for name, value in first.items()},
        "energy": asdict(balance) | {"joint_work_j": balance.joint_work_j, "residual_j": balance.residual_j},
    }


def _write_trace(path: Path, result: "JumpResult", *, force: bool) -> None:
    """One line per step, every number to its last digit; a cell is empty where there is no number."""
    from pareto_monoped.files import write_text

    rows = zip(*(column.tolist() for column in result.trace.values()), strict=True)
    lines = [",".join("" if math.isnan(value) else repr(value) for value in row) for row in rows]
    write_text(path, "\n".join([",".join(result.trace), *lines]) + "\n", force=force)


def _write_model(
    path: Path, design: Design, motors: dict[str, str], maps: "JointMaps", calibration: "Calibration", *, force: bool
) -> None:
    from pareto_monoped.files import write_text
    from pareto_monoped.jump.document import mjcf
    from pareto_monoped.robot.population import robot_arrays

    robots = robot_arrays(design.as_array()[None, :], maps, calibration.mass)
    named = "; ".join(f"{key.replace('_', ' ')}: {name}" for key, name in motors.items())
    comment = f"design: {json.dumps(design.as_dict())}; {named}"
    write_text(path, mjcf(robots, calibration, comment=comment), force=force)


def _print(report: dict[str, Any]) -> None:
    from rich.table import Table

    table = Table(show_header=False, box=None, pad_edge=False)
    for name, value in _lines(report):
        table.add_row(name, value)
    new_console(width=80).print(table)


def _lines(report: dict[str, Any], indent: str = "") -> list[tuple[str, str]]:
    lines = []
    for name, value in report.items():
        if isinstance(value, dict):
            lines += [(f"{indent}{name}", ""), *_lines(value, indent + "  ")]
        elif value not in ("", None):
            lines.append((f"{indent}{name}", f"{value:.6g}" if isinstance(value, float) else str(value)))
    return lines


@click.command()
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def table1(as_json: bool) -> None:
    """Print the paper's Table I as published and as simulated here.

    Simulated under the calibrations `paper` and `reference`.
    """
    from pareto_monoped.actuator.search import map_for
    from pareto_monoped.jump.calibration_defaults import rules_for
    from pareto_monoped.jump.table1 import table1 as rows_of

    paper, reference = (map_for(PAPER_MOTOR, rules_for(name)) for name in ("paper", "reference"))
    ratios = sorted(
        {ratio for case in PAPER_CASES.values() for ratio in (case.design.hip_ratio, case.design.knee_ratio)}
    )
    for text in filter(None, map(reference.stand_in, ratios)):
        note(f"reference: {text}")
    rows = rows_of(paper, reference)
    if as_json:
        echo(json.dumps([row.as_dict() for row in rows], indent=2))
    else:
        _print_table1(rows)


def _print_table1(rows: "tuple[Row, ...]") -> None:
    from rich.table import Table

    table = Table(title="Height in m and energy in J", title_justify="left")
    table.add_column("case")
    for name in ("published", "paper (5 to 95 %)", "reference"):
        table.add_column(name, justify="right")
    for row in rows:
        spread = row.paper
        table.add_row(
            row.case,
            f"{row.published.height_m:.3f}\n{row.published.energy_j:.2f}",
            f"{spread.height_m:.3f} ({spread.height_p05_m:.3f} to {spread.height_p95_m:.3f})\n"
            f"{spread.energy_j:.2f} ({spread.energy_p05_j:.2f} to {spread.energy_p95_j:.2f})",
            f"{row.reference.height_m:.3f}\n{row.reference.energy_j:.2f}",
        )
    console = new_console(width=80)
    console.print(table)
    for row in rows:
        if row.paper.jumped_share < 1.0:
            console.print(f"{row.case}: {row.paper.jumped_share:.0%} of its perturbed copies jump under `paper`")
