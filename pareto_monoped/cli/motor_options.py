"""The options that name the motors of a robot: ``--motor`` for both joints, or ``--hip-motor`` and ``--knee-motor``."""

from collections.abc import Callable
from typing import Any

import click

from pareto_monoped.cli import completing
from pareto_monoped.design import PAPER_MOTOR


def motor_options(prefix: str = "") -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Options ``--motor``, ``--hip-motor`` and ``--knee-motor`` of a command; ``chosen_motors`` reads them.

    Args:
        prefix: of their help texts.
    """
    both = click.option(
        "--motor",
        metavar="NAME",
        shell_complete=completing.motors,
        help=f"{prefix}Name or TOML file.  [default: {PAPER_MOTOR}]",
    )
    hip = click.option(
        "--hip-motor",
        metavar="NAME",
        shell_complete=completing.motors,
        help=f"{prefix}The hip's, with --knee-motor instead of --motor.",
    )
    knee = click.option(
        "--knee-motor", metavar="NAME", shell_complete=completing.motors, help=f"{prefix}The knee's, with --hip-motor."
    )
    return lambda command: both(hip(knee(command)))


def chosen_motors(motor: str | None, hip_motor: str | None, knee_motor: str | None) -> tuple[str, str]:
    """Names or files of the hip's and the knee's motor.

    Raises:
        click.UsageError: one joint's alone, or ``--motor`` beside them.
    """
    if hip_motor is None and knee_motor is None:
        return motor or PAPER_MOTOR, motor or PAPER_MOTOR
    if motor is not None:
        raise click.UsageError("--motor stands for both joints; drop it, or --hip-motor and --knee-motor")
    if hip_motor is None or knee_motor is None:
        missing = "--knee-motor" if knee_motor is None else "--hip-motor"
        raise click.UsageError(f"{missing} is missing; name both joints' motors, or one for both with --motor")
    return hip_motor, knee_motor
