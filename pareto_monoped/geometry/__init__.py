"""Flat shapes, prismatic parts and their exact mass properties: what both the simulation and the CAD are made from.

Order of imports, lowest first: roles, shapes; features, gears, making; tightening; parts; screws; dowels.
"""

__all__ = ["dowels", "features", "gears", "making", "parts", "roles", "screws", "shapes", "tightening"]
