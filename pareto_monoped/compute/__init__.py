"""Work spread over processes and machines: chunks, executors that survive lost workers, and who may compute.

Order of imports, lowest first: chunks, compiled, crew; cluster, processes.
"""

__all__ = ["chunks", "cluster", "compiled", "crew", "processes"]
