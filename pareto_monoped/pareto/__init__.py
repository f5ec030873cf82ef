"""The height-energy front: dominance, indicators, picking one design.

Order of imports, lowest first: objectives; front, selectors, trade_offs; growth, pick.
"""

__all__ = ["front", "growth", "objectives", "pick", "selectors", "trade_offs"]
