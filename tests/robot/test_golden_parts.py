"""Golden values of every part of base, links and foot.

Those of version 0.1.0; with the end stops came their parts, the bolts, ears and heel that carry them on the thigh, and
holes in the near cheek and the shank's plates.

A changed dimension, place or material shows here, whether or not a drawn rule forbids it.
"""

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.robot.build import build_robot

# Name -> mass in g, centre of mass in mm in the body's part frame (x forward, y up along the link, z along the joint
# axis), radius of gyration about it in mm, sqrt(trace(I) / 2 m).
PARTS = {
    "base_near_cheek": (170.39, 0.0, 24.028, -20.5, 52.023),
    "hip_mount_screw": (2.922, 0.0, 0.0, -22.082, 49.091),
    "base_far_cheek": (143.014, 0.0, 46.786, 125.759, 39.084),
    "base_bearing": (17.0, 0.0, 0.0, 125.246, 13.494),
    "base_rod": (105.64, 0.0, 75.0, 52.123, 50.286),
    "base_rod_screw_near": (9.887, 0.0, 75.0, -20.771, 30.594),
    "base_rod_screw_far": (10.139, 0.0, 75.0, 126.912, 30.588),
    "hip_seat_front": (35.205, 34.836, 78.645, -2.579, 19.166),
    "hip_bumper_front": (16.713, 56.973, 62.34, 0.0, 10.739),
    "hip_seat_rear": (35.205, -34.836, 78.645, -2.579, 19.166),
    "hip_bumper_rear": (16.713, -56.973, 62.34, 0.0, 10.739),
    "hip_seat_screw": (2.527, 0.0, 75.0, -16.248, 25.464),
    "thigh_plate_inner": (118.136, 1.642, -181.084, -13.25, 166.774),
    "thigh_plate_outer": (120.041, 1.616, -175.445, 13.25, 170.587),
    "thigh_core": (110.825, 0.0, -211.25, 0.0, 103.224),
    "thigh_standoff": (4.806, 0.0, 24.333, 0.0, 28.222),
    "thigh_bolt": (32.14, -0.171, -163.702, -1.571, 165.618),
    "hip_coupling": (10.347, 0.0, 0.0, -19.0, 11.769),
    "hip_coupling_screw": (8.226, 0.0, 0.0, -15.803, 13.326),
    "knee_mount_screw": (4.999, 0.0, 0.0, 11.889, 49.085),
    "drive_sprocket": (26.637, 0.0, 0.0, 0.0, 19.263),
    "drive_coupling": (15.061, 0.0, 0.0, 7.95, 12.085),
    "drive_screw": (9.599, 0.0, 0.0, 4.232, 13.92),
    "chain_hip": (77.76, 0.0, -73.808, 0.0, 64.064),
    "chain_knee": (77.76, 0.0, -326.192, 0.0, 64.064),
    "turnbuckle_barrel": (5.882, 0.0, -200.0, 0.0, 27.0),
    "turnbuckle_end": (16.717, 0.0, -200.0, 0.0, 36.074),
    "knee_bearing_cup": (21.55, 0.0, -400.0, 0.0, 20.615),
    "knee_cup_screw_near": (0.955, 0.0, -400.0, -10.863, 18.667),
    "knee_cup_screw_far": (0.955, 0.0, -400.0, 10.863, 18.667),
    "knee_bearing": (34.0, 0.0, -400.0, 0.0, 15.948),
    "hip_striker_front": (9.099, 37.453, -66.933, 0.0, 9.206),
    "hip_striker_rear": (9.099, -37.453, -66.933, 0.0, 9.206),
    "knee_seat_extension": (9.904, 30.834, -456.665, 0.0, 9.967),
    "knee_bumper_extension": (16.713, 17.238, -458.334, 0.0, 10.739),
    "knee_seat_flexion": (9.904, -38.622, -343.729, 0.0, 9.967),
    "knee_bumper_flexion": (16.713, -52.245, -345.161, 0.0, 10.739),
    "journal": (37.087, 0.0, 0.0, 114.937, 20.313),
    "journal_screw": (15.4, 0.0, 0.0, 114.37, 26.045),
    "shank_plate": (196.446, -0.063, -162.038, 0.0, 121.973),
    "shank_core": (128.937, 0.0, -222.6, 0.0, 83.337),
    "shank_bolt": (13.835, 0.0, -222.6, -1.684, 118.196),
    "knee_axle": (15.668, 0.0, 0.0, 6.709, 10.202),
    "knee_axle_cap": (11.681, 0.0, 0.0, -8.358, 8.996),
    "knee_spacer": (3.007, 0.0, 0.0, 0.0, 18.01),
    "knee_sprocket": (26.637, 0.0, 0.0, 0.0, 19.263),
    "knee_sprocket_screw": (1.672, 0.0, 0.0, 1.327, 12.163),
    "knee_bolt": (25.249, 0.0, 0.0, 0.174, 17.107),
    "foot_block": (59.877, 0.0, -365.861, 0.0, 17.48),
    "foot_bolt": (11.024, 0.0, -363.2, -1.359, 15.119),
    "knee_striker": (32.808, 18.222, -70.084, 0.0, 16.097),
    "knee_striker_bolt": (11.024, 17.891, -71.342, -1.359, 17.755),
    "foot": (152.349, 0.0, -403.103, 0.0, 25.084),
}


@pytest.fixture(scope="module")
def design():
    changes = {"thigh_length_m": 0.4, "shank_length_m": 0.4, "hip_ratio": 4.5, "knee_ratio": 7.5}
    return PAPER_CASES["C"].design.replace(changes)


def test_every_part_of_the_default_motor_s_leg_is_what_it_was(design, actuator_map):
    units = [u for u in build_robot(design, actuator_map).units if not u.name.endswith("_actuator")]
    parts = [part for unit in units for part in unit.parts]
    assert [part.name for part in parts] == list(PARTS)
    for part in parts:
        mass = part.mass_properties()
        gyration_m = np.sqrt(np.trace(mass.inertia_kg_m2) / (2.0 * mass.mass_kg))
        found = 1e3 * np.array([mass.mass_kg, *mass.com_m, gyration_m])
        assert found == pytest.approx(PARTS[part.name], abs=6e-4), part.name


def test_units_of_another_motor_are_what_they_were(design):
    """The U12 has a larger case and the heavier chain."""
    masses = {u.name: float(u.mass_properties().mass_kg) for u in build_robot(design, map_for("U12")).units}
    assert masses == pytest.approx(
        {
            "base_frame": 0.645272,
            "hip_actuator": 1.321625,
            "thigh": 1.019514,
            "knee_actuator": 1.879030,
            "journal": 0.042092,
            "shank": 0.557691,
            "foot": 0.152349,
        },
        abs=1e-6,
    )


def test_notes_for_the_maker_give_the_sizes_that_are_drawn(design, actuator_map):
    notes = {part.name: part.note for unit in build_robot(design, actuator_map).units for part in unit.parts}
    for name, note in {
        "base_near_cheek": (
            "6 mm sheet; countersink the screw holes: the actuator's on the thigh's side, those of the "
            "hip's seats on the actuator's"
        ),
        "knee_bumper_flexion": "FKM 75 Shore A, round bar 20 mm, cut to 28 mm",
        "knee_striker_bolt": (
            "M4 x 16 countersunk (ISO 10642) 8.8 in a countersunk sleeve nut M4 x 30, flush, 39 mm together"
        ),
        "base_far_cheek": "8 mm plate",
        "base_bearing": "6804, 20 x 32 x 7 mm (ISO 15)",
        "base_rod": "10 mm tube, tapped M4 at both ends; the test stand's carriage clamps to the rods",
        "thigh_plate_inner": "2.5 mm sheet; countersink the bolt holes outside",
        "thigh_plate_outer": ("2.5 mm sheet; carries the knee actuator; countersink the bolt holes outside"),
        "thigh_standoff": "tube, 7 mm outside, bored 4.2 mm",
        "thigh_bolt": (
            "M3 x 16 countersunk (ISO 10642) 8.8 in a countersunk sleeve nut M3 x 20, flush, 29 mm together"
        ),
        "drive_sprocket": "05B-1, 20 teeth (ISO 606)",
        "knee_bearing": "6804, 20 x 32 x 7 mm (ISO 15)",
        "journal_screw": "M5 x 12 cap screw (ISO 4762) 8.8, into the knee motor's own mounting pattern",
        "shank_plate": "3 mm sheet; countersink the bolt holes outside",
        "knee_sprocket": "05B-1, 20 teeth (ISO 606); as drive_sprocket, screw holes countersunk",
        "knee_bolt": "M4 x 45 cap screw (ISO 4762) 12.9 with nut (ISO 4032), clamps the whole knee",
    }.items():
        assert notes[name] == note, name
