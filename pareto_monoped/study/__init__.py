"""Studies: study file, search algorithms behind one ask-and-tell interface, run loop, storage, resume.

Order of imports, lowest first: own_functions, simulator; audits, outside, session; pymoo_problem, run.
"""

__all__ = ["audits", "own_functions", "run", "session", "simulator"]
