"""What stands on a sheet: lines, filled areas and text, in millimetres of paper from the lower left corner.

Line types and widths follow ISO 128-2: wide lines of 0.5 mm for visible edges, narrow ones of 0.25 mm for the rest.
Lettering is Helvetica, which every PDF reader has; heights are those of capital letters, as in ISO 3098-1.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

CAPITAL = 0.718  #: Height of capitals over font size (Adobe's font metrics of Helvetica, ``CapHeight``).
DESCENT = 0.207  #: How far letters reach below their line, over font size (``Descender``).
_METRICS = "mpl-data/fonts/pdfcorefonts/Helvetica.afm"  # Matplotlib ships Adobe's file
TIMES = "\N{MULTIPLICATION SIGN}"  #: Between numbers, as in ``6 x 8`` (ISO 129-1).
_OTHERS = {"Ø": "Oslash", "°": "degree", "±": "plusminus", TIMES: "multiply", "µ": "mu", "'": "quotesingle"}


def width_mm(text: str, height_mm: float) -> float:
    """Return the width of a line of text; ``ValueError`` for a letter that the drawings do not use."""
    widths = _widths()
    unknown = [letter for letter in text if letter not in widths]
    if unknown:
        raise ValueError(f"no width for {unknown[0]!r} in {text!r}")
    return sum(widths[letter] for letter in text) * height_mm / CAPITAL


@lru_cache(maxsize=1)
def _widths() -> dict[str, float]:
    """Return widths over font size, by letter: ASCII and a few signs of drawings."""
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


Points = NDArray[np.float64]
Align = Literal["left", "centre", "right"]

WIDE_MM, NARROW_MM = 0.5, 0.25
SOLID: tuple[float, ...] = ()
DASHED = (2.5, 1.0)
CHAIN = (6.0, 1.0, 0.6, 1.0)  #: Long-dashed dotted: centre lines, pitch circles.
LETTER_MM = 2.5  #: Height of dimensions and notes (ISO 3098-1, nominal size 2.5).
LINE_PITCH = 1.6  #: Distance of lines of text over their height (ISO 3098-1 asks for at least 1.4 without accents).
ARROW_MM = 2.5
_ARROW_HALF_MM = 0.4
_CHORD_MM = 0.01  # a circle on paper is a polygon that stays this close to it


@dataclass(frozen=True, slots=True, kw_only=True)
class Stroke:
    """A line through points, shape (n, 2)."""

    points: Points
    width_mm: float = NARROW_MM
    dashes: tuple[float, ...] = SOLID
    closed: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Fill:
    """A black area within points, shape (n, 2)."""

    points: Points


@dataclass(frozen=True, slots=True, kw_only=True)
class Label:
    """A line of text."""

    text: str
    x: float  #: of the end that ``align`` names
    y: float  #: of the base line
    height_mm: float = LETTER_MM  #: of its capitals
    align: Align = "left"
    upward: bool = False  #: whether it runs upward, to be read from the right

    def start(self) -> tuple[float, float]:
        """Return where the first letter begins."""
        back = {"left": 0.0, "centre": 0.5, "right": 1.0}[self.align] * width_mm(self.text, self.height_mm)
        return (self.x, self.y - back) if self.upward else (self.x - back, self.y)

    def box(self) -> tuple[float, float, float, float]:
        """Return what it covers: least x and y, greatest x and y."""
        x, y = self.start()
        long, below = width_mm(self.text, self.height_mm), DESCENT / CAPITAL * self.height_mm
        if self.upward:
            return (x - self.height_mm, y, x + below, y + long)
        return (x, y - below, x + long, y + self.height_mm)


@dataclass(slots=True)
class Paper:
    """A drawing that grows; views are drawn on papers of their own, which are then laid on the sheet."""

    strokes: list[Stroke] = field(default_factory=list)
    fills: list[Fill] = field(default_factory=list)
    labels: list[Label] = field(default_factory=list)

    def line(
        self,
        points: Sequence[tuple[float, float]] | Points,
        *,
        width_mm: float = NARROW_MM,
        dashes: tuple[float, ...] = SOLID,
        closed: bool = False,
    ) -> None:
        """Draw a line through points."""
        at = np.asarray(points, dtype=np.float64)
        self.strokes.append(Stroke(points=at, width_mm=width_mm, dashes=dashes, closed=closed))

    def fill(self, points: Points) -> None:
        """Draw a black area."""
        self.fills.append(Fill(points=points))

    def circle(
        self, x: float, y: float, radius: float, *, width_mm: float = NARROW_MM, dashes: tuple[float, ...] = SOLID
    ) -> None:
        """Draw a full circle."""
        self.line(circle_points(x, y, radius), width_mm=width_mm, dashes=dashes, closed=True)

    def text(
        self,
        text: str,
        x: float,
        y: float,
        *,
        height_mm: float = LETTER_MM,
        align: Align = "left",
        upward: bool = False,
    ) -> None:
        """Write a line of text; nothing for an empty one."""
        if text:
            self.labels.append(Label(text=text, x=x, y=y, height_mm=height_mm, align=align, upward=upward))

    def arrow(self, x: float, y: float, towards: tuple[float, float]) -> None:
        """Draw a filled arrow head whose tip is at (x, y) and points along ``towards``."""
        along = np.asarray(towards, dtype=np.float64)
        along /= np.hypot(*along)
        back = np.array([x, y]) - ARROW_MM * along
        across = _ARROW_HALF_MM * np.array([-along[1], along[0]])
        self.fills.append(Fill(points=np.array([[x, y], back + across, back - across])))

    def centre_mark(self, x: float, y: float, reach: float) -> None:
        """Draw the two centre lines of a circle, which reach so far from its centre."""
        self.line([(x - reach, y), (x + reach, y)], dashes=CHAIN)
        self.line([(x, y - reach), (x, y + reach)], dashes=CHAIN)

    def lay(self, other: "Paper", dx: float = 0.0, dy: float = 0.0) -> None:
        """Add everything of another paper, moved by (dx, dy)."""
        by = np.array([dx, dy])
        self.strokes += [replace(stroke, points=stroke.points + by) for stroke in other.strokes]
        self.fills += [Fill(points=fill.points + by) for fill in other.fills]
        self.labels += [replace(label, x=label.x + dx, y=label.y + dy) for label in other.labels]

    def box(self) -> tuple[float, float, float, float]:
        """Return what it covers: least x and y, greatest x and y; zeros for an empty paper."""
        corners = [*(stroke.points for stroke in self.strokes), *(fill.points for fill in self.fills)]
        corners += [np.reshape(label.box(), (2, 2)) for label in self.labels]
        if not corners:
            return (0.0, 0.0, 0.0, 0.0)
        low, high = np.min([c.min(axis=0) for c in corners], axis=0), np.max([c.max(axis=0) for c in corners], axis=0)
        return (float(low[0]), float(low[1]), float(high[0]), float(high[1]))


def circle_points(x: float, y: float, radius: float) -> Points:
    """Return points around a circle, close enough for the eye."""
    step = 2.0 * np.arccos(1.0 - min(_CHORD_MM / max(radius, 1e-9), 0.3))
    angles = np.linspace(0.0, 2.0 * np.pi, int(np.ceil(2.0 * np.pi / step)), endpoint=False)
    return np.stack([x + radius * np.cos(angles), y + radius * np.sin(angles)], axis=1)


def overlapping(labels: Iterable[Label], clearance_mm: float = 0.0) -> list[tuple[Label, Label]]:
    """Return pairs of labels whose boxes come closer than the clearance."""
    all_labels = list(labels)
    if len(all_labels) < 2:
        return []
    boxes = np.array([label.box() for label in all_labels])
    low, high = boxes[:, :2] - 0.5 * clearance_mm, boxes[:, 2:] + 0.5 * clearance_mm
    meet = np.all((low[:, None] < high[None]) & (low[None] < high[:, None]), axis=2)
    first, second = np.nonzero(np.triu(meet, 1))
    return [(all_labels[a], all_labels[b]) for a, b in zip(first.tolist(), second.tolist(), strict=True)]
