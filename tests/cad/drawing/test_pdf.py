"""PDF files: sound for a reader that trusts their table, the same bytes each time, drawn as they should be."""

import shutil
import subprocess

import numpy as np
import pytest

from pareto_monoped.cad.drawing.drawings import pdf
from pareto_monoped.cad.drawing.paper import Label, Paper, circle_points, overlapping, width_mm
from tests.cad.drawing.reader import pages


@pytest.fixture
def paper():
    drawn = Paper()
    drawn.line([(10.0, 10.0), (110.0, 10.0)], width_mm=0.5)
    drawn.circle(50.0, 60.0, 20.0, dashes=(2.0, 1.0))
    drawn.arrow(10.0, 10.0, (0.0, -1.0))
    drawn.text("Ø40 h6 (A) 2 \N{MULTIPLICATION SIGN} 45°", 20.0, 30.0)
    drawn.text("upward", 100.0, 100.0, upward=True)
    return drawn


def test_a_reader_finds_every_page_and_text(paper):
    one, other = pages(pdf([(paper, 210.0, 297.0), (Paper(), 420.0, 297.0)], "title"))
    assert (one.width_mm, one.height_mm) == pytest.approx((210.0, 297.0), abs=1e-3)
    assert (other.width_mm, other.height_mm) == pytest.approx((420.0, 297.0), abs=1e-3)
    assert one.texts == (("Ø40 h6 (A) 2 \N{MULTIPLICATION SIGN} 45°", 20.0, 30.0), ("upward", 100.0, 100.0))
    assert other.texts == ()


def test_the_same_drawing_gives_the_same_bytes(paper):
    assert pdf([(paper, 210.0, 297.0)], "a") == pdf([(paper, 210.0, 297.0)], "a")


@pytest.mark.skipif(shutil.which("pdftoppm") is None, reason="poppler is not installed")
def test_poppler_draws_the_lines_where_they_are(paper, tmp_path):
    (tmp_path / "a.pdf").write_bytes(pdf([(paper, 120.0, 120.0)], "a"))
    command = ["pdftoppm", "-r", "254", "-gray", "-singlefile", str(tmp_path / "a.pdf"), str(tmp_path / "a")]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    assert run.stderr == ""
    head, _, rest = (tmp_path / "a.pgm").read_bytes().partition(b"\n255\n")
    width, height = map(int, head.split()[1:3])
    image = np.frombuffer(rest, np.uint8).reshape(height, width)  # ten pixels per millimetre
    dark = image[height - 103 : height - 97, 150:1050] < 128
    assert dark.any(axis=0).mean() > 0.99
    assert (image[height - 250 : height - 150, 600:900] > 250).all()


def test_widths_are_those_of_the_font():
    """Adobe's metrics: A 0.667, i 0.222, digits 0.556 of the font size, whose capitals are 0.718 high."""
    assert width_mm("A", 0.718) == pytest.approx(0.667)
    assert width_mm("i1", 7.18) == pytest.approx(2.22 + 5.56)
    assert width_mm("Ø", 0.718) == pytest.approx(0.778)
    assert width_mm("'", 0.718) == pytest.approx(0.191)
    with pytest.raises(ValueError, match="no width for"):
        width_mm("\N{SNOWMAN}", 2.5)


def test_a_label_s_box_follows_its_direction():
    flat, upward = Label(text="Ab", x=10.0, y=20.0), Label(text="Ab", x=10.0, y=20.0, upward=True)
    x0, y0, x1, y1 = flat.box()
    long = width_mm("Ab", 2.5)
    assert (x0, x1 - x0, y1) == pytest.approx((10.0, long, 22.5))
    assert y0 < 20.0
    u0, v0, u1, v1 = upward.box()
    assert (v0, v1 - v0, u0) == pytest.approx((20.0, long, 7.5))
    assert u1 > 10.0
    assert Label(text="Ab", x=10.0, y=20.0, align="right").box()[2] == pytest.approx(10.0)


def test_overlapping_labels_are_found():
    a, b, c = (Label(text="12345", x=x, y=0.0) for x in (0.0, 5.0, 50.0))
    assert overlapping([a, b, c]) == [(a, b)]
    assert overlapping([a, c]) == []


def test_a_circle_stays_within_a_hundredth_of_a_millimetre():
    points = circle_points(1.0, 2.0, 40.0) - [1.0, 2.0]
    middles = 0.5 * (points + np.roll(points, 1, axis=0))
    assert np.hypot(*points.T) == pytest.approx(40.0)
    assert np.hypot(*middles.T).min() > 40.0 - 0.0101
