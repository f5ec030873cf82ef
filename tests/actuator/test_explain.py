"""What ``actuators`` prints as plain values; the command's own tests hold the form."""

import pytest

from pareto_monoped.actuator.explain import details, gaps, summary
from pareto_monoped.actuator.search import map_for


@pytest.fixture(scope="module")
def actuator_map():
    return map_for("VT8020")


def test_gaps_are_the_intervals_without_a_gearbox(actuator_map):
    missing = [entry.ratio_low for entry in actuator_map.entries if entry.actuator is None]
    (gap,) = gaps(actuator_map)
    assert (gap.ratio_low, gap.ratio_high) == (missing[0], pytest.approx(15.0))
    assert len(missing) == round((gap.ratio_high - gap.ratio_low) / 0.1)
    assert "sun_rim" in gap.in_the_way["ESSPG"]


def test_separate_gaps_stay_separate():
    below, above = gaps(map_for("MAD_M6C12"))
    assert (below.ratio_low, round(below.ratio_high, 9)) == (4.0, 4.3)
    assert (above.ratio_low, round(above.ratio_high, 9)) == (7.1, 15.0)


def test_details_begin_with_the_summary(actuator_map):
    entry = actuator_map.entry(6.05)
    known = details(entry)
    assert list(known)[: len(summary(entry))] == list(summary(entry))
    assert known["mass_kg"] == entry.actuator.mass_kg
    masses = [part["mass_kg"] for part in known["parts"]]
    assert masses == sorted(masses, reverse=True)
    assert sum(masses) == pytest.approx(entry.actuator.mass_kg)
    assert known["runner_up"]["mass_kg"] == entry.runner_up.mass_kg


def test_axial_inertia_is_that_about_the_gearbox_axis(actuator_map):
    entry = actuator_map.entry(6.0)
    for part, known in zip(
        sorted(entry.actuator.parts, key=lambda part: -part.mass_kg()), details(entry)["parts"], strict=True
    ):
        x2, y2 = part.mass_properties().second_kg_m2[[0, 1], [0, 1]]
        assert known["axial_inertia_kg_m2"] == pytest.approx(x2 + y2)
