"""What must hold for every export: one module per check, each with its limit."""
