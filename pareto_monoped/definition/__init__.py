"""What a study is: its file, variables, goals and algorithm settings, as checked records.

Order of imports, lowest first: algorithms, given, goals, variables; study_file; study; provenance.
"""

__all__ = ["algorithms", "given", "goals", "provenance", "study", "study_file", "variables"]
