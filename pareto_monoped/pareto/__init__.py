"""The height-energy front: dominance, indicators, picking one design.

Order of imports, lowest first: growth, objectives; front, selectors, trade_offs; pick.
"""

__all__ = ["front", "growth", "objectives", "pick", "selectors", "trade_offs"]
