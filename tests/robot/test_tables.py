"""Tables of the links' masses: over which lengths, and that exact weighing takes over beyond them."""

import numpy as np
import pytest

from pareto_monoped.geometry.parts import total
from pareto_monoped.geometry.roles import Group, Role
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.leg.thigh import thigh_parts
from pareto_monoped.robot import tables
from pareto_monoped.robot.tables import actuator_table, drive_turning, link_units, weighed
from pareto_monoped.robot.units import UPRIGHT, in_body


@pytest.fixture(scope="module")
def leg(actuator_map):
    return leg_dimensions(actuator_map)


@pytest.mark.parametrize("length", ["thigh_length_m", "shank_length_m"])
def test_links_are_tabulated_from_0_25_to_0_55_m(leg, length):
    table = tables._link_table(length, leg)
    low, high = 0.25, 0.55
    assert table.covers(np.array([low, high])).all()
    assert not table.covers(np.array([low - 1e-12, high + 1e-12])).any()


def test_lengths_beyond_the_table_are_weighed_part_by_part_to_the_last_bit(leg):
    lengths = np.array([0.2, 0.3, 0.6])
    found = weighed("thigh_length_m", leg, lengths)["thigh"]
    exact = in_body(total(part.mass_properties() for part in thigh_parts(lengths[[0, 2]], leg)), UPRIGHT, 0.0)
    assert np.array_equal(found.mass_kg[[0, 2]], exact.mass_kg)
    assert np.array_equal(found.second_kg_m2[[0, 2]], exact.second_kg_m2)
    assert found.mass_kg[1] != found.mass_kg[0]


def test_units_of_a_length_are_those_of_its_link():
    assert [unit.name for unit in link_units("thigh_length_m")] == ["thigh"]
    assert [unit.name for unit in link_units("shank_length_m")] == ["shank", "foot"]


def test_every_interval_leads_to_its_actuator(actuator_map):
    table = actuator_table(actuator_map)
    for index, entry in enumerate(actuator_map.entries):
        if entry.actuator is not None:
            assert table.ratio[table.row[index]] == entry.actuator.ratio
            assert table.continuous_torque_n_m[table.row[index]] == entry.actuator.continuous_torque_n_m


@pytest.mark.parametrize("length", [0.3, 0.42])
def test_a_running_chain_has_the_angular_momentum_of_its_links(leg, length):
    """About the hip, summed up along the loop at the speed r w: the links beyond the knee have more of it."""
    drive, radius = drive_turning(leg), 1e-3 * leg.chain.pitch_radius_mm
    angle = np.linspace(0.0, np.pi, 2001)
    far = radius * np.stack([np.cos(angle), length / radius + np.sin(angle)], axis=1)
    loop = np.concatenate([far, [0.0, length] - far, far[:1]])
    steps, middles = np.diff(loop, axis=0), 0.5 * (loop[1:] + loop[:-1])
    crossed = middles[:, 0] * steps[:, 1] - middles[:, 1] * steps[:, 0]
    momentum = leg.chain.kg_per_m * radius * crossed.sum()
    alone = leg.chain.kg_per_m * radius**2 * np.hypot(*steps.T).sum()
    coupling, reflected = (line[0] + line[1] * length for line in (drive.coupling_kg_m2, drive.reflected_kg_m2))
    assert coupling - reflected == pytest.approx(momentum - alone, rel=1e-2)
    # Twice the kinetic energy at 1 rad/s: the strands run at r m/s, the sprocket and its coupling turn.
    speeds = {Role.CHAIN: radius, Role.TURNBUCKLE: radius}
    energy = 0.0
    for part in thigh_parts(length, leg):
        turned = part.mass_properties().inertia_kg_m2[2, 2] if part.group is Group.KNEE_DRIVE else 0.0
        energy += 0.5 * (part.mass_kg() * speeds.get(part.role, 0.0) ** 2 + turned)
    assert reflected == pytest.approx(2.0 * energy, rel=1e-9)


@pytest.mark.parametrize("ratio", [4.0, 6.0, 8.0])
def test_an_actuator_has_the_angular_momentum_of_what_turns_in_it(actuator_map, ratio):
    """At 1 rad/s of its carrier, from the speeds of rolling pitch circles; the planets' spin is against all others."""
    actuator = actuator_map.lookup(ratio)
    gears, motor = actuator.gears, actuator.motor
    # Shifted profiles make a planet's circle at the sun another than that at the ring.
    centre = next(1e-3 * part.pitch_radius_mm for part in actuator.parts if part.group is Group.PLANET)
    at_ring = centre * gears.planet_teeth / (gears.ring_teeth - gears.planet_teeth)
    at_sun, sun = (centre * z / (gears.sun_teeth + gears.planet_teeth) for z in (gears.planet_teeth, gears.sun_teeth))
    spin = -centre / at_ring  # its point at the ring stands still
    fast = (centre - spin * at_sun) / sun
    about = {part.name: float(part.mass_properties().inertia_kg_m2[2, 2]) for part in actuator.parts}
    # The motor's rotor counts with the data sheet's figure, and what its envelope has less is the excess.
    drawn = sum(about[part.name] for part in actuator.parts if part.group is Group.ROTOR)
    rotor = drawn + tables.rotor_excess_kg_m2(actuator)
    assert tables.rotor_inertia_kg_m2(actuator) == pytest.approx(rotor, rel=1e-12)
    envelope = sum(about[part.name] for part in actuator.parts if part.role is Role.MOTOR_ROTOR)
    assert rotor == pytest.approx(drawn - envelope + motor.rotor_inertia_kg_m2, rel=1e-12)
    momentum = rotor * fast
    for part in actuator.parts:
        if part.group is Group.PLANET:
            orbit = part.mass_kg() * centre**2
            momentum += orbit + (about[part.name] - orbit) * spin
        elif part.group not in (Group.ROTOR, Group.HOUSING):
            momentum += about[part.name]
    assert tables.actuator_coupling_kg_m2(actuator) == pytest.approx(momentum, rel=1e-9)
