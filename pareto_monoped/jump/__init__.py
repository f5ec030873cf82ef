"""Stage 2: a robot becomes a MuJoCo model, jumps under the paper's controller, and its jump is measured.

Order of imports, lowest first: calibration_defaults, controller_record, quiet, rebound; calibration, controller;
callback, end_stops, variations; model; gravity; population; evaluate, frames; peers, shared, single; balance; audit;
screen, table1.
"""

__all__ = [
    "audit",
    "balance",
    "calibration",
    "calibration_defaults",
    "controller_record",
    "end_stops",
    "evaluate",
    "frames",
    "gravity",
    "model",
    "peers",
    "population",
    "screen",
    "shared",
    "single",
    "table1",
    "variations",
]

# fmt: skip
