"""The table of fits on a drawing: limits, finish and place of each toleranced face."""

from collections.abc import Sequence

from pareto_monoped.cad.drawing.dimension import FRAME_MM, datum, frame
from pareto_monoped.cad.drawing.lettering import width_mm
from pareto_monoped.cad.drawing.paper import LETTER_MM, Paper
from pareto_monoped.geometry.iso286 import limits
from pareto_monoped.geometry.making import RACEWAY_RA_UM, Fit

DATUM = "A"
_SEAT_RA, _FIT_RA, _RACEWAY_RA = "0.8", "1.6", f"{RACEWAY_RA_UM:g}"
"""Arithmetical mean height in micrometres: bearing makers ask 0.8 of seats up to 80 mm, and 1.6 suffices elsewhere."""
_COAXIAL = "Ø0.02"
"""Zone of the axes of seats: about one tolerance of grade 6 at 30 to 50 mm, 16 micrometres (our own choice)."""
_SQUARE = "0.02"
"""Zone of the faces that locate a part along its axis. Makers of bearings ask run-out of shoulders of IT5 to IT6:
13 to 19 micrometres at 50 to 80 mm."""
_SHOULDERS = "shoulders"


def datum_fit(fits: Sequence[Fit]) -> Fit | None:
    """The fit whose axis positions refer to: the largest seat, or the largest of all."""
    seats = [fit for fit in fits if fit.seat] or list(fits)
    return max(seats, key=lambda fit: float(fit.diameter_mm), default=None)


def fit_table(fits: Sequence[Fit], alone: Sequence[bool]) -> Paper | None:
    """A row for each fit, and one for the faces square to the datum's axis if it carries a bearing; None without fits.

    Args:
        fits: of the part.
        alone: for each, whether its face stands around the part's axis; patterns have their place in their callouts.
    """
    if not fits:
        return None
    first = datum_fit(fits)
    located = any(fit is first and fit.seat and single for fit, single in zip(fits, alone, strict=True))
    names = [*(f"Ø{fit.text}" for fit in fits), *([_SHOULDERS] if located else [])]
    widths = [max(width_mm(name, LETTER_MM) for name in names) + 3.0, 30.0, 16.0, 34.0]
    high = FRAME_MM + 2.0
    paper = Paper()
    top = high * (len(names) + 1)
    paper.text("Fits (ISO 286-2)", 0.0, top + 1.6)
    rows = [("Face", "Limits", "Ra, µm", "Geometry"), *((f"Ø{fit.text}", _limits(fit), "", "") for fit in fits)]
    for k, cells in enumerate([*rows, *([(_SHOULDERS, "", _FIT_RA, "")] if located else [])]):
        y, x = top - (k + 1) * high, 0.0
        for cell, width in zip(cells, widths, strict=True):
            paper.text(cell, x + 1.5, y + 0.5 * (high - LETTER_MM))
            x += width
        paper.line([(0.0, y), (x, y)])
    for k, (fit, single) in enumerate(zip(fits, alone, strict=True)):
        y = top - (k + 2) * high
        finish = _RACEWAY_RA if fit.raceway else _SEAT_RA if fit.seat else _FIT_RA
        paper.text(finish, sum(widths[:2]) + 1.5, y + 0.5 * (high - LETTER_MM))
        x = sum(widths[:3]) + 1.5
        if fit is first and single:
            datum(paper, DATUM, x, y + 1.0)
        elif single:
            frame(paper, ["coaxial", _COAXIAL, DATUM], x, y + 1.0)
        else:
            paper.text("see view", x, y + 0.5 * (high - LETTER_MM))
    if located:
        frame(paper, ["square", _SQUARE, DATUM], sum(widths[:3]) + 1.5, 1.0)
    x = 0.0
    for width in (*widths, 0.0):
        paper.line([(x, 0.0), (x, top)])
        x += width
    paper.line([(0.0, top), (sum(widths), top)])
    return paper


def _limits(fit: Fit) -> str:
    """Upper and lower deviation in millimetres."""
    found = limits(float(fit.diameter_mm), fit.zone)
    return " / ".join(f"{deviation:+.3f}" if deviation else "0" for deviation in (found.upper_mm, found.lower_mm))
