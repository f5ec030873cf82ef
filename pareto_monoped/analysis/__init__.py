"""What is computed from stored studies: alternatives, robustness, sensitivity, limits, verification.

Order of imports, lowest first: alternatives, at_bounds, robustness, verify; remarks, sensitivity; choices.
"""

__all__ = ["alternatives", "at_bounds", "choices", "remarks", "robustness", "sensitivity", "verify"]
