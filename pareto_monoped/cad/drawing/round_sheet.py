"""The sheet of a round part: section, end view, tables."""

from collections.abc import Iterator

from pareto_monoped.cad.drawing.bores import bores, chamfer_text, number
from pareto_monoped.cad.drawing.end_view import end_view, sees_more_from_above
from pareto_monoped.cad.drawing.gear_data import gear_rows
from pareto_monoped.cad.drawing.paper import Paper
from pareto_monoped.cad.drawing.profile import Teeth, cylinders, half_section, teeth_of
from pareto_monoped.cad.drawing.section import RoundPart, common_chamfer, section_view
from pareto_monoped.cad.drawing.sheet import table
from pareto_monoped.cad.drawing.tolerances import DATUM, datum_fit, fit_table
from pareto_monoped.geometry.making import ToothMaking
from pareto_monoped.geometry.parts import Part


def round_part(part: Part) -> RoundPart:
    """What the views are drawn from."""
    body = half_section(part)
    found = RoundPart(body=body, teeth=teeth_of(part), bores=bores(part), fits=part.fits, from_above=True)
    above = sees_more_from_above(found)
    return RoundPart(body=body, teeth=found.teeth, bores=found.bores, fits=part.fits, from_above=above)


def round_views(drawn: RoundPart, scale: float) -> list[Paper]:
    """Section, and end view if there is something to see."""
    axis = datum_fit(drawn.fits)
    central = axis is not None and any(axis.holds(2.0 * c.radius) for c in cylinders(drawn.body))
    section = section_view(drawn, scale)
    # Diameters in the section say everything about a part without holes beside its axis.
    return [section, end_view(drawn, scale, DATUM if central else None)] if drawn.bores else [section]


def round_tables(part: Part, drawn: RoundPart) -> list[Paper]:
    """Gear data and fits."""
    gears = sorted(drawn.teeth, key=lambda teeth: abs(teeth.low - drawn.datum))
    tables = [
        table(
            _gear_title(teeth, drawn),
            ("", ""),
            gear_rows(
                teeth.gear,
                accuracy_class=part.accuracy_class,
                hole=teeth.hole,
                making=_making(part, teeth),
                hardness=part.grade.hardness if part.grade is not None else "",
            ),
        )
        for teeth in gears
    ]
    around = [2.0 * c.radius for c in cylinders(drawn.body)]
    fits = fit_table(part.fits, [any(fit.holds(diameter) for diameter in around) for fit in part.fits])
    return [*tables, *([fits] if fits is not None else [])]


def _making(part: Part, teeth: Teeth) -> ToothMaking | None:
    """How these teeth are made, if the part says so."""
    gear = (int(teeth.gear.teeth), float(teeth.gear.module_mm))
    return next((one for one in part.teeth if (one.teeth, one.module_mm) == gear), None)


def _gear_title(teeth: Teeth, drawn: RoundPart) -> str:
    """A title that tells several gears of one part apart."""
    if len(drawn.teeth) == 1:
        return "Gear data"
    near, far = sorted(abs(z - drawn.datum) for z in (teeth.low, teeth.high))
    return f"Gear data, from {number(near)} to {number(far)}"


def round_notes(drawn: RoundPart) -> Iterator[str]:
    """What no dimension says."""
    chamfer = common_chamfer(drawn.body)
    if chamfer is not None:
        yield f"Chamfers without dimension {chamfer_text(*chamfer)}."
    yield f"Lengths run from the face marked with a circle, z = {drawn.datum:g} mm in the model."
