"""Stage 1: motors, planetary gear rules, strength, part dimensions and masses; gear ratio -> lightest actuator."""
