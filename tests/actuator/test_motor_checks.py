"""Every contradiction of a motor file ends with one line that names the file, the key and the cure."""

import math
import re
from dataclasses import replace
from pathlib import Path

import pytest

from pareto_monoped.actuator.actuator import build_actuator
from pareto_monoped.actuator.motor import HolePattern
from pareto_monoped.actuator.motors import contradiction, load_motor, motor_names
from pareto_monoped.actuator.search import map_for
from pareto_monoped.errors import MotorError
from pareto_monoped.geometry.roles import Role

VALUES = {
    "kv_rpm_per_v": "100.0",
    "max_continuous_current_a": "40.0",
    "rated_voltage_v": "48.0",
    "winding_resistance_ohm": "0.06",
    "framed": "{ mass_kg = 0.71, outer_diameter_mm = 89.0, length_mm = 50.0 }",
}


def written(tmp_path: Path, **changes: str) -> str:
    path = tmp_path / "mine.toml"
    path.write_text("".join(f"{key} = {value}\n" for key, value in (VALUES | changes).items()))
    return str(path)


def holes(circle: float, hole: float = 4.0, count: int = 4) -> str:
    return f"{{ pitch_circle_mm = {circle}, diameter_mm = {hole}, count = {count} }}"


def framed(diameter: float = 89.0, length: float = 50.0) -> str:
    return f"{{ mass_kg = 0.71, outer_diameter_mm = {diameter}, length_mm = {length} }}"


BAD = {
    "k_t against Kv": (
        {"torque_constant_n_m_per_a": "0.5"},
        "torque_constant_n_m_per_a = 0.5: must be within 10% of 0.09549 N m/A, 60 / (2 pi kv_rpm_per_v) with "
        "kv_rpm_per_v = 100; correct one of them or leave out torque_constant_n_m_per_a",
    ),
    "k_t per ampere of a phase's amplitude": (
        {"torque_constant_n_m_per_a": "0.0827"},
        "torque_constant_n_m_per_a = 0.0827: must be within .* amplitude, divide it by 0.8660",
    ),
    "k_t per ampere of a phase's RMS value": (
        {"torque_constant_n_m_per_a": "0.117"},
        "torque_constant_n_m_per_a = 0.117: must be within .* RMS value, divide it by 1.2247",
    ),
    "peak current against voltage and resistance": (
        {"peak_torque_n_m": "300.0", "winding_resistance_ohm": "0.1"},
        "peak_torque_n_m = 300: its current of 3142 A needs 314.2 V in 0.1 ohm (winding_resistance_ohm), must be at "
        "most rated_voltage_v = 48; correct one of them",
    ),
    "the same with the resistance of a phase": (
        {"peak_torque_n_m": "30.0", "winding_resistance_ohm": "0.1", "winding_resistance_kind": '"phase"'},
        "peak_torque_n_m = 30: its current of 314.2 A needs 62.83 V in 0.2 ohm",
    ),
    "huge torque": (
        {"peak_torque_n_m": "300.0", "winding_resistance_ohm": "0.001"},
        "peak_torque_n_m = 300: would shear an air gap of 80.1 mm by 50 mm with 595.3 kPa, must be at most 100 kPa; "
        "correct it, kv_rpm_per_v, max_continuous_current_a or the motor's size",
    ),
    "huge current": (
        {"max_continuous_current_a": "1e6", "winding_resistance_ohm": "1e-9"},
        "peak_torque_n_m = 1.375e+05: would shear an air gap",
    ),
    "continuous above peak": (
        {"peak_torque_n_m": "1.0"},
        "peak_torque_n_m = 1.0: must be at least the continuous torque, 3.82 N m; correct one of them",
    ),
    "huge voltage": (
        {"rated_voltage_v": "9999999999999999999999"},
        "rated_voltage_v = 1e+22: must be at most 1500 V, the end of low voltage; correct it",
    ),
    "fast": (
        {"kv_rpm_per_v": "1e4"},
        "kv_rpm_per_v = 10000: the rotor's rim would run at 2237 m/s with rated_voltage_v = 48, must be at most "
        "150 m/s; correct one of them",
    ),
    "2 mm long": (
        {"framed": framed(length=2.0)},
        "framed.length_mm = 2: must be at least 12 mm for face, base and magnets; correct it or leave out framed",
    ),
    "small": (
        {"framed": framed(diameter=20.0), "max_continuous_current_a": "1.0"},
        "framed.outer_diameter_mm = 20: must be at least 35 mm to hold the bolts of its base; choose a larger motor",
    ),
    "mounting holes outside the motor": (
        {"mount_holes": holes(300.0)},
        "mount_holes.pitch_circle_mm = 300: must be at most 83 mm, so that holes of 4 mm lie within "
        "outer_diameter_mm = 89; correct one of them",
    ),
    "output holes outside the motor": (
        {"output_holes": holes(86.0)},
        "output_holes.pitch_circle_mm = 86: must be at most",
    ),
    "huge holes": (
        {"mount_holes": holes(51.0, 20.0)},
        "mount_holes.diameter_mm = 20: must be at most 8 mm; give smaller holes",
    ),
    "mounting holes in the bearing's seat": (
        {"mount_holes": holes(20.0)},
        "mount_holes.pitch_circle_mm = 20: must be at least 29 mm, with holes of 4 mm around the rear bearing's seat, "
        "25 mm across; give a larger circle or smaller holes",
    ),
    "output holes in the hub": (
        {"output_holes": holes(15.0)},
        "output_holes.pitch_circle_mm = 15: must be at least 18 mm, with holes of 4 mm around the coupling's hub",
    ),
    "holes in each other": (
        {"mount_holes": holes(30.0, count=24)},
        "mount_holes.count = 24: the holes of 4 mm stand 3.92 mm apart on a circle of 30 mm, must be 5 mm or more; "
        "give fewer or smaller holes",
    ),
    "winding that conducts too little": (
        {
            "thermal": "{ winding_heat_capacity_j_per_k = 16.3, housing_heat_capacity_j_per_k = 512.0, "
            "winding_to_housing_k_per_w = 2.0, winding_limit_degc = 115.0 }"
        },
        "thermal.winding_to_housing_k_per_w = 2.0: must be less than 0.696 K/W, all that the continuous current "
        "allows; correct it or give housing_to_ambient_k_per_w",
    ),
    "a motor of one gram": (
        {"framed": "{ mass_kg = 0.001, outer_diameter_mm = 89.0, length_mm = 50.0 }"},
        "framed.mass_kg = 0.001: 3.215 kg/m3 over the motor's size, must be from 800 to 8000 kg/m3, or 0.249 to 2.49 "
        "kg; correct it or the motor's size",
    ),
    "a motor heavier than copper": (
        {"framed": "{ mass_kg = 7.1, outer_diameter_mm = 89.0, length_mm = 50.0 }"},
        "framed.mass_kg = 7.1: 2.283e+04 kg/m3",
    ),
    "a light frameless motor": (
        {
            "frameless": "{ mass_kg = 0.02, outer_diameter_mm = 89.0, length_mm = 31.5, stator_inner_diameter_mm = "
            "58.0, stator_outer_diameter_mm = 77.0 }"
        },
        "frameless.mass_kg = 0.02: 177.4 kg/m3",
    ),
    "19 MW": (
        {"rated_power_w": "19e6"},
        "rated_power_w = 1.9e+07: must be from 192 to 5760 W, 0.1 to 3 times rated_voltage_v times "
        "max_continuous_current_a; correct one of them or leave it out",
    ),
    "kilowatts for watts": ({"rated_power_w": "1.9"}, "rated_power_w = 1.9: must be from 192"),
    "inertia in g cm2": (
        {"rotor_inertia_kg_m2": "4.0"},
        "rotor_inertia_kg_m2 = 4: must be from 7.03e-06 to 0.00141 kg m2 for one of 0.71 kg and 89 mm; correct it, "
        "the motor's mass or its size",
    ),
    "inertia a thousand times too small": ({"rotor_inertia_kg_m2": "4e-7"}, "rotor_inertia_kg_m2 = 4e-07: must be"),
    "a resistance of another kind": (
        {"winding_resistance_kind": '"delta"'},
        "winding_resistance_kind = 'delta': must be 'line_to_line' or 'phase'; correct it",
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_a_contradiction_ends_with_one_line(tmp_path, case):
    changes, line = BAD[case]
    path = written(tmp_path, **changes)
    with pytest.raises(MotorError) as caught:
        load_motor(path)
    message = str(caught.value)
    assert "\n" not in message
    pattern = ".*".join(re.escape(part) for part in line.split(".*"))
    assert re.match(f"motor file '{re.escape(path)}': {pattern}", message), message


def test_the_motor_that_these_spoil_is_good(tmp_path):
    assert contradiction(load_motor(written(tmp_path))) is None


def test_motors_whose_search_would_take_too_long_are_refused(tmp_path):
    heavy = "{{ mass_kg = 30.0, outer_diameter_mm = {}, length_mm = 50.0 }}"
    assert load_motor(written(tmp_path, framed=heavy.format("400.0"))).framed.outer_diameter_mm == 400.0
    with pytest.raises(MotorError, match="400"):
        load_motor(written(tmp_path, framed=heavy.format("400.1")))


@pytest.mark.parametrize("name", motor_names())
def test_shipped_motors_are_consistent(name):
    assert contradiction(load_motor(name)) is None


@pytest.mark.parametrize(
    ("share", "good"), [(0.901, True), (1.099, True), (0.899, False), (1.101, False), (0.953, True)]
)
def test_the_tolerance_of_k_t(tmp_path, share, good):
    """0.953 is that of T-Motor's AK80-6: 0.091 N m/A at 100 rpm/V."""
    motor = replace(load_motor(written(tmp_path)), torque_constant_n_m_per_a=share * 60.0 / (2.0 * math.pi * 100.0))
    assert (contradiction(motor) is None) is good


@pytest.mark.parametrize(("circle", "hole"), [(29.0, 4.0), (28.0, 3.0), (30.0, 5.0)])
def test_the_least_mounting_circle_clears_the_seat_of_the_rear_bearing(circle, hole):
    """In the backplate of an ISSPG: the pad of the threads begins where the wall of the seat ends, or further out."""
    motor = replace(load_motor("U8"), mount_holes=HolePattern(pitch_circle_mm=circle, diameter_mm=hole, count=4))
    assert contradiction(motor) is None
    usual = map_for("U8").lookup(4.5)
    assert usual.family == "ISSPG"
    actuator = build_actuator(motor, "ISSPG", usual.gears, map_for("U8").settings)
    (plate,) = (part for part in actuator.parts if part.name == "backplate")
    outer_of_seat = 9.5 + 2.5
    inner_of_pad = min(
        float(h.radius_mm) for p in plate.prisms for h in p.holes if 12.0 <= getattr(h, "radius_mm", 0.0) < 20.0
    )
    assert inner_of_pad >= outer_of_seat


def test_the_least_output_circle_clears_the_hub_of_the_coupling():
    motor = replace(load_motor("MN8014"), output_holes=HolePattern(pitch_circle_mm=18.0, diameter_mm=4.0, count=4))
    assert contradiction(motor) is None
    usual = map_for("MN8014").lookup(6.0)
    assert usual.family == "ESSPG"
    actuator = build_actuator(motor, "ESSPG", usual.gears, map_for("MN8014").settings)
    (coupling,) = (part for part in actuator.parts if part.role is Role.COUPLING)
    (prism,) = coupling.prisms
    bolts = next(hole for hole in prism.holes if getattr(hole, "count", 0) == 4)
    # 4 mm of metal around the sun's shaft of 6 mm, less half the play of a clearance hole.
    assert float(bolts.pitch_radius_mm) - float(bolts.radius_mm) >= 3.0 + 4.0 - 0.1
