"""Scripts of ``benchmarks`` whose tables stand on a page."""

import importlib
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

ROOT = Path(__file__).parents[2]


@contextmanager
def imported(name: str) -> Iterator[ModuleType]:
    """A script as a module; scripts import each other."""
    sys.path.insert(0, str(ROOT / "benchmarks"))
    try:
        yield importlib.import_module(name)
    finally:
        sys.path.remove(str(ROOT / "benchmarks"))


def rows(text: str) -> list[list[str]]:
    """The cells of a table in Markdown, row by row."""
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if "--" not in line]
