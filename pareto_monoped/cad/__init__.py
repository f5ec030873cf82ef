"""Stage 3: a robot's parts as solids, assembled, checked and written to files that can be made and simulated."""
