"""Golden values of every part of base, links and foot.

Those of version 0.3.0.

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
    "hip_mount_dowel": (1.665, 0.0, 0.0, -23.0, 49.096),
    "base_near_cheek": (172.75, 0.0, 25.209, -20.501, 52.414),
    "hip_mount_screw": (4.008, 0.0, 0.0, -20.997, 49.113),
    "base_far_cheek": (146.088, 0.0, 47.965, 118.683, 39.519),
    "base_bearing": (17.0, 0.0, 0.0, 118.17, 13.494),
    "base_rod": (100.227, 0.0, 77.206, 48.585, 49.047),
    "base_lower_rod_screw_near": (4.943, 0.0, 62.206, -20.771, 33.73),
    "base_upper_rod_screw_near": (5.069, 0.0, 92.206, -22.665, 18.99),
    "base_lower_rod_screw_far": (5.069, 0.0, 62.206, 119.835, 33.724),
    "base_upper_rod_screw_far": (5.733, 0.0, 92.206, 120.279, 19.408),
    "hip_seat_front": (35.397, 35.285, 81.571, -2.564, 19.252),
    "hip_bumper_front": (16.713, 57.797, 66.547, 0.0, 10.739),
    "hip_seat_rear": (35.397, -35.285, 81.571, -2.564, 19.252),
    "hip_bumper_rear": (16.713, -57.797, 66.547, 0.0, 10.739),
    "hip_seat_screw": (3.384, 0.0, 77.206, -17.892, 26.126),
    "hip_driver_plate": (10.53, 0.0, 88.745, -24.51, 24.312),
    "hip_standoff_screw": (1.784, 0.0, 89.206, -25.364, 30.869),
    "hip_standoff": (1.846, 0.0, 89.206, -29.5, 30.945),
    "hip_driver": (32.0, 0.0, 89.206, -41.668, 19.471),
    "hip_driver_screw": (3.117, 0.0, 89.206, -35.531, 30.891),
    "knee_driver_plate": (10.53, 0.0, 88.745, 123.68, 24.312),
    "knee_standoff_screw": (1.784, 0.0, 89.206, 124.534, 30.869),
    "knee_standoff": (1.846, 0.0, 89.206, 128.67, 30.945),
    "knee_driver": (32.0, 0.0, 89.206, 140.838, 19.471),
    "knee_driver_screw": (3.117, 0.0, 89.206, 134.701, 30.891),
    "thigh_plate_inner": (145.24, 0.716, -183.778, -13.247, 160.693),
    "thigh_plate_outer": (142.993, 0.727, -184.649, 13.246, 162.994),
    "thigh_core": (110.345, 0.0, -210.25, 0.0, 102.616),
    "thigh_standoff": (7.411, 0.0, 26.333, -0.82, 30.397),
    "thigh_standoff_screw": (1.595, 0.0, 26.333, 11.885, 29.581),
    "thigh_bolt": (27.651, 1.976, -216.01, -1.063, 141.599),
    "hip_coupling": (10.328, 0.0, 0.0, -18.721, 12.003),
    "hip_coupling_dowel": (4.735, 0.0, 0.0, -20.0, 12.936),
    "hip_coupling_screw": (8.226, 0.0, 0.0, -15.803, 13.326),
    "knee_mount_screw": (4.999, 0.0, 0.0, 11.889, 49.085),
    "knee_mount_dowel": (2.663, 0.0, 0.0, 15.0, 49.066),
    "drive_shaft": (27.334, 0.0, 0.0, -2.049, 11.117),
    "drive_bearing": (4.6, 0.0, 0.0, -15.0, 7.638),
    "drive_sprocket": (18.946, 0.0, 0.0, 0.012, 21.761),
    "drive_coupling": (10.891, 0.0, 0.0, 9.85, 11.801),
    "drive_dowel": (5.919, 0.0, 0.0, 8.4, 13.392),
    "drive_screw": (9.639, 0.0, 0.0, 3.877, 13.93),
    "chain_hip": (112.395, 0.0, -6.499, 0.0, 36.257),
    "chain_knee": (112.395, 0.0, -393.501, 0.0, 36.257),
    "turnbuckle_bar": (38.597, 0.0, -200.0, 0.0, 87.724),
    "turnbuckle_end_hip": (15.77, 0.0, -59.089, 0.0, 29.872),
    "turnbuckle_nut_hip": (1.678, 0.0, -66.45, 0.0, 28.754),
    "turnbuckle_end_knee": (15.77, 0.0, -340.911, 0.0, 29.872),
    "turnbuckle_nut_knee": (1.678, 0.0, -333.55, 0.0, 28.754),
    "knee_bearing_cup": (21.493, 0.0, -400.0, 0.0, 20.619),
    "knee_cup_screw_near": (1.344, 0.0, -400.0, -11.78, 18.702),
    "knee_cup_screw_far": (1.344, 0.0, -400.0, 11.78, 18.702),
    "knee_bearing": (34.0, 0.0, -400.0, 0.0, 15.948),
    "hip_striker_front": (9.099, 41.453, -68.474, 0.0, 9.206),
    "hip_striker_rear": (9.099, -41.453, -68.474, 0.0, 9.206),
    "knee_seat_extension": (13.73, 57.542, -416.816, 0.0, 11.02),
    "knee_bumper_extension": (32.758, 44.53, -428.533, 0.0, 12.78),
    "knee_seat_flexion": (13.73, -42.995, -346.677, 0.0, 11.02),
    "knee_bumper_flexion": (32.758, -60.481, -345.76, 0.0, 12.78),
    "journal": (37.18, 0.0, 0.0, 107.968, 20.331),
    "journal_screw": (15.4, 0.0, 0.0, 107.294, 26.045),
    "shank_plate_near": (106.21, 2.367, -153.522, -17.995, 120.348),
    "shank_plate_far": (106.21, 2.367, -153.522, 17.995, 120.348),
    "shank_core": (123.415, 0.0, -229.1, 0.0, 79.424),
    "shank_bolt": (15.006, 0.0, -229.1, -1.209, 111.853),
    "knee_axle": (41.894, 0.0, 0.0, 0.0, 17.054),
    "knee_axle_dowel_near": (3.946, 0.0, 0.0, -14.5, 7.522),
    "knee_axle_dowel_far": (3.946, 0.0, 0.0, 14.5, 7.522),
    "knee_spacer": (3.007, 0.0, 0.0, 0.0, 18.01),
    "knee_bolt": (25.238, 0.0, 0.0, 0.165, 17.104),
    "foot_block": (60.295, 0.0, -365.843, 0.0, 17.45),
    "foot_bolt": (12.492, 0.0, -363.2, -0.837, 16.071),
    "knee_striker": (44.247, 27.507, -63.641, 0.0, 33.825),
    "knee_striker_bolt": (12.492, 26.945, -64.276, -0.837, 36.461),
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
            "base_frame": 0.738148,
            "hip_actuator": 1.196547,
            "thigh": 1.089030,
            "knee_actuator": 1.670727,
            "journal": 0.042185,
            "shank": 0.558398,
            "foot": 0.152349,
        },
        abs=1e-6,
    )


def test_notes_for_the_maker_give_the_sizes_that_are_drawn(design, actuator_map):
    notes = {part.name: part.described for unit in build_robot(design, actuator_map).units for part in unit.parts}
    for name, note in {
        "base_near_cheek": "6 mm sheet",
        "knee_bumper_flexion": "round bar FKM 75 Shore A, 28 mm, cut to 28 mm",
        "knee_striker_bolt": (
            "countersunk screw ISO 10642 - M4 x 16 - 8.8; sleeve nut M4 x 30, countersunk 90 degrees, 5 mm outside, "
            "internal hex or slot, steel zinc plated; flush, 39 mm together"
        ),
        "base_far_cheek": "8 mm plate",
        "base_bearing": "NSK 6804VVC3, 20 x 32 x 7 mm",
        "base_rod": "10 mm bar, drilled from both ends; the test stand's carriage clamps to the rods",
        "thigh_plate_inner": "2.5 mm sheet",
        "thigh_plate_outer": "2.5 mm sheet; carries the knee actuator",
        "thigh_standoff": "spigot into the inner plate, screwed to the outer one",
        "thigh_bolt": (
            "countersunk screw ISO 10642 - M3 x 16 - 8.8; sleeve nut M3 x 20, countersunk 90 degrees, 4 mm outside, "
            "internal hex or slot, steel zinc plated; flush, 29 mm together"
        ),
        "drive_sprocket": "084, 14 teeth (ISO 606)",
        "knee_bearing": "NSK 6804VVC3, 20 x 32 x 7 mm",
        "journal_screw": (
            "cap screw ISO 4762 - M5 x 12 - 8.8; through the knee actuator's backplate into the threads in its motor's "
            "base; tighten with the seat's run-out at 0.05 mm or less, measured as the thigh swings"
        ),
        "knee_bolt": "cap screw ISO 4762 - M4 x 45 - 8.8; nut ISO 4032 - M4 - 8; clamps the whole knee",
    }.items():
        assert notes[name] == note, name
