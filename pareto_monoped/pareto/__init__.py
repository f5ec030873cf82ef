"""The height-energy front: dominance, indicators, and picking one design."""
