"""What is computed from stored studies: alternatives, robustness, sensitivity, limits, verification.

Order of imports, lowest first: alternatives, at_bounds, compare, rail_legs, robustness, verify; limit, remarks,
sensitivity; choices.
"""

__all__ = [
    "alternatives",
    "at_bounds",
    "choices",
    "compare",
    "limit",
    "rail_legs",
    "remarks",
    "robustness",
    "sensitivity",
    "verify",
]
