"""Colours of parts in sections and exploded views, which colour-blind readers can tell apart as well."""

Colour = tuple[float, float, float]

LEAST_DISTANCE, LEAST_FOR_DEFICIENT = 24.0, 13.0
"""Between any two colours in CIELAB, for normal vision and for each deficiency: 2.3 is just noticed (Mahy et al. 1994),
13 is plain side by side, 24 also apart from each other, where five greens 17 apart were taken for each other."""

_RGB = (
    (135, 195, 255),
    (255, 0, 30),
    (150, 60, 255),
    (210, 255, 0),
    (210, 135, 120),
    (225, 15, 165),
    (105, 255, 195),
    (225, 195, 90),
    (15, 135, 0),
    (195, 240, 240),
    (120, 120, 75),
    (195, 75, 210),
    (150, 255, 135),
    (195, 135, 165),
    (225, 30, 120),
    (90, 120, 120),
    (195, 180, 165),
    (120, 150, 255),
    (240, 180, 0),
    (240, 240, 90),
    (180, 210, 150),
    (210, 120, 60),
    (75, 120, 165),
    (180, 135, 210),
    (150, 105, 255),
    (225, 210, 255),
    (120, 180, 90),
    (0, 210, 210),
)
PALETTE: tuple[Colour, ...] = tuple((r / 255.0, g / 255.0, b / 255.0) for r, g, b in _RGB)
"""The 28 colours of a grid whose least distance is greatest: the least of that for full protanopia, deuteranopia and
tritanopia (Machado et al. 2009), and of 1/1.8 of that for normal vision. Found by exchanging one colour after the other
from many random beginnings; in the order in which each is farthest from all before it. Lightness 48 to 94, so that
shading and black lines show."""


def colour(k: int) -> Colour:
    """The k-th colour; they repeat after ``len(PALETTE)``, and numbers in the picture tell equal ones apart."""
    return PALETTE[k % len(PALETTE)]
