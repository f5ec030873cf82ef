"""Colours of parts in sections and exploded views, which colour-blind readers can tell apart as well."""

Colour = tuple[float, float, float]

LEAST_DISTANCE = 12.0
"""Between any two colours in CIELAB: 2.3 is just noticed (Mahy et al. 1994), 12 is plain side by side."""

_RGB = (
    (135, 195, 255),
    (255, 135, 0),
    (135, 120, 105),
    (240, 240, 195),
    (195, 0, 255),
    (75, 120, 150),
    (210, 60, 30),
    (0, 255, 105),
    (225, 165, 180),
    (135, 180, 105),
    (135, 120, 225),
    (210, 240, 255),
    (150, 255, 0),
    (255, 90, 195),
    (0, 210, 45),
    (195, 75, 60),
    (210, 195, 165),
    (240, 0, 150),
    (165, 225, 135),
    (60, 165, 195),
    (150, 255, 225),
    (135, 150, 105),
    (210, 0, 195),
    (45, 105, 255),
    (180, 150, 255),
    (210, 210, 255),
    (165, 165, 75),
    (75, 225, 210),
)
PALETTE: tuple[Colour, ...] = tuple((r / 255.0, g / 255.0, b / 255.0) for r, g, b in _RGB)
"""Chosen one after the other, each as far as possible from all before it for normal vision and for full protanopia,
deuteranopia and tritanopia (Machado et al. 2009); lightness 48 to 94, so that shading and black lines show."""


def colour(k: int) -> Colour:
    """The k-th colour; they repeat after ``len(PALETTE)``, and numbers in the picture tell equal ones apart."""
    return PALETTE[k % len(PALETTE)]
