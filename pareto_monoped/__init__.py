"""Co-design of a jumping one-legged robot: actuators, links and controller on one Pareto front."""

__version__ = "0.3.0"
