"""The motor drivers on the base: the choice of the board, and its place."""

import dataclasses
from itertools import combinations

import numpy as np
import pytest
import shapely

from pareto_monoped.actuator.motors import load_motor
from pareto_monoped.actuator.search import map_for
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.screws import M4
from pareto_monoped.leg.actuator_fit import MOTOR_DRIVERS, motor_driver_for, peak_current_a
from pareto_monoped.leg.base import base_parts
from pareto_monoped.leg.dimensions import leg_dimensions
from tests.leg.polygons import polygon

MOTEUS, ODRIVE = MOTOR_DRIVERS


def boards(leg):
    return {part.name: part for part in base_parts(0.09, leg) if part.role is Role.ELECTRONICS}


def test_holes_are_those_of_the_published_mounts():
    # Published from the motor's axis: 23 and 15 mm up and down, 20 mm to the sides; 29, 13 and 22.5 mm.
    assert (MOTEUS.hole_length_mm, MOTEUS.hole_width_mm) == (23.0 + 15.0, 2 * 20.0)
    assert (ODRIVE.hole_length_mm, ODRIVE.hole_width_mm) == (29.0 + 13.0, 2 * 22.5)


def test_peak_current_is_the_amplitude_that_gives_the_peak_torque():
    # Three sinusoidal currents in phase with the induced voltages, whose amplitude is k_t w / sqrt(3): the mean over a
    # turn of the sum of voltage times current, over the speed, is the torque.
    motor = load_motor("VT8020")
    angle = np.linspace(0.0, 2.0 * np.pi, 3600, endpoint=False)[:, None] - 2.0 * np.pi / 3.0 * np.arange(3)
    voltage_per_speed = motor.torque_constant_n_m_per_a / np.sqrt(3.0) * np.sin(angle)
    torque = np.mean(np.sum(voltage_per_speed * peak_current_a(motor) * np.sin(angle), axis=1))
    assert torque == pytest.approx(motor.peak_torque_n_m)


@pytest.mark.parametrize(
    ("name", "driver", "carried"),
    [
        ("U8", MOTEUS, True),  # 24 V, 40 A
        ("VT8020", ODRIVE, True),  # 48 V is too much for the lighter board
        ("U12", ODRIVE, False),  # 158 A at its peak torque
    ],
)
def test_the_lightest_board_that_carries_the_motor_is_chosen(name, driver, carried):
    motor = load_motor(name)
    assert motor_driver_for(motor) is driver
    assert driver.carries(motor) is carried


def test_a_board_that_limits_its_motor_says_so_in_the_parts_list():
    notes = {part.described for part in boards(leg_dimensions(map_for("U12"))).values()}
    assert notes == {
        "motor driver ODrive Pro, bare board; gives 120 A of the 158 A that U12 takes at its peak torque, and so 76% "
        "of that torque"
    }
    high = dataclasses.replace(load_motor("VT8020"), rated_voltage_v=60.0)
    assert ODRIVE.limit(high) == "takes 58 V, less than the 60 V of VT8020"


def with_driver(leg, driver):
    """The leg with this driver for both motors."""
    hip, knee = (dataclasses.replace(fit, driver=driver) for fit in (leg.hip, leg.knee))
    return dataclasses.replace(leg, hip=hip, knee=knee)


@pytest.mark.parametrize("driver", MOTOR_DRIVERS, ids=lambda driver: driver.name)
def test_screws_in_standoffs_are_tightened_as_spacers_for_boards_allow(leg, driver):
    """0.5 N m for M3 (Wuerth's data sheets), 0.3 N m for M2.5 (tables after DIN 267-25)."""
    screws = [
        part
        for part in base_parts(0.09, with_driver(leg, driver))
        if part.name.endswith(("standoff_screw", "driver_screw"))
    ]
    assert len(screws) == 4
    allowed_n_m = {3.0: 0.5, 2.5: 0.3}
    for screw in screws:
        diameter = screw.fastening.thread.diameter_mm
        assert 0.95 * allowed_n_m[diameter] < screw.fastening.torque_n_m <= allowed_n_m[diameter] + 1e-9


@pytest.mark.parametrize("driver", MOTOR_DRIVERS, ids=lambda driver: driver.name)
def test_each_joint_s_board_stands_outside_its_cheek(leg, driver):
    parts = base_parts(0.09, with_driver(leg, driver))
    cheeks = {part.name: part.prisms for part in parts if part.name.endswith("_cheek")}
    found = {part.name: part for part in parts if part.role is Role.ELECTRONICS}
    assert sorted(found) == ["hip_driver", "knee_driver"]
    assert max(p.z1_mm for p in found["hip_driver"].prisms) < min(p.z0_mm for p in cheeks["base_near_cheek"])
    assert min(p.z0_mm for p in found["knee_driver"].prisms) > max(p.z1_mm for p in cheeks["base_far_cheek"])
    for part in found.values():
        heights = [z for prism in part.prisms for z in (prism.z0_mm, prism.z1_mm)]
        assert max(heights) - min(heights) == pytest.approx(driver.height_mm)
        assert part.mass_kg() == driver.mass_kg


@pytest.mark.parametrize("driver", MOTOR_DRIVERS, ids=lambda driver: driver.name)
def test_a_driver_s_plate_has_as_much_metal_around_its_holes_on_all_sides(leg, driver):
    """5 mm from the outermost screws' axes, of board and rods, to each edge; no hole breaks into another."""
    plate = next(p for p in base_parts(0.09, with_driver(leg, driver)) if p.name == "hip_driver_plate").prisms[0]
    window, *round_holes = plate.holes
    board = 0.5 * driver.hole_width_mm
    screws = np.array([(c.x_mm, c.y_mm) for c in round_holes if c.radius_mm in (driver.screw.hole, M4.hole)])
    assert {*np.abs(screws[:, 0]).tolist()} == {board, leg.upper_rod_mm[0]}
    edges = [*(screws.min(axis=0) - 5.0), *(screws.max(axis=0) + 5.0)]
    assert polygon(plate.outline).bounds == pytest.approx(edges)
    rings = [polygon(window), *(shapely.Point(c.x_mm, c.y_mm).buffer(c.radius_mm) for c in round_holes)]
    # Between the two holes of a cable tie, 6 mm apart, stands 2.5 mm.
    assert min(one.distance(other) for one, other in combinations(rings, 2)) >= 2.4
    assert min(polygon(plate.outline).boundary.distance(ring) for ring in rings) >= 2.8


@pytest.mark.parametrize("driver", MOTOR_DRIVERS, ids=lambda driver: driver.name)
def test_what_stands_on_a_board_leaves_room_for_the_heads_of_its_screws(leg, driver):
    parts = {part.name: part for part in base_parts(0.09, with_driver(leg, driver))}
    board, block = (polygon(prism.outline).bounds for prism in parts["hip_driver"].prisms)
    rows = sorted({y for _, y, _ in parts["hip_driver_screw"].places_mm})
    assert rows[1] - rows[0] == driver.hole_length_mm
    assert board[1] + board[3] == block[1] + block[3] == pytest.approx(sum(rows))
    assert rows[0] + driver.screw.head < block[1] < block[3] < rows[1] - driver.screw.head


def test_a_board_carries_just_what_its_data_sheet_says():
    motor = load_motor("U8")
    just = dataclasses.replace(MOTEUS, voltage_v=motor.rated_voltage_v, peak_current_a=peak_current_a(motor))
    assert just.carries(motor)
    assert not dataclasses.replace(just, voltage_v=0.999 * just.voltage_v).carries(motor)
    assert not dataclasses.replace(just, peak_current_a=0.999 * just.peak_current_a).carries(motor)


def test_standoffs_are_ordered_with_the_threads_that_both_screws_need(leg):
    parts = {part.name: part for part in base_parts(0.09, with_driver(leg, ODRIVE))}
    assert parts["hip_standoff"].described.endswith("5.5 mm across flats, aluminium, female threads from both ends")
