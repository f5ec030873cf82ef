"""The files of the test stand, read by what a workshop has."""

import io

import ezdxf
import mujoco
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.write.dxf import stand_files
from pareto_monoped.leg.dimensions import leg_dimensions

RECORD = {
    "calibration": "slippery-2",
    "jumps": {
        "as_built": {"height_m": 1.0614},
        "stand": {"height_m": 1.0332, "mass_kg": 0.418, "rail_friction_n": 4.0},
    },
}


def files_of(record):
    return stand_files(leg_dimensions(map_for("VT8020")), record)


def ends_of(entity):
    if entity.dxftype() == "ARC":
        return entity.start_point, entity.end_point
    return entity.dxf.start, entity.dxf.end


def test_the_arm_reads_back_closed_and_with_its_holes():
    files = files_of(RECORD)
    drawing = ezdxf.read(io.StringIO(files["test_stand/arm.dxf"]))
    circles = [entity.dxf.radius for entity in drawing.modelspace() if entity.dxftype() == "CIRCLE"]
    assert sorted(circles) == [pytest.approx(1.6)] * 8 + [pytest.approx(2.15)] * 3
    outline = [entity for entity in drawing.modelspace() if entity.dxftype() in ("LINE", "ARC")]
    ends = sorted((round(p.x, 4), round(p.y, 4)) for e in outline for p in (ends_of(e)))
    assert ends[::2] == ends[1::2]  # every piece begins where another ends


def test_the_text_names_every_screw():
    text = files_of(RECORD)["test_stand/README.md"]
    assert "| 16 | M3 x 8 cap screw (ISO 4762) 8.8 |" in text
    assert "{" not in text
    assert all(len(line) <= 120 for line in text.splitlines())


def test_the_text_says_what_differs_from_the_simulation_and_gives_both_heights():
    text = files_of(RECORD)["test_stand/README.md"]
    for said in ("4.0 N of\nfriction", "0.418 kg", "1.033 m high\non this stand", "1.061 m high under", "slippery-2"):
        assert said in text
    assert "as the simulation does" not in text
    lame = RECORD | {"jumps": RECORD["jumps"] | {"stand": RECORD["jumps"]["stand"] | {"height_m": None}}}
    assert "it jumps not at all\non this stand" in files_of(lame)["test_stand/README.md"]


def test_an_export_has_both_jumps_and_says_what_the_base_lifts(exported):
    """The MJCF of the stand is the other one with a heavier base on one rail, whose friction MuJoCo has."""
    jumps = exported.record["jumps"]
    loose, held = (
        mujoco.MjModel.from_xml_path(str(exported.folder / "model" / f"monoped{place}.xml")) for place in ("", "_stand")
    )
    added = held.body("base").mass[0] - loose.body("base").mass[0]
    assert added == pytest.approx(jumps["stand"]["mass_kg"], rel=1e-12)
    assert held.joint("slide_z").frictionloss[0] == jumps["stand"]["rail_friction_n"] == 4.0
    assert held.nq == loose.nq - 1
    assert 0.9 < jumps["stand"]["height_m"] < jumps["as_built"]["height_m"]
    text = (exported.folder / "test_stand" / "README.md").read_text()
    assert f"{jumps['stand']['height_m']:.3f} m high" in text
    assert f"it jumps {jumps['stand']['height_m']:.4g} m with" in (exported.folder / "README.md").read_text()
