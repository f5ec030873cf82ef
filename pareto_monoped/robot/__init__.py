"""Design -> Robot: the one place where actuators, links and base become bodies with masses and inertias.

Order of imports, lowest first: units; build, tables; population.
"""

__all__ = ["build", "population", "units"]
