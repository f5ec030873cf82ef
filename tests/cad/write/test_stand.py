"""The files of the test stand, read by what a workshop has."""

import io

import ezdxf
import pytest
import trimesh

from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.write.stand import stand_files
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.leg.stand import arm

LEG = leg_dimensions(map_for("VT8020"))


def test_the_arm_reads_back_with_its_holes_and_its_volume():
    files = stand_files(LEG)
    drawing = ezdxf.read(io.StringIO(files["test_stand/arm.dxf"]))
    circles = [entity.dxf.radius for entity in drawing.modelspace() if entity.dxftype() == "CIRCLE"]
    assert sorted(circles) == [pytest.approx(1.6)] * 8 + [pytest.approx(2.15)] * 3
    mesh = trimesh.load(io.BytesIO(files["test_stand/arm.stl"]), file_type="stl")
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(float(arm(LEG).volume_mm3()), rel=1e-3)


def test_the_text_names_every_screw():
    text = stand_files(LEG)["test_stand/README.md"]
    assert "| 16 | M3 x 8 cap screw (ISO 4762) 8.8 |" in text
    assert "{" not in text
    assert all(len(line) <= 120 for line in text.splitlines())
