"""Design -> Robot: the one place where actuators, links and base become bodies with masses and inertias.

Order of imports, lowest first: cost, units; build, tables; population, tolerances.
"""

__all__ = ["build", "cost", "population", "tolerances", "units"]
