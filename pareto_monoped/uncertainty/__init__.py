"""What is uncertain in a built robot, by how much, and what that does to its jump.

Order of imports, lowest first: settings, statistics; samples; sensitivity.
"""

__all__ = ["samples", "sensitivity", "settings", "statistics"]
