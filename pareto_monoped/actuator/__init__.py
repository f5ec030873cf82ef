"""Stage 1: from a motor to the lightest actuator for every gear ratio."""
