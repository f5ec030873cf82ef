"""Flat shapes, prismatic parts and their exact mass properties: what both the simulation and the CAD are made from.

Order of imports, lowest first: roles, shapes; chains, features, gears, making; tightening; parts; extents, screws;
dowels.
"""

__all__ = [
    "chains",
    "dowels",
    "extents",
    "features",
    "gears",
    "making",
    "parts",
    "roles",
    "screws",
    "shapes",
    "tightening",
]
