"""The CAD kernel (Open CASCADE) in a process of its own: solids, their properties, STEP files."""

__all__ = ["client"]
