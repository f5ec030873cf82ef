"""``bom.csv``: the parts list."""

import csv
import io

from pareto_monoped.cad.product import Product, extent_mm
from pareto_monoped.geometry.parts import Part

_COLUMNS = (
    "part",
    "count",
    "material",
    "process",
    "mass_g",
    "total_g",
    "made_or_bought",
    "size_mm",
    "used_in",
    "torque_n_m",
    "lock",
    "note",
)


def parts_list(product: Product) -> str:
    """The parts list as CSV, one row per unique part."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(_COLUMNS)
    for unique in product.unique:
        part = unique.part
        mass_g = 1e3 * float(part.unit_mass_kg())
        writer.writerow(
            (
                unique.name,
                unique.count,
                part.material.name,
                part.process,
                f"{mass_g:.2f}",
                f"{mass_g * unique.count:.2f}",
                "bought" if part.process == "bought" else "made",
                " x ".join(f"{size:.1f}" for size in extent_mm(unique.mesh)),
                " ".join(unique.units),
                f"{part.fastening.torque_n_m:.1f}" if part.fastening else "",
                part.fastening.lock if part.fastening else "",
                _note(part),
            )
        )
    return stream.getvalue()


def _note(part: Part) -> str:
    """What the maker must know: grade and accuracy, fits, note, joint."""
    return "; ".join(
        filter(
            None,
            (
                part.grade.name if part.grade else "",
                f"ISO 1328-1 class {part.accuracy_class}" if part.accuracy_class else "",
                *(fit.text for fit in part.fits),
                part.note,
                part.joint.text if part.joint else "",
            ),
        )
    )
