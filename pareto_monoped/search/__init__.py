"""Search algorithms behind one ask-and-tell interface, and the space that they search.

Order of imports, lowest first: algorithm; own_algorithm, response_surface, scoring, seen, space, weighted;
archive, evolution, optuna_samplers, random_search; prediction, variation; surrogate; registry.
"""

__all__ = ["algorithm", "own_algorithm", "registry", "scoring", "space", "weighted"]
