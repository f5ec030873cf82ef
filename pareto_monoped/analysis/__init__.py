"""What is computed from stored studies: alternatives, robustness, sensitivity, limits, verification.

Order of imports, lowest first: alternatives, at_bounds, choices, robustness, verify; remarks, sensitivity.
"""

__all__ = ["alternatives", "at_bounds", "choices", "remarks", "robustness", "sensitivity", "verify"]
