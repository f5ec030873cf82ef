"""Tables of an export: ``bom.csv`` with the parts, ``strength.csv`` with all safety factors, ``tolerances.csv`` with
all dimension chains, and ``checks.json``.

What is bought: ``hardware.csv``, one row per designation, the torques of screws, and ``cables.csv``.
"""

import json
import re
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pareto_monoped.cad.assembly import ACTUATOR_UNITS
from pareto_monoped.cad.cables import TIE, TIE_DESIGNATION, Cable, cables
from pareto_monoped.cad.check.result import Check
from pareto_monoped.cad.product import Listed, Product, part_file_name
from pareto_monoped.cad.write.folder import csv_text
from pareto_monoped.geometry.chains import Chain
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import FASTENERS, Role
from pareto_monoped.geometry.tightening import LOCKER
from pareto_monoped.robot.cost import part_cost
from pareto_monoped.strength.factors import JointFactor
from pareto_monoped.strength.joint import ActuatorJoint

_PART_COLUMNS = (
    *("part", "count", "material", "process", "mass_g", "total_g", "made_or_bought", "size_mm", "used_in"),
    *("torque_n_m", "lock", "safety_factors", "note", "material_eur", "machine_h", "cost_eur"),
)
_JOINT_COLUMNS = (
    *("joint", "group", "actuator", "factor", "required", "factor_over_required", "asked", "loads", "formula"),
    *("source", "required_because", "parts", "cure"),
)


_CHAIN_COLUMNS = (
    *("gap", "as_drawn_mm", "least_mm", "greatest_mm", "least_3_sigma_mm", "greatest_3_sigma_mm", "must_be_mm"),
    *("lengths", "cure"),
)


def chain_table(chains: Sequence[Chain]) -> str:
    """Return all dimension chains as CSV: every gap as drawn, at worst and within three standard deviations."""
    return csv_text(
        _CHAIN_COLUMNS,
        [
            (
                chain.name,
                *(f"{value + 0.0:.3f}" for value in (chain.nominal_mm, *chain.worst_mm, *chain.spread_mm)),
                f"{chain.least_mm:g}",
                "; ".join(f"{one.sign:+.3g} {one.text}" for one in chain.links),
                chain.cure,
            )
            for chain in chains
        ],
    )


def parts_list(product: Product, factors: Sequence[JointFactor] = ()) -> str:
    """Return the parts list as CSV, one row per unique part, with the safety factors of the joints that it is in.

    Costs are those of all instances together, and their sum is the robot's.
    """
    joints = _by_part(factors)
    rows: list[tuple[object, ...]] = []
    for unique in product.unique:
        part = unique.part
        mass_g = 1e3 * float(part.unit_mass_kg())
        cost = part_cost(part, unique.count)
        rows.append(
            (
                unique.name,
                unique.count,
                part.material.name,
                part.process,
                f"{mass_g:.2f}",
                f"{mass_g * unique.count:.2f}",
                "bought" if part.process == "bought" else "made",
                " x ".join(f"{size:.1f}" for size in np.ptp(unique.mesh.points_mm, axis=0)),
                " ".join(unique.units),
                f"{part.fastening.torque_n_m:.1f}" if part.fastening else "",
                part.fastening.lock if part.fastening else "",
                "; ".join(joints[unique.name]),
                _note(part),
                f"{cost.material_eur:.2f}",
                f"{cost.hours:.2f}",
                f"{cost.total_eur:.2f}",
            )
        )
    return csv_text(_PART_COLUMNS, rows)


def _by_part(factors: Sequence[JointFactor]) -> dict[str, list[str]]:
    """Return the joints of each part, by its file name, each with factor and required factor."""
    found: dict[str, list[str]] = defaultdict(list)
    for one in factors:
        required = "informs" if one.joint.informs else f"{one.joint.required:g}"
        text = f"{one.joint.name} {one.factor:.2f} ({required})"
        for part in one.joint.parts:
            # A joint of an actuator may name parts of the leg too, and both actuators may share their parts.
            found[part].append(text)
            if isinstance(one.joint, ActuatorJoint):
                found[part_file_name((f"{one.joint.side}_actuator",), part)].append(text)
                found[part_file_name(tuple(ACTUATOR_UNITS), part)].append(text)
    return found


def _note(part: Part) -> str:
    """Return what the maker must know: grade and accuracy, fits, note, joint."""
    grade, accuracy = part.grade, part.accuracy_class
    words = (
        f"{grade.name}, {grade.hardness}" if grade else "",
        f"ISO 1328-1 class {accuracy}" if accuracy else "",
        *(one.text for one in part.teeth),
        *(fit.text for fit in part.fits),
        part.note,
        part.joint.text if part.joint else "",
    )
    return "; ".join(filter(None, words))


def strength_table(factors: Sequence[JointFactor]) -> str:
    """Return the table as CSV, a row per joint; without rows if the design does not jump."""
    rows: list[tuple[object, ...]] = []
    for one in factors:
        joint = one.joint
        rows.append(
            (
                joint.name,
                joint.group,
                joint.side if isinstance(joint, ActuatorJoint) else "",
                f"{one.factor:.12g}",
                f"{joint.required:g}",
                f"{one.share:.12g}",
                "informs" if joint.informs else "required",
                " ".join(f"{name}={value:.6g}" for name, value in one.loads.items()),
                joint.formula,
                joint.source,
                joint.required_source,
                " ".join(joint.parts),
                joint.cure,
            )
        )
    return csv_text(_JOINT_COLUMNS, rows)


_OF_CHECK = ("passed", "looked_at", "worst", "measured", "limit", "unit")


def checks_record(checks: Sequence[Check]) -> str:
    """Return the checks as JSON, in the order in which they ran."""
    rows = [
        {"check": check.name, **{name: getattr(check, name) for name in _OF_CHECK}, "failures": list(check.failures)}
        for check in checks
    ]
    return json.dumps(rows, indent=2) + "\n"


_STANDARD = re.compile(r"(?:ISO|DIN)(?:/[A-Z]+)? \d+(?:-\d+)?")
_COLUMNS = ("kind", "designation", "standard", "count", "used_for", "remark")
_CABLE_COLUMNS = (
    *("cable", "from", "to", "wires", "designation", "diameter_mm", "bend_radius_mm", "least_bend_radius_mm"),
    *("path_mm", "cut_mm", "mass_not_counted_g", "corner", "x_mm", "y_mm", "z_mm", "what", "warning"),
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
    rows: list[tuple[object, ...]] = []
    for item in items(product):
        parts, remarks = " ".join(item.parts), "; ".join(item.remarks)
        rows.append((item.kind, item.designation, item.standard, item.count, parts, remarks))
    for designation, made in by_designation(product).items():
        lengths = ", ".join(f"{c.name} {c.wires} x {c.cut_mm:g} mm" for c in made)
        total_m = 1e-3 * sum(c.wires * c.cut_mm for c in made)
        names = " ".join(c.name for c in made)
        rows.append(("cable", designation, "", sum(c.wires for c in made), names, f"{lengths}; {total_m:.2f} m"))
    ties = sum(cable.notes.count(TIE) for made in by_designation(product).values() for cable in made)
    rows.append(("cable", TIE_DESIGNATION, "", ties, "driver plates", ""))
    locked = sum(unique.count for unique in product.unique if unique.part.role in FASTENERS)
    rows.append(("consumable", LOCKER, "", 1, f"{locked} screws and bolts", "10 ml"))
    return csv_text(_COLUMNS, rows)


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
    rows: list[tuple[object, ...]] = []
    for cable in cables(product.robot):
        head = (cable.name, cable.start, cable.end, cable.wires, cable.designation, f"{cable.diameter_mm:g}")
        bends = (f"{cable.bend_radius_mm:.1f}", f"{cable.least_bend_radius_mm:.1f}")
        sizes = (*bends, f"{cable.length_mm:.0f}", f"{cable.cut_mm:g}", f"{cable.mass_g:.1f}")
        for k, (point, what) in enumerate(zip(cable.points_mm.tolist(), cable.notes, strict=True), 1):
            rows.append((*head, *sizes, k, *(f"{value:.1f}" for value in point), what, cable.warning))
    return csv_text(_CABLE_COLUMNS, rows)
