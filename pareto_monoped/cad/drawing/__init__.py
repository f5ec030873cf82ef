"""Workshop drawings: a sheet for each part that is made, and one of the assembly, as PDF."""
