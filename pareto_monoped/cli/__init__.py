"""The command line: parse, call, print.

Numbers go to stdout, messages and progress to stderr. Bad input ends with one line and exit code 2, a failure while
running with 1, an interrupt with 130.

Order of imports, lowest first: actuator_sheets, terminal; options, process, watching; actuators, campaign, jumps,
machines, selection, stored, studies; exports, fronts, limit, pareto, robustness.
"""

import difflib
import sys

import click

from pareto_monoped import __version__

#: Title of a group -> its commands, each with the module of this package that defines it, in the order of use.
_GROUPS = {
    "Begin": {"pareto": "pareto", "init": "pareto"},
    "Gearboxes and jumps": {"actuators": "actuators", "simulate": "jumps", "table1": "jumps"},
    "Studies": {"run": "studies", "resume": "studies", "status": "studies", "campaign": "campaign"},
    "Choose": {
        "front": "fronts", "pick": "fronts", "robust": "robustness", "sensitivity": "robustness", "limit": "limit",
        "report": "stored", "dashboard": "stored", "trials": "stored",
    },
    "Build": {"export": "exports"},
    "Check": {"replay": "machines", "compare": "machines", "verify": "stored", "repair": "stored"},
}  # fmt: skip
_COMMANDS = {command: module for group in _GROUPS.values() for command, module in group.items()}
_EXAMPLES = (
    ("a first study, and its front", "pareto-monoped init quick", "pareto-monoped run quick.toml"),
    ("the least energy that reaches 0.9 m", "pareto-monoped pick quick.db --min-height 0.9"),
    ("a page to choose from", "pareto-monoped report quick.db -o quick.html"),
    ("CAD of the knee of the front", "pareto-monoped export quick.db --knee -o knee"),
)


class _Commands(click.Group):
    """Lists commands in the order of use and imports a command's module only when the command is needed."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(_COMMANDS)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands by groups, their words in one column, and examples below."""
        width = max(map(len, _COMMANDS))
        for title, group in _GROUPS.items():
            commands = ((name, self.get_command(ctx, name)) for name in group)
            room = formatter.width - width - 4
            rows = [(f"{name:<{width}}", command.get_short_help_str(room)) for name, command in commands if command]
            with formatter.section(title):
                formatter.write_dl(rows)
        with formatter.section("Examples"):
            for words, *lines in _EXAMPLES:
                formatter.write_text(f"# {words}")
                for line in lines:
                    formatter.write_text(f"$ {line}")
        formatter.write_paragraph()
        formatter.write_text("'pareto-monoped COMMAND --help' has the options of a command.")

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        module_name = _COMMANDS.get(cmd_name)
        if module_name is None:
            return None
        from importlib import import_module

        command: click.Command = getattr(import_module(f"pareto_monoped.cli.{module_name}"), cmd_name)
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the command, or an error that names those with a similar name."""
        if args and args[0] not in _COMMANDS and not args[0].startswith("-"):
            near = difflib.get_close_matches(args[0], _COMMANDS, n=2)
            cure = f"did you mean {' or '.join(map(repr, near))}?" if near else f"must be one of {', '.join(_COMMANDS)}"
            ctx.fail(f"command {args[0]!r}: is unknown; {cure}")
        return super().resolve_command(ctx, args)


def _show_versions(ctx: click.Context, _: click.Parameter, asked: bool) -> None:
    """Print the versions that decide a simulation or a search."""
    if not asked or ctx.resilient_parsing:
        return
    import platform
    from importlib.metadata import version

    from pareto_monoped.cli.terminal import echo

    others = [f"{package} {version(package)}" for package in ("mujoco", "optuna", "pymoo", "numpy")]
    echo(f"pareto-monoped {__version__}\nPython {platform.python_version()}, {', '.join(others)}")
    ctx.exit()


@click.group(
    cls=_Commands,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 80},
    invoke_without_command=True,
)
@click.option(
    "--version",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_show_versions,
    help="Show the versions that decide the results, and exit.",
)
@click.pass_context
def cli(ctx: click.Context) -> None:
    """Design a jumping one-legged robot: gearboxes, links and controller at once.

    A study finds the front of jump height against energy; every design on it can be exported to CAD.
    """
    if ctx.invoked_subcommand is None:
        from pareto_monoped.cli.terminal import echo

        echo(ctx.get_help())


def main(arguments: list[str] | None = None) -> None:
    """Run the command line and exit with its code: 0, 1 (failure), 2 (bad input) or 130 (interrupt).

    Without ``arguments``, the process belongs to the command: its signals and standard streams are taken care of.
    """
    if arguments is not None:
        sys.exit(_run(arguments))
    from pareto_monoped.cli import process

    with process.owned() as ended:
        ended(_run(None))


def _run(arguments: list[str] | None) -> int:
    from pareto_monoped.cli import process

    try:
        code = cli.main(args=arguments, prog_name="pareto-monoped", standalone_mode=False)
        return code if isinstance(code, int) else 0
    except (Exception, KeyboardInterrupt) as error:
        return process.report(error)
