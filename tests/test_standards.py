"""Tables that were copied from standards are as they were when they were copied."""

import importlib
from collections.abc import Mapping
from numbers import Real

import pytest

# Table -> how many numbers it has, and their sum weighted by place (1, 2 ... 7, 1 ...), of commit be02a7d. A figure
# that is put right moves the sum: then compare the whole table with the standard that it names, and write the new sum.
TABLES = {
    "actuator.bearings._CLEARANCE_BORES_MM": (12, 3193.0),
    "actuator.bearings._CLEARANCE_UM": (24, 3117.0),
    "actuator.needles._RACEWAY_FACTORS": (18, 14475.26),
    "actuator.rating.load._K1": (16, 1070.4),
    "actuator.rating.width._LEWIS": (48, 4589.33),
    "geometry.dowels.LENGTHS_MM": (17, 1287.0),
    "geometry.features.COARSE_PITCHES_MM": (14, 156.95),
    "geometry.features._TAP_RUN_OUTS_MM": (14, 96.25),
    "geometry.making._HOLES_UM": (40, 975.0),
    "geometry.making._IT_UM": (45, 18567.0),
    "geometry.making._R6_UM": (6, -456.0),
    "geometry.making._SHAFTS_UM": (56, 719.0),
    "geometry.making._SIZES_MM": (8, 1247.0),
    "geometry.making._TOLERANCE_MM": (10, 167.46),
    "geometry.screws.HEXAGON_FLATS_MM": (6, 127.0),
    "geometry.screws.HEXAGON_HEIGHT_MM": (6, 76.2),
    "geometry.screws.LENGTHS_MM": (17, 1555.0),
}


def numbers(table):
    """Every number of a table, of its keys, too, in their order."""
    if isinstance(table, Real):
        return [float(table)]
    if isinstance(table, Mapping):
        table = table.items()
    return [] if isinstance(table, str) else [number for each in table for number in numbers(each)]


@pytest.mark.parametrize("name", TABLES)
def test_a_table_of_a_standard_is_as_it_was_copied(name):
    module, _, table = name.rpartition(".")
    found = numbers(getattr(importlib.import_module(f"pareto_monoped.{module}"), table))
    total = sum(value * (1 + place % 7) for place, value in enumerate(found))
    assert (len(found), total) == (TABLES[name][0], pytest.approx(TABLES[name][1], rel=1e-12))
