"""The constraints on a gearbox, by name."""

from typing import Literal, get_args

ConstraintName = Literal[
    "meshing", "no_interference", "teeth_min", "tip_thickness", "gearbox_diameter", "ring_root", "root_fillet",
    "sun_rim", "planet_rim", "ring_rim", "ring_interference", "contact_ratio", "within_stator", "bearing",
    "bearing_room", "face_width", "flank_strength", "root_strength", "overload_strength", "output_bearing",
    "planet_bearing",
]  # fmt: skip
"""Names of the rules in ``rules.CONSTRAINTS``. They stand here because the rules read the settings, which check names,
and because the command line lists them without any of that."""
CONSTRAINT_NAMES: tuple[ConstraintName, ...] = get_args(ConstraintName)
