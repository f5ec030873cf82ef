"""Round faces of two made parts that touch all around have a tolerance on both sheets."""

from itertools import permutations

import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.drawing.part_sheet import part_sheet
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.geometry.shapes import Circle
from pareto_monoped.robot.build import build_robot


def cylinders(part, *, bores):
    """Radius, height and centre of the round faces of a part about its axis, as seen from its unit."""
    for x, y, z in part.places_mm:
        for prism in part.prisms:
            for shape in prism.holes if bores else (prism.outline,):
                if isinstance(shape, Circle) and float(part.pitch_radius_mm) == 0.0:
                    centre = complex(x + shape.x_mm, y + shape.y_mm)
                    yield float(shape.radius_mm), z + float(prism.z0_mm), z + float(prism.z1_mm), centre


def mating(unit):
    """Parts of which one stands in a bore of the other without play, and the diameter."""
    made = [part for part in unit.parts if part.process == "machined"]
    for inner, outer in permutations(made, 2):
        for radius, low, high, at in cylinders(inner, bores=False):
            for bore, start, end, centre in cylinders(outer, bores=True):
                if abs(bore - radius) < 1e-6 and abs(at - centre) < 1e-6 and min(high, end) - max(low, start) > 0.1:
                    yield inner, outer, 2.0 * radius


@pytest.mark.parametrize(("case", "motor"), [("A", "VT8020"), ("C", "MAD_M6C12"), ("B", "U12"), ("A", "U10")])
def test_what_stands_in_a_bore_has_a_tolerance_and_so_has_the_bore(case, motor):
    """Spacers, caps and the backplate's step had 0.2 to 0.3 mm by the title block on either side."""
    found = set()
    for unit in build_robot(PAPER_CASES[case].design, map_for(motor, "iso6336")).units:
        for inner, outer, diameter in mating(unit):
            found.add((inner.name, outer.name))
            for part, zones in ((inner, str.islower), (outer, str.isupper)):
                fits = [fit for fit in part.toleranced if fit.holds(diameter)]
                assert any(zones(fit.zone[0]) for fit in fits), (
                    part.name,
                    diameter,
                    inner.name,
                    outer.name,
                )
    assert found >= {("backplate", "casing"), ("encoder_cap", "backplate"), ("knee_axle", "knee_spacer")}


def test_holes_of_dowels_are_reamed_in_place_and_plain_diameters_have_a_class():
    """Sheets of both parts of a joint had finished H7 patterns, which no m6 dowel passes."""
    robot = build_robot(PAPER_CASES["A"].design, map_for("VT8020", "iso6336"))
    reamed = set()
    for part in {id(part): part for unit in robot.units for part in unit.parts if part.process != "bought"}.values():
        said = " ".join(label.text for label in part_sheet(part)[0].labels)
        assert ("holes H12, shafts h12" in said) == (part.process in ("machined", "laser cut")), part.name
        if "is reamed together with the parts that the dowels join" in said:
            reamed.add(part.name)
    joined = {"base_near_cheek", "thigh_plate_inner", "hip_coupling", "drive_sprocket", "shank_plate_near", "knee_axle"}
    assert reamed >= joined | {"carrier", "coupling", "ring_housing"}
    assert not reamed & {"base_far_cheek", "journal", "knee_spacer", "planet", "secondary_carrier"}
