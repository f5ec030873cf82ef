"""What is written on a picture: a scale bar, numbers with leaders, and a legend in colours that all can tell apart."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.picture.drawing import Drawn

if TYPE_CHECKING:
    from PIL.ImageDraw import ImageDraw
    from PIL.ImageFont import FreeTypeFont

Colour = tuple[float, float, float]

LEAST_DISTANCE, LEAST_FOR_DEFICIENT = 24.0, 13.0
"""Between any two colours in CIELAB, for normal vision and for each deficiency: 2.3 is just noticed (Mahy et al. 1994),
13 is plain side by side, 24 also apart from each other, where five greens 17 apart were taken for each other."""

_RGB = (
    *((135, 195, 255), (255, 0, 30), (150, 60, 255), (210, 255, 0), (210, 135, 120), (225, 15, 165), (105, 255, 195)),
    *((225, 195, 90), (15, 135, 0), (195, 240, 240), (120, 120, 75), (195, 75, 210), (150, 255, 135), (195, 135, 165)),
    *((225, 30, 120), (90, 120, 120), (195, 180, 165), (120, 150, 255), (240, 180, 0), (240, 240, 90), (180, 210, 150)),
    *((210, 120, 60), (75, 120, 165), (180, 135, 210), (150, 105, 255), (225, 210, 255), (120, 180, 90), (0, 210, 210)),
)
PALETTE: tuple[Colour, ...] = tuple((r / 255.0, g / 255.0, b / 255.0) for r, g, b in _RGB)
"""The 28 colours of a grid whose least distance is greatest: the least of that for full protanopia, deuteranopia and
tritanopia (Machado et al. 2009), and of 1/1.8 of that for normal vision. Found by exchanging one colour after the other
from many random beginnings; in the order in which each is farthest from all before it. Lightness 48 to 94, so that
shading and black lines show."""

STRIP_PX = 58  #: Height of the strips above and below a picture that hold the numbers.
_BALLOON_PX = 15  # radius
_BAR_SHARE = 0.25  # greatest length of a scale bar over the picture's width
_ROW_PX = 34  # of the legend, at most
_BLACK, _GREY = (0, 0, 0), (90, 90, 90)

Image = NDArray[np.uint8]


def colour(k: int) -> Colour:
    """Return the k-th colour; they repeat after ``len(PALETTE)``, and numbers in the picture tell equal ones apart."""
    return PALETTE[k % len(PALETTE)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """A row of a legend."""

    number: int  #: as written in the picture
    text: str  #: what it is
    colour: Colour  #: in the picture


@dataclass(frozen=True, slots=True, kw_only=True)
class Balloon:
    """A number in a circle, and the point of the picture that it belongs to, in pixels to the right and down."""

    number: int
    at: tuple[float, float]
    point: tuple[float, float]


def labelled(drawn: Drawn, legend: Sequence[Row], *, legend_width: int = 330) -> Image:
    """Return the picture with a scale bar, and with numbers and a legend if there are rows; wider by the legend."""
    from PIL import Image as Pillow
    from PIL import ImageDraw

    height, width, _ = drawn.image.shape
    if not legend:
        canvas = Pillow.fromarray(drawn.image)
        _scale_bar(ImageDraw.Draw(canvas), drawn.px_per_mm, width, height)
        return np.asarray(canvas, dtype=np.uint8)
    numbers, rows = _seen(drawn.numbers, legend)
    tall = height + 2 * STRIP_PX
    canvas = Pillow.new("RGB", (width + legend_width, tall), "white")
    canvas.paste(Pillow.fromarray(drawn.image), (0, STRIP_PX))
    pen = ImageDraw.Draw(canvas)
    for balloon in balloons(numbers):
        _balloon(pen, balloon)
    _legend(pen, rows, width, tall - STRIP_PX)
    _scale_bar(pen, drawn.px_per_mm, width, tall, left=width)
    return np.asarray(canvas, dtype=np.uint8)


def _seen(numbers: NDArray[np.int64], legend: Sequence[Row]) -> tuple[NDArray[np.int64], list[Row]]:
    """Return pixels and rows with the bodies that can be seen numbered from 1."""
    seen = set(_present(numbers))
    rows = [row for row in legend if row.number in seen]
    new = np.zeros(1 + max(row.number for row in legend), dtype=np.int64)
    for k, row in enumerate(rows, 1):
        new[row.number] = k
    return new[numbers], [replace(row, number=k) for k, row in enumerate(rows, 1)]


def _present(numbers: NDArray[np.int64]) -> list[int]:
    """Return the different numbers of a picture, all of which are small, in rising order."""
    return np.flatnonzero(np.bincount(numbers.ravel())).tolist()


def bar_mm(px_per_mm: float, width_px: int) -> float:
    """Return the longest of 1, 2, 5, 10, 20, 50 ... mm that takes at most a quarter of the picture's width."""
    most = _BAR_SHARE * width_px / px_per_mm
    decade = 10.0 ** np.floor(np.log10(most))
    return float(max(step * decade for step in (1.0, 2.0, 5.0) if step * decade <= most * (1.0 + 1e-9)))


def balloons(numbers: NDArray[np.int64]) -> list[Balloon]:
    """Return where the number of each visible body goes: above or below the picture, in the order of their points.

    ``numbers`` has the number of the body at each pixel, 0 for none; shape (height, width).
    """
    height, width = numbers.shape
    inside = [(number, *_innermost(numbers == number)) for number in _present(numbers) if number]
    by_height = sorted(inside, key=lambda found: found[2])
    half = (len(by_height) + 1) // 2
    found = []
    for row, line in ((by_height[:half], 0.5 * STRIP_PX), (by_height[half:], height + 1.5 * STRIP_PX)):
        ordered = sorted(row, key=lambda found: found[1])
        places = _spread([x for _, x, _ in ordered], width)
        for at, (number, x, y) in zip(places, ordered, strict=True):
            found.append(Balloon(number=number, at=(at, line), point=(x, y + STRIP_PX)))
    return found


def _innermost(mask: NDArray[np.bool_]) -> tuple[float, float]:
    """Return the point of a region that is farthest from its edge: to the right and down, in pixels."""
    from scipy.ndimage import distance_transform_cdt

    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    top, left = int(rows[0]), int(columns[0])
    # Only the box around the region, with an empty edge, is measured.
    box = np.pad(mask[top : int(rows[-1]) + 1, left : int(columns[-1]) + 1], 1)
    depth = distance_transform_cdt(box)
    row, column = np.unravel_index(int(np.argmax(depth)), depth.shape)
    return float(left + column - 1), float(top + row - 1)


def _spread(wanted: Sequence[float], width: int) -> list[float]:
    """Return places in rising order near the wanted ones, so far apart that balloons do not touch."""
    apart = 2.0 * _BALLOON_PX + 6.0
    if len(wanted) * apart > width:
        apart = width / len(wanted)
    low, high = 0.5 * apart, width - 0.5 * apart
    places = [min(max(x, low), high) for x in wanted]
    for k in range(1, len(places)):
        places[k] = max(places[k], places[k - 1] + apart)
    end = high
    for k in reversed(range(len(places))):
        places[k] = min(places[k], end)
        end = places[k] - apart
    return places


def _balloon(pen: "ImageDraw", balloon: Balloon) -> None:
    (x, y), (px, py) = balloon.at, balloon.point
    pen.line([(x, y), (px, py)], fill="white", width=4)
    pen.line([(x, y), (px, py)], fill=_BLACK, width=1)
    pen.ellipse([px - 3, py - 3, px + 3, py + 3], fill=_BLACK, outline="white")
    r = _BALLOON_PX
    pen.ellipse([x - r, y - r, x + r, y + r], fill="white", outline=_BLACK)
    pen.text((x, y), str(balloon.number), fill=_BLACK, font=_font(17), anchor="mm")


def _scale_bar(pen: "ImageDraw", px_per_mm: float, width: int, bottom: int, *, left: float = 0.0) -> None:
    length = bar_mm(px_per_mm, width)
    start, top = left + 16.0, bottom - 22.0
    end = start + length * px_per_mm
    middle = 0.5 * (start + end)
    pen.rectangle([start, top, middle, top + 8], fill=_BLACK, outline=_BLACK)
    pen.rectangle([middle, top, end, top + 8], fill="white", outline=_BLACK)
    pen.text((middle, top - 3), f"{length:g} mm", fill=_BLACK, font=_font(16), anchor="mb")


def _legend(pen: "ImageDraw", rows: Sequence[Row], left: int, height: int) -> None:
    step = min(_ROW_PX, (height - 30) // len(rows))
    font = _font(0.5 * step + 2)
    for k, row in enumerate(rows):
        top = 15 + k * step
        fill = tuple(round(255 * channel) for channel in row.colour)
        pen.text((left + 30, top + 0.45 * step), str(row.number), fill=_BLACK, font=font, anchor="rm")
        pen.rectangle([left + 38, top + 3, left + 38 + step - 6, top + step - 6], fill=fill, outline=_GREY)
        pen.text((left + 42 + step, top + 0.45 * step), row.text, fill=_BLACK, font=font, anchor="lm")


@lru_cache(maxsize=32)
def _font(size: float) -> "FreeTypeFont":
    from PIL import ImageFont

    font = ImageFont.load_default(size=size)
    assert not isinstance(font, ImageFont.ImageFont)
    return font


def numbered(names: Mapping[str, int], colours: Mapping[str, Colour]) -> Iterator[Row]:
    """Yield rows of a legend from names with their counts, numbered from 1 in their order."""
    for k, (name, count) in enumerate(names.items(), 1):
        text = name.replace("_", " ") + (f" ({count})" if count > 1 else "")
        yield Row(number=k, text=text, colour=colours[name])
