"""What an actuator can do, from first principles."""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.actuator.actuator import build_actuator, reflected_inertia_kg_m2
from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.shape.meshes import flaws, mesh_of
from pareto_monoped.geometry.roles import Group, Role


@pytest.mark.parametrize("ratio", [4.0, 6.0, 7.9])
def test_torque_speed_and_power(vt_map, vt8020, ratio):
    actuator = vt_map.lookup(ratio)
    gears = actuator.gears
    assert actuator.ratio == (gears.sun_teeth + gears.ring_teeth) / gears.sun_teeth
    assert actuator.peak_torque_n_m == pytest.approx(5.5 * actuator.ratio)
    assert actuator.continuous_torque_n_m == pytest.approx(vt8020.continuous_torque_n_m * actuator.ratio)
    power = actuator.peak_torque_n_m * actuator.no_load_speed_rad_per_s
    assert power == pytest.approx(5.5 * vt8020.no_load_speed_rad_per_s)


@pytest.mark.parametrize("ratio", [4.0, 6.0, 7.9])
def test_reflected_inertia_is_twice_the_kinetic_energy_at_unit_speed(vt_map, vt8020, ratio):
    """Sum of 1/2 I w^2 over bodies with their own speeds, from angular velocities of rolling pitch circles."""
    actuator = vt_map.lookup(ratio)
    gears = actuator.gears
    sun, planet, ring = (0.5e-3 * gears.module_mm * z for z in (gears.sun_teeth, gears.planet_teeth, gears.ring_teeth))
    carrier_speed = 1.0
    centre_speed = carrier_speed * (sun + planet)
    # The planet rolls inside the fixed ring: its point at the ring stands still.
    planet_speed = -centre_speed / planet
    # The sun's rim moves like the planet's point there: centre speed minus spin times radius.
    sun_speed = (centre_speed - planet_speed * planet) / sun
    assert sun_speed == pytest.approx(actuator.ratio)
    assert ring == pytest.approx(sun + 2 * planet)
    energy = 0.5 * vt8020.rotor_inertia_kg_m2 * sun_speed**2
    for part in actuator.parts:
        if part.group is Group.HOUSING or part.role is Role.MOTOR_ROTOR:
            continue
        if part.group is Group.PLANET:
            mass = part.unit_mass_kg()
            moments = [(prism.moments(), float(prism.z1_mm - prism.z0_mm)) for prism in part.prisms]
            polar = sum((m.xx + m.yy) * length for m, length in moments)
            polar += sum(bevel.integrals()[4] + bevel.integrals()[5] for bevel in part.bevels)
            spin = polar * 1e-15 * part.material.density_kg_per_m3
            energy += part.count * 0.5 * (mass * centre_speed**2 + spin * planet_speed**2)
        else:
            speed = sun_speed if part.group is Group.ROTOR else carrier_speed
            energy += 0.5 * part.mass_properties().inertia_kg_m2[2, 2] * speed**2
    assert actuator.reflected_inertia_kg_m2 == pytest.approx(2.0 * energy, rel=1e-9)
    assert actuator.reflected_inertia_kg_m2 > vt8020.rotor_inertia_kg_m2 * ratio**2


def test_rotor_inertia_counts_at_the_square_of_the_ratio(vt_map, vt8020):
    actuator = vt_map.lookup(6.0)
    doubled = replace(vt8020, rotor_inertia_kg_m2=2.0 * vt8020.rotor_inertia_kg_m2)
    more = reflected_inertia_kg_m2(actuator.parts, actuator.gears, doubled)
    assert more - actuator.reflected_inertia_kg_m2 == pytest.approx(36.0 * vt8020.rotor_inertia_kg_m2)


def test_gears_weigh_their_true_tooth_area(vt_map):
    """A standard gear is a few percent lighter than its pitch cylinder: roots are cut deeper than tips stand out."""
    actuator = vt_map.lookup(6.0)
    planet = next(part for part in actuator.parts if part.name == "planet")
    cylinder = np.pi * (9.0**2 - 4.0**2) * actuator.face_width_mm * 1e-9 * 7850.0
    assert 0.95 < planet.unit_mass_kg() / cylinder < 0.995


def test_wide_planets_are_recessed_and_narrow_ones_not(vt_map):
    for ratio, prisms in ((6.0, 1), (7.9, 5)):
        planet = next(part for part in vt_map.lookup(ratio).parts if part.name == "planet")
        assert len(planet.prisms) == prisms


def test_parts_have_names_of_their_own_groups_and_materials(vt_map):
    for ratio in (4.0, 7.9):
        parts = vt_map.lookup(ratio).parts
        assert len({part.name for part in parts}) == len(parts)
        assert {part.group for part in parts} == {"housing", "output", "rotor", "planet"}
        assert all(part.mass_kg() > 0.0 for part in parts)
        assert {part.process for part in parts} <= {"machined", "bought"}


@pytest.mark.parametrize("ratio", [4.0, 7.9])
def test_the_notes_of_the_gears_give_their_own_teeth_and_module(vt_map, ratio):
    actuator = vt_map.lookup(ratio)
    gears = actuator.gears
    notes = {part.name: part.note for part in actuator.parts}
    for name, teeth in (("sun", gears.sun_teeth), ("planet", gears.planet_teeth), ("ring", gears.ring_teeth)):
        assert f"{teeth} teeth, module {gears.module_mm:g} mm" in notes[name]


def test_building_twice_gives_the_same_record(vt8020, vt_map, settings):
    actuator = vt_map.lookup(6.0)
    assert build_actuator(vt8020, "ISSPG", actuator.gears, settings) == actuator


@pytest.mark.parametrize("motor", ["VT8020", "U12"])
def test_the_ring_gear_passes_the_bore_behind_its_seat(motor):
    """Ring gears of three of the U12's winners did not, or met the bore at the end of the seat's chamfer."""
    found = (entry.actuator for entry in map_for(motor).entries)
    inside = [one for one in found if one is not None and one.family == "ISSPG"]
    assert len(inside) > 10
    for one in inside:
        housing, ring = (next(part for part in one.parts if part.name == name) for name in ("ring_housing", "ring"))
        radius_mm = max(float(prism.outline.radius_mm) for prism in ring.prisms)
        back_mm = min(float(prism.z0_mm) for prism in ring.prisms)
        behind = [prism for prism in housing.prisms if float(prism.z1_mm) <= back_mm + 1e-6]
        assert behind
        for prism in behind:
            assert min(float(hole.radius_mm) for hole in prism.holes) > radius_mm + 0.3, one  # its chamfer
    lowest = min(inside, key=lambda one: one.ratio)
    housing = next(part for part in lowest.parts if part.name == "ring_housing")
    mesh = mesh_of(housing)
    assert flaws(mesh.points_mm[mesh.triangles]) == ""
