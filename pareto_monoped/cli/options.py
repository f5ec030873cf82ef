"""Options that several commands share."""

import click

force_option = click.option("--force", is_flag=True, help="Replace files of another kind; a study is never replaced.")
