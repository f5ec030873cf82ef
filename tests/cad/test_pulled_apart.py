"""Boxes of an exploded view: what lies behind something else comes off it, what lies beside stays."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.cad.assembly import pulled_apart

sizes = st.floats(1.0, 20.0)
places = st.floats(-40.0, 40.0)
boxes = st.tuples(places, places, places, sizes, sizes, sizes)


@given(st.lists(boxes, min_size=1, max_size=12), st.integers(0, 2))
def test_no_two_boxes_overlap_and_none_leaves_its_line(found, axis):
    low = np.array([box[:3] for box in found])
    corners = np.column_stack([low, low + [box[3:] for box in found]])
    moves = pulled_apart(corners, axis)
    moved = corners.copy()
    moved[:, [axis, axis + 3]] += np.array(moves)[:, None]
    for k in range(len(moved)):
        for other in range(k):
            apart = [
                min(moved[k, i + 3], moved[other, i + 3]) - max(moved[k, i], moved[other, i]) < 1e-9 for i in range(3)
            ]
            assert any(apart), (k, other)


def test_boxes_beside_each_other_stay():
    corners = np.array([[0.0, 0.0, 0.0, 1.0, 5.0, 1.0], [2.0, 0.0, 0.0, 3.0, 5.0, 1.0]])
    assert pulled_apart(corners, 1) == [0.0, 0.0]
