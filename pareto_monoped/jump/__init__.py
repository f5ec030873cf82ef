"""Stage 2: a robot becomes a MuJoCo model, jumps under a controller, and its jump is measured.

Order of imports, lowest first: calibration_defaults, controller_record, quiet, rebound; torques; laws; calibration;
controller, end_stops, rail_leg; callback, model; document, planar, variations; gravity, population; engines;
evaluate, frames; peers, replay, shared, single; balance; audit; screen, table1.
"""

__all__ = [
    "audit",
    "balance",
    "calibration",
    "calibration_defaults",
    "controller_record",
    "document",
    "end_stops",
    "engines",
    "evaluate",
    "frames",
    "gravity",
    "laws",
    "model",
    "peers",
    "population",
    "rail_leg",
    "replay",
    "screen",
    "shared",
    "single",
    "table1",
    "variations",
]

# fmt: skip
