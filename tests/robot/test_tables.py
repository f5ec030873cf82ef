"""Tables of the links' masses: over which lengths, and that exact weighing takes over beyond them."""

import numpy as np
import pytest

from pareto_monoped.geometry.parts import total
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.leg.thigh import thigh_parts
from pareto_monoped.robot import tables
from pareto_monoped.robot.tables import actuator_table, link_units, weighed
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
