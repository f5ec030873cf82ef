"""The height-energy front: dominance, indicators, picking one design."""
