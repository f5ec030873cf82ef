"""The files of the test stand, read by what a workshop has."""

import io

import ezdxf
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.write.dxf import stand_files
from pareto_monoped.leg.dimensions import leg_dimensions

LEG = leg_dimensions(map_for("VT8020"))


def ends_of(entity):
    if entity.dxftype() == "ARC":
        return entity.start_point, entity.end_point
    return entity.dxf.start, entity.dxf.end


def test_the_arm_reads_back_closed_and_with_its_holes():
    files = stand_files(LEG)
    drawing = ezdxf.read(io.StringIO(files["test_stand/arm.dxf"]))
    circles = [entity.dxf.radius for entity in drawing.modelspace() if entity.dxftype() == "CIRCLE"]
    assert sorted(circles) == [pytest.approx(1.6)] * 8 + [pytest.approx(2.15)] * 3
    outline = [entity for entity in drawing.modelspace() if entity.dxftype() in ("LINE", "ARC")]
    ends = sorted((round(p.x, 4), round(p.y, 4)) for e in outline for p in (ends_of(e)))
    assert ends[::2] == ends[1::2]  # every piece begins where another ends


def test_the_text_names_every_screw():
    text = stand_files(LEG)["test_stand/README.md"]
    assert "| 16 | M3 x 8 cap screw (ISO 4762) 8.8 |" in text
    assert "{" not in text
    assert all(len(line) <= 120 for line in text.splitlines())
