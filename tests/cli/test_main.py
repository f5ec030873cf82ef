import re
import shlex
import subprocess
import sys
from importlib import metadata

import click
import pytest

from pareto_monoped import __version__, cli
from pareto_monoped.errors import CheckError, DesignError


def run(monkeypatch, capsys, failure):
    """What the program prints, and its exit code, when a command raises ``failure``."""

    @click.command()
    def failing():
        raise failure

    monkeypatch.setattr(cli._Commands, "get_command", lambda *_: failing)
    with pytest.raises(SystemExit) as caught:
        cli.main(["simulate"])
    return caught.value.code, capsys.readouterr()


@pytest.mark.parametrize(
    ("failure", "code"),
    [
        (DesignError("knee_ratio = 3: must be 4 to 8.7; choose one"), 2),
        (CheckError("sun and planet overlap by 2 mm3"), 1),
        (click.UsageError("no such thing"), 2),
        (KeyboardInterrupt(), 130),
        (click.Abort(), 130),
    ],
)
def test_failures_are_one_line_on_stderr_with_their_code(monkeypatch, capsys, failure, code):
    got, output = run(monkeypatch, capsys, failure)
    assert got == code
    assert output.out == ""
    assert len(output.err.strip().splitlines()) == 1
    assert "Traceback" not in output.err


def test_an_unknown_command_is_one_line():
    result = subprocess.run(
        [sys.executable, "-m", "pareto_monoped", "jmup"], capture_output=True, text=True, check=False
    )
    assert result.returncode == 2
    assert result.stderr.count("\n") == 1
    assert "jmup" in result.stderr


@pytest.mark.parametrize(
    ("typed", "meant"),
    [("simulat", "simulate"), ("exprot", "export"), ("reports", "report"), ("jmup", "must be one of")],
)
def test_a_misspelt_command_is_told_the_right_one(typed, meant, capsys):
    assert cli._run([typed]) == 2
    said = capsys.readouterr().err
    assert f"{typed!r}: is unknown" in said
    assert meant in said


def test_a_call_without_a_command_prints_the_help(capsys):
    """It ended with an error whose one line was the whole help."""
    assert cli._run([]) == 0
    bare = capsys.readouterr()
    assert cli._run(["--help"]) == 0
    assert bare.out == capsys.readouterr().out
    assert bare.err == ""


def test_no_summary_of_a_command_is_cut_off(capsys):
    assert cli._run([]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    assert [line for line in lines[1:] if line.endswith("...")] == []


@pytest.mark.parametrize("command", list(cli._COMMANDS))
def test_the_help_of_a_command_fits_and_names_what_it_takes(command, capsys):
    """Every option with a value says what value, in capitals or as a choice."""
    assert cli._run([command, "--help"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    for word in ("PATH", "TEXT", "FLOAT", "INTEGER RANGE", "FILENAME"):
        assert not any(f" {word} " in f"{line} " for line in lines if line.lstrip().startswith("-")), word


def test_version():
    result = subprocess.run(
        [sys.executable, "-m", "pareto_monoped", "--version"], capture_output=True, text=True, check=True
    )
    first, second = result.stdout.splitlines()
    assert first == f"pareto-monoped {__version__}"
    for package in ("mujoco", "optuna", "numpy"):
        assert f"{package} {metadata.version(package)}" in second
    assert max(len(first), len(second)) <= 80


def test_a_closed_pipe_is_no_error():
    result = subprocess.run(
        f"{shlex.quote(sys.executable)} -m pareto_monoped --help | head -n 1",
        shell=True,
        capture_output=True,
        text=True,
        check=True,
    )
    assert result.stderr == ""
    assert result.stdout.startswith("Usage: pareto-monoped")


@pytest.mark.parametrize("command", sorted(cli._COMMANDS))
def test_help_fits_80_columns(capsys, monkeypatch, command):
    monkeypatch.setenv("COLUMNS", "120")
    with pytest.raises(SystemExit) as caught:
        cli.main([command, "--help"])
    assert caught.value.code == 0
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80


def test_a_usage_error_points_to_the_help_of_its_command(capsys):
    with pytest.raises(SystemExit) as caught:
        cli.main(["pick", "x.db", "--nonsense"])
    assert caught.value.code == 2
    assert "(see 'pareto-monoped pick --help')" in capsys.readouterr().err


METAVARS = {
    # Numbers: a count or number of something, a value, metres, joules, degrees, percent.
    "N", "X", "M", "J", "DEG", "PERCENT",
    # Names, in lists with commas where there are several; with a value; the weights of two objectives.
    "NAME", "A,B", "NAME=X", "NAME=X,...", "WH,WE",
    # A study by name, files, a database, a folder, a loss and a series of a leg, a file in a format of one's choice.
    "STUDY", "STUDY.toml", "CAMPAIGN.toml", "DB", "DIR", "FILE", "LEG.toml", "DESIGN", "TERM", "SERIES",
    "ADDRESS",  # of a scheduler
    "HASH",
}  # fmt: skip
PLAIN = re.compile(r"FILE\.(csv|gif|html|json|mp4|parquet|toml|xml)|DB \[DB \.\.\.\]")


def parameters():
    """Command, option or argument, and what stands for its value in the help; None for a flag."""
    context = click.Context(cli.cli)
    for name in cli._COMMANDS:
        for one in cli.cli.get_command(context, name).params:
            choice = isinstance(one.type, click.Choice)
            flag = isinstance(one, click.Option) and one.is_flag
            shown = None if flag or choice else one.make_metavar(context).removeprefix("[").removesuffix("]")
            yield name, one.opts[-1], shown


def test_values_are_called_the_same_in_all_commands():
    """One word for one kind of value, and one word for one option."""
    seen = {}
    for command, option, shown in parameters():
        if shown is None:
            continue
        if not PLAIN.fullmatch(shown.replace("[DB ...", "[DB ...]").replace("]]", "]")):
            assert shown in METAVARS, f"{command} {option}"
        # The most designs of a front, or the most of a measure.
        if option.startswith("--") and option not in ("--output", "--most"):
            assert seen.setdefault(option, shown) == shown, f"{command} {option}"


def test_every_option_says_what_it_does():
    context = click.Context(cli.cli)
    commands = [cli.cli.get_command(context, name) for name in cli._COMMANDS]
    options = [one for command in commands for one in command.params if isinstance(one, click.Option)]
    assert [one.name for one in options if not one.help or one.help.lstrip().startswith("[")] == []


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["simulate", "--cse", "C"], "option '--cse': is unknown; did you mean '--case'?"),
        (["simulate", "--zzzz"], "option '--zzzz': is unknown; drop it"),
        (["pick", "x.db", "--trial", "abc"], "'abc' is no whole number."),
        (["actuators", "--ratio", "six"], "'six' is no number."),
        (["pick", "x.db", "--trial"], "requires an argument. (see 'pareto-monoped"),
        (["actuators", "--without", "sunrim"], "did you mean 'sun_rim'?"),
        (["simulate", "--set", "knee_rato=5"], "did you mean 'knee_ratio'?"),
        (["init", "quik"], "did you mean 'quick'?"),
        (["simulate", "--motor", "vt8021"], "did you mean 'VT8020'?"),
    ],
)
def test_a_slip_of_the_fingers_is_told_what_was_meant(words, said, capsys):
    assert cli._run(words) == 2
    line = capsys.readouterr().err
    assert said in line
    assert line.count("\n") == 1


def test_the_help_groups_all_commands_in_the_order_of_use_and_its_examples_are_commands(capsys):
    assert cli._run(["--help"]) == 0
    shown = capsys.readouterr().out
    assert [line[:-1] for line in shown.splitlines() if line.endswith(":") and not line.startswith((" ", "Usage"))] == [
        "Options", *cli._GROUPS, "Examples",
    ]  # fmt: skip
    assert max(map(len, shown.splitlines())) <= 80
    # Not the examples, which begin with a dollar or a hash.
    listed = [line.split()[0] for line in shown.partition("Begin:")[2].splitlines() if re.match(r"  [a-z]", line)]
    assert listed == list(cli._COMMANDS)
    examples = [line.split() for line in shown.splitlines() if line.startswith("  $ ")]
    assert len(examples) > 4
    for _, program, command, *words in examples:
        assert program == "pareto-monoped"
        context = cli.cli.get_command(None, command).make_context(command, words)  # refuses unknown options and words
        assert context.args == []
