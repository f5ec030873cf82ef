"""Where notes stand on a sheet."""

import pytest

from pareto_monoped.cad.drawing.paper import Paper
from pareto_monoped.cad.drawing.sheet import A2, A3, TITLE_MM, compose, titled
from tests.cad.drawing.crossings import crossed
from tests.cad.drawing.test_sheets import TITLE


@pytest.mark.parametrize("size", [A3, A2], ids=lambda size: size.name)
@pytest.mark.parametrize("words", [1, 5, 20, 40, 60])
def test_notes_of_any_length_keep_clear_of_the_centring_mark_and_the_title_block(size, words):
    view = Paper()
    view.line([(0.0, 0.0), (50.0, 50.0)])
    for count in range(words, words + 5):
        paper = compose(size, [view], [], ["A first note.", " ".join(["register"] * count)])
        assert paper is not None
        titled(paper, size, 1.0, TITLE)
        assert crossed(paper) == []
        notes = [label for label in paper.labels if "register" in label.text]
        assert all(label.box()[2] < size.width_mm - 10.0 - TITLE_MM[0] for label in notes)
