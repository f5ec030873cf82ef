"""``cables.csv``: every corner of every cable in the assembly's frame, and what is cut how long."""

import csv
import io

from pareto_monoped.cad.cables import cables
from pareto_monoped.cad.product import Listed

_COLUMNS = (
    "cable",
    "from",
    "to",
    "wires",
    "designation",
    "diameter_mm",
    "bend_radius_mm",
    "least_bend_radius_mm",
    "path_mm",
    "cut_mm",
    "mass_not_counted_g",
    "corner",
    "x_mm",
    "y_mm",
    "z_mm",
    "what",
    "warning",
)


def cables_csv(product: Listed) -> str:
    """The corners as CSV, with the thigh hanging down."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(_COLUMNS)
    for cable in cables(product.robot):
        head = (cable.name, cable.start, cable.end, cable.wires, cable.designation, f"{cable.diameter_mm:g}")
        bends = (f"{cable.bend_radius_mm:.1f}", f"{cable.least_bend_radius_mm:.1f}")
        sizes = (*bends, f"{cable.length_mm:.0f}", f"{cable.cut_mm:g}", f"{cable.mass_g:.1f}")
        for k, (point, what) in enumerate(zip(cable.points_mm.tolist(), cable.notes, strict=True), 1):
            writer.writerow((*head, *sizes, k, *(f"{value:.1f}" for value in point), what, cable.warning))
    return stream.getvalue()
