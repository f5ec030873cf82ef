"""Options that several commands share."""

from pathlib import Path

import click

force_option = click.option("--force", is_flag=True, help="Replace files of another kind; a study is never replaced.")
workers_option = click.option(
    "--workers", type=click.IntRange(1, 1024), metavar="N", help="Number of threads.  [default: all cores]"
)
sample_seed_option = click.option(
    "--seed", type=click.IntRange(min=0), metavar="N", help="Of the samples.  [default: the study's, or 1]"
)
uncertainty_option = click.option(
    "--uncertainty",
    type=click.Path(path_type=Path),
    metavar="FILE.toml",
    help="TOML file of ranges, instead of the study's or ours.",
)
