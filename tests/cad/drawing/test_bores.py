"""Threads on the sheets: each with class and depth, and from where it is cut where its hole goes through."""

import pytest

from pareto_monoped.cad.drawing.part_sheet import part_sheet
from pareto_monoped.geometry.parts import layer, machined_part
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.screws import M4, tapped
from pareto_monoped.geometry.shapes import Circle, rectangle


def words(part):
    """All that a sheet says, lines of notes joined."""
    return " ".join(label.text for label in part_sheet(part)[0].labels)


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
