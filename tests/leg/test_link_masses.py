"""Links weigh what the reference link does, smoothly in their length, and the same alone as in a population."""

import numpy as np
import pytest

from pareto_monoped.geometry.parts import total
from pareto_monoped.geometry.roles import Role
from pareto_monoped.leg.base import base_parts
from pareto_monoped.leg.journal import journal_parts
from pareto_monoped.leg.shank import foot_part, shank_parts
from pareto_monoped.leg.thigh import thigh_parts

LENGTHS = np.linspace(0.3, 0.5, 9)


def mass_kg(parts, like):
    return sum(part.mass_kg() + 0.0 * like for part in parts)


# What the end stops and narrower windows add to the thigh, most of it its plates, and to the shank. The windows are as
# narrow as the greatest torque of the motor's gearboxes asks for, at a ratio of 9.6.
THIGH_STOPS_KG, SHANK_STOPS_KG = 0.2082, 0.0724


def test_links_without_their_stops_are_like_the_reference_links(leg):
    """The links of version 0.1.0 weighed the same; a chain that holds five times its pull made the thigh heavier."""
    # The reference link: 0.235 kg and 0.828 g/mm, fitted to the authors' table from 150 to 350 mm.
    reference = 0.235 + 0.828 * LENGTHS
    thigh = mass_kg(thigh_parts(LENGTHS, leg), LENGTHS) - THIGH_STOPS_KG
    shank = mass_kg(shank_parts(LENGTHS, leg), LENGTHS) - SHANK_STOPS_KG
    # Only the thigh carries the chain and the drive sprocket.
    assert np.all(thigh > reference)
    assert np.all(shank < reference)
    assert np.all(thigh < 1.6 * reference)
    assert shank / reference == pytest.approx(0.85, abs=0.06)
    # The chain's strands are bars, which weigh less per length than the chain of the reference.
    slopes = [np.polyfit(LENGTHS, mass, 1)[0] for mass in (thigh, shank)]
    assert slopes[0] == pytest.approx(0.64, abs=0.06)
    assert slopes[1] == pytest.approx(0.828, rel=0.07)


@pytest.mark.parametrize("parts_of", [thigh_parts, shank_parts, base_parts, journal_parts])
def test_a_population_gives_what_each_member_gives(parts_of, leg):
    many = total(part.mass_properties() for part in parts_of(LENGTHS, leg))
    for index, length in enumerate(LENGTHS):
        one = total(part.mass_properties() for part in parts_of(float(length), leg))
        # Parts that do not depend on the length broadcast.
        assert many.mass_kg[index] == pytest.approx(one.mass_kg, rel=1e-13)
        assert many.com_m[index] == pytest.approx(one.com_m, rel=1e-12, abs=1e-15)
        assert many.inertia_kg_m2[index] == pytest.approx(one.inertia_kg_m2, rel=1e-10, abs=1e-12)


@pytest.mark.parametrize("parts_of", [thigh_parts, shank_parts])
def test_mass_grows_smoothly_with_length(parts_of, leg):
    fine = np.linspace(0.3, 0.5, 2001)
    mass = mass_kg(parts_of(fine, leg), fine)
    second = np.diff(mass, 2) / (fine[1] - fine[0]) ** 2
    assert np.all(np.diff(mass) > 0.0)
    assert np.max(np.abs(second)) < 0.01  # a step of one gram anywhere would give 1e5


def test_the_stops_of_a_link_weigh_what_the_docs_say(leg):
    """Against the plates and bolts of version 0.1.0, which had no stops (g, 400 mm): 95.5, 101.1, 22.3 and 197.1."""
    before = {"thigh": 0.095484 + 0.101093 + 0.022251, "shank": 0.197137}
    stops = {"thigh": 0.0, "shank": 0.0}
    for link, parts in (("thigh", thigh_parts(0.4, leg)), ("shank", shank_parts(0.4, leg))):
        for part in parts:
            fastened = part.name in ("thigh_bolt", "knee_striker_bolt", "knee_seat_extension", "knee_seat_flexion")
            if fastened or part.role in (Role.BUMPER, Role.STRIKER, Role.PLATE):
                stops[link] += part.mass_kg()
    assert stops["thigh"] - before["thigh"] == pytest.approx(THIGH_STOPS_KG, abs=3e-3)
    assert stops["shank"] - before["shank"] == pytest.approx(SHANK_STOPS_KG, abs=5e-4)


def test_centres_of_mass_lie_on_the_link(leg):
    """But for the knee's stops, whose seats and striker stand to one side."""
    for parts in (thigh_parts(0.4, leg), shank_parts(0.4, leg)):
        x, y, z = total(part.mass_properties() for part in parts).com_m
        assert abs(x) < 0.004
        assert -0.3 < y < -0.1
        assert abs(z) < 0.004


def test_the_foot_is_about_its_centre_and_light(leg):
    foot = foot_part(0.36, leg)
    centre = np.array([0.0, -0.36, 0.0])
    assert np.linalg.norm(foot.mass_properties().com_m - centre) < 0.006
    whole = 4.0 / 3.0 * np.pi * (leg.foot_radius_mm * 1e-3) ** 3 * foot.material.density_kg_per_m3
    assert 0.8 * whole < foot.mass_kg() < whole


def test_names_are_unique_in_each_body(leg):
    thigh = [p.name for p in (*thigh_parts(0.4, leg), *journal_parts(0.07, leg))]
    shank = [p.name for p in (*shank_parts(0.4, leg), foot_part(0.4, leg))]
    base = [p.name for p in base_parts(0.07, leg)]
    for names in (thigh, shank, base):
        assert len(set(names)) == len(names)
