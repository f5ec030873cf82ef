"""Lettering: Helvetica, which every PDF reader has, and how wide its letters are.

Heights are those of capital letters, as in ISO 3098-1.
"""

from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

CAPITAL = 0.718
"""Height of capitals over font size (Adobe's font metrics of Helvetica, ``CapHeight``)."""
DESCENT = 0.207
"""How far letters reach below their line, over font size (``Descender``)."""
_METRICS = "mpl-data/fonts/pdfcorefonts/Helvetica.afm"  # Matplotlib ships Adobe's file
TIMES = "\N{MULTIPLICATION SIGN}"
"""Between numbers, as in ``6 x 8`` (ISO 129-1)."""
_OTHERS = {"Ø": "Oslash", "°": "degree", "±": "plusminus", TIMES: "multiply", "µ": "mu", "'": "quotesingle"}


def width_mm(text: str, height_mm: float) -> float:
    """Width of a line of text.

    Raises:
        ValueError: a letter that the drawings do not use.
    """
    widths = _widths()
    unknown = [letter for letter in text if letter not in widths]
    if unknown:
        raise ValueError(f"no width for {unknown[0]!r} in {text!r}")
    return sum(widths[letter] for letter in text) * height_mm / CAPITAL


@lru_cache(maxsize=1)
def _widths() -> dict[str, float]:
    """Widths over font size, by letter: ASCII and a few signs of drawings."""
    spec = find_spec("matplotlib")
    assert spec is not None
    assert spec.submodule_search_locations is not None
    lines = (Path(spec.submodule_search_locations[0]) / _METRICS).read_text(encoding="latin-1").splitlines()
    widths: dict[str, float] = {}
    names = {name: letter for letter, name in _OTHERS.items()}
    for line in lines:
        if not line.startswith("C "):
            continue
        # C 65 ; WX 667 ; N A ; B 14 0 654 718 ;
        code, width, name = (field.split()[1] for field in line.split(";")[:3])
        letter = names.get(name) or (chr(int(code)) if 32 <= int(code) < 127 and int(code) != ord("'") else None)
        if letter is not None:
            widths[letter] = float(width) / 1000.0
    return widths
