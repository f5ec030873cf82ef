"""A grid of studies: run side by side, continued as a whole, compared on one page.

Order of imports, lowest first: grid, worker; folder; coordinator, results; page.
"""

__all__ = ["coordinator", "folder", "grid", "page"]
