"""``checks.json``: what was checked, and what was found."""

import json
from collections.abc import Sequence

from pareto_monoped.cad.check.result import Check


def checks_record(checks: Sequence[Check]) -> str:
    """The checks as JSON, in the order in which they ran."""
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
