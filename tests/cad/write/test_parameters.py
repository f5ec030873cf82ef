"""Dimensions by name: both files say the same, and parts can be built again from them."""

import csv
import dataclasses
import io
import re

import numpy as np
import pytest

from pareto_monoped.cad.write.parameters import Parameter, equations, parameters, parameters_csv
from pareto_monoped.geometry.gears import ExternalGear
from pareto_monoped.leg.dimensions import leg_dimensions

LINE = re.compile(r'"(\w+)" = (-?\d+(?:\.\d+)?)(mm|deg|)')


@pytest.fixture(scope="module")
def rows(product, actuator_map):
    return parameters(product, leg_dimensions(actuator_map))


@pytest.fixture(scope="module")
def read(rows):
    """Name -> value in its unit, as the equations file gives it."""
    found = {}
    for line in equations(rows).splitlines():
        name, value, unit = LINE.fullmatch(line).groups()
        assert name not in found
        found[name] = (float(value), unit)
    return found


def test_both_files_say_the_same(rows, read):
    table = list(csv.DictReader(io.StringIO(parameters_csv(rows))))
    assert {row["name"]: (float(row["value"]), row["unit"]) for row in table} == read
    assert all(row["meaning"] for row in table)


def test_every_length_of_the_leg_stands_there_in_its_order_with_words_of_its_own(rows, actuator_map):
    leg = leg_dimensions(actuator_map)
    lengths = {
        f"leg_{field.name.removesuffix('_mm')}": getattr(leg, field.name)
        for field in dataclasses.fields(leg)
        if field.name.endswith("_mm")
    }
    found = {row.name: row for row in rows if row.name.startswith("leg_")}
    assert {name: row.value for name, row in found.items()} == lengths
    assert list(found) == list(lengths)
    assert found["leg_fork"].meaning.startswith("free depth of the shank's fork below the knee axis")
    assert not any(row.meaning == name.removeprefix("leg_").replace("_", " ") for name, row in found.items())


def test_a_line_has_the_form_that_solidworks_links_to():
    row = Parameter(name="thigh_length", value=320.0, unit="mm", part="", meaning="")
    assert equations([row]) == '"thigh_length" = 320mm\n'
    angle = dataclasses.replace(row, name="tilt", value=-1e-9, unit="deg")
    assert equations([angle, dataclasses.replace(angle, value=-22.5)]) == '"tilt" = 0deg\n"tilt" = -22.5deg\n'


def test_lengths_of_the_links_are_the_design_s(product, read):
    assert read["thigh_length"] == (1e3 * product.robot.design.thigh_length_m, "mm")
    assert read["shank_length"] == (1e3 * product.robot.design.shank_length_m, "mm")
    assert read["hip_ratio"] == (pytest.approx(product.robot.hip.ratio, abs=1e-6), "")


def test_a_turned_part_s_volume_follows_from_its_parameters(product, read):
    """The journal from discs, bolt holes and its cone, with the numbers of the file alone."""
    (journal,) = [unique.part for unique in product.unique if unique.name == "journal"]

    def value(name):
        return read[f"journal_{name}"][0]

    volume = 0.0
    for k, prism in enumerate(journal.prisms, 1):
        height = value(f"layer_{k}_to") - value(f"layer_{k}_from")
        area = value(f"layer_{k}_outline_diameter") ** 2
        for j in range(1, len(prism.holes) + 1):
            count = read.get(f"journal_layer_{k}_hole_{j}_count", (1.0, ""))[0]
            area -= count * value(f"layer_{k}_hole_{j}_diameter") ** 2
        volume += 0.25 * np.pi * area * height
    cones = [name for name in read if re.fullmatch(r"journal_feature_\d+_cone_\d+_depth", name)]
    for name in cones:
        cone = name.removeprefix("journal_").removesuffix("_depth")
        wide, narrow = value(f"{cone}_diameter"), value(f"{cone}_on_diameter")
        # A cone of a part that is made takes away what lies between it and its cylinder.
        frustum = (wide**2 + wide * narrow + narrow**2) / 3.0 - narrow**2
        volume -= value(f"{cone}_count") * 0.25 * np.pi * value(f"{cone}_depth") * abs(frustum)
    assert len(cones) == len(journal.bevels) >= 1
    assert volume == pytest.approx(float(journal.volume_mm3()), rel=1e-8)


def test_a_gear_is_named_by_teeth_and_module(product, read):
    (planet,) = [u for u in product.unique if u.name == "hip_actuator_planet"]
    gear = next(p.outline for p in planet.part.prisms if isinstance(p.outline, ExternalGear))
    name = "hip_actuator_planet_layer_1_outline"
    assert read[f"{name}_teeth"] == (gear.teeth, "")
    assert read[f"{name}_module"] == (gear.module_mm, "mm")
    assert read[f"{name}_tip_diameter"][0] == pytest.approx(2.0 * gear.tip_radius_mm, abs=1e-6)


def test_every_made_part_is_there_and_no_bought_one(product, rows):
    named = {row.part for row in rows} - {"", "hip_actuator", "knee_actuator"}
    assert named == {unique.name for unique in product.unique if unique.part.process != "bought"}


def test_two_dimensions_of_one_name_are_refused(product, actuator_map):
    made = next(unique for unique in product.unique if unique.part.process != "bought")
    twice = dataclasses.replace(product, unique=(*product.unique, made))
    with pytest.raises(ValueError, match="one dimension only"):
        parameters(twice, leg_dimensions(actuator_map))
