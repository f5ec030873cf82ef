"""``init``: a study file to start from."""

import textwrap
import tomllib
from pathlib import Path

import click

from pareto_monoped.cli import completing
from pareto_monoped.cli.options import Local
from pareto_monoped.cli.terminal import echo


@click.command()
@click.argument("name", metavar="[STUDY]", required=False, shell_complete=completing.studies)
@click.option("-o", "--output", type=Local(), metavar="FILE.toml", help="The copy.  [default: STUDY.toml]")
@click.option("--list", "listed", is_flag=True, help="List the studies that there are.")
@click.option("--force", is_flag=True, help="Replace an existing study file.")
def init(name: str | None, output: Path | None, listed: bool, force: bool) -> None:
    """Copy a study file that comes with the program, to start from.

    Without a name it is case_c, the paper's best design with all seven variables free; wide shows every key.
    """
    from pareto_monoped.study.shipped import START, shipped_studies, shipped_study

    if listed:
        for study in shipped_studies():
            line = f"{study:<16} {tomllib.loads(shipped_study(study)).get('description', '')}"
            echo(textwrap.fill(line, width=80, subsequent_indent=" " * 17))
        return
    chosen = name or START
    write_study(chosen, output or Path(f"{chosen}.toml"), force=force)


def write_study(name: str, path: Path, *, force: bool = False) -> None:
    """Write a shipped study to a file, and say what to do with it.

    Raises:
        StudyError: there is no such study.
        OutputError: the file exists, and may have changes of the user's.
    """
    from pareto_monoped.errors import OutputError
    from pareto_monoped.files import write_text
    from pareto_monoped.study.shipped import shipped_study

    text = shipped_study(name)
    if path.exists() and not force:
        raise OutputError(f"study file {str(path)!r}: exists; give another -o, or --force to replace it")
    write_text(path, text, force=force)
    echo(f"wrote {path}; run it with: pareto-monoped run {path}", err=True)
