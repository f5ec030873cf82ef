"""Links weigh what the reference link does, from dimensions that are bounded by what the parts must hold."""

import numpy as np
import pytest

from pareto_monoped.actuator.motors import motor_names
from pareto_monoped.actuator.search import map_for
from pareto_monoped.geometry.parts import total
from pareto_monoped.leg import links
from pareto_monoped.leg.dimensions import DEFAULT
from pareto_monoped.robot.build import leg_dimensions

LENGTHS = np.linspace(0.3, 0.5, 9)


def mass_kg(parts, like):
    return sum(part.mass_kg() + 0.0 * like for part in parts)


def test_links_together_weigh_what_the_reference_links_do():
    # The reference link: 0.235 kg and 0.828 g/mm, fitted to the authors' table from 150 to 350 mm.
    reference = 0.235 + 0.828 * LENGTHS
    thigh = mass_kg(links.thigh_parts(LENGTHS), LENGTHS)
    shank = mass_kg(links.shank_parts(LENGTHS), LENGTHS)
    assert (thigh + shank) / (2.0 * reference) == pytest.approx(1.0, abs=0.02)
    # Only the thigh carries the chain and the drive sprocket.
    assert np.all(thigh > reference)
    assert np.all(shank < reference)
    assert thigh / reference == pytest.approx(1.0, abs=0.17)
    assert shank / reference == pytest.approx(1.0, abs=0.17)
    for mass in (thigh, shank):
        slope = np.polyfit(LENGTHS, mass, 1)[0]
        assert slope == pytest.approx(0.828, rel=0.07)


@pytest.mark.parametrize("parts_of", [links.thigh_parts, links.shank_parts, links.base_parts, links.journal_parts])
def test_a_population_gives_what_each_member_gives(parts_of):
    many = total(part.mass_properties() for part in parts_of(LENGTHS))
    for index, length in enumerate(LENGTHS):
        one = total(part.mass_properties() for part in parts_of(float(length)))
        # Parts that do not depend on the length broadcast.
        assert many.mass_kg[index] == pytest.approx(one.mass_kg, rel=1e-13)
        assert many.com_m[index] == pytest.approx(one.com_m, rel=1e-12, abs=1e-15)
        assert many.inertia_kg_m2[index] == pytest.approx(one.inertia_kg_m2, rel=1e-10, abs=1e-12)


@pytest.mark.parametrize("parts_of", [links.thigh_parts, links.shank_parts])
def test_mass_grows_smoothly_with_length(parts_of):
    fine = np.linspace(0.3, 0.5, 2001)
    mass = mass_kg(parts_of(fine), fine)
    second = np.diff(mass, 2) / (fine[1] - fine[0]) ** 2
    assert np.all(np.diff(mass) > 0.0)
    assert np.max(np.abs(second)) < 0.01  # a step of one gram anywhere would give 1e5


def test_centres_of_mass_lie_on_the_link():
    for parts in (links.thigh_parts(0.4), links.shank_parts(0.4)):
        x, y, z = total(part.mass_properties() for part in parts).com_m
        assert x == pytest.approx(0.0, abs=1e-6)
        assert -0.3 < y < -0.1
        assert abs(z) < 0.004


def test_the_foot_is_about_its_centre_and_light():
    foot = links.foot_part(0.36)
    centre = np.array([0.0, -0.36, 0.0])
    assert np.linalg.norm(foot.mass_properties().com_m - centre) < 0.006
    whole = 4.0 / 3.0 * np.pi * (DEFAULT.foot_radius_mm * 1e-3) ** 3 * foot.material.density_kg_per_m3
    assert 0.8 * whole < foot.mass_kg() < whole


def test_names_are_unique_in_each_body():
    thigh = [p.name for p in (*links.thigh_parts(0.4), *links.journal_parts(0.07))]
    shank = [p.name for p in (*links.shank_parts(0.4), links.foot_part(0.4))]
    base = [p.name for p in links.base_parts(0.07)]
    for names in (thigh, shank, base):
        assert len(set(names)) == len(names)


def test_the_chain_holds_the_largest_knee_torque():
    # 5.5 N m at 8.7 to one on the sprocket's pitch radius, against the 4.4 kN of ISO 606 for 05B-1.
    pitch_radius_m = 0.5e-3 * DEFAULT.chain_pitch_mm / np.sin(np.pi / DEFAULT.sprocket_teeth)
    assert 4400.0 / (5.5 * 8.7 / pitch_radius_m) > 2.0


def test_the_default_leg_is_the_default_motor_s():
    assert leg_dimensions(map_for("VT8020")) == DEFAULT


@pytest.mark.parametrize("motor", motor_names())
def test_a_motor_s_leg_is_drilled_for_all_its_actuators_and_its_chain_holds_twice_their_torque(motor):
    actuators = [entry.actuator for entry in map_for(motor).entries if entry.actuator is not None]
    leg = leg_dimensions(map_for(motor))
    for actuator in actuators:
        assert 2.0 * leg.mount_pitch_radius_mm == pytest.approx(actuator.mount.bolts.pitch_circle_mm)
        assert 2.0 * leg.back_pitch_radius_mm == pytest.approx(actuator.mount.back_bolts.pitch_circle_mm)
        assert leg.back_screw_mm == actuator.mount.back_bolts.diameter_mm
    pitch_radius_m = 0.5e-3 * leg.chain_pitch_mm / np.sin(np.pi / leg.sprocket_teeth)
    assert leg.chain_breaking_n * pitch_radius_m >= 2.0 * max(a.peak_torque_n_m for a in actuators)
