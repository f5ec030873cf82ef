"""Tables of an export: ``bom.csv`` with the parts, ``strength.csv`` with all safety factors, and ``checks.json``."""

import csv
import io
import json
from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from pareto_monoped.cad.check.result import Check
from pareto_monoped.cad.product import ACTUATOR_UNITS, Product, part_file_name
from pareto_monoped.geometry.parts import Part
from pareto_monoped.strength.factors import JointFactor
from pareto_monoped.strength.joint import ActuatorJoint

_PART_COLUMNS = (
    *("part", "count", "material", "process", "mass_g", "total_g", "made_or_bought", "size_mm", "used_in"),
    *("torque_n_m", "lock", "safety_factors", "note"),
)
_JOINT_COLUMNS = (
    *("joint", "group", "actuator", "factor", "required", "factor_over_required", "asked", "loads", "formula"),
    *("source", "required_because", "parts", "cure"),
)


def parts_list(product: Product, factors: Sequence[JointFactor] = ()) -> str:
    """Return the parts list as CSV, one row per unique part, with the safety factors of the joints that it is in."""
    joints = _by_part(factors)
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(_PART_COLUMNS)
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
                " x ".join(f"{size:.1f}" for size in np.ptp(unique.mesh.points_mm, axis=0)),
                " ".join(unique.units),
                f"{part.fastening.torque_n_m:.1f}" if part.fastening else "",
                part.fastening.lock if part.fastening else "",
                "; ".join(joints[unique.name]),
                _note(part),
            )
        )
    return stream.getvalue()


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
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(_JOINT_COLUMNS)
    for one in factors:
        joint = one.joint
        writer.writerow(
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
    return stream.getvalue()


def checks_record(checks: Sequence[Check]) -> str:
    """Return the checks as JSON, in the order in which they ran."""
    rows = [
        {
            "check": check.name,
            "passed": check.passed,
            "looked_at": check.looked_at,
            "worst": check.worst,
            "measured": check.measured,
            "limit": check.limit,
            "unit": check.unit,
            "failures": list(check.failures),
        }
        for check in checks
    ]
    return json.dumps(rows, indent=2) + "\n"
