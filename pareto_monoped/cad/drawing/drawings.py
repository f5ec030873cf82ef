"""All drawings of a robot as PDF files: one of each part that is made, one of the assembly."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from pareto_monoped.cad.drawing.assembly_sheet import assembly_sheet
from pareto_monoped.cad.drawing.cable_sheet import cable_sheet
from pareto_monoped.cad.drawing.exploded_sheets import exploded_sheets
from pareto_monoped.cad.drawing.paper import Paper
from pareto_monoped.cad.drawing.part_sheet import Sheet, part_sheet
from pareto_monoped.cad.drawing.pdf import pdf
from pareto_monoped.cad.drawing.sheet import Title, titled
from pareto_monoped.cad.product import ListedPart, Product
from pareto_monoped.geometry.making import Fit, ToothMaking
from pareto_monoped.geometry.parts import Part

_TOLERANCES: Mapping[str, tuple[str, str]] = {
    "machined": ("ISO 2768-mK", "3.2"),
    "laser cut": ("ISO 2768-mK", "12.5"),
    "3D printed": ("ISO 2768-cL", ""),
    "moulded": ("ISO 3302-1 M3", ""),
}
"""General tolerances and roughness Ra in micrometres by process: what milling and turning, cutting by laser, printing
with layers of 0.2 mm and casting rubber reach without effort (our own choice of classes)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Origin:
    """What all title blocks of a robot have in common: the robot in words, hash and date of its design, the program."""

    design: str
    digest: str
    date: str
    maker: str


def origin_of(record: Mapping[str, Any]) -> Origin:
    """The same from the record of an export, which may still lack what is computed last."""
    source = record["source"]
    name = (
        f"case {source['case']}"
        if "case" in source
        else " trial ".join(str(source[key]) for key in ("study", "trial") if key in source)
    )
    return Origin(
        design=", ".join(filter(None, (name, record["motor"], record.get("rules", "paper")))),
        digest=record["design_hash"],
        date=str(source.get("date", "")),
        maker=record["made_by"],
    )


def part_drawings(parts: Sequence[ListedPart], origin: Origin, first: int = 1) -> dict[str, bytes]:
    """The drawing of every part that is not bought, by the part's name.

    Args:
        parts: some of the robot's.
        origin: of the robot.
        first: number of the first drawing.
    """
    made = [unique for unique in parts if unique.part.process != "bought"]
    return {unique.name: part_drawing(unique, origin, number) for number, unique in enumerate(made, first)}


def part_drawing(unique: ListedPart, origin: Origin, number: int) -> bytes:
    """The drawing of one part.

    Args:
        unique: the part.
        origin: of the robot.
        number: of the drawing.
    """
    part = unique.part
    tolerances, finish = _TOLERANCES[part.process]
    title = Title(
        name=_words(unique.name),
        number=f"{origin.digest}-{number:02d}",
        material=part.grade.name if part.grade is not None else part.material.name,
        hardness=part.grade.hardness if part.grade is not None else "",
        mass=_mass(float(part.unit_mass_kg())),
        count=unique.count,
        process=next((one.making for one in part.teeth if one.quality), part.process),
        tolerances=tolerances,
        finish=finish,
        design=origin.design,
        digest=origin.digest,
        date=origin.date,
        maker=origin.maker,
    )
    return _file([_drawn(part, part.fits, part.teeth, part.accuracy_class, part.note)], title)


def assembly_drawing(product: Product, origin: Origin) -> bytes:
    """The drawing of the robot."""
    title = Title(
        name="monoped",
        number=f"{origin.digest}-00",
        material="see the list of items",
        hardness="",
        mass=_mass(product.robot.mass_kg),
        count=1,
        process="assembled",
        tolerances="",
        finish="",
        design=origin.design,
        digest=origin.digest,
        date=origin.date,
        maker=origin.maker,
    )
    return _file([assembly_sheet(product), *exploded_sheets(product), cable_sheet(product)], title)


# Designs of one study share most of their parts; a part's note, fits, teeth and accuracy do not count when compared.
@lru_cache(maxsize=256)
def _drawn(
    part: Part, _fits: tuple[Fit, ...], _teeth: tuple[ToothMaking, ...], _accuracy_class: int | None, _note: str
) -> Sheet:
    """The sheet of a part without its title block."""
    return part_sheet(part)


def _file(sheets: Sequence[Sheet], title: Title) -> bytes:
    pages = []
    for number, (drawn, size, scale) in enumerate(sheets, 1):
        paper = Paper()
        paper.lay(drawn)
        titled(paper, size, scale, title, f"{number}/{len(sheets)}")
        pages.append((paper, size.width_mm, size.height_mm))
    return pdf(pages, f"{title.name}, {title.number}")


def _words(name: str) -> str:
    return name.replace("_", " ")


def _mass(mass_kg: float) -> str:
    return f"{mass_kg:.3f} kg" if mass_kg >= 1.0 else f"{1e3 * mass_kg:.1f} g"
