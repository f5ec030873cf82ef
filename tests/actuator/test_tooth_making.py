"""What drawings and parts list say of teeth and raceways, against what the ratings of gears and needles assume."""

import math
import re
from dataclasses import replace

import pytest

from pareto_monoped.actuator.layout import shoulder_note
from pareto_monoped.actuator.needles import needle_rows, raceway_factor
from pareto_monoped.actuator.rating.load import runout_um
from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.drawing.part_sheet import round_part, round_tables
from pareto_monoped.geometry.gears import ExternalGear
from pareto_monoped.geometry.roles import Group, Role
from pareto_monoped.materials import GEAR_GRADES

HRC_58_HV = 655.0
"""ISO 18265."""
LEAST_HRC = 58


def actuator(ratio=6.0):
    return map_for("VT8020", "iso6336").lookup(ratio)


def settings():
    return map_for("VT8020", "iso6336").settings


def said(part):
    return [label.text for paper in round_tables(part, round_part(part)) for label in paper.labels]


def value(texts, name):
    """What stands beside a name in a table."""
    return texts[texts.index(name) + 1]


def finish_of(part, name):
    """Ra in the row of a face in the table of fits."""
    labels = [label for paper in round_tables(part, round_part(part)) for label in paper.labels]
    (face,) = (label for label in labels if label.text == name)
    row = sorted((label for label in labels if abs(label.box()[1] - face.box()[1]) < 0.5), key=lambda one: one.box()[0])
    return row[row.index(face) + 2].text


def table_with(part, name, number):
    """The table of a part that has this value."""
    tables = [[label.text for label in paper.labels] for paper in round_tables(part, round_part(part))]
    (found,) = (texts for texts in tables if name in texts and value(texts, name) == number)
    return found


def of(found, role, group):
    (part,) = (part for part in found.parts if part.role is role and part.group is group)
    return part


@pytest.mark.parametrize("ratio", [4.5, 7.5])
def test_needles_run_on_faces_that_are_hard_and_ground_as_iso_281_assumes(ratio):
    found = actuator(ratio)
    pin, planet = of(found, Role.PIN, Group.OUTPUT), of(found, Role.GEAR, Group.PLANET)
    for part in (pin, planet):
        assert int(part.grade.hardness.split()[0]) >= LEAST_HRC
        assert part.grade.hardness.endswith("HRC")
        raceways = [fit for fit in part.fits if fit.raceway]
        assert len(raceways) == 1
        assert float(finish_of(part, f"Ø{raceways[0].text}")) <= 0.2
        assert "raceway of the needles: ground, Ra 0.2 um" in part.note
    assert "case of 0.15 mm or more" in planet.note  # a tenth of the needles' 1.5 mm
    assert raceway_factor(planet.grade.hardness_hv) == 1.0


def test_planets_of_softer_steel_carry_less_on_their_needles():
    plain = needle_rows(8.0, settings())
    factors = [raceway_factor(hv) for hv in (800.0, HRC_58_HV, 600.0, 550.0, 300.0)]
    assert factors[:2] == [1.0, 1.0]
    assert factors == sorted(factors, reverse=True)
    data = replace(settings().parts.rating, planet_grade="nitrided_42crmo4")
    soft = needle_rows(8.0, replace(settings(), parts=replace(settings().parts, rating=data)))
    assert soft.dynamic_rating_n / plain.dynamic_rating_n == pytest.approx(0.65)
    assert soft.static_rating_n / plain.static_rating_n == pytest.approx(0.65)


@pytest.mark.parametrize("ratio", [4.5, 7.5])
def test_drawings_of_gears_carry_what_their_rating_assumes(ratio):
    found, data = actuator(ratio), settings().parts.rating
    for name, group in (("sun", Group.ROTOR), ("planet", Group.PLANET), ("ring", Group.HOUSING)):
        part, steel = of(found, Role.GEAR, group), getattr(settings().gear_steels, name)
        texts = said(part)
        assert value(texts, "Making") == steel.making
        assert value(texts, "Quality of material and treatment") == f"ISO 6336-5 {steel.quality}"
        assert value(texts, "Hardness of flanks") == steel.hardness
        assert value(texts, "Hardness of the core") == steel.core_hardness
        (depth,) = (texts[k + 1] for k, text in enumerate(texts) if text.startswith(("Case depth", "Nitriding depth")))
        low, high = (float(number) for number in depth.split(" to "))
        module = found.gears.module_mm
        assert 0.1 * module <= low < high <= 0.4 * module + 1e-9
        finish = value(texts, "Roughness of flanks, fillets")
        assert finish == f"Rz {data.flank_roughness_um:g}, {data.root_roughness_um:g} µm at most"
        diameter = module * {"sun": found.gears.sun_teeth, "planet": found.gears.planet_teeth}.get(
            name, found.gears.ring_teeth
        )
        runout = float(value(texts, "Radial runout to the datum axis").split()[0])
        assert runout <= 1e-3 * runout_um(diameter, module, data.accuracy_class) < runout + 1e-3
        least, most = (float(value(texts, f"Backlash of the pair, at {end}")) for end in ("least", "most"))
        measures = [texts[k + 1] for k, text in enumerate(texts) if text.startswith(("Base tangent", "Between pins"))]
        assert least + 0.02 < most < least + 0.06
        assert measures
        (rated,) = (one for one in part.teeth if one.quality)
        assert rated.text.startswith(f"teeth {steel.making}, {steel.quality}, ")


def test_runout_is_nine_tenths_of_the_total_pitch_tolerance():
    """Class 5, 50 mm, module 1: F_pT = 0.1 + 0.55 sqrt(50) + 0.7 + 12 = 16.7 um; a class is a factor of sqrt(2)."""
    assert runout_um(50.0, 1.0, 5) == pytest.approx(0.9 * 16.689, rel=1e-4)
    assert runout_um(50.0, 1.0, 7) == pytest.approx(1.8 * 16.689, rel=1e-4)


@pytest.mark.parametrize("ratio", [4.5, 7.5])
def test_spline_has_one_backlash_and_says_where_its_roots_lie_below_the_shaft(ratio):
    found, play = actuator(ratio), settings().parts.spline.play_mm
    sun = of(found, Role.GEAR, Group.ROTOR)
    (hub,) = (part for part in found.parts if part.role is Role.COUPLING)
    assert f"{play:g} mm play" in hub.note
    spline = next(one for one in sun.teeth if not one.quality)
    shaft, hole = (
        table_with(sun, "Teeth, external", f"{spline.teeth}"),
        table_with(hub, "Teeth, hole of a splined shaft", f"{spline.teeth}"),
    )
    assert (
        value(shaft, "Backlash of the pair, at least") == value(hole, "Backlash of the pair, at least") == f"{play:g}"
    )
    # Limits are rounded to a micrometre; between both, the play stands along the base tangent.
    assert _span(hole)[0] - _span(shaft)[1] == pytest.approx(play * math.cos(math.radians(20.0)), abs=1.1e-3)
    below = found.family == "ESSPG"
    assert ("below the shaft's 8 mm: hob may run out" in sun.note) is below


def _span(texts):
    row = next(k for k, text in enumerate(texts) if text.startswith("Base tangent length"))
    return [float(number) for number in texts[row + 1].split(" to ")]


def test_grades_say_what_their_drawings_need():
    for grade in GEAR_GRADES.values():
        assert (grade.layer_modules is None) == (grade.treatment == "through_hardened")
        assert grade.making


@pytest.mark.parametrize(("neck", "shaft"), [(3.8, 4.0), (3.8, 3.0), (3.0, 5.0), (3.0, 3.0)])
def test_the_sun_says_how_far_its_tool_runs_out_into_wider_shoulders(neck, shaft):
    """A disc of 12 mm radius that touches the roots stands above the shoulder from there on, and not 0.5 mm before."""
    gear = ExternalGear(teeth=16, module_mm=0.5, backlash_mm=0.01)
    note = shoulder_note(gear, neck, shaft)
    for radius, name in ((neck, "neck"), (shaft, "shaft")):
        found = re.search(rf"([\d.]+) mm into the {name}", note)
        assert bool(found) == (radius > gear.root_radius_mm)
        if found:
            before, there = (
                gear.root_radius_mm + 12.0 - math.sqrt(144.0 - x**2) for x in (float(found[1]) - 0.5, float(found[1]))
            )
            assert before < radius <= there
    assert bool(note) == (max(neck, shaft) > gear.root_radius_mm)


def test_the_note_of_a_sun_with_few_teeth_has_its_run_outs():
    built = [entry.actuator for entry in map_for("MAD_M6C12").entries if entry.actuator is not None]
    notes = {part.note for found in built for part in found.parts if part.name == "sun"}
    assert any("into the neck" in note for note in notes)
