"""Rows of dimensions keep their distance, and stay as near to their features as that allows."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.cad.drawing.dimension import (
    Mark,
    Tag,
    across,
    datum,
    fits_between,
    frame,
    ladder,
    place_tags,
    spread,
)
from pareto_monoped.cad.drawing.paper import Paper, overlapping
from pareto_monoped.cad.drawing.plan import plan_of, repeats
from pareto_monoped.cad.shape.outlines import contours, ends
from pareto_monoped.geometry.parts import Ball, machined_part
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.shapes import polygon

PLACES = st.lists(st.floats(-100.0, 100.0), min_size=1, max_size=12).map(sorted)


@given(PLACES)
def test_places_keep_their_distance_and_order(wanted):
    found = spread(wanted, 4.2)
    assert np.all(np.diff(found) >= 4.2 - 1e-9)


@given(PLACES, st.integers(0, 11), st.floats(-1.0, 1.0))
def test_no_small_move_brings_the_places_nearer(wanted, which, move):
    """The sum of squares is convex, so a minimum along every allowed direction is the minimum."""
    found = np.array(spread(wanted, 4.2))
    other = found.copy()
    other[which % len(found) :] += move
    if np.all(np.diff(other) >= 4.2 - 1e-12):
        assert np.sum((found - wanted) ** 2) <= np.sum((other - wanted) ** 2) + 1e-9


def test_places_far_enough_apart_stay():
    assert spread([0.0, 10.0, 20.0], 4.2) == pytest.approx([0.0, 10.0, 20.0])
    assert spread([0.0, 0.0], 4.0) == pytest.approx([-2.0, 2.0])


@given(PLACES, st.sampled_from(["below", "above", "left", "right"]))
def test_texts_of_a_ladder_never_overlap(wanted, side):
    paper = Paper()
    marks = [Mark(at=at, start=0.0, text=f"{at:.3f}") for at in wanted]
    ladder(paper, marks, side, 10.0 if side in ("above", "right") else -10.0, origin=0.0)
    assert len(paper.labels) == len(wanted)
    assert overlapping(paper.labels) == []
    outside = {"below": lambda b: b[3] < -10.0, "above": lambda b: b[1] > 10.0}
    outside |= {"left": lambda b: b[2] < -10.0, "right": lambda b: b[0] > 10.0}
    assert all(outside[side](label.box()) for label in paper.labels)


@given(PLACES, st.sampled_from(["below", "above", "left", "right"]))
def test_lines_of_a_ladder_run_outwards_to_their_texts_and_end_along_them(wanted, side):
    paper = Paper()
    ladder(
        paper,
        [Mark(at=at, start=0.0, text=f"{at:.3f}") for at in wanted],
        side,
        9.0 if side in ("above", "right") else -9.0,
    )
    across_axis = 1 if side in ("above", "below") else 0
    outwards = 1.0 if side in ("above", "right") else -1.0
    for stroke, label in zip(paper.strokes, paper.labels, strict=True):
        out = outwards * stroke.points[:, across_axis]
        assert np.all(np.diff(out) > 0.0)
        assert stroke.points[-1, 1 - across_axis] == stroke.points[-2, 1 - across_axis]
        begin = min(outwards * np.array(label.box())[[across_axis, across_axis + 2]])
        assert 0.0 < begin - out[-1] < 1.0


@pytest.mark.parametrize("side", range(4), ids=["left", "below", "right", "above"])
@pytest.mark.parametrize(("what", "clear"), [("line", 0.2), ("text", 0.4)])
def test_a_name_moves_away_from_what_is_nearer_than_allowed(side, what, clear):
    """Beside its best place stands a line or a text, a little too near or a little farther off than it must."""
    tag = Tag(text="A1", x=0.0, y=0.0, radius=0.0, height_mm=2.5)
    alone = Paper()
    place_tags(alone, [tag], 1.0)
    box = np.array(alone.labels[0].box())
    moved = []
    for gap in (clear - 0.01, clear + 0.01):
        paper = Paper()
        at = box[side] + (gap if side >= 2 else -gap)
        middle = 0.5 * (box[:2] + box[2:])
        if what == "line":
            ends = np.array([middle, middle]) + np.array([[-0.3, -0.3], [0.3, 0.3]])
            ends[:, side % 2] = at
            paper.line(ends)
        else:
            paper.text("I", 0.0, 0.0)
            other = np.array(paper.labels[0].box())
            shift = middle - 0.5 * (other[:2] + other[2:])
            shift[side % 2] = at - other[(side + 2) % 4]
            paper.labels.clear()
            paper.text("I", *shift)
        place_tags(paper, [tag], 1.0)
        moved.append(paper.labels[-1].box() != pytest.approx(box))
    assert moved == [True, False]


def test_a_diameter_s_text_stands_within_its_arrows_if_it_fits():
    paper = Paper()
    across(paper, -9.0, 20.0, "Ø40 h6", edge=0.0)
    (label,) = paper.labels
    low, high = label.box()[1], label.box()[3]
    assert fits_between("Ø40 h6", 40.0)
    assert not fits_between("Ø40 h6", 10.0)
    assert -20.0 < low < high < 20.0
    assert low == pytest.approx(-high)


def test_a_frame_is_as_wide_as_its_cells():
    paper = Paper()
    wide = frame(paper, ["position", "Ø0.02", "A"], 5.0, 7.0)
    box = paper.box()
    assert box[0] == pytest.approx(5.0)
    assert box[2] == pytest.approx(5.0 + wide)
    assert box[3] - box[1] == pytest.approx(5.0)
    with pytest.raises(ValueError, match="no symbol"):
        frame(paper, ["flat", "0.1"], 0.0, 0.0)


def test_letters_stand_in_the_middle_of_their_boxes():
    """ISO 5459 and ISO 1101: of a datum's box, and of the last cell of a frame, both 5 mm high."""
    paper = Paper()
    datum(paper, "B", 20.0, 30.0)
    wide = frame(paper, ["position", "A"], 50.0, 60.0)
    for label, (x, y) in zip(paper.labels, [(22.5, 32.5), (50.0 + wide - 2.5, 62.5)], strict=True):
        left, _, right, high = label.box()
        assert (0.5 * (left + right), 0.5 * (label.y + high)) == pytest.approx((x, y))


def test_a_paper_is_laid_where_it_was_drawn_unless_moved():
    drawn, plain, moved = Paper(), Paper(), Paper()
    drawn.circle(3.0, 4.0, 2.0)
    drawn.text("A", 1.0, 2.0)
    plain.lay(drawn)
    moved.lay(drawn, 10.0, -5.0)
    assert plain.box() == drawn.box()
    assert moved.box() == pytest.approx(np.add(drawn.box(), (10.0, -5.0) * 2))


@pytest.mark.parametrize("points", [3, 5, 12])
def test_a_star_repeats_itself_as_often_as_it_has_points(points):
    radii, angles = np.tile([10.0, 4.0], points), np.arange(2 * points) * np.pi / points
    (star,) = contours(polygon([(r * np.cos(a), r * np.sin(a)) for r, a in zip(radii, angles, strict=True)]))
    assert repeats(star) == points


def test_the_outline_of_a_ball_that_is_cut_flat_is_closed_by_a_level_line():
    """A chord 12 mm above the centre of a ball of 20 mm is 32 mm long: 12, 16, 20."""
    ball = Ball(radius_mm=20.0, y_mm=-5.0, top_mm=12.0)
    plan = plan_of(machined_part(name="foot", role=Role.FOOT, prisms=(), balls=(ball,)))
    arc, line = plan.layers[0].outline.pieces
    assert ends(arc)[1] == pytest.approx(ends(line)[0])
    assert ends(line)[1] == pytest.approx(ends(arc)[0])
    assert ends(line)[0] - ends(line)[1] == pytest.approx((32.0, 0.0))
