"""What a page says in words, and the numbers of its tables and console blocks, to hold one against the other."""

import re
from collections.abc import Callable, Iterable, Iterator

import pandas as pd

from tests.docs.scripts import ROOT, rows

Told = Callable[[], Iterator[str]]


def said(page: str) -> str:
    """The running text of a page in one line: without comments, blocks and tables."""
    text = (ROOT / page).read_text(encoding="utf-8")
    text = re.sub(r"^```.*?^```$|<!--.*?-->|^\|[^\n]*$", "", text, flags=re.S | re.M)
    return " ".join(text.split())


def untold(page: str, sentences: Iterable[str]) -> list[str]:
    """Those sentences, with the numbers that they should have, which the page does not say; rows have bars."""
    text, whole = said(page), " ".join((ROOT / page).read_text(encoding="utf-8").split())
    return [sentence for sentence in sentences if sentence not in (whole if "|" in sentence else text)]


def given(page: str, script: str, option: str) -> int:
    """The number that a page gives to an option of a script, the same wherever it names both."""
    (number,) = set(re.findall(rf"{re.escape(script)}.* --{option} (\d+)", (ROOT / page).read_text(encoding="utf-8")))
    return int(number)


def table(page: str, *titles: str) -> pd.DataFrame:
    """The first table of a page that has these titles; columns of numbers alone are numbers."""
    for found in re.findall(r"(?:^\|.*\n)+", (ROOT / page).read_text(encoding="utf-8"), re.M):
        head, *cells = rows(found)
        if set(titles) <= set(head):
            return pd.DataFrame(cells, columns=head).apply(_numbers)
    raise LookupError(f"{page} has no table with the titles {titles}")


def _numbers(column: pd.Series) -> pd.Series:
    found = pd.to_numeric(column.str.replace(",", ""), errors="coerce")
    return column if found.isna().any() else found


def firsts(cells: Iterable[str]) -> pd.Series:
    """The first number of each cell, such as 2.5 of "2.5 (2.3 to 2.8)"."""
    return pd.Series([float(re.findall(r"[-+]?\d+(?:\.\d+)?", cell)[0]) for cell in cells])


def shown(page: str, start: str) -> list[float]:
    """The numbers of the first line of a console block that begins like this, after its beginning."""
    rest = re.findall(rf"^ *{re.escape(start)}(.*)$", (ROOT / page).read_text(encoding="utf-8"), re.M)[0]
    return [float(number) for number in re.findall(r"[-+]?\d+(?:\.\d+)?", rest)]


def between(values: Iterable[float], digits: int = 0) -> str:
    """The least and the greatest: "3.0 to 3.6"."""
    kept = list(values)
    return f"{min(kept):.{digits}f} to {max(kept):.{digits}f}"


def mm(metres: float) -> str:
    """A length as "0.3 mm"."""
    return f"{1e3 * metres:g} mm"


def percent(share: float) -> str:
    """A share as "5 percent"."""
    return f"{100.0 * share:g} percent"
