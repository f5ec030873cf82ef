"""The height-energy front: dominance, indicators, picking one design.

Order of imports, lowest first: objectives; alternatives, front, indicators, selectors, trade_offs; pick.
"""

__all__ = ["alternatives", "front", "indicators", "objectives", "pick", "selectors", "trade_offs"]
