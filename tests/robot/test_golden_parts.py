"""Golden values of every part of base, links and foot, taken from version 0.1.0, whose stored results stay valid.

A changed dimension, place or material shows here, whether or not a drawn rule forbids it.
"""

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.robot.build import build_robot

# Name -> mass in g, centre of mass up along the link (y) and along the joint axis (z) in mm in the body's part frame,
# radius of gyration about it in mm, sqrt(trace(I) / 2 m).
PARTS = {
    "base_near_cheek": (170.862, 24.169, -20.5, 52.036),
    "hip_mount_screw": (2.922, 0.0, -22.082, 49.091),
    "base_far_cheek": (143.014, 46.786, 125.759, 39.084),
    "base_bearing": (17.0, 0.0, 125.246, 13.494),
    "base_rod": (105.64, 75.0, 52.123, 50.286),
    "base_rod_screw_near": (9.887, 75.0, -20.771, 30.594),
    "base_rod_screw_far": (10.139, 75.0, 126.912, 30.588),
    "thigh_plate_inner": (95.484, -166.581, -13.25, 159.085),
    "thigh_plate_outer": (101.093, -155.386, 13.25, 162.294),
    "thigh_core": (110.825, -211.25, 0.0, 103.224),
    "thigh_standoff": (4.806, 24.333, 0.0, 28.222),
    "thigh_bolt": (22.251, -132.722, -1.571, 151.351),
    "hip_coupling": (10.347, 0.0, -19.0, 11.769),
    "hip_coupling_screw": (8.226, 0.0, -15.803, 13.326),
    "knee_mount_screw": (4.999, 0.0, 11.889, 49.085),
    "drive_sprocket": (26.637, 0.0, 0.0, 19.263),
    "drive_coupling": (15.061, 0.0, 7.95, 12.085),
    "drive_screw": (9.599, 0.0, 4.232, 13.92),
    "chain_hip": (77.76, -73.808, 0.0, 64.064),
    "chain_knee": (77.76, -326.192, 0.0, 64.064),
    "turnbuckle_barrel": (5.882, -200.0, 0.0, 27.0),
    "turnbuckle_end": (16.717, -200.0, 0.0, 36.074),
    "knee_bearing_cup": (21.55, -400.0, 0.0, 20.615),
    "knee_cup_screw_near": (0.955, -400.0, -10.863, 18.667),
    "knee_cup_screw_far": (0.955, -400.0, 10.863, 18.667),
    "knee_bearing": (34.0, -400.0, 0.0, 15.948),
    "journal": (37.087, 0.0, 114.937, 20.313),
    "journal_screw": (15.4, 0.0, 114.37, 26.045),
    "shank_plate": (197.137, -161.72, 0.0, 121.889),
    "shank_core": (128.937, -222.6, 0.0, 83.337),
    "shank_bolt": (13.835, -222.6, -1.684, 118.196),
    "knee_axle": (15.668, 0.0, 6.709, 10.202),
    "knee_axle_cap": (11.681, 0.0, -8.358, 8.996),
    "knee_spacer": (3.007, 0.0, 0.0, 18.01),
    "knee_sprocket": (26.637, 0.0, 0.0, 19.263),
    "knee_sprocket_screw": (1.672, 0.0, 1.327, 12.163),
    "knee_bolt": (25.249, 0.0, 0.174, 17.107),
    "foot_block": (59.877, -365.861, 0.0, 17.48),
    "foot_bolt": (11.024, -363.2, -1.359, 15.119),
    "foot": (152.349, -403.103, 0.0, 25.084),
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
        found = 1e3 * np.array([mass.mass_kg, mass.com_m[1], mass.com_m[2], gyration_m])
        assert found == pytest.approx(PARTS[part.name], abs=6e-4), part.name
        assert mass.com_m[0] == pytest.approx(0.0, abs=1e-9), part.name


def test_units_of_another_motor_are_what_they_were(design):
    """The U12 has a larger case and the heavier chain."""
    masses = {u.name: float(u.mass_properties().mass_kg) for u in build_robot(design, map_for("U12")).units}
    assert masses == pytest.approx(
        {
            "base_frame": 0.536252,
            "hip_actuator": 1.321625,
            "thigh": 0.896562,
            "knee_actuator": 1.879030,
            "journal": 0.042092,
            "shank": 0.514549,
            "foot": 0.152349,
        },
        abs=1e-6,
    )


def test_notes_for_the_maker_give_the_sizes_that_are_drawn(design, actuator_map):
    notes = {part.name: part.note for unit in build_robot(design, actuator_map).units for part in unit.parts}
    for name, note in {
        "base_near_cheek": "6 mm sheet EN AW-6082 T6; countersink the screw holes on the thigh's side",
        "base_far_cheek": "8 mm plate EN AW-6082 T6; seat 32 J7, 7 mm deep",
        "base_bearing": "6804, 20 x 32 x 7 mm (ISO 15)",
        "base_rod": "10 mm tube, tapped M4 at both ends; the test stand's carriage clamps to the rods",
        "thigh_plate_inner": "2.5 mm sheet EN AW-6082 T6; countersink the bolt holes outside",
        "thigh_plate_outer": (
            "2.5 mm sheet EN AW-6082 T6; carries the knee actuator; countersink the bolt holes outside"
        ),
        "thigh_standoff": "tube, 7 mm outside, bored 4.2 mm",
        "thigh_bolt": (
            "M3 x 16 countersunk (ISO 10642) 8.8 in a countersunk sleeve nut M3 x 20, flush, 29 mm together"
        ),
        "drive_sprocket": "05B-1, 20 teeth (ISO 606)",
        "knee_bearing": "6804, 20 x 32 x 7 mm (ISO 15)",
        "journal_screw": "M5 x 12 cap screw (ISO 4762) 8.8, into the knee motor's own mounting pattern",
        "shank_plate": "3 mm sheet EN AW-6082 T6; countersink the bolt holes outside",
        "knee_sprocket": "05B-1, 20 teeth (ISO 606); as drive_sprocket, screw holes countersunk",
        "knee_bolt": "M4 x 45 cap screw (ISO 4762) 12.9 with nut (ISO 4032), clamps the whole knee",
    }.items():
        assert notes[name] == note, name
