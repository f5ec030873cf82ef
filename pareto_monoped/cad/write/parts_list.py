"""``bom.csv``: the parts list."""

import csv
import io

from pareto_monoped.cad.product import Product, extent_mm

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
                "; ".join(filter(None, (part.note, part.joint.text if part.joint else ""))),
            )
        )
    return stream.getvalue()
