"""Motors: derived values against their definitions, and a clear line for every bad file."""

import json
import math
from pathlib import Path

import pytest

from pareto_monoped.actuator.motor import PEAK_TO_CONTINUOUS, motor_order
from pareto_monoped.actuator.motors import load_motor, motor_names, motor_values, stored_motor
from pareto_monoped.errors import DatabaseError, MotorError

GOOD = """
description = "a motor of my own"
kv_rpm_per_v = 90.0
max_continuous_current_a = 30.0
rated_voltage_v = 36.0
winding_resistance_ohm = 0.1
framed = { mass_kg = 0.5, outer_diameter_mm = 90.0, length_mm = 40.0 }
[frameless]
mass_kg = 0.4
outer_diameter_mm = 90.0
length_mm = 30.0
stator_inner_diameter_mm = 60.0
stator_outer_diameter_mm = 80.0
"""


def written(tmp_path: Path, text: str) -> str:
    path = tmp_path / "mine.toml"
    path.write_text(text)
    return str(path)


def test_the_papers_motor_is_the_first_of_six():
    assert motor_names() == ("VT8020", "U8", "U10", "U12", "MN8014", "MAD_M6C12")
    motor = load_motor("vt8020")
    assert motor.name == "VT8020"
    assert motor.peak_torque_n_m == 5.5
    # 60 / (2 pi 100) x 40 A, as its data sheet: 3.82 N m; 4,800 rpm.
    assert motor.continuous_torque_n_m == pytest.approx(3.82, abs=0.005)
    assert motor.no_load_speed_rad_per_s == pytest.approx(4800.0 * 2.0 * math.pi / 60.0)


@pytest.mark.parametrize("name", motor_names())
def test_derived_values(name):
    motor = load_motor(name)
    assert motor.torque_constant_n_m_per_a == pytest.approx(9.5493 / motor.kv_rpm_per_v, rel=1e-4)
    assert motor.continuous_torque_n_m == pytest.approx(
        motor.torque_constant_n_m_per_a * motor.max_continuous_current_a
    )
    assert motor.peak_torque_n_m == pytest.approx(PEAK_TO_CONTINUOUS * motor.continuous_torque_n_m, rel=1e-3)
    assert motor.rotor_mass_share == motor.estimated_rotor_mass_share()
    assert 0.2 < motor.rotor_mass_share < 0.5


def test_the_estimated_rotor_inertia_of_the_u8_lies_between_the_published_ones():
    motor = load_motor("U8")
    assert 6.07e-5 <= motor.estimated_rotor_inertia_kg_m2() <= 6.3e-5
    assert motor.rotor_inertia_kg_m2 == 6.07e-5


def test_rotor_inertias_that_are_not_published_are_estimated():
    for name in motor_names():
        motor = load_motor(name)
        if name != "U8":
            assert motor.rotor_inertia_kg_m2 == motor.estimated_rotor_inertia_kg_m2()
    # Below that of the whole active mass at the outer radius.
    assert load_motor("VT8020").rotor_inertia_kg_m2 == pytest.approx(4.03e-4, rel=1e-3)
    assert load_motor("VT8020").rotor_inertia_kg_m2 < 0.560 * 0.0445**2


def test_a_framed_motor_s_rotor_is_a_ring_with_its_share_of_79_percent_of_the_mass():
    """The MN8014 has no published stator: its diameters and its active mass follow from proportions."""
    motor = load_motor("MN8014")
    outer = motor.framed.outer_diameter_mm
    stator_out, stator_in = 0.90 * outer, 0.67 * outer
    # Cross-sections times the mean densities: iron and 80 percent of magnets; laminations, and copper with end turns.
    rotor = (0.5 * 7.85 + 0.5 * 0.8 * 7.5) * (outer**2 - (stator_out + 1.0) ** 2)
    stator = (0.6 * 7.8 + 1.5 * 0.4 * 0.45 * 8.96) * (stator_out**2 - stator_in**2)
    share = rotor / (rotor + stator)
    assert motor.rotor_mass_share == pytest.approx(share, rel=1e-3)
    mass = share * 0.79 * motor.framed.mass_kg
    radii = 0.5e-3 * (stator_out + 1.0), 0.5e-3 * outer
    assert motor.estimated_rotor_inertia_kg_m2() == pytest.approx(
        0.5 * mass * (radii[0] ** 2 + radii[1] ** 2), rel=1e-3
    )


def test_a_motor_of_my_own(tmp_path):
    motor = load_motor(written(tmp_path, GOOD))
    assert motor.name == "mine"
    assert motor.frameless.stator_height_mm == 28.0
    assert motor.mount_holes.count == 4
    given = load_motor(written(tmp_path, "rotor_inertia_kg_m2 = 2e-4\npeak_torque_n_m = 9.0\n" + GOOD))
    assert given.rotor_inertia_kg_m2 == 2e-4
    assert given.peak_torque_n_m == 9.0


def test_bolt_circles_that_are_not_given_are_the_vt8020s_scaled_to_the_diameter(tmp_path):
    motor = load_motor(written(tmp_path, GOOD))
    assert motor.mount_holes.pitch_circle_mm == pytest.approx(51.0 * 90.0 / 89.0)
    assert motor.output_holes.pitch_circle_mm == pytest.approx(71.5 * 90.0 / 89.0)
    assert (motor.mount_holes.count, motor.mount_holes.diameter_mm) == (4, 4.0)
    assert (motor.output_holes.count, motor.output_holes.diameter_mm) == (6, 3.0)


def test_circles_that_are_not_given_leave_room_for_what_lies_within(tmp_path):
    small = GOOD.replace("0.5, outer_diameter_mm = 90.0, length", "0.15, outer_diameter_mm = 40.0, length")
    motor = load_motor(written(tmp_path, small.partition("[frameless]")[0]))
    assert motor.mount_holes.pitch_circle_mm == 29.0  # rather than 22.9
    assert motor.output_holes.pitch_circle_mm == pytest.approx(71.5 * 40.0 / 89.0)


def published_holes():
    """``reference/motor_mounts.csv``: circle, hole and number, in the base and in the turning face."""
    return {
        "VT8020": ((51.0, 5.0, 4), (71.5, 3.0, 6)),
        "U8": ((32.0, 4.0, 4), (23.0, 4.0, 4)),
        "U10": ((32.0, 4.0, 4), (23.0, 4.0, 4)),
        "U12": ((40.0, 5.0, 4), (23.0, 4.0, 4)),
        "MN8014": ((36.0, 4.0, 4), (23.0, 4.0, 4)),
        "MAD_M6C12": ((32.0, 4.0, 4), (22.0, 3.0, 4)),
    }


@pytest.mark.parametrize("name", motor_names())
def test_bolt_circles_are_the_published_ones(name):
    motor = load_motor(name)
    found = [(h.pitch_circle_mm, h.diameter_mm, h.count) for h in (motor.mount_holes, motor.output_holes)]
    assert tuple(found) == published_holes()[name]


@pytest.mark.parametrize("name", motor_names())
def test_stored_motors_read_back_equal(name):
    motor = load_motor(name)
    values = json.loads(json.dumps(motor_values(motor)))
    assert stored_motor(values, source="x") == motor
    assert ("thermal" in values, "winding_resistance_kind" in values) == (name == "U8", name == "MAD_M6C12")


def test_a_price_is_stored_where_there_is_one(tmp_path):
    """Studies stored before there were prices keep their hash."""
    assert "price_eur" not in motor_values(load_motor("U8"))
    motor = load_motor(written(tmp_path, "price_eur = 310.0\n" + GOOD))
    assert motor_values(motor)["price_eur"] == 310.0
    assert stored_motor(motor_values(motor), source="x") == motor
    with pytest.raises(MotorError, match=r"price_eur = -1.0: must be above 0"):
        load_motor(written(tmp_path, "price_eur = -1.0\n" + GOOD))


def test_a_motor_stored_by_0_1_0_is_what_it_was():
    """No copper in the stator, hence a heavier rotor; nothing but what was stored is stored again."""
    values = motor_values(load_motor("VT8020"))
    del values["rotor_mass_share"]
    values["rotor_inertia_kg_m2"] = 5.24e-4
    motor = stored_motor(values, source="x")
    rotor, stator = 7.5 * (89.0**2 - 78.0**2), 4.68 * (77.0**2 - 58.0**2)
    assert motor.rotor_mass_share == pytest.approx(rotor / (rotor + stator), rel=1e-12)
    assert (motor.rotor_inertia_kg_m2, motor.thermal, motor.winding_resistance_kind) == (5.24e-4, None, "line_to_line")
    assert motor_values(motor) == values


def test_a_stored_motor_may_contradict_itself_but_not_be_impossible():
    values = motor_values(load_motor("VT8020")) | {"torque_constant_n_m_per_a": 0.5}
    assert stored_motor(values, source="x").torque_constant_n_m_per_a == 0.5
    with pytest.raises(DatabaseError, match=r"^my study: kv_rpm_per_v = -1.0: .*above 0"):
        stored_motor(values | {"kv_rpm_per_v": -1.0}, source="my study", error=DatabaseError)


def test_a_file_in_the_shipped_form(tmp_path):
    motor = load_motor(written(tmp_path, "[my_motor]" + GOOD.replace("[frameless]", "[my_motor.frameless]")))
    assert motor.name == "my_motor"


KV = "kv_rpm_per_v = 90.0"
BAD = {
    "a field missing": (KV + "\n", "", ("kv_rpm_per_v", "missing")),
    "text for a number": (KV, 'kv_rpm_per_v = "fast"', ("kv_rpm_per_v", "fast", "number")),
    "not a number": (KV, "kv_rpm_per_v = nan", ("kv_rpm_per_v", "nan")),
    "unknown field": (KV, KV + "\nkv = 3", ("unknown key 'kv'",)),
    "no TOML": (KV, KV + " x", ("not valid TOML",)),
    "negative mass": ("{ mass_kg = 0.5", "{ mass_kg = -0.5", ("framed.mass_kg", "-0.5", "above 0")),
    "huge diameter": ("= 90.0, length", "= 900.0, length", ("framed.outer_diameter_mm", "900.0", "at most")),
    "zero diameter": ("= 90.0, length", "= 0.0, length", ("framed.outer_diameter_mm", "0.0", "above 0")),
    "stator larger than motor": (
        "stator_outer_diameter_mm = 80.0",
        "stator_outer_diameter_mm = 95.0",
        ("stator_outer_diameter_mm = 95.0", "outer_diameter_mm = 90.0"),
    ),
    "bore larger than stator": (
        "stator_inner_diameter_mm = 60.0",
        "stator_inner_diameter_mm = 81.0",
        ("stator_inner_diameter_mm = 81.0", "80.0"),
    ),
    "bore missing": ("stator_inner_diameter_mm = 60.0\n", "", ("stator_inner_diameter_mm", "missing")),
    "kit heavier than motor": ("mass_kg = 0.4", "mass_kg = 0.6", ("frameless.mass_kg = 0.6", "framed.mass_kg = 0.5")),
    "shorter than its bell": ("length_mm = 30.0", "length_mm = 1.5", ("length_mm = 1.5", "bell")),
    "stator higher than motor": (
        "length_mm = 30.0",
        "length_mm = 30.0\nstator_height_mm = 31.0",
        ("stator_height_mm = 31.0", "length_mm = 30.0"),
    ),
    "zero torque": (KV, KV + "\npeak_torque_n_m = 0.0", ("peak_torque_n_m", "0.0")),
    "peak below continuous": (KV, KV + "\npeak_torque_n_m = 1.0", ("peak_torque_n_m = 1.0", "continuous")),
    "hole larger than its circle": (
        KV,
        KV + "\nmount_holes = { pitch_circle_mm = 5.0, diameter_mm = 6.0, count = 4 }",
        ("diameter_mm = 6.0", "pitch_circle_mm"),
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_files_get_one_line_that_says_what_is_wrong(tmp_path, case):
    old, new, words = BAD[case]
    assert old in GOOD
    path = written(tmp_path, GOOD.replace(old, new, 1))
    with pytest.raises(MotorError) as caught:
        load_motor(path)
    message = str(caught.value)
    assert "\n" not in message
    assert "mine.toml" in message
    for word in words:
        assert word in message


def test_a_motor_without_any_body(tmp_path):
    text = "\n".join(line for line in GOOD.partition("[frameless]")[0].splitlines() if not line.startswith("framed"))
    with pytest.raises(MotorError, match="framed and frameless are both missing"):
        load_motor(written(tmp_path, text))


def test_unknown_names_and_missing_files():
    with pytest.raises(MotorError, match=r"motor = 'VT8021': must be one of VT8020, U8.* or a TOML file"):
        load_motor("VT8021")
    with pytest.raises(MotorError, match="no such file"):
        load_motor("nowhere.toml")


def test_a_frameless_motor_is_ordered_with_the_sizes_that_tell_it_from_the_framed_one():
    """Makers list some of them framed only (U12): the order says what is taken of it."""
    motor = load_motor("U12")
    kit = "stator and rotor without frame, stator 70 x 95 mm, 578 g together"
    assert motor_order(motor, "frameless").text == f"motor U12, frameless, 120 rpm/V, T-Motor U12, {kit}"
    assert motor_order(motor, "framed").text == "motor U12, framed, 120 rpm/V, T-Motor U12"
