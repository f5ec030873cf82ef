from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.report.motors import gearbox_numbers, leg_table, motor_tables, switches
from pareto_monoped.report.page import build
from pareto_monoped.robot.build import build_robot
from pareto_monoped.robot.population import robot_arrays


@pytest.fixture(scope="module")
def vt8020():
    return map_for("VT8020")


def test_points_are_the_intervals_of_the_map_with_its_lightest_actuators(vt8020):
    tables = motor_tables(vt8020, first=100)
    assert tables.map.ratio_step == 0.1
    assert [p.ratio_low for p in tables.map.points] == [
        entry.ratio_low for entry in vt8020.entries if entry.ratio_low <= 9.0 or entry.actuator is not None
    ]
    for point in tables.map.points:
        entry = next(entry for entry in vt8020.entries if entry.ratio_low == point.ratio_low)
        if entry.actuator is None:
            assert point.gearbox is None
            assert point.reason == entry.why_not()
            continue
        gearbox = tables.gearboxes[point.gearbox - 100]
        assert gearbox.ratio == pytest.approx(entry.actuator.ratio, abs=1e-4)
        assert gearbox.mass_kg == pytest.approx(min(point.family_mass_kg.values()), abs=1e-4)
        assert gearbox.peak_torque_n_m == pytest.approx(entry.actuator.peak_torque_n_m, abs=0.01)
        assert gearbox.no_load_speed_rad_per_s == pytest.approx(entry.actuator.no_load_speed_rad_per_s, abs=0.1)
        # No digits but those that a table shows or a simulation repeats: each costs every page four thousand times.
        assert gearbox.mass_kg == float(f"{gearbox.mass_kg:.4f}")
        motor = entry.actuator.motor
        body = motor.frameless if gearbox.family == "ISSPG" else motor.framed
        assert gearbox.motor_diameter_mm == body.outer_diameter_mm


def test_a_motor_that_is_only_sold_framed_has_its_diameter():
    actuator_map = map_for("MN8014")
    assert actuator_map.motor.frameless is None
    for gearbox in motor_tables(actuator_map, first=0).gearboxes:
        assert gearbox.motor_diameter_mm == actuator_map.motor.framed.outer_diameter_mm


def test_gearboxes_of_ratios_are_counted_like_those_of_the_map(vt8020):
    tables = motor_tables(vt8020, first=7)
    ratios = np.array([4.0, 4.1, 6.05, 8.7, 3.9, 14.95])
    for ratio, number in zip(ratios, gearbox_numbers(vt8020, ratios, first=7), strict=True):
        if number < 0:
            assert ratio in (3.9, 14.95)
        else:
            assert tables.gearboxes[number - 7].ratio == pytest.approx(vt8020.lookup(ratio).ratio, abs=1e-4)


def test_leg_is_weighed_and_drawn_with_the_dimensions_of_the_studys_own_motor(source_u12):
    """The page once weighed and drew the default motor's leg, whatever the motor."""
    actuator_map = source_u12.data.case_kit
    robots = [build_robot(case.design, actuator_map) for case in PAPER_CASES.values()]
    arrays = robot_arrays([case.design.as_array() for case in PAPER_CASES.values()], actuator_map)
    (leg,) = (table.leg for table in build([source_u12]).maps)
    for robot, bodies_kg in zip(robots, arrays.body_mass_kg, strict=True):
        units_kg = {unit.name: unit.mass_properties().mass_kg for unit in robot.units}
        thigh_kg = np.interp(robot.design.thigh_length_m, leg.length_m, leg.thigh_kg)
        shank_kg = np.interp(robot.design.shank_length_m, leg.length_m, leg.shank_kg)
        assert thigh_kg + units_kg["knee_actuator"] + units_kg["journal"] == pytest.approx(bodies_kg[1], abs=1e-4)
        assert shank_kg + units_kg["foot"] == pytest.approx(bodies_kg[2], abs=1e-4)
        assert leg.housing_radius_m == pytest.approx(1e-3 * robot.knee.mount.housing_radius_mm)


def test_the_drawing_has_the_parts_dimensions(vt8020):
    leg = leg_table(leg_dimensions(vt8020))
    assert (leg.base_top_m, leg.base_top_radius_m) == pytest.approx((0.06821, 0.040), abs=1e-5)
    assert (leg.thigh_hip_radius_m, leg.thigh_knee_radius_m) == pytest.approx((0.055, 0.0355))
    assert leg.thigh_half_width_m == pytest.approx(0.024)
    assert (leg.shank_knee_radius_m, leg.shank_foot_radius_m) == pytest.approx((0.024, 0.018))
    assert (leg.housing_radius_m, leg.output_radius_m) == pytest.approx((0.0515, 0.0165))


def test_changes_of_the_family_along_a_front_are_told_one_by_one_or_counted(payload):
    """Written by hand: of five designs the third begins with an external hip; the knee goes to and fro."""
    (card,) = payload.studies
    inside, outside = (next(g for g in payload.gearboxes if g.family == one) for one in ("ISSPG", "ESSPG"))
    columns = {"height_m": [0.9, 0.5, 0.6, 0.7, 0.8], "hip_gearbox": [1, 0, 0, 1, 1], "knee_gearbox": [0, 0, 1, 0, 1]}
    made = replace(card, front=[1, 2, 3, 4, 0], trials=replace(card.trials, columns=columns))
    height = next(quantity for quantity in payload.quantities if quantity.name == "height_m")
    assert switches(made, [inside, outside], height) == (
        " Along this front the hip changes at 0.70 m; "
        "the knee has ESSPG in 2 of 5 designs, changing 4 times between 0.60 m and 0.90 m."
    )
    assert (
        switches(made, [outside, outside], height)
        == " Along this front the hip stays with ESSPG; the knee stays with ESSPG."
    )
    assert switches(replace(made, front=[1]), [inside, outside], height) == ""
