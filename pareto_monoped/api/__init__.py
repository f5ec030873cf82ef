"""What ``import pareto_monoped`` offers to scripts and notebooks: thin functions over the rooms that do the work.

Order of imports, lowest first: given; jumps; studies; outputs, plots, robustness, running.
"""

__all__ = ["running"]
