"""Tables of an export: ``bom.csv`` with the parts, ``strength.csv`` with all safety factors, ``tolerances.csv`` with
all dimension chains, and ``checks.json``.

What is bought: ``hardware.csv``, one row per designation, the torques of screws, and ``cables.csv``.
"""

import json
import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from pareto_monoped.cad.assembly import ACTUATOR_UNITS
from pareto_monoped.cad.cables import TIE, TIE_DESIGNATION, Cable, cables
from pareto_monoped.cad.check.result import Check
from pareto_monoped.cad.product import Listed, Product, part_file_name
from pareto_monoped.cad.write.folder import csv_text
from pareto_monoped.geometry.chains import Chain
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import SOLID_UNITS, Purchase
from pareto_monoped.geometry.tightening import LOCK
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
        *(fit.text for fit in part.toleranced),
        part.described,
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


_COLUMNS = ("kind", "designation", "standard", "alternatives", "count", "unit", "solids", "used_for", "remark")
_CABLE_COLUMNS = (
    *("cable", "from", "to", "wires", "designation", "diameter_mm", "bend_radius_mm", "least_bend_radius_mm"),
    *("path_mm", "cut_mm", "mass_not_counted_g", "corner", "x_mm", "y_mm", "z_mm", "what", "warning"),
)


@dataclass(slots=True, kw_only=True)
class Item:
    """What is bought under one designation."""

    order: Purchase  #: of one instance
    count: float = 0.0  #: in the order's unit, for the whole robot
    solids: int = 0  #: bought solids of the assembly that it becomes, together with other items or alone
    parts: list[str] = field(default_factory=list)  #: names of the parts that it is for
    remarks: list[str] = field(default_factory=list)  #: what is done with it

    @property
    def amount(self) -> str:
        """The count as written in tables: whole units, rounded up."""
        return f"{math.ceil(self.count - 1e-9):d}"


def items(product: Listed) -> list[Item]:
    """Return everything that is bought, equal designations together, by kind and in the order of the assembly."""
    found: dict[tuple[str, str], Item] = {}
    for unique in product.unique:
        for order in _orders(unique.part):
            item = found.setdefault((order.kind, order.designation), Item(order=order))
            item.count = 1.0 if order.unit == "pack" else item.count + order.count * unique.count
            item.solids += unique.count if unique.part.process == "bought" and order.unit in SOLID_UNITS else 0
            item.parts.append(unique.name)
            if order.remark and order.remark not in item.remarks:
                item.remarks.append(order.remark)
    return sorted(found.values(), key=lambda item: item.order.kind)


def _orders(part: Part) -> Iterator[Purchase]:
    """Yield what a part is bought as, and what holds it."""
    yield from part.purchases
    if part.joint is not None and part.joint.adhesive is not None:
        yield part.joint.adhesive
    if part.fastening is not None:
        yield LOCK


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
        order, parts, remarks = item.order, " ".join(item.parts), "; ".join(item.remarks)
        others = "; ".join(order.alternatives)
        bought = (order.kind, order.designation, order.standard, others, item.amount, order.unit, item.solids or "")
        rows.append((*bought, parts, remarks))
    for designation, made in by_designation(product).items():
        lengths = ", ".join(f"{c.name} {c.wires} x {c.cut_mm:g} mm" for c in made)
        total_m = 1e-3 * sum(c.wires * c.cut_mm for c in made)
        count, names = sum(c.wires for c in made), " ".join(c.name for c in made)
        remarks = "; ".join((f"{lengths}; {total_m:.2f} m", *(c.warning for c in made if c.warning)))
        rows.append(("cable", designation, "", "", count, "piece", "", names, remarks))
    ties = sum(cable.notes.count(TIE) for made in by_designation(product).values() for cable in made)
    rows.append(("cable", TIE_DESIGNATION, "", "", ties, "piece", "", "driver plates", ""))
    return csv_text(_COLUMNS, rows)


def tightening(part: Part) -> tuple[str, str]:
    """Return torque in N m and lock of a fastener, as written in tables."""
    assert part.fastening is not None
    return f"{part.fastening.torque_n_m:.1f} N m", part.fastening.lock


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
