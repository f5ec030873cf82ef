"""What is bought: ``hardware.csv``, one row per designation, the torques of screws, and ``cables.csv``."""

import csv
import io
import re
from dataclasses import dataclass

from pareto_monoped.cad.cables import TIE, TIE_DESIGNATION, Cable, cables
from pareto_monoped.cad.product import Listed
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import FASTENERS, Role
from pareto_monoped.geometry.tightening import LOCKER

_STANDARD = re.compile(r"(?:ISO|DIN)(?:/[A-Z]+)? \d+(?:-\d+)?")
_COLUMNS = ("kind", "designation", "standard", "count", "used_for", "remark")
_CABLE_COLUMNS = (
    *(
        "cable",
        "from",
        "to",
        "wires",
        "designation",
        "diameter_mm",
        "bend_radius_mm",
        "least_bend_radius_mm",
        "path_mm",
    ),
    *("cut_mm", "mass_not_counted_g", "corner", "x_mm", "y_mm", "z_mm", "what", "warning"),
)
_BOUGHT_ROUGH = frozenset({Role.SPROCKET})
"""Parts that are bought and then worked on, if their designation is that of a standard."""


@dataclass(slots=True, kw_only=True)
class Item:
    """What is bought under one designation."""

    kind: str  #: role of the parts
    designation: str  #: what to order
    standard: str  #: that it follows; '' without one
    count: int  #: how many
    parts: list[str]  #: the parts that it becomes
    remarks: list[str]  #: what else the parts list says about them


def items(product: Listed) -> list[Item]:
    """Return everything that is bought, equal designations together, by kind and in the order of the assembly."""
    found: dict[tuple[str, str], Item] = {}
    for unique in product.unique:
        part = unique.part
        if part.process != "bought" and part.role not in _BOUGHT_ROUGH:
            continue
        designation, remark = _split(part)
        if part.process != "bought" and not _STANDARD.search(designation):
            continue  # cut from solid
        kind, standard = part.role.value, ", ".join(_STANDARD.findall(designation))
        new = Item(kind=kind, designation=designation, standard=standard, count=0, parts=[], remarks=[])
        item = found.setdefault((kind, designation), new)
        item.count += unique.count
        item.parts.append(unique.name)
        if remark and remark not in item.remarks:
            item.remarks.append(remark)
    return sorted(found.values(), key=lambda item: item.kind)


def by_designation(product: Listed) -> dict[str, list[Cable]]:
    """Return the robot's cables, those of one kind together."""
    found: dict[str, list[Cable]] = {}
    for cable in cables(product.robot):
        found.setdefault(cable.designation, []).append(cable)
    return found


def hardware(product: Listed) -> str:
    """Return the purchasing list as CSV."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(_COLUMNS)
    for item in items(product):
        parts, remarks = " ".join(item.parts), "; ".join(item.remarks)
        writer.writerow((item.kind, item.designation, item.standard, item.count, parts, remarks))
    for designation, made in by_designation(product).items():
        lengths = ", ".join(f"{c.name} {c.wires} x {c.cut_mm:g} mm" for c in made)
        total_m = 1e-3 * sum(c.wires * c.cut_mm for c in made)
        names = " ".join(c.name for c in made)
        writer.writerow(("cable", designation, "", sum(c.wires for c in made), names, f"{lengths}; {total_m:.2f} m"))
    ties = sum(cable.notes.count(TIE) for made in by_designation(product).values() for cable in made)
    writer.writerow(("cable", TIE_DESIGNATION, "", ties, "driver plates", ""))
    locked = sum(unique.count for unique in product.unique if unique.part.role in FASTENERS)
    writer.writerow(("consumable", LOCKER, "", 1, f"{locked} screws and bolts", "10 ml"))
    return stream.getvalue()


def tightening(part: Part) -> tuple[str, str]:
    """Return torque in N m and lock of a fastener, as written in tables."""
    assert part.fastening is not None
    return f"{part.fastening.torque_n_m:.1f} N m", part.fastening.lock


def _split(part: Part) -> tuple[str, str]:
    """Return what to order, the first clause of a part's note with the sizes that belong to it, and the rest."""
    head, _, rest = part.note.partition("; ")
    # A size such as "6804, 20 x 32 x 7 mm (ISO 15)" belongs to the designation.
    clauses = head.split(", ")
    take = 1
    while take < len(clauses) and (clauses[take][:1].isdigit() or clauses[take].startswith("round bar")):
        take += 1
    designation = ", ".join(clauses[:take]) or part.material.name
    return designation, "; ".join(filter(None, (", ".join(clauses[take:]), rest)))


def cables_csv(product: Listed) -> str:
    """Return every corner of every cable in the assembly's frame as CSV, with the thigh hanging down."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(_CABLE_COLUMNS)
    for cable in cables(product.robot):
        head = (cable.name, cable.start, cable.end, cable.wires, cable.designation, f"{cable.diameter_mm:g}")
        bends = (f"{cable.bend_radius_mm:.1f}", f"{cable.least_bend_radius_mm:.1f}")
        sizes = (*bends, f"{cable.length_mm:.0f}", f"{cable.cut_mm:g}", f"{cable.mass_g:.1f}")
        for k, (point, what) in enumerate(zip(cable.points_mm.tolist(), cable.notes, strict=True), 1):
            writer.writerow((*head, *sizes, k, *(f"{value:.1f}" for value in point), what, cable.warning))
    return stream.getvalue()
