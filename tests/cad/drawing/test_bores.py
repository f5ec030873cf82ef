"""Threads on the sheets: each with class and depth, and from where it is cut where its hole goes through."""

import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.drawing.part_sheet import part_sheet
from pareto_monoped.cad.drawing.plan import plan_of
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.geometry.features import Hole
from pareto_monoped.geometry.parts import layer, machined_part
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.screws import M4, tapped
from pareto_monoped.geometry.shapes import Circle, Pattern, rectangle
from pareto_monoped.robot.build import build_robot


def words(part):
    """All that a sheet says, lines of notes joined."""
    return " ".join(label.text for label in part_sheet(part)[0].labels)


@pytest.fixture(scope="module")
def made():
    """Made parts of a robot by name, one of each."""
    robot = build_robot(PAPER_CASES["A"].design, map_for("VT8020"))
    return {part.name: part for unit in robot.units for part in unit.parts if part.process != "bought"}


def test_every_thread_stands_on_its_sheet_with_class_and_depth(made):
    threads = 0
    for part in made.values():
        for feature in part.features:
            if isinstance(feature, Hole) and feature.thread is not None:
                threads += 1
                depth = "" if feature.thread_mm is None else f", {float(feature.thread_mm):g} deep, drill Ø"
                assert f"{feature.thread.text}{depth}" in words(part), part.name
    assert threads >= 10


def test_threads_on_the_axis_have_the_faces_that_they_are_cut_from(made):
    rod, pillar = made["base_rod"], made["thigh_standoff"]
    (length,) = rod.lengths
    assert (
        f"Tapped on the axis from the faces at 0 and {length.nominal_mm:g}: M4x0.7 - 6H, 10 deep, drill Ø3.3 through."
        in words(rod)
    )
    assert "Tapped on the axis from the face at 0: M3x0.5 - 6H, 7 deep, drill Ø2.5, 8.8 deep." in words(pillar)


@pytest.mark.parametrize(("enters", "said"), [("low", "the far side"), ("high", "this side"), ("both", "both sides")])
@pytest.mark.parametrize("flat", [True, False])
def test_a_thread_in_part_of_a_through_hole_has_its_drill_and_its_side(enters, said, flat):
    hole = Circle(radius_mm=M4.core, x_mm=6.0)
    outline = rectangle(width_mm=40.0, height_mm=30.0) if flat else Circle(radius_mm=15.0)
    part = machined_part(
        name="block",
        role=Role.BRACKET,
        prisms=(layer(outline, 0.0, 12.0, hole),),
        features=(tapped(M4, (hole,), 0.0, 12.0, enters=enters, usable_mm=5.0),),
    )
    text = words(part)
    assert "M4x0.7 - 6H, 5 deep, drill Ø3.3 through" in text
    # A round part is seen from the side of its datum.
    turned = {"the far side": "this side", "this side": "the far side"}
    assert f"tapped from {said if flat else turned.get(said, said)}" in text


@pytest.mark.parametrize(("depth", "bottoming"), [(None, True), (4.0, False)])
def test_a_thread_to_the_bottom_of_its_hole_asks_for_a_bottoming_tap(depth, bottoming):
    hole = Circle(radius_mm=M4.core, x_mm=6.0)
    part = machined_part(
        name="block",
        role=Role.BRACKET,
        prisms=(layer(Circle(radius_mm=15.0), 0.0, 6.0), layer(Circle(radius_mm=15.0), 6.0, 12.0, hole)),
        features=(tapped(M4, (hole,), 6.0, 12.0, enters="high", usable_mm=depth),),
    )
    assert f"{depth or 6.0:g} deep, drill Ø3.3, 6 deep" in words(part)
    assert ("bottoming tap" in words(part)) == bottoming


def test_holes_that_look_alike_have_the_heights_of_their_flange():
    """In a view along the axis, holes of a front and of a rear flange cannot be told apart."""
    front, rear = (
        Pattern(radius_mm=2.0, pitch_radius_mm=15.0, count=4),
        Pattern(radius_mm=2.0, pitch_radius_mm=14.0, count=4),
    )
    tube, flange = Circle(radius_mm=10.0), Circle(radius_mm=20.0)
    block, boss = rectangle(width_mm=50.0, height_mm=50.0), rectangle(width_mm=30.0, height_mm=30.0)
    for outline, neck, prefix, joined in ((flange, tube, "between", "and"), (block, boss, "z", "to")):
        part = machined_part(
            name="bobbin",
            role=Role.BRACKET,
            prisms=(layer(outline, 0.0, 3.0, front), layer(neck, 3.0, 20.0), layer(outline, 20.0, 25.0, rear)),
        )
        assert f"{prefix} 0 {joined} 3" in words(part)
        assert f"{prefix} 20 {joined} 25" in words(part)
        alike = machined_part(name="ring", role=Role.BRACKET, prisms=(layer(outline, 0.0, 3.0, front, rear),))
        assert f"{prefix} 0 {joined} 3" not in words(alike)


def test_layers_are_one_only_with_as_many_holes():
    """Else a slot of one layer would go through the other, or a slot that goes on would end between them."""
    outline, slot = rectangle(width_mm=60.0, height_mm=40.0), rectangle(width_mm=6.0, height_mm=3.0, x_mm=9.0)
    other = rectangle(width_mm=6.0, height_mm=3.0, x_mm=-9.0)

    def layers(*holes):
        prisms = [layer(outline, 4.0 * k, 4.0 * (k + 1), *each) for k, each in enumerate(holes)]
        plan = plan_of(machined_part(name="plate", role=Role.BRACKET, prisms=tuple(prisms)))
        return [(one.low, one.high, len(one.holes)) for one in plan.layers]

    assert layers([slot], [slot]) == [(0.0, 8.0, 1)]
    assert layers([], [slot]) == [(4.0, 8.0, 1), (0.0, 4.0, 0)]
    assert layers([slot], [slot, other]) == [(4.0, 8.0, 2), (0.0, 4.0, 1)]
    assert layers([slot, other], [slot]) == [(4.0, 8.0, 1), (0.0, 4.0, 2)]
    assert layers([slot], [other]) == [(4.0, 8.0, 1), (0.0, 4.0, 1)]
