"""Make the figures of README and docs again, once a change of the machine has moved them.

A table that stands below a comment ``<!-- made by: COMMAND -->`` gets the rows of the table with the same titles that
the command prints; a table of times alone stands below ``<!-- timed by: COMMAND -->`` and stays. In a block that starts
with ```console, each line below ``$ command`` gets the numbers that the command prints now. Words are never changed: a
line whose words are printed no more is named, and is yours to mend.

    python tools/documented.py [--tables | --outputs] [--check] [PAGE ...]

With ``--check`` nothing is written, and what would change is an error: so CI compares every figure, to its last digit,
under the versions of constraints.txt.
"""

import argparse
import difflib
import functools
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from pareto_monoped.files import write_text

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *(path for room in ("docs", "benchmarks") for path in sorted((ROOT / room).glob("*.md")))]
TABLE = re.compile(r"(<!-- made by: (.+?) -->\n)((?:\|.*\n)+)")
CONSOLE = re.compile(r"(?<=^```console\n).*?(?=^```)", re.S | re.M)
MADE_BY = {"make pareto": "pareto-monoped pareto"}  #: Targets of make that print figures, and what they run.
TIMED = {"speed", "own s / 1,000", "its time"}  #: Columns of times; a check passes over them.
CLOCK = re.compile(r"\b\d+(?:\.\d+)? s\b")  #: How long something took, which is as true as any other time.
#: The machine's best vector instructions change last digits; these are those of every x86-64 since 2013.
PLAIN = {
    "NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL AVX512_SPR",
    "OPENBLAS_CORETYPE": "Haswell",
    "NUMBA_CPU_NAME": "haswell",
}
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


@functools.cache
def printed(command: str, folder: Path) -> str:
    """What a command prints on stdout; it runs once per folder, with this interpreter and checkout.

    Raises:
        SystemExit: the command fails.
    """
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = os.environ | {"PATH": path, "COLUMNS": "80", "PYTHONPATH": str(ROOT)} | PLAIN
    print(f"$ {command}", file=sys.stderr)
    done = subprocess.run(
        command, shell=True, cwd=folder, env=environment, stdout=subprocess.PIPE, text=True, check=False
    )
    if done.returncode:
        sys.exit(f"error: '{command}' exits {done.returncode}; mend it first")
    return done.stdout


def with_tables(page: str, *, timed: bool = True) -> tuple[str, list[str]]:
    """The page with the rows of today in its marked tables, and what could not be made again; times only if asked."""
    faults: list[str] = []

    def again(found: re.Match[str]) -> str:
        comment, command, table = found.groups()
        titles = _cells(table.splitlines()[0])
        for other in re.findall(r"(?:^\|.*\n)+", printed(command, ROOT), re.M):
            if _cells(other.splitlines()[0]) == titles:
                old, rows = table.splitlines()[2:], other.splitlines()[2:]
                if not timed and TIMED & set(titles) and len(old) == len(rows):
                    rows = [_as_timed(titles, *pair) for pair in zip(old, rows, strict=True)]
                return str(comment) + "\n".join([*table.splitlines()[:2], *rows]) + "\n"
        faults.append(f"'{command}' prints no table with the titles {' | '.join(titles)}")
        return str(found.group())

    return TABLE.sub(again, page), faults


def with_outputs(page: str, folder: Path) -> tuple[str, list[str]]:
    """The page with the numbers of today in its console blocks, and the lines that are printed no more."""
    faults: list[str] = []

    def again(found: re.Match[str]) -> str:
        lines: list[str] = []
        for command, shown in _commands(found.group()):
            lines.append(f"$ {command}")
            meant = MADE_BY.get(command, command)
            if meant.startswith("make "):
                lines += shown
                continue
            if not shown and command in MADE_BY:  # it would run for a minute, for nothing
                continue
            new, missed = like(shown, [line for line in printed(meant, folder).splitlines() if line.strip()])
            pairs = zip(shown, new, strict=True)
            new = [old if _timeless(old) == _timeless(now) else now for old, now in pairs]
            lines += new
            faults.extend(f"'{command}' no longer prints: {line}" for line in missed)
        return "\n".join(lines) + "\n"

    return CONSOLE.sub(again, page), faults


def like(shown: list[str], printed: list[str]) -> tuple[list[str], list[str]]:
    """The lines shown, as they are printed now, and those whose words are not printed.

    Lines between two ``...`` follow each other. After a ``...`` they stand where the words agree and the numbers are
    closest to those shown.
    """
    new: list[str] = []
    missed: list[str] = []
    position, free = 0, False
    for piece in _pieces(shown):
        if piece == ["..."]:
            new, free = [*new, "..."], True
            continue
        texts = [line for line in piece if line.strip()]
        last = len(printed) - len(texts) if free else position
        places = [
            at
            for at in range(position, last + 1)
            if len(printed) - at >= len(texts)
            and all(_words(a) == _words(b) for a, b in zip(texts, printed[at:], strict=False))
        ]
        if not places:
            new, missed = new + piece, missed + texts[:1]
            continue
        at = min(places, key=lambda at: sum(_apart(a, b) for a, b in zip(texts, printed[at:], strict=False)))
        found = iter(printed[at : at + len(texts)])
        new += [next(found).rstrip() if line.strip() else line for line in piece]
        position, free = at + len(texts), False
    return new, missed


def _pieces(lines: list[str]) -> Iterator[list[str]]:
    piece: list[str] = []
    for line in lines:
        if line.strip() == "...":
            if piece:
                yield piece
            yield ["..."]
            piece = []
        else:
            piece.append(line)
    if piece:
        yield piece


def _commands(block: str) -> list[tuple[str, list[str]]]:
    found: list[tuple[str, list[str]]] = []
    for line in block.splitlines():
        if line.startswith("$ "):
            found.append((line[2:], []))
        else:
            found[-1][1].append(line)
    return found


def _cells(row: str) -> list[str]:
    return [cell.strip() for cell in row.strip().strip("|").split("|")]


def _as_timed(titles: list[str], old: str, new: str) -> str:
    """The new row with the times of the old one."""
    cells = [was if title in TIMED else now for title, was, now in zip(titles, _cells(old), _cells(new), strict=True)]
    return f"| {' | '.join(cells)} |"


def _timeless(line: str) -> list[str]:
    return CLOCK.sub("#", line).split()


def _words(line: str) -> list[str]:
    return NUMBER.sub("#", line).split()


def _apart(shown: str, printed: str) -> float:
    """Sum of the relative differences of two lines' numbers."""
    pairs = zip(map(float, NUMBER.findall(shown)), map(float, NUMBER.findall(printed)), strict=True)
    return sum(abs(a - b) / max(abs(a), abs(b), 1e-12) for a, b in pairs)


def main() -> None:
    """Rewrite the pages; exit 1 if something could not be made again."""
    parser = argparse.ArgumentParser(description="Make the figures of README and docs again.")
    parser.add_argument("pages", nargs="*", type=Path, help="default: README.md, docs/*.md, benchmarks/*.md")
    only = parser.add_mutually_exclusive_group()
    only.add_argument("--tables", action="store_true", help="only the marked tables")
    only.add_argument("--outputs", action="store_true", help="only what commands print")
    parser.add_argument("--check", action="store_true", help="write nothing; exit 1 if a figure would change")
    asked = parser.parse_args()
    faults = []
    with tempfile.TemporaryDirectory() as scratch:
        for page in asked.pages or PAGES:
            folder = Path(scratch) / page.parent.name / page.stem
            shutil.copytree(ROOT / "studies", folder / "studies", ignore=shutil.ignore_patterns("*.db*"))
            shutil.copytree(ROOT / "examples" / "legs", folder / "examples" / "legs")
            (folder / "reports").mkdir()
            text = page.read_text(encoding="utf-8")
            if not asked.outputs:
                text, missed = with_tables(text, timed=not asked.check)
                faults += [f"{page.name}: {fault}" for fault in missed]
            if not asked.tables:
                text, missed = with_outputs(text, folder)
                faults += [f"{page.name}: {fault}" for fault in missed]
            if asked.check:
                old = page.read_text(encoding="utf-8").splitlines()
                changes = difflib.ndiff(old, text.splitlines())
                faults += [f"{page.name}: {line}" for line in changes if line.startswith(("- ", "+ "))]
            else:
                write_text(page, text)
    print("\n".join(faults))
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
