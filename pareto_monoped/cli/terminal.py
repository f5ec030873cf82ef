r"""All that a command prints goes through here, so that no name in a file or database can steer the terminal.

Characters that a terminal obeys or hides (control characters, changes of writing direction, halves of characters) are
shown as escapes, such as ``\u001b``, which are also valid in JSON.
"""

import re
import textwrap
import unicodedata
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from rich.console import Console

_UNUSUAL = re.compile(r"[^\n\t -~]")
_BREAKS = {"\n": "\\n", "\t": "\\t"}


def plain(text: object) -> str:
    """Return the text with everything escaped that a terminal would obey or hide; line breaks and tabs stay."""
    return _UNUSUAL.sub(_escaped, str(text))


def _escaped(found: re.Match[str]) -> str:
    letter = found[0]
    if letter.isprintable() or unicodedata.category(letter) == "Zs":
        return letter
    return f"\\u{ord(letter):04x}" if ord(letter) <= 0xFFFF else f"\\U{ord(letter):08x}"


def name(text: object) -> str:
    """Return a name or a path for a line of output: as ``plain``, and line breaks and tabs are escaped, too."""
    return "".join(_BREAKS.get(letter, letter) for letter in plain(text))


def echo(text: object = "", *, err: bool = False, nl: bool = True) -> None:
    """Print text, escaped as by ``plain``. A message that nobody can read any more ends no command."""
    try:
        click.echo(plain(text), err=err, nl=nl)
    except OSError:
        if not err:
            raise


WIDTH = 80  #: Letters per line of everything that is printed.


def wrapped(text: str, indent: int = 2) -> str:
    """Return a sentence in lines of at most ``WIDTH`` letters; a number and its percent sign stay together."""
    filled = textwrap.fill(
        text.replace(" %", "\u00a0%"),
        width=WIDTH,
        subsequent_indent=" " * indent,
        break_on_hyphens=False,
        drop_whitespace=True,
        break_long_words=False,
    )
    return filled.replace("\u00a0%", " %")


def note(text: str) -> None:
    """Print what a user should know besides the result."""
    echo(wrapped(f"note: {name(text)}"), err=True)


def new_console(**options: Any) -> "Console":
    """Return a console for tables: text is printed as it is, escaped as by ``plain``, without markup or emoji codes."""
    from rich.console import Console

    class Plain(Console):
        """Every text that is not styled already passes through ``render_str``."""

        def render_str(self, text: str, **given: Any) -> Any:
            return super().render_str(plain(text), **given)

    return Plain(**{"highlight": False, "markup": False, "emoji": False} | options)
