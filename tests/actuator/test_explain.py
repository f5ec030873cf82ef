"""What ``actuators`` prints as plain values; the command's own tests hold the form."""

import pytest

from pareto_monoped.actuator.explain import details, gaps, summary
from pareto_monoped.actuator.search import map_for
from pareto_monoped.actuator.service.sheet import service_sheet
from pareto_monoped.geometry.roles import Role


@pytest.fixture(scope="module")
def actuator_map():
    return map_for("VT8020", "paper")


def test_gaps_are_the_intervals_without_a_gearbox(actuator_map):
    missing = [entry.ratio_low for entry in actuator_map.entries if entry.actuator is None]
    (gap,) = gaps(actuator_map)
    assert (gap.ratio_low, gap.ratio_high) == (missing[0], pytest.approx(15.0))
    assert len(missing) == round((gap.ratio_high - gap.ratio_low) / 0.1)
    assert "sun_rim" in gap.in_the_way["ESSPG"]


def test_separate_gaps_stay_separate():
    below, above = gaps(map_for("MAD_M6C12", "paper"))
    assert (below.ratio_low, round(below.ratio_high, 9)) == (4.0, 4.3)
    assert (above.ratio_low, round(above.ratio_high, 9)) == (7.1, 15.0)


def test_details_begin_with_the_summary(actuator_map):
    entry = actuator_map.entry(6.05)
    sheet = service_sheet(entry.actuator, actuator_map.settings)
    known, row = details(entry, sheet), summary(entry, sheet)
    assert list(known)[: len(row)] == list(row)
    assert known["mass_kg"] == entry.actuator.mass_kg
    masses = [part["mass_kg"] for part in known["parts"]]
    assert masses == sorted(masses, reverse=True)
    assert sum(masses) == pytest.approx(entry.actuator.mass_kg)
    assert known["runner_up"]["mass_kg"] == entry.runner_up.mass_kg


def test_axial_inertia_is_that_about_the_gearbox_axis(actuator_map):
    entry = actuator_map.entry(6.0)
    known_parts = details(entry, service_sheet(entry.actuator, actuator_map.settings))["parts"]
    parts = sorted(entry.actuator.parts, key=lambda part: -part.mass_kg())
    for part, known in zip(parts, known_parts, strict=True):
        x2, y2 = part.mass_properties().second_kg_m2[[0, 1], [0, 1]]
        simulated = entry.actuator.motor.rotor_inertia_kg_m2 if part.role is Role.MOTOR_ROTOR else x2 + y2
        assert known["axial_inertia_kg_m2"] == pytest.approx(simulated)


def test_a_row_of_the_map_tells_what_the_service_sheet_says(actuator_map):
    entry = actuator_map.entry(6.0)
    actuator, sheet = entry.actuator, service_sheet(entry.actuator, actuator_map.settings)
    row, known = summary(entry, sheet), details(entry, sheet)
    assert row["efficiency_mesh"] == row["efficiency"] == actuator.efficiency
    product = row["efficiency_mesh"] * row["efficiency_planets"] * row["efficiency_bearings"]
    assert row["efficiency_total"] == pytest.approx(product * known["efficiency_churning"])
    assert row["bearing_life_h"] == min(found["life_h"] for found in known["bearings"])
    assert row["output_tilt_n_m"] == sheet.output_tilt_n_m
    assert row["stiffness_n_m_per_rad"] == pytest.approx(1.0 / sum(known["compliance_rad_per_n_m"].values()))
    assert row["backlash_arcmin"] == sheet.backlash_arcmin
    for name in ("continuous_torque_n_m", "no_load_speed_rad_per_s", "length_mm", "reflected_inertia_kg_m2"):
        assert row[name] == getattr(actuator, name)
    bush = known["bush"]
    assert bush["pv_mpa_m_per_s"] == pytest.approx(bush["pressure_mpa"] * bush["speed_m_per_s"])
    assert known["bearings"][0]["size_mm"] == [40.0, 52.0, 7.0]


def test_a_shifted_set_is_told_with_its_shifts_and_its_centre_distance():
    found = map_for("VT8020")
    entry = next(e for e in found.entries if e.actuator is not None and e.actuator.gears.is_shifted)
    gears = entry.actuator.gears
    row = summary(entry, service_sheet(entry.actuator, found.settings))
    told = [row[f"{gear}_shift"] for gear in ("sun", "planet", "ring")]
    assert told == [gears.sun_shift, gears.planet_shift, gears.ring_shift]
    both = 0.5 * (gears.sun_teeth + gears.planet_teeth) + gears.centre_shift
    assert row["centre_distance_mm"] == pytest.approx(gears.module_mm * both)
