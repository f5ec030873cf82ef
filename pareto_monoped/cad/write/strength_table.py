"""``strength.csv``: the safety factor of every joint under the loads of the jump."""

import csv
import io
from collections.abc import Sequence

from pareto_monoped.strength.joint import ActuatorJoint
from pareto_monoped.strength.single import JointFactor

_COLUMNS = (
    "joint",
    "group",
    "actuator",
    "factor",
    "required",
    "factor_over_required",
    "asked",
    "loads",
    "formula",
    "source",
    "required_because",
    "parts",
    "cure",
)


def strength_table(factors: Sequence[JointFactor]) -> str:
    """The table as CSV, a row per joint; without rows if the design does not jump."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(_COLUMNS)
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
